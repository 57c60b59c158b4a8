//! One hit: a force and what it caused.

use crate::decimate::DecimationFilter;
use crate::error::{Result, SignalError, check_rate, check_samples};
use crate::form::FrfForm;
use crate::form::ResponseKind;
use crate::frf::ForceMask;
use crate::frf::{Frf, convert};
use crate::pairwise::absolute_sum;
use crate::spectrum::{PADDING_LIMIT, Spectrum, fast_length};
use crate::transform::Kernel;
use crate::uncertainty::{Term, Terms};
use realfft::num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;

/// The force and response samples of one hit.
///
/// The receptance is the ratio of their one-sided transforms,
///
/// ```text
/// H(f) = U(f) / F(f)                       from displacement,
/// H(f) = V(f) / (i 2 pi f F(f))            from velocity,
/// H(f) = A(f) / (-(2 pi f)^2 F(f))         from acceleration,   [m/N]
/// ```
///
/// over the whole record with a rectangular window. The kinds agree when
/// the record starts at rest and has decayed at its end: they differ by the
/// displacement and velocity left there, over `2 pi f` and `(2 pi f)^2`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    force: Vec<f64>,
    samples: Vec<f64>,
    kind: ResponseKind,
    sample_rate_hz: f64,
    /// From the first to the last force sample that is not zero.
    contact: Range<usize>,
}

impl FrequencyResponse {
    /// A hit measured or computed as displacement.
    ///
    /// - `force`: in newtons, the first sample at time zero.
    /// - `displacement`: from equilibrium, in metres, sampled with the force.
    /// - `sample_rate_hz`: positive, in hertz.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::LengthMismatch`], [`SignalError::NotFinite`],
    /// [`SignalError::SampleRate`], [`SignalError::NoForce`].
    pub fn from_displacement(
        force: &[f64],
        displacement: &[f64],
        sample_rate_hz: f64,
    ) -> Result<Self> {
        Self::new(force, displacement, sample_rate_hz, ResponseKind::Displacement)
    }

    /// A hit measured as velocity, in m/s.
    ///
    /// # Errors
    /// Those of [`FrequencyResponse::from_displacement`].
    pub fn from_velocity(force: &[f64], velocity: &[f64], sample_rate_hz: f64) -> Result<Self> {
        Self::new(force, velocity, sample_rate_hz, ResponseKind::Velocity)
    }

    /// A hit measured or computed as acceleration, in m/s^2.
    ///
    /// # Errors
    /// Those of [`FrequencyResponse::from_displacement`].
    pub fn from_acceleration(
        force: &[f64],
        acceleration: &[f64],
        sample_rate_hz: f64,
    ) -> Result<Self> {
        Self::new(force, acceleration, sample_rate_hz, ResponseKind::Acceleration)
    }

    pub(crate) fn new(
        force: &[f64],
        samples: &[f64],
        sample_rate_hz: f64,
        kind: ResponseKind,
    ) -> Result<Self> {
        check_samples("force", force)?;
        check_samples(kind.name(), samples)?;
        check_rate(sample_rate_hz)?;
        if force.len() != samples.len() {
            return Err(SignalError::LengthMismatch {
                force: force.len(),
                response: samples.len(),
            });
        }
        let nonzero = |value: &f64| *value != 0.0;
        let (Some(first), Some(last)) =
            (force.iter().position(nonzero), force.iter().rposition(nonzero))
        else {
            return Err(SignalError::NoForce { samples: force.len() });
        };
        Ok(Self {
            force: force.to_vec(),
            samples: samples.to_vec(),
            kind,
            sample_rate_hz,
            contact: first..last + 1,
        })
    }

    /// Receptance \[m/N\] on the grid of a zero-padded FFT, zero frequency to half the rate.
    ///
    /// `padding` is clamped to 1 to 1024, see [`Spectrum::new`]. From
    /// velocity or acceleration the value at zero frequency is NaN; where the force has no
    /// content at all the value is not finite ([`FrequencyResponse::force_mask`]).
    pub fn receptance(&self, padding: usize) -> Frf {
        let length = self.padded_length(padding);
        let force = Spectrum::padded_to(&self.force, self.sample_rate_hz, length);
        let response = Spectrum::padded_to(&self.samples, self.sample_rate_hz, length);
        let frequency_hz: Vec<f64> =
            (0..force.values().len()).map(|index| force.frequency(index)).collect();
        let values = frequency_hz
            .iter()
            .zip(response.into_values().iter().zip(force.values()))
            .map(|(&frequency, (x, f))| convert(x / f, frequency, self.form(), FrfForm::Receptance))
            .collect();
        Frf { frequency_hz, values, form: FrfForm::Receptance }
    }

    /// Receptance \[m/N\] at any frequency (Hz), from the transforms there.
    pub fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        let kernel = Kernel::new(self.sample_rate_hz, frequency_hz);
        let ratio = kernel.transform(&self.samples, 0) / self.force_transform(&kernel);
        convert(ratio, frequency_hz, self.form(), FrfForm::Receptance)
    }

    /// Transform of the force \[N s\] at any frequency (Hz).
    pub fn force_at(&self, frequency_hz: f64) -> Complex64 {
        self.force_transform(&Kernel::new(self.sample_rate_hz, frequency_hz))
    }

    /// Where the force has at least `threshold` of its largest spectral magnitude.
    ///
    /// On the grid of [`FrequencyResponse::receptance`] with the same `padding`. A
    /// `threshold` of 0.02 leaves the main lobe of any hammer pulse and cuts
    /// the zeros between its side lobes.
    pub fn force_mask(&self, padding: usize, threshold: f64) -> ForceMask {
        let length = self.padded_length(padding);
        let force = Spectrum::padded_to(&self.force, self.sample_rate_hz, length);
        let magnitude: Vec<f64> = force.values().iter().map(|value| value.norm()).collect();
        let frequency_hz = (0..magnitude.len()).map(|index| force.frequency(index));
        ForceMask::new(frequency_hz.collect(), &magnitude, threshold)
    }

    /// Sample rate, in hertz.
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Length of the record, in seconds: the number of samples over their rate.
    pub fn duration(&self) -> f64 {
        self.samples.len() as f64 / self.sample_rate_hz
    }

    /// The force samples, in newtons.
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// The response samples, in the unit of the kind.
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// What the response samples are.
    pub fn kind(&self) -> ResponseKind {
        self.kind
    }

    /// From the first to the last force sample that is not zero.
    pub(crate) fn contact(&self) -> Range<usize> {
        self.contact.clone()
    }

    /// `|H|^2` and the derivative of its logarithm with frequency \[1/Hz\].
    ///
    /// `d ln |H|^2 / df = 2 Re (X'/X - F'/F)`, and `-2/f` more for each derivative of the kind.
    pub(crate) fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64) {
        let kernel = Kernel::new(self.sample_rate_hz, frequency_hz);
        let response = kernel.transform_and_slope(&self.samples, 0);
        let pulse = &self.force[self.contact.clone()];
        let force = kernel.transform_and_slope(pulse, self.contact.start);
        self.power_and_slope_of(frequency_hz, response, force)
    }

    /// The same from the transforms and their derivatives.
    pub(crate) fn power_and_slope_of(
        &self,
        frequency_hz: f64,
        (x, dx): (Complex64, Complex64),
        (f, df): (Complex64, Complex64),
    ) -> (f64, f64) {
        let ratio = convert(x / f, frequency_hz, self.form(), FrfForm::Receptance);
        let derivatives = f64::from(self.kind.derivatives()) / frequency_hz;
        (ratio.norm_sqr(), 2.0 * ((dx / x - df / f).re - derivatives))
    }

    /// The transforms of response and force, with their derivatives, at a frequency (Hz).
    pub(crate) fn transforms_at(&self, frequency_hz: f64) -> Terms {
        let kernel = Kernel::new(self.sample_rate_hz, frequency_hz);
        let (value, slope) = kernel.transform_and_slope(&self.samples, 0);
        let response = Term { value, slope, samples: 0..self.samples.len() };
        let pulse = &self.force[self.contact.clone()];
        let (value, slope) = kernel.transform_and_slope(pulse, self.contact.start);
        Terms { response, force: Term { value, slope, samples: self.contact.clone() } }
    }

    /// A bound on the ripple of `|H|` at a frequency (Hz) that is not physics.
    ///
    /// What is left at the end of the record, `x_end` over the last `period`
    /// seconds, is cut off by the rectangular window: `leakage` is `x_end / w`
    /// over `|F|`. `rounding` is that of the transform, relative to `dt sum |x|`.
    pub(crate) fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple {
        self.ripple_under(self.force_at(frequency_hz).norm(), frequency_hz, period)
    }

    /// The same where the magnitude of the force's transform is known.
    pub(crate) fn ripple_under(&self, force: f64, frequency_hz: f64, period: f64) -> Ripple {
        let count = (period * self.sample_rate_hz).ceil().max(1.0) as usize;
        let tail = &self.samples[self.samples.len().saturating_sub(count)..];
        let left = tail.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let omega = std::f64::consts::TAU * frequency_hz;
        let scale = 1.0 / (omega.powi(self.kind.derivatives()) * force);
        Ripple {
            leakage: left / omega * scale,
            rounding: 1e-14 * absolute_sum(&self.samples) / self.sample_rate_hz * scale,
        }
    }

    /// The transforms of response and force from zero to just beyond `high` (Hz).
    ///
    /// Up to one common phase and to 1e-9 of their largest values, from
    /// decimated samples where that pays.
    pub(crate) fn band(&self, padding: usize, high: f64) -> Band<'static> {
        let filter = DecimationFilter::new(self.sample_rate_hz, high, self.samples.len());
        let (force, samples, rate) = match &filter {
            Some(filter) => (
                Cow::Owned(filter.apply(&self.force, &self.contact)),
                Cow::Owned(filter.apply(&self.samples, &(0..self.samples.len()))),
                self.sample_rate_hz / filter.factor() as f64,
            ),
            None => (
                Cow::Borrowed(self.force.as_slice()),
                Cow::Borrowed(self.samples.as_slice()),
                self.sample_rate_hz,
            ),
        };
        let padding = padding.clamp(1, PADDING_LIMIT);
        let length = fast_length(padding.saturating_mul(samples.len()));
        let step = rate / length as f64;
        let keep = ((high / step).ceil() as usize).saturating_add(2);
        let low_part = |samples: &[f64]| {
            let mut values = Spectrum::padded_to(samples, rate, length).into_values();
            values.truncate(keep);
            values
        };
        Band { step, samples: low_part(&samples).into(), force: low_part(&force).into() }
    }

    fn force_transform(&self, kernel: &Kernel) -> Complex64 {
        kernel.transform(&self.force[self.contact.clone()], self.contact.start)
    }

    fn padded_length(&self, padding: usize) -> usize {
        fast_length(padding.clamp(1, PADDING_LIMIT).saturating_mul(self.samples.len()))
    }

    fn form(&self) -> FrfForm {
        self.kind.form()
    }
}

/// Spectra of a force and what it caused: all that a search for peaks asks of a hit.
pub(crate) trait Spectra {
    /// The transforms from zero to just beyond `high` (Hz), on a grid of at least `padding`.
    fn band(&self, padding: usize, high: f64) -> Band<'_>;
    /// What the response samples are.
    fn kind(&self) -> ResponseKind;
    /// Magnitude of the force's transform \[N s\].
    fn force_magnitude(&self, frequency_hz: f64) -> f64;
    /// Receptance \[m/N\].
    fn receptance_at(&self, frequency_hz: f64) -> Complex64;
    /// `|H|^2` and the derivative of its logarithm with frequency \[1/Hz\].
    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64);
    /// A bound on the ripple of `|H|` at a frequency (Hz) that is not physics.
    fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple;
}

/// Spectra of one hit's own samples, at any frequency.
pub(crate) trait Exact: Spectra {
    /// The hit.
    fn response(&self) -> &FrequencyResponse;
    /// The transforms with their derivatives at a frequency (Hz), up to one common phase.
    fn transforms_at(&self, frequency_hz: f64) -> Terms;
}

impl Exact for FrequencyResponse {
    fn response(&self) -> &FrequencyResponse {
        self
    }

    fn transforms_at(&self, frequency_hz: f64) -> Terms {
        Self::transforms_at(self, frequency_hz)
    }
}

impl Spectra for FrequencyResponse {
    fn band(&self, padding: usize, high: f64) -> Band<'_> {
        Self::band(self, padding, high)
    }

    fn kind(&self) -> ResponseKind {
        self.kind
    }

    fn force_magnitude(&self, frequency_hz: f64) -> f64 {
        self.force_at(frequency_hz).norm()
    }

    fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        Self::receptance_at(self, frequency_hz)
    }

    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64) {
        Self::power_and_slope(self, frequency_hz)
    }

    fn ripple(&self, frequency_hz: f64, period: f64) -> Ripple {
        Self::ripple(self, frequency_hz, period)
    }
}

/// Ripples of `|H|` \[m/N\] that the window and the arithmetic make.
pub(crate) struct Ripple {
    pub(crate) leakage: f64,
    pub(crate) rounding: f64,
}

/// The transforms of response and force at `k step`, from zero.
pub(crate) struct Band<'a> {
    pub(crate) step: f64,
    pub(crate) samples: Cow<'a, [Complex64]>,
    pub(crate) force: Cow<'a, [Complex64]>,
}
