//! Documents between Python and Rust, as JSON text: both sides write the shortest decimals that
//! read back to the same bits.

use std::path::PathBuf;

use asperity_scenario::Document;
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde::Serialize;

use crate::exception;

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

/// The document of a path, a text (which starts with `{`) or a dict. In messages a text and a dict have
/// the name `kind`; file names in them start from `folder`.
///
/// # Errors
/// TypeError for anything else, with what is `accepted`; those of the document and its file.
pub(crate) fn document_of(
    source: &Bound<'_, PyAny>,
    folder: Option<PathBuf>,
    kind: &str,
    accepted: &str,
) -> PyResult<Document> {
    let name = folder.unwrap_or_default().join(kind);
    let document = if source.is_instance_of::<PyDict>() {
        Document::parse(&text_of(source)?, name)
    } else if let Ok(text) = source.cast::<PyString>()
        && text.to_cow()?.trim_start_matches('\u{feff}').trim_start().starts_with('{')
    {
        Document::parse(&text.to_cow()?, name)
    } else if let Ok(path) = source.extract::<PathBuf>() {
        Document::read(path)
    } else {
        return Err(PyTypeError::new_err(format!(
            "a {kind} cannot be of the type {}; accepted: {accepted}",
            source.get_type().name()?
        )));
    };
    document.map_err(|error| exception::of_document(source.py(), &error))
}
