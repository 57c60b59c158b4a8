//! The band of a mode with the integration of its samples to a displacement.

use super::analytic::filtered;
use super::band_pass::BandPass;
use crate::error::Result;
use num_complex::Complex64;

/// Order of the polynomial of the integration.
const ORDER: i32 = 6;

/// Cells of the numerical integral of a noise width.
const CELLS: usize = 400;

/// A band-pass filter that turns velocities and accelerations into displacements.
///
/// ```text
/// g(f) = G(f) sum_k C(-n, k) y^k,   y = f / f_c - 1,   k = 0 to 6,
/// ```
///
/// with the gain `G` and the centre `f_c` of the band, and `n` derivatives. The sum is the polynomial
/// of `(f_c / f)^n` about the centre: its slope is right to 5e-5 at 0.9 and to 0.4 % at 0.8 of it. It
/// has no pole at zero frequency, where an integration amplifies what the band does not suppress, so
/// that the filter settles as the band does. The filtered signal is the displacement times
/// `(i 2 pi f_c)^n`. Limiting case: displacements are filtered by the band alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DisplacementFilter {
    band: BandPass,
    /// Coefficients of the polynomial.
    terms: [f64; ORDER as usize + 1],
    /// Largest value of the polynomial at the limits of the band, at least one.
    raise: f64,
}

impl DisplacementFilter {
    pub(crate) fn new(band: BandPass, derivatives: i32) -> Self {
        let mut terms = [1.0; ORDER as usize + 1];
        for k in 1..terms.len() {
            terms[k] = -terms[k - 1] * (f64::from(derivatives) + k as f64 - 1.0) / k as f64;
        }
        let mut filter = Self { band, terms, raise: 1.0 };
        let at_limits =
            [band.low_hz(), band.high_hz()].map(|limit| filter.integration(limit).abs());
        filter.raise = at_limits.into_iter().fold(1.0, f64::max);
        filter
    }

    /// The polynomial of the integration at a frequency (Hz).
    fn integration(&self, frequency_hz: f64) -> f64 {
        let y = frequency_hz / self.band.centre_hz() - 1.0;
        self.terms.iter().rev().fold(0.0, |sum, term| sum * y + term)
    }

    /// Gain at a frequency (Hz).
    pub(crate) fn gain(&self, frequency_hz: f64) -> f64 {
        let passed = self.band.gain(frequency_hz);
        // The polynomial grows without bound where nothing passes.
        if passed == 0.0 { 0.0 } else { passed * self.integration(frequency_hz) }
    }

    /// The analytic signal of the samples of a decay.
    pub(crate) fn analytic_signal(
        &self,
        samples: &[f64],
        sample_rate_hz: f64,
    ) -> Result<Vec<Complex64>> {
        filtered(samples, sample_rate_hz, Some(&self.band), |frequency| self.gain(frequency))
    }

    /// Equivalent noise bandwidth, in hertz.
    pub(crate) fn noise_width_hz(&self) -> f64 {
        if self.terms[1] == 0.0 {
            return self.band.noise_width_hz();
        }
        let end = 2.0 * self.band.high_hz();
        let cell = end / CELLS as f64;
        (0..CELLS).map(|n| self.gain((n as f64 + 0.5) * cell).powi(2) * cell).sum()
    }

    /// Bound on the response to a unit step a time (seconds) after it: that of the band, raised by the
    /// gain of the integration at its limits.
    pub(crate) fn ringing(&self, time_s: f64) -> f64 {
        self.raise * self.band.ringing(time_s)
    }

    /// The time after which the response to a unit step is below `level`, in seconds.
    pub(crate) fn settling_s(&self, level: f64) -> f64 {
        self.band.settling_s(level / self.raise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_is_that_of_the_integration() {
        let band = BandPass::around(800.0, 0.3).unwrap();
        for derivatives in 0..=2 {
            let filter = DisplacementFilter::new(band, derivatives);
            let exact = |f: f64| (800.0 / f).powi(derivatives);
            let slope = |of: &dyn Fn(f64) -> f64, f: f64| (of(f + 0.01) - of(f - 0.01)) / 0.02;
            for f in [720.0, 790.0, 800.0, 850.0, 880.0] {
                let found = slope(&|f| filter.integration(f), f);
                assert!((found - slope(&exact, f)).abs() < 1e-4 / 800.0, "{derivatives} {f}");
                assert!((filter.integration(f) / exact(f) - 1.0).abs() < 5e-6);
            }
        }
        // Displacements see the band alone.
        let plain = DisplacementFilter::new(band, 0);
        assert_eq!((plain.gain(700.0), plain.raise), (band.gain(700.0), 1.0));
        let numeric = DisplacementFilter { terms: plain.terms.map(|term| term + 1e-300), ..plain };
        assert!((numeric.noise_width_hz() / band.noise_width_hz() - 1.0).abs() < 1e-9);
    }
}
