//! The command `asperity`.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Carries out a command line, without the name of the program; returns its exit status.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let line = std::iter::once(OsString::from("asperity")).chain(arguments);
    py.detach(|| asperity_cli::run(line))
}
