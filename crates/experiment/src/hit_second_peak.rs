//! The peak near twice the fundamental of one hit.

use asperity_signal::{HitFeatures, PeakOrigin};
use serde::Serialize;

/// Peak near twice the fundamental of one hit, before it is known what it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitSecondPeak {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A2 \[m/N\].
    pub magnitude: f64,
    /// Ratio of receptances A2/A1.
    pub ratio: f64,
    /// Standard deviation of the frequency due to noise \[Hz\].
    pub frequency_uncertainty_hz: Option<f64>,
    /// Standard deviation of the receptance due to noise \[m/N\].
    pub magnitude_uncertainty: Option<f64>,
    /// Standard deviation of the ratio due to noise.
    pub ratio_uncertainty: Option<f64>,
    /// Drift of its phase, less twice that of the fundamental, over the decay \[rad\]; `None` where
    /// the decay is noise.
    pub phase_drift_rad: Option<f64>,
    /// Exponent `d ln a2 / d ln a1` of its amplitude along the decay.
    pub amplitude_exponent: Option<f64>,
    /// Length of that decay in cycles of the fundamental.
    pub decay_cycles: Option<f64>,
    /// Origin told by the decay of this hit: `harmonic` or `mode`.
    pub decay_origin: Option<&'static str>,
}

impl HitSecondPeak {
    /// The second peak of the features of a hit; `None` without one.
    pub(crate) fn of(found: &HitFeatures) -> Option<Self> {
        let peak = found.harmonics.second?;
        let (sigma, test) = (found.second_uncertainty, found.harmonic_test);
        Some(Self {
            frequency_hz: peak.frequency_hz,
            magnitude: peak.magnitude,
            ratio: found.harmonics.ratio()?,
            frequency_uncertainty_hz: sigma.map(|sigma| sigma.frequency_hz),
            magnitude_uncertainty: sigma.map(|sigma| sigma.magnitude),
            ratio_uncertainty: found.ratio_uncertainty,
            phase_drift_rad: test.map(|test| test.phase_drift),
            amplitude_exponent: test.map(|test| test.exponent),
            decay_cycles: test.map(|test| test.cycles),
            decay_origin: test.and_then(|test| test.origin()).map(name),
        })
    }
}

/// Name of an origin in a document.
pub(crate) fn name(origin: PeakOrigin) -> &'static str {
    match origin {
        PeakOrigin::Harmonic => "harmonic",
        _ => "mode",
    }
}
