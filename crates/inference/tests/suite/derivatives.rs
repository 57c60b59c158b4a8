//! A model's own derivatives against differences.

use asperity_inference::{
    Derivatives, FitOptions, ForwardModel, Observation, Predictions, Refusal, Scale, Unknown, fit,
    linearise,
};

use crate::models::{assert_close, observations, silent};

/// `a p^m`, with derivatives that can be made wrong by a factor.
struct Power {
    unknowns: Vec<Unknown>,
    observations: Vec<Observation>,
    error: f64,
}

impl ForwardModel for Power {
    fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
        let one = |x: &Vec<f64>| (1..=4).map(|p| Some(x[0] * f64::from(p).powf(x[1]))).collect();
        points.iter().map(|x| Ok(one(x))).collect()
    }

    fn differentiate(&self, x: &[f64]) -> Option<Result<Derivatives, Refusal>> {
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
        unknowns: vec![
            Unknown::new("a", 2.0, [0.1, 50.0], Scale::Logarithmic, None).unwrap(),
            Unknown::new("m", 0.4, [0.0, 1.0], Scale::Linear, None).unwrap(),
        ],
        observations: observations(&[3.0, 4.2, 5.3, 6.0], 0.1),
        error: 1.0,
    };
    let found = fit(&model, &FitOptions::default(), &silent).unwrap();
    let tangent = linearise(&model, &found).unwrap();
    assert!(tangent.exact);
    // Fourth order with a step of 1e-3: what is left is rounding over the step.
    assert!(tangent.derivative_difference.unwrap() < 1e-10, "{:?}", tangent.derivative_difference);
    // By the logarithm of a: the prediction itself, over the standard deviation.
    assert_close(tangent.jacobian[0][0], found.predictions[0].unwrap() / 0.1, 1e-12, "chain rule");

    model.error = 1.25;
    let wrong = linearise(&model, &found).unwrap();
    assert_close(wrong.derivative_difference.unwrap(), 0.2, 1e-6, "a wrong derivative shows");
}
