//! Averages of frequency response functions, their forms, and the response of one hit.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Mutex, MutexGuard, PoisonError};

use asperity_signal::{
    Complex64, FrequencyResponse, Frf, FrfAverage, FrfEstimator, FrfSums, HarmonicOptions,
    HvScaling, Peak, ResponseKind, SpectralDensity, circle_fit, dominant_frequency, find_harmonics,
    half_power_crossings,
};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyComplex, PyDict};

use super::damping::circle_to_dict;
use super::{Array, complex, copied, frf_form, not_accepted, response_kind};
use crate::exception;

/// Function in another form.
#[pyfunction]
pub(crate) fn convert_frf<'py>(
    py: Python<'py>,
    frequency_hz: Array<'py>,
    values: Array<'py, Complex64>,
    form: &str,
    to: &str,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let frf = Frf {
        frequency_hz: copied(&frequency_hz)?,
        values: copied(&values)?,
        form: frf_form(form)?,
    };
    if frf.frequency_hz.len() != frf.values.len() {
        return Err(PyValueError::new_err(format!(
            "{} frequencies but {} values; the numbers must be equal",
            frf.frequency_hz.len(),
            frf.values.len()
        )));
    }
    Ok(PyArray1::from_vec(py, frf.to(frf_form(to)?).values))
}

fn estimator(name: &str, noise_ratio: Option<f64>) -> PyResult<FrfEstimator> {
    match name {
        "h1" => Ok(FrfEstimator::H1),
        "h2" => Ok(FrfEstimator::H2),
        "hv" => {
            Ok(FrfEstimator::Hv(noise_ratio.map_or(HvScaling::EqualRatios, HvScaling::NoiseRatio)))
        }
        other => Err(not_accepted("estimator", other, &["h1", "h2", "hv"])),
    }
}

/// Number of hits, auto spectra, cross spectrum, mean magnitude and sum of its squared deviations.
type Sums<'py> = (
    usize,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<Complex64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// An average of hits.
#[pyclass(name = "FrfAverage", module = "asperity._asperity", frozen)]
pub(crate) struct PyFrfAverage {
    average: Mutex<FrfAverage>,
    kind: ResponseKind,
}

impl PyFrfAverage {
    fn average(&self) -> MutexGuard<'_, FrfAverage> {
        self.average.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Result of a computation without the interpreter's lock.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut FrfAverage) -> Result<T, asperity_signal::SignalError> + Send,
    ) -> PyResult<T> {
        py.detach(|| work(&mut self.average())).map_err(|error| exception::of_signal(&error))
    }
}

#[pymethods]
impl PyFrfAverage {
    #[new]
    fn new(samples: usize, sample_rate_hz: f64, response: &str, padding: usize) -> PyResult<Self> {
        let kind = response_kind(response)?;
        let average = FrfAverage::new(samples, sample_rate_hz, kind, padding)
            .map_err(|error| exception::of_signal(&error))?;
        Ok(Self { average: Mutex::new(average), kind })
    }

    fn push<'py>(
        &self,
        py: Python<'py>,
        force: Array<'py>,
        response: Array<'py>,
    ) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
        let (force, response) = (copied(&force)?, copied(&response)?);
        let frf = self.with(py, move |average| average.push(&force, &response))?;
        Ok(PyArray1::from_vec(py, frf.values))
    }

    /// The sums: number of hits, auto spectra and cross spectrum, mean magnitude and its squares.
    fn sums<'py>(&self, py: Python<'py>) -> Sums<'py> {
        let sums = py.detach(|| self.average().sums());
        let [mean, square] = sums.magnitude.map(|values| PyArray1::from_vec(py, values));
        (
            sums.averages,
            PyArray1::from_vec(py, sums.force),
            PyArray1::from_vec(py, sums.response),
            PyArray1::from_vec(py, sums.cross),
            mean,
            square,
        )
    }

    /// Takes the place of the sums.
    fn restore(
        &self,
        averages: usize,
        force: Array<'_>,
        response: Array<'_>,
        cross: Array<'_, Complex64>,
        mean: Array<'_>,
        square: Array<'_>,
    ) -> PyResult<()> {
        let sums = FrfSums {
            averages,
            force: copied(&force)?,
            response: copied(&response)?,
            cross: copied(&cross)?,
            magnitude: [copied(&mean)?, copied(&square)?],
        };
        let mut average = self.average();
        *average = average.clone().with_sums(sums).map_err(|error| exception::of_signal(&error))?;
        Ok(())
    }

    #[getter]
    fn averages(&self, py: Python<'_>) -> usize {
        py.detach(|| self.average().averages())
    }

    #[getter]
    fn form(&self) -> &'static str {
        self.kind.form().name()
    }

    #[getter]
    fn frequency_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let frequencies = py.detach(|| self.average().frequency_hz());
        PyArray1::from_vec(py, frequencies)
    }

    #[pyo3(signature = (name, noise_ratio))]
    fn frf<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        noise_ratio: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
        let estimator = estimator(name, noise_ratio)?;
        let frf = self.with(py, move |average| average.frf(estimator))?;
        Ok(PyArray1::from_vec(py, frf.values))
    }

    #[pyo3(signature = (name, noise_ratio))]
    fn response(
        &self,
        py: Python<'_>,
        name: &str,
        noise_ratio: Option<f64>,
    ) -> PyResult<PyFrequencyResponse> {
        let estimator = estimator(name, noise_ratio)?;
        let response = self.with(py, move |average| average.response(estimator))?;
        Ok(PyFrequencyResponse { response })
    }

    /// Coherence, and the random errors of magnitude (relative) and phase \[rad\].
    fn coherence<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<f64>>; 3]> {
        let found = self.with(py, |average| average.coherence())?;
        let (magnitude, phase) = (found.magnitude_error(), found.phase_error());
        Ok([found.values, magnitude, phase].map(|values| PyArray1::from_vec(py, values)))
    }

    /// Mean and standard deviation of the magnitude over the hits.
    fn spread<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
        let found = self.with(py, |average| average.spread())?;
        Ok([found.mean, found.standard_deviation].map(|values| PyArray1::from_vec(py, values)))
    }

    fn force_mask<'py>(
        &self,
        py: Python<'py>,
        threshold: f64,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let mask = self.with(py, move |average| average.force_mask(threshold))?;
        Ok(PyArray1::from_vec(py, mask.valid))
    }

    /// Auto spectra of force and response, and their cross spectrum.
    #[expect(clippy::type_complexity, reason = "a tuple of arrays")]
    fn spectra<'py>(
        &self,
        py: Python<'py>,
        density: &str,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<Complex64>>,
    )> {
        let density = match density {
            "energy" => SpectralDensity::Energy,
            "power" => SpectralDensity::Power,
            other => return Err(not_accepted("density", other, &["energy", "power"])),
        };
        let (force, response, cross) = self.with(py, move |average| {
            Ok((
                average.force_auto(density)?,
                average.response_auto(density)?,
                average.cross(density)?,
            ))
        })?;
        let of = |values| PyArray1::from_vec(py, values);
        Ok((of(force), of(response), PyArray1::from_vec(py, cross)))
    }
}

/// Force and response of one hit.
#[pyclass(name = "FrequencyResponse", module = "asperity._asperity", frozen)]
pub(crate) struct PyFrequencyResponse {
    response: FrequencyResponse,
}

/// A maximum of a receptance.
#[pyclass(name = "Peak", module = "asperity.signal", frozen)]
pub(crate) struct PyPeak {
    peak: Peak,
}

#[pymethods]
impl PyPeak {
    /// Frequency [Hz].
    #[getter]
    fn frequency_hz(&self) -> f64 {
        self.peak.frequency_hz
    }

    /// Magnitude of the receptance [m/N].
    #[getter]
    fn magnitude(&self) -> f64 {
        self.peak.magnitude
    }

    /// Receptance [m/N].
    #[getter]
    fn value<'py>(&self, py: Python<'py>) -> Bound<'py, PyComplex> {
        complex(py, self.peak.value)
    }

    /// Height above the higher minimum beside it, over its magnitude.
    #[getter]
    fn prominence(&self) -> f64 {
        self.peak.prominence
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().peak == self.peak)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.peak.frequency_hz.to_bits().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, PeakParts)> {
        let restore = slf.py().import("asperity._asperity")?.getattr("restore_peak")?;
        let Peak { frequency_hz, magnitude, value, prominence } = slf.get().peak;
        Ok((restore, (frequency_hz, magnitude, value.re, value.im, prominence)))
    }

    fn __repr__(&self) -> String {
        let Peak { frequency_hz, magnitude, .. } = self.peak;
        format!("<asperity.signal.Peak at {frequency_hz} Hz: {magnitude} m/N>")
    }
}

/// Frequency, magnitude, real and imaginary part, prominence.
type PeakParts = (f64, f64, f64, f64, f64);

/// The peak of a pickle.
#[pyfunction]
pub(crate) fn restore_peak(
    frequency_hz: f64,
    magnitude: f64,
    real: f64,
    imag: f64,
    prominence: f64,
) -> PyPeak {
    let value = Complex64::new(real, imag);
    PyPeak { peak: Peak { frequency_hz, magnitude, value, prominence } }
}

#[pymethods]
impl PyFrequencyResponse {
    /// Force and response, and whether their transforms are interpolated.
    fn parts<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, bool) {
        let array = |values| PyArray1::from_slice(py, values);
        let response = &self.response;
        (array(response.force()), array(response.samples()), response.is_interpolated())
    }

    /// The same with interpolated transforms.
    fn interpolated(&self, py: Python<'_>) -> Self {
        Self { response: py.detach(|| self.response.clone().interpolated()) }
    }

    #[new]
    fn new(
        py: Python<'_>,
        force: Array<'_>,
        response: Array<'_>,
        sample_rate_hz: f64,
        kind: &str,
    ) -> PyResult<Self> {
        let (force, response) = (copied(&force)?, copied(&response)?);
        let kind = response_kind(kind)?;
        let new = match kind {
            ResponseKind::Displacement => FrequencyResponse::from_displacement,
            ResponseKind::Velocity => FrequencyResponse::from_velocity,
            ResponseKind::Acceleration => FrequencyResponse::from_acceleration,
        };
        let response = py.detach(|| new(&force, &response, sample_rate_hz));
        Ok(Self { response: response.map_err(|error| exception::of_signal(&error))? })
    }

    /// Receptances at frequencies.
    fn receptance_at<'py>(
        &self,
        py: Python<'py>,
        frequency_hz: Array<'py>,
    ) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
        let frequencies = copied(&frequency_hz)?;
        let values = py.detach(|| {
            frequencies.iter().map(|frequency| self.response.receptance_at(*frequency)).collect()
        });
        Ok(PyArray1::from_vec(py, values))
    }

    /// Frequency \[Hz\] of the largest peak in a band, in a form; None without one.
    fn dominant_frequency(
        &self,
        py: Python<'_>,
        band_hz: (f64, f64),
        form: &str,
        force_threshold: f64,
    ) -> PyResult<Option<f64>> {
        let form = frf_form(form)?;
        Ok(py.detach(|| dominant_frequency(&self.response, band_hz, form, force_threshold)))
    }

    /// Fundamental, second harmonic, and frequencies of masked maxima.
    fn find_harmonics<'py>(
        &self,
        py: Python<'py>,
        near_hz: f64,
        fundamental_window: (f64, f64),
        second_window: (f64, f64),
        force_threshold: f64,
    ) -> (Option<PyPeak>, Option<PyPeak>, Bound<'py, PyArray1<f64>>) {
        let options = HarmonicOptions {
            fundamental_window,
            second_window,
            force_threshold,
            ..HarmonicOptions::default()
        };
        let found = py.detach(|| find_harmonics(&self.response, near_hz, &options));
        let peak = |peak: Option<Peak>| peak.map(|peak| PyPeak { peak });
        (peak(found.fundamental), peak(found.second), PyArray1::from_vec(py, found.masked_hz))
    }

    /// Damping ratio and the two half-power frequencies \[Hz\] of a peak; None without them.
    fn half_power(&self, py: Python<'_>, peak: &Bound<'_, PyPeak>) -> Option<(f64, f64, f64)> {
        let peak = peak.get().peak;
        let found = py.detach(|| half_power_crossings(&self.response, &peak))?;
        Some((found.ratio(), found.lower_hz, found.upper_hz))
    }

    /// Circle fit of a peak as a dict; None without one.
    fn circle_fit<'py>(
        &self,
        py: Python<'py>,
        peak: &Bound<'py, PyPeak>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let peak = peak.get().peak;
        let fit = py.detach(|| circle_fit(&self.response, &peak));
        fit.map(|fit| circle_to_dict(py, &fit)).transpose()
    }
}
