//! The frequency response of a hit with interpolated transforms.

use crate::form::{FrfForm, ResponseKind};
use crate::frf::convert;
use crate::interpolation::Interpolation;
use crate::response::FrequencyResponse;
use crate::spectra::{
    BandSpectra, ExactSpectra, HitSpectra, HitTransforms, Ripple, SignalTransform,
};
use num_complex::Complex64;

/// A frequency response whose transforms cost a few products per frequency instead of a sum over
/// all samples, to 2e-14 of `dt sum |x|`.
///
/// Transforms are taken about the middle sample; the common phase cancels in ratios.
#[derive(Debug)]
pub(crate) struct InterpolatedResponse<'a> {
    response: &'a FrequencyResponse,
    force: Interpolation,
    samples: Interpolation,
}

impl<'a> InterpolatedResponse<'a> {
    pub(crate) fn new(response: &'a FrequencyResponse) -> Self {
        let rate = response.sample_rate_hz();
        Self {
            response,
            force: Interpolation::new(response.force(), rate),
            samples: Interpolation::new(response.samples(), rate),
        }
    }
}

impl HitSpectra for InterpolatedResponse<'_> {
    fn band(&self, padding: usize, high: f64) -> BandSpectra<'_> {
        // The transforms have twice as many points as samples already.
        let parts = padding.div_ceil(2).max(1);
        BandSpectra {
            step: self.samples.step(parts),
            samples: self.samples.grid(parts, high).into(),
            force: self.force.grid(parts, high).into(),
        }
    }

    fn kind(&self) -> ResponseKind {
        self.response.kind()
    }

    fn force_magnitude(&self, frequency_hz: f64) -> f64 {
        self.force.value(frequency_hz).norm()
    }

    fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        let ratio = self.samples.value(frequency_hz) / self.force.value(frequency_hz);
        convert(ratio, frequency_hz, self.kind().form(), FrfForm::Receptance)
    }

    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64) {
        self.response.power_and_slope_of(frequency_hz, &self.transforms_at(frequency_hz))
    }

    fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple {
        self.response.ripple_under(self.force_magnitude(frequency_hz), frequency_hz, period)
    }
}

impl ExactSpectra for InterpolatedResponse<'_> {
    fn response(&self) -> &FrequencyResponse {
        self.response
    }

    fn transforms_at(&self, frequency_hz: f64) -> HitTransforms {
        let transform = |signal: &Interpolation, samples| {
            let (value, slope) = signal.value_and_slope(frequency_hz);
            SignalTransform { value, slope, samples }
        };
        HitTransforms {
            response: transform(&self.samples, 0..self.response.samples().len()),
            force: transform(&self.force, self.response.contact()),
        }
    }
}
