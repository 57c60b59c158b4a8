//! The class `Figure`.

use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use asperity_figure::{CATEGORIES, Color, FigureError, svg_to_pdf, svg_to_png};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::exception;

/// Resolution of PNG, 300 dots per inch.
const PIXELS_PER_MM: f64 = 300.0 / 25.4;

/// Figure of a result, the same as the command writes. Notebooks show it.
///
/// Results have their figures as attributes.
#[pyclass(name = "Figure", module = "asperity", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct PyFigure(Content);

/// A figure, or the text of one from a pickle.
#[derive(Debug, Clone)]
enum Content {
    Drawn(Box<asperity_figure::Figure>),
    Svg(String),
}

impl From<asperity_figure::Figure> for PyFigure {
    fn from(figure: asperity_figure::Figure) -> Self {
        Self(Content::Drawn(Box::new(figure)))
    }
}

impl PyFigure {
    fn text(&self) -> String {
        match &self.0 {
            Content::Drawn(figure) => figure.to_svg(),
            Content::Svg(text) => text.clone(),
        }
    }

    fn bytes_of_png(&self) -> Result<Vec<u8>, FigureError> {
        match &self.0 {
            Content::Drawn(figure) => figure.to_png(PIXELS_PER_MM),
            Content::Svg(text) => svg_to_png(text, PIXELS_PER_MM),
        }
    }

    fn bytes_of_pdf(&self) -> Result<Vec<u8>, FigureError> {
        match &self.0 {
            Content::Drawn(figure) => figure.to_pdf(),
            Content::Svg(text) => svg_to_pdf(text),
        }
    }
}

#[pymethods]
impl PyFigure {
    /// The figure as SVG text.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| self.text())
    }

    /// The figure as PNG at 300 dots per inch.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.bytes_of_png()).map_err(|error| failed(&error))?;
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
            Some("svg") => py.detach(|| Ok(self.text().into_bytes())),
            Some("pdf") => py.detach(|| self.bytes_of_pdf()),
            Some("png") => py.detach(|| self.bytes_of_png()),
            _ => {
                return Err(PyValueError::new_err(format!(
                    "{}: the format of a figure is the end of its name: .svg, .pdf or .png",
                    path.display()
                )));
            }
        };
        let bytes = bytes.map_err(|error| failed(&error))?;
        std::fs::write(&path, bytes)
            .map_err(|error| exception::of_io(&error, format!("{}: {error}", path.display())))
    }

    fn _repr_svg_(&self, py: Python<'_>) -> String {
        self.svg(py)
    }

    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> bool {
        let other = other.cast::<Self>();
        other.is_ok_and(|other| other.get().svg(py) == self.svg(py))
    }

    fn __hash__(&self, py: Python<'_>) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.svg(py).hash(&mut hasher);
        hasher.finish()
    }

    /// Pickles and copies are made from the SVG text, of which PDF and PNG are made too.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let restore = slf.py().import("asperity._asperity")?.getattr("restore_figure")?;
        Ok((restore, (slf.get().svg(slf.py()),)))
    }
}

/// The figure of an SVG text.
#[pyfunction]
pub(crate) fn restore_figure(svg: String) -> PyFigure {
    PyFigure(Content::Svg(svg))
}

/// Figures by their names.
pub(crate) fn by_name<'py>(
    py: Python<'py>,
    figures: Vec<(&'static str, asperity_figure::Figure)>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, figure) in figures {
        dict.set_item(name, PyFigure::from(figure))?;
    }
    Ok(dict)
}

fn failed(error: &FigureError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

/// Colours of the figures: of lines of different kinds, in their order, and `count` from dark to light.
#[pyfunction]
pub(crate) fn palette(count: usize) -> (Vec<String>, Vec<String>) {
    let kinds = CATEGORIES.iter().map(Color::to_string).collect();
    (kinds, (0..count).map(|index| Color::ramp_step(index, count).to_string()).collect())
}

/// Label and unit of a feature; the label has subscripts such as `f_{1}`.
#[pyfunction]
pub(crate) fn feature_name(feature: &str) -> (String, &'static str) {
    asperity_plot::feature_name(feature)
}
