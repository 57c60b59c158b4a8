//! Requests beyond the bounds of time and memory, refused before any work, and numbers at the ends of
//! their range.

use crate::{asperity, files, fixture, text};

/// A rig on a compliant disc, with finite differences.
const COMPLIANT: &str = r#"/support={"kind": "spring_mass", "stiffness_n_per_m": 1e9, "mass_kg": 2, "damping_ratio": 0.02}"#;
const FINITE_DIFFERENCE: &str = "/method=finite_difference";

/// Requests of every command: options after the scenario, and what the message contains.
#[test]
fn requests_beyond_the_bounds_end_with_status_2_and_tell_number_and_limit() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let amplitudes = vec!["1"; 1001].join(",");
    let steady = ["--from", "700", "--to", "900"];
    let cases: [(&str, Vec<&str>, [&str; 2]); 15] = [
        ("simulate", vec!["--set=/output_rate_hz=1e9"], ["1.2e8 samples", "at most 1e7"]),
        ("simulate", vec!["--set=/support/mass_kg=1e-30"], ["time steps", "2e10 steps"]),
        ("check", vec!["--set=/support/stiffness_n_per_m=1e24"], ["time steps", "2e10 steps"]),
        ("check", vec!["--set=/support/stiffness_n_per_m=1e100"], ["time steps", "2e10 steps"]),
        ("modes", vec!["--set=/support/stiffness_n_per_m=1.7e308"], ["time steps", "2e10 steps"]),
        ("simulate", vec!["--set=/support/stiffness_n_per_m=1e23"], ["node updates", "1e12"]),
        ("simulate", vec!["--set=/bodies/1/density_kg_per_m3=1e-5"], ["node updates", "1e12"]),
        (
            "simulate",
            vec![r#"--set=/method={"kind": "modal", "step_s": 1e-9}"#],
            ["recorded", "2e8"],
        ),
        ("check", vec![r#"--set=/method={"kind": "modal", "step_s": 1e-9}"#], ["recorded", "2e8"]),
        ("sweep", vec!["--vary", "/excitation/peak_n=1:2:10000000"], ["1:2:10000000", "1000000"]),
        (
            "sweep",
            vec!["--vary", "/excitation/peak_n=1:2:1001", "--vary", "/gravity_m_per_s2=9:10:1000"],
            ["1001000 runs", "1000000"],
        ),
        (
            "sweep",
            vec!["--vary", "/excitation/peak_n=1:2:1000000", "--set=/method/cell_m=1e-4"],
            ["1000000 runs", "1e14"],
        ),
        ("steady", [&["--amplitude", &amplitudes], &steady[..]].concat(), ["1001", "1000"]),
        (
            "steady",
            [&["--amplitude", "1", "--harmonics", "401"], &steady[..]].concat(),
            ["401", "400"],
        ),
        ("modes", vec!["--count", "1001"], ["1001", "1000"]),
    ];
    for (command, options, expected) in cases {
        let mut arguments = vec![command, &rig, "--set", COMPLIANT, "--set", FINITE_DIFFERENCE];
        arguments.extend(options);
        let output = asperity(folder.path(), &arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(expected.iter().all(|word| message.contains(word)), "{arguments:?}: {message}");
    }
    assert!(files(folder.path()).is_empty());
}

/// Measurements whose axis has no rate that a sensor could have, and inputs that never end.
#[test]
fn measurements_that_cannot_be_analysed_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for step in [5e-324, 1e-300, 1e-18, 1e12] {
        let row = |n: i32| {
            let force = if (500..520).contains(&n) { 30 } else { 0 };
            format!("{:e},{force},{}\n", f64::from(n) * step, n % 13)
        };
        let rows: String = (0..4000).map(row).collect();
        let text_of_file = format!("time_s,force_N,acc_m_s2\n{rows}");
        std::fs::write(folder.path().join("hits.csv"), text_of_file).unwrap();
        let output = asperity(folder.path(), &["analyse", "hits.csv"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{step}: {message}");
        assert!(message.contains("rate"), "{step}: {message}");
    }
    if cfg!(unix) {
        for arguments in [&["analyse", "/dev/zero"][..], &["convert", "/dev/zero", "x.npz"]] {
            let output = asperity(folder.path(), arguments);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains("a regular file"), "{message}");
        }
    }
    assert_eq!(files(folder.path()), ["hits.csv"]);
}

#[test]
fn structures_of_very_many_parts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    for (change, expected) in [
        (format!("/laws={}", laws(1001)), "at most 1000 laws"),
        (format!("/bodies={}", bodies(1001)), "1 to 1000 items"),
    ] {
        let output = asperity(folder.path(), &["law", &rig, "--set", &change]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

/// Numbers that are in the bounds of their keys, and whose products or quotients leave the range of
/// double precision.
#[test]
fn degenerate_sizes_are_errors_of_the_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    for (change, quantity) in [
        ("/bodies/0/youngs_modulus_pa=5e-324", "wave speed"),
        ("/bodies/1/youngs_modulus_pa=5e-324", "wave speed"),
        ("/bodies/1/area_m2=1e300", "stiffness in N/m"),
        ("/bodies/0/density_kg_per_m3=5e-324", "section"),
        ("/support/mass_kg=5e-324", "natural frequency"),
    ] {
        for command in ["check", "simulate", "modes"] {
            let modulus = "/bodies/1/youngs_modulus_pa=1e12";
            let arguments = [command, &rig, "--set", COMPLIANT, "--set", modulus, "--set", change];
            let output = asperity(folder.path(), &arguments);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{change}: {message}");
            assert!(message.contains(quantity), "{change}: {message}");
        }
    }
}

/// A support of any stiffness is as stable as a rigid one, and so is a contact; where a body between contacts is so light that
/// stability cannot be integrated, the branch is given without it.
#[test]
fn steady_gives_no_stability_where_a_mode_is_too_fast_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let range = ["--amplitude", "0.1", "--from", "200", "--to", "210", "--harmonics", "1"];
    for (change, expected) in [
        ("/support/stiffness_n_per_m=1e300", "true"),
        (r#"/interfaces/0/law={"kind": "constant", "stiffness_pa_per_m": 1e25}"#, "true"),
        ("/bodies/1/density_kg_per_m3=1e-12", ""),
    ] {
        let arguments = [
            &["steady", &rig, "--out", "out", "--overwrite", "--set", COMPLIANT][..],
            &["--set", change, "--set", "/method=modal", "--quiet"],
            &range,
        ]
        .concat();
        let output = asperity(folder.path(), &arguments);
        assert!(output.status.success(), "{change}: {}", text(&output.stderr));
        let table = std::fs::read_to_string(folder.path().join("out/steady.csv")).unwrap();
        let column = table.lines().next().unwrap().split(',').position(|name| name == "stable");
        let stable: Vec<&str> =
            table.lines().skip(1).map(|row| row.split(',').nth(column.unwrap()).unwrap()).collect();
        assert!(!stable.is_empty() && stable.iter().all(|cell| *cell == expected), "{stable:?}");
    }
}

#[test]
fn modes_prints_no_number_that_it_could_not_compute() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    for change in [
        r#"/interfaces/0/law={"kind": "constant", "stiffness_pa_per_m": 1e-9}"#,
        "/interfaces/0/area_m2=1e-300",
        "/support/damping_ratio=1.7e308",
        "/damping/ratio=1.7e308",
    ] {
        let arguments = ["modes", &rig, "--out", "out", "--set", COMPLIANT, "--set", change];
        let output = asperity(folder.path(), &arguments);
        let answer = text(&output.stdout);
        assert!(!answer.contains("NaN") && !answer.contains("inf"), "{change}: {answer}");
        if !output.status.success() {
            assert!(!output.stderr.is_empty(), "{change}");
        }
    }
}

/// Laws whose names a spreadsheet would run, or a file system refuses, are written as text and under
/// names that are accepted.
#[test]
fn hostile_names_are_written_as_text_and_under_safe_names() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let law = r#"{"kind": "constant", "stiffness_pa_per_m": 1e12}"#;
    let laws = format!(
        "/laws={{\"=cmd\": {law}, \"exe\u{202e}gpj\": {law}, \"exe-GPJ\": {law}, \"constant\": {law}}}"
    );
    let output = asperity(folder.path(), &["law", &rig, "--out", "out", "--set", &laws]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let written = files(&folder.path().join("out"));
    for name in ["law-=cmd.csv", "law-exe-gpj.csv", "law-exe-GPJ-2.csv", "law-constant.csv"] {
        assert!(written.contains(&name.to_owned()), "{written:?}");
    }
    let arguments =
        ["simulate", &rig, "--quiet", "--out", "run", "--set", "/interfaces/0/name==1+2"];
    let output = asperity(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let table = std::fs::read_to_string(folder.path().join("run/history.csv")).unwrap();
    assert!(table.lines().next().unwrap().contains(",'=1+2:pressure_pa,"), "{table:.300}");
}

fn laws(count: usize) -> String {
    let law = r#"{"kind": "constant", "stiffness_pa_per_m": 1e12}"#;
    let laws: Vec<String> = (0..count).map(|number| format!("\"law {number}\": {law}")).collect();
    format!("{{{}}}", laws.join(","))
}

fn bodies(count: usize) -> String {
    let body = |number: usize| {
        format!(
            "{{\"name\": \"{number}\", \"length_m\": 0.1, \"area_m2\": 1e-4, \
             \"youngs_modulus_pa\": 7e10, \"density_kg_per_m3\": 2700}}"
        )
    };
    format!("[{}]", (0..count).map(body).collect::<Vec<_>>().join(","))
}
