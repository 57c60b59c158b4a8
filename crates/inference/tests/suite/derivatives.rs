//! A model's own derivatives against differences.

use asperity_inference::{
    Derivatives, FitOptions, ForwardModel, Observation, Parameter, ParameterScale, PredictionError,
    Predictions, fit,
};

use crate::models::assert_close;

/// `a p^m`, with derivatives that can be made wrong by a factor.
struct Power {
    parameters: Vec<Parameter>,
    observations: Vec<Observation>,
    error: f64,
}

impl ForwardModel for Power {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let one = |x: &Vec<f64>| (1..=4).map(|p| Some(x[0] * f64::from(p).powf(x[1]))).collect();
        points.iter().map(|x| Ok(one(x))).collect()
    }

    fn differentiate(&self, x: &[f64]) -> Option<Result<Derivatives, PredictionError>> {
        let row = |p: i32| {
            let power = f64::from(p).powf(x[1]);
            vec![Some(power * self.error), Some(x[0] * power * f64::from(p).ln())]
        };
        let values = self.predict(&[x.to_vec()]).remove(0).ok()?;
        Some(Ok(Derivatives { values, jacobian: (1..=4).map(row).collect() }))
    }
}

#[test]
fn own_derivatives_are_used_and_compared() {
    let mut model = Power {
        parameters: vec![
            Parameter::new("a", 2.0, [0.1, 50.0], ParameterScale::Logarithmic, None).unwrap(),
            Parameter::new("m", 0.4, [0.0, 1.0], ParameterScale::Linear, None).unwrap(),
        ],
        observations: Observation::list(&[3.0, 4.2, 5.3, 6.0], 0.1),
        error: 1.0,
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    let tangent = found.linearise().unwrap();
    assert!(tangent.exact);
    // Fourth order with a step of 1e-3: what is left is rounding over the step.
    assert!(tangent.derivative_difference.unwrap() < 1e-6, "{:?}", tangent.derivative_difference);
    // By the logarithm of a: the prediction itself, over the standard deviation.
    assert_close(tangent.jacobian[0][0], found.predictions[0].unwrap() / 0.1, 1e-12, "chain rule");

    model.error = 1.25;
    let wrong = fit(&model, &FitOptions::default()).unwrap().linearise().unwrap();
    assert_close(wrong.derivative_difference.unwrap(), 0.2, 1e-6, "a wrong derivative shows");
}
