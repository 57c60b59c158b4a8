//! The response surface against models it can and cannot copy.

use asperity_inference::{
    Covariance, Fit, FitOptions, ForwardModel, IdentifyError, NoiseScale, Observation, Predictions,
    Refusal, Surrogate, SurrogateOptions, Unknown, covariance, fit, linearise,
};

use crate::models::{Formula, linear, observations, silent};

fn fitted(model: &dyn ForwardModel) -> (Fit, Covariance) {
    let found = fit(model, &FitOptions::default(), &silent).unwrap();
    let tangent = linearise(model, &found).unwrap();
    let spread = covariance(model, &found, &tangent, NoiseScale::Given).unwrap();
    (found, spread)
}

/// A cubic model is copied to rounding; of another one the leave-out error is what fresh points
/// show, within a factor of two (a root mean square of heavy tails over 1000 points each).
#[test]
fn a_cubic_is_copied_and_the_error_of_others_is_known() {
    let cubic = |x: &[f64]| vec![x[0] + 0.1 * x[1].powi(3), x[0] * x[1] + x[1], x[1]];
    let model = Formula {
        unknowns: vec![linear("a", 0.5, [-9.0, 9.0]), linear("b", 0.5, [-9.0, 9.0])],
        observations: observations(&[1.0, 0.5, 0.4], 0.3),
        predict: cubic,
    };
    let (found, spread) = fitted(&model);
    let options = SurrogateOptions::default();
    let surface = Surrogate::train(&model, &found, &spread, &options, &silent).unwrap();
    assert!(surface.leave_out_errors.iter().all(|&error| error < 1e-9));
    let there = [found.point[0] + 0.2, found.point[1] - 0.3];
    let expected = (cubic(&there)[0] - 1.0) / 0.3;
    assert!((surface.standardised_residuals(&there)[0] - expected).abs() < 1e-9);

    let model = Formula {
        unknowns: model.unknowns,
        observations: model.observations,
        predict: |x: &[f64]| vec![(x[0] - x[1]).exp(), x[0], x[1]],
    };
    let (found, spread) = fitted(&model);
    let options = SurrogateOptions { oversampling: 100.0, seed: 3 };
    let surface = Surrogate::train(&model, &found, &spread, &options, &silent).unwrap();
    let fresh = Surrogate::train(
        &model,
        &found,
        &spread,
        &SurrogateOptions { seed: 4, ..options },
        &silent,
    )
    .unwrap();
    let error = surface.leave_out_errors[0];
    assert!(error > 1e-4, "{error}");
    // Another seed's training points are fresh ones for this surface.
    let ratio = fresh.leave_out_errors[0] / error;
    assert!((0.5..2.0).contains(&ratio), "{ratio}");
}

/// A second answer that exists only for `x > 0`.
struct Half {
    unknowns: Vec<Unknown>,
    observations: Vec<Observation>,
}

impl ForwardModel for Half {
    fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
        points.iter().map(|x| Ok(vec![Some(x[0]), (x[0] > 0.05).then_some(x[0])])).collect()
    }
}

#[test]
fn an_observation_that_is_often_missing_is_refused_by_name() {
    let model = Half {
        unknowns: vec![linear("x", 0.1, [-9.0, 0.2])],
        observations: observations(&[0.1, 0.1], 1.0),
    };
    let (found, spread) = fitted(&model);
    let error = Surrogate::train(&model, &found, &spread, &SurrogateOptions::default(), &silent);
    assert!(
        matches!(&error, Err(IdentifyError::OftenMissing { label, .. }) if label == "y1"),
        "{error:?}"
    );
}
