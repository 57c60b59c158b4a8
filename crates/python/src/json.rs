//! Documents between Python and Rust, as JSON text: both sides write the shortest decimals that
//! read back to the same bits.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde::Serialize;

/// JSON text of a Python value: dicts, lists, text, numbers, truth values, None, and the numbers
/// and arrays of NumPy.
///
/// # Errors
/// TypeError or ValueError for anything else, and for numbers that are not finite.
pub(crate) fn text_of(value: &Bound<'_, PyAny>) -> PyResult<String> {
    value.py().import("asperity._json")?.call_method1("text_of", (value,))?.extract()
}

/// Python value of a serialised document: dicts, lists, text, numbers, truth values, None.
///
/// # Errors
/// RuntimeError for a value that cannot be serialised.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text =
        serde_json::to_string(value).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
