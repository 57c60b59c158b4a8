//! The same damping by three methods.

use super::circle::circle_within;
use super::crossings_of;
use crate::decrement::logarithmic_decrement;
use crate::peak::Peak;
use crate::response::{Exact, FrequencyResponse};

/// Damping ratios of one mode by methods that fail differently.
///
/// A record that ends too early, a second mode, and a frequency that moves
/// with amplitude widen a peak, but do not speed up a decay. Where the methods
/// agree the mode is linear and alone; where they do not, their spread says so.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DampingComparison {
    /// From the half-power width, [`half_power`](crate::half_power).
    pub half_power: Option<f64>,
    /// From the circle, [`circle_fit`](crate::circle_fit).
    pub circle: Option<f64>,
    /// From the decay, [`logarithmic_decrement`].
    pub decrement: Option<f64>,
}

impl DampingComparison {
    /// All three, from a peak and from the free decay of the same mode.
    ///
    /// - `decay`: no force acts on it and no other mode is in it (see
    ///   [`BandPass`](crate::BandPass)); sampled as the response.
    pub fn of(response: &FrequencyResponse, peak: &Peak, decay: &[f64]) -> Self {
        Self::of_exact(response, peak, decay)
    }

    /// The same of whatever gives the spectra of a hit.
    pub(crate) fn of_exact(hit: &impl Exact, peak: &Peak, decay: &[f64]) -> Self {
        let rate = hit.response().sample_rate_hz();
        let decrement = logarithmic_decrement(decay, rate, peak.frequency_hz);
        let width = crossings_of(hit, peak);
        let circle = width.and_then(|width| circle_within(hit, &width));
        Self {
            half_power: width.map(|width| width.ratio()),
            circle: circle.map(|circle| circle.ratio),
            decrement: decrement.map(|decrement| decrement.ratio),
        }
    }

    /// The ratios there are, in the order of the fields.
    pub fn ratios(&self) -> impl Iterator<Item = f64> {
        [self.half_power, self.circle, self.decrement].into_iter().flatten()
    }

    /// Their mean; `None` if there is none.
    pub fn mean(&self) -> Option<f64> {
        let count = self.ratios().count();
        (count > 0).then(|| self.ratios().sum::<f64>() / count as f64)
    }

    /// Largest less smallest, over the mean; `None` for fewer than two.
    pub fn spread(&self) -> Option<f64> {
        let mean = self.mean().filter(|_| self.ratios().count() >= 2)?;
        let largest = self.ratios().fold(f64::NEG_INFINITY, f64::max);
        let smallest = self.ratios().fold(f64::INFINITY, f64::min);
        Some((largest - smallest) / mean)
    }
}
