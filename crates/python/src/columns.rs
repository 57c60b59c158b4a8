//! Named columns of results as a dict of NumPy arrays and lists.

use asperity_table::{ColumnData, DataTable};
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

/// Dict of the columns of a table: arrays of float64, int64 and bool, lists of str. Truth values that
/// are not known everywhere are the numbers 1, 0 and NaN.
pub(crate) fn of_table(py: Python<'_>, table: DataTable) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, data) in table.into_columns() {
        match data {
            ColumnData::Numbers(values) => dict.set_item(name, PyArray1::from_vec(py, values))?,
            ColumnData::Integers(values) => dict.set_item(name, PyArray1::from_vec(py, values))?,
            ColumnData::Truths(values) | ColumnData::Flags(values) => {
                dict.set_item(name, PyArray1::from_vec(py, values))?;
            }
            ColumnData::PartialTruths(values) => {
                let number = |value: Option<bool>| value.map_or(f64::NAN, f64::from);
                let numbers = values.into_iter().map(number).collect();
                dict.set_item(name, PyArray1::from_vec(py, numbers))?;
            }
            ColumnData::Texts(values) => dict.set_item(name, values)?,
            other => {
                let text = format!("a column of the kind {other:?}");
                return Err(pyo3::exceptions::PyNotImplementedError::new_err(text));
            }
        }
    }
    Ok(dict)
}
