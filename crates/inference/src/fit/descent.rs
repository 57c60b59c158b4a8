//! One search for a minimum, which asks for the points it needs and is told the answers.

use crate::fit::options::FitOptions;
use crate::fit::step::Linear;
use crate::fit::{Ending, Progress, Stage};
use crate::model::Predictions;
use crate::problem::Problem;
use crate::stencil::{Order, Stencil};

/// A fall that is less than this part of the expected one is no success.
const LEAST_GAIN: f64 = 1e-4;
/// Damping beyond which a step is lost in rounding.
const MOST_DAMPING: f64 = 1e20;

enum Wait {
    Start,
    Derivatives(Stencil),
    Trial { x: Vec<f64>, step: Vec<f64>, expected: f64 },
}

/// Levenberg-Marquardt within bounds from one start.
///
/// Damping follows Nielsen's gain rule, scaled by the largest column norms met (as in MINPACK).
/// Sources: J. J. Moré, Lecture Notes in Mathematics 630 (1978); H. B. Nielsen, IMM-REP-1999-05.
pub(crate) struct Descent {
    pub(crate) x: Vec<f64>,
    held: Vec<bool>,
    pub(crate) predictions: Predictions,
    pub(crate) residuals: Vec<f64>,
    pub(crate) cost: f64,
    linear: Option<Linear>,
    scaling: Vec<f64>,
    damping: f64,
    growth: f64,
    wait: Wait,
    pub(crate) iterations: usize,
    pub(crate) evaluations: usize,
    pub(crate) ending: Option<Ending>,
    pub(crate) refusal: Option<String>,
}

impl Descent {
    /// A search from working coordinates `x`; the unknowns marked held stay there.
    pub(crate) fn new(x: Vec<f64>, held: Vec<bool>) -> Self {
        let scaling = vec![0.0; x.len()];
        Self {
            x,
            held,
            predictions: Vec::new(),
            residuals: Vec::new(),
            cost: f64::INFINITY,
            linear: None,
            scaling,
            damping: 1e-3,
            growth: 2.0,
            wait: Wait::Start,
            iterations: 0,
            evaluations: 0,
            ending: None,
            refusal: None,
        }
    }

    /// The points this search needs now; none when it has ended.
    fn wanted(&self) -> Vec<Vec<f64>> {
        if self.ending.is_some() {
            return Vec::new();
        }
        match &self.wait {
            Wait::Start => vec![self.x.clone()],
            Wait::Derivatives(stencil) => stencil.points.clone(),
            Wait::Trial { x, .. } => vec![x.clone()],
        }
    }

    fn receive(
        &mut self,
        problem: &Problem<'_>,
        options: &FitOptions,
        answers: Vec<Result<Predictions, String>>,
    ) {
        self.evaluations += answers.len();
        match std::mem::replace(&mut self.wait, Wait::Start) {
            Wait::Start => match answers.into_iter().next() {
                Some(Ok(predictions)) => {
                    let (x, residuals) = (self.x.clone(), problem.residuals(&predictions));
                    self.settle(problem, options, x, predictions, residuals);
                }
                Some(Err(reason)) => {
                    self.refusal = Some(reason);
                    self.ending = Some(Ending::Refused);
                }
                None => self.ending = Some(Ending::Refused),
            },
            Wait::Derivatives(stencil) => {
                let rows = stencil.derivatives(&self.predictions, &answers, self.x.len());
                self.linearise(problem, options, &rows);
            }
            Wait::Trial { x, step, expected } => {
                let answer = answers.into_iter().next().and_then(Result::ok);
                self.judge(problem, options, x, &step, expected, answer);
            }
        }
    }

    /// Takes a point as the present one and asks for its derivatives.
    fn settle(
        &mut self,
        problem: &Problem<'_>,
        options: &FitOptions,
        x: Vec<f64>,
        predictions: Predictions,
        residuals: Vec<f64>,
    ) {
        self.cost = problem.cost(&residuals, &x);
        (self.x, self.predictions, self.residuals) = (x, predictions, residuals);
        if self.held.iter().all(|&held| held) {
            self.ending = Some(Ending::SmallStep);
            return;
        }
        let (step, order) = (options.difference_step, Order::Second);
        self.wait = Wait::Derivatives(Stencil::new(problem, &self.x, &self.held, step, order));
    }

    fn linearise(&mut self, problem: &Problem<'_>, options: &FitOptions, rows: &[Vec<f64>]) {
        let unknowns = self.x.len();
        let linear = weighted(problem, &self.x, &self.residuals, rows, &self.held);
        let norms = linear.column_norms(unknowns);
        for (j, norm) in norms.iter().enumerate() {
            let least = 1e-6 / problem.unknowns[j].length(self.x[j]);
            self.scaling[j] = self.scaling[j].max(*norm).max(least);
        }
        let size = linear.residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        let gradient = linear.gradient(unknowns);
        let steepest = (0..unknowns)
            .filter(|&j| !self.held[j] && !self.blocked(problem, j, gradient[j]))
            .map(|j| gradient[j].abs() / (norms[j] * size).max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max);
        self.linear = Some(linear);
        if steepest <= options.tolerance || size <= 1e-14 {
            self.ending = Some(Ending::SmallGradient);
        } else {
            self.propose(problem, options);
        }
    }

    /// Whether an unknown is on a bound that the cost falls beyond.
    fn blocked(&self, problem: &Problem<'_>, j: usize, gradient: f64) -> bool {
        (self.x[j] <= problem.lower[j] && gradient >= 0.0)
            || (self.x[j] >= problem.upper[j] && gradient <= 0.0)
    }

    fn propose(&mut self, problem: &Problem<'_>, options: &FitOptions) {
        let Some(linear) = &self.linear else { return };
        let gradient = linear.gradient(self.x.len());
        let room = |j: usize| {
            if self.held[j] || self.blocked(problem, j, gradient[j]) {
                return [0.0; 2];
            }
            [problem.lower[j] - self.x[j], problem.upper[j] - self.x[j]]
        };
        let room: Vec<[f64; 2]> = (0..self.x.len()).map(room).collect();
        while self.damping <= MOST_DAMPING {
            if self.iterations >= options.most_iterations {
                self.ending = Some(Ending::MostIterations);
                return;
            }
            self.iterations += 1;
            if let Some(step) = linear.step(self.damping, &self.scaling, &room) {
                let expected = linear.reduction(&step);
                let mut x: Vec<f64> = self.x.iter().zip(&step).map(|(x, step)| x + step).collect();
                problem.clamp(&mut x);
                if x == self.x {
                    self.ending = Some(Ending::SmallStep);
                    return;
                }
                if expected > 0.0 {
                    self.wait = Wait::Trial { x, step, expected };
                    return;
                }
            }
            self.damping *= self.growth;
            self.growth *= 2.0;
        }
        self.ending = Some(Ending::NoProgress);
    }

    fn judge(
        &mut self,
        problem: &Problem<'_>,
        options: &FitOptions,
        x: Vec<f64>,
        step: &[f64],
        expected: f64,
        answer: Option<Predictions>,
    ) {
        let tried = answer.map(|predictions| {
            let residuals = problem.residuals(&predictions);
            let fall = self.cost - problem.cost(&residuals, &x);
            (predictions, residuals, fall)
        });
        let little = expected <= options.tolerance * self.cost;
        let short = step.iter().enumerate().all(|(j, step)| {
            step.abs() <= options.tolerance * problem.unknowns[j].length(self.x[j])
        });
        match tried {
            Some((predictions, residuals, fall)) if fall > LEAST_GAIN * expected => {
                let gain = fall / expected;
                self.damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 2.0);
                self.damping = self.damping.max(1e-15);
                self.growth = 2.0;
                let before = self.cost;
                self.settle(problem, options, x, predictions, residuals);
                if little && fall <= options.tolerance * before {
                    self.ending = Some(Ending::SmallReduction);
                } else if short {
                    self.ending = Some(Ending::SmallStep);
                }
            }
            // No fall where hardly any was expected: rounding has the last word.
            _ if little => self.ending = Some(Ending::SmallReduction),
            _ if short => self.ending = Some(Ending::SmallStep),
            _ => {
                self.damping *= self.growth;
                self.growth *= 2.0;
                self.propose(problem, options);
            }
        }
    }
}

/// Residual rows and Jacobian with the loss's weights (iteratively reweighted least squares), the
/// priors' rows below; held unknowns have zero columns.
fn weighted(
    problem: &Problem<'_>,
    x: &[f64],
    residuals: &[f64],
    rows: &[Vec<f64>],
    held: &[bool],
) -> Linear {
    let mut linear = Linear { jacobian: Vec::new(), residuals: Vec::new() };
    for ((row, &residual), observation) in rows.iter().zip(residuals).zip(problem.observations) {
        let root = (problem.loss.weight(residual) / problem.noise_variance).sqrt();
        let scale = root / observation.standard_deviation;
        linear.jacobian.push(row.iter().map(|entry| entry * scale).collect());
        linear.residuals.push(root * residual);
    }
    for (j, residual, slope) in problem.prior_rows(x) {
        let mut row = vec![0.0; x.len()];
        row[j] = if held[j] { 0.0 } else { slope };
        linear.jacobian.push(row);
        linear.residuals.push(residual);
    }
    linear
}

/// Runs searches side by side until all have ended: one call to the model carries the points
/// that all of them need.
pub(crate) fn advance(
    problem: &Problem<'_>,
    searches: &mut [Descent],
    options: &FitOptions,
    stage: Stage,
    progress: &(dyn Fn(Progress) + Sync),
) {
    loop {
        let wanted: Vec<Vec<Vec<f64>>> = searches.iter().map(Descent::wanted).collect();
        let points: Vec<Vec<f64>> = wanted.iter().flatten().cloned().collect();
        if points.is_empty() {
            return;
        }
        let mut answers = problem.predict(&points).into_iter();
        for (search, wanted) in searches.iter_mut().zip(&wanted) {
            if !wanted.is_empty() {
                search.receive(problem, options, answers.by_ref().take(wanted.len()).collect());
            }
        }
        let cost = searches.iter().map(|search| search.cost).fold(f64::INFINITY, f64::min);
        let done = searches.iter().filter(|search| search.ending.is_some()).count();
        progress(Progress { stage, done, of: searches.len(), cost });
    }
}
