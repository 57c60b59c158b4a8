//! Markov chains on a response surface, corrected by the weights of their draws.

use std::cell::RefCell;

use super::{
    PART, Posterior, PosteriorDiagnostics, PosteriorOptions, chain_diagnostics, layout, spread,
};
use crate::error::InferenceError;
use crate::fit_problem::FitProblem;
use crate::importance::{effective_draws, normalised, pareto_shape};
use crate::linear_algebra::upper_root;
use crate::model::Predictions;
use crate::profile::Profile;
use crate::progress::{ProgressCallback, Stage, report};
use crate::sampler::sample_chains;
use crate::surrogate::{RANGE, Surrogate, Training, Whitening, sample};

/// Whitened coordinate beyond which a draw is at the limit of the response surface's range.
const RANGE_LIMIT: f64 = 0.9 * RANGE;
/// Share of such draws above which a wider surface is trained; a normal distribution has none.
const MAX_AT_RANGE_LIMIT: f64 = 0.001;
/// Factor of the range of that surface.
const WIDENING: f64 = 1.5;
/// Least draws of which a part is evaluated first.
const LEAST_PARTED: usize = 250;
/// Effective share of those draws, over the target, below which a surface is replaced at once.
const POOR: f64 = 0.5;

/// The part of a density that no response surface replaces, and the points at which its draws are
/// evaluated.
pub(crate) trait SurfaceTarget: Sync {
    /// Logarithm of the factor of `exp(-cost)` at working coordinates.
    fn log_factor(&self, x: &[f64]) -> f64;

    /// Values of all parameters of the model at draws, and the predictions there; `first` draws of
    /// the same sample came before.
    fn evaluate(
        &self,
        problem: &FitProblem<'_>,
        x: &[Vec<f64>],
        first: usize,
    ) -> (Vec<Vec<f64>>, Vec<Result<Predictions, String>>);
}

/// The density of a problem as it is.
pub(crate) struct AsItIs;

impl SurfaceTarget for AsItIs {
    fn log_factor(&self, _: &[f64]) -> f64 {
        0.0
    }

    fn evaluate(
        &self,
        problem: &FitProblem<'_>,
        x: &[Vec<f64>],
        _: usize,
    ) -> (Vec<Vec<f64>>, Vec<Result<Predictions, String>>) {
        (x.iter().map(|x| problem.values_at(x)).collect(), problem.predict(x))
    }
}

/// Draws of `exp(-cost)` times the factor of the target.
pub(crate) fn by_surrogate(
    problem: &FitProblem<'_>,
    target: &dyn SurfaceTarget,
    mut whitening: Whitening,
    profiles: &[Profile],
    options: &PosteriorOptions,
    progress: &ProgressCallback<'_>,
) -> Result<Posterior, InferenceError> {
    let mut training = Training::default();
    let mut best: Option<(f64, Posterior)> = None;
    let mut evaluations = 0;
    for round in 1..=options.max_rounds {
        let along = if round == 1 { profiles } else { &[] };
        let seed = options.seed.wrapping_add(round as u64);
        let fresh = sample(problem, &whitening, along, options.oversampling, seed, progress)?;
        evaluations += fresh.points.len();
        training.points.extend(fresh.points);
        training.predictions.extend(fresh.predictions);
        let surface = match Surrogate::from_training(problem, whitening.clone(), &training) {
            Ok(surface) => surface,
            // Too wide: the model often has no predictions.
            Err(
                InferenceError::MissingPredictions { .. } | InferenceError::TooFewTraining { .. },
            ) if best.is_none() && round < options.max_rounds => {
                whitening = whitening.halved();
                training = Training::default();
                continue;
            }
            // A later surface that fails leaves the result of the earlier rounds.
            Err(error) if best.is_none() => return Err(error),
            Err(_) => break,
        };
        let chains = sample_chains(
            &|z| surface_density(problem, target, &surface, z),
            &layout(whitening.centre.len(), options, round),
        );
        report(progress, Stage::Sampling, round, options.max_rounds);
        let log_ratio = |answer: &Result<Predictions, String>, x: &[f64], z: &[f64]| match answer {
            Ok(predictions) => {
                target.log_factor(x)
                    - problem.cost(&problem.residuals(predictions), x)
                    - surface_density(problem, target, &surface, z)
            }
            Err(_) => f64::NEG_INFINITY,
        };
        // A part of the draws shows a poor surface, which a better one replaces.
        let whole = round == options.max_rounds || options.draws < LEAST_PARTED;
        let parts =
            if whole { vec![options.draws] } else { vec![options.draws / PART, options.draws] };
        let (mut z, mut x): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        let (mut draws, mut answers, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        for part in parts {
            let more = spread(&chains, options.draws, z.len(), part);
            let points: Vec<Vec<f64>> = more.iter().map(|z| whitening.to_working(z)).collect();
            let (values, predicted) = target.evaluate(problem, &points, x.len());
            draws.extend(values);
            answers.extend(predicted);
            evaluations += points.len();
            z.extend(more);
            x.extend(points);
            let places = answers.iter().zip(x.iter().zip(&z));
            let ratios: Vec<f64> = places.map(|(answer, (x, z))| log_ratio(answer, x, z)).collect();
            weights = normalised(&ratios);
            if effective_draws(&weights) < POOR * options.target_share * z.len() as f64 {
                break;
            }
        }
        report(progress, Stage::Draws, round, options.max_rounds);
        let crowd = z.iter().filter(|z| z.iter().any(|z| z.abs() > RANGE_LIMIT)).count();
        let at_range_limit = crowd as f64 / z.len() as f64;
        let effective = effective_draws(&weights);
        let diagnostics = PosteriorDiagnostics {
            pareto_shape: pareto_shape(&weights),
            effective_draws: effective,
            at_range_limit,
            rounds: round,
            surrogate_error: surface.leave_one_out_errors.iter().copied().fold(0.0, f64::max),
            evaluations,
            ..chain_diagnostics(&chains, whitening.centre.len())
        };
        let narrow = at_range_limit > MAX_AT_RANGE_LIMIT;
        let enough = effective >= options.target_share * z.len() as f64 && !narrow;
        // Local training: predictions at the draws, and the earlier points among them.
        let next = localised(&x, &weights);
        training.extend(&x, &answers);
        // Draws outside the range are missing; small weights only cost precision.
        let score = if narrow { 0.25 * effective } else { effective };
        if effective > 0.0 && best.as_ref().is_none_or(|(before, _)| score > *before) {
            let predictions = answers.into_iter().map(Result::unwrap_or_default).collect();
            best = Some((score, Posterior { draws, weights, predictions, diagnostics }));
        }
        if enough {
            break;
        }
        if let Some(mut next) = next {
            if narrow {
                next.root.iter_mut().flatten().for_each(|entry| *entry *= WIDENING);
            }
            keep_near(&mut training, &next);
            whitening = next;
        }
    }
    let failed = || InferenceError::NoPredictions {
        points: options.draws,
        reason: "the cost is not finite".to_owned(),
    };
    let (_, mut posterior) = best.ok_or_else(failed)?;
    posterior.diagnostics.evaluations = evaluations;
    Ok(posterior)
}

thread_local! {
    /// Monomials and residuals of the response surface.
    static SCRATCH: RefCell<(Vec<f64>, Vec<f64>)> = const { RefCell::new((Vec::new(), Vec::new())) };
}

/// Logarithm of the density that the response surface gives, minus infinity outside its range.
fn surface_density(
    problem: &FitProblem<'_>,
    target: &dyn SurfaceTarget,
    surface: &Surrogate,
    z: &[f64],
) -> f64 {
    if z.iter().any(|z| z.abs() > RANGE) {
        return f64::NEG_INFINITY;
    }
    let x = surface.whitening.to_working(z);
    if !problem.inside(&x) {
        return f64::NEG_INFINITY;
    }
    SCRATCH.with_borrow_mut(|(monomials, residuals)| {
        surface.residuals(z, monomials, residuals);
        target.log_factor(&x) - problem.cost(residuals, &x)
    })
}

/// Mean and covariance of weighted draws. Weights are cut at `mean * sqrt(count)` (E. L. Ionides,
/// J. Comp. Graph. Stat. 17, 295, 2008), so that a few large ones do not dominate.
fn localised(x: &[Vec<f64>], weights: &[f64]) -> Option<Whitening> {
    let limit = (weights.len() as f64).sqrt().recip();
    let cut: Vec<f64> = weights.iter().map(|weight| weight.min(limit)).collect();
    let total: f64 = cut.iter().sum();
    let size = x.first()?.len();
    let mean = |j: usize| x.iter().zip(&cut).map(|(x, w)| x[j] * w).sum::<f64>() / total;
    let centre: Vec<f64> = (0..size).map(mean).collect();
    let entry = |i: usize, j: usize| {
        let product = |(x, w): (&Vec<f64>, &f64)| w * (x[i] - centre[i]) * (x[j] - centre[j]);
        x.iter().zip(&cut).map(product).sum::<f64>() / total
    };
    let covariance: Vec<Vec<f64>> =
        (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect();
    Some(Whitening { centre, root: upper_root(&covariance)? })
}

/// Drops training points outside the new surface's range.
fn keep_near(training: &mut Training, whitening: &Whitening) {
    let near = |x: &Vec<f64>| whitening.to_white(x).iter().all(|z| z.abs() <= RANGE);
    let keep: Vec<bool> = training.points.iter().map(near).collect();
    let mut flags = keep.iter();
    training.points.retain(|_| flags.next().is_some_and(|&keep| keep));
    let mut flags = keep.iter();
    training.predictions.retain(|_| flags.next().is_some_and(|&keep| keep));
}
