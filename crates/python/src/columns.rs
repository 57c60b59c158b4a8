//! Named columns of numbers as a dict of NumPy arrays.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Dict of the columns in their order; an array takes over the memory of its column.
pub(crate) fn to_dict<N: AsRef<str>>(
    py: Python<'_>,
    columns: impl IntoIterator<Item = (N, Vec<f64>)>,
) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, values) in columns {
        dict.set_item(name.as_ref(), PyArray1::from_vec(py, values))?;
    }
    Ok(dict)
}
