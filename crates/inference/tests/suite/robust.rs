//! Robust losses against closed forms.

use asperity_inference::{FitOptions, FunctionModel, Loss, Observation, fit};

use crate::models::linear;

fn location(values: &[f64], loss: Loss) -> (f64, Vec<f64>) {
    let count = values.len();
    let model = FunctionModel {
        parameters: vec![linear("mean", 0.0, [-50.0, 50.0])],
        observations: Observation::list(values, 1.0),
        function: move |x: &[f64]| vec![x[0]; count],
    };
    let options = FitOptions { loss, tolerance: 1e-14, ..FitOptions::default() };
    let found = fit(&model, &options).unwrap();
    assert!(found.converged);
    (found.point[0], found.weights.clone())
}

const DATA: [f64; 6] = [-0.5, -0.2, 0.1, 0.2, 0.6, 30.0];

/// With one residual beyond the threshold `t`, Huber's estimate of a location solves
/// `sum_inside (x - y) = t`: the mean of the inside values plus `t / 5`.
#[test]
fn huber_location_has_a_closed_form() {
    let (found, weights) = location(&DATA, Loss::Huber { threshold: 1.345 });
    let expected = DATA[..5].iter().sum::<f64>() / 5.0 + 1.345 / 5.0;
    // Steps of a linear convergence stop at a fall of 1e-14 of the cost.
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    assert!((weights[5] - 1.345 / (30.0 - expected)).abs() < 1e-6);
    assert!(weights[..5].iter().all(|&weight| weight == 1.0));
}

#[test]
fn an_outlier_moves_the_mean_but_hardly_a_cauchy_fit() {
    let (squared, _) = location(&DATA, Loss::Squared);
    assert!((squared - DATA.iter().sum::<f64>() / 6.0).abs() < 1e-9);
    let (cauchy, weights) = location(&DATA, Loss::Cauchy { scale: 2.385 });
    // The stationary point of the Cauchy loss, checked by its own equation.
    let slope: f64 =
        DATA.iter().map(|y| (cauchy - y) / (1.0 + ((cauchy - y) / 2.385).powi(2))).sum();
    assert!(slope.abs() < 1e-6, "{slope}");
    assert!(cauchy < 0.3 && weights[5] < 0.01);
}
