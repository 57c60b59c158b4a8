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
//! | `simulate` | one transient run |
//! | `background` | long calls: without the interpreter's lock, with progress, stopped by Ctrl-C |
//! | `columns` | columns of numbers as NumPy arrays |
//! | `json` | documents between Python and Rust |
//! | `exception` | errors as exceptions |

#![allow(clippy::doc_markdown, reason = "the documentation of classes and functions is Python's")]

mod background;
mod columns;
mod exception;
mod json;
mod scenario;
mod simulate;

/// Native part of the package `asperity`.
#[pyo3::pymodule]
mod _asperity {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::exception::{ComputationError, ScenarioError};
    #[pymodule_export]
    use crate::scenario::{PyScenario, restore_scenario};
    #[pymodule_export]
    use crate::simulate::simulate;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
