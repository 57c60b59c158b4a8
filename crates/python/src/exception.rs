//! Errors as Python exceptions.

use std::path::Path;

use asperity_experiment::AnalysisError;
use asperity_identify::IdentificationError;
use asperity_measure::MeasureError;
use asperity_scenario::{Diagnostic, DocumentError, InputError, InvalidDocument, SetError};
use asperity_signal::SignalError;
use asperity_simulation::error::SimulationError;
use asperity_study::StudyError;
use pyo3::create_exception;
use pyo3::exceptions::{
    PyException, PyFileExistsError, PyFileNotFoundError, PyIsADirectoryError, PyOSError,
    PyPermissionError, PyValueError,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

create_exception!(
    asperity,
    ScenarioError,
    PyValueError,
    "Fault of a scenario or another document.\n\n\
     `faults` has a dict for each fault, in the order of the text: `pointer` (JSON Pointer to the\n\
     value), `message`, `accepted` (the accepted values, in words) and `suggestion` (JSON text of\n\
     a value that may have been meant, or None). `pointer` and `accepted` are those of the first."
);
create_exception!(
    asperity,
    ComputationError,
    PyException,
    "Failure of a computation whose input is valid, such as a step that does not converge."
);

/// One fault of a document.
struct DocumentFault {
    pointer: String,
    message: String,
    accepted: Option<String>,
    suggestion: Option<String>,
}

impl From<&Diagnostic> for DocumentFault {
    fn from(diagnostic: &Diagnostic) -> Self {
        Self {
            pointer: diagnostic.pointer.clone(),
            message: diagnostic.fault.to_string(),
            accepted: Some(diagnostic.accepted.clone()),
            suggestion: diagnostic.suggestion.clone(),
        }
    }
}

/// ScenarioError with its attributes.
fn scenario_error(py: Python<'_>, message: String, faults: &[DocumentFault]) -> PyErr {
    let error = ScenarioError::new_err(message);
    let attributes = || -> PyResult<()> {
        let value = error.value(py);
        let mut dicts = Vec::with_capacity(faults.len());
        for fault in faults {
            let dict = PyDict::new(py);
            dict.set_item("pointer", &fault.pointer)?;
            dict.set_item("message", &fault.message)?;
            dict.set_item("accepted", &fault.accepted)?;
            dict.set_item("suggestion", &fault.suggestion)?;
            dicts.push(dict);
        }
        let first = faults.first();
        value.setattr("pointer", first.map_or("", |fault| &fault.pointer))?;
        value.setattr("accepted", first.and_then(|fault| fault.accepted.as_deref()))?;
        value.setattr("faults", dicts)
    };
    match attributes() {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// All faults of a document.
pub(crate) fn of_invalid(py: Python<'_>, invalid: &InvalidDocument) -> PyErr {
    of_faults(py, invalid.to_string(), invalid)
}

/// All faults of a document, with another message.
pub(crate) fn of_faults(py: Python<'_>, message: String, invalid: &InvalidDocument) -> PyErr {
    let faults: Vec<DocumentFault> = invalid.diagnostics.iter().map(Into::into).collect();
    scenario_error(py, message, &faults)
}

/// Error of a text that is not a document, or of its file.
pub(crate) fn of_document(py: Python<'_>, error: &DocumentError) -> PyErr {
    if let DocumentError::Input { path, source } = error {
        return of_input(path, *source);
    }
    let message = error.to_string();
    let (pointer, accepted, suggestion) = (String::new(), None, None);
    let fault = DocumentFault { pointer, message: message.clone(), accepted, suggestion };
    scenario_error(py, message, &[fault])
}

/// Error of one place of a document.
fn of_place(py: Python<'_>, pointer: String, message: String) -> PyErr {
    let (accepted, suggestion) = (None, None);
    let fault = DocumentFault { pointer, message: message.clone(), accepted, suggestion };
    scenario_error(py, message, &[fault])
}

/// Error of a value that cannot be set.
pub(crate) fn of_set(py: Python<'_>, message: String, error: &SetError) -> PyErr {
    let (accepted, suggestion) = match error {
        SetError::Missing { accepted, suggestion, .. } => {
            (Some(accepted.join(", ")), suggestion.clone())
        }
        _ => (None, None),
    };
    let pointer = match error {
        SetError::Missing { pointer, .. }
        | SetError::NotAContainer { pointer, .. }
        | SetError::Value { pointer, .. }
        | SetError::RepeatedKey { pointer, .. } => pointer.clone(),
        _ => String::new(),
    };
    let fault = DocumentFault { pointer, message: message.clone(), accepted, suggestion };
    scenario_error(py, message, &[fault])
}

/// Error of a file that cannot be opened.
fn of_input(path: &Path, error: InputError) -> PyErr {
    let message = format!("{}: {error}", path.display());
    match error {
        InputError::NotFound => PyFileNotFoundError::new_err(message),
        InputError::Directory => PyIsADirectoryError::new_err(message),
        InputError::NotPermitted => PyPermissionError::new_err(message),
        _ => PyOSError::new_err(message),
    }
}

/// Error of a number of threads that cannot be started.
pub(crate) fn no_threads(threads: Option<usize>) -> PyErr {
    let threads = threads.unwrap_or_default();
    PyValueError::new_err(format!("{threads} threads cannot be started; accepted: 1 to 1024"))
}

/// Error of a study: ValueError for a wrong request, else `ComputationError`.
pub(crate) fn of_study(py: Python<'_>, error: &SimulationError) -> PyErr {
    match error {
        SimulationError::Document(source) => of_document(py, source),
        SimulationError::Input { path, source } => of_input(path, *source),
        _ if error.is_wrong_request() => PyValueError::new_err(error.to_string()),
        _ => ComputationError::new_err(error.to_string()),
    }
}

/// Error of a study over a design, its files included.
pub(crate) fn of_design(py: Python<'_>, error: &StudyError) -> PyErr {
    let message = error.to_string();
    match error {
        StudyError::Document(source) => of_document(py, source),
        StudyError::Invalid(source) => of_invalid(py, source),
        StudyError::Study(source) => of_study(py, source),
        StudyError::Design { place, .. } | StudyError::Part { place, .. } => {
            of_place(py, place.clone(), message)
        }
        StudyError::Begun { .. } => {
            PyFileExistsError::new_err(format!("{message}: resume=True continues it"))
        }
        StudyError::Foreign { .. } => PyFileExistsError::new_err(message),
        StudyError::Io { source, .. } => of_io(source, message),
        _ if error.is_wrong_request() => PyValueError::new_err(message),
        _ => PyOSError::new_err(message),
    }
}

/// Error of measurements: OSError for a file that cannot be read, else ValueError.
pub(crate) fn of_measure(error: &MeasureError) -> PyErr {
    match error {
        MeasureError::Io { source, .. } => of_io(source, error.to_string()),
        MeasureError::Exists { .. } => {
            PyFileExistsError::new_err(format!("{error}; overwrite=True replaces it"))
        }
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// Error of an analysis: OSError for a file that cannot be read, ValueError for a wrong request, else
/// `ComputationError`.
pub(crate) fn of_analysis(error: &AnalysisError) -> PyErr {
    match error {
        AnalysisError::Measure(source) => of_measure(source),
        AnalysisError::Io { source, .. } => of_io(source, error.to_string()),
        AnalysisError::NoFiles { .. } => PyFileNotFoundError::new_err(error.to_string()),
        _ if error.is_wrong_request() => PyValueError::new_err(error.to_string()),
        _ => ComputationError::new_err(error.to_string()),
    }
}

/// Error of samples or options that are not valid.
pub(crate) fn of_signal(error: &SignalError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Error of an identification: that of its document, data or scenario; ValueError for a wrong request,
/// else `ComputationError`.
pub(crate) fn of_identification(py: Python<'_>, error: &IdentificationError) -> PyErr {
    match error {
        IdentificationError::Document(source) => of_document(py, source),
        IdentificationError::Invalid(source) => of_invalid(py, source),
        IdentificationError::Study(source) => of_study(py, source),
        IdentificationError::Analysis(source) => of_analysis(source),
        IdentificationError::Input { path, source } => of_input(path, *source),
        error if error.place().is_some() => {
            let place = error.place().unwrap_or_default().to_owned();
            of_place(py, place, error.to_string())
        }
        _ if error.is_wrong_request() => PyValueError::new_err(error.to_string()),
        _ => ComputationError::new_err(error.to_string()),
    }
}

/// OSError, of the class that fits the cause.
pub(crate) fn of_io(cause: &std::io::Error, message: String) -> PyErr {
    std::io::Error::new(cause.kind(), message).into()
}
