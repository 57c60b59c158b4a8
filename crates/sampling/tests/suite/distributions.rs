//! Quantiles and moments against closed forms.

use asperity_sampling::{Design, Distribution};

fn all() -> Vec<Distribution> {
    vec![
        Distribution::uniform(-2.0, 5.0).unwrap(),
        Distribution::log_uniform(1e-3, 10.0).unwrap(),
        Distribution::normal(-3.0, 0.5).unwrap(),
        Distribution::lognormal(2e9, 0.4).unwrap(),
        Distribution::triangular(1.0, 2.0, 5.0).unwrap(),
        Distribution::triangular(1.0, 1.0, 5.0).unwrap(),
        Distribution::triangular(1.0, 5.0, 5.0).unwrap(),
    ]
}

#[test]
fn cumulative_probabilities_invert_quantiles() {
    for distribution in all() {
        for k in 1..1000 {
            let p = f64::from(k) / 1000.0;
            let back = distribution.cumulative(distribution.quantile(p));
            assert!((back / p - 1.0).abs() < 1e-12, "{distribution:?} at {p}: {back}");
        }
    }
}

#[test]
fn quantiles_are_those_of_tables() {
    let close = |value: f64, expected: f64| {
        assert!((value / expected - 1.0).abs() < 1e-13, "{value} instead of {expected}");
    };
    // Abramowitz and Stegun, table 26.5, with more digits.
    close(Distribution::normal(0.0, 1.0).unwrap().quantile(0.975), 1.959_963_984_540_054);
    close(Distribution::normal(0.0, 1.0).unwrap().quantile(0.001), -3.090_232_306_167_813_5);
    let lognormal = Distribution::lognormal(3.0, 0.2).unwrap();
    close(lognormal.quantile(0.975), 3.0 * (0.2 * 1.959_963_984_540_054_f64).exp());
    close(Distribution::triangular(0.0, 1.0, 2.0).unwrap().quantile(0.125), 0.5);
    close(Distribution::triangular(0.0, 1.0, 2.0).unwrap().quantile(0.875), 1.5);
    close(Distribution::log_uniform(1.0, 1e4).unwrap().quantile(0.25), 10.0);
}

/// The midpoint rule over the probability: its error is that of the tails at most.
#[test]
fn moments_are_those_of_the_quantile_function() {
    const CELLS: usize = 400_000;
    for distribution in all() {
        let value = |k| distribution.quantile((k as f64 + 0.5) / CELLS as f64);
        let values: Vec<f64> = (0..CELLS).map(value).collect();
        let mean = values.iter().sum::<f64>() / CELLS as f64;
        let squares: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        let variance = squares / CELLS as f64;
        let sd = distribution.variance().sqrt();
        assert!((mean - distribution.mean()).abs() < 2e-6 * sd, "{distribution:?}: mean {mean}");
        let relative = variance / distribution.variance() - 1.0;
        assert!(relative.abs() < 2e-4, "{distribution:?}: variance {relative}");
    }
}

#[test]
fn ends_are_met() {
    for distribution in [
        Distribution::uniform(0.1, 0.3).unwrap(),
        Distribution::log_uniform(0.1, 0.3).unwrap(),
        Distribution::triangular(0.1, 0.2, 0.3).unwrap(),
    ] {
        assert_eq!([0.0, 1.0].map(|p| distribution.quantile(p)), [0.1, 0.3]);
        assert_eq!([0.1, 0.3].map(|x| distribution.cumulative(x)), [0.0, 1.0]);
    }
}

#[test]
fn options_have_their_shares() {
    let choice = Distribution::choice(&[1.0, 2.0, 5.0]).unwrap();
    let design = Design::grid(vec![800]).unwrap();
    let mut counts = [0; 3];
    for row in 0..design.rows() {
        counts[choice.quantile(design.point(row)[0]) as usize] += 1;
    }
    assert_eq!(counts, [100, 200, 500]);
    assert_eq!(choice.options(), Some(3));
    assert_eq!(choice.mean(), 0.25 + 2.0 * 0.625);
    assert!((choice.variance() - (0.25 + 4.0 * 0.625 - 1.5_f64.powi(2))).abs() < 1e-15);
    assert_eq!([-1.0, 0.0, 1.5, 2.0].map(|x| choice.cumulative(x)), [0.0, 0.125, 0.375, 1.0]);
}
