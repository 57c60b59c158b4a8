//! Sobol indices against models whose indices are known.

use std::f64::consts::PI;

use asperity_sampling::{
    Design, Distribution, InputSpace, IntervalEstimate, SensitivitySums, SobolIndices,
};

/// Indices of a model over Saltelli's design.
fn indices(
    inputs: &InputSpace,
    base_rows: u64,
    seed: u64,
    model: impl Fn(u64, &[f64]) -> f64,
) -> SobolIndices {
    let dimensions = inputs.dimensions();
    let design = Design::saltelli(dimensions, base_rows, seed).unwrap();
    let mut sums = SensitivitySums::new(dimensions, 500, seed).unwrap();
    let size = dimensions as u64 + 2;
    for base in 0..base_rows {
        let rows = base * size..(base + 1) * size;
        let value = |row| model(row, &inputs.values(&design.point(row)));
        sums.add(base, &rows.map(value).collect::<Vec<_>>());
    }
    sums.indices(0.95).unwrap()
}

fn uniform(count: usize, lower: f64, upper: f64) -> InputSpace {
    InputSpace::independent(vec![Distribution::uniform(lower, upper).unwrap(); count]).unwrap()
}

const A: f64 = 7.0;
const B: f64 = 0.1;

/// T. Ishigami, T. Homma (1990): `sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1`.
fn ishigami(_: u64, x: &[f64]) -> f64 {
    x[0].sin() + A * x[1].sin().powi(2) + B * x[2].powi(4) * x[0].sin()
}

/// First-order and total indices of [`ishigami`] in closed form.
fn ishigami_truth() -> [[f64; 3]; 2] {
    let (p4, p8) = (PI.powi(4), PI.powi(8));
    let first = 0.5 * (1.0 + B * p4 / 5.0).powi(2);
    let second = A * A / 8.0;
    let both = B * B * p8 * (1.0 / 18.0 - 1.0 / 50.0);
    let variance = first + second + both;
    [[first, second, 0.0], [first + both, second, both]].map(|row| row.map(|v| v / variance))
}

fn pairs<'a>(
    found: &'a SobolIndices,
    truth: &'a [[f64; 3]; 2],
) -> Vec<(&'a IntervalEstimate, f64)> {
    let first = found.first.iter().zip(truth[0]);
    first.chain(found.total.iter().zip(truth[1])).collect()
}

#[test]
fn indices_of_ishigami_are_within_their_intervals() {
    let truth = ishigami_truth();
    // Published: 0.3139, 0.4424, 0; 0.5576, 0.4424, 0.2437.
    assert!((truth[0][0] - 0.3139).abs() < 1e-4 && (truth[1][2] - 0.2437).abs() < 1e-4);
    let found = indices(&uniform(3, -PI, PI), 1 << 12, 1, ishigami);
    for (estimate, truth) in pairs(&found, &truth) {
        assert!(estimate.holds(truth), "{estimate:?} for {truth}");
        assert!((estimate.value - truth).abs() < 0.01, "{estimate:?} for {truth}");
        assert!(estimate.high - estimate.low < 0.1, "{estimate:?}");
    }
    assert!((found.mean - A / 2.0).abs() < 0.01);
    assert_eq!((found.used, found.left_out), (1 << 12, 0));
}

/// Over 60 seeds and six indices, at least 93 of 100 intervals of 95 % hold the truth: they are those
/// of independent rows, and the rows of the design are more even.
#[test]
fn intervals_hold_the_truth_at_least_as_often_as_stated() {
    let truth = ishigami_truth();
    let inputs = uniform(3, -PI, PI);
    let mut held = 0;
    for seed in 0..60 {
        let found = indices(&inputs, 256, seed, ishigami);
        held += pairs(&found, &truth).iter().filter(|(one, truth)| one.holds(*truth)).count();
    }
    assert!(held >= 335, "{held} of 360");
}

#[test]
fn indices_of_a_linear_model_are_its_shares_of_variance() {
    let distributions = vec![
        Distribution::normal(3.0, 2.0).unwrap(),
        Distribution::uniform(0.0, 6.0).unwrap(),
        Distribution::triangular(0.0, 1.0, 5.0).unwrap(),
        Distribution::lognormal(1.0, 0.5).unwrap(),
    ];
    let slopes = [1.0, -1.5, 2.0, 3.0];
    let shares: Vec<f64> =
        distributions.iter().zip(slopes).map(|(one, a)| a * a * one.variance()).collect();
    let variance: f64 = shares.iter().sum();
    let inputs = InputSpace::independent(distributions).unwrap();
    // A large constant does not harm.
    let model =
        |_: u64, x: &[f64]| -> f64 { 1e6 + x.iter().zip(slopes).map(|(x, a)| a * x).sum::<f64>() };
    let found = indices(&inputs, 1 << 12, 5, model);
    assert!((found.variance / variance - 1.0).abs() < 0.01);
    for (i, share) in shares.iter().enumerate() {
        for estimate in [&found.first[i], &found.total[i]] {
            assert!(estimate.holds(share / variance), "input {i}: {estimate:?}");
            assert!((estimate.value - share / variance).abs() < 0.01);
        }
    }
}

#[test]
fn base_rows_without_a_value_are_left_out_and_counted() {
    let truth = ishigami_truth();
    // Every 97th run fails, whatever its inputs.
    let model = |row, x: &[f64]| if row % 97 == 3 { f64::NAN } else { ishigami(row, x) };
    let found = indices(&uniform(3, -PI, PI), 1 << 12, 1, model);
    let failed = (0..5_u64 << 12).filter(|row| row % 97 == 3).count() as u64;
    assert_eq!((found.used, found.left_out), ((1 << 12) - failed, failed));
    for (estimate, truth) in pairs(&found, &truth) {
        assert!(estimate.holds(truth) && (estimate.value - truth).abs() < 0.02, "{estimate:?}");
    }
}

#[test]
fn a_constant_output_has_no_indices() {
    let mut sums = SensitivitySums::new(2, 20, 1).unwrap();
    assert!(sums.indices(0.95).unwrap_err().to_string().contains("is 0; accepted: 2 to"));
    for base in 0..10 {
        sums.add(base, &[0.1; 4]);
    }
    let text = sums.indices(0.95).unwrap_err().to_string();
    assert_eq!(text, "the variance of the output is 0; it must be positive");
}
