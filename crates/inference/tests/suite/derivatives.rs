//! A model's own derivatives against differences.

use asperity_inference::{
    Derivatives, FitOptions, ForwardModel, FunctionModel, Observation, Parameter, ParameterScale,
    PredictionError, Predictions, fit,
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

/// Frequency and receptance lines of a light resonance, with precise data: a step of a hundredth of the
/// parameters is wider than the resonance, and the search does not stop short with derivatives of such steps.
#[test]
fn steps_of_differences_are_narrower_than_a_resonance() {
    const RATIO: f64 = 0.01;
    let pressures: Vec<f64> = (0..6).map(|i| 5e4 * 1.5_f64.powi(i)).collect();
    let predict = |x: &[f64]| -> Vec<f64> {
        let natural = |p: f64| (x[0] * p.powf(x[1])).sqrt();
        let mut all: Vec<f64> = pressures.iter().map(|&p| natural(p)).collect();
        for &p in &pressures[..3] {
            let of = natural(p);
            for line in 0..14 {
                let ratio = (1e6 * p.powf(0.4) / 5e4_f64.powf(0.4)).sqrt() / of
                    * (1.0 + 0.004 * f64::from(line - 7));
                let (re, im) = (1.0 - ratio * ratio, 2.0 * RATIO * ratio);
                let size = re * re + im * im;
                all.extend([re / size / of.powi(2), -im / size / of.powi(2)]);
            }
        }
        all
    };
    let truth = [1e6 / 5e4_f64.powf(0.4), 0.4];
    let exact = predict(&truth);
    let largest = exact[6..].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let observations = exact.iter().enumerate().map(|(i, value)| {
        let deviation = if i < 6 { 5e-5 * value } else { 2e-3 * largest };
        Observation {
            standard_deviation: deviation,
            ..Observation::list(&[*value], 1.0)[0].clone()
        }
    });
    let model = FunctionModel {
        parameters: vec![
            Parameter::new(
                "c",
                1.2 * truth[0],
                [truth[0] / 1e3, truth[0] * 1e3],
                ParameterScale::Logarithmic,
                None,
            )
            .unwrap(),
            Parameter::new("m", 0.41, [0.02, 1.2], ParameterScale::Linear, None).unwrap(),
        ],
        observations: observations.collect(),
        function: predict,
    };
    let options =
        FitOptions { starts: 1, difference_step: 1e-2, tolerance: 1e-7, ..FitOptions::default() };
    let found = fit(&model, &options).unwrap();
    assert!(found.converged && found.chi_square < 1e-3, "{} {:?}", found.chi_square, found.point);
}
