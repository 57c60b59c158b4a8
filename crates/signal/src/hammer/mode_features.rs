//! Features of one mode of a hit.

use crate::damping::DampingComparison;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::window::ExponentialWindow;
use num_complex::Complex64;

/// Frequency, receptance and damping of the mode of a peak, corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ModeFeatures {
    /// Frequency of the peak, in hertz; `None` if the correction needs a damping ratio that was not
    /// found.
    pub frequency_hz: Option<f64>,
    /// Receptance at the peak, in m/N, likewise.
    pub magnitude: Option<f64>,
    /// Damping ratios.
    pub damping: DampingComparison,
    /// Undamped natural frequency of the circle fit, in hertz.
    pub natural_hz: Option<f64>,
    /// Modal constant of the circle fit, in 1/kg, which a window does not change.
    pub modal_constant: Option<Complex64>,
}

impl ModeFeatures {
    /// The features of a peak of a response under an exponential window, with the free decay of its
    /// mode as for [`DampingComparison::of`].
    pub fn of(
        response: &FrequencyResponse,
        peak: &Peak,
        decay: &[f64],
        window: Option<ExponentialWindow>,
    ) -> Self {
        let (mut damping, circle) = DampingComparison::and_circle(response, peak, decay);
        let (frequency, magnitude) = (peak.frequency_hz, peak.magnitude);
        let natural_hz = circle.map(|circle| circle.natural_hz);
        let modal_constant = circle.map(|circle| circle.modal_constant);
        let Some(window) = window else {
            return Self {
                frequency_hz: Some(frequency),
                magnitude: Some(magnitude),
                damping,
                natural_hz,
                modal_constant,
            };
        };
        let ratio = damping.circle.or(damping.half_power);
        let corrected = |ratio: f64| window.corrected_damping(frequency, ratio);
        damping.half_power = damping.half_power.map(corrected);
        damping.circle = damping.circle.map(corrected);
        Self {
            frequency_hz: ratio.map(|r| window.corrected_peak_frequency(frequency, r, frequency)),
            magnitude: ratio.map(|r| window.corrected_peak(frequency, r, magnitude)),
            damping,
            natural_hz: circle.map(|c| window.corrected_natural_frequency(c.natural_hz, c.ratio)),
            modal_constant,
        }
    }
}
