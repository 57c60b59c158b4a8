//! Windows for transients and their effect on a frequency response function.

mod response_window;

pub(crate) use response_window::DecayEnvelope;
pub use response_window::ResponseWindow;

use crate::error::{Result, check_positive};
use crate::form::ResponseKind;
use crate::offset::Offset;
use crate::pulse::Pulse;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// A window that keeps the force pulse and sets the rest of the force record to zero.
///
/// ```text
/// w = 1 in [begin, end], 0 beyond a cosine taper of `taper` on either side
/// ```
///
/// Outside contact the force is zero and its record is
/// noise. The offset must be subtracted first.
///
/// ```
/// use asperity_signal::ForceWindow;
///
/// let window = ForceWindow { begin_s: 1e-3, end_s: 2e-3, taper_s: 1e-3 };
/// let mut force = [0.1, 4.0, 3.0, 0.2, 0.1];
/// window.apply(&mut force, 1e3, None);
/// assert_eq!(force, [0.0, 4.0, 3.0, 0.0, 0.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceWindow {
    /// End of the rising taper, after the first sample, in seconds.
    pub begin_s: f64,
    /// Beginning of the falling taper, in seconds.
    pub end_s: f64,
    /// Length of each taper, in seconds; zero for a rectangular window.
    pub taper_s: f64,
}

impl ForceWindow {
    /// The window around a pulse, with a margin on either side and a taper, in seconds.
    pub fn around(pulse: &Pulse, margin_s: f64, taper_s: f64) -> Self {
        let (first, last) = pulse.base_s;
        Self { begin_s: first - margin_s, end_s: last + margin_s, taper_s }
    }

    /// The window from the first to the last sample above a level (in newtons), with a margin on
    /// either side and a taper, in seconds; `None` if no sample is.
    pub fn above(
        force: &[f64],
        sample_rate_hz: f64,
        level_n: f64,
        margin_s: f64,
        taper_s: f64,
    ) -> Option<Self> {
        let is_above = |x: &f64| x.abs() > level_n;
        let first = force.iter().position(is_above)? as f64 / sample_rate_hz;
        let last = force.iter().rposition(is_above)? as f64 / sample_rate_hz;
        Some(Self { begin_s: first - margin_s, end_s: last + margin_s, taper_s })
    }

    /// Value of the window at a time after the first sample (seconds), 0 to 1.
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

    /// Subtracts the offset and applies the window to force samples.
    pub fn apply(&self, force: &mut [f64], sample_rate_hz: f64, offset: Option<&Offset>) {
        if let Some(offset) = offset {
            offset.remove(force);
        }
        for (index, x) in force.iter_mut().enumerate() {
            let weight = self.weight(index as f64 / sample_rate_hz);
            // Not `x *= 0.0`, which would keep NaN and negative zeros.
            *x = if weight == 0.0 { 0.0 } else { *x * weight };
        }
    }
}

/// An exponential window `exp(-(t - t0) / tau)` for force and response alike.
///
/// The transforms of the windowed signals are those of the signals on the
/// line `s = i w + 1/tau`, so that
///
/// ```text
/// H_w(i w) = H(i w + 1/tau)
/// ```
///
/// exactly, if the record begins at rest and the windowed response has decayed
/// at its end. The origin `t0` cancels. Values are not divided by the mean of the window.
/// A pole `-sigma + i w_d` of `H` becomes the pole
/// `-(sigma + 1/tau) + i w_d` of `H_w` with the same residue, therefore
///
/// - damping: `zeta w = zeta_w w_w - 1/tau` ([`ExponentialWindow::corrected_damping`]);
/// - frequency: `w_d` is kept, `w^2 = w_d^2 + sigma^2`;
/// - height of a single mode, `A = |residue| / (sigma w_d)`: times
///   `(sigma + 1/tau) / sigma` ([`ExponentialWindow::corrected_peak`]);
/// - residues and modal constants from a circle or pole fit: unchanged.
///
/// With a window on the response alone this holds up to the decrease of the window
/// during the pulse.
///
/// ```
/// use asperity_signal::ExponentialWindow;
///
/// // A window that falls to 1 % in 0.1 s, and a mode at 100 Hz with 1 % of critical damping.
/// let window = ExponentialWindow::falling_to(0.01, 0.1)?;
/// let omega = std::f64::consts::TAU * 100.0;
/// let windowed = (0.01 * omega + window.rate()) / omega;
/// assert!((window.corrected_damping(100.0, windowed) - 0.01).abs() < 1e-4);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
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

    /// The window that falls to `fraction` (between 0 and 1) after a time (seconds).
    ///
    /// # Errors
    /// [`SignalError::Option`](crate::SignalError::Option) for a window that does not fall.
    pub fn falling_to(fraction: f64, after_s: f64) -> Result<Self> {
        Self::new(-after_s / fraction.ln())
    }

    /// The time constant, in seconds.
    pub fn tau_s(&self) -> f64 {
        self.tau
    }

    /// Added decay rate `1 / tau`, in 1/s.
    pub fn rate(&self) -> f64 {
        1.0 / self.tau
    }

    /// Multiplies samples by the window, which is one at sample `origin` and larger before it.
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
    /// Exact for a viscous mode; negative if the decay rate of the window exceeds the one found.
    pub fn corrected_damping(&self, natural_hz: f64, ratio: f64) -> f64 {
        let omega = TAU * natural_hz;
        let sigma = ratio * omega - self.rate();
        let damped_square = omega * omega * (1.0 - ratio * ratio);
        sigma / (damped_square + sigma * sigma).sqrt()
    }

    /// The undamped natural frequency (Hz) without the window, `w^2 = w_d^2 + sigma^2`.
    ///
    /// Arguments as for [`ExponentialWindow::corrected_damping`]. Exact for a viscous mode.
    pub fn corrected_natural_frequency(&self, natural_hz: f64, ratio: f64) -> f64 {
        let sigma = ratio * natural_hz - self.rate() / TAU;
        (natural_hz * natural_hz * (1.0 - ratio * ratio) + sigma * sigma).sqrt()
    }

    /// The frequency (Hz) of a single mode's receptance peak without the window.
    ///
    /// The peak is at `w^2 = w_d^2 - sigma^2`, in which the window changes `sigma`.
    /// Arguments as for [`ExponentialWindow::corrected_damping`], and the
    /// frequency of the peak. Exact for one viscous mode.
    pub fn corrected_peak_frequency(&self, natural_hz: f64, ratio: f64, peak_hz: f64) -> f64 {
        let sigma = ratio * natural_hz;
        let added = self.rate() / TAU;
        // sigma^2 - (sigma - added)^2, without cancellation.
        (peak_hz * peak_hz + added * (2.0 * sigma - added)).sqrt()
    }

    /// The height of a single mode's receptance peak without the window.
    ///
    /// Arguments as for [`ExponentialWindow::corrected_damping`], and the
    /// height found. Exact for one viscous mode; NaN if the decay rate of the window
    /// exceeds the one found. With neighbouring modes use the residue, which needs no correction.
    pub fn corrected_peak(&self, natural_hz: f64, ratio: f64, magnitude: f64) -> f64 {
        let sigma = ratio * TAU * natural_hz;
        let without = sigma - self.rate();
        if without > 0.0 { magnitude * sigma / without } else { f64::NAN }
    }

    /// The receptance on `s = i w + 1/tau` from the receptance of
    /// [`FrequencyResponse`](crate::FrequencyResponse).
    ///
    /// Windowed accelerations must be divided by `s^2` instead of `(i w)^2`, windowed velocities by
    /// `s` instead of `i w`. The receptance from displacement is returned unchanged.
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
