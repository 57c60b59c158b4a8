//! Derivatives by finite differences: second order during a fit, fourth order at the optimum.

use crate::fit_problem::FitProblem;
use crate::model::Predictions;

/// Offsets in steps with their weights, and the weight of the base point.
type Formula = (&'static [(f64, f64)], f64);

const CENTRAL_2: Formula = (&[(-1.0, -0.5), (1.0, 0.5)], 0.0);
const FORWARD_2: Formula = (&[(1.0, 2.0), (2.0, -0.5)], -1.5);
const CENTRAL_4: Formula =
    (&[(-2.0, 1.0 / 12.0), (-1.0, -2.0 / 3.0), (1.0, 2.0 / 3.0), (2.0, -1.0 / 12.0)], 0.0);
const FORWARD_4: Formula =
    (&[(1.0, 4.0), (2.0, -3.0), (3.0, 4.0 / 3.0), (4.0, -0.25)], -25.0 / 12.0);

/// The order of the error in the step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    Second,
    Fourth,
}

struct Column {
    parameter: usize,
    /// Signed: one-sided formulas use points away from the bound.
    step: f64,
    formula: Formula,
}

/// Root mean square change of the observations in a step, in their standard deviations, above which steps are
/// shortened: far below a resonance's width where data are precise, far above the errors of predictions.
const LARGEST_CHANGE: f64 = 3.0;
/// Change below which steps are lengthened: differences of less are of the order of the errors of predictions.
const LEAST_CHANGE: f64 = 0.3;
/// Shortest and longest step over the one asked for.
const SHORTEST: f64 = 1e-2;
const LONGEST: f64 = 30.0;

/// Steps for derivatives.
#[derive(Clone, Copy)]
pub(crate) struct StencilStep<'a> {
    /// Step over the length of a parameter.
    pub(crate) relative: f64,
    /// Norms of the columns of the standardised Jacobian as far as known; zero where not. A step is shortened so
    /// that the observations change by at most three standard deviations, root mean square.
    pub(crate) norms: &'a [f64],
    /// True for predictions with errors: a step is lengthened so that the observations change by 0.3 standard
    /// deviations or more.
    pub(crate) lengthened: bool,
}

impl StencilStep<'_> {
    fn of(self, problem: &FitProblem<'_>, parameter: usize, x: f64) -> f64 {
        let asked = self.relative * problem.parameters[parameter].length(x);
        let norm = self.norms.get(parameter).copied().unwrap_or(0.0);
        if norm == 0.0 {
            return asked;
        }
        let size = (problem.observations.len() as f64).sqrt();
        let [least, largest] = [LEAST_CHANGE, LARGEST_CHANGE].map(|change| change * size / norm);
        let least = if self.lengthened { least.min(LONGEST * asked) } else { 0.0 };
        asked.clamp(least, largest.max(SHORTEST * asked))
    }
}

/// The points around `x` for the derivatives with respect to all parameters that are not held.
///
/// Next to a bound a one-sided formula of the same order keeps all points inside.
pub(crate) struct Stencil {
    columns: Vec<Column>,
    pub(crate) points: Vec<Vec<f64>>,
}

impl Stencil {
    pub(crate) fn new(
        problem: &FitProblem<'_>,
        x: &[f64],
        held: &[bool],
        steps: StencilStep<'_>,
        order: Order,
    ) -> Self {
        let (central, forward, width) = match order {
            Order::Second => (CENTRAL_2, FORWARD_2, 1.0),
            Order::Fourth => (CENTRAL_4, FORWARD_4, 2.0),
        };
        let (mut columns, mut points) = (Vec::new(), Vec::new());
        for j in (0..x.len()).filter(|&j| !held[j]) {
            let step = steps.of(problem, j, x[j]);
            let column = if x[j] - width * step < problem.lower[j] {
                Column { parameter: j, step, formula: forward }
            } else if x[j] + width * step > problem.upper[j] {
                Column { parameter: j, step: -step, formula: forward }
            } else {
                Column { parameter: j, step, formula: central }
            };
            for (offset, _) in column.formula.0 {
                let mut point = x.to_vec();
                point[j] += offset * column.step;
                points.push(point);
            }
            columns.push(column);
        }
        Self { columns, points }
    }

    /// Derivatives of the predictions with respect to the working coordinates: a row per
    /// observation, zero where there is none. Where a point of the formula has no prediction, the
    /// base and one neighbour give a first-order difference.
    pub(crate) fn derivatives(
        &self,
        base: &Predictions,
        answers: &[Result<Predictions, String>],
        parameters: usize,
    ) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; parameters]; base.len()];
        let mut first = 0;
        for column in &self.columns {
            let (terms, base_weight) = column.formula;
            let around = &answers[first..(first + terms.len()).min(answers.len())];
            first += terms.len();
            for (i, row) in rows.iter_mut().enumerate() {
                let Some(centre) = base[i] else { continue };
                let at = |k: usize| around.get(k)?.as_ref().ok().and_then(|p| p[i]);
                // Differences from the base, so that a constant has derivative zero exactly.
                let sum: Option<f64> = terms
                    .iter()
                    .enumerate()
                    .map(|(k, term)| Some(term.1 * (at(k)? - centre)))
                    .sum();
                debug_assert!((terms.iter().map(|t| t.1).sum::<f64>() + base_weight).abs() < 1e-12);
                let one = || {
                    let near = |(k, term): (usize, &(f64, f64))| Some((at(k)? - centre) / term.0);
                    terms.iter().enumerate().filter(|(_, t)| t.0.abs() == 1.0).find_map(near)
                };
                row[column.parameter] = sum.or_else(one).unwrap_or(0.0) / column.step;
            }
        }
        rows
    }
}
