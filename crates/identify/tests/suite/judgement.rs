//! The judgement of an identification: synthetic data of stiffnesses, for each reason.

use asperity_identify::{
    GivenNumber, Identification, IdentificationProblem, ReasonKind, Usability, identify,
};
use asperity_scenario::Document;
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

const COEFFICIENT: f64 = 1.81e10;
const EXPONENT: f64 = 0.35;
const SCENARIO: &str = "../../fixtures/scenarios/nouira2020-modified.json";

/// The rig of the fixtures with a power law.
fn rig() -> Value {
    let mut rig: Value = serde_json::from_slice(&std::fs::read(SCENARIO).unwrap()).unwrap();
    rig["laws"] =
        json!({"pl": {"kind": "power", "coefficient": COEFFICIENT, "exponent": EXPONENT}});
    for interface in rig["interfaces"].as_array_mut().unwrap() {
        interface["law"] = json!("pl");
    }
    rig
}

fn unknowns() -> Value {
    json!([
        {"kind": "scalar", "pointer": "/laws/pl/coefficient", "bounds": [1e8, 1e12]},
        {"kind": "scalar", "pointer": "/laws/pl/exponent", "bounds": [0.05, 0.9]},
    ])
}

/// Stiffnesses with errors of a standard deviation of 2 %, times `change` of their pressure.
fn points(change: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let errors = [0.6, -1.1, 0.3, 1.4, -0.8, 0.2, -0.5, 0.9];
    let pressure = |i: usize| 2e4 * 1.7_f64.powi(i32::try_from(i).unwrap());
    let point = |(i, error): (usize, &f64)| {
        let p = pressure(i);
        [p, COEFFICIENT * p.powf(EXPONENT) * (1.0 + 0.02 * error) * change(p)]
    };
    errors.iter().enumerate().map(point).collect()
}

fn problem(unknowns: &Value, points: &[[f64; 2]], spread: f64) -> IdentificationProblem {
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": rig(),
        "unknowns": unknowns,
        "data": [{"kind": "stiffness", "law": "pl", "points": points,
                  "spread": {"relative": spread}}],
        "draws": 400,
    });
    IdentificationProblem::of(Document::parse(&problem.to_string(), "problem.json").unwrap())
        .unwrap()
}

fn found(unknowns: &Value, points: &[[f64; 2]]) -> Identification {
    identify(&problem(unknowns, points, 0.02)).unwrap()
}

/// The use that the reasons of a kind allow; all without one.
fn allowed(found: &Identification, kind: ReasonKind) -> Usability {
    let reasons = found.judgement().reasons;
    let own = reasons.iter().filter(|reason| reason.kind == kind);
    own.map(|reason| reason.usability).max().unwrap_or(Usability::Yes)
}

/// The right model may be used: no reason against it, and the judgement comes first everywhere.
#[test]
fn the_right_model_may_be_used() {
    let problem = problem(&unknowns(), &points(|_| 1.0), 0.02);
    let found = identify(&problem).unwrap();
    let judgement = found.judgement();
    assert_eq!(judgement.usability, Usability::Yes, "{judgement:?}");
    assert!(found.conclusions()[0].starts_with("May be used: law \"pl\""));
    let report = found.report(&problem);
    assert_eq!(report["judgement"]["use"], "yes");
    assert_eq!(found.draws_json(&problem).unwrap()["judgement"]["use"], "yes");
}

/// A bump that the form does not have, beyond its standard deviations.
#[test]
fn a_misfit_voids_the_law() {
    let bump = |p: f64| if (5e4..2e5).contains(&p) { 1.3 } else { 1.0 };
    let problem = problem(&unknowns(), &points(bump), 0.02);
    let found = identify(&problem).unwrap();
    assert_eq!(allowed(&found, ReasonKind::Misfit), Usability::No);
    let words = found.conclusions();
    assert!(words[0].starts_with("Not to be used: law \"pl\""), "{words:?}");
    assert!(words[1].starts_with("Void: chi-square is"), "{words:?}");
    assert!(!words.iter().any(|word| word.contains("half width")), "{words:?}");
    let report = found.report(&problem);
    assert_eq!(report["judgement"]["use"], "no");
    assert_eq!(report["judgement"]["reasons"][0]["kind"], "misfit");
    assert!(report["judgement"]["reasons"][0]["numbers"]["p_value"].as_f64().unwrap() < 1e-3);
    assert_eq!(found.draws_json(&problem).unwrap()["judgement"]["use"], "no");
}

/// A prior that the data contradict, though chi-square is good.
#[test]
fn a_prior_in_conflict_voids_the_law() {
    for (mean, expected) in
        [(0.35, Usability::Yes), (0.31, Usability::WithCare), (0.25, Usability::No)]
    {
        let mut unknowns = unknowns();
        unknowns[1]["scale"] = json!("linear");
        unknowns[1]["prior"] = json!({"value": mean, "standard_deviation": 0.01});
        // Many precise points, so that the data decide.
        let many: Vec<[f64; 2]> = (0..20).flat_map(|_| points(|_| 1.0)).collect();
        let found = found(&unknowns, &many);
        let kind = ReasonKind::Prior;
        assert_eq!(allowed(&found, kind), expected, "{mean}: {:?}", found.strains);
        assert!(found.judgement().usability >= expected);
    }
}

/// A bound that the data push against carries the result; one that the value rests on does not.
#[test]
fn a_bound_that_carries_the_result_voids_it() {
    for (upper, expected) in [(0.3, Usability::No), (0.9, Usability::Yes)] {
        let mut unknowns = unknowns();
        unknowns[1]["bounds"] = json!([0.05, upper]);
        unknowns[1]["start"] = json!(0.2);
        let many: Vec<[f64; 2]> = (0..10).flat_map(|_| points(|_| 1.0)).collect();
        let found = found(&unknowns, &many);
        assert_eq!(allowed(&found, ReasonKind::Bound), expected, "{:?}", found.strains);
    }
}

/// Spreads far above the residuals are a remark, which allows all use.
#[test]
fn spreads_that_are_too_large_are_remarked() {
    let many: Vec<[f64; 2]> = (0..10).flat_map(|_| points(|_| 1.0)).collect();
    let found = identify(&problem(&unknowns(), &many, 0.2)).unwrap();
    let reasons = found.judgement().reasons;
    let spreads = reasons.iter().find(|reason| reason.kind == ReasonKind::Spreads).unwrap();
    assert_eq!(spreads.usability, Usability::Yes);
    assert!(spreads.words.contains("times the residuals"), "{}", spreads.words);
}

/// Points at one pressure determine one combination of both numbers.
#[test]
fn numbers_that_the_data_do_not_determine_are_named() {
    let one = points(|_| 1.0)[3];
    let found = found(&unknowns(), &[one, one, one]);
    let reasons = found.judgement().reasons;
    let open = reasons.iter().find(|reason| reason.kind == ReasonKind::Undetermined).unwrap();
    assert_eq!(open.usability, Usability::WithCare);
    assert!(open.words.contains("/laws/pl/exponent"), "{}", open.words);
    let constant = allowed(&found, ReasonKind::ConstantStiffness);
    assert_eq!(constant, Usability::WithCare, "{reasons:?}");
}

/// Failures of the numerics: derivatives, chains, intervals, starts, the search.
#[test]
fn failed_numerics_void_the_law() {
    let right = || found(&unknowns(), &points(|_| 1.0));
    let mut wrong = right();
    for (difference, expected) in
        [(0.01, Usability::Yes), (0.3, Usability::WithCare), (15.49, Usability::No)]
    {
        wrong.linearisation.derivative_difference = Some(difference);
        assert_eq!(allowed(&wrong, ReasonKind::Derivatives), expected, "{difference}");
    }
    let mut wrong = right();
    for (r_hat, expected) in
        [(1.001, Usability::Yes), (1.03, Usability::WithCare), (1.3, Usability::No)]
    {
        wrong.posterior.diagnostics.r_hat[1] = r_hat;
        assert_eq!(allowed(&wrong, ReasonKind::Sampler), expected, "{r_hat}");
    }
    let mut wrong = right();
    for draw in &mut wrong.posterior.draws {
        draw[1] += 0.1;
    }
    assert_eq!(allowed(&wrong, ReasonKind::Interval), Usability::No);
    let mut wrong = right();
    for ends in [&mut wrong.law.lower, &mut wrong.law.upper] {
        for end in ends {
            *end *= 1.5;
        }
    }
    assert_eq!(allowed(&wrong, ReasonKind::Interval), Usability::No);
    // The band beside the best fit by a share of its width, as of a skewed posterior.
    let skewed = |share: f64| {
        let mut wrong = right();
        let law = &mut wrong.law;
        for i in 0..law.pressure.len() {
            let width = law.upper[i] - law.lower[i];
            law.lower[i] = law.stiffness[i] + share * width;
            law.upper[i] = law.lower[i] + width;
        }
        wrong
    };
    for (share, expected) in
        [(0.04, Usability::Yes), (0.2, Usability::WithCare), (0.6, Usability::No)]
    {
        assert_eq!(allowed(&skewed(share), ReasonKind::Interval), expected, "{share}");
    }
    let mut wrong = skewed(0.2);
    wrong.posterior.diagnostics.r_hat[1] = 1.03;
    assert_eq!(allowed(&wrong, ReasonKind::Interval), Usability::No);
    let mut wrong = right();
    for start in wrong.fit.starts.iter_mut().skip(1) {
        start.cost = wrong.fit.cost + 50.0;
    }
    assert_eq!(allowed(&wrong, ReasonKind::Starts), Usability::WithCare);
    // Another optimum as good, so many widths of the interval above it.
    let with_another = |widths: f64| {
        let mut wrong = right();
        let mut other = wrong.fit.distinct_optima[0].clone();
        let [low, high] = [0.025, 0.975].map(|tail| wrong.posterior.quantile(1, tail));
        other.point[1] = high + widths * (high - low);
        other.cost = wrong.fit.cost + 0.5;
        wrong.fit.distinct_optima.push(other);
        wrong
    };
    for (widths, expected) in
        [(0.04, Usability::Yes), (0.3, Usability::WithCare), (0.6, Usability::No)]
    {
        assert_eq!(allowed(&with_another(widths), ReasonKind::Starts), expected, "{widths}");
    }
    let mut wrong = with_another(0.3);
    wrong.posterior.diagnostics.r_hat[1] = 1.03;
    assert_eq!(allowed(&wrong, ReasonKind::Starts), Usability::No);
    let mut wrong = right();
    wrong.fit.converged = false;
    assert_eq!(allowed(&wrong, ReasonKind::Fit), Usability::No);
    let mut wrong = right();
    wrong.stopped = true;
    assert_eq!(allowed(&wrong, ReasonKind::Incomplete), Usability::WithCare);
}

/// A frequency of the rig determines the stiffness over the mass: one per cent of the mass of the bar is
/// about one per cent of K, and its tolerance enters the band.
#[test]
fn given_numbers_are_listed_and_their_tolerance_is_in_the_band() {
    let mut rig = rig();
    rig["method"] = json!({"kind": "modal", "step_s": 2e-5, "modes_per_body": 2});
    rig["excitation"]["peak_n"] = json!(0.1);
    let of = |given: Value| {
        let hit = json!({"force_peak_n": 0.1, "features": {"fundamental.frequency_hz":
            {"value": 900.0, "standard_deviation": 0.1}}});
        let problem = json!({
            "schema": "asperity/identify/1",
            "scenario": rig,
            "unknowns": [unknowns()[0]],
            "data": [{"kind": "hits", "hits": [hit]}],
            "given": given,
            "draws": 200,
        });
        IdentificationProblem::of(Document::parse(&problem.to_string(), "problem.json").unwrap())
            .unwrap()
    };
    let mass = "/bodies/0/mass_kg";
    let width = |relative: f64| {
        let mut exact: Vec<Value> = Vec::new();
        let by_default = identify(&of(json!([]))).unwrap();
        for one in &by_default.given {
            let tolerance = if one.pointer == mass { relative } else { 0.0 };
            exact.push(json!({"pointer": one.pointer, "relative": tolerance}));
        }
        let problem = of(json!(exact));
        let found = identify(&problem).unwrap();
        let number = found.given.iter().find(|one| one.pointer == mass).unwrap();
        assert!(number.is_stated && number.relative == relative);
        assert!((0.5..1.6).contains(&number.sensitivity), "{number:?}");
        assert!(found.report(&problem)["given"][0]["sensitivity"].is_number());
        let law = &found.law;
        let place = law.pressure.iter().position(|p| *p == law.at_rest).unwrap();
        ((law.upper[place] / law.median[place]).ln(), number.sensitivity)
    };
    let (without, _) = width(0.0);
    let (with, sensitivity) = width(0.05);
    let expected = without.hypot(1.96 * 0.05 * sensitivity);
    assert!((with / expected - 1.0).abs() < 0.02, "{with} {expected} {without}");
    let refused = identify(&of(json!([{"pointer": "/bodies/0/name", "relative": 0.1}])));
    assert!(refused.unwrap_err().to_string().contains(mass));
}

/// A frequency of the rig determines the stiffness of the whole stack: a support taken as rigid is remarked
/// with the stiffness at which it matters, which is that of an elastic support in the model.
#[test]
fn a_support_taken_as_rigid_needs_care_where_a_usual_one_moves_the_law() {
    let found = |support: Value, given: &[Value]| {
        let mut rig = rig();
        rig["method"] = json!({"kind": "modal", "step_s": 2e-5, "modes_per_body": 2});
        rig["support"] = support;
        let hit = json!({"force_peak_n": 0.1, "features": {"fundamental.frequency_hz":
            {"value": 900.0, "standard_deviation": 0.1}}});
        let problem = json!({
            "schema": "asperity/identify/1",
            "scenario": rig,
            "unknowns": [unknowns()[0]],
            "data": [{"kind": "hits", "hits": [hit]}],
            "given": given,
            "draws": 200,
        });
        let document = Document::parse(&problem.to_string(), "problem.json").unwrap();
        identify(&IdentificationProblem::of(document).unwrap()).unwrap()
    };
    let use_of = |found: &Identification| {
        let reasons = found.judgement().reasons.into_iter();
        reasons
            .filter(|reason| reason.kind == ReasonKind::RigidSupport)
            .map(|one| one.usability)
            .next()
    };
    // By their digits the given numbers move the law as much as a support of usual stiffness.
    let rigid = found(json!({"kind": "rigid"}), &[]);
    assert_eq!(use_of(&rigid), Some(Usability::Yes));
    let exact = |one: &GivenNumber| json!({"pointer": one.pointer, "relative": 1e-9});
    let exact: Vec<Value> = rigid.given.iter().map(exact).collect();
    let rigid = found(json!({"kind": "rigid"}), &exact);
    let support = rigid.rigid_support.unwrap();
    let widths = support.stiffness_n_per_m / support.half_space_n_per_m;
    assert!(widths > 5.0, "{widths}");
    assert_eq!(use_of(&rigid), Some(Usability::WithCare));
    let stated = [exact.clone(), vec![json!({"pointer": "/support", "relative": 0})]].concat();
    let stated = found(json!({"kind": "rigid"}), &stated);
    assert_eq!(use_of(&stated), Some(Usability::Yes));
    assert!(stated.rigid_support.unwrap().is_stated);
    let band = &rigid.law;
    let place = band.pressure.iter().position(|p| *p == support.pressure_pa).unwrap();
    let half_width = 0.5 * (band.upper[place] / band.lower[place]).ln();
    let stiffness = 2e9;
    let elastic = found(
        json!({"kind": "spring_mass", "stiffness_n_per_m": stiffness,
        "mass_kg": 1e-3, "damping_ratio": 0.01}),
        &[],
    );
    assert_eq!(use_of(&elastic), None);
    assert_eq!(elastic.rigid_support, None);
    let moved = (elastic.law.stiffness[place] / band.stiffness[place]).ln();
    let expected = support.stiffness_n_per_m * half_width / stiffness;
    assert!((moved / expected - 1.0).abs() < 0.05, "{moved} {expected}");
    // 2 E a / (1 - nu^2) of an area of 1.15e-4 m2.
    assert!((support.half_space_n_per_m / 2.79e9 - 1.0).abs() < 0.01);
    let shift = support.half_space_shift * support.half_space_n_per_m / stiffness;
    assert!((moved / shift - 1.0).abs() < 0.05, "{moved} {shift}");
}

/// A model without predictions about its best fit has no posterior, which voids the law: the fit is told.
#[test]
fn a_fit_far_from_the_data_has_a_judgement() {
    let mut rig = rig();
    rig["method"] = json!({"kind": "modal", "step_s": 2e-5, "modes_per_body": 2});
    let mut unknowns = unknowns();
    unknowns[1]["bounds"] = json!([0.6, 0.9]);
    unknowns[1]["start"] = json!(0.7);
    let hit = |mass: f64, f: f64| {
        json!({"set": {"/bodies/0/mass_kg": mass}, "force_peak_n": 0.1,
        "features": {"fundamental.frequency_hz": {"value": f, "standard_deviation": 0.01}}})
    };
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": rig,
        "unknowns": unknowns,
        "data": [{"kind": "hits", "hits": [hit(0.8, 1200.0), hit(1.6, 1000.0), hit(3.2, 800.0)]}],
        "draws": 100,
    });
    let document = Document::parse(&problem.to_string(), "problem.json").unwrap();
    let problem = IdentificationProblem::of(document).unwrap();
    let found = identify(&problem).unwrap();
    assert_eq!(found.judgement().usability, Usability::No);
    assert_eq!(allowed(&found, ReasonKind::Misfit), Usability::No);
    assert!(found.report(&problem)["judgement"]["reasons"].as_array().unwrap().len() > 1);
}

/// Without profiles and comparison the law has its band, and the judgement names what is missing.
#[test]
fn a_fast_identification_leaves_out_profiles_and_comparison() {
    let problem = problem(&unknowns(), &points(|_| 1.0), 0.02).fast();
    let found = identify(&problem).unwrap();
    assert!(found.profiles.is_empty() && found.comparison.is_none());
    assert_eq!(allowed(&found, ReasonKind::Incomplete), Usability::WithCare);
    assert!(found.law.informed_range().is_some());
    let words = found.conclusions().join(" ");
    assert!(
        words.contains("The data inform the stiffness") && words.contains("left out"),
        "{words}"
    );
    assert_eq!(found.report(&problem)["fast"], true);
}

/// Hits whose contact opens move otherwise than the model, as where the bar tilts while a contact is open: that the model
/// fits the others alone is an explanation, with the chi-square of these.
#[test]
fn hits_in_which_contact_opens_are_an_explanation() {
    let mut scenario = rig();
    scenario["method"] = json!({"kind": "modal", "step_s": 4e-5, "modes_per_body": 1});
    scenario["duration_s"] = json!(0.03);
    let hit = |force: f64| {
        let mut rig = scenario.clone();
        rig["excitation"]["peak_n"] = json!(force);
        let document = Document::parse(&rig.to_string(), "rig.json").unwrap();
        let run = simulate(&document, &document.scenario().unwrap()).unwrap();
        let opens = run.summary.interfaces.iter().any(|one| one.pressure_min_pa == 0.0);
        assert_eq!(opens, force > 26.0, "{force}");
        let summary = serde_json::to_value(&run.summary).unwrap();
        let feature = |of: &str, name: &str| {
            let value = if opens { 1.05 } else { 1.0 } * summary[of][name].as_f64().unwrap();
            json!({"value": value, "standard_deviation": 2e-3 * value})
        };
        json!({"force_peak_n": force, "features": {
            "fundamental.frequency_hz": feature("fundamental", "frequency_hz"),
            "fundamental.receptance_m_per_n": feature("fundamental", "receptance_m_per_n"),
        }})
    };
    let problem = json!({
        "schema": "asperity/identify/1", "scenario": scenario, "unknowns": unknowns(),
        "data": [{"kind": "hits", "hits": [hit(6.0), hit(12.0), hit(34.0)]}],
        "starts": 1, "draws": 100,
    });
    let problem = Document::parse(&problem.to_string(), "problem.json").unwrap();
    let found = identify(&IdentificationProblem::of(problem).unwrap()).unwrap();
    let first = &found.explanations[0];
    let words = "contact is without pressure at times in 1 of 3 hits";
    assert!(first.cause.starts_with(words), "{:?}", found.explanations);
    // The two observations left out, and the others almost without residuals.
    let chi_square = first.chi_square.unwrap();
    assert!((2.0..2.2).contains(&chi_square), "{:?}", found.explanations);
    assert!(found.goodness.chi_square > 100.0, "{:?}", found.goodness);
}
