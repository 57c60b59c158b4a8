//! A power law fitted to measured stiffnesses, with the uncertainty of its parameters.
#![allow(clippy::print_stdout, reason = "an example prints its results")]

use asperity::prelude::*;

fn main() -> Result<(), InferenceError> {
    // Pressure [MPa]; stiffness per area [1e12 Pa/m] with a standard deviation of 0.1.
    let pressures = [0.14_f64, 0.35, 0.57, 1.0];
    let coefficient = Parameter::logarithmic("coefficient", 2.0, [0.1, 100.0])?;
    let exponent = Parameter::linear("exponent", 0.5, [0.0, 1.0])?;
    let model = FunctionModel {
        parameters: vec![coefficient, exponent],
        observations: Observation::list(&[1.15, 1.75, 1.63, 2.46], 0.1),
        function: |c: &[f64]| pressures.iter().map(|p| c[0] * p.powf(c[1])).collect(),
    };
    let best = fit(&model, &FitOptions::default())?;
    let [low, high] = best.covariance()?.interval(1, 0.95)?;
    println!("K = {:.3} p^{:.3}, exponent {low:.3} to {high:.3}", best.point[0], best.point[1]);
    Ok(())
}
