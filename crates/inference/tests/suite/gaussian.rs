//! A straight line with normal noise: everything has a closed form.

use asperity_inference::{
    FitOptions, FunctionModel, NoiseScale, Observation, ProfileEnd, ProfileOptions, fit,
};

use crate::models::{assert_close, linear, linear_with_prior};

/// Times centred on zero, so that intercept and slope are independent: variances are
/// `sd^2 / n` and `sd^2 / sum t^2`.
pub(crate) const TIMES: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
pub(crate) const VALUES: [f64; 5] = [-3.1, -0.8, 1.1, 2.7, 5.1];
pub(crate) const DEVIATION: f64 = 0.2;

pub(crate) fn line(reach: f64) -> FunctionModel<impl Fn(&[f64]) -> Vec<f64> + Sync> {
    FunctionModel {
        parameters: vec![
            linear("intercept", 0.0, [-reach, reach]),
            linear("slope", 0.0, [-reach, reach]),
        ],
        observations: Observation::list(&VALUES, DEVIATION),
        function: |x: &[f64]| TIMES.iter().map(|t| x[0] + x[1] * t).collect(),
    }
}

#[test]
fn covariance_profile_and_goodness_are_the_closed_forms() {
    let model = line(1e5);
    let found = fit(&model, &FitOptions::default()).unwrap();
    let (intercept, slope) = (1.0, (6.2 + 0.8 + 2.7 + 10.2) / 10.0);
    assert_close(found.point[0], intercept, 1e-9, "intercept");
    assert_close(found.point[1], slope, 1e-9, "slope");
    let linearisation = found.linearise().unwrap();
    assert!(!linearisation.exact && linearisation.derivative_difference.is_none());
    let spread = linearisation.covariance(NoiseScale::Given).unwrap();
    let deviations = [DEVIATION / 5.0_f64.sqrt(), DEVIATION / 10.0_f64.sqrt()];
    assert_close(spread.standard_deviations[0], deviations[0], 1e-8, "sd of the intercept");
    assert_close(spread.standard_deviations[1], deviations[1], 1e-8, "sd of the slope");
    assert!(spread.correlation[0][1].abs() < 1e-8);

    // With two parameters fitted to five values, three degrees of freedom are left.
    let misfit: f64 =
        TIMES.iter().zip(VALUES).map(|(t, y)| (intercept + slope * t - y).powi(2)).sum();
    let chi_square = misfit / DEVIATION.powi(2);
    assert_close(spread.goodness.chi_square, chi_square, 1e-8, "chi-square");
    assert_eq!(spread.goodness.degrees_of_freedom, 3);
    // The tail of chi-square with three degrees of freedom, by its closed form.
    let half = 0.5 * chi_square;
    let complement = statrs_free_erfc(half.sqrt());
    let tail = complement + 2.0 * (half / std::f64::consts::PI).sqrt() * (-half).exp();
    assert_close(spread.goodness.p_value.unwrap(), tail, 1e-6, "p-value");

    let options = ProfileOptions { level: 0.95, ..ProfileOptions::default() };
    let profiles = found.profile(&spread, &[0, 1], &options).unwrap();
    for (j, profile) in profiles.iter().enumerate() {
        let reach = 1.959_963_984_540_054 * deviations[j];
        assert_eq!(profile.ends, [ProfileEnd::Crossed; 2]);
        // A side may stop within 0.2 % of the level's root.
        assert_close(found.point[j] - profile.interval[0], reach, 2.1e-3, "lower side");
        assert_close(profile.interval[1] - found.point[j], reach, 2.1e-3, "upper side");
        let interval = spread.interval(j, 0.95).unwrap();
        assert_close(interval[1] - found.point[j], reach, 1e-7, "interval of the covariance");
    }
}

/// `erfc` by Simpson's rule, independent of the crate's own distribution functions.
fn statrs_free_erfc(x: f64) -> f64 {
    let (count, end) = (4000, 8.0);
    let step = (end - x) / f64::from(count);
    let term = |i: i32| {
        let weight = if i == 0 || i == count {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        weight * (-(x + step * f64::from(i)).powi(2)).exp()
    };
    (0..=count).map(term).sum::<f64>() * step / 3.0 * 2.0 / std::f64::consts::PI.sqrt()
}

/// Residuals larger than their standard deviations widen the covariance by the Birge ratio, and
/// only then.
#[test]
fn the_birge_ratio_widens_but_never_narrows() {
    for (factor, widened) in [(0.01, true), (100.0, false)] {
        let mut model = line(1e5);
        model.observations.iter_mut().for_each(|o| o.standard_deviation *= factor);
        let found = fit(&model, &FitOptions::default()).unwrap();
        let linear = found.linearise().unwrap();
        let given = linear.covariance(NoiseScale::Given).unwrap();
        let at_least = linear.covariance(NoiseScale::AtLeastGiven).unwrap();
        let expected = if widened { (found.chi_square / 3.0).sqrt() } else { 1.0 };
        assert_close(at_least.noise_factor, expected, 1e-12, "factor");
        let ratio = at_least.standard_deviations[1] / given.standard_deviations[1];
        assert_close(ratio, expected, 1e-6, "widening");
    }
}

/// A prior and one measurement of the same number: precisions add.
#[test]
fn a_prior_counts_as_a_measurement() {
    let model = FunctionModel {
        parameters: vec![linear_with_prior("x", 0.0, [-99.0, 99.0], 1.0, 0.5)],
        observations: Observation::list(&[2.0], 0.25),
        function: |x: &[f64]| vec![x[0]],
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert_close(found.point[0], (1.0 / 0.25 + 2.0 / 0.0625) / (4.0 + 16.0), 1e-9, "mean");
    let linear = found.linearise().unwrap();
    let spread = linear.covariance(NoiseScale::Given).unwrap();
    assert_close(spread.standard_deviations[0], 20.0_f64.sqrt().recip(), 1e-9, "deviation");
    // One standardised row 1 / 0.25 times the prior's 0.5: twice as precise as before.
    let known = linear.identifiability().unwrap();
    assert_close(known.singular_values[0], 2.0, 1e-9, "singular value");
    assert_close(
        1.0 / known.singular_values[0].hypot(1.0),
        spread.standard_deviations[0] / 0.5,
        1e-9,
        "share",
    );
}

/// A model of the product alone says nothing about the ratio.
#[test]
fn an_undetermined_combination_is_found() {
    use asperity_inference::{Parameter, ParameterScale};
    let log =
        |name| Parameter::new(name, 1.0, [0.01, 100.0], ParameterScale::Logarithmic, None).unwrap();
    let model = FunctionModel {
        parameters: vec![log("a"), log("b")],
        observations: Observation::list(&[2.0, 4.1, 5.9], 0.1),
        function: |x: &[f64]| (1..=3).map(|k| f64::from(k) * x[0] * x[1]).collect(),
    };
    let found = fit(&model, &FitOptions::default()).unwrap();
    assert_close(found.point[0] * found.point[1], 27.9 / 14.0, 1e-6, "the product is determined");
    let linear = found.linearise().unwrap();
    let known = linear.identifiability().unwrap();
    assert_eq!(known.undetermined.len(), 1);
    let ratio = &known.undetermined[0];
    assert!((ratio.remaining - 1.0).abs() < 1e-6, "{}", ratio.remaining);
    assert!((ratio.weights[0].1 - 0.5_f64.sqrt()).abs() < 1e-6);
    assert!((ratio.weights[0].1 + ratio.weights[1].1).abs() < 1e-6, "opposite weights: the ratio");
    let spread = linear.covariance(NoiseScale::Given).unwrap();
    // What is left of a direction that only the bounds know: range / sqrt(12) / sqrt(2) each.
    let range = (100.0_f64 / 0.01).ln();
    assert_close(spread.standard_deviations[0], range / 24.0_f64.sqrt(), 1e-3, "finite");
    assert!(spread.correlation[0][1] < -0.99);
}
