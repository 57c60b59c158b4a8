//! Searches along curved valleys, past missing predictions, and with errors of the predictions.

use asperity_inference::{
    FitOptions, FitTermination, ForwardModel, FunctionModel, Observation, Parameter, Posterior,
    PosteriorDiagnostics, PosteriorOptions, PredictionError, Predictions, fit, refit_with_progress,
};

use crate::models::linear;

/// A valley `y = x^2` that is 1000 times as steep across as along: the steps of the linear model alone are as
/// short as its curvature asks, and stop at the limit of iterations.
#[test]
fn a_narrow_curved_valley_is_followed_to_its_minimum() {
    let model = FunctionModel {
        parameters: vec![linear("x", -2.0, [-4.0, 4.0]), linear("y", 4.0, [-16.0, 16.0])],
        observations: Observation::list(&[0.0, 0.0], 1.0),
        function: |x: &[f64]| vec![1e3 * (x[1] - x[0] * x[0]), x[0] - 1.5],
    };
    let options = FitOptions { difference_step: 1e-4, ..FitOptions::default() };
    let found = fit(&model, &options).unwrap();
    assert!(found.converged && found.cost < 1e-12, "{} {:?}", found.cost, found.termination);
    assert!(found.iterations < 100, "{}", found.iterations);
}

/// `10 x`, and beyond 2 also `1000 x`.
struct Appearing {
    parameters: Vec<Parameter>,
    observations: Vec<Observation>,
}

impl ForwardModel for Appearing {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let one = |x: f64| Ok(vec![Some(10.0 * x), (x > 2.0).then_some(1000.0 * x)]);
        points.iter().map(|point| one(point[0])).collect()
    }
}

/// A prediction that appears far from its observation costs more than its absence, and is no reason to stay
/// where it is missing.
#[test]
fn a_search_leaves_the_place_of_missing_predictions() {
    for start in [0.5, 1.9, 2.1] {
        let model = Appearing {
            parameters: vec![linear("x", start, [0.0, 30.0])],
            observations: Observation::list(&[80.0, 8000.0], 1.0),
        };
        let found = fit(&model, &FitOptions::default()).unwrap();
        assert!(found.converged && found.missing.is_empty(), "{start}: {:?}", found.termination);
        assert!((found.point[0] - 8.0).abs() < 1e-6, "{start}: {:?}", found.point);
    }
}

/// Predictions with an error of a hundredth of a standard deviation, which is as large as their change in a step
/// of a thousandth: derivatives are differences over longer steps, and the minimum is found to a tenth of its
/// standard deviation.
#[test]
fn errors_of_the_predictions_do_not_spoil_the_derivatives() {
    let rows: Vec<f64> = (0..40).map(f64::from).collect();
    let clean = |x: &[f64], t: f64| 8.0 * (x[0] - 0.2 * x[1] * t).sin() + x[1] * (0.3 * t).cos();
    let values: Vec<f64> = rows.iter().map(|&t| clean(&[1.1, 0.2], t)).collect();
    let model = FunctionModel {
        parameters: vec![linear("x", 0.6, [-2.0, 2.0]), linear("y", 0.3, [-2.0, 2.0])],
        observations: Observation::list(&values, 1.0),
        function: |x: &[f64]| {
            let error = |t: f64| 0.01 * (1e7 * (x[0] + 1.7 * x[1]) * (t + 1.0)).sin();
            rows.iter().map(|&t| clean(x, t) + error(t)).collect()
        },
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert!(found.converged, "{:?}", found.termination);
    assert!(found.chi_square < 0.05, "{} {:?}", found.chi_square, found.point);
}

/// A search that ended in the higher of two minima goes on from a draw in the lower one, and ends there.
#[test]
fn a_draw_of_lower_cost_is_a_further_start() {
    let model = FunctionModel {
        parameters: vec![Parameter::linear("x", -1.2, [-2.0, 2.0]).unwrap()],
        observations: Observation::list(&[0.0, 1.0], 0.1),
        function: |x: &[f64]| vec![3.0 * (x[0] * x[0] - 1.0), x[0]],
    };
    let found = fit(&model, &FitOptions { starts: 1, ..FitOptions::default() }).unwrap();
    assert!(found.point[0] < -0.8, "{:?}", found.point);
    let drawn = |draws: &[f64]| Posterior {
        draws: draws.iter().map(|&x| vec![x]).collect(),
        weights: vec![1.0 / draws.len() as f64; draws.len()],
        predictions: draws
            .iter()
            .map(|&x| (model.function)(&[x]).into_iter().map(Some).collect())
            .collect(),
        diagnostics: PosteriorDiagnostics::default(),
    };
    // Draws about the minimum that was found are not better, whatever their number.
    assert_eq!(found.better_draw(&drawn(&[-0.9, -0.85, -0.95])), None);
    let posterior = drawn(&[-0.9, 0.9, 1.1, 1.01]);
    let better = found.better_draw(&posterior).unwrap().to_vec();
    assert_eq!(better, [1.01]);
    let again =
        refit_with_progress(&model, &found.clone().into_solution().with_start(better), &|_| ());
    let again = again.unwrap();
    assert!((again.point[0] - 1.0).abs() < 1e-6, "{:?}", again.point);
    assert!(again.cost < 1e-9 && again.starts.len() == 2 && found.cost > 100.0);
    assert_eq!(again.better_draw(&posterior), None);
    // A draw without the predictions that the fit has does not count.
    let mut without = posterior.clone();
    without.predictions.iter_mut().for_each(|one| one[1] = None);
    assert_eq!(found.better_draw(&without), None);
}

/// A posterior of the higher of two minima, asked to end where a draw is lower, ends with the draws of its first surface, more
/// or less of which are good; that of the lower minimum is what it is without being asked.
#[test]
fn a_posterior_ends_where_a_draw_is_lower() {
    let model = |start: f64| FunctionModel {
        parameters: vec![Parameter::linear("x", start, [-4.0, 4.0]).unwrap()],
        observations: Observation::list(&[0.0, 1.0], 1.0),
        function: |x: &[f64]| vec![(x[0] * x[0] - 1.0) / 0.8, 1.0 + (x[0] - 1.0) / 1.6],
    };
    let until_the_last = PosteriorOptions {
        draws: 200,
        steps: 500,
        target_share: 1.0,
        most_times: 2,
        ..PosteriorOptions::default()
    };
    let asked = PosteriorOptions { ends_at_lower: true, ..until_the_last };
    for (start, ends) in [(-1.0, true), (1.2, false)] {
        let model = model(start);
        let found = fit(&model, &FitOptions { starts: 1, ..FitOptions::default() }).unwrap();
        assert_eq!(found.point[0] < 0.0, ends, "{:?}", found.point);
        let covariance = found.covariance().unwrap();
        let [whole, short] = [&until_the_last, &asked]
            .map(|options| found.posterior(&covariance, &[], options).unwrap());
        if ends {
            let (whole, short) = (whole.diagnostics, &short);
            assert!(found.better_draw(short).is_some());
            assert_eq!(short.diagnostics.evaluated_draws, 200);
            assert!(2 * short.diagnostics.evaluations <= whole.evaluations, "{whole:?}");
        } else {
            assert_eq!(whole, short);
            assert_eq!(found.better_draw(&short), None);
        }
    }
}

/// A gradual search that stays hundreds of deviations away from data that it cannot reach ends before it has followed the
/// valley of the others, and says so; one that reaches its data does not.
#[test]
fn a_search_far_from_its_data_ends_where_it_is_slow() {
    for (unreachable, is_slow) in [(300.0, true), (0.0, false)] {
        let model = FunctionModel {
            parameters: vec![linear("x", -2.0, [-4.0, 4.0]), linear("y", 4.0, [-16.0, 16.0])],
            observations: Observation::list(&[0.0, 0.0, unreachable], 1.0),
            function: |x: &[f64]| vec![3e4 * (x[1] - x[0] * x[0]), 20.0 * (x[0] - 1.5), 0.0],
        };
        let options = FitOptions { difference_step: 1e-4, gradual: true, ..FitOptions::default() };
        let found = fit(&model, &options).unwrap();
        let termination = found.termination;
        assert_eq!(termination == FitTermination::SlowReduction, is_slow, "{termination:?}");
        assert_eq!(found.converged, !is_slow);
        assert_eq!((found.point[0] - 1.5).abs() < 1e-3, !is_slow, "{:?}", found.point);
    }
}

/// The same with a latent, whose value in a draw has the prior of a mixture and not that of the fit: it does not count.
#[test]
fn latents_do_not_hide_a_draw_of_lower_cost() {
    let model = FunctionModel {
        parameters: vec![
            Parameter::linear("x", -1.2, [-2.0, 2.0]).unwrap(),
            Parameter::latent("z"),
        ],
        observations: Observation::list(&[0.0, 1.0, 0.0], 0.1),
        function: |x: &[f64]| vec![3.0 * (x[0] * x[0] - 1.0), x[0], 1e-3 * x[1]],
    };
    let found = fit(&model, &FitOptions { starts: 1, ..FitOptions::default() }).unwrap();
    assert!(found.point[0] < -0.8 && found.cost > 100.0, "{:?}", found.point);
    let drawn = |draw: [f64; 2]| Posterior {
        draws: vec![draw.to_vec()],
        weights: vec![1.0],
        predictions: vec![(model.function)(&draw).into_iter().map(Some).collect()],
        diagnostics: PosteriorDiagnostics::default(),
    };
    let far = drawn([1.01, 30.0]);
    assert_eq!(found.better_draw(&far), None);
    assert_eq!(found.better_latent_draw(&far), Some(&[1.01, 30.0][..]));
    let start = found.clone().into_solution().with_start(vec![1.01, 30.0]);
    let again = refit_with_progress(&model, &start, &|_| ()).unwrap();
    assert!((again.point[0] - 1.0).abs() < 1e-6 && again.point[1].abs() < 1e-3);
    // Not by a tenth: the priors of latents may explain it.
    assert_eq!(found.better_latent_draw(&drawn([found.point[0] + 1e-3, 0.0])), None);
    assert_eq!(found.better_latent_draw(&drawn([-0.99, 0.0])), None);
}
