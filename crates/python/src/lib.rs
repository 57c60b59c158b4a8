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
//! | `study` | studies over designs |
//! | `measurement` | channels in arrays as records, and back |
//! | `analyse` | analyses of hits and of free decays |
//! | `identify` | identification of laws |
//! | `signal` | single steps of an analysis |
//! | `explore` | the live page of a scenario |
//! | `figure` | the class `Figure` |
//! | `background` | long calls: without the interpreter's lock, with progress, stopped by Ctrl-C |
//! | `columns`, `arrow` | columns as NumPy arrays, and as a stream of the Arrow C data interface |
//! | `json` | documents between Python and Rust |
//! | `exception` | errors as exceptions |

#![allow(clippy::doc_markdown, reason = "the documentation of classes and functions is Python's")]
#![allow(clippy::needless_pass_by_value, reason = "arguments of Python's functions are owned")]

mod analyse;
mod arrow;
mod background;
mod columns;
mod exception;
mod explore;
mod figure;
mod identify;
mod json;
mod law;
mod measurement;
mod scenario;
mod signal;
mod simulate;
mod steady;
mod study;
mod sweep;

use std::ffi::OsString;

/// Carries out a command line of `asperity`, without the name of the program; returns its exit status.
#[pyo3::pyfunction]
fn command(py: pyo3::Python<'_>, arguments: Vec<OsString>) -> u8 {
    let line = std::iter::once(OsString::from("asperity")).chain(arguments);
    py.detach(|| asperity_cli::run(line))
}

/// Native part of the package `asperity`.
#[pyo3::pymodule]
mod _asperity {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use crate::analyse::{analyse, decay};
    #[pymodule_export]
    use crate::arrow::arrow_stream;
    #[pymodule_export]
    use crate::exception::{ComputationError, ScenarioError};
    #[pymodule_export]
    use crate::explore::PyLivePage;
    #[pymodule_export]
    use crate::figure::{PyFigure, feature_name, palette, restore_figure};
    #[pymodule_export]
    use crate::identify::identify;
    #[pymodule_export]
    use crate::law::{PyLaw, fit_power, laws, restore_law, tabulate};
    #[pymodule_export]
    use crate::measurement::{even_rate, read, write};
    #[pymodule_export]
    use crate::scenario::{PyScenario, restore_scenario};
    #[pymodule_export]
    use crate::signal::damping::{backbone, circle_fit, decay_length, logarithmic_decrement};
    #[pymodule_export]
    use crate::signal::frf::{
        PyFrequencyResponse, PyFrfAverage, PyPeak, convert_frf, restore_peak,
    };
    #[pymodule_export]
    use crate::signal::hits::{find_hits, pulse, quality_issues};
    #[pymodule_export]
    use crate::signal::windows::{
        exponential_corrected, exponential_falling_to, exponential_receptance, exponential_window,
        force_window, response_window, until_noise,
    };
    #[pymodule_export]
    use crate::simulate::simulate;
    #[pymodule_export]
    use crate::steady::{modes, steady};
    #[pymodule_export]
    use crate::study::study;
    #[pymodule_export]
    use crate::sweep::{sweep, sweep_rows};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::background::imported();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
