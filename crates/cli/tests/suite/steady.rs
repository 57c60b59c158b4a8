//! Answers of `steady`: peaks, ends of branches, special points, columns.

use std::path::Path;

use serde_json::Value;

use crate::{asperity, fixture, text};

fn rig() -> String {
    fixture("scenarios/nouira2020-modified.json").display().to_string()
}

/// Standard output of a successful run on the rig into `out`.
fn answer(folder: &Path, options: &[&str]) -> String {
    let rig = rig();
    let arguments = [&["steady", &rig, "--out", "out", "--overwrite"], options].concat();
    let output = asperity(folder, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

fn summary(folder: &Path) -> Value {
    let written = std::fs::read_to_string(folder.join("out/summary.json")).unwrap();
    serde_json::from_str(&written).unwrap()
}

/// A branch that ends before its peak has none: the answer gives the place and the reason, the part from the other end
/// of the range, and a request that may help; the figure marks the end.
#[test]
fn a_branch_that_does_not_complete_has_no_peak() {
    let folder = tempfile::tempdir().unwrap();
    let range = ["--amplitude", "100", "--from", "1100", "--to", "700", "--harmonics", "20"];
    let printed = answer(folder.path(), &[&range[..], &["--bodies", "elastic"]].concat());
    let level = &summary(folder.path())["levels"][0];
    assert_eq!(level["end"], "returned", "{level}");
    assert_eq!(level["peak_is_inside"], false);
    assert_eq!(level["stable_peak_frequency_hz"], Value::Null);
    assert_eq!(level["ranges_without_stable_hz"], serde_json::json!([[700.0, 1100.0]]));
    assert_eq!(level["motions"].as_array().unwrap().len(), 5);
    for part in [
        "no peak",
        "turns back",
        "another part of the branch, from 700.000 Hz on",
        "time integration at 740.000 Hz",
    ] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    let figure = std::fs::read_to_string(folder.path().join("out/steady.svg")).unwrap();
    assert!(figure.contains("end of the branch"));
}

/// A block whose resonance leans over the start of the range has two parts: the level has the one that covers the range,
/// and the other, which begins and ends at the start, follows with a number of its own.
#[test]
fn both_parts_of_a_branch_are_followed() {
    let folder = tempfile::tempdir().unwrap();
    let block = concat!(env!("CARGO_MANIFEST_DIR"), "/../simulation/examples/block.json");
    let range = ["--amplitude", "0.2,2", "--from", "1200", "--to", "1900"];
    let run = [&["steady", block, "--out", "out"], &range[..]].concat();
    let output = asperity(folder.path(), &run);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found = summary(folder.path());
    let (levels, others) = (&found["levels"], found["other_parts"].as_array().unwrap());
    assert_eq!((levels[0]["end"].as_str(), others.len()), (Some("reached"), 1), "{found}");
    let (level, other) = (&levels[1], &others[0]);
    let ends = |part: &Value| {
        ["start_frequency_hz", "end_frequency_hz"].map(|key| part[key].as_f64().unwrap())
    };
    assert_eq!((level["end"].as_str(), ends(level)), (Some("reached"), [1900.0, 1200.0]));
    assert_eq!((other["end"].as_str(), ends(other)[0]), (Some("returned"), 1200.0));
    assert_eq!(other["force_n"], 2.0);
    // The part from the start turns at a fold; both have the range in which no response is stable, here none.
    let fold = other["bifurcations"].as_array().unwrap().iter().find(|one| one["kind"] == "fold");
    assert!((1380.0..1410.0).contains(&fold.unwrap()["frequency_hz"].as_f64().unwrap()));
    for part in [level, other] {
        assert_eq!(part["ranges_without_stable_hz"], serde_json::json!([]));
    }
    let printed = text(&output.stdout);
    assert!(printed.contains("2 N   another part of the branch, from 1200.000 Hz on"), "{printed}");
    let table = std::fs::read_to_string(folder.path().join("out/steady.csv")).unwrap();
    let rows = |branch: &str| table.lines().filter(|row| row.starts_with(branch)).count();
    assert_eq!(rows("2,") as u64, level["points"].as_u64().unwrap());
    assert_eq!(rows("3,") as u64, other["points"].as_u64().unwrap());
    // Both have the colour of their force, which the legend names once.
    let figure = std::fs::read_to_string(folder.path().join("out/steady.svg")).unwrap();
    assert_eq!(figure.matches(">2 N<").count(), 1, "{figure}");
}

/// A sample condensed where contact is lost is named with the reason; pressures
/// are those of both contacts.
#[test]
fn condensed_bodies_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let law = ["--set", "/interfaces/0/law=pl", "--set", "/interfaces/1/law=pl"];
    let range = ["--amplitude", "2", "--from", "1054", "--to", "700"];
    let printed = answer(folder.path(), &[&law[..], &range[..]].concat());
    let level = &summary(folder.path())["levels"][0];
    assert_eq!(level["end"], "reached", "{level}");
    assert_eq!(level["condensed_bodies"][0]["name"], "sample");
    let because = &level["condensed_because"];
    assert_eq!(because["kind"], "contact_lost");
    let hz = format!(
        "contact is lost from about {:.0} Hz on with it",
        because["from_hz"].as_f64().unwrap()
    );
    for part in ["   peak ", "inertia left out: sample (", &hz] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    let figure = std::fs::read_to_string(folder.path().join("out/steady.svg")).unwrap();
    assert!(figure.contains("contact lost"));
    let table = std::fs::read_to_string(folder.path().join("out/steady.csv")).unwrap();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row: Vec<&str> = lines.next().unwrap().split(',').collect();
    let cell = |name: &str| {
        row[header.iter().position(|one| *one == name).unwrap()].parse::<f64>().unwrap()
    };
    let sample = 2710.0 * 0.015 * 9.81;
    let apart = cell("sample-disc:pressure_min_pa") - cell("guide-sample:pressure_min_pa");
    assert!((apart - sample).abs() < 1e-3, "{apart}");
    let output = asperity(
        folder.path(),
        &[
            "steady",
            &rig(),
            "--bodies",
            "condensed",
            "--amplitude",
            "1",
            "--from",
            "9",
            "--to",
            "5e3",
        ],
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("no body can be condensed"));
}

/// A stepped sine in time is printed with its jump and written, in both directions.
#[test]
fn stepped_sines_in_time_are_printed_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let range = ["--amplitude", "1", "--from", "810", "--to", "780", "--harmonics", "8"];
    let sweep = ["--sweep", "both", "--sweep-points", "13"];
    let printed = answer(folder.path(), &[&range[..], &sweep].concat());
    let found = summary(folder.path());
    let sweeps = found["time_sweeps"].as_array().unwrap();
    assert_eq!(sweeps.len(), 2);
    for (sweep, direction) in sweeps.iter().zip(["up", "down"]) {
        assert_eq!((&sweep["direction"], &sweep["frequencies"]), (&direction.into(), &13.into()));
        let jump = &sweep["jumps_hz"][0];
        let [a, b] = [0, 1].map(|end| jump[end].as_f64().unwrap());
        let words = format!("stepped sine {direction} by time integration");
        assert!(printed.contains(&words), "{printed}");
        let words = format!("jumps between {a:.3} and {b:.3} Hz");
        assert!(printed.contains(&words), "{printed}");
    }
    let table = std::fs::read_to_string(folder.path().join("out/steady_time.csv")).unwrap();
    assert_eq!(table.lines().count(), 27);
    let figure = std::fs::read_to_string(folder.path().join("out/steady.svg")).unwrap();
    assert!(figure.contains("time integration, down"));
    let wrong = ["steady", &rig(), "--sweep", "up", "--sweep-points", "1"];
    let output = asperity(folder.path(), &[&wrong[..], &range].concat());
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
}

/// A branch highest at its end has no peak in the range.
#[test]
fn the_end_of_the_range_is_no_peak() {
    let folder = tempfile::tempdir().unwrap();
    let range = ["--amplitude", "0.2", "--from", "1100", "--to", "950", "--harmonics", "5"];
    let printed = answer(folder.path(), &range);
    assert!(printed.contains("no peak in the range; largest at its end   950.000 Hz"), "{printed}");
    assert!(printed.contains("try a wider range"), "{printed}");
    assert_eq!(summary(folder.path())["levels"][0]["peak_is_inside"], false);
}

/// One harmonic, which puts the peak 44 Hz too low, does not suffice: the answer says so, and so does the table.
#[test]
fn too_few_harmonics_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-power.json").display().to_string();
    let mut peaks = Vec::new();
    for (harmonics, suffice) in [("1", false), ("9", true)] {
        let range = ["--amplitude", "2", "--from", "1000", "--to", "700", "--harmonics", harmonics];
        let out = ["steady", &rig, "--out", "out", "--overwrite", "--bodies", "condensed"];
        let output = asperity(folder.path(), &[&out[..], &range].concat());
        let warned = text(&output.stderr).contains("may be wrong");
        let level = &summary(folder.path())["levels"][0];
        let kinds = level["warnings"].as_array().unwrap().iter();
        let is_listed = kinds.clone().any(|warning| warning["kind"] == "unresolved");
        assert_eq!([warned, is_listed], [!suffice; 2], "{level}");
        assert_eq!(level["peak_truncation"].as_f64().unwrap() <= 2e-3, suffice, "{level}");
        assert_eq!(level["peak_is_stable"], suffice, "{level}");
        assert_eq!(text(&output.stdout).contains("m   u2/u1 0.00000   unstable"), !suffice);
        peaks.push(level["peak_frequency_hz"].as_f64().unwrap());
        let table = std::fs::read_to_string(folder.path().join("out/steady.csv")).unwrap();
        let largest = table.lines().skip(1).map(|row| row.rsplit(',').next().unwrap());
        let largest = largest.map(|cell| cell.parse().unwrap()).fold(0.0, f64::max);
        assert_eq!(largest, level["truncation"].as_f64().unwrap());
    }
    assert!(peaks[1] - peaks[0] > 40.0, "{peaks:?}");
}

/// Folds and the unstable part between them are printed, written and drawn.
#[test]
fn folds_and_stability_are_printed_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let range = ["--amplitude", "1", "--from", "1000", "--to", "700", "--harmonics", "12"];
    let printed = answer(folder.path(), &range);
    let level = summary(folder.path())["levels"][0].clone();
    let found = level["bifurcations"].as_array().unwrap();
    assert!(found.len() == 2 && found.iter().all(|one| one["kind"] == "fold"), "{level}");
    let places = found.iter().map(|one| format!("{:.3}", one["frequency_hz"].as_f64().unwrap()));
    let places = places.collect::<Vec<_>>().join(", ");
    assert!(printed.contains(&format!("folds at {places} Hz")), "{printed}");
    let unstable = level["unstable_points"].as_u64().unwrap();
    assert!(unstable > 0 && printed.contains(&format!("unstable at {unstable} of")), "{printed}");
    assert!(printed.contains("   peak ") && !printed.contains("no peak"), "{printed}");
    let figure = std::fs::read_to_string(folder.path().join("out/steady.svg")).unwrap();
    assert!(figure.contains(">fold<") && !figure.contains("end of the branch"));
}

/// Harmonics below 1e-4 of the fundamental everywhere are no columns, however many were computed.
#[test]
fn harmonics_that_do_not_matter_are_not_columns() {
    let folder = tempfile::tempdir().unwrap();
    let range = ["--from", "1000", "--to", "800", "--harmonics", "20", "--quiet"];
    for (amplitude, few, many) in [("0.02", 2, 3), ("0.5", 4, 10)] {
        answer(folder.path(), &[&["--amplitude", amplitude], &range[..]].concat());
        let table = std::fs::read_to_string(folder.path().join("out/steady.csv")).unwrap();
        let mut lines = table.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let places: Vec<usize> =
            (0..header.len()).filter(|&i| header[i].starts_with("amplitude_")).collect();
        assert!((few..=many).contains(&places.len()), "{amplitude} N: {header:?}");
        let largest = lines
            .map(|row| {
                let cell = |i: usize| row.split(',').nth(i).unwrap().parse::<f64>().unwrap();
                cell(places[places.len() - 1]) / cell(places[0])
            })
            .fold(0.0, f64::max);
        assert!(largest > 1e-4 || places.len() == 2, "{amplitude} N: {largest:.1e}");
    }
}

/// With friction in the guide the branch is complete and meets the integration in time; it is
/// stable, as without.
#[test]
fn a_branch_with_friction_meets_the_integration_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let friction = r#"/bodies/0/friction={"stiffness_n_per_m": 1e7, "coefficient": 0.02}"#;
    let range = ["--amplitude", "0.8", "--from", "820", "--to", "700", "--harmonics", "8"];
    let printed = answer(folder.path(), &[&range[..], &["--verify", "--set", friction]].concat());
    assert!(printed.contains("stable"), "{printed}");
    let level = &summary(folder.path())["levels"][0];
    assert_eq!(level["end"], "reached", "{level}");
    assert_eq!(level["unstable_points"], 0);
    assert_eq!(level["stability_unknown"], Value::Null);
    assert_eq!(level["verify"]["motion"], "periodic", "{level}");
    assert!(level["verify"]["relative_difference"].as_f64().unwrap() < 5e-3, "{level}");
    let without = answer(folder.path(), &range);
    assert!(without.contains("stable"), "{without}");
}
