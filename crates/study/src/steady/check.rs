//! A response by time integration, as a check of a branch.

use std::f64::consts::TAU;

use asperity_dynamics::{DynamicsError, Excitation, FiniteDifference, Integrator, Sampling};
use asperity_harmonic::{Branch, PeriodicResponse, SpecialPointKind};
use serde::Serialize;

use crate::assemble::Assembly;

/// Samples of the last period.
const SAMPLES: usize = 64;

/// Transients are integrated until they have fallen to this.
const REMAINS: f64 = 1e-6;

/// Periods at most, for lightly damped rigs.
const MOST_PERIODS: f64 = 2000.0;

/// Relative distance in frequency of a checked response from a fold: next to one transients
/// hardly decay.
const AWAY: f64 = 0.01;

/// Halvings of the cell at most until the step is shorter: small bodies have a fewest number of
/// cells.
const HALVINGS: usize = 4;

/// A fundamental from rest by finite differences, beside that of the branch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TimeCheck {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude of the fundamental of the top, of the branch \[m\].
    pub amplitude_1_m: f64,
    /// The same by time integration, extrapolated from two steps to zero \[m\].
    pub integrated_1_m: f64,
    /// Difference over the integrated amplitude.
    pub relative_difference: f64,
}

impl TimeCheck {
    /// The highest stable response at a frequency that the branch meets only once, its peak unless
    /// it leans over. Elsewhere integration from rest may settle on
    /// another response.
    pub(super) fn place(branch: &Branch) -> Option<&PeriodicResponse> {
        let frequencies: Vec<f64> =
            branch.points.iter().map(PeriodicResponse::frequency_hz).collect();
        let crossings = |f: f64| {
            frequencies.windows(2).filter(|pair| (pair[0] - f) * (pair[1] - f) < 0.0).count()
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
        let (coarse, long) = fundamental(assembly, response, method)?;
        let (mut fine, mut short) = (coarse, long);
        let mut finer = cell;
        for _ in 0..HALVINGS {
            if short < 0.75 * long {
                break;
            }
            finer *= 0.5;
            (fine, short) =
                fundamental(assembly, response, FiniteDifference { cell: finer, ..method })?;
        }
        let amplitude_1_m = response.amplitude(1);
        let integrated_1_m = fine + (fine - coarse) * short / (long - short);
        Ok(Self {
            frequency_hz: response.frequency_hz(),
            amplitude_1_m,
            integrated_1_m,
            relative_difference: (amplitude_1_m / integrated_1_m - 1.0).abs(),
        })
    }
}

fn fundamental(
    assembly: &Assembly,
    response: &PeriodicResponse,
    method: FiniteDifference,
) -> Result<(f64, f64), DynamicsError> {
    let frequency = response.frequency_hz();
    let decay = 0.5 * assembly.structure.damping_rate() / frequency;
    let periods = (-REMAINS.ln() / decay).clamp(20.0, MOST_PERIODS).ceil();
    let sampling = Sampling::new(periods / frequency, SAMPLES as f64 * frequency)?;
    let shaker = Excitation::Harmonic { amplitude: response.force, frequency };
    let done = method.integrate(&assembly.structure, &shaker, &sampling)?;
    let displacement = &done.history.displacement;
    let last = &displacement[displacement.len().saturating_sub(SAMPLES)..];
    let angle = |n: usize| TAU * n as f64 / SAMPLES as f64;
    let cos: f64 = last.iter().enumerate().map(|(n, u)| u * angle(n).cos()).sum();
    let sin: f64 = last.iter().enumerate().map(|(n, u)| u * angle(n).sin()).sum();
    Ok((2.0 / SAMPLES as f64 * cos.hypot(sin), done.step))
}
