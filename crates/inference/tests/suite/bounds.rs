//! Bounds, starts and missing predictions.

use asperity_inference::{
    FitOptions, ForwardModel, FunctionModel, Observation, Parameter, PredictionError, Predictions,
    ProfileEnd, ProfileOptions, fit,
};

use crate::models::{linear, linear_with_prior};

/// Minimise `(a + b - 3)^2 + (a - b)^2 + ((b - 0.5) / 2)^2` with `a <= 1`: on the bound the sum
/// is least where `(b - 2) + (b - 1) + (b - 0.5) / 4 = 0`, so `b = 25 / 18`.
#[test]
fn an_active_bound_gives_the_constrained_minimum() {
    let model = FunctionModel {
        parameters: vec![
            linear("a", 0.2, [-1.0, 1.0]),
            linear_with_prior("b", 0.0, [-9.0, 9.0], 0.5, 2.0),
        ],
        observations: Observation::list(&[3.0, 0.0], 1.0),
        function: |x: &[f64]| vec![x[0] + x[1], x[0] - x[1]],
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert!(found.converged);
    assert_eq!(found.at_bound, [true, false]);
    assert_eq!(found.point[0], 1.0);
    // Linear problem: differences are exact to rounding over the step.
    assert!((found.point[1] - 25.0 / 18.0).abs() < 1e-9, "{:?}", found.point);

    let spread = found.covariance().unwrap();
    let options = ProfileOptions::default();
    let profiles = found.profile(&spread, &[0], &options).unwrap();
    assert_eq!(profiles[0].ends, [ProfileEnd::Crossed, ProfileEnd::Bound]);
    assert_eq!(profiles[0].interval[1], 1.0);
    // The best b does not depend on a, and the sum is 2 (a - 3/2)^2 and a constant.
    let lower = 1.5 - f64::midpoint(0.5, 3.841_458_820_694_124).sqrt();
    assert!((profiles[0].interval[0] - lower).abs() < 3e-3, "{:?}", profiles[0].interval);
}

/// `(x^2 - 1) (weak slope)`: two valleys, both found from many starts, the deeper one first.
#[test]
fn many_starts_find_both_minima() {
    let model = FunctionModel {
        parameters: vec![linear("x", 1.4, [-2.0, 2.0])],
        observations: Observation::list(&[0.0, -1.0], 1.0),
        function: |x: &[f64]| vec![10.0 * (x[0] * x[0] - 1.0), x[0]],
    };
    let one = fit(&model, &FitOptions::default()).unwrap();
    assert!((one.point[0] - 1.0).abs() < 0.1);
    let options = FitOptions { starts: 12, ..FitOptions::default() };
    let many = fit(&model, &options).unwrap();
    assert!((many.point[0] + 1.0).abs() < 1e-6, "residuals vanish at -1");
    assert_eq!(many.distinct_optima.len(), 2);
    assert_eq!(many.distinct_optima.iter().map(|o| o.starts).sum::<usize>(), 12);
    let again = fit(&model, &options).unwrap().into_solution();
    assert_eq!(many.into_solution(), again, "results depend on the seed alone");
}

/// A model that refuses `x > 2` and has no second answer below 0.5.
struct Partial {
    parameters: Vec<Parameter>,
    observations: Vec<Observation>,
}

impl ForwardModel for Partial {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let one = |point: &Vec<f64>| match point[0] {
            x if x > 2.0 => Err(PredictionError { reason: "x is beyond 2".into() }),
            x => Ok(vec![Some(x * x), (x >= 0.5).then_some(x)]),
        };
        points.iter().map(one).collect()
    }
}

#[test]
fn refused_points_are_stepped_back_from_and_missing_answers_reported() {
    let mut model = Partial {
        parameters: vec![linear("x", 0.6, [0.01, 10.0])],
        observations: Observation::list(&[3.9, 1.9], 0.1),
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert!(found.converged && found.missing.is_empty());
    assert!((found.point[0] - 1.97).abs() < 0.02, "{:?}", found.point);

    model.observations[0].value = 0.04;
    model.parameters = vec![linear("x", 0.3, [0.01, 0.4])];
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert!((found.point[0] - 0.2).abs() < 1e-6);
    assert_eq!(found.missing, [1]);
    assert_eq!(found.residuals[1], 5.0, "the stand-in");
    assert!(found.chi_square < 1e-9, "which is no part of chi-square");
}
