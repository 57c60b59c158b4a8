//! `asperity law --export`: the deck itself, and ccx run on it where it is installed.

mod calculix;
mod joint;

use asperity_law::{ContactLaw, ModifiedPower};
use serde_json::Value;

use super::{answer, asperity, files, fixture, number, text};

/// Arguments of an export of the paper's rig.
fn export<'a>(scenario: &'a str, format: &'a str, units: &'a str) -> [&'a str; 9] {
    let [out, json] = ["--out", "--json"];
    ["law", scenario, "--export", format, "--deck-units", units, out, "out", json]
}

/// The law "modified" of the paper's rig, built apart from the scenario.
fn modified() -> ModifiedPower {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap()
}

fn modified_rig() -> String {
    fixture("scenarios/nouira2020-modified.json").display().to_string()
}

/// Rows (pressure, overclosure) of a surface interaction of a deck.
fn table_of(deck: &str, name: &str) -> Vec<(f64, f64)> {
    let head = format!("*SURFACE INTERACTION,NAME={name}\n*SURFACE BEHAVIOR,");
    let after = deck.split_once(&head).unwrap().1;
    let rows = after.lines().skip(1).take_while(|line| !line.starts_with('*'));
    rows.map(|row| {
        let (pressure, overclosure) = row.split_once(',').unwrap();
        (pressure.parse().unwrap(), overclosure.parse().unwrap())
    })
    .collect()
}

/// Overclosure and tangent of the straight segments at a pressure.
fn segment_at(rows: &[(f64, f64)], pressure: f64) -> (f64, f64) {
    let pair = rows.windows(2).find(|pair| pressure <= pair[1].0).unwrap();
    let tangent = (pair[1].0 - pair[0].0) / (pair[1].1 - pair[0].1);
    (pair[0].1 + (pressure - pair[0].0) / tangent, tangent)
}

fn contact<'a>(answer: &'a Value, name: &str) -> &'a Value {
    let contacts = answer["export"]["contacts"].as_array().unwrap();
    contacts.iter().find(|contact| contact["surface_interaction"] == name).unwrap()
}

#[test]
fn tables_in_both_units_and_formats_follow_the_law_within_the_stated_errors() {
    let rig = modified_rig();
    let law = modified();
    for (format, units, pascal, metre) in [
        ("calculix", "mm-t-s", 1e-6, 1e3),
        ("calculix", "si", 1.0, 1.0),
        ("abaqus", "mm-t-s", 1e-6, 1e3),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let answer = answer(folder.path(), &export(&rig, format, units));
        let file = format!("contacts-{format}.inp");
        assert_eq!(answer["export"]["file"], file.as_str());
        let deck = std::fs::read_to_string(folder.path().join("out").join(&file)).unwrap();
        assert!(deck.is_ascii() && deck.lines().all(|line| line.len() <= 100));
        for name in ["GUIDE-SAMPLE", "SAMPLE-DISC"] {
            let stated = contact(&answer, name);
            let rows = table_of(&deck, name);
            assert_eq!(rows.len() as f64, number(stated, "/rows"));
            assert!(rows.len() <= 200 && rows[0] == (0.0, 0.0));
            let at_rest = number(stated, "/static_pressure_pa");
            let (overclosure, tangent) = segment_at(&rows, at_rest * pascal);
            let tangent_error = tangent * metre / pascal / law.stiffness(at_rest) - 1.0;
            assert!(tangent_error.abs() < 1e-8, "{tangent_error}");
            assert!((overclosure / metre / law.closure(at_rest) - 1.0).abs() < 1e-9);
            let from = number(stated, "/accurate_from_pa");
            assert!((from / at_rest - 0.3).abs() < 1e-12);
            let (mut worst_tangent, mut worst_closure) = (0.0_f64, 0.0_f64);
            for step in 0..5000 {
                let pressure = from + (1e6 - from) * f64::from(step) / 5000.0;
                let (overclosure, tangent) = segment_at(&rows, pressure * pascal);
                let tangent_error = tangent * metre / pascal / law.stiffness(pressure) - 1.0;
                worst_tangent = worst_tangent.max(tangent_error.abs());
                let closure_error = overclosure / metre / law.closure(pressure) - 1.0;
                worst_closure = worst_closure.max(closure_error.abs());
            }
            let (tangent, closure) =
                (number(stated, "/tangent_error"), number(stated, "/overclosure_error"));
            assert!(worst_tangent <= tangent && worst_tangent > 0.8 * tangent);
            assert!(worst_closure <= 1.01 * closure && worst_closure > 0.9 * closure);
            assert!(closure < 2e-5, "{closure}");
        }
    }
}

#[test]
fn the_deck_names_the_traps_of_its_code() {
    let rig = modified_rig();
    let folder = tempfile::tempdir().unwrap();
    let deck = |format: &str| {
        answer(folder.path(), &export(&rig, format, "si"));
        let file = format!("out/contacts-{format}.inp");
        std::fs::read_to_string(folder.path().join(file)).unwrap()
    };
    let calculix = deck("calculix");
    for said in ["springforc_f2f.f", "NODE TO SURFACE", "PARAMETERS=FIELD", "PERTURBATION", "holds"]
    {
        assert!(calculix.contains(said), "{said}");
    }
    let abaqus = deck("abaqus");
    assert!(abaqus.contains("continues the last slope") && !abaqus.contains("springforc"));
    assert!(!files(&folder.path().join("out")).contains(&"contacts-calculix.inp".to_owned()));
}

#[test]
fn an_export_without_units_with_too_many_rows_or_too_low_a_top_is_refused() {
    let rig = modified_rig();
    let folder = tempfile::tempdir().unwrap();
    let refused = |options: &[&str]| {
        let output = asperity(folder.path(), &[&["law", &rig], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        assert!(!folder.path().join("out").exists());
        text(&output.stderr)
    };
    assert!(refused(&["--export", "calculix"]).contains("--deck-units"));
    let calculix = ["--export", "calculix", "--deck-units", "si"];
    let message = refused(&[&calculix[..], &["--rows", "201"]].concat());
    assert!(message.contains("201 rows") && message.contains("16 to 200"), "{message}");
    let message = refused(&[&calculix[..], &["--top-pressure", "1e5"]].concat());
    assert!(message.contains("guide-sample") && message.contains("137340"), "{message}");
}

/// The table of a law that never separates begins at zero pressure and states its offset.
#[test]
fn an_exponential_law_is_exported_from_a_small_pressure_on() {
    let rig = modified_rig();
    let folder = tempfile::tempdir().unwrap();
    let law = r#"/interfaces/0/law={"kind": "exponential", "length_m": 3e-7}"#;
    let options = [&export(&rig, "abaqus", "si")[..], &["--set", law]].concat();
    let answer = answer(folder.path(), &options);
    let stated = contact(&answer, "GUIDE-SAMPLE");
    let deck = folder.path().join("out/contacts-abaqus.inp");
    let rows = table_of(&std::fs::read_to_string(deck).unwrap(), "GUIDE-SAMPLE");
    let at_rest = number(stated, "/static_pressure_pa");
    let offset = number(stated, "/closure_at_zero_overclosure_m");
    // K = p / u0; closures of the law count from the static pressure.
    let (overclosure, tangent) = segment_at(&rows, 2.0 * at_rest);
    assert!(((overclosure + offset) / (3e-7 * 2.0_f64.ln()) - 1.0).abs() < 1e-3);
    assert!((tangent / (2.0 * at_rest / 3e-7) - 1.0).abs() < 0.02);
    let (overclosure, tangent) = segment_at(&rows, at_rest);
    assert!((overclosure + offset).abs() < 1e-12 * 3e-7 + 1e-16);
    assert!((tangent / (at_rest / 3e-7) - 1.0).abs() < 1e-8);
}
