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
//! | [`midway`] | the case as equal steps take it on |
//! | [`contact_solve`] | closures and tractions at the end of a step |
//! | [`measures`] | extremes, times without contact, mean stiffness and energies |
#![allow(
    clippy::needless_range_loop,
    reason = "rows and columns of small square matrices by index"
)]

mod contact_solve;
mod integration;
mod measures;
mod midway;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use pulp::{Arch, NullaryFnOnce};

use super::assembly::MOST_INTERFACES;
use super::decimation::Decimation;
use super::transient_case::{CaseResponse, TransientCase, first_table_exponents};
use crate::error::{balanced, positive};
use crate::{DynamicsError, History, InstructionSet, Sampling, Transient};
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
        Ok(Self { base, steps, tolerance })
    }
}

/// End of a case at steps of its own.
#[derive(Debug)]
pub(super) enum Ended {
    /// The whole response, with its history if it was recorded.
    Whole(Box<CaseResponse>, History),
    /// Left to equal steps, which serve as well.
    Midway(Box<Midway>),
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
    let recording = Recording::Filtered { decimation, may_end_midway };
    recording.run(case, StepControl::of(case)?, (set, stop))
}

/// The whole response to a case at steps of its own, whose samples are at ends of base steps.
pub(super) fn transient(
    case: &TransientCase,
    sampling: &Sampling,
    set: InstructionSet,
    stop: &AtomicBool,
) -> Result<Transient, DynamicsError> {
    let longest = StepControl::of(case)?;
    let parts = (sampling.interval() / longest.base * (1.0 - 1e-9)).ceil().max(1.0) as usize;
    let control = StepControl {
        base: sampling.interval() / parts as f64,
        steps: sampling.samples() * parts,
        ..longest
    };
    match Recording::Every(parts).run(case, control, (set, stop))? {
        Ended::Whole(response, history) => {
            let CaseResponse { step, integrated_steps: steps, contacts, energy, .. } = *response;
            Ok(Transient { step, steps, history, contacts, energy })
        }
        // Not asked for.
        Ended::Midway(_) => Err(DynamicsError::InstructionSet { set }),
    }
}

/// Record of the motion.
#[derive(Debug, Clone, Copy)]
enum Recording<'a> {
    /// The displacement of one sensor, filtered and decimated.
    Filtered { decimation: &'a Arc<Decimation>, may_end_midway: bool },
    /// All sensors and contacts at every so many base steps.
    Every(usize),
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
        let none = Arc::new(Decimation { factor: 1, taps: Arc::new([]) });
        let mut watch = None;
        let decimation = match self {
            Self::Filtered { decimation, may_end_midway } => {
                watch = may_end_midway.then(|| Watch::new(case, control)).flatten();
                decimation
            }
            Self::Every(_) => {
                let (sensors, contacts) = (case.model.sensors(), case.model.contacts().len());
                history = History::with_capacity(control.steps + 1, sensors, contacts);
                run.record(&mut history, 0.0);
                &none
            }
        };
        let mut midway = false;
        let record = |run: &mut Integration<'_, N>, done: usize| {
            match self {
                Self::Filtered { .. } => readings.push(run.displacement(case.sensor)),
                Self::Every(parts) if done.is_multiple_of(parts) && done < control.steps => {
                    run.record(&mut history, done as f64 * control.base);
                }
                Self::Every(_) => {}
            }
            midway = watch.as_mut().is_some_and(|watch| watch.ends_at(run, done));
            if midway { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        on(set, Steps(&mut run, record, stop))??;
        if let (true, Some(watch)) = (midway, watch) {
            return Ok(Ended::Midway(Box::new(watch.midway(&run, readings))));
        }
        // The state at the very end is beyond the samples.
        readings.truncate(control.steps);
        let energy = run.ledger();
        balanced(energy.residual_relative(), run.shortest, "step")?;
        let response = CaseResponse {
            step: control.base,
            steps: control.steps,
            integrated_steps: run.taken,
            modes: case.model.row_modes().modes.len(),
            displacement: decimation.filtered(&readings),
            decimation: Arc::clone(decimation),
            contacts: run.contact_extremes(),
            energy,
            is_of_second_order: false,
            table_exponents: exponents,
        };
        Ok(Ended::Whole(Box::new(response), history))
    }
}

/// All steps of a run, and what sees the state at the end of each base step.
struct Steps<'r, 'a, R, const N: usize>(&'r mut Integration<'a, N>, R, &'r AtomicBool);

impl<R: FnMut(&mut Integration<'_, N>, usize) -> ControlFlow<()>, const N: usize> NullaryFnOnce
    for Steps<'_, '_, R, N>
{
    type Output = Result<(), DynamicsError>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.0.run(self.1, self.2)
    }
}

/// The outcome of `task`, compiled for the instructions of `set`.
fn on<F: NullaryFnOnce>(set: InstructionSet, task: F) -> Result<F::Output, DynamicsError> {
    match set.arch() {
        Some(Arch::Scalar) => Ok(task.call()),
        #[cfg(target_arch = "x86_64")]
        Some(Arch::V3(simd)) => Ok(simd.vectorize(task)),
        #[cfg(target_arch = "x86_64")]
        Some(Arch::V4(simd)) => Ok(simd.vectorize(task)),
        #[cfg(target_arch = "aarch64")]
        Some(Arch::Neon(simd)) => Ok(simd.vectorize(task)),
        _ => Err(DynamicsError::InstructionSet { set }),
    }
}

/// The cubic through values and slopes at 0 and 1, at `s`.
#[inline(always)]
fn hermite([a, da, b, db]: [f64; 4], s: f64) -> f64 {
    let rise = b - a;
    a + s * (da + s * ((3.0 * rise - 2.0 * da - db) + s * (da + db - 2.0 * rise)))
}

/// Its slope.
#[inline(always)]
fn hermite_slope([a, da, b, db]: [f64; 4], s: f64) -> f64 {
    let rise = b - a;
    da + s * (2.0 * (3.0 * rise - 2.0 * da - db) + 3.0 * s * (da + db - 2.0 * rise))
}
