//! A hit whose transforms are wanted at many frequencies.

use crate::form::FrfForm;
use crate::form::ResponseKind;
use crate::frf::convert;
use crate::interpolation::Interpolation;
use crate::response::{Band, Exact, FrequencyResponse, Ripple, Spectra};
use crate::uncertainty::{Term, Terms};
use realfft::num_complex::Complex64;

/// A response with both transforms by interpolation: what costs a sum over all samples
/// at each frequency otherwise costs a few products, to 2e-14 of `dt sum |x|`.
///
/// Transforms are those about the middle sample; their ratios do not know.
#[derive(Debug)]
pub(crate) struct FineResponse<'a> {
    response: &'a FrequencyResponse,
    force: Interpolation,
    samples: Interpolation,
}

impl<'a> FineResponse<'a> {
    pub(crate) fn new(response: &'a FrequencyResponse) -> Self {
        let rate = response.sample_rate_hz();
        Self {
            response,
            force: Interpolation::new(response.force(), rate),
            samples: Interpolation::new(response.samples(), rate),
        }
    }
}

impl Spectra for FineResponse<'_> {
    fn band(&self, padding: usize, high: f64) -> Band<'_> {
        // The transforms are on twice as many points already.
        let parts = padding.div_ceil(2).max(1);
        Band {
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
        let response = self.samples.value_and_slope(frequency_hz);
        let force = self.force.value_and_slope(frequency_hz);
        self.response.power_and_slope_of(frequency_hz, response, force)
    }

    fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple {
        self.response.ripple_under(self.force_magnitude(frequency_hz), frequency_hz, period)
    }
}

impl Exact for FineResponse<'_> {
    fn response(&self) -> &FrequencyResponse {
        self.response
    }

    fn transforms_at(&self, frequency_hz: f64) -> Terms {
        let term = |signal: &Interpolation, samples| {
            let (value, slope) = signal.value_and_slope(frequency_hz);
            Term { value, slope, samples }
        };
        let count = self.response.samples().len();
        let contact = self.response.contact();
        Terms { response: term(&self.samples, 0..count), force: term(&self.force, contact) }
    }
}
