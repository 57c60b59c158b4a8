//! Latents with a mixture prior: a linear model, whose posterior has a closed form.

use asperity_inference::{
    Agreement, FitOptions, FunctionModel, LatentPosterior, LatentPrior, Observation, Parameter,
    PosteriorOptions, fit, matern_one_half, matern_three_halves, prior_draws, refit_with_progress,
};
use nalgebra::{DMatrix, DVector};

use crate::models::{Noise, linear_with_prior};

const LATENTS: usize = 12;
const DATA: usize = 7;
const NOISE: f64 = 0.3;

/// Covariance of places, by a length.
type Covariance = fn(&[f64], f64) -> Vec<Vec<f64>>;

/// Covariance, standard deviation and length of each component, with its weight.
const COMPONENTS: [(Covariance, f64, f64, f64); 4] = [
    (matern_three_halves, 0.5, 4.0, 1.0),
    (matern_three_halves, 1.0, 1.5, 2.0),
    (matern_three_halves, 2.0, 0.5, 1.0),
    (matern_one_half, 1.0, 2.0, 2.0),
];

fn prior(first: usize) -> LatentPrior {
    let places: Vec<f64> = (0..LATENTS).map(|i| 0.4 * i as f64).collect();
    let component = |(of, deviation, length, weight): (Covariance, f64, f64, f64)| {
        let mut covariance = of(&places, length);
        covariance.iter_mut().flatten().for_each(|entry| *entry *= deviation * deviation);
        (weight, covariance)
    };
    LatentPrior::new(first, COMPONENTS.map(component).to_vec()).unwrap()
}

/// Means over windows of the latents and an offset, which is the first parameter.
fn row(i: usize) -> Vec<f64> {
    let window = |j: usize| (-0.5 * ((j as f64 - 1.2 * i as f64) / 1.0).powi(2)).exp();
    std::iter::once(1.0).chain((0..LATENTS).map(window)).collect()
}

fn model(noise: f64) -> FunctionModel<impl Fn(&[f64]) -> Vec<f64> + Sync> {
    let mut random = Noise(5);
    let truth = |j: f64| 1.2 * (0.7 * j).sin();
    let values: Vec<f64> = (0..DATA)
        .map(|i| {
            let signal: f64 =
                row(i)[1..].iter().enumerate().map(|(j, w)| w * truth(j as f64)).sum();
            signal + 0.4 + NOISE * random.normal()
        })
        .collect();
    let mut parameters = vec![linear_with_prior("offset", 0.0, [-20.0, 20.0], 0.0, 0.5)];
    parameters.extend((0..LATENTS).map(|j| Parameter::latent(format!("z{j}"))));
    FunctionModel {
        parameters,
        observations: Observation::list(&values, noise),
        function: |x: &[f64]| {
            (0..DATA).map(|i| row(i).iter().zip(x).map(|(a, b)| a * b).sum()).collect()
        },
    }
}

fn sampled(noise: f64, draws: usize) -> LatentPosterior {
    let model = model(noise);
    let found = fit(&model, &FitOptions::default()).unwrap();
    let options = PosteriorOptions { draws, steps: 2000, ..PosteriorOptions::default() };
    found.latent_posterior(&found.linearise().unwrap(), 1.0, &prior(1), &options).unwrap()
}

/// Probabilities of the components, mean and covariance of all parameters, by the formulas of normal
/// distributions for each component.
fn closed_form(noise: f64) -> (Vec<f64>, DVector<f64>, DMatrix<f64>) {
    let model = model(noise);
    let a = DMatrix::from_fn(DATA, LATENTS + 1, |i, j| row(i)[j]);
    let y = DVector::from_iterator(DATA, model.observations.iter().map(|one| one.value));
    let (mut weights, mut parts) = (Vec::new(), Vec::new());
    let prior = prior(1);
    for (weight, own) in prior.weights().iter().zip(prior.covariances()) {
        let before = DMatrix::from_fn(LATENTS + 1, LATENTS + 1, |i, j| match (i, j) {
            (0, 0) => 0.25,
            (0, _) | (_, 0) => 0.0,
            _ => own[i - 1][j - 1],
        });
        let spread = &a * &before * a.transpose() + DMatrix::identity(DATA, DATA) * noise.powi(2);
        let inverse = spread.clone().try_inverse().unwrap();
        let mean = &before * a.transpose() * &inverse * &y;
        let covariance = &before - &before * a.transpose() * &inverse * &a * &before;
        let log = -0.5 * spread.determinant().ln() - 0.5 * (y.transpose() * &inverse * &y)[0];
        weights.push(weight * log.exp());
        parts.push((mean, covariance));
    }
    let total: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= total;
    }
    let mut mean = DVector::zeros(LATENTS + 1);
    for (weight, part) in weights.iter().zip(&parts) {
        mean += *weight * &part.0;
    }
    let mut covariance = DMatrix::zeros(LATENTS + 1, LATENTS + 1);
    for (weight, (own, spread)) in weights.iter().zip(&parts) {
        let apart = own - &mean;
        covariance += *weight * (spread + &apart * apart.transpose());
    }
    (weights, mean, covariance)
}

/// Draws against the closed form; tolerances are about four standard errors of `effective` draws.
fn assert_is_closed_form(found: &LatentPosterior, noise: f64, effective: f64) {
    let (weights, mean, covariance) = closed_form(noise);
    let posterior = &found.posterior;
    let tolerance = 4.0 / effective.sqrt();
    for (shown, expected) in found.component_probabilities(&prior(1)).iter().zip(&weights) {
        let error = tolerance * (expected * (1.0 - expected)).sqrt().max(0.02);
        assert!((shown - expected).abs() < error, "{shown} {expected}");
    }
    for j in 0..=LATENTS {
        let deviation = covariance[(j, j)].sqrt();
        assert!((posterior.mean(j) - mean[j]).abs() < tolerance * deviation, "mean {j}");
        // Fourth moments of a mixture of normals exceed those of one.
        let ratio = posterior.standard_deviation(j) / deviation;
        assert!((ratio - 1.0).abs() < 1.2 * tolerance, "deviation {j}: {ratio}");
        let expected =
            covariance[(j, LATENTS)] / (deviation * covariance[(LATENTS, LATENTS)].sqrt());
        let shown = posterior.correlation(j, LATENTS);
        assert!((shown - expected).abs() < 1.5 * tolerance, "correlation {j}: {shown} {expected}");
    }
}

#[test]
fn a_linear_model_has_its_mixture_of_normal_posteriors() {
    let found = sampled(NOISE, 4000);
    let diagnostics = &found.posterior.diagnostics;
    assert!((2..LATENTS).contains(&found.active), "{} {:?}", found.active, found.information);
    assert!(diagnostics.effective_draws > 3000.0, "{diagnostics:?}");
    assert!(diagnostics.r_hat.iter().all(|&r| r < 1.01), "{diagnostics:?}");
    assert_eq!(diagnostics.r_hat.len(), LATENTS + 1);
    assert_is_closed_form(&found, NOISE, 1500.0);
}

/// The linearised model of a linear one is exact, and so are the probabilities of the components at its best fit.
#[test]
fn a_linear_fit_knows_the_probabilities_of_the_components() {
    let model = model(NOISE);
    let found = fit(&model, &FitOptions::default()).unwrap();
    let shown = found.component_probabilities(&prior(1)).unwrap();
    for (shown, expected) in shown.iter().zip(closed_form(NOISE).0) {
        assert!((shown - expected).abs() < 1e-6, "{shown} {expected}");
    }
}

/// A fit goes on with other latents, here those of half the size, from the same function and with its derivatives: to the
/// optimum under the prior that belongs to them.
#[test]
fn a_fit_goes_on_with_other_latents() {
    let before = model(NOISE);
    let other = FunctionModel {
        parameters: before.parameters.clone(),
        observations: before.observations.clone(),
        function: |x: &[f64]| {
            let whole: Vec<f64> =
                x.iter().enumerate().map(|(j, z)| if j == 0 { *z } else { 2.0 * z }).collect();
            (before.function)(&whole)
        },
    };
    let scaled = |factor: f64| move |z: &[f64]| z.iter().map(|z| factor * z).collect::<Vec<_>>();
    let options = FitOptions { gradual: true, ..FitOptions::default() };
    let found = fit(&before, &options).unwrap().into_solution();
    let plain = fit(&before, &FitOptions::default()).unwrap();
    assert!((found.cost - plain.cost).abs() < 1e-8, "{} {}", found.cost, plain.cost);
    let latents = 1..LATENTS + 1;
    let same = found.clone().with_latents(latents, &scaled(0.5), &scaled(2.0));
    let predictions: Vec<Option<f64>> =
        (other.function)(&same.point).into_iter().map(Some).collect();
    for (a, b) in predictions.iter().zip(&found.predictions) {
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-12);
    }
    let again = refit_with_progress(&other, &same, &|_| ()).unwrap();
    let fresh = fit(&other, &FitOptions::default()).unwrap();
    assert!(again.cost < found.cost - 1e-3, "{} {}", again.cost, found.cost);
    assert!((again.cost - fresh.cost).abs() < 1e-8, "{} {}", again.cost, fresh.cost);
    for (a, b) in again.point.iter().zip(&fresh.point) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

/// Data without information leave the mixture as it was.
#[test]
fn without_information_the_posterior_is_the_prior() {
    let found = sampled(1e3, 4000);
    assert_eq!(found.active, 0);
    assert_is_closed_form(&found, 1e3, 3500.0);
}

#[test]
fn draws_depend_on_the_seed_and_not_on_threads() {
    let serial = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let one = serial.install(|| sampled(NOISE, 200));
    assert_eq!(one, sampled(NOISE, 200));
}

/// The mean of many posteriors is the resolution matrix times the truth: for a linear model, the
/// derivative of the posterior mean with respect to data times that of data with respect to latents.
#[test]
fn resolution_is_the_response_of_the_mean_to_the_truth() {
    let found = sampled(NOISE, 100);
    let (weights, ..) = closed_form(NOISE);
    let own = prior(1);
    let before = DMatrix::from_fn(LATENTS + 1, LATENTS + 1, |i, j| match (i, j) {
        (0, 0) => 0.25,
        (0, _) | (_, 0) => 0.0,
        _ => {
            let pairs = own.covariances().iter().zip(&weights);
            pairs.map(|(s, weight)| weight * s[i - 1][j - 1]).sum()
        }
    });
    let a = DMatrix::from_fn(DATA, LATENTS + 1, |i, j| row(i)[j]);
    let spread = &a * &before * a.transpose() + DMatrix::identity(DATA, DATA) * NOISE.powi(2);
    let of_latents = a.columns(1, LATENTS);
    let expected = &before * a.transpose() * spread.try_inverse().unwrap() * of_latents;
    assert!(expected[(0, 0)].abs() > 1e-3, "the offset follows the latents");
    for i in 0..=LATENTS {
        for j in 0..LATENTS {
            let apart = found.resolution[i][j] - expected[(i, j)];
            assert!(apart.abs() < 1e-7, "{i} {j}: {apart}");
        }
    }
}

#[test]
fn prior_draws_have_the_covariance_of_the_mixture() {
    let own = prior(1);
    let count = 20_000;
    let draws = prior_draws(&model(NOISE).parameters, std::slice::from_ref(&own), count, 3);
    let moment =
        |i: usize, j: usize| draws.iter().map(|draw| draw[i] * draw[j]).sum::<f64>() / count as f64;
    assert!((moment(0, 0) / 0.25 - 1.0).abs() < 1e-3);
    for (i, j) in [(0, 0), (0, 1), (3, 8), (11, 11)] {
        let expected: f64 =
            own.covariances().iter().zip(own.weights()).map(|(s, weight)| weight * s[i][j]).sum();
        let error = (moment(i + 1, j + 1) - expected).abs();
        // The standard deviation of a product is at most that of a normal square, times the mixture's
        // excess.
        assert!(error < 4.0 * 4.0 / (count as f64).sqrt(), "{i} {j}: {error}");
    }
}

#[test]
fn words_of_agreement_follow_the_p_value() {
    // Chi-square 49.5 for 31 degrees of freedom has p = 0.019.
    let model = FunctionModel {
        parameters: vec![Parameter::linear("mean", 0.0, [-10.0, 10.0]).unwrap()],
        observations: Observation::list(
            &(0..32).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect::<Vec<_>>(),
            (32.0_f64 / 49.5).sqrt(),
        ),
        function: |x: &[f64]| vec![x[0]; 32],
    };
    let goodness = fit(&model, &FitOptions::default()).unwrap().goodness();
    assert!((goodness.chi_square - 49.5).abs() < 1e-9 && goodness.degrees_of_freedom == 31);
    assert!((goodness.p_value.unwrap() - 0.0188).abs() < 2e-4, "{:?}", goodness.p_value);
    assert_eq!(goodness.agreement(), Agreement::Doubtful);
    assert_eq!(Agreement::of(Some(0.3)), Agreement::Good);
    assert_eq!(Agreement::of(Some(1e-4)), Agreement::None);
    assert_eq!(Agreement::of(None), Agreement::Good);
}
