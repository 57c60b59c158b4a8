//! Windows for transients, and what they do to a frequency response function.

use crate::error::{Result, check_positive};
use crate::form::ResponseKind;
use crate::hit::{Offset, Pulse};
use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Keeps the blow and blanks the rest of the force record.
///
/// ```text
/// w = 1 in [begin, end], 0 beyond a cosine taper of `taper` on either side
/// ```
///
/// The force is zero unless the hammer touches, so what else is recorded is
/// noise. The offset goes first: windowed, it would become a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceWindow {
    /// Where the taper has risen to one, after the first sample, in seconds.
    pub begin_s: f64,
    /// Where the second taper begins, in seconds.
    pub end_s: f64,
    /// Length of each taper, in seconds; zero cuts.
    pub taper_s: f64,
}

impl ForceWindow {
    /// The window that keeps a pulse with a margin on either side (both times in seconds).
    pub fn around(pulse: &Pulse, margin_s: f64, taper_s: f64) -> Self {
        let (first, last) = pulse.base_s;
        Self { begin_s: first - margin_s, end_s: last + margin_s, taper_s }
    }

    /// The window at a time after the first sample (seconds), 0 to 1.
    pub fn weight(&self, time_s: f64) -> f64 {
        let outside = (self.begin_s - time_s).max(time_s - self.end_s);
        if outside <= 0.0 {
            1.0
        } else if outside >= self.taper_s {
            0.0
        } else {
            0.5 + 0.5 * (PI * outside / self.taper_s).cos()
        }
    }

    /// Takes the offset away and applies the window to force samples.
    pub fn apply(&self, force: &mut [f64], sample_rate_hz: f64, offset: Option<&Offset>) {
        if let Some(offset) = offset {
            offset.remove(force);
        }
        for (index, x) in force.iter_mut().enumerate() {
            let weight = self.weight(index as f64 / sample_rate_hz);
            // Not `x *= 0.0`, which would keep a NaN that is blanked and a negative zero.
            *x = if weight == 0.0 { 0.0 } else { *x * weight };
        }
    }
}

/// An exponential window `exp(-(t - t0) / tau)` for force and response alike.
///
/// With both signals windowed their transforms are those of the signals on the
/// line `s = i w + 1/tau`, so that exactly
///
/// ```text
/// H_w(i w) = H(i w + 1/tau)
/// ```
///
/// as long as the record begins at rest and the windowed response has decayed
/// at its end. The origin `t0` cancels. No division by the window's mean: a
/// transient loses what it loses. A pole `-sigma + i w_d` of `H` becomes a pole
/// `-(sigma + 1/tau) + i w_d` of `H_w` with the same residue, therefore
///
/// - damping: `zeta w = zeta_w w_w - 1/tau` ([`ExponentialWindow::corrected_damping`]);
/// - frequency: `w_d` is kept, `w^2 = w_d^2 + sigma^2`;
/// - height of a single mode, `A = |residue| / (sigma w_d)`: times
///   `(sigma + 1/tau) / sigma` ([`ExponentialWindow::corrected_peak`]);
/// - residues and modal constants from a circle or pole fit: unchanged.
///
/// With the response alone windowed all this holds up to the window's fall
/// during the blow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialWindow {
    tau: f64,
}

impl ExponentialWindow {
    /// A window of time constant `tau_s`, in seconds.
    ///
    /// # Errors
    /// [`SignalError::Option`](crate::SignalError::Option) unless it is positive and finite.
    pub fn new(tau_s: f64) -> Result<Self> {
        check_positive("the time constant", tau_s)?;
        Ok(Self { tau: tau_s })
    }

    /// The window that falls to `fraction` (between 0 and 1) at a time (seconds).
    ///
    /// # Errors
    /// [`SignalError::Option`](crate::SignalError::Option) unless that is a falling window.
    pub fn falling_to(fraction: f64, after_s: f64) -> Result<Self> {
        Self::new(-after_s / fraction.ln())
    }

    /// The time constant, in seconds.
    pub fn tau_s(&self) -> f64 {
        self.tau
    }

    /// Decay rate the window adds, `1 / tau`, in 1/s.
    pub fn rate(&self) -> f64 {
        1.0 / self.tau
    }

    /// Multiplies samples by the window; it is one at sample `origin`.
    ///
    /// Samples before the origin grow. That is what keeps the relation exact.
    pub fn apply(&self, samples: &mut [f64], sample_rate_hz: f64, origin: usize) {
        for (index, x) in samples.iter_mut().enumerate() {
            let time = (index as f64 - origin as f64) / sample_rate_hz;
            *x *= (-time / self.tau).exp();
        }
    }

    /// The damping ratio without the window.
    ///
    /// - `natural_hz`: undamped natural frequency found on windowed signals, in
    ///   hertz (for small damping the peak's frequency will do).
    /// - `ratio`: damping ratio found on them.
    ///
    /// Exact for a viscous mode; negative if the window's rate exceeds the one found.
    pub fn corrected_damping(&self, natural_hz: f64, ratio: f64) -> f64 {
        let omega = TAU * natural_hz;
        let sigma = ratio * omega - self.rate();
        let damped_square = omega * omega * (1.0 - ratio * ratio);
        sigma / (damped_square + sigma * sigma).sqrt()
    }

    /// The frequency (Hz) of a single mode's receptance peak without the window.
    ///
    /// The peak lies at `w^2 = w_d^2 - sigma^2`, of which the window changes `sigma`.
    /// Arguments as for [`ExponentialWindow::corrected_damping`], and the
    /// peak's frequency. Exact for one viscous mode.
    pub fn corrected_peak_frequency(&self, natural_hz: f64, ratio: f64, peak_hz: f64) -> f64 {
        let sigma = ratio * natural_hz;
        let added = self.rate() / TAU;
        // sigma^2 - (sigma - added)^2, without cancellation.
        (peak_hz * peak_hz + added * (2.0 * sigma - added)).sqrt()
    }

    /// The height of a single mode's receptance peak without the window.
    ///
    /// Arguments as for [`ExponentialWindow::corrected_damping`], and the
    /// height found. Exact for one viscous mode; NaN if the window's rate
    /// exceeds the one found. With neighbours, correct the residue instead.
    pub fn corrected_peak(&self, natural_hz: f64, ratio: f64, magnitude: f64) -> f64 {
        let sigma = ratio * TAU * natural_hz;
        let without = sigma - self.rate();
        if without > 0.0 { magnitude * sigma / without } else { f64::NAN }
    }

    /// The receptance on `s = i w + 1/tau` from what [`FrequencyResponse`](crate::FrequencyResponse) made of it.
    ///
    /// From acceleration that divides by `(i w)^2` where windowed signals need
    /// `s^2`, from velocity by `i w` for `s`; this puts it right. From displacement there is
    /// nothing to do.
    pub fn corrected_receptance(
        &self,
        frequency_hz: f64,
        receptance: Complex64,
        kind: ResponseKind,
    ) -> Complex64 {
        let on_axis = Complex64::new(0.0, TAU * frequency_hz);
        let ratio = on_axis / (on_axis + self.rate());
        (0..kind.derivatives()).fold(receptance, |value, _| value * ratio)
    }
}
