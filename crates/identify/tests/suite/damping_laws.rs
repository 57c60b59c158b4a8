//! Numbers of damping as parameters of an identification.

use crate::losses::{KINDS, LIGHT, Observed};
use crate::twin::{Sensors, Truth};
use asperity_experiment::{
    AnalysisOptions, DecayOptions, FrequencyBand, ResponseChoice, analyse, analyse_decays,
};
use asperity_identify::{Identification, IdentificationProblem, identify};
use asperity_measure::{Format, WriteOptions, write};
use asperity_scenario::Document;
use asperity_simulation::record::measurement_record;
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

/// Rate of records \[Hz\].
const RATE: f64 = 50_000.0;

const SCENARIO: &str = "../../fixtures/scenarios/nouira2020-modified.json";

/// Retardation time of the contacts \[s\].
const TIME_S: f64 = 6e-6;

/// Hits by finite differences on a rig with damped contacts, identification by the modal engine: the
/// retardation time of both contacts is found within its band, and its derivatives are exact. Damping
/// of the bodies instead explains the data less well.
#[test]
fn the_retardation_time_of_contacts_is_identified() {
    let damping = json!({"kind": "kelvin_voigt", "time_s": TIME_S}).to_string();
    let changes = [
        ("/output_rate_hz", "50000"),
        ("/duration_s", "0.06"),
        ("/damping/ratio", "0.01"),
        ("/interfaces/0/damping", damping.as_str()),
        ("/interfaces/1/damping", damping.as_str()),
    ];
    let twin = Truth::new(SCENARIO, &[9.0, 20.0, 32.0], &changes);
    let sensors =
        Sensors { signal_to_noise_db: 50.0, force_gain: 1.0, response_gain: 1.0, seed: 11 };
    let unknowns = json!([
        {"kind": "scalar", "pointer": "/interfaces/0/damping/time_s",
         "also": ["/interfaces/1/damping/time_s"], "bounds": [1e-7, 1e-4], "start": 2e-6},
    ]);
    let none = json!({"kind": "kelvin_voigt", "time_s": 0.0});
    let more = json!({
        "draws": 100,
        "starts": 1,
        "compare": [{
            "name": "damped bodies",
            "set": {"/interfaces/0/damping": none, "/interfaces/1/damping": none},
            "unknowns": [{"kind": "scalar", "pointer": "/damping/ratio", "bounds": [1e-3, 0.2]}],
        }],
    });
    let found = identify(&twin.problem(&twin.measured(&sensors), &unknowns, &more)).unwrap();
    let time = &found.estimates()[0];
    let [low, high] = time.posterior_interval;
    assert!((low..=high).contains(&TIME_S) && high < 1.1 * low, "{time:?}");
    assert!(found.linearisation.exact);
    let off = found.linearisation.derivative_difference.unwrap();
    assert!(off < 1e-3, "{off}");
    assert!(found.explains() && found.has_converged(), "{:?}", found.conclusions());
    let comparison = found.comparison.as_ref().unwrap();
    assert_eq!(comparison.best, 0, "{:?}", found.conclusions());
    assert_eq!(comparison.candidates[0].name, "the problem's scenario");
    assert_eq!(comparison.candidates[1].name, "damped bodies");
}

/// Largest deviations of measured from predicted frequencies and damping ratios of a result, over the
/// predicted ones, the number of points, and the largest over the smallest measured frequency.
fn deviations(found: &Identification) -> ([f64; 2], usize, f64) {
    let table = found.data_table().to_csv();
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (feature, value, predicted) = (place("feature"), place("value"), place("predicted"));
    let (mut off, mut points, mut range) = ([0.0_f64; 2], 0, [f64::INFINITY, 0.0_f64]);
    for row in rows {
        let number = |place: usize| row[place].parse::<f64>().ok();
        // Where one backbone ends before the other there is no prediction.
        let (Some(value), Some(predicted)) = (number(value), number(predicted)) else { continue };
        let of_damping = row[feature].contains("damping");
        let own = &mut off[usize::from(of_damping)];
        *own = own.max((value / predicted - 1.0).abs());
        if !of_damping {
            points += 1;
            range = [range[0].min(value), range[1].max(value)];
        }
    }
    (off, points, range[1] / range[0])
}

/// A twin without noise: accelerations of a hit by finite differences, analysed as measured ones by
/// `analyse` and by `decay`, against displacements of the modal engine. For each kind of loss, and where
/// the frequency changes by 5 to 12 %, frequencies at equal amplitudes agree to 2e-4 (4e-4 from another
/// force) and damping ratios to 0.7 %; the number of the loss is found. (Decay rates of the acceleration
/// were 4 to 6 % off.)
#[test]
fn measured_and_predicted_backbones_agree() {
    for kind in KINDS {
        let (changes, pointers) = LIGHT.changes(kind, 1.0);
        let mut document = Document::read(SCENARIO).unwrap();
        let more = [("/duration_s", json!(0.1)), ("/output_rate_hz", json!(RATE))];
        for (pointer, value) in changes.into_iter().chain(more) {
            document.set(pointer, &value.to_string()).unwrap();
        }
        document.set("/method", r#"{"kind": "modal"}"#).unwrap();
        let scenario = document.value().clone();
        let truth = scenario.pointer(pointers[0]).and_then(Value::as_f64).unwrap();
        document.set("/method", r#"{"kind": "finite_difference", "cell_m": 0.001}"#).unwrap();
        let run = simulate(&document, &document.scenario().unwrap()).unwrap();
        let record = measurement_record(&run, None);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hit.uff");
        let options = WriteOptions::default();
        write(&path, std::slice::from_ref(&record), Format::UniversalBinary, &options).unwrap();
        let band = FrequencyBand { low_hz: 600.0, high_hz: 1100.0 };
        let responses = vec!["acceleration".into()];
        let options = AnalysisOptions {
            responses: ResponseChoice::of(&responses),
            band_hz: Some(band),
            ..AnalysisOptions::default()
        };
        let hits = analyse(std::slice::from_ref(&path), &options).unwrap();
        let options = DecayOptions { responses, bands_hz: vec![band], ..DecayOptions::default() };
        let decays = analyse_decays(std::slice::from_ref(&path), &options).unwrap();
        // `decay` is without a force and begins at larger amplitudes: a stronger hit reaches them.
        for (name, table, peak, tolerance) in [
            ("analyse", hits.responses[0].backbone_table().to_csv(), 32, 2e-4),
            ("decay", decays.backbone_table().to_csv(), 45, 4e-4),
        ] {
            // The pipelines differ in the same way for every kind of loss.
            if name == "decay" && kind != "bodies" {
                continue;
            }
            std::fs::write(folder.path().join("backbone.csv"), table).unwrap();
            let problem = json!({
                "schema": "asperity/identify/1", "scenario": scenario,
                "unknowns": [crate::losses::unknown(kind)],
                "data": [{"kind": "backbone", "file": "backbone.csv", "index": 1,
                          "hit": {"force_peak_n": peak}, "spread": {"relative": 1e-4}, "damping_spread": {"relative": 0.01}}],
                "draws": 100, "starts": 1,
            });
            let path = folder.path().join("problem.json");
            let document = Document::parse(&problem.to_string(), path).unwrap();
            let found = identify(&IdentificationProblem::of(document).unwrap().fast()).unwrap();
            let ([frequency, ratio], points, range) = deviations(&found);
            let size = found.fit.point[0] / truth;
            let text =
                format!("{kind}, {name}: {frequency:e}, {ratio:e}, {points}, {range}, {size}");
            assert!(points > 8 && range > 1.02, "{text}");
            assert!(frequency < tolerance && ratio < 7e-3 && (size - 1.0).abs() < 1e-2, "{text}");
        }
    }
}

/// Hits with each kind of loss, 40 dB of noise, compared by frequency and damping along their decays: no
/// right kind is rejected, and friction is told from viscous losses; bodies and contacts may be left
/// undecided. (The example `damping_kinds` counts more.)
#[test]
fn friction_is_told_from_viscous_losses_by_backbones() {
    for kind in ["bodies", "friction"] {
        let (truth, _) = LIGHT.truth(kind, 1);
        let measured = LIGHT.comparison(&truth, Observed::Backbones, 1).unwrap();
        let found = identify(&measured.problem).unwrap();
        let comparison = found.comparison.as_ref().unwrap();
        let words = found.conclusions();
        for (name, candidate) in KINDS.iter().zip(&comparison.candidates) {
            assert_eq!(candidate.name, *name);
            let rejected = candidate.assessment.is_rejected();
            if *name == kind {
                assert!(!rejected, "{kind}: {words:?}");
            } else if (*name == "friction") != (kind == "friction") {
                assert!(rejected, "{kind}, {name}: {words:?}");
            }
        }
    }
}

/// The coefficient of friction beside an unknown damping ratio of the bodies: within its band, by exact
/// derivatives.
#[test]
fn the_coefficient_of_friction_is_identified() {
    let (truth, size) = LIGHT.truth("friction", 3);
    let found = identify(&LIGHT.friction(&truth, Observed::All, 3).unwrap().problem).unwrap();
    let mu = &found.estimates()[0];
    let [low, high] = mu.posterior_interval;
    assert!((low..=high).contains(&(0.003 * size)) && high < 1.2 * low, "{size}: {mu:?}");
    assert!(found.linearisation.exact);
    // Differences are noisy where the motion sticks or slips; the profile does not use derivatives.
    let [Some(below), Some(above)] = mu.profile_interval else { panic!("{mu:?}") };
    let half_width = 1.96 * mu.standard_deviation;
    assert!((0.5 * (above - below) / half_width - 1.0).abs() < 0.1, "{mu:?}");
    assert!(found.explains() && found.has_converged(), "{:?}", found.conclusions());
}
