//! NIST Statistical Reference Datasets, nonlinear regression: certified values and standard
//! deviations, held to six digits (<https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml>).

use asperity_inference::{FitOptions, FunctionModel, NoiseScale, Observation, fit};

use crate::models::{assert_close, linear};

/// Fits with the certified residual standard deviation as that of every observation, so that
/// the covariance is the one certified.
fn check(
    data: &[(f64, f64)],
    formula: impl Fn(f64, &[f64]) -> f64 + Sync,
    starts: &[f64],
    certified: &[(f64, f64)],
    sum_of_squares: f64,
) {
    let freedom = (data.len() - starts.len()) as f64;
    let deviation = (sum_of_squares / freedom).sqrt();
    let values: Vec<f64> = data.iter().map(|row| row.0).collect();
    // The bounds' weak precision must stay below the seventh digit: ranges of thousands of sd.
    let parameter = |(j, (&start, sure)): (usize, (&f64, &(f64, f64)))| {
        let reach = 1e4 * sure.1;
        linear(&format!("b{}", j + 1), start, [sure.0 - reach, sure.0 + reach])
    };
    let model = FunctionModel {
        parameters: starts.iter().zip(certified).enumerate().map(parameter).collect(),
        observations: Observation::list(&values, deviation),
        function: |b: &[f64]| data.iter().map(|row| formula(row.1, b)).collect(),
    };
    let options = FitOptions {
        tolerance: 1e-14,
        difference_step: 1e-4,
        max_iterations: 1000,
        ..FitOptions::default()
    };
    let found = fit(&model, &options).unwrap();
    assert!(found.converged, "{:?}", found.termination);
    let linearisation = found.linearise().unwrap();
    let covariance = linearisation.covariance(NoiseScale::Given).unwrap();
    for (j, &(value, sd)) in certified.iter().enumerate() {
        assert_close(found.point[j], value, 1e-6, "value");
        assert_close(covariance.value_standard_deviations()[j], sd, 1e-6, "standard deviation");
    }
    assert_close(found.chi_square, freedom, 1e-6, "sum of squares in units of its certified value");
}

#[test]
fn misra1a() {
    let data = [
        (10.07, 77.6),
        (14.73, 114.9),
        (17.94, 141.1),
        (23.93, 190.8),
        (29.61, 239.9),
        (35.18, 289.0),
        (40.02, 332.8),
        (44.82, 378.4),
        (50.76, 434.8),
        (55.05, 477.3),
        (61.01, 536.8),
        (66.40, 593.1),
        (75.47, 689.1),
        (81.78, 760.0),
    ];
    let certified =
        [(2.389_421_291_8e2, 2.707_007_524_1), (5.501_564_318_1e-4, 7.266_868_843_6e-6)];
    let formula = |x: f64, b: &[f64]| b[0] * (1.0 - (-b[1] * x).exp());
    check(&data, formula, &[250.0, 0.0005], &certified, 1.245_513_889_4e-1);
}

#[test]
fn danwood() {
    let data = [
        (2.138, 1.309),
        (3.421, 1.471),
        (3.597, 1.490),
        (4.340, 1.565),
        (4.882, 1.611),
        (5.660, 1.680),
    ];
    let certified =
        [(7.688_622_617_6e-1, 1.828_197_386_0e-2), (3.860_405_587_1, 5.172_661_091_3e-2)];
    let formula = |x: f64, b: &[f64]| b[0] * x.powf(b[1]);
    check(&data, formula, &[1.0, 5.0], &certified, 4.317_308_408_3e-3);
}

#[test]
fn mgh09_of_kowalik_and_osborne() {
    let data = [
        (1.957e-1, 4.0),
        (1.947e-1, 2.0),
        (1.735e-1, 1.0),
        (1.600e-1, 0.5),
        (8.44e-2, 0.25),
        (6.27e-2, 0.167),
        (4.56e-2, 0.125),
        (3.42e-2, 0.1),
        (3.23e-2, 0.0833),
        (2.35e-2, 0.0714),
        (2.46e-2, 0.0625),
    ];
    let certified = [
        (1.928_069_345_8e-1, 1.143_531_222_7e-2),
        (1.912_823_287_3e-1, 1.963_322_091_1e-1),
        (1.230_565_069_3e-1, 8.084_203_123_2e-2),
        (1.360_623_306_8e-1, 9.002_554_230_8e-2),
    ];
    let formula = |x: f64, b: &[f64]| b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
    check(&data, formula, &[0.25, 0.39, 0.415, 0.39], &certified, 3.075_056_038_5e-4);
}
