//! Model choice between polynomials of the right and the wrong degree.

use asperity_inference::{
    ComparisonOptions, ForwardModel, FunctionModel, ModelAssessment, Observation, compare,
};

use crate::models::{Noise, assert_close, linear};

/// Fits `y = sum_k b_k t^k` to `y = 1 + t + bend t^2` with noise 0.1 at `count` times in [-1, 1],
/// two in a block.
fn polynomial(degree: usize, count: usize, bend: f64) -> impl ForwardModel {
    let mut noise = Noise(5);
    let times: Vec<f64> = (0..count).map(|i| 2.0 * i as f64 / (count - 1) as f64 - 1.0).collect();
    let values: Vec<f64> =
        times.iter().map(|t| 1.0 + t + bend * t * t + 0.1 * noise.normal()).collect();
    let mut observations = Observation::list(&values, 0.1);
    for observation in &mut observations {
        observation.block /= 2;
    }
    FunctionModel {
        parameters: (0..=degree).map(|k| linear(&format!("b{k}"), 0.0, [-50.0, 50.0])).collect(),
        observations,
        function: move |b: &[f64]| {
            let at = |t: &f64| b.iter().rev().fold(0.0, |sum, b| sum * t + b);
            times.iter().map(at).collect()
        },
    }
}

#[test]
fn enough_data_reject_the_wrong_degree_and_little_data_do_not() {
    let choose = |count: usize, bend: f64| {
        let (line, parabola) = (polynomial(1, count, bend), polynomial(2, count, bend));
        let candidates: [(&str, &dyn ForwardModel); 2] = [("line", &line), ("parabola", &parabola)];
        compare(&candidates, &ComparisonOptions::default()).unwrap()
    };
    let much = choose(60, 0.6);
    assert_eq!(much.candidates[1].assessment, ModelAssessment::Best);
    assert_eq!(much.best, 1);
    let ModelAssessment::Rejected { standard_errors, aicc_difference } =
        much.candidates[0].assessment
    else {
        panic!("{:?}", much.candidates[0].assessment);
    };
    assert!(standard_errors > 2.5 && aicc_difference > 10.0);
    assert!(much.candidates[0].goodness.p_value.unwrap() < 1e-3);
    assert!(much.candidates[1].goodness.p_value.unwrap() > 1e-3);

    let little = choose(8, 0.15);
    assert!(little.candidates.iter().any(|c| c.assessment == ModelAssessment::Undecided));
    assert!(
        !little.candidates.iter().any(|c| matches!(c.assessment, ModelAssessment::Rejected { .. }))
    );
}

/// A fold of one block at a time must give the closed form of a mean: leaving out `y_i` of `n`
/// leaves the mean of the others, so its residual is `n / (n - 1)` times the one at the mean.
#[test]
fn cross_validation_of_a_mean_is_the_closed_form() {
    let values = [0.3, -0.4, 1.0, 0.2, -0.6];
    let model = FunctionModel {
        parameters: vec![linear("mean", 0.0, [-10.0, 10.0])],
        observations: Observation::list(&values, 0.5),
        function: |x: &[f64]| vec![x[0]; 5],
    };
    let choice = compare(&[("mean", &model)], &ComparisonOptions::default()).unwrap();
    let outcome = &choice.candidates[0];
    assert_eq!(outcome.assessment, ModelAssessment::Best);
    let score = outcome.cross_validation.as_ref().unwrap();
    assert_eq!(score.folds, 5);
    let constant = 0.5_f64.ln() + 0.5 * std::f64::consts::TAU.ln();
    for (found, y) in score.blocks.iter().zip(values) {
        let residual = (y - 0.1) * 5.0 / 4.0 / 0.5;
        assert_close(*found, -0.5 * residual * residual - constant, 1e-7, "block");
    }
    let chi_square: f64 = values.iter().map(|y| ((y - 0.1) / 0.5).powi(2)).sum();
    assert_close(outcome.aicc, chi_square + 2.0 + 4.0 / 3.0, 1e-9, "AICc");
    assert_close(outcome.bic, chi_square + 5.0_f64.ln(), 1e-9, "BIC");
}

/// Two observations, two parameters: no criterion and no cross-validation, but a constant whose residuals
/// are a hundred standard deviations is rejected by them.
#[test]
fn residuals_reject_where_there_are_no_criteria() {
    let observations = Observation::list(&[1.0, 3.0], 0.01);
    let parameter = |name| linear(name, 0.5, [-5.0, 5.0]);
    let constant = FunctionModel {
        parameters: vec![parameter("mean")],
        observations: observations.clone(),
        function: |x: &[f64]| vec![x[0]; 2],
    };
    let line = FunctionModel {
        parameters: vec![parameter("intercept"), parameter("slope")],
        observations,
        function: |x: &[f64]| vec![x[0], x[0] + x[1]],
    };
    let models: [(&str, &dyn ForwardModel); 2] = [("constant", &constant), ("line", &line)];
    for order in [[0, 1], [1, 0]] {
        let models = order.map(|k: usize| models[k]);
        let found = compare(&models, &ComparisonOptions::default()).unwrap();
        assert_eq!(found.candidates[found.best].name, "line");
        let constant = found.candidates.iter().find(|one| one.name == "constant").unwrap();
        assert!(matches!(constant.assessment, ModelAssessment::Misfit { .. }), "{constant:?}");
    }
}
