//! One hit as displacement, velocity and acceleration.

use std::f64::consts::TAU;

use asperity_measure::Format;

use super::exact::{Signals, blows, record};
use super::hammer::{DAMPING, MASS, NATURAL_HZ, channel};
use super::store;
use crate::{answer, asperity, number, text};

/// File, unit, what a metre (per second) is in it, place of the signal, and the measured form.
const MOTIONS: [(&str, &str, f64, usize, &str); 3] = [
    ("displacement", "um", 1e6, 1, "receptance"),
    ("velocity", "mm/s", 1e3, 2, "mobility"),
    ("acceleration", "m/s^2", 1.0, 3, "accelerance"),
];

fn write_all(folder: &std::path::Path, signals: &Signals) {
    for (name, unit, scale, place, _) in MOTIONS {
        let record = record(&signals[0], "laser", unit, &signals[place], scale);
        store(folder, &format!("{name}.uff"), record, Format::UniversalBinary);
    }
}

/// Verified against the mode itself, from three files in three units: the receptance's peak,
/// `1 / (2 m zeta w0^2 (1 - zeta^2)^(1/2))` high. The rectangle rule leaves `|z dt|^4 / 240` with
/// `z = 2 / rise + i w` (4e-5 here) of the magnitude, and less of what is along the curve.
#[test]
fn three_motions_have_one_receptance() {
    let folder = tempfile::tempdir().unwrap();
    write_all(folder.path(), &blows(DAMPING, &[10.0, 25.0]));
    let root = (1.0 - DAMPING * DAMPING).sqrt();
    let top = NATURAL_HZ * (1.0 - 2.0 * DAMPING * DAMPING).sqrt();
    let height = 1.0 / (2.0 * MASS * DAMPING * (TAU * NATURAL_HZ).powi(2) * root);
    for (name, unit, _, _, measured) in MOTIONS {
        let file = format!("{name}.uff");
        let found =
            answer(folder.path(), &["analyse", &file, "--json", "--out", "a", "--overwrite"]);
        assert_eq!(found["channels"][1]["unit"], unit);
        assert_eq!(found["channels"][1]["quantity"], name);
        assert_eq!(found["settings"]["measured_form"], measured);
        assert_eq!(found["settings"]["feature_form"], "receptance");
        assert_eq!(found["settings"]["frf_form"], "receptance");
        for hit in found["hits"].as_array().unwrap() {
            let first = |key: &str| number(hit, &format!("/fundamental/{key}"));
            assert!((first("frequency_hz") / top - 1.0).abs() < 1e-6, "{name} {hit}");
            assert!((first("magnitude") / height - 1.0).abs() < 5e-5, "{name} {hit}");
            for ratio in ["damping_ratio", "damping_ratio_circle"] {
                assert!((first(ratio) / DAMPING - 1.0).abs() < 1e-4, "{name} {ratio} {hit}");
            }
            // A linear mode has no second harmonic, by any route.
            assert!(hit["second_harmonic"].is_null() && hit["harmonic_ratio"].is_null());
        }
        // The backbone's amplitudes are displacements. A blow of this length gives 0.42 of what its
        // impulse would in no time, and some 11 cycles, which halve it, are under the filter's edge.
        let backbone = std::fs::read_to_string(folder.path().join("a/backbone.csv")).unwrap();
        let amplitude = |line: &str| line.split(',').nth(3).unwrap().parse::<f64>().unwrap();
        let largest = backbone.lines().skip(1).map(amplitude).fold(0.0, f64::max);
        // Impulse over mass and frequency: 25 N, e^2 / 4 rise, 1.6 kg, 5221 rad/s.
        let impulse = 25.0 * 2.0_f64.exp() / 4.0 * 3.4e-4;
        let most = impulse / (MASS * TAU * NATURAL_HZ);
        assert!(largest > 0.15 * most && largest < 0.42 * most, "{name} {largest:e} {most:e}");
        std::fs::remove_dir_all(folder.path().join("a")).unwrap();
    }
}

/// Displacement, velocity and acceleration in one file: an option chooses one; without it the
/// error lists them.
#[test]
fn a_velocity_is_chosen_by_its_word() {
    let folder = tempfile::tempdir().unwrap();
    let signals = blows(DAMPING, &[20.0]);
    let mut all = record(&signals[0], "acc", "m/s^2", &signals[3], 1.0);
    all.channels.push(channel("vib", "m/s", signals[2].clone()));
    store(folder.path(), "all.uff", all, Format::UniversalBinary);
    let refused = asperity(folder.path(), &["analyse", "all.uff"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("#3 `vib` (velocity, m/s)"), "{refused:?}");
    let asked = ["analyse", "all.uff", "--response", "velocity", "--json"];
    let found = answer(folder.path(), &asked);
    assert_eq!(found["channels"][1]["name"], "vib");
    assert_eq!(found["channels"][1]["si_unit"], "m/s");
}
