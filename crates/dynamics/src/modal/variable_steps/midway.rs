//! A case as equal steps take it on.

use std::array;
use std::sync::Arc;

use super::StepControl;
use super::integration::Integration;
use crate::modal::lane_start::LaneStart;
use crate::modal::oscillator::NODES;
use crate::modal::transient_case::{CaseResponse, TransientCase};
use crate::{ContactExtremes, EnergyLedger};

/// Parts of a case at whose ends it may be left to equal steps, so that cases alike are taken on side by
/// side; and parts before the last of these.
const PARTS: usize = 256;
const LAST_PART: usize = 224;

/// Periods of the lowest natural frequency during which no contact was near opening.
const PRESSED: f64 = 1.5;

/// A case after some base steps.
#[derive(Debug)]
pub(in crate::modal) struct Midway {
    pub(in crate::modal) start: Arc<LaneStart>,
    /// Extremes and averages of the contacts, with averages over the whole duration, and the work and
    /// losses so far.
    contacts: Vec<ContactExtremes>,
    energy: EnergyLedger,
    taken: usize,
    /// Pressure of each contact \[Pa\] that equal steps leave out; zero where it is too small to count.
    left: Vec<f64>,
}

/// The last of some equal steps of a case, and where it may be left.
#[derive(Debug)]
pub(super) struct Watch {
    /// The equal step and the base step \[s\], and their ratio.
    step: f64,
    base: f64,
    stride: usize,
    /// Base steps of a part, and between which base steps the case may be left.
    part: usize,
    first: usize,
    last: usize,
    /// Base steps in which no contact must have been near opening.
    pressed: usize,
    recent: [Recent; NODES],
    /// Pressures that equal steps leave out where the case is left.
    left: Vec<f64>,
}

/// The rows and the modes at the end of an equal step.
#[derive(Debug, Clone, Default)]
struct Recent {
    closure: Vec<f64>,
    traction: Vec<f64>,
    viscous: Vec<f64>,
    modes: Vec<f64>,
}

impl Watch {
    /// None for a case that is never left: too short, or without a lowest frequency.
    pub(super) fn new(case: &TransientCase, control: StepControl) -> Option<Self> {
        let stride = control.stride;
        let part = control.steps / PARTS / stride * stride;
        let natural = case.model.preloaded().natural_frequency()?;
        let pressed = (PRESSED / (natural * control.base)).ceil();
        let last = LAST_PART * part;
        // The cast saturates.
        let pressed = pressed as usize;
        let first = pressed.max(2 * NODES * stride);
        let (step, base) = (control.equal_step(), control.base);
        let (recent, left) = (Default::default(), Vec::new());
        (first < last).then_some(Self {
            step,
            base,
            stride,
            part,
            first,
            last,
            pressed,
            recent,
            left,
        })
    }

    /// Takes in the state after `done` base steps, at the end of an equal step; true if the case may be left there.
    pub(super) fn ends_at<const N: usize>(
        &mut self,
        run: &mut Integration<'_, N>,
        done: usize,
    ) -> bool {
        if done < self.first || done > self.last {
            return false;
        }
        let ahead = (done.next_multiple_of(self.part) - done) / self.stride;
        if ahead < NODES {
            self.recent.rotate_right(1);
            let (closure, traction, viscous) = run.rows_now();
            let modes = if ahead < 2 { run.modes().collect() } else { Vec::new() };
            self.recent[0] = Recent { closure, traction, viscous, modes };
        }
        if ahead > 0 || run.pressed < self.pressed {
            return false;
        }
        let left = run.left_by_steps(self.step, done as f64 * self.base);
        let is_left = left.is_some();
        self.left = left.unwrap_or_default();
        is_left
    }

    /// The case where it is left, with its output at equal steps so far.
    pub(super) fn midway<const N: usize>(
        self,
        run: &Integration<'_, N>,
        readings: Vec<f64>,
    ) -> Midway {
        let recent = self.recent;
        let rows = 0..recent[0].closure.len();
        let of = |age: usize, numbers: fn(&Recent) -> &Vec<f64>, i: usize| {
            numbers(&recent[age]).get(i).copied().unwrap_or(0.0)
        };
        let start = LaneStart {
            step: readings.len() - 1,
            modes: (0..recent[0].modes.len())
                .map(|k| array::from_fn(|age| of(age, |one| &one.modes, k)))
                .collect(),
            closure: rows
                .clone()
                .map(|i| array::from_fn(|age| of(age, |one| &one.closure, i)))
                .collect(),
            traction: rows
                .clone()
                .map(|i| array::from_fn(|age| of(age, |one| &one.traction, i)))
                .collect(),
            viscous: rows.map(|i| array::from_fn(|age| of(age, |one| &one.viscous, i))).collect(),
            velocities: run.mode_velocities().collect(),
            stiffness: run.stiffness_now(),
            load_port: run.load_port[0],
            readings,
            stored: 0.0,
        };
        Midway {
            start: Arc::new(start),
            contacts: run.contact_extremes(),
            energy: run.ledger(),
            taken: run.taken,
            left: self.left,
        }
    }
}

impl Midway {
    /// True if what equal steps leave out of the pressures cannot have been an extreme.
    pub(in crate::modal) fn keeps_extremes(&self, rest: &[ContactExtremes]) -> bool {
        let mut pairs = self.contacts.iter().zip(rest).zip(&self.left);
        pairs.all(|((before, after), left)| {
            *left == 0.0
                || (after.pressure_min - left >= before.pressure_min
                    && after.pressure_max + left <= before.pressure_max)
        })
    }

    /// The whole response, from the response of the rest.
    pub(in crate::modal) fn joined(&self, rest: CaseResponse) -> CaseResponse {
        let join = |(before, after): (&ContactExtremes, &ContactExtremes)| ContactExtremes {
            pressure_min: before.pressure_min.min(after.pressure_min),
            pressure_max: before.pressure_max.max(after.pressure_max),
            lost: before.lost + after.lost,
            stiffness_average: before.stiffness_average + after.stiffness_average,
        };
        let contacts = self.contacts.iter().zip(&rest.contacts).map(join).collect();
        let (before, after) = (&self.energy, rest.energy);
        let energy = EnergyLedger {
            input: before.input + after.input,
            dissipated: before.dissipated + after.dissipated,
            contact_dissipated: before.contact_dissipated + after.contact_dissipated,
            ..after
        };
        let integrated_steps = self.taken + rest.integrated_steps - self.start.step;
        CaseResponse { integrated_steps, contacts, energy, ..rest }
    }
}
