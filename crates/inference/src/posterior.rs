//! The posterior distribution of the parameters, as weighted draws.

mod on_surface;
mod options;
mod summary;

use rayon::prelude::*;

use crate::convergence::{effective_sample_size, r_hat};
use crate::covariance::Covariance;
use crate::error::{InferenceError, check_size};
use crate::fit::Fit;
use crate::fit_problem::FitProblem;
use crate::model::Predictions;
use crate::profile::Profile;
use crate::progress::{ProgressCallback, Stage, report};
use crate::sampler::{ChainLayout, Chains, sample_chains};
use crate::surrogate::Whitening;

use on_surface::AsItIs;
pub(crate) use on_surface::{SurfaceTarget, by_surrogate};
pub use options::{PosteriorMethod, PosteriorOptions};
pub use summary::CredibleBand;

/// Smallest number of walkers of an ensemble: fewer do not move independently.
const MIN_WALKERS: usize = 16;
/// Of how many draws one is evaluated first.
const PART: usize = 5;
/// Share of a profile's interval that draws may leave out.
const MAX_LEFT_OUT: f64 = 0.25;

/// Diagnostics of chains, weights and response surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PosteriorDiagnostics {
    /// Rank-normalised split R-hat of every parameter, each ensemble one chain of its walkers' steps
    /// in turn; below 1.01 is good.
    pub r_hat: Vec<f64>,
    /// Effective sample size of every parameter, of all kept steps: the smaller of the bulk sizes
    /// over walkers and of the ensembles' means.
    pub effective_sample_size: Vec<f64>,
    /// Integrated autocorrelation time of every parameter, in steps: kept steps over effective sample
    /// size.
    pub autocorrelation_time: Vec<f64>,
    /// Share of accepted moves.
    pub acceptance: f64,
    /// Effective number of weighted draws, at most their number.
    pub effective_draws: f64,
    /// Pareto shape of the largest weights, before any cut: below 0.7 weighted means are reliable. `None` where
    /// the weights are equal or too few.
    pub pareto_shape: Option<f64>,
    /// Share of draws at the limit of the response surface's range.
    pub at_range_limit: f64,
    /// Draws that were evaluated on the model: more than are kept where their weights left too few, of
    /// which the kept ones are resampled to equal weights. Weights are then cut at their mean times the
    /// root of their number, which takes a bias for less variance.
    pub evaluated_draws: usize,
    /// Response surfaces trained; 0 for the exact method.
    pub rounds: usize,
    /// Largest leave-one-out error of the last surface, in standard deviations of an observation.
    pub surrogate_error: f64,
    /// Evaluations of the model: training points with predictions and draws of all rounds; for the
    /// exact method all points.
    pub evaluations: usize,
    /// Parameters whose draws leave out more than a quarter of the profile interval: the surface
    /// then misses a part of the distribution.
    pub truncated: Vec<usize>,
}

/// Draws from the posterior distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Values of the parameters, a row per draw.
    pub draws: Vec<Vec<f64>>,
    /// Weight of every draw; they sum to 1.
    pub weights: Vec<f64>,
    /// The model's predictions at every draw; empty where it has none (weight 0).
    pub predictions: Vec<Predictions>,
    /// Diagnostics.
    pub diagnostics: PosteriorDiagnostics,
}

impl Fit<'_> {
    /// Samples `exp(-cost(x))` in working coordinates within the bounds: the loss gives the
    /// likelihood (a pseudo-likelihood unless squared) and the priors count; the observations'
    /// variances are multiplied by the square of the covariance's noise factor.
    ///
    /// Markov chains run on a response surface: polynomials of degree three (two above ten
    /// parameters) in whitened coordinates. Of their steps [`PosteriorOptions::draws`] evenly
    /// spread ones are evaluated on the model and weighted by exact over surrogate density
    /// (importance sampling), so that errors of the surface cost precision but cause no bias within
    /// its range. While the effective share of draws is below [`PosteriorOptions::target_share`],
    /// or draws are at the limit of the range, a new surface is trained at these draws and new
    /// points about them; the round with the most effective draws counts. If that is too few, up to ten times as
    /// many draws are evaluated and resampled to the number asked for. Results depend on the
    /// seed, not on the number of threads.
    ///
    /// A tail outside the range of all surfaces is missing, which the weights do not show. Compare
    /// strongly curved, heavy-tailed distributions with [`PosteriorMethod::Exact`], or give the
    /// profiles of [`Fit::profile`]: training points then follow them, and draws that do not cover
    /// them are listed in [`PosteriorDiagnostics::truncated`].
    ///
    /// # Errors
    ///
    /// Options out of range; [`InferenceError::TooFewTraining`] and
    /// [`InferenceError::MissingPredictions`] of the surface; [`InferenceError::Size`] for a
    /// covariance of another model; [`InferenceError::NoPredictions`] if no draw has a finite cost.
    ///
    /// # Example
    ///
    /// ```
    /// # use asperity_inference::*;
    /// let model = FunctionModel {
    ///     parameters: vec![Parameter::linear("mean", 1.0, [-10.0, 10.0])?],
    ///     observations: Observation::list(&[1.9, 2.1], 0.1),
    ///     function: |x: &[f64]| vec![x[0]; 2],
    /// };
    /// let best = fit(&model, &FitOptions::default())?;
    /// let posterior = best.posterior(&best.covariance()?, &[], &PosteriorOptions::default())?;
    /// assert!((posterior.mean(0) - 2.0).abs() < 0.01);
    /// # Ok::<(), InferenceError>(())
    /// ```
    pub fn posterior(
        &self,
        covariance: &Covariance,
        profiles: &[Profile],
        options: &PosteriorOptions,
    ) -> Result<Posterior, InferenceError> {
        options.check()?;
        let problem = self.problem.with_noise_factor(covariance.noise_factor);
        let count = problem.parameters.len();
        check_size("parameters of the covariance", covariance.centre.len(), count)?;
        let whitening = Whitening::of(covariance);
        let mut found = match options.method {
            PosteriorMethod::Surrogate => {
                by_surrogate(&problem, &AsItIs, whitening, profiles, options, self.progress)
                    .map(|found| found.posterior)
            }
            PosteriorMethod::Exact => exactly(&problem, &whitening, options, self.progress),
        }?;
        found.diagnostics.truncated = truncated(&found, profiles);
        Ok(found)
    }
}

/// Parameters whose draws leave out more than [`MAX_LEFT_OUT`] of their profile intervals.
fn truncated(found: &Posterior, profiles: &[Profile]) -> Vec<usize> {
    let is_truncated = |profile: &&Profile| {
        let [low, high] = profile.interval;
        let values = || found.draws.iter().filter_map(|draw| draw.get(profile.parameter).copied());
        let least = values().fold(f64::INFINITY, f64::min);
        let greatest = values().fold(f64::NEG_INFINITY, f64::max);
        let left_out = (least - low).max(0.0) + (high - greatest).max(0.0);
        left_out > MAX_LEFT_OUT * (high - low)
    };
    profiles.iter().filter(is_truncated).map(|profile| profile.parameter).collect()
}

fn layout(dimensions: usize, options: &PosteriorOptions, round: usize) -> ChainLayout {
    ChainLayout {
        dimensions,
        ensembles: options.ensembles,
        walkers: 2 * (dimensions * options.walkers_per_parameter).div_ceil(2).max(MIN_WALKERS / 2),
        burn_in: options.burn_in,
        steps: options.steps,
        seed: options.seed.wrapping_add(0x5eed * round as u64),
    }
}

/// Of `draws` states evenly spread over steps, from one walker after the other, those from `first` to
/// `end` in an order that spreads every beginning over all steps.
fn spread(chains: &Chains, draws: usize, first: usize, end: usize) -> Vec<Vec<f64>> {
    let walkers = chains.walkers.len();
    let steps = chains.walkers.first().map_or(0, Vec::len);
    let count = draws.min(walkers * steps);
    let order = (0..PART).flat_map(|offset| (offset..count).step_by(PART));
    let state = |k: usize| chains.walkers[k % walkers][k * steps / count].clone();
    order.skip(first).take(end.saturating_sub(first)).map(state).collect()
}

/// Diagnostics with those of the chains of every parameter.
fn chain_diagnostics(chains: &Chains, of_draws: PosteriorDiagnostics) -> PosteriorDiagnostics {
    let dimensions = chains.walkers.first().and_then(|chain| chain.first()).map_or(0, Vec::len);
    let of = |j: usize| -> Vec<Vec<f64>> {
        chains.walkers.iter().map(|chain| chain.iter().map(|state| state[j]).collect()).collect()
    };
    let kept: usize = chains.walkers.iter().map(Vec::len).sum();
    let of_parameter = |j: usize| {
        let chains_of_walkers = of(j);
        let ensembles = ensemble_means(&chains_of_walkers, chains.ensembles);
        let worth =
            effective_sample_size(&ensembles) * variance(&chains_of_walkers) / variance(&ensembles);
        let size = effective_sample_size(&chains_of_walkers).min(worth);
        (size, r_hat(&whole_ensembles(&chains_of_walkers, chains.ensembles)))
    };
    let (sizes, r_hat): (Vec<f64>, Vec<f64>) =
        (0..dimensions).into_par_iter().map(of_parameter).unzip();
    PosteriorDiagnostics {
        r_hat,
        autocorrelation_time: sizes.iter().map(|size| kept as f64 / size).collect(),
        effective_sample_size: sizes,
        acceptance: chains.acceptance,
        ..of_draws
    }
}

/// Each ensemble as one chain: all its walkers' first steps, then all second ones, and so on.
fn whole_ensembles(walkers: &[Vec<f64>], ensembles: usize) -> Vec<Vec<f64>> {
    let in_turn = |group: &[Vec<f64>]| {
        (0..group[0].len()).flat_map(|n| group.iter().map(move |chain| chain[n])).collect()
    };
    walkers.chunks(walkers.len() / ensembles).map(in_turn).collect()
}

/// The mean over the walkers of each ensemble, step by step. Its autocorrelation includes that
/// between walkers, which single chains do not show (Goodman and Weare 2010, section 3).
fn ensemble_means(walkers: &[Vec<f64>], ensembles: usize) -> Vec<Vec<f64>> {
    let together = |group: &[Vec<f64>]| {
        let mean = |n: usize| group.iter().map(|chain| chain[n]).sum::<f64>() / group.len() as f64;
        (0..group[0].len()).map(mean).collect()
    };
    walkers.chunks(walkers.len() / ensembles).map(together).collect()
}

fn variance(chains: &[Vec<f64>]) -> f64 {
    let count: usize = chains.iter().map(Vec::len).sum();
    let mean = chains.iter().flatten().sum::<f64>() / count as f64;
    chains.iter().flatten().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64
}

fn exactly(
    problem: &FitProblem<'_>,
    whitening: &Whitening,
    options: &PosteriorOptions,
    progress: &ProgressCallback<'_>,
) -> Result<Posterior, InferenceError> {
    let density = |z: &[f64]| {
        let x = whitening.to_working(z);
        if !problem.inside(&x) {
            return f64::NEG_INFINITY;
        }
        match problem.predict(std::slice::from_ref(&x)).first() {
            Some(Ok(predictions)) => -problem.cost(&problem.residuals(predictions), &x),
            _ => f64::NEG_INFINITY,
        }
    };
    let layout = layout(whitening.centre.len(), options, 0);
    let chains = sample_chains(&density, &layout);
    report(progress, Stage::Sampling, 1, 1);
    let x: Vec<Vec<f64>> = spread(&chains, options.draws, 0, options.draws)
        .iter()
        .map(|z| whitening.to_working(z))
        .collect();
    let answers = problem.predict(&x);
    let usable = answers.iter().filter(|answer| answer.is_ok()).count();
    if usable == 0 {
        let reason = answers.into_iter().find_map(Result::err).unwrap_or_default();
        return Err(InferenceError::NoPredictions { points: x.len(), reason });
    }
    let share = |answer: &Result<Predictions, String>| {
        if answer.is_ok() { 1.0 / usable as f64 } else { 0.0 }
    };
    let of_draws = PosteriorDiagnostics {
        effective_draws: usable as f64,
        evaluated_draws: x.len(),
        evaluations: layout.ensembles * layout.walkers * (layout.burn_in + layout.steps + 1)
            + x.len(),
        ..PosteriorDiagnostics::default()
    };
    Ok(Posterior {
        draws: x.iter().map(|x| problem.values_at(x)).collect(),
        weights: answers.iter().map(share).collect(),
        predictions: answers.into_iter().map(Result::unwrap_or_default).collect(),
        diagnostics: chain_diagnostics(&chains, of_draws),
    })
}
