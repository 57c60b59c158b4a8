//! A response by time integration, as a check of a branch.

use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator};
use asperity_harmonic::{Branch, PeriodicResponse, SpecialPointKind};
use serde::Serialize;

use super::settled::{SettledAmplitude, SteadyMotion};
use crate::assemble::Assembly;
use crate::warning::Warning;

/// Relative distance in frequency of a checked response from a fold: next to one transients
/// hardly decay.
const AWAY: f64 = 0.01;

/// Halvings of the cell at most until the step is shorter: small bodies have a fewest number of
/// cells.
const HALVINGS: usize = 4;

/// A fundamental by time integration, beside that of the branch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeCheck {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude of the fundamental of the first sensor, of the branch \[m\].
    pub amplitude_1_m: f64,
    /// The same by time integration \[m\]: from rest by finite differences, extrapolated from two steps to zero where
    /// the motion is periodic, else the mean over many periods at the shorter step; from the state of the response by
    /// modal steps, the mean over many periods.
    pub integrated_1_m: f64,
    /// Difference over the integrated amplitude.
    pub relative_difference: f64,
    /// True if the integrated motion is periodic; the difference of one that still changes shows nothing.
    pub settled: bool,
    /// The integrated motion.
    pub motion: SteadyMotion,
    /// Largest relative distance of the fundamental of a period from the mean over many.
    pub scatter: f64,
}

/// Difference of a fundamental above which there is a warning, beside twice the scatter of a motion that
/// is not periodic.
const AGREES: f64 = 0.01;

/// Difference and scatter of the fundamental up to which a motion that begins in a response stays there.
const KEPT: f64 = 0.005;

impl TimeCheck {
    /// The warning about a branch that differs from the integration; none while the motion still changes. Where the response
    /// `is_kept` by integration from its own state, the other motion exists beside it.
    pub(super) fn warning(&self, is_kept: impl FnOnce() -> bool) -> Option<Warning> {
        let Self { frequency_hz, relative_difference, .. } = *self;
        let allowed = match self.motion {
            SteadyMotion::Periodic => AGREES,
            SteadyMotion::NotSettled => return None,
            _ => AGREES + 2.0 * self.scatter,
        };
        // A difference that is no number is no agreement.
        let agrees = relative_difference <= allowed;
        (!agrees).then(|| {
            if is_kept() {
                Warning::AnotherMotion { frequency_hz, relative_difference }
            } else {
                Warning::IntegrationDiffers { frequency_hz, relative_difference }
            }
        })
    }

    /// The warning about a response that time integration from its own state leaves; none while the motion still
    /// changes.
    pub(super) fn not_kept(&self) -> Option<Warning> {
        let Self { frequency_hz, relative_difference, scatter, .. } = *self;
        let left = self.motion != SteadyMotion::NotSettled && !self.is_kept();
        left.then_some(Warning::NotKept { frequency_hz, relative_difference, scatter })
    }

    /// True if time integration from the state of a response stays there.
    pub(super) fn is_kept(&self) -> bool {
        let settled = !matches!(self.motion, SteadyMotion::NotSettled | SteadyMotion::Apart);
        settled && self.relative_difference.max(self.scatter) <= KEPT
    }

    /// The highest stable response at a frequency that the branch, with its other part, meets only once, its peak
    /// unless it leans over. Elsewhere integration from rest may settle on
    /// another response.
    pub(super) fn place<'a>(
        branch: &'a Branch,
        other_part: Option<&Branch>,
    ) -> Option<&'a PeriodicResponse> {
        let parts = [Some(branch), other_part].map(|part| -> Vec<f64> {
            let points = part.map_or(&[][..], |part| &part.points);
            points.iter().map(PeriodicResponse::frequency_hz).collect()
        });
        let crossings = |f: f64| {
            let pairs = parts.iter().flat_map(|frequencies| frequencies.windows(2));
            pairs.filter(|pair| (pair[0] - f) * (pair[1] - f) < 0.0).count()
        };
        // A located peak lies within a step, a point between two.
        let peaks = branch.of_kind(SpecialPointKind::Peak).map(|peak| (peak, 1));
        let all = peaks.chain(branch.points.iter().map(|point| (point, 0)));
        all.filter(|(response, own)| {
            let f = response.frequency_hz();
            let mut around = (-10..=10).map(|n| f * (1.0 + 0.1 * AWAY * f64::from(n)));
            let alone = crossings(f) == *own && around.all(|near| crossings(near) <= 1);
            response.stable() != Some(false) && alone
        })
        .map(|(response, _)| response)
        .max_by(|a, b| a.amplitude(1).total_cmp(&b.amplitude(1)))
    }

    /// Integrates the rig under the force and at the frequency of `response`, from rest, by
    /// finite differences in the scenario's cells, or of 1 mm, and in smaller ones. The scheme's
    /// error near resonance falls with the step.
    pub(super) fn of(
        assembly: &Assembly,
        response: &PeriodicResponse,
    ) -> Result<Self, DynamicsError> {
        let method = match assembly.method {
            Integrator::FiniteDifference(method) => method,
            Integrator::Modal(_) => FiniteDifference::default(),
        };
        let cell = method.cell;
        let settled = |method: FiniteDifference| {
            let (force, frequency) = (response.force, response.frequency_hz());
            SettledAmplitude::of(assembly, &method.into(), force, frequency)
        };
        let coarse = settled(method)?;
        let mut fine = coarse;
        let mut finer = cell;
        for _ in 0..HALVINGS {
            if fine.step_s < 0.75 * coarse.step_s {
                break;
            }
            finer *= 0.5;
            fine = settled(FiniteDifference { cell: finer, ..method })?;
        }
        Ok(Self::between(response, [coarse, fine], 1))
    }

    /// The check of a response by integrations with two steps, of which the second is shorter, by a method
    /// whose error falls with this power of the step.
    pub(crate) fn between(
        response: &PeriodicResponse,
        [coarse, fine]: [SettledAmplitude; 2],
        order: i32,
    ) -> Self {
        let amplitude_1_m = response.at_sensor(0, 1).norm();
        let all = [coarse.motion, fine.motion];
        let of = |motion| all.contains(&motion).then_some(motion);
        let unsettled = of(SteadyMotion::NonPeriodic)
            .or(of(SteadyMotion::Subharmonic))
            .or(of(SteadyMotion::NotSettled));
        let motion = unsettled.unwrap_or(SteadyMotion::Periodic);
        let error = |one: &SettledAmplitude| one.step_s.powi(order);
        let change = (fine.amplitude_1_m - coarse.amplitude_1_m) / (error(&coarse) - error(&fine));
        let correction = if unsettled.is_none() { change * error(&fine) } else { 0.0 };
        let integrated_1_m = fine.amplitude_1_m + correction;
        Self {
            frequency_hz: response.frequency_hz(),
            amplitude_1_m,
            integrated_1_m,
            relative_difference: (amplitude_1_m / integrated_1_m - 1.0).abs(),
            settled: unsettled.is_none(),
            motion,
            scatter: coarse.scatter.max(fine.scatter),
        }
    }
}
