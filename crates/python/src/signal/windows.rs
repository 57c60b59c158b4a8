//! Windows on force and response, and their corrections.

use asperity_signal::{Complex64, ExponentialWindow, ForceWindow, ResponseWindow};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::{Array, copied, not_accepted, response_kind};
use crate::exception;

/// The force in a window of (begin, end, taper) \[s\].
#[pyfunction]
pub(crate) fn force_window<'py>(
    py: Python<'py>,
    force: Array<'py>,
    sample_rate_hz: f64,
    window: (f64, f64, f64),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (begin_s, end_s, taper_s) = window;
    let mut force = copied(&force)?;
    py.detach(|| ForceWindow { begin_s, end_s, taper_s }.apply(&mut force, sample_rate_hz, None));
    Ok(PyArray1::from_vec(py, force))
}

/// The response in a window of (end, taper) \[s\].
#[pyfunction]
pub(crate) fn response_window<'py>(
    py: Python<'py>,
    response: Array<'py>,
    sample_rate_hz: f64,
    window: (f64, f64),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (end_s, taper_s) = window;
    let mut response = copied(&response)?;
    py.detach(|| ResponseWindow { end_s, taper_s }.apply(&mut response, sample_rate_hz));
    Ok(PyArray1::from_vec(py, response))
}

/// End and taper \[s\] of the window at whose end the response is noise; None without such an end.
#[pyfunction]
pub(crate) fn until_noise(
    py: Python<'_>,
    response: Array<'_>,
    sample_rate_hz: f64,
    frequency_hz: f64,
    noise_density: f64,
) -> PyResult<Option<(f64, f64)>> {
    let response = copied(&response)?;
    let window = py.detach(|| {
        ResponseWindow::until_noise(&response, sample_rate_hz, frequency_hz, noise_density)
    });
    Ok(window.map(|window| (window.end_s, window.taper_s)))
}

/// The samples in an exponential window that is one at sample `origin`.
#[pyfunction]
pub(crate) fn exponential_window<'py>(
    py: Python<'py>,
    samples: Array<'py>,
    sample_rate_hz: f64,
    tau_s: f64,
    origin: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let window = exponential(tau_s)?;
    let mut samples = copied(&samples)?;
    py.detach(|| window.apply(&mut samples, sample_rate_hz, origin));
    Ok(PyArray1::from_vec(py, samples))
}

/// Time constant \[s\] of a window that falls to a fraction after a time.
#[pyfunction]
pub(crate) fn exponential_falling_to(fraction: f64, after_s: f64) -> PyResult<f64> {
    let window = ExponentialWindow::falling_to(fraction, after_s);
    Ok(window.map_err(|error| exception::of_signal(&error))?.tau_s())
}

/// A quantity of a mode without the window; `value` is that of a peak.
#[pyfunction]
pub(crate) fn exponential_corrected(
    quantity: &str,
    tau_s: f64,
    natural_hz: f64,
    ratio: f64,
    value: f64,
) -> PyResult<f64> {
    let window = exponential(tau_s)?;
    Ok(match quantity {
        "damping_ratio" => window.corrected_damping(natural_hz, ratio),
        "natural_frequency_hz" => window.corrected_natural_frequency(natural_hz, ratio),
        "peak_frequency_hz" => window.corrected_peak_frequency(natural_hz, ratio, value),
        "peak_magnitude" => window.corrected_peak(natural_hz, ratio, value),
        other => return Err(not_accepted("quantity", other, &["damping_ratio"])),
    })
}

/// Receptances on the line of the window.
#[pyfunction]
pub(crate) fn exponential_receptance<'py>(
    py: Python<'py>,
    frequency_hz: Array<'py>,
    receptance: Array<'py, Complex64>,
    response: &str,
    tau_s: f64,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let (window, kind) = (exponential(tau_s)?, response_kind(response)?);
    let lines = copied(&frequency_hz)?.into_iter().zip(copied(&receptance)?);
    let values =
        lines.map(|(frequency, value)| window.corrected_receptance(frequency, value, kind));
    Ok(PyArray1::from_vec(py, values.collect()))
}

fn exponential(tau_s: f64) -> PyResult<ExponentialWindow> {
    ExponentialWindow::new(tau_s).map_err(|error| exception::of_signal(&error))
}
