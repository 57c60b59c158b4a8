//! Markov chains on a response surface, corrected by the weights of their draws.

use std::cell::RefCell;

use super::chains::{PART, PosteriorDiagnostics, chain_diagnostics, spread};
use super::options::PosteriorOptions;
use super::summary::Posterior;
use crate::error::InferenceError;
use crate::fit_problem::FitProblem;
use crate::importance::{RELIABLE_SHAPE, effective_draws, normalised, pareto_shape};
use crate::linear_algebra::upper_root;
use crate::model::Predictions;
use crate::profile::Profile;
use crate::progress::{ProgressCallback, Stage, report};
use crate::random::{generator, uniform};
use crate::sampler::{Chains, sample_chains};
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

/// Logarithm of the density by which the best draw of a round may be below the best of all, beside the
/// number of parameters.
const MOST_BELOW: f64 = 10.0;
/// Effective draws for each coordinate, at least, of which the next surface is made.
const LEAST_LOCALISED: f64 = 8.0;

/// Stream of the random numbers of resampling.
const RESAMPLING: u64 = 0x5e1e;

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

/// A draw with what belongs to it.
#[derive(Debug, Clone)]
struct Draw {
    /// Whitened coordinates on the surface.
    z: Vec<f64>,
    /// Values of all parameters of the model.
    values: Vec<f64>,
    answer: Result<Predictions, String>,
    /// Logarithm of exact over surface density.
    log_ratio: f64,
    /// Logarithm of the exact density.
    log_density: f64,
    /// Number by which the target evaluated it.
    number: usize,
}

/// Draws from a posterior, with the number by which the target evaluated each.
pub(crate) struct NumberedDraws {
    pub(crate) posterior: Posterior,
    pub(crate) numbers: Vec<usize>,
}

/// The draws of a round.
struct Round {
    /// Effective number of them, less where the surface is too narrow.
    score: f64,
    surface: Surrogate,
    draws: Vec<Draw>,
    weights: Vec<f64>,
    diagnostics: PosteriorDiagnostics,
    /// The chains that the draws are states of.
    chains: Chains,
}

/// True for the values of all parameters, and the predictions there, of a draw that ends the rounds.
pub(crate) type IsLower<'a> = dyn Fn(&[f64], &Predictions) -> bool + 'a;

/// Draws of `exp(-cost)` times the factor of the target; those of the first round with a draw that `is_lower`, if any.
pub(crate) fn by_surrogate(
    (problem, is_lower): (&FitProblem<'_>, &IsLower<'_>),
    target: &dyn SurfaceTarget,
    mut whitening: Whitening,
    profiles: &[Profile],
    options: &PosteriorOptions,
    progress: &ProgressCallback<'_>,
) -> Result<NumberedDraws, InferenceError> {
    let mut training = Training::default();
    let mut best: Option<Round> = None;
    let (mut evaluations, mut highest) = (0, f64::NEG_INFINITY);
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
            &options.layout(whitening.centre.len(), round),
        );
        report(progress, Stage::Sampling, round, options.max_rounds);
        let is_last = round == options.max_rounds;
        let (draws, weights) = first_draws((problem, target), &surface, &chains, options, is_last);
        evaluations += draws.len();
        report(progress, Stage::Draws, round, options.max_rounds);
        let is_at_limit = |draw: &&Draw| draw.z.iter().any(|z| z.abs() > RANGE_LIMIT);
        let at_range_limit = draws.iter().filter(is_at_limit).count() as f64 / draws.len() as f64;
        let effective = effective_draws(&weights);
        let diagnostics = PosteriorDiagnostics {
            pareto_shape: pareto_shape(&weights),
            effective_draws: effective,
            at_range_limit,
            rounds: round,
            surrogate_error: surface.leave_one_out_errors.iter().copied().fold(0.0, f64::max),
            evaluations,
            ..PosteriorDiagnostics::default()
        };
        let is_better =
            |draw: &Draw| draw.answer.as_ref().is_ok_and(|found| is_lower(&draw.values, found));
        if options.ends_at_lower && draws.iter().any(is_better) {
            let score = effective;
            let found = Round { score, surface, draws, weights, diagnostics, chains };
            let as_they_are = PosteriorOptions { most_times: 0, ..*options };
            return Ok(found.completed((problem, target), &as_they_are, progress));
        }
        let narrow = at_range_limit > MAX_AT_RANGE_LIMIT;
        let enough = effective >= options.target_share * draws.len() as f64 && !narrow;
        // Local training: predictions at the draws, and the earlier points among them.
        let x: Vec<Vec<f64>> = draws.iter().map(|draw| whitening.to_working(&draw.z)).collect();
        let next = localised(&x, &tempered(&draws));
        training.extend(&x, draws.iter().map(|draw| &draw.answer));
        // Draws outside the range are missing; small weights only cost precision.
        let score = if narrow { 0.25 * effective } else { effective };
        // A surface of a small part of a wrong one's range is exact there, far from the optimum.
        let top = draws.iter().map(|draw| draw.log_density).fold(f64::NEG_INFINITY, f64::max);
        highest = highest.max(top);
        let has_collapsed = top < highest - MOST_BELOW - whitening.centre.len() as f64;
        if has_collapsed {
            continue;
        }
        if effective > 0.0 && best.as_ref().is_none_or(|before| score > before.score) {
            best = Some(Round { score, surface, draws, weights, diagnostics, chains });
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
    let mut best = best.ok_or_else(failed)?;
    best.diagnostics.evaluations = evaluations;
    Ok(best.completed((problem, target), options, progress))
}

impl Round {
    /// The draws, more of them where their weights leave too few, resampled to the number asked for.
    fn completed(
        self,
        (problem, target): (&FitProblem<'_>, &dyn SurfaceTarget),
        options: &PosteriorOptions,
        progress: &ProgressCallback<'_>,
    ) -> NumberedDraws {
        let Self { surface, mut draws, mut weights, diagnostics, chains, .. } = self;
        let mut diagnostics = chain_diagnostics(&chains, diagnostics);
        let is_poor = |weights: &[f64]| {
            effective_draws(weights) < options.target_share * options.draws as f64
        };
        let is_heavy = |found: &PosteriorDiagnostics| {
            found.pareto_shape.is_some_and(|shape| shape > RELIABLE_SHAPE)
        };
        let most = if is_poor(&weights) { options.most_times * options.draws } else { 0 };
        let reserve = spread(&chains, most, 0, most);
        let mut reserve = reserve.chunks(options.draws);
        while (is_poor(&weights) || (draws.len() > options.draws && is_heavy(&diagnostics)))
            && let Some(more) = reserve.next()
        {
            let first = draws.len();
            draws.extend(evaluated((problem, target), &surface, more, first));
            diagnostics.evaluations += more.len();
            let whole = weights_of(&draws);
            diagnostics.pareto_shape = pareto_shape(&whole);
            weights = cut(&whole);
            report(progress, Stage::Draws, draws.len(), (1 + options.most_times) * options.draws);
        }
        diagnostics.evaluated_draws = draws.len();
        diagnostics.effective_draws = effective_draws(&weights);
        if draws.len() > options.draws {
            let kept = resampled(&weights, options.draws, options.seed);
            draws = kept.into_iter().map(|place| draws[place].clone()).collect();
            weights = vec![1.0 / draws.len() as f64; draws.len()];
            // The variances of weights and of resampling add.
            let inverse = diagnostics.effective_draws.recip() + (draws.len() as f64).recip();
            diagnostics.effective_draws = inverse.recip();
        }
        let numbers = draws.iter().map(|draw| draw.number).collect();
        let (mut values, mut predictions) = (Vec::new(), Vec::new());
        for draw in draws {
            values.push(draw.values);
            predictions.push(draw.answer.unwrap_or_default());
        }
        let posterior = Posterior { draws: values, weights, predictions, diagnostics };
        NumberedDraws { posterior, numbers }
    }
}

/// Normalised weights of draws.
fn weights_of(draws: &[Draw]) -> Vec<f64> {
    normalised(&draws.iter().map(|draw| draw.log_ratio).collect::<Vec<_>>())
}

/// Weights with the power of one, a half, a quarter ... at which enough draws are effective for a
/// covariance.
fn tempered(draws: &[Draw]) -> Vec<f64> {
    let dimensions = draws.first().map_or(0, |draw| draw.z.len()) as f64;
    let least = (LEAST_LOCALISED * (dimensions + 1.0)).min(0.2 * draws.len() as f64);
    let mut power = 1.0;
    loop {
        let ratios: Vec<f64> = draws.iter().map(|draw| power * draw.log_ratio).collect();
        let weights = normalised(&ratios);
        let effective = effective_draws(&weights);
        if effective >= least || effective == 0.0 || power < LEAST_POWER {
            return weights;
        }
        power *= 0.5;
    }
}

/// Least power of weights.
const LEAST_POWER: f64 = 1e-3;

/// The draws of a round with their weights. A part of them shows a poor surface, which a better one replaces.
fn first_draws(
    model: (&FitProblem<'_>, &dyn SurfaceTarget),
    surface: &Surrogate,
    chains: &Chains,
    options: &PosteriorOptions,
    is_last: bool,
) -> (Vec<Draw>, Vec<f64>) {
    let whole = is_last || options.draws < LEAST_PARTED;
    let parts = if whole { vec![options.draws] } else { vec![options.draws / PART, options.draws] };
    let (mut draws, mut weights): (Vec<Draw>, Vec<f64>) = (Vec::new(), Vec::new());
    for part in parts {
        let more = spread(chains, options.draws, draws.len(), part);
        let first = draws.len();
        draws.extend(evaluated(model, surface, &more, first));
        weights = weights_of(&draws);
        if effective_draws(&weights) < POOR * options.target_share * draws.len() as f64 {
            break;
        }
    }
    (draws, weights)
}

/// The model at places of the surface, the first of which has the number `first`.
fn evaluated(
    (problem, target): (&FitProblem<'_>, &dyn SurfaceTarget),
    surface: &Surrogate,
    places: &[Vec<f64>],
    first: usize,
) -> Vec<Draw> {
    let x: Vec<Vec<f64>> = places.iter().map(|z| surface.whitening.to_working(z)).collect();
    let (values, answers) = target.evaluate(problem, &x, first);
    let rows = places.iter().zip(&x).zip(values.into_iter().zip(answers)).enumerate();
    rows.map(|(place, ((z, x), (values, answer)))| {
        let log_density = match &answer {
            Ok(predictions) => {
                target.log_factor(x) - problem.cost(&problem.residuals(predictions), x)
            }
            Err(_) => f64::NEG_INFINITY,
        };
        let log_ratio = log_density - surface_density(problem, target, surface, z);
        Draw { z: z.clone(), values, answer, log_ratio, log_density, number: first + place }
    })
    .collect()
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

/// Places of `count` draws of equal weight: systematic resampling.
fn resampled(weights: &[f64], count: usize, seed: u64) -> Vec<usize> {
    let offset = uniform(&mut generator(seed ^ RESAMPLING, 0));
    let (mut place, mut sum) = (0, weights.first().copied().unwrap_or(0.0));
    let one = |k: usize| {
        let level = (k as f64 + offset) / count as f64;
        while sum <= level && place + 1 < weights.len() {
            place += 1;
            sum += weights[place];
        }
        place
    };
    (0..count).map(one).collect()
}

/// Weights cut at `mean * sqrt(count)`, so that a few large ones do not dominate, with unit sum. The bias of a
/// weighted mean vanishes with their number. Source: E. L. Ionides, J. Comp. Graph. Stat. 17, 295 (2008).
fn cut(weights: &[f64]) -> Vec<f64> {
    let limit = (weights.len() as f64).sqrt().recip();
    let cut: Vec<f64> = weights.iter().map(|weight| weight.min(limit)).collect();
    let total: f64 = cut.iter().sum();
    if total > 0.0 { cut.iter().map(|weight| weight / total).collect() } else { cut }
}

/// Mean and covariance of draws with weights that are [`cut`].
fn localised(x: &[Vec<f64>], weights: &[f64]) -> Option<Whitening> {
    let cut = cut(weights);
    let size = x.first()?.len();
    let mean = |j: usize| x.iter().zip(&cut).map(|(x, w)| x[j] * w).sum::<f64>();
    let centre: Vec<f64> = (0..size).map(mean).collect();
    let entry = |i: usize, j: usize| {
        let product = |(x, w): (&Vec<f64>, &f64)| w * (x[i] - centre[i]) * (x[j] - centre[j]);
        x.iter().zip(&cut).map(product).sum::<f64>()
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
