//! Spectra of a hit, as the searches for peaks and widths use them.

use crate::form::ResponseKind;
use crate::sums::{absolute_sum, largest_magnitude};
use num_complex::Complex64;
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::ops::Range;

/// Receptance of a hit and the transforms it is the ratio of.
pub(crate) trait HitSpectra {
    /// The transforms from zero to just above `high` (Hz), zero-padded by `padding` or more, up to
    /// a common phase.
    fn band(&self, padding: usize, high: f64) -> BandSpectra<'_>;
    /// Quantity of the response samples.
    fn kind(&self) -> ResponseKind;
    /// Magnitude of the transform of the force \[N s\].
    fn force_magnitude(&self, frequency_hz: f64) -> f64;
    /// Receptance \[m/N\].
    fn receptance_at(&self, frequency_hz: f64) -> Complex64;
    /// `|H|^2` and the derivative of its logarithm with respect to frequency \[1/Hz\].
    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64);
    /// Bounds on the ripple of `|H|` from truncation and rounding; see [`Ripple::of`].
    fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple;
}

/// Transforms of force and response at `k step`, from zero.
pub(crate) struct BandSpectra<'a> {
    pub(crate) step: f64,
    pub(crate) samples: Cow<'a, [Complex64]>,
    pub(crate) force: Cow<'a, [Complex64]>,
}

/// Transforms of force and response at one frequency.
pub(crate) struct HitTransforms {
    pub(crate) response: SignalTransform,
    pub(crate) force: SignalTransform,
}

/// Transform of a signal, its derivative with respect to frequency, and the samples it is taken
/// over.
pub(crate) struct SignalTransform {
    pub(crate) value: Complex64,
    pub(crate) slope: Complex64,
    pub(crate) samples: Range<usize>,
}

/// Bounds on the ripple of `|H|` \[m/N\] that is not the structure's.
pub(crate) struct Ripple {
    pub(crate) leakage: f64,
    pub(crate) rounding: f64,
}

impl Ripple {
    /// Ripple of a record of `samples` under a force of spectral magnitude `force` at a frequency.
    ///
    /// `leakage` is that of the step at the end of the record, `x_end / (w |F|)` with `x_end` the
    /// largest sample of the last `period` seconds; `rounding` is that of the transform, relative
    /// to `dt sum |x|`.
    pub(crate) fn of(
        samples: &[f64],
        (rate, kind): (f64, ResponseKind),
        force: f64,
        (frequency_hz, period): (f64, f64),
    ) -> Self {
        let count = (period * rate).ceil().max(1.0) as usize;
        let end = largest_magnitude(&samples[samples.len().saturating_sub(count)..]);
        let omega = TAU * frequency_hz;
        let scale = 1.0 / (omega.powi(kind.derivatives()) * force);
        Self {
            leakage: end / omega * scale,
            rounding: 1e-14 * absolute_sum(samples) / rate * scale,
        }
    }
}
