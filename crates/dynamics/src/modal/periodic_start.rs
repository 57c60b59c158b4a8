//! Cases that go on from a motion with the period of their load.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use faer::linalg::solvers::SolveLstsq;
use faer::{Mat, c64};

use super::assembly::ModalModel;
use super::batch::{Batch, Preparation};
use super::decimation::Decimation;
use super::energy::EnergyState;
use super::lane_start::LaneStart;
use super::load_steps::LoadShapes;
use super::oscillator::NODES;
use super::prepared_case::PreparedCase;
use super::row_modes::RowMode;
use super::simd::integrate::{BlockRun, Recording};
use super::transient_case::{CaseResponse, TransientCase, pressure_at};
use crate::DynamicsError;

/// Steps before a case goes on: as many as the interpolation of contact forces looks back.
const STEPS_BEFORE: usize = NODES;

/// Samples of a period for each harmonic of the pressures that is kept.
const SAMPLES_A_HARMONIC: usize = 4;

/// Fewest samples of a period.
const FEWEST_SAMPLES: usize = 16;

/// Departure of a period from a whole number of steps, in steps.
const WHOLE: f64 = 1e-6;

/// A motion with the period of a harmonic load, by the pressures of its contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicMotion {
    /// Pressure increments of each contact from rest \[Pa\], at equal times over a period, the first where the load
    /// is zero and rises.
    pub pressures: Vec<Vec<f64>>,
    /// Mean closure increment of each contact from rest \[m\].
    pub mean_closures: Vec<f64>,
}

impl Batch {
    /// The response to a case under a harmonic load that goes on from `motion` in place of rest, with its output at
    /// every step. Pressures decide the state: each mode is in the steady motion under them and the load,
    ///
    /// ```text
    /// q_k = (f F_k - sum_i g_i S_i P_ik) / (w^2 - (k W)^2 + i k W c),
    /// ```
    ///
    /// and rigid modes are where the mean closures are met. Times without contact are from there on.
    ///
    /// # Errors
    /// As [`Modal::integrate`](super::Modal::integrate), and [`DynamicsError::Setting`] for a load without a
    /// frequency, a step that is not given or does not divide the period, a duration of five steps or less, damped
    /// contacts, friction, a motion of another number of contacts, and fewer than 16 samples of it.
    pub fn run_from(
        &self,
        case: &TransientCase,
        motion: &PeriodicMotion,
    ) -> Result<CaseResponse, DynamicsError> {
        let state = PeriodicState::new(case, motion)?;
        let every_step = Decimation::every_step();
        let decimation = |_: usize, _: f64| Arc::clone(&every_step);
        let mut preparation =
            Preparation { shapes: LoadShapes::default(), decimation: &decimation };
        let mut attempt = preparation.first(0, case)?;
        loop {
            attempt = attempt.from(|lane| state.lane_start(lane));
            let (recording, stop) = (Recording::Decimated(&every_step), &AtomicBool::new(false));
            let run = BlockRun { lanes: &[attempt.lane()], recording, stop };
            let outcome = run.run(self.instructions).and_then(|all| all.into_iter().next());
            let outcome =
                outcome.ok_or(DynamicsError::InstructionSet { set: self.instructions })?;
            match attempt.next(case, &outcome, &mut preparation)? {
                Some(next) => attempt = next,
                None => return Ok(attempt.record(outcome)),
            }
        }
    }
}

/// The state of a structure over a period.
struct PeriodicState<'a> {
    model: &'a ModalModel,
    sensor: usize,
    /// Angular frequency \[rad/s\] and step \[s\].
    angular_frequency: f64,
    step: f64,
    amplitude: f64,
    /// Complex amplitudes of the pressure increments of each row, from the mean on \[Pa\].
    pressures: Vec<Vec<c64>>,
    /// The same of each mode of the structure.
    modes: Vec<Vec<c64>>,
}

/// The structure at one time.
struct Instant {
    modes: Vec<f64>,
    velocities: Vec<f64>,
    pressures: Vec<f64>,
    load: f64,
}

impl<'a> PeriodicState<'a> {
    fn new(case: &'a TransientCase, motion: &PeriodicMotion) -> Result<Self, DynamicsError> {
        let model = &*case.model;
        let refused =
            |quantity, value, accepted| Err(DynamicsError::Setting { quantity, value, accepted });
        let Some(frequency) = case.load.frequency() else {
            return refused("frequency of the load of a periodic motion [Hz]", 0.0, "above 0");
        };
        let steps = case.step.map_or(f64::NAN, |step| 1.0 / (frequency * step));
        if !((steps - steps.round()).abs() <= WHOLE && steps >= 1.0) {
            return refused("steps in the period of the motion", steps, "a whole number");
        }
        let periods = case.duration * frequency;
        let goes_on = periods * steps >= (STEPS_BEFORE + 1) as f64;
        if !goes_on {
            return refused("periods of the load in the duration", periods, "more than five steps");
        }
        if model.is_dissipative() {
            let quantity = "damped contacts and friction in a periodic motion";
            return refused(quantity, 1.0, "none");
        }
        let contacts = model.contacts().len();
        let given = motion.pressures.len().min(motion.mean_closures.len());
        if given != contacts || motion.pressures.len() != motion.mean_closures.len() {
            let quantity = "contacts of a periodic motion";
            return refused(quantity, given as f64, "those of the structure");
        }
        let samples = motion.pressures.iter().map(Vec::len).min().unwrap_or(0);
        if samples < FEWEST_SAMPLES {
            let quantity = "samples of the pressures over a period";
            return refused(quantity, samples as f64, "at least 16");
        }
        let pressures: Vec<Vec<c64>> = motion.pressures.iter().map(|of| harmonics(of)).collect();
        let mut state = Self {
            model,
            sensor: case.sensor,
            angular_frequency: TAU * frequency,
            step: 1.0 / (frequency * steps.round()),
            amplitude: case.load.amplitude(),
            pressures,
            modes: Vec::new(),
        };
        state.modes = model.row_modes().modes.iter().map(|mode| state.moved(mode)).collect();
        state.place_rigid_modes(&motion.mean_closures);
        Ok(state)
    }

    /// Complex amplitude of harmonic `k` of the load: a sine.
    fn load(&self, k: usize) -> c64 {
        if k == 1 { c64::new(0.0, -self.amplitude) } else { c64::new(0.0, 0.0) }
    }

    /// The steady motion of a mode under the pressures and the load; the mean of a rigid one is zero.
    fn moved(&self, mode: &RowMode) -> Vec<c64> {
        let count = self.pressures.iter().map(Vec::len).max().unwrap_or(0).max(2);
        let rate = mode.total_damping(self.model.preloaded().damping_rate());
        let of = |k: usize| {
            let mut force = self.load(k) * mode.load;
            for (i, pressures) in self.pressures.iter().enumerate() {
                let share = mode.closure[i] * self.model.area(i);
                force -= pressures.get(k).copied().unwrap_or_default() * share;
            }
            let turning = k as f64 * self.angular_frequency;
            let inertia = if mode.massless { 0.0 } else { turning * turning };
            let stiffness = mode.angular_frequency * mode.angular_frequency;
            let resistance = c64::new(stiffness - inertia, turning * rate);
            if resistance == c64::new(0.0, 0.0) { c64::new(0.0, 0.0) } else { force / resistance }
        };
        (0..count).map(of).collect()
    }

    /// Moves the rigid modes so that the mean closures are these, in the sense of least squares.
    fn place_rigid_modes(&mut self, mean_closures: &[f64]) {
        let rows = self.model.row_modes();
        let rigid: Vec<usize> =
            (0..rows.modes.len()).filter(|&m| rows.modes[m].angular_frequency == 0.0).collect();
        if rigid.is_empty() || mean_closures.len() < rigid.len() {
            return;
        }
        let mean = Instant {
            modes: self.modes.iter().map(|mode| mode[0].re).collect(),
            velocities: Vec::new(),
            pressures: self.pressures.iter().map(|of| of[0].re).collect(),
            load: 0.0,
        };
        let shapes =
            Mat::from_fn(mean_closures.len(), rigid.len(), |i, r| rows.modes[rigid[r]].closure[i]);
        let left =
            Mat::from_fn(mean_closures.len(), 1, |i, _| mean_closures[i] - self.closure(&mean, i));
        let moved = shapes.col_piv_qr().solve_lstsq(&left);
        for (r, &m) in rigid.iter().enumerate() {
            self.modes[m][0] = c64::new(moved[(r, 0)], 0.0);
        }
    }

    /// The structure after so many steps.
    fn at(&self, step: usize) -> Instant {
        let phase = self.angular_frequency * self.step * step as f64;
        let count = self.modes.first().map_or(0, Vec::len);
        let turns: Vec<c64> = (0..count).map(|k| turn(k as f64 * phase)).collect();
        let sum = |of: &[c64]| of.iter().zip(&turns).map(|(c, t)| (c * t).re).sum();
        let rate = |of: &[c64]| {
            let terms = of.iter().zip(&turns).enumerate();
            terms.map(|(k, (c, t))| -(k as f64) * self.angular_frequency * (c * t).im).sum()
        };
        Instant {
            modes: self.modes.iter().map(|mode| sum(mode)).collect(),
            velocities: self.modes.iter().map(|mode| rate(mode)).collect(),
            pressures: self.pressures.iter().map(|row| sum(row)).collect(),
            load: self.amplitude * phase.sin(),
        }
    }

    /// Displacement of a port by its participations in the modes, its flexibility under the load, and under the
    /// force of each row.
    fn displacement(
        &self,
        at: &Instant,
        participation: impl Fn(&RowMode) -> f64,
        (per_load, per_row): (f64, &[f64]),
    ) -> f64 {
        let modes = self.model.row_modes().modes.iter().zip(&at.modes);
        let moved: f64 = modes.map(|(mode, q)| participation(mode) * q).sum();
        let pressures = at.pressures.iter().zip(per_row).enumerate();
        let pushed = pressures.map(|(j, (pressure, per))| per * self.model.area(j) * pressure);
        moved + per_load * at.load - pushed.sum::<f64>()
    }

    /// Closure increment of row `i` \[m\].
    fn closure(&self, at: &Instant, i: usize) -> f64 {
        let residual = &self.model.row_modes().residual;
        self.displacement(at, |mode| mode.closure[i], (residual.load[i], &residual.closure[i]))
    }

    /// The start of a case in which the motion goes on.
    fn lane_start(&self, lane: &PreparedCase) -> LaneStart {
        let rows = self.model.row_modes();
        let residual = &rows.residual;
        // The newest first.
        let all: Vec<Instant> = (0..=STEPS_BEFORE).rev().map(|step| self.at(step)).collect();
        let (now, last) = (&all[0], &all[..NODES]);
        let ages = |of: &dyn Fn(&Instant) -> f64| std::array::from_fn(|age| of(&last[age]));
        let reading = |at: &Instant| {
            let per = (residual.sensors_per_load[self.sensor], &*residual.sensors[self.sensor]);
            self.displacement(at, |mode| mode.sensors[self.sensor], per)
        };
        let stiffness =
            |(i, contact)| pressure_at(contact, lane.open_below(i), self.closure(now, i))[1];
        let mut start = LaneStart {
            step: STEPS_BEFORE,
            modes: (0..rows.modes.len()).map(|m| [now.modes[m], all[1].modes[m]]).collect(),
            velocities: now.velocities.clone(),
            closure: (0..rows.rows()).map(|i| ages(&|at| self.closure(at, i))).collect(),
            traction: (0..rows.rows()).map(|i| ages(&|at| at.pressures[i])).collect(),
            viscous: vec![[0.0; 2]; rows.rows()],
            stiffness: self.model.contacts().iter().enumerate().map(stiffness).collect(),
            load_port: self.displacement(
                now,
                |mode| mode.load,
                (residual.load_port, &residual.load),
            ),
            readings: all.iter().rev().map(reading).collect(),
            stored: 0.0,
        };
        let moving = start.stepped(&lane.tabulated.step_model);
        let state = EnergyState {
            modes: moving.map(|([now, _], velocity)| [now, velocity]).collect(),
            tractions: now.pressures.clone(),
            closures: (0..self.model.contacts().len()).map(|i| self.closure(now, i)).collect(),
            load: now.load,
        };
        start.stored = state.stored(lane).iter().sum();
        start
    }
}

/// Complex amplitudes of samples of a period, from the mean on.
fn harmonics(samples: &[f64]) -> Vec<c64> {
    let count = samples.len() as f64;
    let turns: Vec<c64> = (0..samples.len()).map(|n| turn(-TAU * n as f64 / count)).collect();
    let of = |k: usize| {
        let terms = samples.iter().enumerate();
        let sum: c64 = terms.map(|(n, p)| turns[k * n % turns.len()] * p).sum();
        sum * if k == 0 { 1.0 / count } else { 2.0 / count }
    };
    (0..=samples.len() / SAMPLES_A_HARMONIC).map(of).collect()
}

fn turn(phase: f64) -> c64 {
    c64::new(phase.cos(), phase.sin())
}
