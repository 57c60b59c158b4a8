//! The class `Figure`.

use std::ffi::OsStr;
use std::path::PathBuf;

use asperity_figure::FigureError;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

/// Resolution of PNG, 300 dots per inch.
const PIXELS_PER_MM: f64 = 300.0 / 25.4;

/// Figure of a result, the same as the command writes. Notebooks show it.
///
/// Results have their figures as attributes.
#[pyclass(name = "Figure", module = "asperity", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct PyFigure(pub(crate) asperity_figure::Figure);

#[pymethods]
impl PyFigure {
    /// The figure as SVG text.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| self.0.to_svg())
    }

    /// The figure as PNG at 300 dots per inch.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.0.to_png(PIXELS_PER_MM)).map_err(|error| failed(&error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Write the figure to a file, which is replaced.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The name ends with ``.svg``, ``.pdf`` or ``.png``.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If it does not.
    /// OSError
    ///     If the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let ending = path.extension().and_then(OsStr::to_str).map(str::to_lowercase);
        let bytes = match ending.as_deref() {
            Some("svg") => py.detach(|| Ok(self.0.to_svg().into_bytes())),
            Some("pdf") => py.detach(|| self.0.to_pdf()),
            Some("png") => py.detach(|| self.0.to_png(PIXELS_PER_MM)),
            _ => {
                return Err(PyValueError::new_err(format!(
                    "{}: the format of a figure is the end of its name: .svg, .pdf or .png",
                    path.display()
                )));
            }
        };
        let bytes = bytes.map_err(|error| failed(&error))?;
        std::fs::write(&path, bytes)
            .map_err(|error| PyOSError::new_err(format!("{}: {error}", path.display())))
    }

    fn _repr_svg_(&self, py: Python<'_>) -> String {
        self.svg(py)
    }
}

/// Figures by their names.
pub(crate) fn by_name<'py>(
    py: Python<'py>,
    figures: Vec<(&'static str, asperity_figure::Figure)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, figure) in figures {
        dict.set_item(name, PyFigure(figure))?;
    }
    Ok(dict)
}

fn failed(error: &FigureError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}
