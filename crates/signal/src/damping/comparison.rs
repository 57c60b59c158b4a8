//! Damping of one mode by three methods.

use super::circle::{CircleFit, circle_within};
use super::half_power_crossings;
use crate::decrement::logarithmic_decrement;
use crate::peak::Peak;
use crate::response::FrequencyResponse;

/// Damping ratios of one mode by three methods with different errors.
///
/// A record that ends too early, a second mode, and a frequency that varies
/// with amplitude widen a peak but do not change the decay rate. The methods agree
/// for a linear, isolated mode.
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
    /// The damping ratios of a peak and of the free decay of the same mode.
    ///
    /// - `decay`: without force and without other modes (see
    ///   [`BandPass`](crate::BandPass)), at the sample rate of the response.
    pub fn of(response: &FrequencyResponse, peak: &Peak, decay: &[f64]) -> Self {
        Self::and_circle(response, peak, decay).0
    }

    /// [`DampingComparison::of`] and the circle fit.
    pub(crate) fn and_circle(
        response: &FrequencyResponse,
        peak: &Peak,
        decay: &[f64],
    ) -> (Self, Option<CircleFit>) {
        let rate = response.sample_rate_hz();
        let decrement = logarithmic_decrement(decay, rate, peak.frequency_hz);
        let width = half_power_crossings(response, peak);
        let circle = width.and_then(|width| circle_within(response, &width));
        let found = Self {
            half_power: width.map(|width| width.ratio()),
            circle: circle.map(|circle| circle.ratio),
            decrement: decrement.map(|decrement| decrement.ratio),
        };
        (found, circle)
    }

    /// The ratios that were found, in the order of the fields.
    pub fn ratios(&self) -> impl Iterator<Item = f64> {
        [self.half_power, self.circle, self.decrement].into_iter().flatten()
    }

    /// Mean of the ratios; `None` if there is none.
    pub fn mean(&self) -> Option<f64> {
        let count = self.ratios().count();
        (count > 0).then(|| self.ratios().sum::<f64>() / count as f64)
    }

    /// Largest less smallest ratio, over the mean; `None` for fewer than two.
    pub fn spread(&self) -> Option<f64> {
        let mean = self.mean().filter(|_| self.ratios().count() >= 2)?;
        let largest = self.ratios().fold(f64::NEG_INFINITY, f64::max);
        let smallest = self.ratios().fold(f64::INFINITY, f64::min);
        Some((largest - smallest) / mean)
    }
}
