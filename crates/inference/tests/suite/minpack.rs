//! Minima against the crate levenberg-marquardt, a port of MINPACK's `lmder`.

use asperity_inference::{FitOptions, FunctionModel, Observation, fit};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, storage::Owned};

use crate::models::linear;

#[derive(Clone)]
struct Theirs<F> {
    residuals: F,
    point: DVector<f64>,
}

impl<F: Fn(&[f64]) -> Vec<f64>> LeastSquaresProblem<f64, Dyn, Dyn> for Theirs<F> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.point.clone_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.point.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(DVector::from_vec((self.residuals)(self.point.as_slice())))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let columns: Vec<DVector<f64>> = (0..self.point.len())
            .map(|j| {
                let step = 1e-5 * self.point[j].abs().max(1e-2);
                let at = |side: f64| {
                    let mut point = self.point.clone();
                    point[j] += side * step;
                    DVector::from_vec((self.residuals)(point.as_slice()))
                };
                (at(1.0) - at(-1.0)) / (2.0 * step)
            })
            .collect();
        Some(DMatrix::from_columns(&columns))
    }
}

/// Both minimise the same residuals from the same start; points agree to 1e-5, which is what
/// their stopping rules (1e-10 of the sum of squares) leave of a flat minimum.
fn check(residuals: impl Fn(&[f64]) -> Vec<f64> + Sync + Clone, start: &[f64], reach: f64) {
    let count = residuals(start).len();
    let parameter = |(j, &x): (usize, &f64)| linear(&format!("x{j}"), x, [x - reach, x + reach]);
    let ours = FunctionModel {
        parameters: start.iter().enumerate().map(parameter).collect(),
        observations: Observation::list(&vec![0.0; count], 1.0),
        function: residuals.clone(),
    };
    let options = FitOptions {
        tolerance: 1e-13,
        difference_step: 1e-4,
        max_iterations: 2000,
        ..FitOptions::default()
    };
    let found = fit(&ours, &options).unwrap();
    assert!(found.converged, "{:?}", found.termination);

    let theirs = Theirs { residuals, point: DVector::from_column_slice(start) };
    let (theirs, report) = LevenbergMarquardt::new()
        .with_ftol(1e-13)
        .with_xtol(1e-13)
        .with_gtol(1e-13)
        .minimize(theirs);
    assert!(report.objective_function.is_finite());
    for (ours, theirs) in found.point.iter().zip(theirs.point.iter()) {
        assert!((ours - theirs).abs() <= 1e-5 * theirs.abs().max(1e-3), "{ours} and {theirs}");
    }
    assert!(found.cost <= report.objective_function * (1.0 + 1e-6) + 1e-16);
}

#[test]
fn rosenbrock() {
    check(|x| vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]], &[-1.2, 1.0], 5.0);
}

#[test]
fn kowalik_and_osborne() {
    let y = [0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
    let u = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];
    let residuals = move |x: &[f64]| {
        let model = |u: f64| x[0] * u * (u + x[1]) / (u * (u + x[2]) + x[3]);
        y.iter().zip(u).map(|(y, u)| y - model(u)).collect()
    };
    check(residuals, &[0.25, 0.39, 0.415, 0.39], 10.0);
}

#[test]
fn osborne_one() {
    let y = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685,
        0.658, 0.628, 0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448,
        0.438, 0.431, 0.424, 0.420, 0.414, 0.411, 0.406,
    ];
    let residuals = move |x: &[f64]| {
        let model = |t: f64| x[0] + x[1] * (-t * x[3]).exp() + x[2] * (-t * x[4]).exp();
        y.iter().enumerate().map(|(i, y)| y - model(10.0 * i as f64)).collect()
    };
    check(residuals, &[0.5, 1.5, -1.0, 0.01, 0.02], 3.0);
}

#[test]
fn exponential_decay() {
    let residuals = |x: &[f64]| {
        let model = |t: f64| x[0] * (-x[1] * t).exp() + x[2];
        // A decay with a ripple that no parameters can follow: the minimum has residuals.
        let data = |t: f64| 3.0 * (-0.7 * t).exp() + 0.4 + 0.05 * (9.0 * t).sin();
        (0..40).map(|i| 0.1 * f64::from(i)).map(|t| model(t) - data(t)).collect()
    };
    check(residuals, &[1.0, 0.1, 0.0], 20.0);
}
