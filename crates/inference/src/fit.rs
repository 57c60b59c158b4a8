//! Bounded nonlinear least squares from many starts.

use std::fmt;
use std::ops::Deref;

use crate::error::InferenceError;
use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::model::{ForwardModel, Predictions};
use crate::parameter::Parameter;
use crate::progress::{NO_PROGRESS, ProgressCallback, Stage};
use crate::random::latin_hypercube;
use crate::search::{FitTermination, Search, run};

/// The search from one start.
#[derive(Debug, Clone, PartialEq)]
pub struct StartOutcome {
    /// Values where the search started.
    pub start: Vec<f64>,
    /// Values where it ended.
    pub end: Vec<f64>,
    /// Cost at the end; infinite if the model has no predictions at the start.
    pub cost: f64,
    /// The reason for its end.
    pub termination: FitTermination,
}

/// A minimum that one or more starts found.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// Values of the parameters.
    pub point: Vec<f64>,
    /// Cost there.
    pub cost: f64,
    /// Number of starts that ended there.
    pub starts: usize,
}

/// The optimum of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitSolution {
    /// Values of the parameters.
    pub point: Vec<f64>,
    /// Half the sum of the losses and the squared prior residuals.
    pub cost: f64,
    /// Sum of the squared standardised residuals of the observations with a prediction.
    pub chi_square: f64,
    /// Sum of the squared standardised distances from the priors' means.
    pub prior_chi_square: f64,
    /// Predictions at the point.
    pub predictions: Predictions,
    /// `(prediction - value) / standard deviation`, or [`FitOptions::missing_residual`].
    pub residuals: Vec<f64>,
    /// Observations without a prediction at the point.
    pub missing: Vec<usize>,
    /// Robust weights of the residuals, in (0, 1]; all 1 for squared loss.
    pub weights: Vec<f64>,
    /// True for parameters on a bound.
    pub at_bound: Vec<bool>,
    /// Steps tried by all searches.
    pub iterations: usize,
    /// Points evaluated by all searches.
    pub evaluations: usize,
    /// True if the best search converged.
    pub converged: bool,
    /// The reason for its end.
    pub termination: FitTermination,
    /// Every start in its order.
    pub starts: Vec<StartOutcome>,
    /// The different minima that converged starts found, lowest cost first. Ends are the same
    /// minimum when no parameter differs by more than a thousandth of its range (in working
    /// coordinates) and the costs differ by less than one thousandth of themselves plus 0.01.
    pub distinct_optima: Vec<Optimum>,
    /// The options of the fit; later computations use its loss and steps.
    pub options: FitOptions,
}

/// A fit: the [`FitSolution`] (to which it dereferences) with the model it belongs to.
#[derive(Clone)]
pub struct Fit<'m> {
    pub(crate) problem: FitProblem<'m>,
    pub(crate) progress: &'m ProgressCallback<'m>,
    solution: FitSolution,
}

impl<'m> Fit<'m> {
    /// The fit of `model` that has ended in `solution`.
    ///
    /// # Errors
    ///
    /// [`InferenceError`] for a model that cannot be fitted, as [`fit`].
    pub fn resumed(
        model: &'m dyn ForwardModel,
        solution: FitSolution,
        progress: &'m ProgressCallback<'m>,
    ) -> Result<Self, InferenceError> {
        let FitOptions { loss, missing_residual, .. } = solution.options;
        Ok(Self { problem: FitProblem::new(model, loss, missing_residual)?, progress, solution })
    }

    /// Names and best values of the parameters.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, f64)> {
        self.problem.parameters.iter().map(Parameter::name).zip(self.point.iter().copied())
    }

    /// The best value of a parameter.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.parameters().find(|parameter| parameter.0 == name).map(|parameter| parameter.1)
    }

    /// The solution without the model.
    pub fn into_solution(self) -> FitSolution {
        self.solution
    }

    /// Working coordinates of the optimum.
    pub(crate) fn optimum(&self) -> Vec<f64> {
        self.problem.to_working(&self.point)
    }
}

impl Deref for Fit<'_> {
    type Target = FitSolution;

    fn deref(&self) -> &FitSolution {
        &self.solution
    }
}

impl fmt::Debug for Fit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fit").field("solution", &self.solution).finish_non_exhaustive()
    }
}

/// Finds the parameters of lowest cost within their bounds,
///
/// ```text
/// cost = 1/2 sum_i rho(((prediction_i - value_i) / sd_i)^2) + 1/2 sum_j ((x_j - mean_j) / sd_j)^2,
/// ```
///
/// by Levenberg-Marquardt in the working coordinates `x`. All starts are searched side by side:
/// each call of the model has the points of all of them. The first start is that of the
/// parameters, the others are a Latin hypercube over the middle 70 % of the bounds (with a prior:
/// two standard deviations about its mean, within the bounds). A step to a point without
/// predictions is rejected; a single missing prediction counts as
/// [`FitOptions::missing_residual`] and is listed in [`FitSolution::missing`].
///
/// # Errors
///
/// [`InferenceError`] for a model without parameters or observations, or with too few
/// observations; duplicate names; observations that are not finite; options out of range;
/// [`InferenceError::NoPredictions`] if the model has no predictions at any start.
///
/// # Example
///
/// ```
/// use asperity_inference::{FitOptions, FunctionModel, Observation, Parameter, fit};
///
/// let model = FunctionModel {
///     parameters: vec![Parameter::linear("slope", 1.0, [0.0, 10.0])?],
///     observations: Observation::list(&[2.1, 3.9, 6.2], 0.1),
///     function: |x: &[f64]| vec![x[0], 2.0 * x[0], 3.0 * x[0]],
/// };
/// let best = fit(&model, &FitOptions::default())?;
/// assert!((best.point[0] - 28.5 / 14.0).abs() < 1e-6);
/// # Ok::<(), asperity_inference::InferenceError>(())
/// ```
pub fn fit<'m>(
    model: &'m dyn ForwardModel,
    options: &FitOptions,
) -> Result<Fit<'m>, InferenceError> {
    fit_with_progress(model, options, NO_PROGRESS)
}

/// As [`fit`], with a callback that also receives the progress of all that follows the fit.
///
/// # Errors
///
/// Those of [`fit`].
pub fn fit_with_progress<'m>(
    model: &'m dyn ForwardModel,
    options: &FitOptions,
    progress: &'m ProgressCallback<'m>,
) -> Result<Fit<'m>, InferenceError> {
    options.check()?;
    let problem = FitProblem::new(model, options.loss, options.missing_residual)?;
    let starts = starts(&problem, options);
    fit_from(problem, &starts, options, progress)
}

/// Fits from given starts (working coordinates).
pub(crate) fn fit_from<'m>(
    problem: FitProblem<'m>,
    starts: &[Vec<f64>],
    options: &FitOptions,
    progress: &'m ProgressCallback<'m>,
) -> Result<Fit<'m>, InferenceError> {
    let free = vec![false; problem.parameters.len()];
    let mut searches: Vec<Search> =
        starts.iter().map(|x| Search::new(x.clone(), free.clone())).collect();
    run(&problem, &mut searches, options, Stage::Fit, progress);

    let outcome = |(start, search): (&Vec<f64>, &Search)| StartOutcome {
        start: problem.values_at(start),
        end: problem.values_at(&search.x),
        cost: search.cost,
        termination: search.termination.unwrap_or(FitTermination::IterationLimit),
    };
    let outcomes: Vec<StartOutcome> = starts.iter().zip(&searches).map(outcome).collect();
    let best =
        searches.iter().filter(|s| s.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(best) = best else {
        let reason = searches.iter().find_map(|search| search.error.clone());
        let reason = reason.unwrap_or_else(|| "the cost is not finite".to_owned());
        return Err(InferenceError::NoPredictions { points: searches.len(), reason });
    };
    let termination = best.termination.unwrap_or(FitTermination::IterationLimit);
    let answered = best.residuals.iter().zip(&best.predictions).filter(|(_, p)| p.is_some());
    let at_bound = |j: usize| {
        let slack = 1e-9 * (problem.upper[j] - problem.lower[j]);
        best.x[j] <= problem.lower[j] + slack || best.x[j] >= problem.upper[j] - slack
    };
    let solution = FitSolution {
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
        converged: termination.converged(),
        termination,
        distinct_optima: distinct(&problem, &outcomes),
        starts: outcomes,
        options: *options,
    };
    Ok(Fit { problem, progress, solution })
}

/// Margin of the further starts from the bounds, over the range.
const MARGIN: f64 = 0.15;

fn starts(problem: &FitProblem<'_>, options: &FitOptions) -> Vec<Vec<f64>> {
    let parameters = problem.parameters;
    let own: Vec<f64> =
        parameters.iter().map(|parameter| parameter.to_working(parameter.start())).collect();
    let mut starts = vec![own];
    for unit in latin_hypercube(options.starts - 1, parameters.len(), options.seed) {
        let place = |(j, unit): (usize, &f64)| {
            // Corners, with several extreme parameters, are far from any measurement.
            let margin = MARGIN * (problem.upper[j] - problem.lower[j]);
            let (mut lower, mut upper) = (problem.lower[j] + margin, problem.upper[j] - margin);
            if let Some(prior) = parameters[j].prior() {
                let width = 2.0 * prior.standard_deviation;
                lower = (prior.mean - width).clamp(lower, upper);
                upper = (prior.mean + width).clamp(lower, upper);
            }
            lower + unit * (upper - lower)
        };
        starts.push(unit.iter().enumerate().map(place).collect());
    }
    starts
}

fn distinct(problem: &FitProblem<'_>, outcomes: &[StartOutcome]) -> Vec<Optimum> {
    let mut ends: Vec<&StartOutcome> =
        outcomes.iter().filter(|o| o.termination.converged()).collect();
    ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut optima: Vec<Optimum> = Vec::new();
    for end in ends {
        let same = |optimum: &&mut Optimum| {
            let near = |j: usize| {
                let to = |value| problem.parameters[j].to_working(value);
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
