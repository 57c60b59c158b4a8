//! The laws of rough surfaces in every command that takes a scenario, with both engines.

use super::{answer, asperity, files, fixture, number, text};

const LAWS: [&str; 2] = [
    r#"{"kind": "greenwood_williamson", "summit_density_per_m2": 1e10, "summit_radius_m": 5e-5, "summit_height_rms_m": 5e-7, "contact_modulus_pa": 3.98e10}"#,
    r#"{"kind": "persson", "height_rms_m": 1e-6, "hurst_exponent": 0.8, "roll_off_per_m": 1e4, "cut_off_per_m": 1e7, "contact_modulus_pa": 3.98e10}"#,
];

/// Options for the paper's rig with this law at both interfaces, hit gently.
fn options(law: &str) -> Vec<String> {
    let mut options = vec![fixture("scenarios/nouira2020-modified.json").display().to_string()];
    let rough = format!("/laws/modified={law}");
    for set in [rough.as_str(), "/excitation/peak_n=4", "/duration_s=0.05"] {
        options.extend(["--set".to_owned(), set.to_owned()]);
    }
    options
}

#[test]
fn both_engines_agree_on_laws_of_rough_surfaces() {
    for law in LAWS {
        let folder = tempfile::tempdir().unwrap();
        let simulated = |method: &str| {
            let rig = options(law);
            let mut arguments: Vec<&str> = vec!["simulate"];
            arguments.extend(rig.iter().map(String::as_str));
            arguments.extend(["--json", "--out", "run", "--set", method]);
            answer(folder.path(), &arguments)
        };
        let modal = simulated("/method=modal");
        let finite_differences = simulated(
            r#"/method={"kind": "finite_difference", "cell_m": 0.001, "courant": 0.95, "contact": "centred"}"#,
        );
        for pointer in ["/fundamental/frequency_hz", "/interfaces/0/stiffness_average_pa_per_m"] {
            let (a, b) = (number(&modal, pointer), number(&finite_differences, pointer));
            assert!((a / b - 1.0).abs() < 1e-4, "{law} {pointer}: {a} {b}");
        }
        // The modal step is chosen for observables to 1e-3.
        assert!(number(&modal, "/energy/residual_relative").abs() < 1e-4);
        assert!(number(&finite_differences, "/energy/residual_relative").abs() < 1e-6);
        let at_rest = number(&modal, "/static/natural_frequency_hz");
        let hit = number(&modal, "/fundamental/frequency_hz");
        assert!(hit < at_rest && hit > 0.8 * at_rest, "{law}: {at_rest} {hit}");
    }
}

#[test]
fn laws_of_rough_surfaces_work_in_every_command() {
    for law in LAWS {
        let folder = tempfile::tempdir().unwrap();
        let rig = options(law);
        let run = |command: &str, more: &[&str]| {
            let mut arguments: Vec<&str> = vec![command];
            arguments.extend(rig.iter().map(String::as_str));
            arguments.extend(more);
            let output = asperity(folder.path(), &arguments);
            assert!(output.status.success(), "{command}: {}", text(&output.stderr));
        };
        run("check", &[]);
        run("modes", &["--out", "modes"]);
        run("sweep", &["--out", "sweep", "--vary", "/excitation/peak_n=1,2"]);
        let range = ["--amplitude", "0.5", "--from", "300", "--to", "700", "--harmonics", "5"];
        run("steady", &[&["--out", "steady"], &range[..]].concat());
        run("law", &["--out", "law", "--export", "calculix", "--deck-units", "mm-t-s"]);
        assert!(files(&folder.path().join("law")).contains(&"law-modified.csv".to_owned()));
        let deck =
            std::fs::read_to_string(folder.path().join("law/contacts-calculix.inp")).unwrap();
        assert!(deck.contains("** overclosure 0 is closure -"));
    }
}

#[test]
fn statistics_of_a_surface_that_cannot_be_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = fixture("malformed/wavevectors-reversed.json").display().to_string();
    let output = asperity(folder.path(), &["check", &file]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    for said in ["/laws/modified/cut_off_per_m", "/laws/modified/hurst_exponent", "roll_off_per_m"]
    {
        assert!(message.contains(said), "{said}: {message}");
    }
}
