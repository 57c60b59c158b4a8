//! Measured and predicted backbones of one motion: a twin without noise.

use asperity_experiment::{
    AnalysisOptions, DecayOptions, FrequencyBand, ResponseChoice, analyse, analyse_decays,
};
use asperity_inference::ForwardModel;
use asperity_measure::{Format, WriteOptions, write};
use asperity_scenario::Document;
use asperity_study::record::measurement_record;
use asperity_study::run::simulate;
use serde_json::{Value, json};

use super::{problem_of, scenario, starts};

/// Rate of the records \[Hz\].
const RATE: f64 = 50_000.0;

/// Largest differences of measured and predicted frequencies and damping ratios, over the predicted
/// ones, and the number of points.
#[derive(Debug)]
struct Apart {
    frequency: f64,
    ratio: f64,
    points: usize,
    /// Ratio of the largest to the smallest measured frequency.
    range: f64,
}

fn apart(scenario: &Value, folder: &std::path::Path, file: &str) -> Apart {
    let data = json!([{"kind": "backbone", "file": file, "hit": {"force_peak_n": 32},
                       "index": 1, "spread": {"relative": 1e-4}, "damping_spread": {"relative": 1e-2}}]);
    let unknowns =
        json!([{"kind": "scalar", "pointer": "/gravity_m_per_s2", "bounds": [9.0, 10.0]}]);
    let problem = problem_of(scenario, &unknowns, &data, &folder.join("problem.json"));
    let mut model = problem.model().unwrap().forward;
    model.hold(&model.controlled(&starts(&model)).unwrap());
    let predicted = model.predict(&[starts(&model)]).remove(0).unwrap();
    let mut apart = Apart { frequency: 0.0, ratio: 0.0, points: 0, range: 1.0 };
    let mut range = [f64::INFINITY, 0.0_f64];
    for (observation, predicted) in model.observations().iter().zip(predicted) {
        // Where one backbone ends before the other there is no prediction.
        let Some(predicted) = predicted else { continue };
        let off = (observation.value / predicted - 1.0).abs();
        if observation.label.contains("frequency") {
            apart.frequency = apart.frequency.max(off);
            range = [range[0].min(observation.value), range[1].max(observation.value)];
            apart.points += 1;
        } else {
            apart.ratio = apart.ratio.max(off);
        }
    }
    Apart { range: range[1] / range[0], ..apart }
}

/// Accelerations of a hit by finite differences, analysed as measured ones by `analyse` and by `decay`,
/// and the prediction by the modal engine from displacements: frequencies along the decay agree to
/// 1e-4 and damping ratios to 0.5 %, for each kind of loss, where the frequency changes by 3 % or
/// more. As the decay of an acceleration's amplitude the ratios were 4 to 6 % off.
#[test]
fn measured_and_predicted_backbones_agree() {
    let folder = tempfile::tempdir().unwrap();
    let damping = json!({"kind": "kelvin_voigt", "time_s": 3e-6});
    let friction = json!({"stiffness_n_per_m": 2e8, "coefficient": 0.002});
    for (name, changes) in [
        ("bodies", vec![("/damping/ratio", json!(0.01))]),
        (
            "contacts",
            vec![
                ("/damping/ratio", json!(0.002)),
                ("/interfaces/0/damping", damping.clone()),
                ("/interfaces/1/damping", damping),
            ],
        ),
        ("friction", vec![("/damping/ratio", json!(0.006)), ("/bodies/0/friction", friction)]),
    ] {
        let mut document = Document::parse(&scenario().to_string(), "rig.json").unwrap();
        let method = json!({"kind": "finite_difference", "cell_m": 1e-3});
        for (pointer, value) in changes
            .into_iter()
            .chain([("/duration_s", json!(0.1)), ("/output_rate_hz", json!(RATE))])
        {
            document.set(pointer, &value.to_string()).unwrap();
        }
        let modal = document.value().clone();
        document.set("/method", &method.to_string()).unwrap();
        let run = simulate(&document, &document.scenario().unwrap()).unwrap();
        let record = measurement_record(&run.transient.history, RATE, None);
        let path = folder.path().join("hit.uff");
        let options = WriteOptions::default();
        write(&path, std::slice::from_ref(&record), Format::UniversalBinary, &options).unwrap();
        let responses = vec!["acceleration".into()];
        let band = FrequencyBand { low_hz: 600.0, high_hz: 1100.0 };
        let options = AnalysisOptions {
            responses: ResponseChoice::of(&responses),
            band_hz: Some(band),
            ..AnalysisOptions::default()
        };
        let analysed = analyse(std::slice::from_ref(&path), &options).unwrap();
        let table = analysed.responses[0].backbone_csv();
        std::fs::write(folder.path().join("analysed.csv"), table).unwrap();
        let options = DecayOptions { responses, bands_hz: vec![band], ..DecayOptions::default() };
        let decays = analyse_decays(std::slice::from_ref(&path), &options).unwrap();
        std::fs::write(folder.path().join("decays.csv"), decays.backbone_csv()).unwrap();
        for file in ["analysed.csv", "decays.csv"] {
            let apart = apart(&modal, folder.path(), file);
            println!("{name}, {file}: {apart:?}");
            assert!(apart.points > 8 && apart.range > 1.02, "{name}, {file}: {apart:?}");
            assert!(apart.frequency < 1e-4, "{name}, {file}: {apart:?}");
            assert!(apart.ratio < 5e-3, "{name}, {file}: {apart:?}");
        }
    }
}
