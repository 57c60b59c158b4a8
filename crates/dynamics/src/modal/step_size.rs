//! The choice of the step.

use std::f64::consts::TAU;

use super::law_tables::tolerance_at_equal_steps;
use super::step_model::longest_step;
use super::transient_case::TransientCase;
use crate::DynamicsError;
use crate::error::positive;
use crate::run_bounds::check_recorded_steps;

/// Most radians of the lowest natural frequency in a step that was given, beyond which the motion
/// is not resolved.
const MOST_RADIANS: f64 = 1.0;

/// Steps in the time in which the load changes.
const STEPS_A_PULSE: f64 = 16.0;

/// Multiples of a power of ten that steps are rounded down to.
const ROUND: [f64; 10] = [8.0, 6.4, 5.0, 4.0, 3.2, 2.5, 2.0, 1.6, 1.25, 1.0];

/// Energy residual above which a step that was chosen is halved.
pub const COARSE_RESIDUAL: f64 = 5e-4;

/// Halvings of it at most.
pub(super) const MOST_HALVINGS: u32 = 7;

/// Parts of the longest of a case's own steps in which it is differentiated.
const EQUAL_PARTS: f64 = 16.0;

impl TransientCase {
    /// The case at equal steps, short ones for a case at steps of its own.
    pub(super) fn at_equal_steps(&self) -> Result<Self, DynamicsError> {
        let mut case = self.clone();
        if case.tolerance.take().is_some() {
            case.step = Some(self.first_step()?.0 / EQUAL_PARTS);
        }
        Ok(case)
    }

    /// Step \[s\] that the case is first tried with, and the number of steps.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for a step or duration that is not positive and finite,
    /// [`DynamicsError::TooLarge`] for more steps than can be recorded.
    pub fn first_step(&self) -> Result<(f64, usize), DynamicsError> {
        Resolution::first(self).map(|resolution| (resolution.step, resolution.steps))
    }

    /// Error of the tables at equal steps of `step` \[s\], as a share of the static pressures.
    ///
    /// # Errors
    /// As [`first_step`](Self::first_step).
    pub(super) fn table_tolerance(&self, step: f64) -> Result<f64, DynamicsError> {
        Ok(tolerance_at_equal_steps(Resolution::chosen(self)?.step / step))
    }
}

/// A step and the number of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Resolution {
    /// Step \[s\].
    pub(super) step: f64,
    pub(super) steps: usize,
}

impl Resolution {
    /// The step that a case is first tried with: as given, or so that the lowest natural
    /// frequency and the load are resolved. A chosen step divides the duration.
    fn first(case: &TransientCase) -> Result<Self, DynamicsError> {
        let Some(step) = case.step else {
            let Self { step, steps } = Self::chosen(case)?;
            return Self::of(case, step, steps as f64);
        };
        let duration = positive("duration [s]", case.duration)?;
        let step = positive("step [s]", step)?;
        let value = TAU * step * case.model.preloaded().natural_frequency().unwrap_or(0.0);
        if value > MOST_RADIANS {
            let quantity = "step [s] times lowest natural frequency [rad/s]";
            return Err(DynamicsError::Setting { quantity, value, accepted: "at most 1" });
        }
        Self::of(case, step, (duration / step - 1e-9).ceil().max(1.0))
    }

    /// The longest step that is chosen for a case, also where one is given.
    fn chosen(case: &TransientCase) -> Result<Self, DynamicsError> {
        let duration = positive("duration [s]", case.duration)?;
        let natural = case.model.preloaded().natural_frequency();
        let slow = natural.map_or(f64::INFINITY, longest_step);
        let step = slow.min(case.load.time_scale() / STEPS_A_PULSE).min(duration / 64.0);
        // Round down, ten steps a decade, so that cases of like structures share a step.
        let decade = 10.0_f64.powf(step.log10().floor());
        let round = ROUND.into_iter().find(|m| m * decade <= step * (1.0 + 1e-9));
        let step = round.unwrap_or(1.0) * decade;
        let steps = (duration / step - 1e-9).ceil();
        Ok(Self { step: duration / steps, steps: steps as usize })
    }

    /// The step of [`first`](Self::first), halved.
    pub(super) fn halved(case: &TransientCase, halvings: u32) -> Result<Self, DynamicsError> {
        let Self { step, steps } = Self::first(case)?;
        let parts = f64::from(halvings).exp2();
        Self::of(case, step / parts, steps as f64 * parts)
    }

    fn of(case: &TransientCase, step: f64, steps: f64) -> Result<Self, DynamicsError> {
        check_recorded_steps(steps, case.model.contacts().len(), step)?;
        Ok(Self { step, steps: steps as usize })
    }

    /// True if an energy residual is too large for a chosen step.
    pub(super) fn too_coarse(residual: f64) -> bool {
        // A residual that is not a number is not a small one.
        residual.is_nan() || residual > COARSE_RESIDUAL
    }
}
