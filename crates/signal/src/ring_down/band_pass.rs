//! A band-pass filter without phase.

use super::analytic::analytic_signal;
use crate::error::{Result, SignalError, check_positive};
use std::f64::consts::PI;

/// A zero-phase band-pass filter with smooth edges.
///
/// ```text
/// G(f) = 1/(1 + exp(-(f - low)/edge)) - 1/(1 + exp(-(f - high)/edge))
/// ```
///
/// is flat in the band and half at its limits. The edges are analytic, so the
/// impulse response falls exponentially,
///
/// ```text
/// |h(t)| <= 4 pi edge / sinh(2 pi^2 edge t)
/// ```
///
/// (of the analytic filter), and a filter for narrow bands stays short: what
/// counts is the width of the edges, not of the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPass {
    low: f64,
    high: f64,
    edge: f64,
}

/// Edges of [`BandPass::around`] over half the band's width.
const EDGE: f64 = 1.0 / 6.0;

impl BandPass {
    /// A filter from `low_hz` to `high_hz` with edges of `edge_hz`, all positive.
    ///
    /// From 0.0025 to 0.9975 an edge is 12 times `edge_hz` wide.
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

    /// A filter for one mode: `centre (1 -+ part)`, its edges a sixth of half its width.
    ///
    /// The gain at the centre is 0.995; [`backbone`](super::backbone) divides it out.
    ///
    /// # Errors
    /// [`SignalError::Option`], for a `part` that is not between 0 and 1 too.
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

    /// Width of the band, which is also the integral of the gain, in hertz.
    pub fn width_hz(&self) -> f64 {
        self.high - self.low
    }

    /// The frequency (Hz) from which on the gain is zero to rounding.
    pub(super) fn end_hz(&self) -> f64 {
        // exp(-37) is less than half of the last bit of one.
        self.high + 37.0 * self.edge
    }

    /// Width of a rectangular band that passes as much white noise, in hertz.
    ///
    /// `integral G^2 df = B coth(B / (2 edge)) - 2 edge`, with `B` the width.
    pub fn noise_width_hz(&self) -> f64 {
        let width = self.width_hz();
        width / (0.5 * width / self.edge).tanh() - 2.0 * self.edge
    }

    /// How much of a jump is still felt after a time (seconds): `(4/pi) exp(-2 pi^2 edge t)`.
    ///
    /// The integral of the impulse response's bound from there on.
    pub fn ringing(&self, time_s: f64) -> f64 {
        4.0 / PI * (-2.0 * PI * PI * self.edge * time_s).exp()
    }

    /// The time after which a jump is felt less than `level`, in seconds.
    pub fn settling_s(&self, level: f64) -> f64 {
        ((4.0 / (PI * level)).ln() / (2.0 * PI * PI * self.edge)).max(0.0)
    }

    /// The filtered samples, as many as were given, at the same times.
    ///
    /// # Errors
    /// Those of [`analytic_signal`].
    pub fn apply(&self, samples: &[f64], sample_rate_hz: f64) -> Result<Vec<f64>> {
        let analytic = analytic_signal(samples, sample_rate_hz, Some(self))?;
        Ok(analytic.into_iter().map(|value| value.re).collect())
    }
}

/// Refuses a band that reaches beyond half the sample rate.
pub(super) fn check_band(band: &BandPass, sample_rate_hz: f64) -> Result<()> {
    if band.high <= 0.5 * sample_rate_hz {
        return Ok(());
    }
    let (quantity, expected) = ("the band's upper limit", "at most half the sample rate");
    Err(SignalError::Option { quantity, value: band.high, expected })
}
