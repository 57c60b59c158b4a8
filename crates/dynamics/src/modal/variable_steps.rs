//! One case at steps of its own: long ones while the motion is smooth, short ones where contact opens
//! and closes.
//!
//! A step is a half, a quarter and so on of the base step. Its length is chosen from the tractions: the
//! cubic of the step before, continued, differs from the traction at the end of the step by
//!
//! ```text
//! (h^2 / 24) (h + h_before)^2 d4T/dt4,
//! ```
//!
//! of which the error of the cubic within the step is at most the share `h^2 / (16 (h + h_before)^2)`. The
//! step is halved while this error exceeds the tolerance, over the largest traction so far, and doubled
//! where it falls far below. A kink of a law, where contact opens or closes, gives an error of the first
//! power of h, so that the steps across it shrink with the tolerance.
//!
//! Once contact holds, the load acts slowly and base steps are not divided any more, the rest may be left to
//! equal steps, which many cases take side by side: [`Ended::Midway`].
//!
//! | module | holds |
//! |---|---|
//! | [`integration`] | a case on its way: its steps and their lengths |
//! | [`modal_motion`] | the modes over a step |
//! | [`midway`] | the case as equal steps take it on |
//! | [`bend`] | the traction within a step, to sixth order |
//! | [`contact_solve`] | closures and tractions at the end of a step |
//! | [`measures`] | extremes, times without contact, mean stiffness and energies |
#![allow(
    clippy::needless_range_loop,
    reason = "rows and columns of small square matrices by index"
)]

mod bend;
mod contact_solve;
mod integration;
mod measures;
mod midway;
mod modal_motion;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pulp::{Simd, WithSimd};

use super::assembly::MOST_INTERFACES;
use super::decimation::Decimation;
use super::law_tables::tolerance_at_own_steps;
use super::transient_case::{CaseResponse, TransientCase, first_table_exponents};
use crate::error::{balanced, positive};
use crate::{DynamicsError, History, InstructionSet, Sampling};
use integration::Integration;
pub(super) use midway::Midway;
use midway::Watch;

/// Base steps of a case, and the error of the tractions within a step.
#[derive(Debug, Clone, Copy)]
struct StepControl {
    /// Longest step \[s\].
    base: f64,
    /// Number of base steps.
    steps: usize,
    /// Base steps in one of the equal steps that may take the case on.
    stride: usize,
    /// Error of the traction within a step over its largest so far.
    tolerance: f64,
}

impl StepControl {
    fn of(case: &TransientCase) -> Result<Self, DynamicsError> {
        let (base, steps) = case.first_step()?;
        // Not a number without one, which is refused.
        let (quantity, value) = ("tolerance of steps", case.tolerance.unwrap_or(f64::NAN));
        if case.model.preloaded().friction().is_some() {
            let accepted = "none for a structure with friction";
            return Err(DynamicsError::Setting { quantity, value, accepted });
        }
        let tolerance = positive(quantity, value)?;
        Ok(Self { base, steps, stride: 1, tolerance })
    }

    /// Error of the tables of laws, as a share of the static pressures.
    fn table_tolerance(&self) -> f64 {
        tolerance_at_own_steps(self.tolerance)
    }

    /// Equal steps \[s\] that may take the case on.
    fn equal_step(&self) -> f64 {
        self.stride as f64 * self.base
    }
}

/// End of a case at steps of its own, with its history, if it was recorded, so far.
#[derive(Debug)]
pub(super) enum Ended {
    /// The whole response.
    Whole(Box<CaseResponse>, History),
    /// Left to equal steps, which serve as well.
    Midway(Box<Midway>, History),
}

/// A case whose samples are at ends of base steps, of which a whole number is an equal step.
#[derive(Debug)]
pub(super) struct SampledCase {
    /// The case in equal steps that are at most as long as were asked for.
    pub(super) case: TransientCase,
    control: StepControl,
    /// Base steps from sample to sample.
    parts: usize,
    samples: usize,
}

/// Share of the longest equal steps that is long enough, so that the sampling interval is not divided further.
const LONG_ENOUGH: f64 = 0.8;

impl SampledCase {
    pub(super) fn new(case: &TransientCase, sampling: &Sampling) -> Result<Self, DynamicsError> {
        let asked = StepControl::of(case)?;
        let (interval, samples, most) = (sampling.interval(), sampling.samples(), 1.0 + 1e-9);
        let stride = |parts: usize| most * asked.base / (interval / parts as f64);
        let fewest = (1.0 / stride(1)).ceil() as usize;
        // From four base steps in an equal step on, all are long enough.
        let is_long = |parts: &usize| stride(*parts).floor() >= LONG_ENOUGH * stride(*parts);
        let parts = (fewest..=4 * fewest).find(is_long).unwrap_or(fewest);
        let (base, stride) = (interval / parts as f64, stride(parts) as usize);
        let steps = (samples * parts).next_multiple_of(stride);
        let control = StepControl { base, steps, stride, ..asked };
        let (step, duration) = (Some(control.equal_step()), steps as f64 * base);
        let case = TransientCase { duration, step, ..case.clone() };
        Ok(Self { case, control, parts, samples })
    }
}

/// The response to a case at steps of its own, through the filter of `decimation`, or the case midway where
/// that is enough.
pub(super) fn respond(
    case: &TransientCase,
    decimation: &Arc<Decimation>,
    set: InstructionSet,
    may_end_midway: bool,
    stop: &AtomicBool,
) -> Result<Ended, DynamicsError> {
    let recording = Recording { kept: Kept::Filtered(decimation), may_end_midway };
    recording.run(case, StepControl::of(case)?, (set, stop))
}

/// The response to a case at steps of its own with its history, or the case midway where that is enough.
pub(super) fn transient(
    sampled: &SampledCase,
    set: InstructionSet,
    may_end_midway: bool,
    stop: &AtomicBool,
) -> Result<Ended, DynamicsError> {
    let kept = Kept::Every { parts: sampled.parts, samples: sampled.samples };
    let recording = Recording { kept, may_end_midway };
    recording.run(&sampled.case, sampled.control, (set, stop))
}

/// Record of the motion.
#[derive(Debug, Clone, Copy)]
struct Recording<'a> {
    kept: Kept<'a>,
    may_end_midway: bool,
}

#[derive(Debug, Clone, Copy)]
enum Kept<'a> {
    /// The displacement of one sensor, filtered and decimated.
    Filtered(&'a Arc<Decimation>),
    /// Samples of all sensors and contacts at every so many base steps.
    Every { parts: usize, samples: usize },
}

impl Recording<'_> {
    fn run(
        self,
        case: &TransientCase,
        control: StepControl,
        on: (InstructionSet, &AtomicBool),
    ) -> Result<Ended, DynamicsError> {
        match case.model.rows() {
            1 => self.of::<1>(case, control, on),
            2 => self.of::<2>(case, control, on),
            3 => self.of::<3>(case, control, on),
            4 => self.of::<4>(case, control, on),
            _ => self.of::<MOST_INTERFACES>(case, control, on),
        }
    }

    fn of<const N: usize>(
        self,
        case: &TransientCase,
        control: StepControl,
        (set, stop): (InstructionSet, &AtomicBool),
    ) -> Result<Ended, DynamicsError> {
        let exponents = first_table_exponents(case);
        let mut run: Integration<'_, N> =
            Integration::new(&case.model, &case.load, &exponents, control)?;
        let (mut readings, mut history) = (vec![0.0], History::default());
        let none = Decimation::none();
        let mut watch = self.may_end_midway.then(|| Watch::new(case, control)).flatten();
        let decimation = match self.kept {
            Kept::Filtered(decimation) => decimation,
            Kept::Every { samples, .. } => {
                let (sensors, contacts) = (case.model.sensors(), case.model.contacts().len());
                history = History::with_capacity(samples, sensors, contacts);
                run.record(&mut history, 0.0);
                &none
            }
        };
        let mut midway = false;
        let record = |run: &mut Integration<'_, N>, done: usize| {
            match self.kept {
                Kept::Every { parts, samples }
                    if done.is_multiple_of(parts) && done / parts < samples =>
                {
                    run.record(&mut history, done as f64 * control.base);
                }
                _ => {}
            }
            if done.is_multiple_of(control.stride) {
                readings.push(run.displacement(case.sensor));
                midway = watch.as_mut().is_some_and(|watch| watch.ends_at(run, done));
            }
            if midway { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let arch = set.arch().ok_or(DynamicsError::InstructionSet { set })?;
        arch.dispatch(Steps(&mut run, record, stop))?;
        if let (true, Some(watch)) = (midway, watch) {
            return Ok(Ended::Midway(Box::new(watch.midway(&run, readings)), history));
        }
        // The state at the very end is beyond the samples.
        readings.truncate(control.steps / control.stride);
        let energy = run.ledger();
        balanced(energy.residual_relative(), run.shortest, "step")?;
        let response = CaseResponse {
            step: control.equal_step(),
            steps: control.steps / control.stride,
            integrated_steps: run.taken,
            modes: case.model.row_modes().modes.len(),
            displacement: decimation.filtered(&readings),
            ending: readings.split_off(decimation.ending_from(readings.len())),
            decimation: Arc::clone(decimation),
            contacts: run.contact_extremes(),
            energy,
            is_of_second_order: false,
            table_exponents: exponents,
            table_tolerance: control.table_tolerance(),
        };
        Ok(Ended::Whole(Box::new(response), history))
    }
}

/// All steps of a run, and what sees the state at the end of each base step.
struct Steps<'r, 'a, R, const N: usize>(&'r mut Integration<'a, N>, R, &'r AtomicBool);

impl<R: FnMut(&mut Integration<'_, N>, usize) -> ControlFlow<()>, const N: usize> WithSimd
    for Steps<'_, '_, R, N>
{
    type Output = Result<(), DynamicsError>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.0.run(simd, self.1, self.2)
    }
}

/// The cubic through values and slopes at 0 and 1, at `s`.
#[inline(always)]
pub(super) fn hermite([a, da, b, db]: [f64; 4], s: f64) -> f64 {
    let rise = b - a;
    a + s * (da + s * ((3.0 * rise - 2.0 * da - db) + s * (da + db - 2.0 * rise)))
}

/// Its slope.
#[inline(always)]
pub(super) fn hermite_slope([a, da, b, db]: [f64; 4], s: f64) -> f64 {
    let rise = b - a;
    da + s * (2.0 * (3.0 * rise - 2.0 * da - db) + 3.0 * s * (da + db - 2.0 * rise))
}
