//! The motion between steps.
//!
//! The pressures at the steps fix the force within them, and under a given force every
//! oscillator's motion is known at any instant. So the samples of a response may fall anywhere
//! between steps, at any distance.

use std::cell::Cell;

use super::lane_start::LaneStart;
use super::law_point::LawPoint;
use super::oscillator::{ForceInterpolation, NODES, Propagator};
use super::prepared_case::PreparedCase;
use super::simd::outcome::Outcome;
use super::step_model::ModeStep;
use crate::{History, Sampling};
use asperity_structure::{LoadCase, PreloadedContact};

/// Parts of a step closer than this to one of its ends are that end.
const ON_STEP: f64 = 1e-9;

/// Places within a step whose propagators are kept.
const MOST_PLACES: usize = 64;

/// The samples of one case from rest, at every sensor of its model.
pub(super) fn history(
    case: &PreparedCase,
    outcome: &Outcome,
    load: &LoadCase,
    sampling: &Sampling,
) -> History {
    let (sensors, contacts) = (case.model.sensors(), case.model.contacts().len());
    let mut history = History::with_capacity(sampling.samples(), sensors, contacts);
    complete(&mut history, case, outcome, load, sampling);
    history
}

/// Adds the samples of one case that are not in its `history` yet.
pub(super) fn complete(
    history: &mut History,
    case: &PreparedCase,
    outcome: &Outcome,
    load: &LoadCase,
    sampling: &Sampling,
) {
    let mut motion = DenseOutput::new(case, outcome);
    for sample in history.time.len()..sampling.samples() {
        let time = sample as f64 * sampling.interval();
        history.time.push(time);
        history.load.push(load.value(time));
        motion.move_to(time, load);
        for (columns, moved) in history.sensors.iter_mut().zip(&motion.moved) {
            columns.push(*moved);
        }
        for (i, columns) in history.interfaces.iter_mut().enumerate() {
            columns.push(motion.contact(time, i));
        }
    }
}

/// The modes, integrated again with their velocities under the pressures found.
struct DenseOutput<'a> {
    case: &'a PreparedCase,
    outcome: &'a Outcome,
    /// Displacement and velocity of every mode at step `at`.
    states: Vec<[f64; 2]>,
    /// Displacements of every mode at the step before.
    before: Vec<f64>,
    at: usize,
    /// Step of the first rows of the outcome.
    first: usize,
    /// Coefficients of `s^k` of the tractions within the step from `at`, by interpolation and row.
    tractions: [Vec<[f64; NODES]>; ForceInterpolation::ALL.len()],
    /// Propagators of every mode to places within a step, the whole step first.
    places: Vec<Place>,
    /// Closure increment \[m\] at and below which each contact is lost.
    open_below: Vec<f64>,
    /// Displacement \[m\], velocity \[m/s\] and acceleration \[m/s2\] of each sensor.
    moved: Vec<[f64; 3]>,
    /// The law of each contact when it was last inverted.
    known: Vec<Cell<LawPoint>>,
}

/// The propagators of every mode to a part of a step; `moments` are of the forces `F_k s^k`.
struct Place {
    part: f64,
    propagators: Vec<Propagator>,
}

impl<'a> DenseOutput<'a> {
    fn new(case: &'a PreparedCase, outcome: &'a Outcome) -> Self {
        let model = &case.tabulated.step_model;
        let start = case.start.as_deref();
        let (states, before) = match start {
            Some(start) => {
                start.stepped(model).map(|([now, before], v)| ([now, v], before)).unzip()
            }
            None => (vec![[0.0; 2]; model.modes.len()], vec![0.0; model.modes.len()]),
        };
        let (at, first) = (case.first_step(), start.map_or(0, LaneStart::first_known));
        let open_below = (0..case.model.contacts().len()).map(|i| case.open_below(i)).collect();
        let (tractions, places) = (Default::default(), Vec::new());
        let moved = vec![[0.0; 3]; case.model.sensors()];
        let at_rest = |contact| Cell::new(LawPoint::at_rest(contact));
        let known = case.model.contacts().iter().map(at_rest).collect();
        let mut motion = Self {
            case,
            outcome,
            states,
            before,
            at,
            first,
            tractions,
            places,
            open_below,
            moved,
            known,
        };
        motion.place(1.0);
        motion.interpolate_tractions();
        motion
    }

    /// Number of the propagators to the part `s` of a step.
    fn place(&mut self, s: f64) -> usize {
        let close = |known: &Place| (known.part - s).abs() < ON_STEP;
        if let Some(found) = self.places.iter().position(close) {
            return found;
        }
        let model = &self.case.tabulated.step_model;
        let to = |mode: &ModeStep| {
            let mut propagator = mode.dynamics.propagator(s * model.step);
            let mut power = 1.0;
            for moment in &mut propagator.moments {
                *moment = moment.map(|share| share * power);
                power *= s;
            }
            propagator
        };
        let propagators = model.modes.iter().map(to).collect();
        if self.places.len() > MOST_PLACES {
            self.places.truncate(1);
        }
        self.places.push(Place { part: s, propagators });
        self.places.len() - 1
    }

    fn traction(&self, i: usize, step: Option<usize>) -> f64 {
        let column = &self.outcome.traction[i];
        let row = step.and_then(|step| step.checked_sub(self.first));
        row.and_then(|row| column.get(row.min(column.len() - 1))).copied().unwrap_or(0.0)
    }

    /// The cubic through four steps of a column of the outcome about part `s` of `step`.
    fn cubic(&self, column: &[f64], step: usize, s: f64) -> f64 {
        cubic(column, step - self.first, s)
    }

    /// Interpolates the tractions within the step from `at`.
    fn interpolate_tractions(&mut self) {
        self.tractions.iter_mut().for_each(Vec::clear);
        for i in 0..self.outcome.traction.len() {
            let ends: [f64; NODES] =
                std::array::from_fn(|age| self.traction(i, (self.at + 1).checked_sub(age)));
            for (of_rows, interpolation) in self.tractions.iter_mut().zip(ForceInterpolation::ALL) {
                let weights = interpolation.weights();
                let coefficient =
                    |row: [f64; NODES]| row.iter().zip(&ends).map(|(w, end)| w * end).sum();
                of_rows.push(weights.map(coefficient));
            }
        }
    }

    /// Coefficients of `s^k` of the modal force of a mode within the step from `at`.
    fn force(&self, mode: &ModeStep) -> [f64; NODES] {
        let mut force = [0.0; NODES];
        let tractions = &self.tractions[mode.interpolation as usize];
        for (of_row, traction) in mode.force.iter().zip(tractions) {
            for (force, traction) in force.iter_mut().zip(traction) {
                *force -= of_row * traction;
            }
        }
        let load = &self.case.load;
        if let (Some(mean), Some(rise)) = (load.mean.get(self.at), load.rise.get(self.at)) {
            let of = self.case.amplitude * mode.load;
            force[0] += of * (mean - 0.5 * rise);
            force[1] += of * rise;
        }
        force
    }

    /// Displacement and velocity of mode `m` at a place in the step from `at`.
    fn state(&self, m: usize, place: usize) -> [f64; 2] {
        let (propagator, [q, v]) = (&self.places[place].propagators[m], self.states[m]);
        let mut state = [
            propagator.displacement[0] * q + propagator.displacement[1] * v,
            propagator.velocity[0] * q + propagator.velocity[1] * v,
        ];
        let force = self.force(&self.case.tabulated.step_model.modes[m]);
        for (moment, force) in propagator.moments.iter().zip(force) {
            state[0] += moment[0] * force;
            state[1] += moment[1] * force;
        }
        state
    }

    /// Takes one step.
    fn advance(&mut self) {
        for m in 0..self.states.len() {
            self.before[m] = self.states[m][0];
            self.states[m] = self.state(m, 0);
        }
        self.at += 1;
        self.interpolate_tractions();
    }

    /// Step before `time` and the part of it that has passed.
    fn locate(&self, time: f64) -> (usize, f64) {
        let steps = time / self.case.tabulated.step_model.step;
        let whole = (steps + ON_STEP).floor();
        (whole as usize, (steps - whole).max(0.0))
    }

    /// Moves the sensors to `time` \[s\], which must not come before an earlier one.
    fn move_to(&mut self, time: f64, load: &LoadCase) {
        let (step, s) = self.locate(time);
        while self.at < step {
            self.advance();
        }
        let place = (s > ON_STEP).then(|| self.place(s));
        let model = &self.case.tabulated.step_model;
        let h = model.step;
        // The modes left out follow load and tractions at once.
        let following = |value: f64, f: &dyn Fn(f64) -> f64| {
            [value, (f(h) - f(-h)) / (2.0 * h), (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h)]
        };
        let mut moved = std::mem::take(&mut self.moved);
        let loaded = following(load.value(time), &|shift| load.value(time + shift));
        for (moved, share) in moved.iter_mut().zip(&model.residual.sensors_per_load) {
            *moved = loaded.map(|value| share * value);
        }
        for (m, mode) in model.modes.iter().enumerate() {
            let [q, mut v] = place.map_or(self.states[m], |place| self.state(m, place));
            let dynamics = &mode.dynamics;
            let acceleration = if dynamics.massless {
                let (next, now, before) = (self.state(m, 0)[0], self.states[m][0], self.before[m]);
                v = (next - before) / (2.0 * h);
                (next - 2.0 * now + before) / (h * h)
            } else {
                let force = self.force(mode).iter().rev().fold(0.0, |sum, f| sum * s + f);
                force - dynamics.rate * v - dynamics.angular_frequency.powi(2) * q
            };
            for (moved, participation) in moved.iter_mut().zip(&mode.sensors) {
                for (sum, value) in moved.iter_mut().zip([q, v, acceleration]) {
                    *sum += participation * value;
                }
            }
        }
        for i in 0..self.outcome.traction.len() {
            let at = |shift: f64| match shift {
                shift if shift > 0.0 => self.traction(i, Some(step + 1)),
                shift if shift < 0.0 => self.traction(i, step.checked_sub(1)),
                _ => self.traction(i, Some(step)),
            };
            let pressed = following(self.traction_increment(i, step, s), &at);
            for (moved, row) in moved.iter_mut().zip(&model.sensors_per_pressure) {
                for (sum, value) in moved.iter_mut().zip(pressed) {
                    *sum -= row[i] * value;
                }
            }
        }
        self.moved = moved;
    }

    /// Traction increment at row `i` at part `s` of `step`.
    fn traction_increment(&self, i: usize, step: usize, s: f64) -> f64 {
        if s <= ON_STEP {
            return self.traction(i, Some(step));
        }
        let contact = self.case.model.contacts().get(i);
        let elastic = |contact: &&PreloadedContact| {
            contact.damping().is_none() && contact.friction().is_none()
        };
        let Some(contact) = contact.filter(elastic) else {
            return self.cubic(&self.outcome.traction[i], step, s);
        };
        self.law(i, contact, self.cubic(&self.outcome.closure[i], step, s)).increment.value
    }

    /// The law of contact `i` at a closure increment \[m\].
    fn law(&self, i: usize, contact: &PreloadedContact, closure: f64) -> LawPoint {
        let found = self.known[i].get().moved(contact, closure);
        self.known[i].set(found);
        found
    }

    /// Pressure \[Pa\], closure \[m\] and stiffness \[Pa/m\] of interface `i` at `time` \[s\].
    fn contact(&self, time: f64, i: usize) -> (f64, f64, f64) {
        let (step, s) = self.locate(time);
        let contact = &self.case.model.contacts()[i];
        let increment = self.cubic(&self.outcome.closure[i], step, s);
        let closure = contact.closure() + increment;
        if increment <= self.open_below[i] {
            return (0.0, closure, 0.0);
        }
        let found = self.law(i, contact, increment);
        (found.pressure, closure, found.increment.tangent)
    }
}

/// The cubic through four rows of `column` about part `s` behind `row`.
fn cubic(column: &[f64], row: usize, s: f64) -> f64 {
    let at = |shift: isize| {
        let place = row.checked_add_signed(shift);
        place.map_or(0.0, |place| column[place.min(column.len() - 1)])
    };
    if s <= ON_STEP {
        return at(0);
    }
    let (a, b, c, d) = (at(-1), at(0), at(1), at(2));
    let (p, q, r) = (s + 1.0, s - 1.0, s - 2.0);
    -a * s * q * r / 6.0 + b * p * q * r / 2.0 - c * p * s * r / 2.0 + d * p * s * q / 6.0
}
