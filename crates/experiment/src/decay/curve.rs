//! Backbone of one response in one decay.

use asperity_signal::DecayPoint;

/// Backbone of one response in one decay.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayCurve {
    /// Number through all curves, from 1.
    pub index: usize,
    /// Number of the decay, from 1.
    pub decay: usize,
    /// Number of the band, from 1.
    pub band: usize,
    /// Name of the response.
    pub response: String,
    /// Unit of the response; empty if it has none.
    pub unit: String,
    /// Metres over the unit of the response, times the square, the first or no power of the angular
    /// frequency; `None` for an unknown unit.
    pub(super) metres: Option<(f64, i32)>,
    /// Time of the first sample of the decay on the time axis of the record \[s\].
    pub start_s: f64,
    /// Points in the order of time, after `start_s`; none where the band holds several modes.
    pub points: Vec<DecayPoint>,
}

impl DecayCurve {
    /// Amplitude of a point as a displacement \[m\], by the derivatives of a harmonic motion; `None`
    /// for an unknown unit.
    pub fn amplitude_m(&self, point: &DecayPoint) -> Option<f64> {
        let (factor, derivatives) = self.metres?;
        let omega = std::f64::consts::TAU * point.point.frequency_hz;
        Some(point.point.amplitude * factor / omega.powi(derivatives))
    }
}
