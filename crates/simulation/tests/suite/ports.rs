//! Loads and sensors at places of the document, in one run, in sweeps and in steady responses.

use std::f64::consts::TAU;

use asperity_scenario::Document;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::modes::linearised_modes;
use asperity_simulation::quantity::Quantity;
use asperity_simulation::record::{frf_columns, history_columns, measurement_record};
use asperity_simulation::run::{Run, receptance, simulate, transmissibility};
use asperity_simulation::steady::{BodyModel, SteadyRequest, steady, steady_table};
use asperity_simulation::sweep::{Variation, sweep};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios");

fn document(name: &str, changes: &[(&str, &str)]) -> Document {
    let mut document = Document::read(format!("{FOLDER}/{name}.json")).unwrap();
    for (pointer, value) in changes {
        document.set(pointer, value).unwrap();
    }
    document
}

fn run(document: &Document) -> Run {
    simulate(document, &document.scenario().unwrap()).unwrap()
}

/// A force at the lower end of the guide bar and sensors at three places.
fn hit(changes: &[(&str, &str)]) -> Document {
    let mut all = vec![
        ("/method", "modal"),
        ("/excitation/at", r#"{"body": "guide bar", "position_m": 0.15}"#),
        (
            "/sensors",
            r#"[{"name": "top", "kind": "acceleration"},
                {"name": "foot", "at": {"body": "sample", "end": "lower"}, "kind": "displacement"},
                {"name": "side", "at": {"body": "guide bar", "position_m": 0.05}, "kind": "velocity"}]"#,
        ),
    ];
    all.extend(changes);
    document("nouira2020-modified", &all)
}

#[test]
fn each_sensor_has_its_columns_and_features() {
    let run = run(&hit(&[]));
    let columns = history_columns(&run);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        "time_s",
        "force_n",
        "top:acceleration_m_per_s2",
        "foot:displacement_m",
        "side:velocity_m_per_s",
    ];
    assert_eq!(names[..5], expected);
    let record = measurement_record(&run, None);
    let names: Vec<&str> = record.channels.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["force", "top", "foot", "side"]);
    let frf = frf_columns(&run).unwrap().unwrap();
    let names: Vec<&str> = frf.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[..3], ["frequency_hz", "real_m_per_n", "imag_m_per_n"]);
    assert_eq!(names[5..7], ["foot:real_m_per_n", "foot:imag_m_per_n"]);
    let sensors = &run.summary.sensors;
    let first = run.summary.fundamental.unwrap();
    assert_eq!(sensors.len(), 3);
    assert_eq!(sensors[0].fundamental, Some(first));
    let amplitude = |n: usize| sensors[n].fundamental.unwrap().amplitude.value();
    // The foot of the sample moves by the lower contact alone, the side of the bar as its top.
    assert!(amplitude(1) < 0.7 * amplitude(0) && (amplitude(2) / amplitude(0) - 1.0).abs() < 0.05);
    for (number, sensor) in sensors.iter().enumerate() {
        let frequency = sensor.fundamental.unwrap().frequency_hz;
        assert!((frequency / first.frequency_hz - 1.0).abs() < 1e-2);
        let found = run.observables.at(number, Quantity::FundamentalFrequency);
        assert_eq!(found, Some(frequency));
    }
}

/// A row of a sweep has the numbers of a single run, at each sensor.
#[test]
fn a_sweep_has_the_features_of_each_sensor() {
    let found = sweep(&hit(&[]), &[Variation::parse("/excitation/peak_n=9,20").unwrap()]).unwrap();
    for (row, peak) in ["9", "20"].into_iter().enumerate() {
        let run = run(&hit(&[("/excitation/peak_n", peak)]));
        for (sensor, name) in [(1, "foot"), (2, "side")] {
            for (quantity, tolerance) in [
                (Quantity::FundamentalFrequency, 2e-6),
                (Quantity::FundamentalReceptance, 1e-4),
                (Quantity::HarmonicRatio, 5e-3),
            ] {
                let column = format!("{name}:{}", quantity.key());
                let swept = found.number(row, &column).unwrap();
                let single = run.observables.at(sensor, quantity).unwrap();
                assert!((swept / single - 1.0).abs() < tolerance, "{column}: {swept} {single}");
            }
        }
    }
}

/// Rows have the features that each sensor has alone, however many of its structure are integrated side by side.
#[test]
fn a_row_has_the_features_of_a_sensor_alone() {
    let forces = Variation::parse("/excitation/peak_n=9:10:8").unwrap();
    let features = |sensors: &str, columns: &[&str]| -> Vec<Vec<f64>> {
        let found = sweep(&hit(&[("/sensors", sensors)]), std::slice::from_ref(&forces)).unwrap();
        let row = |row| columns.iter().map(|column| found.number(row, column).unwrap()).collect();
        (0..8).map(row).collect()
    };
    let foot =
        r#"{"name": "foot", "at": {"body": "sample", "end": "lower"}, "kind": "displacement"}"#;
    let top = r#"{"name": "top", "kind": "acceleration"}"#;
    let receptance = "fundamental.receptance_m_per_n";
    let both = features(&format!("[{top}, {foot}]"), &[receptance, &format!("foot:{receptance}")]);
    let [top, foot] = [top, foot].map(|sensor| features(&format!("[{sensor}]"), &[receptance]));
    for (row, both) in both.iter().enumerate() {
        assert_eq!(both[..], [top[row][0], foot[row][0]], "row {row}");
        assert!(both[1] < 0.7 * both[0], "row {row}: {both:?}");
    }
}

/// Varying the place of the force moves the force: at the upper end it is the default.
#[test]
fn the_place_of_the_force_can_be_varied() {
    let document = hit(&[]);
    let vary = [Variation::parse("/excitation/at/position_m=0,0.1,0.229").unwrap()];
    let found = sweep(&document, &vary).unwrap();
    let amplitude = |row| found.number(row, "fundamental.receptance_m_per_n").unwrap();
    let swept: Vec<f64> = (0..3).map(amplitude).collect();
    let at_end = run(&hit(&[("/excitation/at", r#"{"body": "guide bar", "end": "upper"}"#)]));
    let default = at_end.summary.fundamental.unwrap().amplitude.value();
    assert!((swept[0] / default - 1.0).abs() < 1e-4);
    assert!(swept[0] != swept[1] && swept[1] != swept[2], "{swept:?}");
}

/// With a moving base, sensors read the absolute motion, and FRF and features are relative ones per
/// base acceleration.
#[test]
fn a_moving_base_gives_absolute_and_relative_motion() {
    let run = run(&document("shaken-base", &[]));
    let columns = history_columns(&run);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names[..6],
        [
            "time_s",
            "base_acceleration_m_per_s2",
            "block:acceleration_m_per_s2",
            "block:relative_acceleration_m_per_s2",
            "middle:velocity_m_per_s",
            "middle:relative_velocity_m_per_s"
        ]
    );
    for n in 0..columns[0].1.len() {
        let relative = columns[3].1[n];
        assert!((columns[2].1[n] - relative - columns[1].1[n]).abs() < 1e-12);
        let base = run.assembly.load.base_at(columns[0].1[n])[1];
        assert!((columns[4].1[n] - columns[5].1[n] - base).abs() < 1e-12);
    }
    let frf = receptance(&run, 0).unwrap().unwrap();
    let through = transmissibility(&frf, 1.0);
    assert!((through.values[1].norm() - 1.0).abs() < 1e-3, "the rig moves with a slow base");
    let columns = frf_columns(&run).unwrap().unwrap();
    assert_eq!(columns[1].0, "transmissibility_real");
    let value = serde_json::to_value(&run.summary).unwrap();
    assert!(value["fundamental"]["receptance_s2"].as_f64().unwrap() > 0.0);
    assert!(value["fundamental"].get("receptance_m_per_n").is_none());
}

/// Steady responses to a base motion and to a force along a body, against the modes' participations on
/// contacts that hardly bend.
#[test]
fn steady_responses_are_read_at_the_sensors() {
    for name in ["force", "base"] {
        let mut document = document("shaken-base", &[("/sensors/1/kind", "displacement")]);
        if name == "force" {
            let force = r#"{"kind": "half_sine", "peak_n": 5, "duration_s": 1e-3,
                            "at": {"body": "bar", "position_m": 0.03}}"#;
            document.set("/excitation", force).unwrap();
        }
        let assembly = Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap();
        let natural = assembly.structure.natural_frequency().unwrap();
        let request = SteadyRequest {
            amplitudes: vec![1e-4],
            from_hz: 0.8 * natural,
            to_hz: 1.2 * natural,
            harmonics: Some(3),
            backbone: false,
            verify: true,
            bodies: BodyModel::Auto,
            time_sweep: None,
        };
        let found = steady(&assembly, &request).unwrap();
        let modes = linearised_modes(&assembly, 30).unwrap().modes;
        let stack = assembly.structure.stack();
        let branch = found.levels[0].outcome.as_ref().unwrap();
        for point in &branch.points {
            let w = TAU * point.frequency_hz();
            for (number, sensor) in assembly.sensors.iter().enumerate() {
                let sum = modes.iter().map(|mode| {
                    let own = TAU * mode.frequency_hz;
                    let shapes = mode.participation(stack, assembly.load.port())
                        * mode.participation(stack, sensor.port);
                    let rate = 2.0 * mode.damping_ratio * own;
                    shapes / asperity_signal::Complex64::new(own * own - w * w, rate * w)
                });
                let exact = 1e-4 * sum.sum::<asperity_signal::Complex64>();
                let off = (point.at_sensor(number, 1) - exact).norm() / exact.norm();
                assert!(off < 2e-2, "{name}, sensor {number}: {off:e}");
            }
        }
        let check = found.levels[0].check.unwrap();
        assert!(check.relative_difference < 1e-2, "{name}: {check:?}");
        let table = steady_table(&found, &[]).to_csv();
        let header = table.lines().next().unwrap();
        let load = if name == "force" { "force_n" } else { "base_acceleration_m_per_s2" };
        assert!(header.contains(load) && header.contains("middle:amplitude_1_m"), "{header}");
        assert_eq!(header.contains("transmissibility_1"), name == "base");
    }
}
