//! Frequency response functions averaged over hits.

mod estimator;
mod statistics;

pub use estimator::{FrfEstimator, HvScaling};
pub use statistics::{Coherence, MagnitudeSpread};

use crate::error::{Result, SignalError, check_rate, check_samples};
use crate::form::{FrfForm, ResponseKind};
use crate::frf::{ForceMask, Frf};
use crate::response::FrequencyResponse;
use crate::spectrum::{PADDING_LIMIT, Spectrum};
use asperity_transform::{fast_length, inverse};
use num_complex::Complex64;
use statistics::RunningVariance;

/// Longest transform with one value a line; the spectra of an average take more than a gigabyte.
const TRANSFORM_LIMIT: usize = 1 << 25;

/// Spectra are summed at twice the lines: products of spectra are transforms of correlations, which
/// last twice as long as the records.
const OVERSAMPLING: usize = 2;

/// Scaling of a one-sided spectral density.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SpectralDensity {
    /// Energy density, unit^2 s / Hz, with the integral `integral x^2 dt` over frequency. For
    /// transients, since it does not depend on the length of the record.
    Energy,
    /// Power density, unit^2 / Hz, with the integral of the mean square
    /// over the nominal record length.
    Power,
}

/// The average of hits: auto and cross spectra, frequency response function and coherence.
///
/// With the transforms `F`, `X` of the hits (see [`Spectrum`]) and their mean `< >`,
///
/// ```text
/// Gff = 2 <|F|^2>,   Gxx = 2 <|X|^2>,   Gfx = 2 <conj(F) X>
/// ```
///
/// (not doubled at zero frequency and half the rate) are one-sided energy
/// densities. Memory is ten numbers a frequency for any number of hits. Signals are windowed
/// before, by [`ForceWindow`](crate::ForceWindow) and
/// [`ExponentialWindow`](crate::ExponentialWindow).
///
/// Source: J. S. Bendat and A. G. Piersol, *Random Data*, 4th ed., Wiley 2010,
/// chs. 5, 6 and 9, doi 10.1002/9781118032428.
///
/// ```
/// use asperity_signal::{FrfAverage, FrfEstimator, ResponseKind};
///
/// // Two hits on a spring of 1e6 N/m.
/// let mut average = FrfAverage::new(8, 1e4, ResponseKind::Displacement, 1)?;
/// for peak in [10.0, 20.0] {
///     let force = [0.0, peak, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
///     average.push(&force, &force.map(|f| 1e-6 * f))?;
/// }
/// for estimator in [FrfEstimator::H1, FrfEstimator::H2] {
///     assert!((average.frf(estimator)?.values[1].re - 1e-6).abs() < 1e-18);
/// }
/// assert!((average.coherence()?.values[1] - 1.0).abs() < 1e-12);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FrfAverage {
    kind: ResponseKind,
    sample_rate_hz: f64,
    samples: usize,
    /// Samples of a transform with one value a line.
    length: usize,
    averages: usize,
    /// Sums over hits of `|F|^2`, `|X|^2` and `conj(F) X`, at lines and between.
    force: Vec<f64>,
    response: Vec<f64>,
    cross: Vec<Complex64>,
    magnitude: RunningVariance,
}

/// Sums of an average over its hits, by which it is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct FrfSums {
    /// Number of hits.
    pub averages: usize,
    /// Sums of `|F|^2`, at the lines and between.
    pub force: Vec<f64>,
    /// Sums of `|X|^2`.
    pub response: Vec<f64>,
    /// Sums of `conj(F) X`.
    pub cross: Vec<Complex64>,
    /// Mean of `|X/F|`, and sum of the squared deviations from it, at the lines.
    pub magnitude: [Vec<f64>; 2],
}

impl FrfAverage {
    /// An empty average.
    ///
    /// - `samples`: nominal length of a record, positive.
    /// - `padding`: zero padding, 1 (none) to 1024; the transform has
    ///   [`fast_length`]`(padding * samples)` samples, at most about `2^26`.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::Padding`], [`SignalError::SampleRate`], [`SignalError::TooLong`].
    pub fn new(
        samples: usize,
        sample_rate_hz: f64,
        kind: ResponseKind,
        padding: usize,
    ) -> Result<Self> {
        check_rate(sample_rate_hz)?;
        if samples == 0 {
            return Err(SignalError::Empty { signal: "record to average" });
        }
        if !(1..=PADDING_LIMIT).contains(&padding) {
            return Err(SignalError::Padding { value: padding, limit: PADDING_LIMIT });
        }
        let limit = TRANSFORM_LIMIT / padding;
        if samples > limit {
            return Err(SignalError::TooLong { samples, limit });
        }
        let length = fast_length(samples * padding);
        let bins = OVERSAMPLING * length / 2 + 1;
        Ok(Self {
            kind,
            sample_rate_hz,
            samples,
            length,
            averages: 0,
            force: vec![0.0; bins],
            response: vec![0.0; bins],
            cross: vec![Complex64::ZERO; bins],
            magnitude: RunningVariance::new(length / 2 + 1),
        })
    }

    /// The sums over the hits so far.
    pub fn sums(&self) -> FrfSums {
        FrfSums {
            averages: self.averages,
            force: self.force.clone(),
            response: self.response.clone(),
            cross: self.cross.clone(),
            magnitude: self.magnitude.clone().into_parts(),
        }
    }

    /// An average of the same settings with other [`sums`](Self::sums).
    ///
    /// # Errors
    /// [`SignalError::LengthMismatch`] for those of an average of another length.
    pub fn with_sums(self, sums: FrfSums) -> Result<Self> {
        let lengths = [sums.force.len(), sums.response.len(), sums.cross.len()];
        let bins = self.force.len();
        if let Some(&other) = lengths.iter().find(|length| **length != bins) {
            return Err(SignalError::LengthMismatch { force: bins, response: other });
        }
        let lines = self.length / 2 + 1;
        if let Some(other) = sums.magnitude.iter().find(|values| values.len() != lines) {
            return Err(SignalError::LengthMismatch { force: lines, response: other.len() });
        }
        let FrfSums { averages, force, response, cross, magnitude } = sums;
        let magnitude = RunningVariance::from_parts(magnitude);
        Ok(Self { averages, force, response, cross, magnitude, ..self })
    }

    /// Adds a hit and returns its own frequency response function `X/F`.
    ///
    /// Receptance from displacement, mobility from velocity, accelerance from acceleration; not
    /// finite where the transform of the force is zero. A record shorter than the
    /// nominal length is padded with zeros.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::LengthMismatch`],
    /// [`SignalError::TooLong`], [`SignalError::NoForce`]; the hit is then not added.
    pub fn push(&mut self, force: &[f64], response: &[f64]) -> Result<Frf> {
        check_samples("force", force)?;
        check_samples("response", response)?;
        if force.len() != response.len() {
            return Err(SignalError::LengthMismatch {
                force: force.len(),
                response: response.len(),
            });
        }
        if force.len() > self.samples {
            return Err(SignalError::TooLong { samples: force.len(), limit: self.samples });
        }
        if force.iter().all(|x| *x == 0.0) {
            return Err(SignalError::NoForce { samples: force.len() });
        }
        let length = OVERSAMPLING * self.length;
        let transform = |x| Spectrum::padded_to(x, self.sample_rate_hz, length).into_values();
        let (force, response) = (transform(force), transform(response));
        self.averages += 1;
        let mut values = Vec::with_capacity(self.length / 2 + 1);
        for (k, (f, x)) in force.iter().zip(&response).enumerate() {
            self.force[k] += f.norm_sqr();
            self.response[k] += x.norm_sqr();
            self.cross[k] += f.conj() * x;
            if k % OVERSAMPLING == 0 {
                let ratio = x / f;
                self.magnitude.push(values.len(), ratio.norm(), self.averages);
                values.push(ratio);
            }
        }
        Ok(Frf { frequency_hz: self.frequency_hz(), values, form: self.form() })
    }

    /// Adds the hits of another average, so that hits can be transformed in parallel. The sums agree
    /// with those of [`FrfAverage::push`] to rounding.
    ///
    /// # Errors
    /// [`SignalError::TooLong`] where the lengths of the transforms differ, and
    /// [`SignalError::SampleRate`] where the rates do; nothing is then added.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if other.length != self.length {
            return Err(SignalError::TooLong { samples: other.samples, limit: self.samples });
        }
        if other.sample_rate_hz != self.sample_rate_hz {
            return Err(SignalError::SampleRate { value: other.sample_rate_hz });
        }
        if other.averages == 0 {
            return Ok(());
        }
        let add = |sums: &mut [f64], more: &[f64]| {
            sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        };
        add(&mut self.force, &other.force);
        add(&mut self.response, &other.response);
        self.cross.iter_mut().zip(&other.cross).for_each(|(sum, more)| *sum += more);
        self.magnitude.merge(self.averages, &other.magnitude, other.averages);
        self.averages += other.averages;
        Ok(())
    }

    /// Hits averaged so far.
    pub fn averages(&self) -> usize {
        self.averages
    }

    /// Frequencies of every result, zero to half the sample rate, in hertz.
    pub fn frequency_hz(&self) -> Vec<f64> {
        let step = self.sample_rate_hz / self.length as f64;
        (0..=self.length / 2).map(|k| k as f64 * step).collect()
    }

    /// The sums of `|F|^2`, `|X|^2` and `conj(F) X` at the lines.
    fn lines(&self) -> impl Iterator<Item = (f64, f64, Complex64)> {
        let all = self.force.iter().zip(&self.response).zip(&self.cross);
        all.step_by(OVERSAMPLING).map(|((f, x), c)| (*f, *x, *c))
    }

    /// Sums over the hits at the lines within limits (Hz): frequency in hertz, `|F|^2` in N^2 s^2,
    /// `|X|^2` and `conj(F) X` in the unit of the response.
    pub fn sums_within(
        &self,
        (low_hz, high_hz): (f64, f64),
    ) -> impl Iterator<Item = (f64, f64, f64, Complex64)> {
        let step = self.sample_rate_hz / self.length as f64;
        let at = move |(k, (force, response, cross)): (usize, (f64, f64, Complex64))| {
            (k as f64 * step, force, response, cross)
        };
        let inside = move |line: &(f64, f64, f64, Complex64)| (low_hz..=high_hz).contains(&line.0);
        self.lines().enumerate().map(at).filter(inside)
    }

    /// Auto spectrum of the force `Gff`, in N^2 s / Hz or N^2 / Hz.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] without a hit.
    pub fn force_auto(&self, density: SpectralDensity) -> Result<Vec<f64>> {
        let scale = self.scale("auto spectrum", density)?;
        Ok(self.lines().enumerate().map(|(k, (force, ..))| force * scale(k)).collect())
    }

    /// Auto spectrum of the response `Gxx`.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] without a hit.
    pub fn response_auto(&self, density: SpectralDensity) -> Result<Vec<f64>> {
        let scale = self.scale("auto spectrum", density)?;
        Ok(self.lines().enumerate().map(|(k, (_, response, _))| response * scale(k)).collect())
    }

    /// Cross spectrum `Gfx`, with the phase of the response relative to the force.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] without a hit.
    pub fn cross(&self, density: SpectralDensity) -> Result<Vec<Complex64>> {
        let scale = self.scale("cross spectrum", density)?;
        Ok(self.lines().enumerate().map(|(k, (.., cross))| cross * scale(k)).collect())
    }

    /// The averaged frequency response function; other forms by [`Frf::to`].
    ///
    /// Receptance from displacement, mobility from velocity, accelerance from acceleration. Not
    /// finite where the transform of the force is zero.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] without a hit, [`SignalError::Option`] for a noise
    /// ratio that is not positive.
    pub fn frf(&self, estimator: FrfEstimator) -> Result<Frf> {
        self.need("frequency response function", 1)?;
        estimator.check()?;
        let values = self.lines().map(|(f, x, c)| estimator.value(f, x, c)).collect();
        Ok(Frf { frequency_hz: self.frequency_hz(), values, form: self.form() })
    }

    /// A force and a response of one hit with the averaged frequency response function, at every
    /// frequency: peaks and damping are found in it as in the functions of hits.
    ///
    /// They are the mean autocorrelation of the forces, and the transform of `H Gff`; with H1 the
    /// mean cross correlation, so that the function is exact between the lines. Of one hit it is
    /// the function of the hit with each estimator.
    ///
    /// # Errors
    /// Those of [`FrfAverage::frf`], and [`SignalError::NotFinite`] where the function is not finite.
    pub fn response(&self, estimator: FrfEstimator) -> Result<FrequencyResponse> {
        self.need("frequency response function", 1)?;
        estimator.check()?;
        let all = self.force.iter().zip(&self.response).zip(&self.cross);
        let cross = all.map(|((&f, &x), &c)| {
            let is_zero = f == 0.0 || c == Complex64::ZERO;
            if is_zero { Complex64::ZERO } else { estimator.value(f, x, c) * f }
        });
        let correlation = |spectrum: Vec<Complex64>| {
            let mut samples = inverse(spectrum, OVERSAMPLING * self.length);
            // No delay in the middle.
            samples.rotate_right(self.length);
            samples
        };
        let response = correlation(cross.collect());
        let force = correlation(self.force.iter().map(|&f| f.into()).collect());
        let found = FrequencyResponse::new(&force, &response, self.sample_rate_hz, self.kind)?;
        Ok(found.interpolated())
    }

    /// Ordinary coherence and the random errors that follow from it.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] for fewer than two hits, since the coherence of one is 1.
    pub fn coherence(&self) -> Result<Coherence> {
        self.need("coherence", 2)?;
        let values = self.lines().map(|(f, x, c)| c.norm_sqr() / (f * x)).collect();
        Ok(Coherence { frequency_hz: self.frequency_hz(), values, averages: self.averages })
    }

    /// Mean and standard deviation of `|X/F|` over the hits, at each frequency.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] for fewer than two hits.
    pub fn spread(&self) -> Result<MagnitudeSpread> {
        self.need("spread", 2)?;
        Ok(self.magnitude.spread(self.frequency_hz(), self.averages))
    }

    /// The frequencies at which the averaged force `sqrt(<|F|^2>)` has at least `threshold` of its
    /// largest value.
    ///
    /// # Errors
    /// [`SignalError::TooFewAverages`] without a hit.
    pub fn force_mask(&self, threshold: f64) -> Result<ForceMask> {
        self.need("force mask", 1)?;
        let averages = self.averages as f64;
        let magnitude: Vec<f64> =
            self.lines().map(|(force, ..)| (force / averages).sqrt()).collect();
        Ok(ForceMask::new(self.frequency_hz(), &magnitude, threshold))
    }

    fn form(&self) -> FrfForm {
        self.kind.form()
    }

    /// Factors from sums to one-sided densities, not doubled at zero and half the rate.
    fn scale(
        &self,
        quantity: &'static str,
        density: SpectralDensity,
    ) -> Result<impl Fn(usize) -> f64> {
        self.need(quantity, 1)?;
        let over = match density {
            SpectralDensity::Energy => self.averages as f64,
            SpectralDensity::Power => {
                self.averages as f64 * self.samples as f64 / self.sample_rate_hz
            }
        };
        let last = self.length / 2;
        Ok(move |k| if k == 0 || k == last { 1.0 / over } else { 2.0 / over })
    }

    fn need(&self, quantity: &'static str, needed: usize) -> Result<()> {
        if self.averages >= needed {
            Ok(())
        } else {
            Err(SignalError::TooFewAverages { quantity, averages: self.averages, needed })
        }
    }
}
