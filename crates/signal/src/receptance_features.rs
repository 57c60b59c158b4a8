//! Fundamental, second harmonic and damping in the receptance of one hit.

use crate::damping::{HalfPower, half_power_crossings};
use crate::envelope_decrement::envelope_decrement;
use crate::harmonics::{HarmonicOptions, Harmonics, find_harmonics};
use crate::response::FrequencyResponse;
use std::ops::Range;

/// Fundamental, second harmonic and damping of one hit.
///
/// Every response of the workspace is read by this definition: [`of`](Self::of) for samples of any
/// origin, [`SharedForce::analyse`](crate::SharedForce::analyse) for many hits under one force. The
/// analysis of measured hits ([`HitFeatures`](crate::HitFeatures)) searches with the same
/// [`find_harmonics`] and the same windows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReceptanceFeatures {
    /// Fundamental `(f1, A1)` and second harmonic `(f2, A2)`.
    pub harmonics: Harmonics,
    /// Half-power crossings of the fundamental; none where a side does not fall to half power.
    pub half_power: Option<HalfPower>,
    /// Damping ratio by the logarithmic decrement of the decay's envelope; none without a long enough decay.
    pub damping_ratio_decrement: Option<f64>,
    /// Standard deviation of the last cycle of the decay, or of its last twentieth if that is longer, over the largest distance
    /// of the decay from its mean there: the part that remains where it ends. None without a decay of a cycle.
    ///
    /// The end of a record widens a peak: of a mode of which 0.01 remains the half-power damping ratio is 4 % too large, of 0.02
    /// 10 %, of 0.1 60 %.
    pub remaining: Option<f64>,
}

impl ReceptanceFeatures {
    /// The features of a `response` with its fundamental near `reference_hz`, as [`find_harmonics`]
    /// and [`half_power_crossings`] find them; without a decrement.
    ///
    /// ```
    /// use asperity_signal::{FrequencyResponse, HarmonicOptions, ReceptanceFeatures};
    ///
    /// // Impulse response of a 1 kg oscillator at 200 Hz with 2 % of critical damping.
    /// let (rate, omega, zeta) = (2e4, std::f64::consts::TAU * 200.0, 0.02_f64);
    /// let damped = omega * (1.0 - zeta * zeta).sqrt();
    /// let displacement: Vec<f64> = (0..20_000)
    ///     .map(|n| f64::from(n) / rate)
    ///     .map(|t| (-zeta * omega * t).exp() * (damped * t).sin() / damped)
    ///     .collect();
    /// let mut force = vec![0.0; displacement.len()];
    /// force[0] = rate;
    /// let response = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
    /// let features = ReceptanceFeatures::of(&response, 190.0, &HarmonicOptions::default())
    ///     .with_decay(&displacement, 1.0..19_999.0, rate);
    /// for ratio in [features.damping_ratio(), features.damping_ratio_decrement] {
    ///     assert!((ratio.ok_or("a mode has damping")? - zeta).abs() < 1e-5);
    /// }
    /// assert!(features.harmonics.second.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(response: &FrequencyResponse, reference_hz: f64, options: &HarmonicOptions) -> Self {
        let harmonics = find_harmonics(response, reference_hz, options);
        let half_power =
            harmonics.fundamental.and_then(|peak| half_power_crossings(response, &peak));
        Self { harmonics, half_power, ..Self::default() }
    }

    /// These features with the decrement of a `decay` at `sample_rate_hz`, and the part of it that [remains](Self::remaining).
    /// Its motion is free and known in a `range`, in samples; see [`envelope_decrement`].
    ///
    /// The last cycle is left out, so that the ratio does not depend on whether a filter has run out at the end.
    #[must_use]
    pub fn with_decay(self, decay: &[f64], range: Range<f64>, sample_rate_hz: f64) -> Self {
        let fundamental = self.harmonics.fundamental;
        let remaining = fundamental.and_then(|peak| {
            // The casts saturate.
            let known = range.start.ceil() as usize..decay.len().min(range.end as usize + 1);
            remaining_of(decay.get(known)?, sample_rate_hz / peak.frequency_hz)
        });
        let damping_ratio_decrement = fundamental.and_then(|peak| {
            let frequency_hz = peak.frequency_hz;
            let range = range.start..range.end - sample_rate_hz / frequency_hz;
            envelope_decrement(decay, range, sample_rate_hz, frequency_hz)
        });
        Self { damping_ratio_decrement, remaining, ..self }
    }

    /// Damping ratio of the fundamental from its half-power width, [`HalfPower::ratio`].
    pub fn damping_ratio(&self) -> Option<f64> {
        self.half_power.map(|crossings| crossings.ratio())
    }
}

/// Part of a decay of `per_cycle` samples a cycle that remains at its end, see [`ReceptanceFeatures::remaining`].
fn remaining_of(decay: &[f64], per_cycle: f64) -> Option<f64> {
    let count = (decay.len() / 20).max(per_cycle.ceil() as usize);
    let tail = decay.get(decay.len().checked_sub(count)?..).filter(|tail| !tail.is_empty())?;
    let mean = tail.iter().sum::<f64>() / count as f64;
    let variance = tail.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / count as f64;
    let largest = decay.iter().map(|sample| (sample - mean).abs()).fold(0.0, f64::max);
    let remaining = variance.sqrt() / largest;
    remaining.is_finite().then_some(remaining)
}
