//! Quantiles and exceedance probabilities: definitions, and the coverage of their intervals.

use asperity_design::{Design, Distribution, IntervalEstimate, WeightedSample};

/// Share of the intervals over `SAMPLES` independent samples of `n` normal numbers that hold `truth`.
fn coverage(n: u64, truth: f64, estimate: impl Fn(&WeightedSample) -> IntervalEstimate) -> f64 {
    const SAMPLES: u64 = 4000;
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    let holds = |&seed: &u64| {
        let design = Design::random(1, n, seed).unwrap();
        let values = (0..n).map(|row| normal.quantile(design.point(row)[0]));
        estimate(&WeightedSample::of_equal(values).unwrap()).holds(truth)
    };
    (0..SAMPLES).filter(holds).count() as f64 / SAMPLES as f64
}

#[test]
fn intervals_of_quantiles_hold_the_truth_as_often_as_stated() {
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    for (n, probability, level) in [(100, 0.5, 0.95), (400, 0.9, 0.95), (100, 0.2, 0.8)] {
        let truth = normal.quantile(probability);
        let found = coverage(n, truth, |sample| sample.quantile(probability, level).unwrap());
        // The standard error of the coverage is 0.004; quantiles of a discrete count add 0.01.
        assert!((found - level).abs() < 0.025, "{n}, {probability}: {found} for {level}");
    }
}

#[test]
fn intervals_of_exceedances_hold_the_truth_as_often_as_stated() {
    let normal = Distribution::normal(0.0, 1.0).unwrap();
    for (n, probability) in [(100, 0.3), (200, 0.05)] {
        let threshold = normal.quantile(1.0 - probability);
        let found = coverage(n, probability, |sample| sample.exceedance(threshold, 0.95).unwrap());
        assert!((found - 0.95).abs() < 0.03, "{n}, {probability}: {found}");
    }
}

#[test]
fn exceedance_counts_values_above_the_threshold() {
    let sample = WeightedSample::of_equal([1.0, 2.0, 3.0, 4.0, f64::NAN]).unwrap();
    let above = |threshold| sample.exceedance(threshold, 0.95).unwrap();
    assert_eq!([0.5, 1.0, 2.5, 3.0, 4.0].map(|t| above(t).value), [1.0, 0.75, 0.5, 0.25, 0.0]);
    assert_eq!((sample.left_out(), sample.count()), (1, 4));
    // Wilson's interval of 0 of n is 0 to z^2 / (n + z^2).
    let z2 = 1.959_963_984_540_054_f64.powi(2);
    assert_eq!(above(4.0).low, 0.0);
    assert!((above(4.0).high - z2 / (4.0 + z2)).abs() < 1e-12);
    assert_eq!(above(0.5).high, 1.0);
}

#[test]
fn a_weight_of_two_is_as_good_a_quantile_as_two_values() {
    let weighted = WeightedSample::new([(1.0, 1.0), (5.0, 2.0), (2.0, 1.0), (9.0, 0.0)]).unwrap();
    let repeated = WeightedSample::of_equal([1.0, 2.0, 5.0, 5.0]).unwrap();
    assert_eq!(weighted.count(), 3);
    assert_eq!(weighted.mean(), repeated.mean());
    for threshold in [0.0, 1.5, 2.0, 5.0] {
        let of = |sample: &WeightedSample| sample.exceedance(threshold, 0.9).unwrap().value;
        assert_eq!(of(&weighted), of(&repeated));
    }
    assert_eq!(weighted.effective_size(), 16.0 / 6.0);
    // Type 5: middles at 1/8, 3/8 and 3/4 of the weight.
    assert_eq!(weighted.quantile(0.25, 0.9).unwrap().value, 1.5);
    assert_eq!(weighted.quantile(0.75, 0.9).unwrap().value, 5.0);
}

#[test]
fn a_small_sample_does_not_bound_an_extreme_quantile() {
    let sample = WeightedSample::of_equal((0..50).map(f64::from)).unwrap();
    let high = sample.quantile(0.99, 0.95).unwrap();
    assert_eq!((high.value, high.high), (49.0, f64::INFINITY));
    assert!(high.low > 40.0);
    assert_eq!(sample.quantile(0.01, 0.95).unwrap().low, f64::NEG_INFINITY);
}

#[test]
fn moments_are_those_of_the_values() {
    let sample = WeightedSample::of_equal([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).unwrap();
    assert!((sample.mean() - 5.0).abs() < 1e-14);
    assert!((sample.standard_deviation() - (32.0_f64 / 7.0).sqrt()).abs() < 1e-14);
}
