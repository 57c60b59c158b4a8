//! Damping from a circle, from the decrement and along a decay.

use asperity_signal::{
    BackboneOptions, BandPass, CircleFit, Complex64, backbone as backbone_of, circle_fit_of,
    decay_length as length_of, logarithmic_decrement as decrement_of,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Array, complex, copied, response_kind};
use crate::exception;

/// A circle fit as a dict.
pub(crate) fn circle_to_dict<'py>(
    py: Python<'py>,
    fit: &CircleFit,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("natural_frequency_hz", fit.natural_hz)?;
    dict.set_item("damping_ratio", fit.ratio)?;
    dict.set_item("modal_constant_per_kg", complex(py, fit.modal_constant))?;
    dict.set_item("centre", complex(py, fit.centre))?;
    dict.set_item("radius", fit.radius)?;
    dict.set_item("scatter", fit.scatter)?;
    dict.set_item("angle_scatter_rad", fit.angle_scatter)?;
    dict.set_item("arc_rad", fit.arc)?;
    Ok(dict)
}

/// Circle fit of mobilities as a dict; None for points that are not on a circle.
#[pyfunction]
pub(crate) fn circle_fit<'py>(
    py: Python<'py>,
    frequency_hz: Array<'py>,
    mobility: Array<'py, Complex64>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let (frequencies, mobility) = (copied(&frequency_hz)?, copied(&mobility)?);
    let fit = py.detach(|| circle_fit_of(&frequencies, &mobility));
    fit.map(|fit| circle_to_dict(py, &fit)).transpose()
}

/// Logarithmic decrement of a decay as a dict; None without one.
#[pyfunction]
pub(crate) fn logarithmic_decrement<'py>(
    py: Python<'py>,
    samples: Array<'py>,
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let samples = copied(&samples)?;
    let found = py.detach(|| decrement_of(&samples, sample_rate_hz, frequency_hz));
    let Some(found) = found else { return Ok(None) };
    let dict = PyDict::new(py);
    dict.set_item("damping_ratio", found.ratio)?;
    dict.set_item("decrement", found.decrement)?;
    dict.set_item("frequency_hz", found.frequency_hz)?;
    dict.set_item("cycles", found.cycles)?;
    dict.set_item("scatter", found.scatter)?;
    Ok(Some(dict))
}

/// Backbone of a decay in a band (low, high, edge) \[Hz\], as a dict of columns.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub(crate) fn backbone<'py>(
    py: Python<'py>,
    decay: Array<'py>,
    sample_rate_hz: f64,
    band: (f64, f64, f64),
    cycles: f64,
    edge_level: f64,
    noise_density: f64,
    noise_factor: f64,
    response: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let derivatives = response_kind(response)?.derivatives();
    let (low_hz, high_hz, edge_hz) = band;
    let band =
        BandPass::new(low_hz, high_hz, edge_hz).map_err(|error| exception::of_signal(&error))?;
    let options = BackboneOptions {
        band,
        cycles,
        edge_level,
        noise_density,
        noise_factor,
        floor: 0.0,
        derivatives,
    };
    let decay = copied(&decay)?;
    let found = py.detach(|| backbone_of(&decay, sample_rate_hz, &options));
    let points = found.map_err(|error| exception::of_signal(&error))?.points;
    let dict = PyDict::new(py);
    let set = |name: &str, value: fn(&asperity_signal::BackbonePoint) -> f64| {
        dict.set_item(name, PyArray1::from_iter(py, points.iter().map(value)))
    };
    set("time_s", |point| point.time_s)?;
    set("amplitude", |point| point.amplitude)?;
    set("frequency_hz", |point| point.frequency_hz)?;
    set("decay_rate_per_s", |point| point.decay_rate)?;
    set("damping_ratio", |point| point.damping_ratio)?;
    Ok(dict)
}

/// Number of samples in which a decay falls to about 2 % of its start.
#[pyfunction]
pub(crate) fn decay_length(samples: Array<'_>) -> PyResult<usize> {
    Ok(length_of(&copied(&samples)?))
}
