//! The response surface against models it can and cannot copy.

use asperity_inference::{
    Covariance, Fit, FitOptions, ForwardModel, FunctionModel, InferenceError, Observation,
    Parameter, PredictionError, Predictions, Surrogate, SurrogateOptions, fit,
};

use crate::models::linear;

fn fitted(model: &dyn ForwardModel) -> (Fit<'_>, Covariance) {
    let found = fit(model, &FitOptions::default()).unwrap();
    let spread = found.covariance().unwrap();
    (found, spread)
}

/// A cubic model is copied to rounding; of another one the leave-out error is what fresh points
/// show, within a factor of two (a root mean square of heavy tails over 1000 points each).
#[test]
fn a_cubic_is_copied_and_the_error_of_others_is_known() {
    let cubic = |x: &[f64]| vec![x[0] + 0.1 * x[1].powi(3), x[0] * x[1] + x[1], x[1]];
    let model = FunctionModel {
        parameters: vec![linear("a", 0.5, [-9.0, 9.0]), linear("b", 0.5, [-9.0, 9.0])],
        observations: Observation::list(&[1.0, 0.5, 0.4], 0.3),
        function: cubic,
    };
    let (found, spread) = fitted(&model);
    let options = SurrogateOptions::default();
    let surface = Surrogate::train(&found, &spread, &options).unwrap();
    assert!(surface.leave_one_out_errors.iter().all(|&error| error < 1e-9));
    let there = [found.point[0] + 0.2, found.point[1] - 0.3];
    let expected = (cubic(&there)[0] - 1.0) / 0.3;
    assert!((surface.standardised_residuals(&there)[0] - expected).abs() < 1e-9);

    let model = FunctionModel {
        parameters: model.parameters,
        observations: model.observations,
        function: |x: &[f64]| vec![(x[0] - x[1]).exp(), x[0], x[1]],
    };
    let (found, spread) = fitted(&model);
    let options = SurrogateOptions { oversampling: 100.0, seed: 3 };
    let surface = Surrogate::train(&found, &spread, &options).unwrap();
    let fresh =
        Surrogate::train(&found, &spread, &SurrogateOptions { seed: 4, ..options }).unwrap();
    let error = surface.leave_one_out_errors[0];
    assert!(error > 1e-4, "{error}");
    // Another seed's training points are fresh ones for this surface.
    let ratio = fresh.leave_one_out_errors[0] / error;
    assert!((0.5..2.0).contains(&ratio), "{ratio}");
}

/// A second answer that exists only for `x > 0`.
struct Half {
    parameters: Vec<Parameter>,
    observations: Vec<Observation>,
}

impl ForwardModel for Half {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        points.iter().map(|x| Ok(vec![Some(x[0]), (x[0] > 0.05).then_some(x[0])])).collect()
    }
}

#[test]
fn an_observation_that_is_often_missing_is_refused_by_name() {
    let model = Half {
        parameters: vec![linear("x", 0.1, [-9.0, 0.2])],
        observations: Observation::list(&[0.1, 0.1], 1.0),
    };
    let (found, spread) = fitted(&model);
    let error = Surrogate::train(&found, &spread, &SurrogateOptions::default());
    assert!(
        matches!(&error, Err(InferenceError::MissingPredictions { label, .. }) if label == "y1"),
        "{error:?}"
    );
}
