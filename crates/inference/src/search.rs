//! Levenberg-Marquardt searches within bounds, several side by side.

mod gradual;
mod step;

use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::linear_algebra::dot;
use crate::model::Predictions;
use crate::progress::{Progress, ProgressCallback, Stage};
use crate::stencil::{Order, Stencil, StencilStep};
pub(crate) use gradual::run_gradually;
use step::LinearisedCost;

/// The reason for the end of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitTermination {
    /// The residuals are orthogonal to every direction open to the parameters.
    SmallGradient,
    /// The cost cannot fall by more than the tolerance.
    SmallReduction,
    /// The last step was shorter than the tolerance.
    SmallStep,
    /// The iterations are used up.
    IterationLimit,
    /// No step, however short, lowers the cost.
    NoReduction,
    /// Far from its observations the cost falls too slowly to get there.
    SlowReduction,
    /// The model has no predictions at the start.
    NoPrediction,
}

impl FitTermination {
    /// True if the search found a minimum.
    pub fn converged(self) -> bool {
        matches!(self, Self::SmallGradient | Self::SmallReduction | Self::SmallStep)
    }
}

/// Least ratio of actual to expected reduction of the cost of an accepted step.
const LEAST_RATIO: f64 = 1e-4;
/// Damping of the first step.
const FIRST_DAMPING: f64 = 1e-3;
/// Damping beyond which a step is below rounding.
const MAX_DAMPING: f64 = 1e20;

/// Ratio of actual to expected reduction below which a step is corrected for the curvature of the predictions.
const GOOD_RATIO: f64 = 0.75;

/// Least ratio of actual to expected reduction after which updated derivatives are used further.
const UPDATED_RATIO: f64 = 0.25;
/// Fewest parameters whose derivatives are updated after a corrected step too, if it was good: in fewer, new ones cost less
/// than a step along updated ones that fails.
const MANY: usize = 20;
/// Most updates before the derivatives are computed again.
const MOST_UPDATES: usize = 12;
/// Expected reduction of the cost of a rejected step from which the end of a search is no minimum: that of a
/// parameter off by a standard deviation. Errors of the predictions reject steps of less.
const LARGEST_REJECTED: f64 = 0.5;
/// Root mean square residual, in standard deviations, beyond which a gradual search is far from its observations, and the
/// steps that have to lower its cost by a share there.
const FAR: f64 = 3.0;
const SLOW_STEPS: usize = 20;
const LEAST_FALL: f64 = 0.1;
/// Shortest step that updates the derivatives, over the step of difference derivatives: differences
/// along shorter ones are of the order of the errors of the predictions.
const LEAST_UPDATE: f64 = 0.5;

/// The predictions and their derivatives with respect to the working coordinates at a point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Known {
    /// Working coordinates.
    pub(crate) x: Vec<f64>,
    pub(crate) predictions: Predictions,
    /// A row per observation.
    pub(crate) slopes: Vec<Vec<f64>>,
}

/// The points whose predictions a search needs next.
enum Request {
    Start,
    Derivatives(Stencil),
    Trial(Trial),
}

/// A step and the reduction of the cost that the linearised problem expects of it.
struct Trial {
    x: Vec<f64>,
    step: Vec<f64>,
    expected: f64,
    /// The step without its correction, where this one is corrected.
    plain: Option<Box<Tried>>,
}

/// A point that was tried.
struct Tried {
    x: Vec<f64>,
    step: Vec<f64>,
    predictions: Predictions,
    residuals: Vec<f64>,
    /// Fall of the cost.
    fall: f64,
}

/// Levenberg-Marquardt within bounds from one start.
///
/// Damping follows Nielsen's rule, scaled by the largest column norms so far (as in MINPACK). After
/// a step that reduced the cost as expected, the derivatives are those before it with Broyden's
/// update (after a corrected one from twenty parameters on); after any other they are computed again, and before the end of a search from a start
/// too. A search from a known point nearby also ends on updated derivatives. A step that fell short of
/// the expected reduction is corrected for the curvature that it has shown.
/// Sources: J. J. Moré, Lecture Notes in Mathematics 630 (1978); H. B. Nielsen, IMM-REP-1999-05;
/// C. G. Broyden, Math. Comp. 19, 577 (1965); M. K. Transtrum, J. P. Sethna, arXiv:1201.5885 (2012).
pub(crate) struct Search {
    pub(crate) x: Vec<f64>,
    held: Vec<bool>,
    pub(crate) predictions: Predictions,
    pub(crate) residuals: Vec<f64>,
    pub(crate) cost: f64,
    /// Derivatives of the predictions with respect to the working coordinates; empty before the
    /// first.
    slopes: Vec<Vec<f64>>,
    /// Updates of the derivatives since they were computed.
    updates: usize,
    /// True if the search may end on updated derivatives.
    near: bool,
    /// The point nearby at which the derivatives hold, before the predictions at the start.
    known: Option<Known>,
    linear: Option<LinearisedCost>,
    scaling: Vec<f64>,
    damping: f64,
    growth: f64,
    /// True from where no step lowered the cost: differences are taken over longer steps.
    lengthened: bool,
    /// Largest expected reduction of the steps that were rejected with these derivatives.
    rejected: f64,
    /// Number of steps and cost from which on slow reduction counts; none before the first step.
    mark: Option<(usize, f64)>,
    request: Request,
    pub(crate) iterations: usize,
    pub(crate) evaluations: usize,
    pub(crate) termination: Option<FitTermination>,
    pub(crate) error: Option<String>,
}

impl Search {
    /// A search from working coordinates `x`; the parameters marked held stay there.
    pub(crate) fn new(x: Vec<f64>, held: Vec<bool>) -> Self {
        let scaling = vec![0.0; x.len()];
        Self {
            x,
            held,
            predictions: Vec::new(),
            residuals: Vec::new(),
            cost: f64::INFINITY,
            slopes: Vec::new(),
            updates: 0,
            near: false,
            known: None,
            linear: None,
            scaling,
            damping: FIRST_DAMPING,
            lengthened: false,
            growth: 2.0,
            rejected: 0.0,
            mark: None,
            request: Request::Start,
            iterations: 0,
            evaluations: 0,
            termination: None,
            error: None,
        }
    }

    /// A search from working coordinates `x` near a known point.
    pub(crate) fn near(x: Vec<f64>, held: Vec<bool>, known: Known) -> Self {
        Self { near: true, known: Some(known), ..Self::new(x, held) }
    }

    /// A search from a known point of another problem of the same model; its derivatives are computed where they are not known.
    pub(crate) fn at(problem: &FitProblem<'_>, options: &FitOptions, known: Known) -> Self {
        let Known { x, predictions, slopes } = known;
        let residuals = problem.residuals(&predictions);
        let mut search =
            Self { near: true, slopes, updates: 1, ..Self::new(x.clone(), vec![false; x.len()]) };
        let usable = !search.slopes.is_empty();
        search.move_to(problem, options, (x, predictions, residuals), usable);
        search
    }

    /// The search, which computes the derivatives again before its end.
    pub(crate) fn until_confirmed(self) -> Self {
        Self { near: false, ..self }
    }

    /// The end of the search, for searches near it.
    pub(crate) fn known(&self) -> Known {
        let (x, predictions, slopes) =
            (self.x.clone(), self.predictions.clone(), self.slopes.clone());
        Known { x, predictions, slopes }
    }

    /// The points that the search needs next; none after its end.
    fn requested(&self) -> Vec<Vec<f64>> {
        if self.termination.is_some() {
            return Vec::new();
        }
        match &self.request {
            Request::Start => vec![self.x.clone()],
            Request::Derivatives(stencil) => stencil.points.clone(),
            Request::Trial(trial) => vec![trial.x.clone()],
        }
    }

    fn receive(
        &mut self,
        problem: &FitProblem<'_>,
        options: &FitOptions,
        answers: Vec<Result<Predictions, String>>,
    ) {
        self.evaluations += answers.len();
        match std::mem::replace(&mut self.request, Request::Start) {
            Request::Start => match answers.into_iter().next() {
                Some(Ok(predictions)) => {
                    let (x, residuals) = (self.x.clone(), problem.residuals(&predictions));
                    let known = self.known.take();
                    let usable = known.as_ref().is_some_and(|known| !known.slopes.is_empty());
                    if let Some(Known { x: before, predictions: old, slopes }) = known {
                        self.slopes = slopes;
                        self.update(problem, options, (&before, &old), (&x, &predictions));
                    }
                    self.move_to(problem, options, (x, predictions, residuals), usable);
                }
                Some(Err(reason)) => {
                    self.error = Some(reason);
                    self.termination = Some(FitTermination::NoPrediction);
                }
                None => self.termination = Some(FitTermination::NoPrediction),
            },
            Request::Derivatives(stencil) => {
                let computed = stencil.derivatives(&self.predictions, &answers, self.x.len());
                let before = std::mem::replace(&mut self.slopes, computed);
                // Those with respect to held parameters are not computed again.
                for (row, before) in self.slopes.iter_mut().zip(&before) {
                    for j in (0..row.len()).filter(|&j| self.held[j]) {
                        row[j] = before[j];
                    }
                }
                self.updates = 0;
                self.linearise(problem, options);
            }
            Request::Trial(trial) => {
                let answer = answers.into_iter().next().and_then(Result::ok);
                self.assess(problem, options, trial, answer);
            }
        }
    }

    /// Moves to a point; requests its derivatives unless the updated ones are `usable` there.
    fn move_to(
        &mut self,
        problem: &FitProblem<'_>,
        options: &FitOptions,
        (x, predictions, residuals): (Vec<f64>, Predictions, Vec<f64>),
        usable: bool,
    ) {
        self.cost = problem.cost(&residuals, &x);
        (self.x, self.predictions, self.residuals) = (x, predictions, residuals);
        if self.held.iter().all(|&held| held) {
            self.termination = Some(FitTermination::SmallStep);
            return;
        }
        if usable {
            self.linearise(problem, options);
        } else {
            self.request_derivatives(problem, options);
        }
    }

    fn request_derivatives(&mut self, problem: &FitProblem<'_>, options: &FitOptions) {
        let steps = StencilStep {
            relative: options.difference_step,
            norms: &self.scaling,
            lengthened: self.lengthened,
        };
        self.request =
            Request::Derivatives(Stencil::new(problem, &self.x, &self.held, steps, Order::Second));
    }

    /// Ends the search, unless it must first compute the derivatives again.
    fn end(&mut self, problem: &FitProblem<'_>, options: &FitOptions, termination: FitTermination) {
        // Steps become short by damping too, where derivatives are wrong or predictions jump.
        let termination = if self.rejected > LARGEST_REJECTED {
            FitTermination::NoReduction
        } else {
            termination
        };
        // Errors of the predictions spoil differences over short steps.
        if termination == FitTermination::NoReduction && self.updates == 0 && !self.lengthened {
            self.lengthened = true;
            self.damping = FIRST_DAMPING;
            self.growth = 2.0;
            self.request_derivatives(problem, options);
            return;
        }
        let good_enough = self.near && termination != FitTermination::NoReduction;
        if self.updates == 0 || good_enough {
            self.termination = Some(termination);
        } else {
            self.request_derivatives(problem, options);
        }
    }

    /// Broyden's update of the derivatives from the predictions at two points, in coordinates scaled
    /// as those of the damping; none for a step too short to measure them.
    fn update(
        &mut self,
        problem: &FitProblem<'_>,
        options: &FitOptions,
        (before, old): (&[f64], &Predictions),
        (after, new): (&[f64], &Predictions),
    ) {
        let parameters = problem.parameters;
        self.updates += 1;
        let step: Vec<f64> =
            after.iter().zip(before).map(|(after, before)| after - before).collect();
        let lengths: Vec<f64> =
            parameters.iter().zip(before).map(|(parameter, &x)| parameter.length(x)).collect();
        let longest =
            step.iter().zip(&lengths).map(|(s, length)| (s / length).abs()).fold(0.0, f64::max);
        if longest < LEAST_UPDATE * options.difference_step {
            return;
        }
        let along: Vec<f64> = if self.scaling.iter().all(|&d| d > 0.0) {
            step.iter().zip(&self.scaling).map(|(s, d)| s * d * d).collect()
        } else {
            step.iter().zip(&lengths).map(|(s, length)| s / (length * length)).collect()
        };
        let size = dot(&along, &step);
        for ((row, old), new) in self.slopes.iter_mut().zip(old).zip(new) {
            if let (Some(old), Some(new)) = (old, new) {
                let factor = (new - old - dot(row, &step)) / size;
                row.iter_mut().zip(&along).for_each(|(slope, along)| *slope += factor * along);
            }
        }
    }

    fn linearise(&mut self, problem: &FitProblem<'_>, options: &FitOptions) {
        self.rejected = 0.0;
        let parameters = self.x.len();
        let linear =
            LinearisedCost::new(problem, &self.x, &self.residuals, &self.slopes, &self.held);
        let norms = linear.column_norms(parameters);
        for (j, norm) in norms.iter().enumerate() {
            let least = 1e-6 / problem.parameters[j].length(self.x[j]);
            self.scaling[j] = self.scaling[j].max(*norm).max(least);
        }
        let size = linear.residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        let gradient = linear.gradient(parameters);
        let steepest = (0..parameters)
            .filter(|&j| !self.held[j] && !self.blocked(problem, j, gradient[j]))
            .map(|j| gradient[j].abs() / (norms[j] * size).max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max);
        self.linear = Some(linear);
        if steepest <= options.tolerance || size <= 1e-14 {
            self.end(problem, options, FitTermination::SmallGradient);
        } else {
            self.propose(problem, options);
        }
    }

    /// True if a parameter is on a bound beyond which the cost falls.
    fn blocked(&self, problem: &FitProblem<'_>, j: usize, gradient: f64) -> bool {
        (self.x[j] <= problem.lower[j] && gradient >= 0.0)
            || (self.x[j] >= problem.upper[j] && gradient <= 0.0)
    }

    /// Distances that each parameter may go from the point, down and up.
    fn room(&self, problem: &FitProblem<'_>, linear: &LinearisedCost) -> Vec<[f64; 2]> {
        let gradient = linear.gradient(self.x.len());
        let room = |j: usize| {
            if self.held[j] || self.blocked(problem, j, gradient[j]) {
                return [0.0; 2];
            }
            [problem.lower[j] - self.x[j], problem.upper[j] - self.x[j]]
        };
        (0..self.x.len()).map(room).collect()
    }

    fn propose(&mut self, problem: &FitProblem<'_>, options: &FitOptions) {
        if options.gradual && self.is_slow() {
            self.termination = Some(FitTermination::SlowReduction);
            return;
        }
        let Some(linear) = &self.linear else { return };
        let room = self.room(problem, linear);
        while self.damping <= MAX_DAMPING {
            if self.iterations >= options.max_iterations {
                self.termination = Some(FitTermination::IterationLimit);
                return;
            }
            self.iterations += 1;
            if let Some(step) = linear.step(self.damping, &self.scaling, &room) {
                let expected = linear.reduction(&step);
                let mut x: Vec<f64> = self.x.iter().zip(&step).map(|(x, step)| x + step).collect();
                problem.clamp(&mut x);
                if x == self.x {
                    self.end(problem, options, FitTermination::SmallStep);
                    return;
                }
                if expected > 0.0 {
                    self.request = Request::Trial(Trial { x, step, expected, plain: None });
                    return;
                }
            }
            self.damping *= self.growth;
            self.growth *= 2.0;
        }
        self.end(problem, options, FitTermination::NoReduction);
    }

    /// True if the cost has fallen by too little in the last steps to reach the observations, which are far.
    fn is_slow(&mut self) -> bool {
        let (begun, cost) = *self.mark.get_or_insert((self.iterations, self.cost));
        if self.iterations < begun + SLOW_STEPS {
            return false;
        }
        self.mark = Some((self.iterations, self.cost));
        let squares = self.residuals.iter().map(|r| r * r).sum::<f64>();
        squares > FAR * FAR * self.residuals.len() as f64 && self.cost > (1.0 - LEAST_FALL) * cost
    }

    /// Fall of the cost to a point. An observation with a prediction at one of the two points alone counts as
    /// no better where it has none: otherwise a search stays where predictions are missing, since their
    /// residual is less than residuals of a poor fit.
    fn fall(
        &self,
        problem: &FitProblem<'_>,
        (x, predictions, residuals): (&[f64], &Predictions, &[f64]),
    ) -> f64 {
        let (mut before, mut after) = (self.residuals.clone(), residuals.to_vec());
        for i in 0..before.len() {
            let worse = before[i].abs().max(after[i].abs());
            match (self.predictions[i], predictions[i]) {
                (None, Some(_)) => before[i] = worse,
                (Some(_), None) => after[i] = worse,
                _ => {}
            }
        }
        problem.cost(&before, &self.x) - problem.cost(&after, x)
    }

    /// The step with its correction for the curvature of the predictions along it, which the plain step has
    /// shown: the minimum of `|r + J d + k + J c|^2 + damping |D c|^2` over corrections `c`, with `k` the
    /// predictions at the end of the step less those of the linear model. `None` where the correction is not
    /// small against the step.
    fn corrected(&self, problem: &FitProblem<'_>, plain: &Tried) -> Option<Vec<f64>> {
        let linear = self.linear.as_ref()?;
        let both = |i: usize| self.predictions[i].is_some() && plain.predictions[i].is_some();
        let change = |i: usize| if both(i) { plain.residuals[i] - self.residuals[i] } else { 0.0 };
        let counted = (0..self.residuals.len()).filter(|&i| problem.counts(i));
        let weight = |i: usize| problem.loss.weight(self.residuals[i]) / problem.noise_variance;
        let mut curvature: Vec<f64> = counted
            .zip(&linear.jacobian)
            .map(|(i, row)| weight(i).sqrt() * change(i) - dot(row, &plain.step))
            .collect();
        // Priors are linear.
        curvature.resize(linear.residuals.len(), 0.0);
        let room = self.room(problem, linear);
        linear.corrected(&plain.step, curvature, (self.damping, &self.scaling), &room)
    }

    /// Accepts or rejects a trial step, or corrects it.
    fn assess(
        &mut self,
        problem: &FitProblem<'_>,
        options: &FitOptions,
        trial: Trial,
        answer: Option<Predictions>,
    ) {
        let Trial { x, step, expected, plain } = trial;
        let is_corrected = plain.is_some();
        let mut tried = answer.map(|predictions| {
            let residuals = problem.residuals(&predictions);
            let fall = self.fall(problem, (&x, &predictions, &residuals));
            Tried { x, step: step.clone(), predictions, residuals, fall }
        });
        if let Some(plain) = plain
            && tried.as_ref().is_none_or(|tried| tried.fall < plain.fall)
        {
            tried = Some(*plain);
        }
        if !is_corrected
            && self.updates == 0
            && let Some(plain) = tried.take_if(|tried| tried.fall < GOOD_RATIO * expected)
        {
            if let Some(step) = self.corrected(problem, &plain) {
                let mut x: Vec<f64> = self.x.iter().zip(&step).map(|(x, step)| x + step).collect();
                problem.clamp(&mut x);
                let plain = Some(Box::new(plain));
                self.request = Request::Trial(Trial { x, step, expected, plain });
                return;
            }
            tried = Some(plain);
        }
        let little = expected <= options.tolerance * self.cost;
        let short = step.iter().enumerate().all(|(j, step)| {
            step.abs() <= options.tolerance * problem.parameters[j].length(self.x[j])
        });
        match tried {
            Some(Tried { x, predictions, residuals, fall, .. })
                if fall > LEAST_RATIO * expected =>
            {
                let ratio = fall / expected;
                self.damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(0.1, 2.0);
                self.damping = self.damping.max(1e-15);
                self.growth = 2.0;
                let ending = if little && fall <= options.tolerance * self.cost {
                    Some(FitTermination::SmallReduction)
                } else if short {
                    Some(FitTermination::SmallStep)
                } else {
                    None
                };
                if let Some(termination) = ending
                    && (self.updates == 0 || self.near)
                {
                    self.cost = problem.cost(&residuals, &x);
                    (self.x, self.predictions, self.residuals) = (x, predictions, residuals);
                    self.termination = Some(termination);
                    return;
                }
                let least = if !is_corrected {
                    UPDATED_RATIO
                } else if self.x.len() >= MANY {
                    GOOD_RATIO
                } else {
                    f64::INFINITY
                };
                let usable = ending.is_none() && ratio >= least && self.updates < MOST_UPDATES;
                if usable {
                    let (before, old) = (self.x.clone(), self.predictions.clone());
                    self.update(problem, options, (&before, &old), (&x, &predictions));
                }
                self.move_to(problem, options, (x, predictions, residuals), usable);
            }
            // No reduction where hardly any was expected: rounding, but for damped steps.
            _ if little => self.end(problem, options, FitTermination::SmallReduction),
            _ if short => self.end(problem, options, FitTermination::SmallStep),
            _ if self.updates > 0 => self.request_derivatives(problem, options),
            _ => {
                self.rejected = self.rejected.max(expected);
                self.damping *= self.growth;
                self.growth *= 2.0;
                self.propose(problem, options);
            }
        }
    }
}

/// Runs searches side by side to their ends; each call of the model has the points of all of them.
pub(crate) fn run(
    problem: &FitProblem<'_>,
    searches: &mut [Search],
    options: &FitOptions,
    stage: Stage,
    progress: &ProgressCallback<'_>,
) {
    let problems: Vec<&FitProblem<'_>> = searches.iter().map(|_| problem).collect();
    run_all(&problems, searches, options, stage, progress);
}

/// As [`run`], with a problem for each search; all problems are of one model.
pub(crate) fn run_all(
    problems: &[&FitProblem<'_>],
    searches: &mut [Search],
    options: &FitOptions,
    stage: Stage,
    progress: &ProgressCallback<'_>,
) {
    let Some(problem) = problems.first() else { return };
    loop {
        let requested: Vec<Vec<Vec<f64>>> = searches.iter().map(Search::requested).collect();
        let points: Vec<Vec<f64>> = requested.iter().flatten().cloned().collect();
        if points.is_empty() {
            return;
        }
        let mut answers = problem.predict(&points).into_iter();
        for ((search, requested), problem) in searches.iter_mut().zip(&requested).zip(problems) {
            if !requested.is_empty() {
                search.receive(problem, options, answers.by_ref().take(requested.len()).collect());
            }
        }
        let cost = searches.iter().map(|search| search.cost).fold(f64::INFINITY, f64::min);
        let done = searches.iter().filter(|search| search.termination.is_some()).count();
        progress(Progress { stage, done, of: searches.len(), cost });
    }
}
