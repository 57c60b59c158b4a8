//! `asperity law --import-gaps`: tables of contact solvers as laws.

use std::fs;

use serde_json::Value;

use super::{answer, asperity, files, fixture, number, text};

fn rig() -> String {
    fixture("scenarios/nouira2020-modified.json").display().to_string()
}

/// Gaps in um and pressures in MPa of an exponential law of 0.3 um, as a solver may write them.
fn table() -> String {
    let rows = (0..40).map(|row| {
        let gap = 3.0 - 0.05 * f64::from(row);
        format!("{gap:.9},{:.9e}\n", 0.01 * ((3.0 - gap) / 0.3).exp())
    });
    format!("# contact solver\ngap_um,pressure_mpa\n3.2,0\n{}", rows.collect::<String>())
}

#[test]
fn a_table_of_gaps_becomes_a_law_that_modes_computes_with() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rough.csv"), table()).unwrap();
    let arguments = ["law", &rig(), "--import-gaps", "rough.csv", "--out", "out", "--json"];
    let found = answer(folder.path(), &arguments);
    assert_eq!(
        (number(&found, "/imported/rows"), number(&found, "/imported/open_rows")),
        (41.0, 1.0)
    );
    assert!((number(&found, "/imported/pressure_min_pa") / 1e4 - 1.0).abs() < 1e-9);
    assert!(number(&found, "/imported/closure_error") < 1e-6);
    assert!(found["provenance"]["files"].to_string().contains("rough.csv"));
    let out = folder.path().join("out");
    assert!(files(&out).contains(&"law-rough.csv".to_owned()));
    let law = fs::read_to_string(out.join("imported-law.json")).unwrap();
    let spec: Value = serde_json::from_str(&law).unwrap();
    assert_eq!(spec["kind"], "table");

    // The static stiffness of both contacts is p / u0, as with the exponential law itself.
    let modes = |law: &str| {
        let [first, second] = [0, 1].map(|at| format!("/interfaces/{at}/law={law}"));
        let arguments =
            ["modes", &rig(), "--json", "--out", "modes", "--set", &first, "--set", &second];
        number(&answer(folder.path(), &arguments), "/static/natural_frequency_hz")
    };
    let (imported, exact) = (modes(&law), modes(r#"{"kind": "exponential", "length_m": 3e-7}"#));
    assert!((imported / exact - 1.0).abs() < 1e-6, "{imported} {exact}");

    // The reverse order of rows, and closures in m, make the same law.
    let lines = table();
    let mut reversed: Vec<&str> = lines.lines().skip(2).collect();
    reversed.reverse();
    fs::write(
        folder.path().join("back.csv"),
        format!("gap_um,pressure_mpa\n{}", reversed.join("\n")),
    )
    .unwrap();
    answer(folder.path(), &["law", &rig(), "--import-gaps", "back.csv", "--out", "back", "--json"]);
    assert_eq!(fs::read_to_string(folder.path().join("back/imported-law.json")).unwrap(), law);
}

#[test]
fn a_file_that_is_no_table_of_gaps_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |contents: &str| {
        fs::write(folder.path().join("rough.csv"), contents).unwrap();
        let output = asperity(folder.path(), &["law", &rig(), "--import-gaps", "rough.csv"]);
        assert_eq!(output.status.code(), Some(2), "{contents}");
        assert!(!folder.path().join("out").exists());
        text(&output.stderr)
    };
    assert!(refused("u,p\n1,2\n").contains("gap_m,pressure_pa"));
    let head = "gap_m,pressure_pa\n3e-6,1e4\n2e-6,3e4\n";
    assert!(refused(&format!("{head}1e-6,-5\n")).contains("line 4: the pressure is -5 Pa"));
    assert!(refused(&format!("{head}1e-6;5e4\n")).contains("line 4"));
    assert!(refused(&format!("{head}1e-6,nan\n")).contains("line 4"));
    let message = refused(&format!("{head}2.5e-6,9e4\n"));
    assert!(message.contains("line 4: the gap does not fall from line 3"), "{message}");
    let message = refused(&format!("{head}1e-6,2e4\n0.5e-6,9e4\n"));
    assert!(message.contains("line 4: the pressure does not rise from line 3"), "{message}");
    assert!(refused(head).contains("number of points"));
    assert!(refused("").contains("gap_m,pressure_pa"));
}
