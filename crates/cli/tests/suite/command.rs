//! Names, columns and exit status of every command on a scenario, and the files they write.

use std::path::Path;

use crate::{FILES_OF_A_RUN, asperity, files, fixture, text};

fn rig() -> String {
    fixture("scenarios/nouira2020-modified.json").display().to_string()
}

/// A quick run of the rig: coarse cells, 20 ms.
const QUICK: [&str; 4] = ["--set", "/method/cell_m=0.004", "--set", "/duration_s=0.04"];

fn header(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap().lines().next().unwrap().to_owned()
}

#[test]
fn simulate_writes_the_files_and_columns_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let output = asperity(folder.path(), &[&["simulate", &rig()], &QUICK[..]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let out = folder.path().join("out/nouira2020-modified");
    assert_eq!(files(&out), FILES_OF_A_RUN);
    assert_eq!(
        header(&out.join("history.csv")),
        "time_s,force_n,displacement_m,acceleration_m_per_s2,\
         guide-sample:pressure_pa,guide-sample:closure_m,guide-sample:stiffness_pa_per_m,\
         sample-disc:pressure_pa,sample-disc:closure_m,sample-disc:stiffness_pa_per_m"
    );
    assert_eq!(
        header(&out.join("frf.csv")),
        "frequency_hz,real_m_per_n,imag_m_per_n,magnitude_m_per_n,phase_rad"
    );
}

/// Every name of the contract's summary.json, and that `--json` prints the file and nothing else.
#[test]
fn json_prints_the_summary_of_the_contract_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let rig = rig();
    let arguments = [&["simulate", &rig, "--json", "--out", "here"], &QUICK[..]].concat();
    let output = asperity(folder.path(), &arguments);
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let written = std::fs::read_to_string(folder.path().join("here/summary.json")).unwrap();
    assert_eq!(text(&output.stdout), written);
    for pointer in [
        "/schema",
        "/title",
        "/static/natural_frequency_hz",
        "/static/interfaces/0/name",
        "/static/interfaces/0/pressure_pa",
        "/static/interfaces/0/stiffness_pa_per_m",
        "/static/interfaces/0/closure_m",
        "/fundamental/frequency_hz",
        "/fundamental/receptance_m_per_n",
        "/fundamental/damping_ratio",
        "/second_harmonic/frequency_hz",
        "/second_harmonic/receptance_m_per_n",
        "/harmonic_ratio",
        "/interfaces/1/name",
        "/interfaces/1/pressure_min_pa",
        "/interfaces/1/pressure_max_pa",
        "/interfaces/1/stiffness_average_pa_per_m",
        "/interfaces/1/stiffness_at_pressure_min_pa_per_m",
        "/interfaces/1/contact_lost_s",
        "/energy/input_j",
        "/energy/dissipated_j",
        "/energy/contact_dissipated_j",
        "/energy/friction_dissipated_j",
        "/energy/residual_relative",
        "/numerics/method",
        "/numerics/step_s",
        "/numerics/steps",
        "/numerics/wall_s",
        "/provenance/version",
        "/provenance/scenario_sha256",
    ] {
        assert!(printed.pointer(pointer).is_some_and(|v| !v.is_null()), "{pointer}");
    }
    assert_eq!(printed["schema"], "asperity/summary/1");
}

#[test]
fn a_linear_rig_has_no_second_harmonic_and_says_null() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let output =
        asperity(folder.path(), &["simulate", &rig, "--json", "--set", "/method/cell_m=0.005"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary["second_harmonic"].is_null() && summary["harmonic_ratio"].is_null());
    assert!(summary["fundamental"]["frequency_hz"].as_f64().unwrap() > 800.0);
}

#[test]
fn a_run_without_force_is_at_rest_and_has_no_frf() {
    let folder = tempfile::tempdir().unwrap();
    let set = ["--set", r#"/excitation={"kind": "none"}"#];
    let rig = rig();
    let arguments = [&["simulate", &rig, "--json"], &QUICK[..], &set[..]].concat();
    let output = asperity(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary["fundamental"].is_null());
    assert_eq!(summary["energy"]["residual_relative"], 0.0);
    let at_rest = &summary["static"]["interfaces"][0]["pressure_pa"];
    assert_eq!(&summary["interfaces"][0]["pressure_min_pa"], at_rest);
}

/// Rows in order and bit-identical tables, whatever the number of threads.
#[test]
fn sweeps_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let vary = ["--vary", "/excitation/peak_n=9:32:4", "--vary", "/interfaces/0/law=modified,pl"];
    let rig = rig();
    let tables: Vec<String> = ["1", "2", "5"]
        .iter()
        .map(|threads| {
            let head = ["sweep", &rig, "--threads", threads, "--out", threads];
            let output = asperity(folder.path(), &[&head[..], &vary[..], &QUICK[..]].concat());
            assert!(output.status.success(), "{}", text(&output.stderr));
            std::fs::read_to_string(folder.path().join(threads).join("sweep.csv")).unwrap()
        })
        .collect();
    assert_eq!(tables[0], tables[1]);
    assert_eq!(tables[0], tables[2]);
    let rows: Vec<&str> = tables[0].lines().collect();
    assert_eq!(rows.len(), 9);
    assert!(
        rows[0].starts_with("/excitation/peak_n,/interfaces/0/law,static.natural_frequency_hz")
    );
    assert!(rows[0].contains(",interfaces.guide-sample.pressure_min_pa,"));
    assert!(rows[1].starts_with("9,modified,") && rows[2].starts_with("9,pl,"));
    assert!(rows[8].starts_with("32,pl,"));
    assert_eq!(files(&folder.path().join("1")), ["sweep.csv", "sweep.json", "sweep.svg"]);
}

#[test]
fn law_tabulates_every_law_and_fits_table_3() {
    let folder = tempfile::tempdir().unwrap();
    let table = fixture("paper/table3.csv").display().to_string();
    let output = asperity(folder.path(), &["law", &rig(), "--json", "--fit", &table]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let (c, m) = (&answer["fit"]["coefficient"], &answer["fit"]["exponent"]);
    // The paper's values, to the digits it gives.
    assert!((c.as_f64().unwrap() / 1.81e10 - 1.0).abs() < 1e-3, "{c}");
    assert!((m.as_f64().unwrap() - 0.35).abs() < 2e-3, "{m}");
    let out = folder.path().join("out/nouira2020-modified");
    assert_eq!(
        files(&out),
        [
            "law-constant.csv",
            "law-measured.csv",
            "law-modified.csv",
            "law-pl.csv",
            "law.json",
            "law.svg"
        ]
    );
    assert_eq!(
        header(&out.join("law-pl.csv")),
        "pressure_pa,stiffness_pa_per_m,closure_m,energy_j_per_m2"
    );
}

#[test]
fn modes_and_check_and_schema_answer_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let answer = |arguments: &[&str]| -> serde_json::Value {
        let output = asperity(folder.path(), arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let modes = answer(&["modes", &rig, "--json"]);
    assert_eq!(modes["schema"], "asperity/modes/1");
    // Exact result 1 of the physics.
    let first = modes["modes"][0]["frequency_hz"].as_f64().unwrap();
    assert!((first - 831.98).abs() < 5e-3, "{first}");
    assert!(modes["static"]["interfaces"][0]["pressure_pa"].is_number());
    assert_eq!(answer(&["check", &rig, "--json"])["valid"], true);
    assert!(answer(&["schema"])["properties"]["bodies"].is_object());
}

/// Every malformed scenario, through every command that reads one: status 2,
/// a message on standard error, nothing on standard output, nothing written.
#[test]
fn malformed_scenarios_end_with_status_2_and_write_nothing() {
    let malformed = fixture("malformed");
    let mut seen = 0;
    for entry in std::fs::read_dir(&malformed).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        seen += 1;
        let folder = tempfile::tempdir().unwrap();
        let name = path.display().to_string();
        let command = ["simulate", "check", "law", "modes"][seen % 4];
        let output = asperity(folder.path(), &[command, &name]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command} {name}: {message}");
        assert!(!message.trim().is_empty() && !message.contains("panicked"), "{name}: {message}");
        assert!(output.stdout.is_empty(), "{name}");
        assert!(files(folder.path()).is_empty(), "{name} left {:?}", files(folder.path()));
    }
    assert!(seen >= 40, "only {seen} malformed scenarios");
}

#[test]
fn wrong_requests_end_with_status_2_and_say_what_is_accepted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("full")).unwrap();
    std::fs::write(folder.path().join("full/thesis.tex"), "x").unwrap();
    let rig = rig();
    let cases: [(&[&str], &str); 9] = [
        (&["simulate", "nowhere.json"], "there is no such file"),
        (&["simulate", "full"], "directory"),
        (&["simulate", &rig, "--set", "/excitation/peak_n"], "POINTER=VALUE"),
        (&["simulate", &rig, "--set", "/excitation/peek_n=3"], "peak_n"),
        (&["simulate", &rig, "--set", "/method/courant=1.2"], "/method/courant"),
        (&["simulate", &rig, "--out", "full"], "--overwrite"),
        (&["sweep", &rig, "--vary", "/excitation/peak_n=1:2"], "start:stop:count"),
        (&["sweep", &rig, "--vary", "/duration_s=1:-1:2"], "/duration_s"),
        (&["sweep", &rig, "--vary", "/gravity_m_per_s2=1,2", "--threads", "0"], "threads"),
    ];
    for (arguments, expected) in cases {
        let output = asperity(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert_eq!(files(folder.path()), ["full"]);
    assert_eq!(files(&folder.path().join("full")), ["thesis.tex"]);
}

/// `--force` is the older name of `--overwrite`.
#[test]
fn folders_with_other_files_are_overwritten_on_request() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.tex"), "x").unwrap();
    let rig = rig();
    for option in ["--overwrite", "--force"] {
        let output = asperity(folder.path(), &["law", &rig, "--out", ".", option]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        std::fs::remove_file(folder.path().join("law.json")).unwrap();
    }
}

/// At `-v` every stage of a run is logged with its times; with `--log-format json` one object a
/// line.
#[test]
fn stages_are_logged_with_their_times() {
    let folder = tempfile::tempdir().unwrap();
    let rig = rig();
    let run = |options: &[&str]| {
        let output = asperity(folder.path(), &[&["simulate", &rig], &QUICK[..], options].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let stages = ["read", "draw", "write"];
    let log = run(&["-v"]);
    for stage in stages {
        let logged = |line: &str| line.contains(stage) && line.contains("time.busy=");
        assert!(log.lines().any(logged), "{stage} in {log}");
    }
    let log = run(&["-v", "--log-format", "json"]);
    let events: Vec<serde_json::Value> =
        log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for stage in stages {
        let closed = |event: &serde_json::Value| {
            event["span"]["name"] == stage && event["time.busy"].is_string()
        };
        assert!(events.iter().any(closed), "{stage} in {log}");
    }
    assert_eq!(run(&["--log-format", "json"]), "");
}

/// A law that no weight holds closed has no equilibrium: the scenario is valid, the run fails.
#[test]
fn a_run_that_fails_ends_with_status_1_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let rig = rig();
    let arguments = [
        &["simulate", &rig, "--set", "/gravity_m_per_s2=0"][..],
        &["--set", "/interfaces/0/law=pl", "--set", "/interfaces/1/law=pl"],
        &QUICK[..],
    ]
    .concat();
    let output = asperity(folder.path(), &arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("guide-sample"), "{message}");
    assert!(files(folder.path()).is_empty());
}

/// Every scenario that is shipped as an example runs.
#[test]
fn every_example_scenario_runs() {
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(fixture("scenarios")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let name = path.display().to_string();
            let coarse = r#"/method={"kind": "finite_difference", "cell_m": 0.005}"#;
            let arguments = ["simulate", &name, "--quiet", "--set", coarse];
            let output = asperity(folder.path(), &arguments);
            assert!(output.status.success(), "{name}: {}", text(&output.stderr));
            assert!(output.stdout.is_empty());
        }
    }
}

/// The names that `steady` writes, and its numbers beside time integration.
#[test]
fn steady_writes_the_files_and_columns_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = rig();
    let range =
        ["--amplitude", "0.2,0.6", "--from", "800", "--to", "950", "--backbone", "--verify"];
    let arguments =
        [&["steady", &scenario, "--json", "--out", "here"], &range[..], &QUICK[..]].concat();
    let output = asperity(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let out = folder.path().join("here");
    let expected = ["backbone.csv", "report.html", "steady.csv", "steady.svg", "summary.json"];
    assert_eq!(files(&out), expected);
    let columns = header(&out.join("steady.csv"));
    assert!(columns.starts_with("branch,point,force_n,frequency_hz,amplitude_1_m,amplitude_2_m,"));
    assert!(columns.ends_with(
        ",phase_1_rad,guide-sample:pressure_min_pa,guide-sample:pressure_max_pa,\
         sample-disc:pressure_min_pa,sample-disc:pressure_max_pa,stable,contact_lost,truncation"
    ));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["schema"], "asperity/steady/1");
    for level in summary["levels"].as_array().unwrap() {
        assert_eq!(level["end"], "reached");
        // Cells of 5 mm, extrapolated.
        assert!(level["verify"]["relative_difference"].as_f64().unwrap() < 1e-3, "{level}");
    }
}

/// A branch whose pressures leave the points of a table law says so; one within them does not.
#[test]
fn steady_warns_of_pressures_outside_the_measured_range() {
    let folder = tempfile::tempdir().unwrap();
    let law = r#"/laws/modified={"kind": "table", "points": [[1.3e5, 9e11], [1.45e5, 1e12]]}"#;
    let range = ["--amplitude", "0.02,0.2", "--from", "850", "--to", "900", "--harmonics", "3"];
    let scenario = rig();
    let arguments = [&["steady", &scenario, "--json", "--set", law], &range[..]].concat();
    let output = asperity(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["levels"][0]["warnings"], serde_json::json!([]));
    let warning = &summary["levels"][1]["warnings"][0];
    assert_eq!(warning["kind"], "outside_measured_range");
    assert!(warning["pressure_min_pa"].as_f64().unwrap() < 1.3e5, "{warning}");
}

/// No amplitude, a range of no length and a force of nothing are wrong requests.
#[test]
fn steady_requests_without_sense_exit_with_two() {
    let folder = tempfile::tempdir().unwrap();
    for range in [
        ["--amplitude", "0", "--from", "800", "--to", "950"],
        ["--amplitude", "1", "--from", "800", "--to", "800"],
        ["--amplitude", "NaN", "--from", "800", "--to", "900"],
    ] {
        let output = asperity(folder.path(), &[&["steady", &rig()], &range[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert!(files(&folder.path().join("out")).is_empty());
    }
}
