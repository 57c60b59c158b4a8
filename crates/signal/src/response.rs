//! The frequency response of one hit from its force and response samples.

use crate::decimation::DecimationFilter;
use crate::error::{Result, SignalError, check_rate, check_samples};
use crate::form::{FrfForm, ResponseKind};
use crate::frf::{ForceMask, Frf, convert};
use crate::interpolation::Interpolation;
use crate::spectra::{
    BandSpectra, HitSpectra, HitTransforms, Ripples, SignalTransform, UnfilteredEnd,
};
use crate::spectrum::{PADDING_LIMIT, Spectrum};
use crate::transform::FourierKernel;
use crate::window::ResponseWindow;
use asperity_transform::fast_length;
use num_complex::Complex64;
use std::borrow::Cow;
use std::ops::Range;

/// The frequency response of one hit, from its force and response samples.
///
/// The receptance is the ratio of the one-sided transforms,
///
/// ```text
/// H(f) = U(f) / F(f)                       from displacement,
/// H(f) = V(f) / (i 2 pi f F(f))            from velocity,
/// H(f) = A(f) / (-(2 pi f)^2 F(f))         from acceleration,   [m/N]
/// ```
///
/// over the whole record with a rectangular window. The three agree if
/// the record starts at rest and has decayed at its end; otherwise they differ by the
/// final displacement and velocity over `2 pi f` and `(2 pi f)^2`.
///
/// ```
/// use asperity_signal::FrequencyResponse;
///
/// // A mass of 2 kg pushed by 1 N for a millisecond, then stopped: 5e-7 m further.
/// let force = [vec![1.0; 10], vec![-1.0; 10], vec![0.0; 80]].concat();
/// let acceleration: Vec<f64> = force.iter().map(|f| f / 2.0).collect();
/// let hit = FrequencyResponse::from_acceleration(&force, &acceleration, 1e4)?;
/// let omega = std::f64::consts::TAU * 100.0;
/// assert!((hit.receptance_at(100.0).re * omega * omega + 0.5).abs() < 1e-12);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    force: Vec<f64>,
    samples: Vec<f64>,
    kind: ResponseKind,
    sample_rate_hz: f64,
    /// From the first to the last force sample that is not zero.
    contact: Range<usize>,
    /// Transforms of force and response, about the middle sample; the common phase cancels in
    /// ratios.
    interpolations: Option<[Interpolation; 2]>,
    /// The end of the motion before a filter, and its sample rate \[Hz\].
    unfiltered: Option<(Vec<f64>, f64)>,
}

impl FrequencyResponse {
    /// The frequency response from force and displacement.
    ///
    /// - `force`: in newtons, the first sample at time zero.
    /// - `displacement`: from equilibrium, in metres, sampled with the force.
    /// - `sample_rate_hz`: positive, in hertz.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::LengthMismatch`], [`SignalError::NotFinite`],
    /// [`SignalError::SampleRate`], [`SignalError::NoForce`].
    ///
    /// ```
    /// use asperity_signal::FrequencyResponse;
    ///
    /// // A spring of 1e6 N/m without mass: H = 1e-6 m/N at every frequency.
    /// let force = [0.0, 3.0, 5.0, 3.0, 0.0, 0.0];
    /// let displacement = force.map(|f| 1e-6 * f);
    /// let hit = FrequencyResponse::from_displacement(&force, &displacement, 1e4)?;
    /// assert!((hit.receptance_at(440.0).re - 1e-6).abs() < 1e-20);
    /// # Ok::<(), asperity_signal::SignalError>(())
    /// ```
    pub fn from_displacement(
        force: &[f64],
        displacement: &[f64],
        sample_rate_hz: f64,
    ) -> Result<Self> {
        Self::new(force, displacement, sample_rate_hz, ResponseKind::Displacement)
    }

    /// The frequency response from force and velocity (m/s).
    ///
    /// # Errors
    /// Those of [`FrequencyResponse::from_displacement`].
    pub fn from_velocity(force: &[f64], velocity: &[f64], sample_rate_hz: f64) -> Result<Self> {
        Self::new(force, velocity, sample_rate_hz, ResponseKind::Velocity)
    }

    /// The frequency response from force and acceleration (m/s^2).
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
            interpolations: None,
            unfiltered: None,
        })
    }

    /// True for [interpolated](Self::interpolated) transforms.
    pub fn is_interpolated(&self) -> bool {
        self.interpolations.is_some()
    }

    /// The response with interpolated transforms, a few products per frequency instead of a sum over
    /// all samples, to 2e-14 of `dt sum |x|`.
    #[must_use]
    pub fn interpolated(self) -> Self {
        let signals = [&self.force, &self.samples];
        let interpolations = signals.map(|signal| Interpolation::new(signal, self.sample_rate_hz));
        Self { interpolations: Some(interpolations), ..self }
    }

    /// The response of samples that a filter has taken in, with the end of their motion before it.
    #[must_use]
    pub fn with_unfiltered_end(self, end: UnfilteredEnd<'_>) -> Self {
        Self { unfiltered: Some((end.samples.to_vec(), end.sample_rate_hz)), ..self }
    }

    /// The response under a window, without interpolated transforms, and without the samples after the
    /// window, which are zero, and after the force.
    pub(crate) fn with_response_window(&self, window: &ResponseWindow) -> Self {
        let rate = self.sample_rate_hz;
        let end = ((window.end_s + window.taper_s) * rate).ceil() as usize + 1;
        let end = end.max(self.contact.end).min(self.samples.len());
        let mut samples = self.samples[..end].to_vec();
        window.apply(&mut samples, rate);
        Self {
            force: self.force[..end].to_vec(),
            samples,
            kind: self.kind,
            sample_rate_hz: rate,
            contact: self.contact.clone(),
            interpolations: None,
            unfiltered: None,
        }
    }

    /// Receptance \[m/N\] on the grid of a zero-padded FFT, from zero frequency to half the sample
    /// rate.
    ///
    /// `padding` is clamped to 1 to 1024, see [`Spectrum::new`]. The value at zero frequency is NaN
    /// from velocity or acceleration; values are not finite where the transform of the force is
    /// zero ([`FrequencyResponse::force_mask`]).
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

    /// Receptance \[m/N\] at any frequency (Hz), from the Fourier sums at that frequency.
    pub fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        let ratio = if let Some([force, samples]) = &self.interpolations {
            samples.value(frequency_hz) / force.value(frequency_hz)
        } else {
            let kernel = FourierKernel::new(self.sample_rate_hz, frequency_hz);
            kernel.transform(&self.samples, 0) / self.force_transform(&kernel)
        };
        convert(ratio, frequency_hz, self.form(), FrfForm::Receptance)
    }

    /// Transform of the force \[N s\] at any frequency (Hz).
    pub fn force_at(&self, frequency_hz: f64) -> Complex64 {
        self.force_transform(&FourierKernel::new(self.sample_rate_hz, frequency_hz))
    }

    /// The frequencies at which the force has at least `threshold` of its largest spectral
    /// magnitude.
    ///
    /// On the grid of [`FrequencyResponse::receptance`] with the same `padding`. A
    /// `threshold` of 0.02 keeps the main lobe of any hammer pulse and excludes
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

    /// Length of the record, the number of samples over their rate, in seconds.
    pub fn duration(&self) -> f64 {
        self.samples.len() as f64 / self.sample_rate_hz
    }

    /// The force samples, in newtons.
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// The response samples, in m, m/s or m/s^2 according to [`FrequencyResponse::kind`].
    pub fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Quantity of the response samples.
    pub fn kind(&self) -> ResponseKind {
        self.kind
    }

    /// Time of no phase in [`FrequencyResponse::transforms_at`], after the first sample.
    pub(crate) fn time_origin_s(&self) -> f64 {
        let middle = if self.interpolations.is_some() { self.samples.len() / 2 } else { 0 };
        middle as f64 / self.sample_rate_hz
    }

    /// Transforms and their derivatives at a frequency (Hz), up to a common phase.
    pub(crate) fn transforms_at(&self, frequency_hz: f64) -> HitTransforms {
        let contact = self.contact.clone();
        let (force, samples) = if let Some([force, samples]) = &self.interpolations {
            (force.value_and_slope(frequency_hz), samples.value_and_slope(frequency_hz))
        } else {
            let kernel = FourierKernel::new(self.sample_rate_hz, frequency_hz);
            let force = kernel.transform_and_slope(&self.force[contact.clone()], contact.start);
            (force, kernel.transform_and_slope(&self.samples, 0))
        };
        let transform = |(value, slope), samples| SignalTransform { value, slope, samples };
        HitTransforms {
            response: transform(samples, 0..self.samples.len()),
            force: transform(force, contact),
        }
    }

    /// From decimated samples where that is faster, to 1e-9 of the largest values.
    fn decimated_band(&self, padding: usize, high: f64) -> BandSpectra<'_> {
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
        BandSpectra {
            step,
            duration: self.duration(),
            samples: low_part(&samples).into(),
            force: low_part(&force).into(),
        }
    }

    fn force_transform(&self, kernel: &FourierKernel) -> Complex64 {
        kernel.transform(&self.force[self.contact.clone()], self.contact.start)
    }

    fn padded_length(&self, padding: usize) -> usize {
        fast_length(padding.clamp(1, PADDING_LIMIT).saturating_mul(self.samples.len()))
    }

    fn form(&self) -> FrfForm {
        self.kind.form()
    }
}

impl HitSpectra for FrequencyResponse {
    fn band(&self, padding: usize, high: f64) -> BandSpectra<'_> {
        let Some([force, samples]) = &self.interpolations else {
            return self.decimated_band(padding, high);
        };
        // The transforms have twice as many points as samples already.
        let parts = padding.div_ceil(2).max(1);
        BandSpectra {
            step: samples.step(parts),
            duration: self.duration(),
            samples: samples.grid(parts, high).into(),
            force: force.grid(parts, high).into(),
        }
    }

    fn kind(&self) -> ResponseKind {
        self.kind
    }

    fn force_magnitude(&self, frequency_hz: f64) -> f64 {
        match &self.interpolations {
            Some([force, _]) => force.value(frequency_hz).norm(),
            None => self.force_at(frequency_hz).norm(),
        }
    }

    fn receptance_at(&self, frequency_hz: f64) -> Complex64 {
        Self::receptance_at(self, frequency_hz)
    }

    /// The slope is `2 Re (X'/X - F'/F)`, less `2/f` for each time derivative in the response.
    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64) {
        let HitTransforms { response: x, force: f } = self.transforms_at(frequency_hz);
        let ratio = convert(x.value / f.value, frequency_hz, self.form(), FrfForm::Receptance);
        let derivatives = f64::from(self.kind.derivatives()) / frequency_hz;
        let slope = (x.slope / x.value - f.slope / f.value).re;
        (ratio.norm_sqr(), 2.0 * (slope - derivatives))
    }

    fn ripples(&self, period: f64) -> Ripples {
        let end = self.unfiltered.as_ref();
        let end = end.map(|(samples, rate)| UnfilteredEnd { samples, sample_rate_hz: *rate });
        Ripples::of(&self.samples, (self.sample_rate_hz, self.kind), end, period)
    }
}
