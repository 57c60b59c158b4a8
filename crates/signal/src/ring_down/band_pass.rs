//! A zero-phase band-pass filter.

use crate::error::{Result, SignalError, check_positive};
use std::f64::consts::PI;

/// A zero-phase band-pass filter with smooth edges.
///
/// ```text
/// G(f) = 1/(1 + exp(-(f - low)/edge)) - 1/(1 + exp(-(f - high)/edge))
/// ```
///
/// is flat in the band and half at its limits. Its edges are analytic, so the
/// impulse response of the analytic filter decays exponentially,
///
/// ```text
/// |h(t)| <= 4 pi edge / sinh(2 pi^2 edge t)
/// ```
///
/// at a rate set by the width of the edges, not of the band.
///
/// ```
/// use asperity_signal::BandPass;
///
/// let filter = BandPass::around(800.0, 0.3)?;
/// let sine = |f: f64| -> Vec<f64> {
///     (0..4096).map(|n| (std::f64::consts::TAU * f * f64::from(n) / 8192.0).sin()).collect()
/// };
/// let (inside, outside) = (filter.apply(&sine(800.0), 8192.0)?, filter.apply(&sine(1600.0), 8192.0)?);
/// assert!((inside[2048 + 64] - filter.gain(800.0) * sine(800.0)[2048 + 64]).abs() < 1e-6);
/// assert!(outside[2048].abs() < 1e-6);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPass {
    low: f64,
    high: f64,
    edge: f64,
}

/// Edges of [`BandPass::around`] over half the width of the band.
const EDGE: f64 = 1.0 / 6.0;

impl BandPass {
    /// A filter from `low_hz` to `high_hz` with edges of `edge_hz`, all positive.
    ///
    /// The gain rises from 0.0025 to 0.9975 over 12 times `edge_hz`.
    ///
    /// # Errors
    /// [`SignalError::Option`].
    pub fn new(low_hz: f64, high_hz: f64, edge_hz: f64) -> Result<Self> {
        check_positive("the band's lower limit", low_hz)?;
        check_positive("the band's upper limit", high_hz)?;
        check_positive("the band's edge", edge_hz)?;
        if high_hz <= low_hz {
            let (quantity, expected) = ("the band's upper limit", "above the lower limit");
            return Err(SignalError::Option { quantity, value: high_hz, expected });
        }
        Ok(Self { low: low_hz, high: high_hz, edge: edge_hz })
    }

    /// A filter for one mode, with the limits `centre (1 -+ part)` and edges of a sixth of half its
    /// width.
    ///
    /// The gain at the centre is 0.995; [`backbone`](super::backbone) divides by it.
    ///
    /// # Errors
    /// [`SignalError::Option`], also for a `part` that is not between 0 and 1.
    pub fn around(centre_hz: f64, part: f64) -> Result<Self> {
        let half = part * centre_hz;
        Self::new(centre_hz - half, centre_hz + half, EDGE * half)
    }

    /// Gain at a frequency (Hz), 0 to 1.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let step = |limit: f64| 1.0 / (1.0 + ((limit - frequency_hz) / self.edge).exp());
        step(self.low) - step(self.high)
    }

    /// Lower limit, where the gain is half, in hertz.
    pub fn low_hz(&self) -> f64 {
        self.low
    }

    /// Upper limit, where the gain is half, in hertz.
    pub fn high_hz(&self) -> f64 {
        self.high
    }

    /// Middle of the band, in hertz.
    pub fn centre_hz(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Width of the band, equal to the integral of the gain, in hertz.
    pub fn width_hz(&self) -> f64 {
        self.high - self.low
    }

    /// The frequency (Hz) above which the gain is zero to rounding.
    pub(super) fn end_hz(&self) -> f64 {
        // exp(-37) is below half of the last bit of one.
        self.high + 37.0 * self.edge
    }

    /// Equivalent noise bandwidth, in hertz.
    ///
    /// `integral G^2 df = B coth(B / (2 edge)) - 2 edge`, with `B` the width.
    pub fn noise_width_hz(&self) -> f64 {
        let width = self.width_hz();
        width / (0.5 * width / self.edge).tanh() - 2.0 * self.edge
    }

    /// Bound on the response to a unit step a time (seconds) after it, `(4/pi) exp(-2 pi^2 edge t)`.
    pub fn ringing(&self, time_s: f64) -> f64 {
        4.0 / PI * (-2.0 * PI * PI * self.edge * time_s).exp()
    }

    /// The time after which the response to a unit step is below `level`, in seconds.
    pub fn settling_s(&self, level: f64) -> f64 {
        ((4.0 / (PI * level)).ln() / (2.0 * PI * PI * self.edge)).max(0.0)
    }
}

/// Rejects a band that extends beyond half the sample rate.
pub(super) fn check_band(band: &BandPass, sample_rate_hz: f64) -> Result<()> {
    if band.high <= 0.5 * sample_rate_hz {
        return Ok(());
    }
    let (quantity, expected) = ("the band's upper limit", "at most half the sample rate");
    Err(SignalError::Option { quantity, value: band.high, expected })
}
