//! The native part of the Python package `asperity`.
//!
//! Scenarios enter as paths, texts or dicts, results leave as dicts and NumPy arrays:
//!
//! ```text
//! path, text, dict -> Document -> Scenario -> study -> arrays under the column names of the files
//! ```
//!
//! The functions here return plain dicts and arrays; the Python modules beside them
//! (`python/asperity`) are the public interface, with its classes and documentation.
//!
//! | module | holds |
//! |---|---|
//! | `scenario` | the class `Scenario` |
//! | `law` | the class `Law`, laws of a scenario, fits |
//! | `simulate`, `sweep`, `steady` | one transient run; many; steady responses and modes |
//! | `figure` | the class `Figure` |
//! | `background` | long calls: without the interpreter's lock, with progress, stopped by Ctrl-C |
//! | `columns`, `arrow` | columns as NumPy arrays, and as a stream of the Arrow C data interface |
//! | `json` | documents between Python and Rust |
//! | `exception` | errors as exceptions |

#![allow(clippy::doc_markdown, reason = "the documentation of classes and functions is Python's")]

mod arrow;
mod background;
mod columns;
mod exception;
mod figure;
mod json;
mod law;
mod scenario;
mod simulate;
mod steady;
mod sweep;

/// Native part of the package `asperity`.
#[pyo3::pymodule]
mod _asperity {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::arrow::arrow_stream;
    #[pymodule_export]
    use crate::exception::{ComputationError, ScenarioError};
    #[pymodule_export]
    use crate::figure::PyFigure;
    #[pymodule_export]
    use crate::law::{PyLaw, fit_power, laws, restore_law, tabulate};
    #[pymodule_export]
    use crate::scenario::{PyScenario, restore_scenario};
    #[pymodule_export]
    use crate::simulate::simulate;
    #[pymodule_export]
    use crate::steady::{modes, steady};
    #[pymodule_export]
    use crate::sweep::{sweep, sweep_rows};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
