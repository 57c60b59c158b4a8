//! The rest of a ring-down in which the laws are straight, in closed form.
//!
//! While each law is its tangent at rest, a step without a load is linear in what it carries over
//! to the next, `z`, and so is the output u:
//!
//! ```text
//! u_(s+1+n) = c A^n z_s.
//! ```
//!
//! Every decimated sample after step s is then a row times the state there,
//! `sum over n of taps_(j factor - s - 1 - n) c A^n`, and these rows are the same for all cases of a
//! model. Step s is that at which the slowest ring-down, that of mass-proportional damping alone, has
//! become small; whether the laws are straight enough there is checked case by case, and if they are not,
//! the case is integrated to its end.

use std::f64::consts::TAU;

use super::assembly::{ModalModel, PreparedCase, TabulatedModel};
use super::linear_system::Factors;
use super::load_steps::LoadSteps;
use super::oscillator::{ForceInterpolation, NODES, Recurrence};
use super::simd::decimation::Decimation;
use super::simd::integrate::Outcome;
use super::step_model::{ModeStep, StepModel};
use crate::EnergyLedger;

/// Most that the bend of the laws may change in the displacement, over its peak: below the error of
/// the laws' tables.
const DEPARTURE: f64 = 1e-6;

/// Share of the amplitude at which a law that is bent by as much as it carries would change so much.
/// The check is stricter than the motion: it allows each contact all of the energy.
const AMPLITUDE: f64 = 0.5;

/// Share of its peak below which a force counts as passed when the ring-down is predicted.
const PASSED: f64 = 1e-3;

/// Parts of a response that are integrated are sixteenths of it, so that cases whose ring-downs differ
/// a little are integrated side by side, and at most twelve: less is not worth the preparation.
const PARTS: f64 = 16.0;
const MOST_PARTS: f64 = 12.0;

/// Most modes, whose matrix is multiplied once a sample, and most numbers in the rows.
const MOST_MODES: usize = 12;
const MOST_NUMBERS: usize = 1 << 20;

/// Step at which a response of `steps` steps of `step` \[s\] may be linear from then on; none where
/// too little of it would be left, or where it is not known to ring down.
pub(super) fn start(
    model: &ModalModel,
    load: &LoadSteps,
    step: f64,
    steps: usize,
) -> Option<usize> {
    let structure = model.preloaded();
    let (frequency, rate) = (TAU * structure.natural_frequency()?, structure.damping_rate());
    // Written so that a rate that is not a number has no rest.
    let rings_down = rate > 0.0 && rate < frequency && !model.is_dissipative();
    if !rings_down {
        return None;
    }
    let amplitude = AMPLITUDE * (DEPARTURE * rate / frequency).sqrt();
    let peak = load.mean.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let acting = load.mean.iter().rposition(|force| force.abs() > PASSED * peak)? + 1;
    let decay = -2.0 * amplitude.ln() / (rate * step);
    // The recurrence sees the load of the step before.
    let from = (acting as f64 + decay).max((load.steps() + 2) as f64);
    let parts = (PARTS * from / steps as f64).ceil();
    (parts <= MOST_PARTS).then(|| (parts / PARTS * steps as f64).ceil() as usize)
}

/// True if the laws of `case` bend so little in what is left of its motion that the rest is linear.
///
/// The energy that is left bounds each closure, `Y = sqrt(2 E / (S K))`. Within it the law departs from
/// its tangent by a share b, which changes a frequency by b/2 and in the time that the ring-down
/// takes a phase by `b w / c`, with the damping rate c.
pub(super) fn is_straight(case: &PreparedCase, outcome: &Outcome, energy: &EnergyLedger) -> bool {
    let structure = case.model.preloaded();
    let turns = TAU * structure.natural_frequency().unwrap_or(0.0) / structure.damping_rate();
    let left = energy.kinetic + energy.elastic + energy.contact;
    let pairs = case.model.contacts().iter().zip(&case.tabulated.tables);
    // A number that is not one is not straight.
    pairs.zip(&outcome.contacts).all(|((contact, table), seen)| {
        let stiffness = table.tangent(0.0);
        let bound = (2.0 * left / (contact.area() * stiffness)).sqrt();
        let bend = |closure: f64| (table.get(closure) / (stiffness * closure) - 1.0).abs();
        let largest = seen.extremes.highest.max(-seen.extremes.lowest);
        let change = |closure: f64| bound / largest * bend(closure) * turns;
        change(bound) <= DEPARTURE && change(-bound) <= DEPARTURE
    })
}

/// The energy balance at the end of a response from that where its rest begins: what is left decays at
/// the rate of the mass-proportional damping.
pub(super) fn at_end(case: &PreparedCase, energy: EnergyLedger) -> EnergyLedger {
    let model = &case.tabulated.step_model;
    let time = (case.steps - case.integrated()) as f64 * model.step;
    let share = (-case.model.preloaded().damping_rate() * time).exp();
    let left = energy.kinetic + energy.elastic + energy.contact;
    EnergyLedger {
        kinetic: share * energy.kinetic,
        elastic: share * energy.elastic,
        contact: share * energy.contact,
        dissipated: energy.dissipated + (1.0 - share) * left,
        ..energy
    }
}

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
    /// The rest of responses of `steps` steps after the first `from`; none if it would be larger than
    /// it is worth, or if it does not decay.
    pub(super) fn new(
        model: &TabulatedModel,
        sensor: usize,
        (from, steps): (usize, usize),
        decimation: &Decimation,
    ) -> Option<Self> {
        let (factor, reach) = (decimation.factor.max(1), decimation.taps.len());
        // The state at the very end is beyond the outputs, of which the last is this.
        let last = steps.checked_sub(1)?;
        let count = (steps + reach).checked_sub(1)?.div_ceil(factor);
        let first_sample = (from + 1).div_ceil(factor);
        let linear = LinearStep::new(model, sensor);
        let numbers = count.saturating_sub(first_sample).saturating_mul(linear.size);
        // Samples whose steps all lie between, the first and the last.
        let (whole, last_whole) = ((from + reach).div_ceil(factor), last / factor);
        let is_worth =
            reach > 0 && whole < last_whole && numbers <= MOST_NUMBERS && linear.size > 0;
        if !is_worth || model.step_model.modes.len() > MOST_MODES {
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
        // Sample j from rows of the outputs, the first of which is that of step `first`.
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
    fn new(tabulated: &'a TabulatedModel, sensor: usize) -> Self {
        let model = &tabulated.step_model;
        let tables = tabulated.tables.iter();
        let stiffness: Vec<f64> = tables.map(|table| table.tangent(0.0)).collect();
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
