//! The forward model: exact derivatives, data of every kind, invalid problems.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use asperity_dynamics::{STENCIL, central_difference};
use std::sync::Arc;

use asperity_inference::{ForwardModel, Stage};
use serde_json::{Value, json};

use super::scenario_model::ScenarioModel;
use super::{
    IdentificationError, IdentificationProblem, ReasonKind, WorkStage, identify,
    identify_with_progress,
};
use asperity_scenario::Document;

/// The paper's rig, with steps that are quick and few samples.
fn scenario() -> Value {
    json!({
        "schema": "asperity/scenario/1",
        "bodies": [
            {"name": "guide bar", "length_m": 0.229, "mass_kg": 1.61,
             "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710},
            {"name": "sample", "length_m": 0.015, "area_m2": 1.15e-4,
             "youngs_modulus_pa": 71e9, "density_kg_per_m3": 2710},
        ],
        "interfaces": [
            {"name": "guide-sample", "area_m2": 1.15e-4, "law": "modified"},
            {"name": "sample-disc", "area_m2": 1.15e-4, "law": "modified"},
        ],
        "laws": {
            "modified": {
                "kind": "modified_power", "coefficient": 1.81e10, "exponent": 0.35,
                "transition_pa": 2e5,
                "knots": [[0, 0.02e12], [0.025e6, 0.12e12], [0.078e6, 0.40e12], [0.14e6, 0.97e12]],
            },
            "constant": {"kind": "constant", "stiffness_pa_per_m": 8.5e11},
        },
        "damping": {"kind": "mass_proportional", "ratio": 0.035},
        "excitation": {"kind": "gamma_pulse", "peak_n": 32, "rise_s": 0.34e-3},
        "duration_s": 0.08,
        "method": {"kind": "modal", "step_s": 2e-5, "modes_per_body": 2},
    })
}

fn problem(parameters: &Value, data: &Value) -> IdentificationProblem {
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": scenario(),
        "unknowns": parameters,
        "data": data,
    });
    let name = concat!(env!("CARGO_MANIFEST_DIR"), "/problem.json");
    IdentificationProblem::of(Document::parse(&problem.to_string(), name).unwrap()).unwrap()
}

/// Data of every kind that needs no file, two preloads among them.
fn data() -> Value {
    let number = |value: f64| json!({"value": value, "standard_deviation": 1e-3 * value});
    let features = json!({
        "fundamental.frequency_hz": number(850.0),
        "fundamental.receptance_m_per_n": number(2e-7),
        "fundamental.damping_ratio": number(0.035),
        "second_harmonic.frequency_hz": number(1600.0),
        "harmonic_ratio": number(0.2),
        "interfaces.guide-sample.pressure_min_pa": number(5e4),
    });
    json!([
        {"kind": "hits", "hits": [
            {"force_peak_n": 9, "features": features},
            {"force_peak_n": 20, "features": features},
        ]},
        {"kind": "hits", "name": "half preload", "set": {"/bodies/0/mass_kg": 0.8},
         "hits": [{"force_peak_n": 8, "features": features}]},
        {"kind": "stiffness", "law": "modified", "points": [[1e5, 6e11], [4e5, 1.65e12]],
         "spread": {"relative": 0.05}},
        {"kind": "ratio", "feature": "fundamental.frequency_hz",
         "numerator": {"force_peak_n": 20}, "denominator": {"force_peak_n": 9},
         "value": 0.98, "standard_deviation": 0.001},
    ])
}

fn parameters() -> Value {
    json!([
        {"kind": "monotone_law", "law": "modified"},
        {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e10, 4e10]},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]},
        {"kind": "scalar", "pointer": "/excitation/rise_s", "bounds": [1e-4, 1e-3]},
        {"kind": "gain", "channel": "force"},
        {"kind": "gain", "channel": "response", "name": "gain on the half preload",
         "data": ["half preload"]},
    ])
}

/// Fourth-order central differences of the predictions with respect to one parameter.
fn differenced(model: &ScenarioModel, start: &[f64], parameter: usize) -> impl Fn(usize) -> f64 {
    let step = 1e-5 * start[parameter];
    let four = STENCIL.map(|place| {
        let mut point = start.to_vec();
        point[parameter] += place * step;
        model.derivatives(&point).unwrap().values
    });
    move |i| central_difference(four.each_ref().map(|values| values[i].unwrap()), step)
}

fn starts(model: &ScenarioModel) -> Vec<f64> {
    model.parameters().iter().map(asperity_inference::Parameter::start).collect()
}

/// Against fourth-order central differences of the predictions, both with the laws solved to rounding
/// at the same step: to 1e-6 of the derivative, or of a hundredth of the value over the parameter's.
#[test]
fn derivatives_are_those_of_the_predictions() {
    let model = problem(&parameters(), &data()).model().unwrap().forward;
    let start = starts(&model);
    let exact = model.derivatives(&start).unwrap();
    let mut compared = 0;
    for (j, parameter) in model.parameters().iter().enumerate() {
        let differences = differenced(&model, &start, j);
        for (i, observation) in model.observations().iter().enumerate() {
            let Some(value) = exact.values[i] else { continue };
            let expected = differences(i);
            let found = exact.jacobian[i][j].unwrap();
            let scale = expected.abs().max(1e-2 * value.abs() / start[j]);
            let off = (found - expected).abs() / scale;
            assert!(off < 1e-6, "{} {}", parameter.name(), observation.label);
            compared += 1;
        }
    }
    assert_eq!(compared, start.len() * 21);
}

/// The same for the latents of free laws, at a law that is not the centre of the prior.
#[test]
fn derivatives_of_free_laws_are_those_of_the_predictions() {
    for own in
        [json!({}), json!({"exponent_between_0_and_1": true}), json!({"concave_above_pa": 1e5})]
    {
        let mut law = json!({"kind": "free_law", "law": "modified", "points": 10, "pressures_pa": [1e4, 1e6]});
        law.as_object_mut().unwrap().extend(own.as_object().unwrap().clone());
        let model = problem(&json!([law]), &data()).model().unwrap().forward;
        let point: Vec<f64> = (0..10_u32).map(|i| 0.5 * f64::from(i).sin()).collect();
        let exact = model.derivatives(&point).unwrap();
        let mut compared = 0;
        for j in 0..point.len() {
            let step = 3e-5;
            let four = STENCIL.map(|place| {
                let mut moved = point.clone();
                moved[j] += place * step;
                model.derivatives(&moved).unwrap().values
            });
            for (i, value) in exact.values.iter().enumerate() {
                let Some(value) = value else { continue };
                let values = four.each_ref().map(|values| values[i].unwrap());
                let expected = central_difference(values, step);
                let scale = expected.abs().max(1e-2 * value.abs());
                let off = (exact.jacobian[i][j].unwrap() - expected).abs() / scale;
                let label = &model.observations()[i].label;
                assert!(off < 1e-6, "{own}: {label} over latent {j}: {off}");
                compared += 1;
            }
        }
        assert_eq!(compared, 10 * 21);
    }
}

/// Steps and modes are those that the start needs, until a point needs finer ones; coarser ones are
/// not taken.
#[test]
fn step_and_modes_are_held_until_a_point_needs_finer_ones() {
    let parameters = json!([
        {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e10, 1e13]},
    ]);
    let mut problem = problem(&parameters, &json!([data()[0]]));
    problem.scenario["method"] = json!("modal");
    problem.scenario["duration_s"] = json!(0.04);
    let mut model = problem.model().unwrap().forward;
    let start = starts(&model);
    let at = |model: &ScenarioModel, point: &[f64]| model.converged(point).unwrap();
    let steps = |model: &ScenarioModel| -> Vec<f64> {
        model.hits.iter().map(|hit| hit.resolution.as_ref().unwrap().step).collect()
    };
    // The first steps are those of a search.
    model.hold(&at(&model, &start));
    assert!(!model.hold(&at(&model, &start)));
    let before = steps(&model);
    let stiff = [400.0 * start[0]];
    assert!(model.hold(&at(&model, &stiff)));
    assert!(steps(&model).iter().zip(&before).all(|(step, before)| *step < 0.6 * before));
    assert!(!model.hold(&at(&model, &start)));
    // The predictions are those of a response to the accuracy.
    let exact = at(&model, &stiff).remove(0).unwrap().observables;
    let predicted = model.predict(&[stiff.to_vec()]).remove(0).unwrap();
    let first =
        exact.get(asperity_simulation::quantity::Quantity::FundamentalFrequency, None).unwrap();
    let off = predicted.iter().flatten().map(|value| (value / first - 1.0).abs());
    assert!(off.fold(f64::INFINITY, f64::min) < 1e-4);
}

/// A first step that does not keep the energy at the start of the parameters, as with little damping, is
/// halved: there are predictions.
#[test]
fn a_first_step_without_an_energy_balance_is_halved() {
    let parameters = json!([
        {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e10, 1e13]},
    ]);
    let mut problem = problem(&parameters, &data());
    problem.scenario["method"] = json!("modal");
    problem.scenario["duration_s"] = json!(0.4);
    problem.scenario["damping"] = json!({"kind": "mass_proportional", "ratio": 0.01});
    problem.scenario["laws"]["modified"] = json!({"kind": "power", "coefficient": 1.6e10,
        "exponent": 0.35});
    let model = problem.model().unwrap().forward;
    let step = model.hits[0].resolution.as_ref().unwrap().step;
    assert!(step < 1.2e-5, "{step}");
    assert!(model.predict(&[starts(&model)]).remove(0).is_ok());
}

/// As written by `asperity analyse`: no value at zero, and a line with too little force.
const FRF: &str = "frequency_hz,real,imag,magnitude,phase_rad,coherence,valid
0,,,,,0.9,1
800,1e-7,0,1e-7,0,0.9,1
830,1e-7,0,1e-7,0,0.1,0
860,1e-7,0,1e-7,0,0.9,1
1600,1e-8,0,1e-8,0,0.9,1
";

/// The same for receptances and backbones, whose files give the abscissas only: receptances to 1e-6 of the
/// largest part, frequencies along a decay to 1e-5 of a hundredth of the value over the parameter's and
/// damping ratios to 1e-5 of the value, since they are differenced once more.
#[test]
fn derivatives_of_receptances_and_backbones_are_those_of_the_predictions() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let frf = file("frf.csv", FRF);
    let backbone =
        file("backbone.csv", "index,amplitude_m,frequency_hz,damping_ratio\n1,3e-11,875,0.03\n");
    let hit = json!({"force_peak_n": 15});
    let data = json!([
        {"kind": "frf", "file": frf, "hit": hit, "band_hz": [700, 1700],
         "spread": {"relative": 0.01}},
        {"kind": "backbone", "file": backbone, "hit": hit, "spread": {"relative": 1e-4},
         "damping_spread": {"relative": 0.01}},
    ]);
    let model = problem(&parameters(), &data).model();
    // The gain of the half preload has no data here.
    assert!(model.is_err());
    let mut some = parameters();
    some.as_array_mut().unwrap().pop();
    let model = problem(&some, &data).model().unwrap().forward;
    let start = starts(&model);
    let exact = model.derivatives(&start).unwrap();
    let largest = exact.values[..6].iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (j, parameter) in model.parameters().iter().enumerate() {
        let differences = differenced(&model, &start, j);
        for (i, observation) in model.observations().iter().enumerate() {
            let expected = differences(i);
            let found = exact.jacobian[i][j].unwrap();
            let (scale, tolerance) = if i < 6 {
                (largest / start[j], 1e-6)
            } else {
                // The damping ratio hardly depends on the stiffness, the frequency on nothing else.
                let part = if observation.label.contains("damping") { 1.0 } else { 1e-2 };
                (part * exact.values[i].unwrap() / start[j], 1e-5)
            };
            let off = (found - expected).abs() / expected.abs().max(scale);
            assert!(off < tolerance, "{} {}", parameter.name(), observation.label);
        }
    }
}

/// Predictions by batches, with tables and decimated records, equal those of the exact integration to
/// the tolerance of the tables and the sampling.
#[test]
fn batches_predict_what_is_differentiated() {
    let model = problem(&parameters(), &data()).model().unwrap().forward;
    let start = starts(&model);
    let exact = model.derivatives(&start).unwrap().values;
    let both = model.predict(&[start.clone(), start]);
    for (i, observation) in model.observations().iter().enumerate() {
        let [a, b] = [0, 1].map(|point| both[point].as_ref().unwrap()[i]);
        assert_eq!(a, b, "{}", observation.label);
        let (Some(a), Some(exact)) = (a, exact[i]) else { panic!("{}", observation.label) };
        assert!((a / exact - 1.0).abs() < 2e-4, "{}: {a:e} {exact:e}", observation.label);
    }
}

/// One simulation serves all data of the same rig, force and sensors.
#[test]
fn equal_hits_are_simulated_once() {
    let all = json!([{"kind": "gain", "channel": "force"}]);
    let model = problem(&all, &data()).model().unwrap().forward;
    // 9 and 20 N, which the ratio uses too, and 8 N on the half preload.
    assert_eq!((model.hits.len(), model.rigs.len()), (3, 2));
    // Another sensor at the half preload does not change the other hits.
    let model = problem(&parameters(), &data()).model().unwrap().forward;
    assert_eq!(model.hits.len(), 3);
}

/// Invalid candidates, ranges and designs are reported before any run.
#[test]
fn requests_are_checked_before_any_work() {
    for (key, value, expected) in [
        (
            "compare",
            json!([{"name": "x", "set": {"/laws/modified/kind": "none"}}]),
            "/laws/modified",
        ),
        ("pressures_pa", json!([2e5, 1e5]), "the lower first"),
        (
            "design",
            json!({"force_peak_n": [9], "set": [{"/damping/ratio": 0.1}]}),
            "/damping/ratio",
        ),
    ] {
        let mut asked = problem(&parameters(), &data()).document.value().clone();
        asked[key] = value;
        let document = Document::parse(&asked.to_string(), "problem.json").unwrap();
        let started =
            |step: asperity_inference::Progress| panic!("{} has started", step.stage.name());
        let refused =
            super::identify_with_progress(&IdentificationProblem::of(document).unwrap(), &started)
                .unwrap_err();
        assert!(refused.to_string().contains(expected), "{refused}");
    }
}

/// Gains scale the receptances of their own data only.
#[test]
fn gains_apply_to_their_own_data() {
    let gains = json!([
        {"kind": "gain", "channel": "response", "data": ["half preload"]},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]},
    ]);
    let model = problem(&gains, &data()).model().unwrap().forward;
    let found = model.predict(&[vec![1.0, 0.035], vec![1.25, 0.035]]);
    for (i, observation) in model.observations().iter().enumerate() {
        let ratio = found[1].as_ref().unwrap()[i].unwrap() / found[0].as_ref().unwrap()[i].unwrap();
        let scaled = observation.label.starts_with("half preload")
            && observation.label.contains("receptance");
        let expected = if scaled { 1.25 } else { 1.0 };
        assert!((ratio / expected - 1.0).abs() < 1e-12, "{} {ratio}", observation.label);
    }
}

/// Every message names the place and the accepted input.
#[test]
fn invalid_problems_name_the_place() {
    let number = json!({"value": 850.0, "standard_deviation": 1.0});
    let hits = |features: Value| json!([{"kind": "hits", "hits": [{"force_peak_n": 9, "features": features}]}]);
    let frequency = hits(json!({"fundamental.frequency_hz": number}));
    let damping = json!([{"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]}]);
    let scalar = |pointer: &str, more: Value| {
        let mut parameter = json!({"kind": "scalar", "pointer": pointer, "bounds": [0.01, 0.1]});
        for (key, value) in more.as_object().unwrap() {
            parameter[key] = value.clone();
        }
        json!([parameter])
    };
    let twice = json!([
        {"kind": "hits", "hits": [{"force_peak_n": 9, "features": {"fundamental.frequency_hz": number}}]},
        {"kind": "hits", "name": "hits 1", "hits": [{"force_peak_n": 9, "features":
            {"fundamental.frequency_hz": {"value": 950.0, "standard_deviation": 1.0}}}]},
    ]);
    let cases = [
        (scalar("/damping/rate", json!({})), frequency.clone(), "/damping/rate"),
        (scalar("/method/step_s", json!({})), frequency.clone(), "setting of the computation"),
        (scalar("damping", json!({})), frequency.clone(), "damping"),
        (scalar("/damping/ratio", json!({"start": 0.5})), frequency.clone(), "outside its bounds"),
        (scalar("/damping/ratio", json!({"bounds": [0.1, 0.01]})), frequency.clone(), "increasing"),
        (scalar("/damping/ratio", json!({"prior": {"value": 1.0}})), frequency.clone(), "relative"),
        (json!([{"kind": "monotone_law", "law": "constant"}]), frequency.clone(), "constant"),
        (
            json!([{"kind": "gain", "channel": "force", "data": ["x"]}]),
            frequency.clone(),
            "there are: hits 1",
        ),
        (damping.clone(), hits(json!({"fundamental.frequency": number})), "expected one of"),
        (damping.clone(), hits(json!({"energy.input_j": number})), "expected one of"),
        (damping.clone(), hits(json!({"fundamental.frequency_hz": 850.0})), "standard deviation"),
        (damping.clone(), twice, "standard deviations apart"),
        (
            damping.clone(),
            json!([{"kind": "hits", "set": {"/damping/ratio": 0.02}, "hits": [
                {"force_peak_n": 9, "features": {"fundamental.frequency_hz": number}}]}]),
            "sets /damping/ratio",
        ),
        (
            damping.clone(),
            json!([{"kind": "hits", "set": {"/bodies/0/mass": 2}, "hits": [
                {"force_peak_n": 9, "features": {"fundamental.frequency_hz": number}}]}]),
            "mass",
        ),
        (
            damping.clone(),
            json!([{"kind": "stiffness", "law": "steel", "points": [[1e5, 1e12]],
                    "spread": {"relative": 0.1}}]),
            "\"steel\"",
        ),
        (damping.clone(), json!([{"kind": "analysis", "file": "nowhere.json"}]), "nowhere.json"),
        (
            damping,
            json!([{"kind": "frf", "file": "nowhere.csv", "band_hz": [900, 800],
                    "spread": {"relative": 0.1}}]),
            "the lower first",
        ),
    ];
    for (parameters, data, expected) in cases {
        let refused = problem(&parameters, &data).model().map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains(expected), "{expected} is not in: {refused}");
    }
}

/// Errors of the schema, at their places.
#[test]
fn a_problem_without_data_or_with_unknown_keys_is_an_error() {
    for (key, value, expected) in [
        ("data", json!([]), "/data"),
        ("unknowns", json!([]), "/unknowns"),
        ("level", json!(1.5), "/level"),
        ("colour", json!("red"), "/colour"),
        ("scenario", json!({"schema": "asperity/scenario/1"}), "/scenario"),
        ("scenario", json!("nowhere.json"), "nowhere.json"),
        ("schema", json!("asperity/scenario/1"), "/schema"),
    ] {
        let mut text = json!({
            "schema": "asperity/identify/1",
            "scenario": scenario(),
            "unknowns": parameters(),
            "data": data(),
        });
        text[key] = value;
        let document = Document::parse(&text.to_string(), "problem.json").unwrap();
        let refused = IdentificationProblem::of(document).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains(expected), "{expected} is not in: {refused}");
    }
}

/// A request to stop leaves what is finished.
#[test]
fn a_stopped_identification_keeps_what_is_finished() {
    let parameters = json!([
        {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e10, 4e10]},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]},
    ]);
    let of = || problem(&parameters, &data());
    let at_once = of();
    at_once.work().stop();
    assert!(matches!(identify(&at_once), Err(IdentificationError::StoppedAtOnce)));
    let stopped_in = |stage: Stage| {
        let problem = of();
        let work = Arc::clone(problem.work());
        let found = identify_with_progress(&problem, &|progress| {
            if progress.stage == stage {
                work.stop();
            }
        });
        (problem, found)
    };
    for (stage, expected) in
        [(Stage::Profile, WorkStage::Profiles), (Stage::Draws, WorkStage::Posterior)]
    {
        let (problem, found) = stopped_in(stage);
        let Err(IdentificationError::Stopped(found)) = found else { panic!("{stage:?}") };
        assert_eq!(found.stage, expected);
        assert_eq!(found.profiles.is_empty(), expected == WorkStage::Profiles);
        let report = found.report(&problem);
        assert_eq!(report["complete"], false);
        assert!(report["estimates"][0]["standard_deviation"].as_f64().unwrap() > 0.0);
        assert!(found.conclusions()[0].starts_with("Not to be used"));
        assert_eq!(report["judgement"]["use"], "no");
        assert_eq!(report["judgement"]["reasons"][0]["kind"], "incomplete");
        let scenario = found.scenario_json(&problem).unwrap();
        let coefficient = scenario.pointer("/laws/modified/coefficient").unwrap();
        assert_eq!(coefficient.as_f64().unwrap(), found.fit.point[0]);
    }
    let (problem, found) = stopped_in(Stage::Comparison);
    let found = found.unwrap();
    assert!(found.stopped && found.comparison.is_none());
    assert_eq!(found.report(&problem)["complete"], false);
    assert!(found.conclusions().iter().any(|word| word.starts_with("Incomplete")));
    assert_ne!(found.report(&problem)["judgement"]["use"], "yes");
}

/// Receptances of one hit that a changed model predicts: what explains them is named, and fitted.
#[test]
fn misfits_are_explained_by_polarity_units_and_losses() {
    let parameters = json!([
        {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e10, 4e10]},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.01, 0.1]},
    ]);
    let frequencies: Vec<f64> = (0..30).map(|i| 760.0 + 8.0 * f64::from(i)).collect();
    let with = |values: &[f64]| {
        let part = |offset: usize| values.iter().skip(offset).step_by(2).collect::<Vec<_>>();
        let table = json!({"frequency_hz": frequencies, "real": part(0), "imag": part(1)});
        let data = json!([{"kind": "frf", "file": table, "hit": {"force_peak_n": 1},
            "band_hz": [700, 1100], "points": 100, "spread": {"relative": 0.01}}]);
        problem(&parameters, &data)
    };
    let model = with(&vec![1e-7; 60]).model().unwrap().forward;
    let predicted = |model: &ScenarioModel| -> Vec<f64> {
        let found = model.predict(&[starts(model)]).remove(0).unwrap();
        found.into_iter().flatten().collect()
    };
    let right = predicted(&model);
    let explained = |factor: f64, values: &[f64]| {
        let values: Vec<f64> = values.iter().map(|value| factor * value).collect();
        let problem = with(&values);
        let found = identify(&problem).unwrap();
        let report = found.report(&problem);
        (found, report)
    };
    let (found, _) = explained(1.0, &right);
    assert!(found.explanations.is_empty(), "{:?}", found.explanations);
    for (factor, cause) in
        [(-1.0, "the other polarity"), (1e3, "1000"), (9.81, "m/s^2 taken for g")]
    {
        let (found, report) = explained(factor, &right);
        let first = &found.explanations[0];
        assert!(first.cause.contains(cause), "{factor}: {:?}", found.explanations);
        assert!(first.chi_square.unwrap() < 1.0, "{factor}: {first:?}");
        assert_eq!(report["judgement"]["use"], "no");
        assert_eq!(report["explanations"][0]["cause"], first.cause);
        let words = found.conclusions().join(" ");
        assert!(words.contains("What would explain the data better"), "{words}");
    }
    // A loss that the model does not have: the damping ratio is given here.
    let damping = json!({"kind": "kelvin_voigt", "time_s": 5e-6});
    let lossy = predicted(&model.with_set("/interfaces/0/damping", &damping));
    let given = with(&lossy).document.value()["data"].clone();
    let found = identify(&problem(&json!([parameters[0]]), &given)).unwrap();
    let first = &found.explanations[0];
    assert!(first.cause.contains("damping"), "{:?}", found.explanations);
    assert!(first.chi_square.unwrap() < 0.1 * found.goodness.chi_square, "{first:?}");
}

/// Errors of a step that the scenario sets are compared with the standard deviations of the data.
#[test]
fn a_step_that_is_coarse_for_the_data_needs_care() {
    let parameters = json!([{"kind": "scalar", "pointer": "/laws/modified/coefficient",
        "bounds": [1e9, 1e12]}]);
    for (deviation, needs_care) in [(1e-6, true), (1.0, false)] {
        let hit = |peak: f64| {
            json!({"force_peak_n": peak, "features": {"fundamental.frequency_hz":
                {"value": 850.0, "standard_deviation": deviation}}})
        };
        let data = json!([{"kind": "hits", "hits": [hit(10.0), hit(20.0)]}]);
        let found = identify(&problem(&parameters, &data).fast()).unwrap();
        let [errors] = &found.feature_errors[..] else { panic!("{:?}", found.feature_errors) };
        assert_eq!((errors.feature.as_str(), errors.observations), ("fundamental.frequency_hz", 2));
        let mut reasons = found.judgement().reasons.into_iter();
        let reason = reasons.find(|reason| reason.kind == ReasonKind::Numerics);
        assert_eq!(reason.is_some(), needs_care, "{errors:?}");
        if let Some(reason) = reason {
            assert!(reason.words.contains("Without \"step_s\""), "{}", reason.words);
        }
    }
}
