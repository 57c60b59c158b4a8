//! A posterior along a ridge: data that determine one combination of two parameters.

use asperity_inference::{
    FitOptions, FunctionModel, Observation, Parameter, PosteriorOptions, ProfileOptions, fit,
};

/// Pressure \[Pa\] and stiffness \[Pa/m\] at which two frequencies are measured.
const PRESSURE: f64 = 137_340.0;
const STIFFNESS: f64 = 1.1374e12;

/// Frequencies \[Hz\] of a block on a contact in series with its body, `K = C p^m`.
fn frequencies(x: &[f64]) -> Vec<f64> {
    let compliance = |k: f64| 1.0 / k + 0.2 / STIFFNESS;
    let k = x[0] * PRESSURE.powf(x[1]);
    let f = 1434.387 * (compliance(STIFFNESS) / compliance(k)).sqrt();
    vec![f, f]
}

/// Only `C p^m` is determined: m is uniform where C is inside its bounds, 0.05 to 0.79.
#[test]
fn a_ridge_is_sampled_from_end_to_end() {
    for start in [0.06, 0.3, 0.7] {
        let model = FunctionModel {
            parameters: vec![
                Parameter::logarithmic("C", 1.81e10, [1e8, 1e13]).unwrap(),
                Parameter::linear("m", start, [0.05, 0.9]).unwrap(),
            ],
            observations: Observation::list(&[1434.387, 1434.387], 0.5),
            function: frequencies,
        };
        let best = fit(&model, &FitOptions { starts: 4, ..FitOptions::default() }).unwrap();
        let covariance = best.covariance().unwrap();
        let profiles = best.profile(&covariance, &[0, 1], &ProfileOptions::default()).unwrap();
        let found = best.posterior(&covariance, &profiles, &PosteriorOptions::default()).unwrap();
        let diagnostics = &found.diagnostics;
        let [low, high] = [0.025, 0.975].map(|tail| found.quantile(1, tail));
        assert!((low - 0.0685).abs() < 0.02 && (high - 0.771).abs() < 0.03, "{low} {high}");
        let [least, greatest] = profiles[1].interval;
        assert!((least - 0.05).abs() < 1e-9 && (greatest - 0.7894).abs() < 0.002, "{profiles:?}");
        assert!(diagnostics.truncated.is_empty(), "{diagnostics:?}");
    }
}
