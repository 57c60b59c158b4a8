//! One point of a free decay.

use super::harmonics::DecayHarmonic;
use crate::ring_down::{BackbonePoint, BackboneUncertainty};
use std::ops::RangeInclusive;

/// One point of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayPoint {
    /// Time, amplitude, frequency and damping.
    pub point: BackbonePoint,
    /// Their standard deviations due to noise.
    pub uncertainty: BackboneUncertainty,
    /// Amplitudes of the second and the third harmonic over the fundamental's; `None` where
    /// they are noise.
    pub harmonics: [Option<DecayHarmonic>; 2],
}

/// Samples of the lines of some points.
pub(super) fn span_of(
    points: &[DecayPoint],
    half: usize,
    rate: f64,
) -> Option<RangeInclusive<usize>> {
    let place = |one: &DecayPoint| (one.point.time_s * rate).round() as usize;
    Some(place(points.first()?) - half..=place(points.last()?) + half)
}
