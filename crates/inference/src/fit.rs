//! The best values of the unknowns: bounded nonlinear least squares from many starts.

mod descent;
mod options;
mod step;

use crate::error::IdentifyError;
use crate::model::{ForwardModel, Predictions};
use crate::problem::Problem;
use crate::random::latin_hypercube;

pub(crate) use descent::{Descent, advance};
pub use options::FitOptions;

/// What a long computation is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Searches of a fit.
    Fit,
    /// Searches along profiles.
    Profile,
    /// Training points of the response surface.
    Surrogate,
    /// Steps of the sampler.
    Sampling,
    /// Draws evaluated on the model.
    Draws,
    /// Folds of a cross-validation.
    CrossValidation,
}

/// How far a long computation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Parts done.
    pub done: usize,
    /// Parts there are.
    pub of: usize,
    /// Lowest cost so far; infinite where there is none yet.
    pub cost: f64,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The residuals are orthogonal to every direction open to the unknowns.
    SmallGradient,
    /// The cost cannot fall by more than the tolerance.
    SmallReduction,
    /// The last step was shorter than the tolerance.
    SmallStep,
    /// The allowed iterations were used up.
    MostIterations,
    /// No step, however short, lowers the cost.
    NoProgress,
    /// The model refused the start.
    Refused,
}

impl Ending {
    /// Whether the search found a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Self::SmallGradient | Self::SmallReduction | Self::SmallStep)
    }
}

/// What became of one start.
#[derive(Debug, Clone, PartialEq)]
pub struct StartOutcome {
    /// Values where the search started.
    pub start: Vec<f64>,
    /// Values where it ended.
    pub end: Vec<f64>,
    /// Cost at the end; infinite if the model refused the start.
    pub cost: f64,
    /// Why it ended.
    pub ending: Ending,
}

/// A minimum that one or more starts found.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// Values of the unknowns.
    pub point: Vec<f64>,
    /// Cost there.
    pub cost: f64,
    /// Number of starts that ended there.
    pub starts: usize,
}

/// The best fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Values of the unknowns.
    pub point: Vec<f64>,
    /// Half the sum of the losses and the squared prior residuals.
    pub cost: f64,
    /// Sum of the squared standardised residuals of the observations with a prediction.
    pub chi_square: f64,
    /// Sum of the squared standardised distances from the priors' means.
    pub prior_chi_square: f64,
    /// Predictions at the point.
    pub predictions: Predictions,
    /// `(prediction - value) / standard deviation`; the stand-in where a prediction is missing.
    pub residuals: Vec<f64>,
    /// Observations without a prediction at the point.
    pub missing: Vec<usize>,
    /// Robust weights of the residuals, in (0, 1]; all 1 for squared loss.
    pub weights: Vec<f64>,
    /// Which unknowns are on a bound.
    pub at_bound: Vec<bool>,
    /// Steps tried by all searches.
    pub iterations: usize,
    /// Points asked of the model by all searches.
    pub evaluations: usize,
    /// Whether the best search converged.
    pub converged: bool,
    /// Why it ended.
    pub ending: Ending,
    /// Every start in its order.
    pub starts: Vec<StartOutcome>,
    /// The different minima that converged starts found, lowest cost first. Ends are the same
    /// minimum when no unknown differs by more than a thousandth of its range (in working
    /// coordinates) and the costs differ by less than one thousandth of themselves plus 0.01.
    pub distinct_optima: Vec<Optimum>,
    /// The options it was found with; what follows a fit uses its loss and steps.
    pub options: FitOptions,
}

/// Finds the values with the lowest cost within the bounds,
///
/// ```text
/// cost = 1/2 sum_i rho(((prediction_i - value_i) / sd_i)^2) + 1/2 sum_j ((x_j - mean_j) / sd_j)^2,
/// ```
///
/// by Levenberg-Marquardt in the working coordinates `x`, all starts side by side: the model is
/// asked for the difference stencils of all of them in one call. The first start is the unknowns'
/// own, the others fill the middle 70 % of the bounds (with a prior: two standard deviations about its mean, within
/// the bounds) as a Latin hypercube. A refused point is a rejected step; a missing prediction
/// counts as [`FitOptions::missing_residual`] and is reported in [`Fit::missing`].
///
/// # Errors
///
/// A model without unknowns or observations, or with too few; duplicate names; observations that
/// are no numbers; options out of range; [`IdentifyError::AllRefused`] when the model refuses
/// every start.
pub fn fit(
    model: &dyn ForwardModel,
    options: &FitOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Fit, IdentifyError> {
    options.check()?;
    let problem = Problem::new(model, options.loss, options.missing_residual)?;
    let starts = starts(&problem, options);
    fit_from(&problem, &starts, options, progress)
}

/// Fits from given starts (working coordinates).
pub(crate) fn fit_from(
    problem: &Problem<'_>,
    starts: &[Vec<f64>],
    options: &FitOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Fit, IdentifyError> {
    let nothing_held = vec![false; problem.unknowns.len()];
    let mut searches: Vec<Descent> =
        starts.iter().map(|x| Descent::new(x.clone(), nothing_held.clone())).collect();
    advance(problem, &mut searches, options, Stage::Fit, progress);

    let outcome = |(start, search): (&Vec<f64>, &Descent)| StartOutcome {
        start: problem.values_at(start),
        end: problem.values_at(&search.x),
        cost: search.cost,
        ending: search.ending.unwrap_or(Ending::MostIterations),
    };
    let outcomes: Vec<StartOutcome> = starts.iter().zip(&searches).map(outcome).collect();
    let best =
        searches.iter().filter(|s| s.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(best) = best else {
        let reason = searches.iter().find_map(|search| search.refusal.clone());
        let reason = reason.unwrap_or_else(|| "the cost is not finite".to_owned());
        return Err(IdentifyError::AllRefused { points: searches.len(), reason });
    };
    let ending = best.ending.unwrap_or(Ending::MostIterations);
    let answered = best.residuals.iter().zip(&best.predictions).filter(|(_, p)| p.is_some());
    let at_bound = |j: usize| {
        let slack = 1e-9 * (problem.upper[j] - problem.lower[j]);
        best.x[j] <= problem.lower[j] + slack || best.x[j] >= problem.upper[j] - slack
    };
    Ok(Fit {
        point: problem.values_at(&best.x),
        cost: best.cost,
        chi_square: answered.map(|(residual, _)| residual * residual).sum(),
        prior_chi_square: 2.0 * problem.prior_cost(&best.x),
        predictions: best.predictions.clone(),
        residuals: best.residuals.clone(),
        missing: (0..best.predictions.len()).filter(|&i| best.predictions[i].is_none()).collect(),
        weights: best.residuals.iter().map(|&r| problem.loss.weight(r)).collect(),
        at_bound: (0..best.x.len()).map(at_bound).collect(),
        iterations: searches.iter().map(|search| search.iterations).sum(),
        evaluations: searches.iter().map(|search| search.evaluations).sum(),
        converged: ending.converged(),
        ending,
        distinct_optima: distinct(problem, &outcomes),
        starts: outcomes,
        options: *options,
    })
}

/// Share of the bounds that the further starts keep from either end.
const MARGIN: f64 = 0.15;

fn starts(problem: &Problem<'_>, options: &FitOptions) -> Vec<Vec<f64>> {
    let unknowns = problem.unknowns;
    let own: Vec<f64> =
        unknowns.iter().map(|unknown| unknown.to_working(unknown.start())).collect();
    let mut starts = vec![own];
    for unit in latin_hypercube(options.starts - 1, unknowns.len(), options.seed) {
        let place = |(j, unit): (usize, &f64)| {
            // Corners, where several unknowns are extreme at once, are far from any measurement.
            let margin = MARGIN * (problem.upper[j] - problem.lower[j]);
            let (mut lower, mut upper) = (problem.lower[j] + margin, problem.upper[j] - margin);
            if let Some(prior) = unknowns[j].prior() {
                let reach = 2.0 * prior.standard_deviation;
                lower = (prior.mean - reach).clamp(lower, upper);
                upper = (prior.mean + reach).clamp(lower, upper);
            }
            lower + unit * (upper - lower)
        };
        starts.push(unit.iter().enumerate().map(place).collect());
    }
    starts
}

fn distinct(problem: &Problem<'_>, outcomes: &[StartOutcome]) -> Vec<Optimum> {
    let mut ends: Vec<&StartOutcome> = outcomes.iter().filter(|o| o.ending.converged()).collect();
    ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut optima: Vec<Optimum> = Vec::new();
    for end in ends {
        let same = |optimum: &&mut Optimum| {
            let near = |j: usize| {
                let to = |value| problem.unknowns[j].to_working(value);
                let range = problem.upper[j] - problem.lower[j];
                (to(end.end[j]) - to(optimum.point[j])).abs() <= 1e-3 * range
            };
            (end.cost - optimum.cost) <= 0.01 + 1e-3 * optimum.cost && (0..end.end.len()).all(near)
        };
        match optima.iter_mut().find(same) {
            Some(optimum) => optimum.starts += 1,
            None => optima.push(Optimum { point: end.end.clone(), cost: end.cost, starts: 1 }),
        }
    }
    optima
}
