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
//! `sum over n of taps_(j factor - s - 1 - n) c A^n`. Samples whose steps all lie after step s repeat: a block of
//! rows gives the first of them, and the same block those behind it, from the state moved on. The last outputs before
//! the filter are rows of their own. All cases of a model share these rows. `ring_down` chooses the step s, and checks
//! that the laws are straight after it.

use std::sync::Arc;

use asperity_law::CompiledLaw;
use faer::{Col, Mat, MatRef};

use super::decimation::Decimation;
use super::linear_system::Factors;
use super::oscillator::{ForceInterpolation, NODES, Recurrence};
use super::step_model::{ModeStep, StepModel};

/// Most modes, since their matrix is multiplied with itself, and most numbers in the rows.
const MOST_MODES: usize = 12;
const MOST_NUMBERS: usize = 1 << 20;

/// Samples that one block of rows gives.
const BLOCK: usize = 64;

/// The rest of the responses of one model at one step.
#[derive(Debug)]
pub(super) struct LinearTail {
    /// Number of steps before it.
    pub(super) from: usize,
    first_sample: usize,
    /// Rows of the samples whose filter reaches back beyond the first step.
    head: Mat<f64>,
    /// Rows of the first samples behind them, and the matrix that moves the state on by as many.
    block: Mat<f64>,
    advance: Mat<f64>,
    /// Number of these samples.
    repeated: usize,
    /// Rows of the samples whose filter reaches beyond the last step.
    end: Mat<f64>,
    /// Rows of the last outputs before the filter, and how many of these came before.
    ending: Mat<f64>,
    ending_before: usize,
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
        let ending_from = decimation.ending_from(steps);
        let first_ending = ending_from.max(from + 1).min(steps);
        let ending = steps - first_ending;
        let numbers = (count.saturating_sub(first_sample) + ending).saturating_mul(linear.size);
        // Samples whose steps all lie between, the first and the last.
        let (whole, last_whole) = ((from + reach).div_ceil(factor), last / factor);
        let is_worth =
            reach > 0 && whole < last_whole && numbers <= MOST_NUMBERS && linear.size > 0;
        if !is_worth || model.modes.len() > MOST_MODES {
            return None;
        }
        let (matrix, output) = linear.matrix();
        let mut powers = Powers(vec![matrix]);
        // An oscillation that the step makes grow must show in the energy of all steps.
        let beyond = (steps - from).next_power_of_two();
        if !powers.power(beyond).col_iter().all(|column| column.iter().all(|x| x.abs() < 1.0)) {
            return None;
        }
        // Samples `from_sample` on, from rows of the outputs, of which the first belongs to step `first`.
        let samples = |rows: &Mat<f64>, first: usize, from_sample: usize, count: usize| {
            let tap = |j: usize, n: usize| {
                let place = ((from_sample + j) * factor).checked_sub(first + n);
                place.and_then(|l| decimation.taps.get(l)).copied().unwrap_or(0.0)
            };
            Mat::from_fn(count, rows.nrows(), tap) * rows
        };
        let rows = powers.rows(output.as_ref(), 1, whole * factor - from);
        let head = samples(&rows, from + 1, first_sample, whole + 1 - first_sample);
        let repeated = last_whole - whole;
        let row = head.subrows(whole - first_sample, 1) * powers.power(factor);
        let block = powers.rows(row.as_ref(), factor, BLOCK.min(repeated));
        let advance = powers.power(factor * BLOCK);
        let first = ((last_whole + 1) * factor + 1).saturating_sub(reach).max(from + 1);
        let row = powers.moved(&output, first - from - 1);
        let rows = powers.rows(row.as_ref(), 1, (last + 1).saturating_sub(first));
        let end = samples(&rows, first, last_whole + 1, count.saturating_sub(last_whole + 1));
        let row = powers.moved(&output, first_ending - from - 1);
        let ending = powers.rows(row.as_ref(), 1, ending);
        let ending_before = first_ending - ending_from;
        let tail =
            Self { from, first_sample, head, block, advance, repeated, end, ending, ending_before };
        Some(tail)
    }

    /// Adds the rest to the samples of a response, and to its last outputs, from its state.
    pub(super) fn add_to(&self, samples: &mut [f64], ending: &mut [f64], state: &[f64]) {
        add_product(ending.get_mut(self.ending_before..).unwrap_or_default(), &self.ending, state);
        let samples = samples.get_mut(self.first_sample..).unwrap_or_default();
        let (head, rest) = samples.split_at_mut(self.head.nrows().min(samples.len()));
        let (repeated, end) = rest.split_at_mut(self.repeated.min(rest.len()));
        add_product(head, &self.head, state);
        add_product(end, &self.end, state);
        let mut state = Col::from_fn(state.len(), |k| state[k]);
        for (n, block) in repeated.chunks_mut(BLOCK).enumerate() {
            if n > 0 {
                state = &self.advance * &state;
            }
            let state: Vec<f64> = state.iter().copied().collect();
            add_product(block, &self.block, &state);
        }
    }
}

/// Adds the products of the first rows with a state to samples.
fn add_product(samples: &mut [f64], rows: &Mat<f64>, state: &[f64]) {
    for (column, variable) in rows.col_iter().zip(state) {
        for (sample, share) in samples.iter_mut().zip(column.iter()) {
            *sample += variable * share;
        }
    }
}

/// A square matrix A, and its powers of 2, 4, 8, ... as far as they were needed.
struct Powers(Vec<Mat<f64>>);

impl Powers {
    /// `A^(2^k)`.
    fn square(&mut self, k: usize) -> &Mat<f64> {
        while self.0.len() <= k {
            let last = &self.0[self.0.len() - 1];
            let next = last * last;
            self.0.push(next);
        }
        &self.0[k]
    }

    fn power(&mut self, exponent: usize) -> Mat<f64> {
        let bits = (0..usize::BITS as usize).filter(|bit| exponent >> bit & 1 == 1);
        let mut power: Option<Mat<f64>> = None;
        for bit in bits {
            let square = self.square(bit);
            power = Some(power.map_or_else(|| square.clone(), |power| power * square));
        }
        let size = self.0[0].nrows();
        power.unwrap_or_else(|| Mat::identity(size, size))
    }

    /// `row A^exponent`.
    fn moved(&mut self, row: &Mat<f64>, exponent: usize) -> Mat<f64> {
        let bits = (0..usize::BITS as usize).filter(|bit| exponent >> bit & 1 == 1);
        bits.fold(row.clone(), |row, bit| row * self.square(bit))
    }

    /// `row A^0`, `row A^stride`, ... to the number of `count`, each half of them from the first half.
    fn rows(&mut self, row: MatRef<'_, f64>, stride: usize, count: usize) -> Mat<f64> {
        let mut rows = Mat::zeros(count.max(1), row.ncols());
        rows.subrows_mut(0, 1).copy_from(row);
        let mut known = 1;
        while known < count {
            let more = known.min(count - known);
            let next = rows.subrows(0, more) * self.power(stride * known);
            rows.subrows_mut(known, more).copy_from(next);
            known += more;
        }
        rows.resize_with(count, row.ncols(), |_, _| 0.0);
        rows
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
    fn matrix(&self) -> (Mat<f64>, Mat<f64>) {
        let mut matrix = Mat::zeros(self.size, self.size);
        let mut output = Mat::zeros(1, self.size);
        for k in 0..self.size {
            let mut state = vec![0.0; self.size];
            state[k] = 1.0;
            output[(0, k)] = self.take(&mut state);
            for (i, entry) in state.into_iter().enumerate() {
                matrix[(i, k)] = entry;
            }
        }
        (matrix, output)
    }
}
