//! One damped least-squares step within bounds.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;

use crate::fit_problem::FitProblem;
use crate::linear_algebra::dot;

/// Longest correction over the step (Transtrum and Sethna's bound of the acceleration, 0.75, halved).
const LARGEST_CORRECTION: f64 = 0.375;

/// The linearised problem at a point: weighted residuals and their Jacobian.
pub(crate) struct LinearisedCost {
    /// Rows times parameters.
    pub(crate) jacobian: Vec<Vec<f64>>,
    pub(crate) residuals: Vec<f64>,
}

impl LinearisedCost {
    /// Residual rows and Jacobian with the loss's weights (iteratively reweighted least squares), the
    /// priors' rows below; held parameters have zero columns.
    pub(crate) fn new(
        problem: &FitProblem<'_>,
        x: &[f64],
        residuals: &[f64],
        rows: &[Vec<f64>],
        held: &[bool],
    ) -> Self {
        let mut linear = Self { jacobian: Vec::new(), residuals: Vec::new() };
        let observations = problem.observations.iter().enumerate();
        for ((row, &residual), (i, observation)) in rows.iter().zip(residuals).zip(observations) {
            if !problem.counts(i) {
                continue;
            }
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

    /// A step with its correction `c` for the curvature `k` of the predictions along it, the minimum of
    /// `|r + J d + k + J c|^2 + damping |D c|^2`; `None` where the correction is not small against the step.
    pub(crate) fn corrected(
        &self,
        step: &[f64],
        curvature: Vec<f64>,
        (damping, scaling): (f64, &[f64]),
        room: &[[f64; 2]],
    ) -> Option<Vec<f64>> {
        let left = |(room, step): (&[f64; 2], &f64)| {
            [(room[0] - step).min(0.0), (room[1] - step).max(0.0)]
        };
        let room: Vec<[f64; 2]> = room.iter().zip(step).map(left).collect();
        let curved = Self { jacobian: self.jacobian.clone(), residuals: curvature };
        let correction = curved.step(damping, scaling, &room)?;
        let length = |step: &[f64]| {
            step.iter().zip(scaling).map(|(s, d)| (s * d).powi(2)).sum::<f64>().sqrt()
        };
        if length(&correction) > LARGEST_CORRECTION * length(step) {
            return None;
        }
        Some(step.iter().zip(&correction).map(|(step, c)| step + c).collect())
    }

    pub(crate) fn gradient(&self, parameters: usize) -> Vec<f64> {
        let mut gradient = vec![0.0; parameters];
        for (row, residual) in self.jacobian.iter().zip(&self.residuals) {
            for (g, entry) in gradient.iter_mut().zip(row) {
                *g += entry * residual;
            }
        }
        gradient
    }

    pub(crate) fn column_norms(&self, parameters: usize) -> Vec<f64> {
        let norm = |j: usize| self.jacobian.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
        (0..parameters).map(norm).collect()
    }

    /// Reduction of the cost along a step, by the linear model.
    pub(crate) fn reduction(&self, step: &[f64]) -> f64 {
        let change = |(row, residual): (&Vec<f64>, &f64)| {
            let change = dot(row, step);
            -change * (residual + 0.5 * change)
        };
        self.jacobian.iter().zip(&self.residuals).map(change).sum()
    }

    /// The minimum of `|r + J d|^2 + damping |D d|^2` over steps `d` within `room` (lower and upper
    /// limit of each entry): a coordinate outside is set to its limit and the others are solved for
    /// again. Held parameters have no room.
    pub(crate) fn step(
        &self,
        damping: f64,
        scaling: &[f64],
        room: &[[f64; 2]],
    ) -> Option<Vec<f64>> {
        let parameters = scaling.len();
        let mut step = vec![0.0; parameters];
        let mut free: Vec<usize> = (0..parameters).filter(|&j| room[j][1] > room[j][0]).collect();
        for _ in 0..=parameters {
            if free.is_empty() {
                break;
            }
            let rows = self.residuals.len();
            let matrix =
                Mat::from_fn(rows + free.len(), free.len(), |i, k| match i.checked_sub(rows) {
                    None => self.jacobian[i][free[k]],
                    Some(extra) if extra == k => damping.sqrt() * scaling[free[k]],
                    Some(_) => 0.0,
                });
            let fixed = |j: &usize| !free.contains(j);
            let right = Mat::from_fn(rows + free.len(), 1, |i, _| {
                if i >= rows {
                    return 0.0;
                }
                let row = &self.jacobian[i];
                let moved: f64 = (0..parameters).filter(fixed).map(|j| row[j] * step[j]).sum();
                -(self.residuals[i] + moved)
            });
            let solution = matrix.col_piv_qr().solve_lstsq(&right);
            let mut stays = Vec::with_capacity(free.len());
            for (k, &j) in free.iter().enumerate() {
                let wanted = solution[(k, 0)];
                if !wanted.is_finite() {
                    return None;
                }
                step[j] = wanted.clamp(room[j][0], room[j][1]);
                if step[j] == wanted {
                    stays.push(j);
                }
            }
            if stays.len() == free.len() {
                break;
            }
            free = stays;
        }
        Some(step)
    }
}
