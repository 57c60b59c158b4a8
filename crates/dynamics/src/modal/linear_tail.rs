//! The rest of a ring-down in which the laws are straight, in closed form.
//!
//! Without a load, and while each law is its tangent at rest, a step is linear. The state z, which a
//! step hands to the next one, and the output u obey
//!
//! ```text
//! z_(s+1) = A z_s,   u_(s+1+n) = c A^n z_s.
//! ```
//!
//! Each decimated sample after step s is a row times the state at step s,
//! `sum over n of taps_(j factor - s - 1 - n) c A^n`. All cases of a model share these rows. `ring_down`
//! chooses the step s, and checks that the laws are straight after it.

use std::sync::Arc;

use asperity_law::CompiledLaw;

use super::decimation::Decimation;
use super::linear_system::Factors;
use super::oscillator::{ForceInterpolation, NODES, Recurrence};
use super::step_model::{ModeStep, StepModel};

/// Most modes, since the matrix is multiplied once a sample, and most numbers in the rows.
const MOST_MODES: usize = 12;
const MOST_NUMBERS: usize = 1 << 20;

/// The rest of the responses of one model at one step.
#[derive(Debug)]
pub(super) struct LinearTail {
    /// Number of steps before it.
    pub(super) from: usize,
    first_sample: usize,
    /// Shares of each variable of the state in the samples from the first on.
    columns: Vec<Vec<f64>>,
}

impl LinearTail {
    /// The rest of responses of `steps` steps after the first `from`; none if the rows would cost
    /// more than the steps, or if it does not decay.
    pub(super) fn new(
        model: &StepModel,
        tables: &[Arc<CompiledLaw>],
        sensor: usize,
        (from, steps): (usize, usize),
        decimation: &Decimation,
    ) -> Option<Self> {
        let (factor, reach) = (decimation.stride(), decimation.taps.len());
        // The last step with an output; the state at the very end has none.
        let last = steps.checked_sub(1)?;
        let count = decimation.samples(steps);
        let first_sample = (from + 1).div_ceil(factor);
        let linear = LinearStep::new(model, tables, sensor);
        let numbers = count.saturating_sub(first_sample).saturating_mul(linear.size);
        // Samples whose steps all lie between, the first and the last.
        let (whole, last_whole) = ((from + reach).div_ceil(factor), last / factor);
        let is_worth =
            reach > 0 && whole < last_whole && numbers <= MOST_NUMBERS && linear.size > 0;
        if !is_worth || model.modes.len() > MOST_MODES {
            return None;
        }
        let (matrix, output) = linear.matrix();
        // An oscillation that the step makes grow must show in the energy of all steps.
        if !matrix.power(steps - from).entries.iter().all(|entry| entry.abs() < 1.0) {
            return None;
        }
        let mut columns = vec![Vec::with_capacity(count - first_sample); linear.size];
        let mut push = |row: &[f64]| {
            for (column, entry) in columns.iter_mut().zip(row) {
                column.push(*entry);
            }
        };
        // Sample j from rows of the outputs, of which the first belongs to step `first`.
        let sample = |j: usize, rows: &[Vec<f64>], first: usize| {
            let mut sum = vec![0.0; linear.size];
            for (n, row) in rows.iter().enumerate() {
                let tap = (j * factor).checked_sub(first + n).and_then(|l| decimation.taps.get(l));
                for (sum, entry) in sum.iter_mut().zip(row) {
                    *sum += tap.copied().unwrap_or(0.0) * entry;
                }
            }
            sum
        };
        let rows = matrix.rows(output.clone(), whole * factor - from);
        let mut row = Vec::new();
        for j in first_sample..=whole {
            row = sample(j, &rows, from + 1);
            push(&row);
        }
        let stride = matrix.power(factor);
        for _ in whole + 1..=last_whole {
            row = stride.left_product(&row);
            push(&row);
        }
        let first = ((last_whole + 1) * factor + 1).saturating_sub(reach).max(from + 1);
        let row = matrix.power_left_product(output, first - from - 1);
        let rows = matrix.rows(row, (last + 1).saturating_sub(first));
        for j in last_whole + 1..count {
            push(&sample(j, &rows, first));
        }
        Some(Self { from, first_sample, columns })
    }

    /// Adds the rest to the samples of a response, from its state.
    #[inline(always)]
    pub(super) fn add_to(&self, samples: &mut [f64], state: &[f64]) {
        let samples = samples.get_mut(self.first_sample..).unwrap_or_default();
        for (column, variable) in self.columns.iter().zip(state) {
            for (sample, share) in samples.iter_mut().zip(column) {
                *sample += variable * share;
            }
        }
    }
}

/// Number of shares of contact forces that a mode carries over to later steps.
pub(super) fn carried(mode: &ModeStep) -> usize {
    if mode.interpolation == ForceInterpolation::Quartic { NODES - 1 } else { 1 }
}

/// A step between contacts that are springs. The state is for each mode its displacement and increment
/// at the end of the next step without that step's pressures, and the shares carried over.
struct LinearStep<'a> {
    model: &'a StepModel,
    sensor: usize,
    size: usize,
    /// Stiffness of each contact \[Pa/m\], and the factors of their equations.
    stiffness: Vec<f64>,
    factors: Factors,
}

impl<'a> LinearStep<'a> {
    fn new(model: &'a StepModel, tables: &[Arc<CompiledLaw>], sensor: usize) -> Self {
        let stiffness: Vec<f64> = tables.iter().map(|table| table.tangent(0.0)).collect();
        let mut factors = Factors::new(stiffness.len());
        factors.factor(&model.coupling, &stiffness);
        let size = model.modes.iter().map(|mode| 2 + carried(mode)).sum();
        Self { model, sensor, size, stiffness, factors }
    }

    /// Takes a step, and gives its output \[m\].
    fn take(&self, state: &mut [f64]) -> f64 {
        let mut pressure = vec![0.0; self.stiffness.len()];
        let mut at = 0;
        for mode in &self.model.modes {
            for (closure, shape) in pressure.iter_mut().zip(&mode.closure) {
                *closure += shape * state[at];
            }
            at += 2 + carried(mode);
        }
        self.factors.solve(&mut pressure);
        let mut output = 0.0;
        let residual = self.model.sensors_per_pressure[self.sensor].iter();
        for ((closure, stiffness), share) in pressure.iter_mut().zip(&self.stiffness).zip(residual)
        {
            *closure *= stiffness;
            output -= share * *closure;
        }
        let mut rest = state;
        for mode in &self.model.modes {
            let (own, others) = rest.split_at_mut(2 + carried(mode));
            rest = others;
            let [predicted, predicted_increment, carry @ ..] = own else { break };
            let pairs = mode.force.iter().zip(&pressure);
            let force: f64 = pairs.map(|(force, pressure)| force * pressure).sum();
            let taps = mode.recurrence.contact.map(|tap| -tap * force);
            let increment = *predicted_increment + taps[0];
            let reached = *predicted + taps[0];
            output += mode.sensors[self.sensor] * reached;
            let forced = taps[1] + carry[0];
            carry.rotate_left(1);
            if let Some(newest) = carry.last_mut() {
                *newest = 0.0;
            }
            for (carry, tap) in carry.iter_mut().zip(&taps[2..]) {
                *carry += tap;
            }
            let Recurrence { decay, spring, .. } = mode.recurrence;
            *predicted_increment = decay * increment - spring * reached + forced;
            *predicted = reached + *predicted_increment;
        }
        output
    }

    /// The matrix A and the row c.
    fn matrix(&self) -> (Matrix, Vec<f64>) {
        let mut entries = vec![0.0; self.size * self.size];
        let mut output = vec![0.0; self.size];
        for k in 0..self.size {
            let mut state = vec![0.0; self.size];
            state[k] = 1.0;
            output[k] = self.take(&mut state);
            for (i, entry) in state.into_iter().enumerate() {
                entries[i * self.size + k] = entry;
            }
        }
        (Matrix { size: self.size, entries }, output)
    }
}

/// A square matrix, row by row.
#[derive(Debug, Clone)]
struct Matrix {
    size: usize,
    entries: Vec<f64>,
}

impl Matrix {
    /// `row A`.
    fn left_product(&self, row: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; self.size];
        for (factor, entries) in row.iter().zip(self.entries.chunks_exact(self.size)) {
            for (sum, entry) in product.iter_mut().zip(entries) {
                *sum += factor * entry;
            }
        }
        product
    }

    fn times(&self, other: &Self) -> Self {
        let rows = self.entries.chunks_exact(self.size);
        Self { size: self.size, entries: rows.flat_map(|row| other.left_product(row)).collect() }
    }

    /// `row A^0` to `row A^(count - 1)`.
    fn rows(&self, row: Vec<f64>, count: usize) -> Vec<Vec<f64>> {
        std::iter::successors(Some(row), |row| Some(self.left_product(row))).take(count).collect()
    }

    /// `row A^exponent`.
    fn power_left_product(&self, mut row: Vec<f64>, mut exponent: usize) -> Vec<f64> {
        let mut square = self.clone();
        while exponent > 0 {
            if exponent % 2 == 1 {
                row = square.left_product(&row);
            }
            exponent /= 2;
            if exponent > 0 {
                square = square.times(&square);
            }
        }
        row
    }

    /// `A^exponent`, at least the first.
    fn power(&self, exponent: usize) -> Self {
        if exponent <= 1 {
            return self.clone();
        }
        let half = self.power(exponent / 2);
        let even = half.times(&half);
        if exponent % 2 == 1 { even.times(self) } else { even }
    }
}
