//! The class `Scenario`.

use std::path::PathBuf;

use asperity_scenario::{Document, Scenario};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::{exception, json};

/// A valid scenario: one computation as a document.
///
/// Parameters
/// ----------
/// source : str, os.PathLike, dict or Scenario
///     Path of a JSON file, JSON text (which starts with ``{``), or the document as a dict.
/// folder : str or os.PathLike, optional
///     Folder that relative file names in a text or a dict start from; the current one by default.
///
/// Raises
/// ------
/// TypeError
///     If `source` is none of these.
/// ScenarioError
///     With all faults of the document.
/// OSError
///     If the file cannot be read.
///
/// Examples
/// --------
/// >>> scenario = Scenario("rig.json")                         # doctest: +SKIP
/// >>> stronger = scenario.with_({"/excitation/peak_n": 20})   # doctest: +SKIP
#[pyclass(name = "Scenario", module = "asperity", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct PyScenario {
    pub(crate) document: Document,
    pub(crate) scenario: Scenario,
}

impl PyScenario {
    /// The checked scenario of `document`.
    fn checked(py: Python<'_>, document: Document) -> PyResult<Self> {
        let scenario = py
            .detach(|| document.scenario())
            .map_err(|invalid| exception::of_invalid(py, &invalid))?;
        Ok(Self { document, scenario })
    }

    /// The scenario of anything that the constructor accepts.
    pub(crate) fn of(source: &Bound<'_, PyAny>, folder: Option<PathBuf>) -> PyResult<Self> {
        if let Ok(scenario) = source.cast::<Self>() {
            return Ok(scenario.get().clone());
        }
        let accepted = "a path, JSON text, a dict or a Scenario";
        Self::checked(source.py(), json::document_of(source, folder, "scenario", accepted)?)
    }
}

#[pymethods]
impl PyScenario {
    #[new]
    #[pyo3(signature = (source, *, folder = None))]
    fn new(source: &Bound<'_, PyAny>, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::of(source, folder)
    }

    /// The same scenario with other values.
    ///
    /// Parameters
    /// ----------
    /// values : dict
    ///     Values by JSON Pointer (RFC 6901), such as ``{"/excitation/peak_n": 20}``. They are set
    ///     in their order, and the whole is checked then.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     If a pointer is not a str, or a value cannot be in a document.
    /// ScenarioError
    ///     If a pointer leads nowhere, or the result is not valid.
    fn with_(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let py = values.py();
        let mut document = self.document.clone();
        for (pointer, value) in values {
            let pointer = pointer.cast::<PyString>().map_err(|_| {
                PyTypeError::new_err("the keys of the values are JSON Pointers, as str")
            })?;
            let (pointer, text) = (pointer.to_cow()?, json::text_of(&value)?);
            document
                .set(&pointer, &text)
                .map_err(|error| exception::of_set(py, error.to_string(), &error))?;
        }
        Self::checked(py, document)
    }

    /// The document as a dict, without the defaults.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::to_python(py, self.document.value())
    }

    /// Title, or None.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.scenario.title.as_deref()
    }

    /// SHA-256 of the document, as results state it.
    #[getter]
    fn sha256(&self) -> String {
        self.document.sha256()
    }

    fn __repr__(&self) -> String {
        let names = |count: usize, noun: &str| {
            format!("{count} {noun}{}", if count == 1 { "y" } else { "ies" })
        };
        let title = self.scenario.title.as_deref().unwrap_or("untitled");
        let bodies = names(self.scenario.bodies.len(), "bod");
        let contacts = self.scenario.interfaces.len();
        format!(
            "<asperity.Scenario {title:?}: {bodies}, {contacts} interface{}>",
            match contacts {
                1 => "",
                _ => "s",
            }
        )
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let other = other.cast::<Self>();
        other.is_ok_and(|other| other.get().document.value() == self.document.value())
    }

    /// Pickles and copies are made from the document and its folder.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let restore = slf.py().import("asperity._asperity")?.getattr("restore_scenario")?;
        let document = &slf.get().document;
        Ok((restore, (document.value().to_string(), document.path().to_owned())))
    }
}

/// The scenario of a text whose file has this path.
#[pyfunction]
pub(crate) fn restore_scenario(py: Python<'_>, text: &str, path: PathBuf) -> PyResult<PyScenario> {
    let document = Document::parse(text, path);
    PyScenario::checked(py, document.map_err(|error| exception::of_document(py, &error))?)
}
