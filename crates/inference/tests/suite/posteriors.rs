//! Posteriors against closed forms and brute-force quadrature.

use asperity_inference::{
    Covariance, Fit, FitOptions, ForwardModel, FunctionModel, Observation, Posterior,
    PosteriorMethod, PosteriorOptions, fit,
};

use crate::models::{linear, linear_with_prior};

fn fitted(model: &dyn ForwardModel) -> (Fit<'_>, Covariance) {
    let found = fit(model, &FitOptions::default()).unwrap();
    let spread = found.covariance().unwrap();
    (found, spread)
}

fn sampled(model: &dyn ForwardModel, options: &PosteriorOptions) -> Posterior {
    let (found, spread) = fitted(model);
    found.posterior(&spread, &[], options).unwrap()
}

/// Least effective sample size of 4000 draws (asserted below).
const MIN_EFFECTIVE: f64 = 1500.0;

fn plenty() -> PosteriorOptions {
    PosteriorOptions { draws: 4000, steps: 4000, ..PosteriorOptions::default() }
}

fn assert_trustworthy(found: &Posterior) {
    let diagnostics = &found.diagnostics;
    assert!(diagnostics.r_hat.iter().all(|&r| r < 1.01), "{diagnostics:?}");
    assert!(
        diagnostics.effective_sample_size.iter().all(|&size| size > MIN_EFFECTIVE),
        "{diagnostics:?}"
    );
    assert!(diagnostics.effective_draws > 0.5 * found.draws.len() as f64, "{diagnostics:?}");
    assert!((0.2..0.95).contains(&diagnostics.acceptance), "{diagnostics:?}");
    assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

/// A straight line with times 1 to 5 and noise 0.2: normal, with the closed forms
/// `var(slope) = s^2 / 10`, `var(intercept) = s^2 (1/5 + 9/10)`, correlation `-3 / sqrt(11)`.
/// Tolerances are four standard errors with [`MIN_EFFECTIVE`] independent draws.
#[test]
fn a_linear_model_has_its_normal_posterior() {
    let times = [1.0, 2.0, 3.0, 4.0, 5.0];
    let model = FunctionModel {
        parameters: vec![
            linear("intercept", 0.0, [-100.0, 100.0]),
            linear("slope", 0.0, [-100.0, 100.0]),
        ],
        observations: Observation::list(&[3.1, 4.9, 7.2, 8.8, 11.0], 0.2),
        function: move |x: &[f64]| times.iter().map(|t| x[0] + x[1] * t).collect(),
    };
    let found = sampled(&model, &plenty());
    assert_trustworthy(&found);
    // The surface is exact, so all weights are alike.
    assert!(found.diagnostics.effective_draws > 3999.0);
    let slope = (-2.0 * 3.1 - 4.9 + 8.8 + 2.0 * 11.0) / 10.0;
    let means = [7.0 - 3.0 * slope, slope];
    let deviations = [0.2 * 1.1_f64.sqrt(), 0.2 / 10.0_f64.sqrt()];
    for j in 0..2 {
        let error = 4.0 * deviations[j] / MIN_EFFECTIVE.sqrt();
        assert!((found.mean(j) - means[j]).abs() < error, "{} {}", found.mean(j), means[j]);
        let ratio = found.standard_deviation(j) / deviations[j];
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * MIN_EFFECTIVE).sqrt(), "{ratio}");
    }
    let correlation = -3.0 / 11.0_f64.sqrt();
    let error = 4.0 * (1.0 - correlation * correlation) / MIN_EFFECTIVE.sqrt();
    assert!((found.correlation(0, 1) - correlation).abs() < error);

    // The line itself at t = 3 and 6: variance s^2 (1/5 + (t - 3)^2 / 10).
    let band = found.band(&|x| vec![x[0] + 3.0 * x[1], x[0] + 6.0 * x[1]], &[0.025, 0.5, 0.975]);
    for (point, (t, variance)) in [(3.0, 0.04 / 5.0), (6.0, 0.04 * 1.1)].into_iter().enumerate() {
        for (row, score) in band.quantiles.iter().zip([-1.959_964, 0.0, 1.959_964]) {
            let deviation: f64 = f64::sqrt(variance);
            let expected = 7.0 + slope * (t - 3.0) + score * deviation;
            // sqrt(p (1 - p) / n) over the density: 2.67 at the tails, 1.25 in the middle.
            let error = 4.0 * 2.67 * deviation / MIN_EFFECTIVE.sqrt();
            assert!((row[point] - expected).abs() < error, "{} {expected}", row[point]);
        }
    }
    let predicted = found.prediction_band(&[0.5]);
    let curve = found.band(&|x| times.iter().map(|t| x[0] + x[1] * t).collect(), &[0.5]);
    assert_eq!(predicted.quantiles, curve.quantiles, "predictions are the line");
}

/// The error stated of a quantile is its standard deviation over 60 seeds, which is known to 9 %.
#[test]
fn quantiles_state_their_monte_carlo_error() {
    let model = FunctionModel {
        parameters: vec![linear("mean", 0.0, [-100.0, 100.0])],
        observations: Observation::list(&[1.0, 2.0, 3.0], 0.2),
        function: |x: &[f64]| vec![x[0]; 3],
    };
    let (found, spread) = fitted(&model);
    let posteriors: Vec<Posterior> = (0..60)
        .map(|seed| PosteriorOptions { draws: 500, seed, ..PosteriorOptions::default() })
        .map(|options| found.posterior(&spread, &[], &options).unwrap())
        .collect();
    let count = posteriors.len() as f64;
    for level in [0.025, 0.5, 0.9] {
        let mean = |of: &dyn Fn(&Posterior) -> f64| posteriors.iter().map(of).sum::<f64>() / count;
        let centre = mean(&|one| one.quantile(0, level));
        let variance = mean(&|one| (one.quantile(0, level) - centre).powi(2));
        let stated = mean(&|one| one.quantile_error(0, level).powi(2));
        let ratio = (stated / variance).sqrt();
        assert!((0.75..1.35).contains(&ratio), "{level}: {ratio}");
    }
    assert!(posteriors[0].quantile_error(1, 0.5).is_nan(), "there is no such parameter");
}

/// A slope of one up to 0.5, and of [`STEEP`] beyond: no polynomial is near such predictions.
fn kinked(x: f64) -> f64 {
    if x < 0.5 { x } else { 0.5 + STEEP * (x - 0.5) }
}
const STEEP: f64 = 4.0;
const KINKS: usize = 8;

/// A poor surface takes more draws: means over 16 seeds have no bias, and vary as those of the stated
/// number of independent draws.
#[test]
fn more_draws_make_up_for_a_poor_surface() {
    let model = FunctionModel {
        parameters: (0..KINKS).map(|j| linear(&format!("x{j}"), 0.1, [-20.0, 20.0])).collect(),
        observations: Observation::list(&[0.0; KINKS], 1.0),
        function: |x: &[f64]| x.iter().map(|&x| kinked(x)).collect::<Vec<f64>>(),
    };
    let (found, spread) = fitted(&model);
    let options = PosteriorOptions {
        draws: 400,
        max_rounds: 1,
        burn_in: 500,
        steps: 1500,
        ..PosteriorOptions::default()
    };
    let posteriors: Vec<Posterior> = (0..16)
        .map(|seed| PosteriorOptions { seed, ..options })
        .map(|options| found.posterior(&spread, &[], &options).unwrap())
        .collect();
    // By the midpoint rule.
    let places = || (0..100_000).map(|k| -10.0 + (f64::from(k) + 0.5) * 2e-4);
    let density = |x: f64| (-0.5 * kinked(x) * kinked(x)).exp();
    let moment = |power: i32| places().map(|x| x.powi(power) * density(x)).sum::<f64>();
    let mean = moment(1) / moment(0);
    let variance = moment(2) / moment(0) - mean * mean;
    let (mut bias, mut squares, mut count, mut more) = (0.0, 0.0, 0.0, 0);
    for found in &posteriors {
        let diagnostics = &found.diagnostics;
        more += usize::from(diagnostics.evaluated_draws > 400);
        assert_eq!(found.draws.len(), 400);
        for j in 0..KINKS {
            let scaled = (found.mean(j) - mean) * (diagnostics.effective_draws / variance).sqrt();
            bias += scaled;
            squares += scaled * scaled;
            count += 1.0;
        }
    }
    assert!(more >= 8, "{more}");
    assert!((bias / count).abs() < 4.0 / f64::sqrt(count), "{}", bias / count);
    assert!((0.5..1.5).contains(&(squares / count)), "{}", squares / count);
}

/// A bent valley: `x` known to 1, `exp(x / 2) + y` to 0.5.
fn banana() -> FunctionModel<impl Fn(&[f64]) -> Vec<f64> + Sync> {
    FunctionModel {
        parameters: vec![
            linear_with_prior("x", 0.0, [-6.0, 6.0], 0.0, 1.0),
            linear("y", 0.0, [-9.0, 9.0]),
        ],
        observations: Observation::list(&[1.0, 0.0], 0.5),
        function: |p: &[f64]| vec![(0.5 * p[0]).exp() + p[1], 0.5 * p[1]],
    }
}

/// Means, deviations and the 90 % quantile of both parameters by the midpoint rule on a grid.
fn quadrature() -> [[f64; 3]; 2] {
    let model = banana();
    let count = 1000;
    let centre = |k: usize, reach: f64| (2.0 * (k as f64 + 0.5) / count as f64 - 1.0) * reach;
    let mut marginals = [vec![0.0; count], vec![0.0; count]];
    for i in 0..count {
        for k in 0..count {
            let p = [centre(i, 6.0), centre(k, 9.0)];
            let r = (model.function)(&p);
            let cost = ((r[0] - 1.0) / 0.5).powi(2) + (r[1] / 0.5).powi(2) + p[0] * p[0];
            let density = (-0.5 * cost).exp();
            marginals[0][i] += density;
            marginals[1][k] += density;
        }
    }
    let mut reach = [6.0, 9.0].into_iter();
    marginals.map(|marginal| {
        let reach = reach.next().unwrap();
        let total: f64 = marginal.iter().sum();
        let moment = |power: i32| {
            let terms = marginal.iter().enumerate().map(|(k, p)| p * centre(k, reach).powi(power));
            terms.sum::<f64>() / total
        };
        let mut sum = 0.0;
        let tenth = marginal.iter().position(|p| {
            sum += p;
            sum >= 0.9 * total
        });
        [moment(1), (moment(2) - moment(1).powi(2)).sqrt(), centre(tenth.unwrap(), reach)]
    })
}

/// Errors of five standard errors with [`MIN_EFFECTIVE`] draws: 1.7 sd at the 90 % quantile, and for the
/// deviation a kurtosis up to 5 instead of 3 (twice the variance).
fn assert_matches_quadrature(found: &Posterior) {
    for (j, [mean, deviation, tenth]) in quadrature().into_iter().enumerate() {
        let error = 5.0 * deviation / MIN_EFFECTIVE.sqrt();
        assert!((found.mean(j) - mean).abs() < error, "mean {} {mean}", found.mean(j));
        let spread = found.standard_deviation(j);
        assert!((spread - deviation).abs() < error, "deviation {spread} {deviation}");
        let high = found.quantile(j, 0.9);
        assert!((high - tenth).abs() < 1.7 * error + 0.02, "quantile {high} {tenth}");
    }
}

#[test]
fn a_bent_posterior_matches_quadrature() {
    let found = sampled(&banana(), &plenty());
    assert_trustworthy(&found);
    assert!(found.diagnostics.pareto_shape.is_some_and(|k| k < 0.7), "{:?}", found.diagnostics);
    assert!(found.diagnostics.surrogate_error > 1e-4, "the surface is not exact here");
    assert_matches_quadrature(&found);
    let exact =
        sampled(&banana(), &PosteriorOptions { method: PosteriorMethod::Exact, ..plenty() });
    assert_eq!(exact.diagnostics.rounds, 0);
    assert_matches_quadrature(&exact);
}

/// A strongly bent valley: the surface at the optimum fails, later rounds follow the bend. With
/// `x` normal and `y = 3 sin(0.8 x)` up to 0.3, `E[x y] = 2.4 e^-0.32` and
/// `var(y) = 4.5 (1 - e^-1.28) + 0.09`.
#[test]
fn later_rounds_follow_a_strong_bend() {
    let model = FunctionModel {
        parameters: vec![
            linear_with_prior("x", 0.0, [-6.0, 6.0], 0.0, 1.0),
            linear("y", 0.0, [-20.0, 20.0]),
        ],
        observations: Observation::list(&[0.0], 0.3),
        function: |p: &[f64]| vec![p[1] - 3.0 * (0.8 * p[0]).sin()],
    };
    let short = PosteriorOptions { max_rounds: 6, burn_in: 500, ..plenty() };
    let found = sampled(&model, &short);
    assert!(found.diagnostics.rounds > 1);
    assert_trustworthy(&found);
    let deviation = (4.5 * (1.0 - (-1.28_f64).exp()) + 0.09).sqrt();
    assert!(found.mean(0).abs() < 4.0 / MIN_EFFECTIVE.sqrt(), "{}", found.mean(0));
    assert!(found.mean(1).abs() < 4.0 * deviation / MIN_EFFECTIVE.sqrt(), "{}", found.mean(1));
    let correlation = 2.4 * (-0.32_f64).exp() / deviation;
    let error = 4.0 * (1.0 - correlation * correlation) / MIN_EFFECTIVE.sqrt();
    assert!((found.correlation(0, 1) - correlation).abs() < error, "{}", found.correlation(0, 1));
}

/// The product `a b = 2` is known to 1 %, the ratio not at all: `ln a` is uniform where both are
/// within their bounds, from `ln 0.02` to `ln 100`.
#[test]
fn an_undetermined_combination_fills_its_bounds() {
    let log = |name, start| {
        asperity_inference::Parameter::new(
            name,
            start,
            [0.01, 100.0],
            asperity_inference::ParameterScale::Logarithmic,
            None,
        )
        .unwrap()
    };
    let model = FunctionModel {
        parameters: vec![log("a", 1.0), log("b", 2.0)],
        observations: Observation::list(&[2.0, 2.0], 0.02),
        function: |x: &[f64]| vec![x[0] * x[1]; 2],
    };
    let found = sampled(&model, &plenty());
    assert_trustworthy(&found);
    let (lower, upper) = (0.02_f64.ln(), 100.0_f64.ln());
    for level in [0.1, 0.5, 0.9] {
        let expected = lower + level * (upper - lower);
        let error = 4.0 * (level * (1.0 - level) / MIN_EFFECTIVE).sqrt() * (upper - lower);
        assert!((found.quantile(0, level).ln() - expected).abs() < error, "{level}");
    }
}

/// A bound cuts a normal distribution in half: mean `sqrt(2 / pi)` deviations from it.
#[test]
fn bounds_are_hard() {
    let model = FunctionModel {
        parameters: vec![linear("x", 1.0, [0.0, 40.0])],
        observations: Observation::list(&[0.0], 1.0),
        function: |x: &[f64]| vec![x[0]],
    };
    let found = sampled(&model, &plenty());
    assert!(found.draws.iter().all(|draw| draw[0] >= 0.0));
    let mean = (2.0 / std::f64::consts::PI).sqrt();
    assert_trustworthy(&found);
    // Deviation of the half-normal: sqrt(1 - 2 / pi) = 0.60.
    assert!((found.mean(0) - mean).abs() < 4.0 * 0.603 / MIN_EFFECTIVE.sqrt(), "{}", found.mean(0));
}

#[test]
fn threads_change_nothing_and_the_seed_does() {
    let options = PosteriorOptions { draws: 200, steps: 200, ..PosteriorOptions::default() };
    let with = |threads: usize, options: &PosteriorOptions| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sampled(&banana(), options))
    };
    let one = with(1, &options);
    assert_eq!(one, with(3, &options));
    assert_ne!(one.draws, with(1, &PosteriorOptions { seed: 2, ..options }).draws);
}
