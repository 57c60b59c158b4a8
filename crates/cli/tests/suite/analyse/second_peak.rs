//! The peak near twice the fundamental: harmonic or mode, and hits by force.

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use asperity_measure::{Format, Record};
use serde_json::Value;

use super::exact::noisy;
use super::hammer::{RATE, channel};
use super::store;
use crate::{answer, number};

/// Hits of half-sines of 1 ms on a linear structure of two modes, 2 % damped, half a second each;
/// noise of 60 dB on force and acceleration.
fn linear_record(second_hz: f64, forces: &[f64]) -> Record {
    const STEPS: usize = 16;
    let step = 1.0 / (RATE * STEPS as f64);
    let samples = (0.5 * RATE) as usize;
    let (mut force, mut acceleration) = (Vec::new(), Vec::new());
    for peak in forces {
        let mut modes = [(800.0, 1.6, 0.0, 0.0), (second_hz, 6.0, 0.0, 0.0)];
        for n in 0..samples * STEPS {
            let t = n as f64 * step - 0.02;
            let f = if (0.0..1e-3).contains(&t) { peak * (PI * t / 1e-3).sin() } else { 0.0 };
            let mut sum = 0.0;
            for (natural, mass, before, now) in &mut modes {
                let omega = TAU * *natural;
                let half = 0.02 * omega * step;
                let push = step * step * (f / *mass - omega * omega * *now);
                let next = (2.0 * *now - (1.0 - half) * *before + push) / (1.0 + half);
                sum += (next - 2.0 * *now + *before) / (step * step);
                (*before, *now) = (*now, next);
            }
            if n % STEPS == 0 {
                force.push(f);
                acceleration.push(sum);
            }
        }
    }
    let force = noisy(&force, 1e-3 * forces[0], 1);
    let acceleration = noisy(&acceleration, 0.5e-3 * forces[0], 2);
    let channels = vec![channel("hammer", "N", force), channel("top", "m/s^2", acceleration)];
    Record { channels, ..Record::default() }
}

fn analysed(second_hz: f64, forces: &[f64]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let record = linear_record(second_hz, forces);
    store(folder.path(), "test.uff", record, Format::UniversalBinary);
    answer(folder.path(), &["analyse", "test.uff", "--band", "700:900", "--json", "--out", "a"])
}

/// A mode of a linear structure is no second harmonic: at 1.65 of the fundamental it is no candidate,
/// at 1.75 and 1.95 the decay of equal hits tells, and hits of different forces tell too. No hit has a harmonic
/// ratio, and a linear structure does not change with force.
#[test]
fn a_mode_is_no_second_harmonic() {
    let equal = [20.0; 4];
    let found = analysed(1320.0, &equal);
    assert!(found["second_peak"].is_null(), "{}", found["second_peak"]);
    let levels = [6.0, 6.1, 12.0, 12.2, 24.0, 24.3];
    for (second_hz, forces, test) in [
        (1400.0, &equal[..], "decay"),
        (1560.0, &equal[..], "decay"),
        (1560.0, &levels[..], "force"),
    ] {
        let found = analysed(second_hz, forces);
        let second = &found["second_peak"];
        assert_eq!((&second["origin"], &second["decided_by"]), (&"mode".into(), &test.into()));
        assert!(second["sentence"].as_str().unwrap().contains("another mode"), "{second}");
        for hit in found["hits"].as_array().unwrap() {
            assert!(hit["harmonic_ratio"].is_null() && hit["second_harmonic"].is_null());
            assert!((number(hit, "/second_peak/frequency_hz") / second_hz - 1.0).abs() < 0.01);
        }
    }
    let found = analysed(1560.0, &levels);
    let groups = found["levels"].as_array().unwrap();
    let hits: Vec<&Value> = groups.iter().map(|level| &level["hits"]).collect();
    assert_eq!(serde_json::json!(hits), serde_json::json!([[1, 2], [3, 4], [5, 6]]));
    for level in groups {
        assert!(number(level, "/coherence") > 0.999, "{level}");
        assert!((number(level, "/damping_ratio/mean") / 0.02 - 1.0).abs() < 0.01, "{level}");
    }
    let sentence = found["conclusions"][0].as_str().unwrap();
    assert!(sentence.starts_with("f1 does not change with force"), "{sentence}");
}

/// Verified against the rig, whose contacts make a harmonic: over four forces the force decides, of
/// one hit the decay; the fundamental falls with force, in units of the scatter.
#[test]
fn the_second_harmonic_of_the_rig_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/scenarios");
    let rig = fixtures.join("nouira2020-modified.json").display().to_string();
    let mut records = Vec::new();
    for force in ["9", "14", "20", "32"] {
        let level = format!("/excitation/peak_n={force}");
        let options = ["--set", "/method/cell_m=0.005", "--set", &level, "--record", "uff"];
        answer(
            folder.path(),
            &[&["simulate", &rig, "--json", "--out", force], &options[..]].concat(),
        );
        records.push(format!("{force}/record.uff"));
    }
    let analysed = |files: &[String]| {
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let options = [
            "--response",
            "acceleration",
            "--band",
            "600:1000",
            "--out",
            "a",
            "--json",
            "--overwrite",
        ];
        answer(folder.path(), &[&["analyse"], &files[..], &options[..]].concat())
    };
    let found = analysed(&records);
    let second = &found["second_peak"];
    assert_eq!((&second["origin"], &second["decided_by"]), (&"harmonic".into(), &"force".into()));
    assert!(number(second, "/force_exponent") > 0.6, "{second}");
    let sentence = found["conclusions"][0].as_str().unwrap();
    assert!(sentence.starts_with("f1 falls 5.2"), "{sentence}");

    let found = analysed(&records[3..]);
    let second = &found["second_peak"];
    assert_eq!((&second["origin"], &second["decided_by"]), (&"harmonic".into(), &"decay".into()));
    let hit = &found["hits"][0];
    assert!((number(hit, "/second_peak/amplitude_exponent") - 2.0).abs() < 0.1);
    assert!(number(hit, "/second_peak/phase_drift_rad").abs() < 0.3);
    assert!(number(hit, "/harmonic_ratio") > 0.2);
}
