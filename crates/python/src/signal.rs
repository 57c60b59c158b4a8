//! The signal toolbox: single steps of an analysis, for arrays.
//!
//! Samples come as contiguous arrays of float64, which `asperity.signal` makes of anything else; they
//! are copied before the interpreter's lock is released, so that no other thread changes them.
//!
//! | module | holds |
//! |---|---|
//! | `hits` | hits of a record, force pulse, quality issues |
//! | `windows` | force, response and exponential windows |
//! | `frf` | averages, forms, the response of one hit |
//! | `damping` | circle fit, logarithmic decrement, backbones |

pub(crate) mod damping;
pub(crate) mod frf;
pub(crate) mod hits;
pub(crate) mod windows;

use asperity_signal::{Complex64, FrfForm, ResponseKind};
use numpy::{Element, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyComplex;

/// Samples of an array.
pub(crate) type Array<'py, T = f64> = PyReadonlyArray1<'py, T>;

/// A copy of the samples.
///
/// # Errors
/// For an array that is not contiguous.
pub(crate) fn copied<T: Element + Copy>(array: &Array<'_, T>) -> PyResult<Vec<T>> {
    Ok(array.as_slice()?.to_vec())
}

/// A complex number of Python.
pub(crate) fn complex(py: Python<'_>, value: Complex64) -> Bound<'_, PyComplex> {
    PyComplex::from_doubles(py, value.re, value.im)
}

/// The quantity of a response by its name.
pub(crate) fn response_kind(name: &str) -> PyResult<ResponseKind> {
    let all = [ResponseKind::Displacement, ResponseKind::Velocity, ResponseKind::Acceleration];
    let found = all.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| not_accepted("response", name, &all.map(ResponseKind::name)))
}

/// The form of a frequency response function by its name.
pub(crate) fn frf_form(name: &str) -> PyResult<FrfForm> {
    let found = FrfForm::ALL.into_iter().find(|form| form.name() == name);
    found.ok_or_else(|| not_accepted("form", name, &FrfForm::ALL.map(FrfForm::name)))
}

/// ValueError of a word that is not accepted.
pub(crate) fn not_accepted(option: &str, found: &str, accepted: &[&str]) -> PyErr {
    let accepted = accepted.join("\", \"");
    PyValueError::new_err(format!("{option} is {found:?}; accepted: \"{accepted}\""))
}
