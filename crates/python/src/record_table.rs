//! Tables of records as dicts.

use asperity_table::{ColumnValues, RecordTable};
use numpy::PyArray1;
use pyo3::exceptions::PyNotImplementedError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Dict of the columns in their order: arrays of numbers, counts and flags, lists of texts.
pub(crate) fn to_dict(py: Python<'_>, table: RecordTable) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, values) in table.into_columns() {
        match values {
            ColumnValues::Numbers(values) => dict.set_item(name, PyArray1::from_vec(py, values))?,
            ColumnValues::Counts(values) => {
                let values = values.into_iter().map(|count| count as i64).collect();
                dict.set_item(name, PyArray1::<i64>::from_vec(py, values))?;
            }
            ColumnValues::Flags(values) => dict.set_item(name, PyArray1::from_vec(py, values))?,
            ColumnValues::Texts(values) => dict.set_item(name, values)?,
            _ => return Err(PyNotImplementedError::new_err(format!("type of column {name}"))),
        }
    }
    Ok(dict)
}
