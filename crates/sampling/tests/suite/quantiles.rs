//! Quantiles and exceedance probabilities: definitions, and the coverage of their intervals.

use asperity_sampling::{
    ColumnSummary, Design, DesignError, Distribution, IntervalEstimate, SummaryRequest,
    ValueColumn, WeightedSample,
};

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

/// Values of a function of their number.
struct Computed<F>(u64, F);

impl<F: Fn(u64) -> f64> ValueColumn for Computed<F> {
    type Error = DesignError;

    fn scan(&self, visit: &mut dyn FnMut(&[f64])) -> Result<(), DesignError> {
        for first in (0..self.0).step_by(1000) {
            let values: Vec<f64> = (first..self.0.min(first + 1000)).map(&self.1).collect();
            visit(&values);
        }
        Ok(())
    }
}

#[test]
fn a_column_that_is_read_again_and_again_has_the_statistics_of_one_in_memory() {
    let lognormal = Distribution::lognormal(1e-9, 0.7).unwrap();
    // More values than are sorted at once.
    for rows in [1, 2, 1000, 1_500_000] {
        let design = Design::sobol(1, rows, 5).unwrap();
        let value = |row: u64| match row % 9 {
            8 => f64::NAN,
            7 => 1.25e-9,
            _ => lognormal.quantile(design.point(row)[0]),
        };
        let (probabilities, thresholds) = (vec![1e-5, 0.05, 0.5, 0.8, 0.999], vec![0.0, 1.25e-9]);
        let asked = SummaryRequest { level: 0.9, probabilities, thresholds };
        let found = ColumnSummary::of(&Computed(rows, value), &asked).unwrap().unwrap();
        let held = WeightedSample::of_equal((0..rows).map(value)).unwrap();
        assert_eq!(found.count, held.count() as u64);
        assert_eq!(found.left_out, held.left_out() as u64);
        let close = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < 1e-9;
        assert!(close(found.mean, held.mean()), "{} {}", found.mean, held.mean());
        assert!(close(found.standard_deviation, held.standard_deviation()));
        let same = |a: &IntervalEstimate, b: &IntervalEstimate| {
            close(a.value, b.value) && close(a.low, b.low) && close(a.high, b.high)
        };
        for (&p, one) in asked.probabilities.iter().zip(&found.quantiles) {
            let expected = held.quantile(p, 0.9).unwrap();
            assert!(same(one, &expected), "{rows}, {p}: {one:?} for {expected:?}");
        }
        for (&threshold, one) in asked.thresholds.iter().zip(&found.exceedances) {
            let expected = held.exceedance(threshold, 0.9).unwrap();
            assert!(same(one, &expected), "{rows}, {threshold}: {one:?} for {expected:?}");
        }
        if rows == 1 {
            assert!(found.histogram.is_none() && found.exceedance_curve.is_empty());
            continue;
        }
        let histogram = found.histogram.unwrap();
        let inside: u64 = histogram.counts.iter().sum();
        assert_eq!(inside + histogram.below + histogram.above, found.count);
        let edges = histogram.edges();
        let (from, to) = (edges[10], edges[30]);
        let within =
            held.exceedance(from, 0.9).unwrap().value - held.exceedance(to, 0.9).unwrap().value;
        let counted: u64 = histogram.counts[10..30].iter().sum();
        assert!(close(counted as f64, within * found.count as f64), "{counted}, {within}");
        for (place, share) in found.exceedance_curve.iter().skip(1) {
            let expected = held.exceedance(*place, 0.9).unwrap();
            assert!(same(share, &expected), "{rows}, {place}: {share:?} for {expected:?}");
        }
    }
    let none = ColumnSummary::of(
        &Computed(10, |_| f64::NAN),
        &SummaryRequest { level: 0.9, probabilities: vec![0.5], thresholds: Vec::new() },
    );
    assert_eq!(none, Ok(None));
    let wrong = SummaryRequest { level: 0.9, probabilities: vec![1.0], thresholds: Vec::new() };
    assert!(ColumnSummary::of(&Computed(10, |row| row as f64), &wrong).is_err());
}
