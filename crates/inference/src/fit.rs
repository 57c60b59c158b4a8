//! Bounded nonlinear least squares from many starts.

use std::fmt;
use std::ops::{Deref, Range};

use faer::Mat;

use crate::error::{InferenceError, check_size};
use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::linear_algebra::dot;
use crate::model::{ForwardModel, Predictions};
use crate::parameter::Parameter;
use crate::progress::{NO_PROGRESS, ProgressCallback, Stage};
use crate::random::latin_hypercube;
use crate::search::{FitTermination, Known, Search, run, run_gradually};

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
    /// Index of its minimum in [`FitSolution::distinct_optima`]; `None` for a search that has not
    /// converged.
    pub optimum: Option<usize>,
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
    /// Derivatives of the predictions with respect to the working coordinates, as the search had
    /// them last.
    slopes: Vec<Vec<f64>>,
}

impl FitSolution {
    /// The solution of a model whose `latents` are `changed` of those of this one, a linear map; `back` is its inverse.
    #[must_use]
    pub fn with_latents(
        mut self,
        latents: Range<usize>,
        changed: &dyn Fn(&[f64]) -> Vec<f64>,
        back: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Self {
        let points = std::iter::once(&mut self.point)
            .chain(self.starts.iter_mut().flat_map(|start| [&mut start.start, &mut start.end]))
            .chain(self.distinct_optima.iter_mut().map(|optimum| &mut optimum.point));
        for point in points {
            let own = changed(&point[latents.clone()]);
            point[latents.clone()].copy_from_slice(&own);
        }
        let column = |k: usize| {
            let mut unit = vec![0.0; latents.len()];
            unit[k] = 1.0;
            back(&unit)
        };
        let columns: Vec<Vec<f64>> = (0..latents.len()).map(column).collect();
        for row in &mut self.slopes {
            let before = row[latents.clone()].to_vec();
            let own = columns.iter().map(|column| dot(&before, column));
            row[latents.clone()].iter_mut().zip(own).for_each(|(slope, own)| *slope = own);
        }
        self
    }

    /// The solution with a further start at these values, which [`refit_with_progress`] searches from.
    #[must_use]
    pub fn with_start(mut self, point: Vec<f64>) -> Self {
        let (start, end, cost) = (point.clone(), point, self.cost);
        let termination = FitTermination::IterationLimit;
        self.starts.push(StartOutcome { start, end, cost, termination, optimum: None });
        self
    }
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

    /// The optimum, for searches near it.
    pub(crate) fn known(&self) -> Known {
        let (predictions, slopes) = (self.predictions.clone(), self.slopes.clone());
        Known { x: self.optimum(), predictions, slopes }
    }

    /// Number of parameters, of which latents count as many as the data determine.
    pub(crate) fn effective_parameters(&self) -> f64 {
        let parameters = self.problem.parameters;
        let latents: Vec<usize> =
            (0..parameters.len()).filter(|&j| parameters[j].is_latent()).collect();
        let others = (parameters.len() - latents.len()) as f64;
        if latents.is_empty() || self.slopes.len() != self.problem.observations.len() {
            return parameters.len() as f64;
        }
        let scaled = Mat::from_fn(self.slopes.len(), latents.len(), |i, j| {
            let root = self.weights[i].sqrt() / self.problem.observations[i].standard_deviation;
            self.slopes[i][latents[j]] * root
        });
        let determined =
            |values: Vec<f64>| values.iter().map(|s| s * s / (1.0 + s * s)).sum::<f64>();
        others + scaled.singular_values().map_or(latents.len() as f64, determined)
    }

    /// Rows of the standardised Jacobian with the robust weights, as the search had it last.
    pub(crate) fn weighted_rows(&self) -> Vec<Vec<f64>> {
        let rows = self.slopes.iter().zip(&self.weights).zip(self.problem.observations);
        rows.map(|((row, weight), observation)| {
            let scale = weight.sqrt() / observation.standard_deviation;
            row.iter().map(|slope| slope * scale).collect()
        })
        .collect()
    }

    /// The part of the priors' chi-square that is of latents.
    pub(crate) fn latent_prior_chi_square(&self) -> f64 {
        let latents = self.problem.parameters.iter().zip(&self.point);
        latents.filter(|(parameter, _)| parameter.is_latent()).map(|(_, z)| z * z).sum()
    }

    /// The fit at another point; `None` where the model has no predictions.
    pub(crate) fn moved(&self, point: Vec<f64>) -> Option<Self> {
        let x = self.problem.to_working(&point);
        let predictions = self.problem.predict(std::slice::from_ref(&x)).pop()?.ok()?;
        let residuals = self.problem.residuals(&predictions);
        let solution = FitSolution {
            cost: self.problem.cost(&residuals, &x),
            weights: residuals.iter().map(|&r| self.problem.loss.weight(r)).collect(),
            missing: (0..predictions.len()).filter(|&i| predictions[i].is_none()).collect(),
            point,
            predictions,
            residuals,
            ..self.solution.clone()
        };
        Some(Self { problem: self.problem.clone(), progress: self.progress, solution })
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
    let free = vec![false; problem.parameters.len()];
    let mut searches: Vec<Search> =
        starts.iter().map(|x| Search::new(x.clone(), free.clone())).collect();
    if options.gradual {
        run_gradually(&problem, &mut searches, options, Stage::Fit, progress);
    } else {
        run(&problem, &mut searches, options, Stage::Fit, progress);
    }
    let starts = starts.iter().map(|x| problem.values_at(x)).enumerate().collect();
    from_searches(problem, &searches, starts, options, progress)
}

/// Fits a changed model, of the same parameters and as many observations, from the ends of an
/// earlier fit. Starts that had ended in one minimum are continued as one.
///
/// # Errors
///
/// Those of [`fit`], and [`InferenceError::Size`] for another number of parameters or observations.
pub fn refit_with_progress<'m>(
    model: &'m dyn ForwardModel,
    before: &FitSolution,
    progress: &'m ProgressCallback<'m>,
) -> Result<Fit<'m>, InferenceError> {
    let options = before.options;
    let problem = FitProblem::new(model, options.loss, options.missing_residual)?;
    let (parameters, count) = (problem.parameters.len(), problem.observations.len());
    check_size("parameters of the earlier fit", before.point.len(), parameters)?;
    check_size("observations of the earlier fit", before.predictions.len(), count)?;
    let free = vec![false; parameters];
    let best = Known {
        x: problem.to_working(&before.point),
        predictions: before.predictions.clone(),
        slopes: before.slopes.clone(),
    };
    let mut searches: Vec<Search> = Vec::new();
    for optimum in &before.distinct_optima {
        let x = problem.to_working(&optimum.point);
        searches.push(if x == best.x {
            Search::near(x, free.clone(), best.clone()).until_confirmed()
        } else {
            Search::new(x, free.clone())
        });
    }
    let mut starts = Vec::with_capacity(before.starts.len());
    for outcome in &before.starts {
        let search = outcome.optimum.unwrap_or_else(|| {
            let place = if outcome.cost.is_finite() { &outcome.end } else { &outcome.start };
            searches.push(Search::new(problem.to_working(place), free.clone()));
            searches.len() - 1
        });
        starts.push((search, outcome.start.clone()));
    }
    run(&problem, &mut searches, &options, Stage::Fit, progress);
    from_searches(problem, &searches, starts, &options, progress)
}

/// The fit of finished searches; `starts` are the index of the search of each start, and its values.
fn from_searches<'m>(
    problem: FitProblem<'m>,
    searches: &[Search],
    starts: Vec<(usize, Vec<f64>)>,
    options: &FitOptions,
    progress: &'m ProgressCallback<'m>,
) -> Result<Fit<'m>, InferenceError> {
    let outcome = |(search, start): (usize, Vec<f64>)| StartOutcome {
        start,
        end: problem.values_at(&searches[search].x),
        cost: searches[search].cost,
        termination: searches[search].termination.unwrap_or(FitTermination::IterationLimit),
        optimum: None,
    };
    let mut outcomes: Vec<StartOutcome> = starts.into_iter().map(outcome).collect();
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
        distinct_optima: distinct(&problem, &mut outcomes),
        starts: outcomes,
        options: *options,
        slopes: best.known().slopes,
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

/// The different minima; each converged outcome gets the index of its own.
fn distinct(problem: &FitProblem<'_>, outcomes: &mut [StartOutcome]) -> Vec<Optimum> {
    let mut ends: Vec<&mut StartOutcome> =
        outcomes.iter_mut().filter(|o| o.termination.converged()).collect();
    ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut optima: Vec<Optimum> = Vec::new();
    for end in ends {
        let same = |optimum: &Optimum| {
            let near = |j: usize| {
                let to = |value| problem.parameters[j].to_working(value);
                let range = problem.upper[j] - problem.lower[j];
                (to(end.end[j]) - to(optimum.point[j])).abs() <= 1e-3 * range
            };
            (end.cost - optimum.cost) <= 0.01 + 1e-3 * optimum.cost && (0..end.end.len()).all(near)
        };
        let known = optima.iter().position(same);
        if known.is_none() {
            optima.push(Optimum { point: end.end.clone(), cost: end.cost, starts: 0 });
        }
        let index = known.unwrap_or(optima.len() - 1);
        optima[index].starts += 1;
        end.optimum = Some(index);
    }
    optima
}
