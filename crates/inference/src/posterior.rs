//! The posterior distribution of the parameters, as weighted draws.

mod chains;
mod cost;
mod on_surface;
mod options;
mod summary;

use crate::covariance::Covariance;
use crate::error::{InferenceError, check_size};
use crate::fit::Fit;
use crate::fit_problem::FitProblem;
use crate::model::Predictions;
use crate::parameter::Parameter;
use crate::profile::Profile;
use crate::progress::{ProgressCallback, Stage, report};
use crate::sampler::sample_chains;
use crate::surrogate::Whitening;

pub use chains::PosteriorDiagnostics;
use chains::{chain_diagnostics, spread};
pub use cost::SurfaceCost;
use on_surface::AsItIs;
pub(crate) use on_surface::{IsLower, SurfaceTarget, by_surrogate};
pub use options::{PosteriorMethod, PosteriorOptions};
pub use summary::{CredibleBand, Posterior};

/// Share of a profile's interval that draws may leave out.
const MAX_LEFT_OUT: f64 = 0.25;

/// Fall of the cost from which a minimum is another one.
const LOWER: f64 = 0.5;

/// Share of the cost of a fit, and cost, by which a draw with latents is lower where the fit ended short.
const LATENT_LOWER: [f64; 2] = [0.1, 10.0];

impl Fit<'_> {
    /// Samples `exp(-cost(x))` in working coordinates within the bounds: the loss gives the
    /// likelihood (a pseudo-likelihood unless squared) and the priors count; the observations'
    /// variances are multiplied by the square of the covariance's noise factor.
    ///
    /// Markov chains run on a response surface: polynomials of degree three (without products of three parameters
    /// above ten of them, and of degree two above twenty) in whitened coordinates. Of their steps [`PosteriorOptions::draws`] evenly
    /// spread ones are evaluated on the model and weighted by exact over surrogate density
    /// (importance sampling), so that errors of the surface cost precision but cause no bias within
    /// its range. While the effective share of draws is below [`PosteriorOptions::target_share`],
    /// or draws are at the limit of the range, a new surface is trained at these draws and new
    /// points about them; the round with the most effective draws counts. If that is too few, or the weights then have a heavy tail (a Pareto
    /// shape above [`RELIABLE_SHAPE`](crate::RELIABLE_SHAPE)), up to ten times as
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
                let is_lower = |values: &[f64], found: &Predictions| self.is_lower(values, found);
                let problem = (&problem, &is_lower as &IsLower<'_>);
                by_surrogate(problem, &AsItIs, whitening, profiles, options, self.progress)
                    .map(|found| found.posterior)
            }
            PosteriorMethod::Exact => exactly(&problem, &whitening, options, self.progress),
        }?;
        found.diagnostics.truncated = truncated(&found, profiles);
        Ok(found)
    }

    /// The draw of least cost, if it is lower than the cost of the fit by more than half, a standard deviation along any
    /// direction: the search then ended in a minimum that is not the lowest. Draws without a prediction that the fit has do
    /// not count.
    pub fn better_draw<'p>(&self, posterior: &'p Posterior) -> Option<&'p [f64]> {
        let (draw, predictions) = self.least_draw(posterior, &|_| true)?;
        self.is_lower(draw, predictions).then_some(draw)
    }

    /// As [`better_draw`](Self::better_draw), without the priors of latents, which are not those of
    /// [`latent_posterior`](Self::latent_posterior): the draw of least cost, if it is lower by a tenth and by more than ten, which
    /// is more than another prior of latents explains.
    pub fn better_latent_draw<'p>(&self, posterior: &'p Posterior) -> Option<&'p [f64]> {
        let (draw, predictions) = self.least_draw(posterior, &is_no_latent)?;
        self.is_lower_latent(draw, predictions).then_some(draw)
    }

    fn is_lower(&self, draw: &[f64], predictions: &Predictions) -> bool {
        let cost = self.cost_of_draw(draw, predictions, &|_| true);
        cost.is_some_and(|cost| cost < self.cost - LOWER)
    }

    pub(crate) fn is_lower_latent(&self, draw: &[f64], predictions: &Predictions) -> bool {
        let x = self.problem.to_working(&self.point);
        let own = self.problem.cost_of(&self.residuals, &x, &is_no_latent);
        let [share, lower] = LATENT_LOWER;
        let cost = self.cost_of_draw(draw, predictions, &is_no_latent);
        cost.is_some_and(|cost| own - cost > lower.max(share * own))
    }

    /// The draw of least cost with the priors of the parameters that count, and its predictions.
    fn least_draw<'p>(
        &self,
        posterior: &'p Posterior,
        counts: &dyn Fn(&Parameter) -> bool,
    ) -> Option<(&'p [f64], &'p Predictions)> {
        let draws = posterior.draws.iter().zip(&posterior.predictions);
        let costs = draws.filter_map(|(draw, predictions)| {
            Some((self.cost_of_draw(draw, predictions, counts)?, (draw.as_slice(), predictions)))
        });
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, least)| least)
    }

    /// The cost of a draw with the priors of the parameters that count; none where it lacks a prediction that the fit has.
    fn cost_of_draw(
        &self,
        draw: &[f64],
        predictions: &Predictions,
        counts: &dyn Fn(&Parameter) -> bool,
    ) -> Option<f64> {
        let mut pairs = predictions.iter().zip(&self.predictions);
        let has_all = predictions.len() == self.predictions.len()
            && pairs.all(|(a, b)| a.is_some() || b.is_none());
        let x = self.problem.to_working(draw);
        has_all.then(|| self.problem.cost_of(&self.problem.residuals(predictions), &x, counts))
    }
}

fn is_no_latent(parameter: &Parameter) -> bool {
    !parameter.is_latent()
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
    let layout = options.layout(whitening.centre.len(), 0);
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
