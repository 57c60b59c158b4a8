//! Columns as a stream of the Arrow C data interface.
//!
//! Numbers stay in the memory of their NumPy arrays, which the stream keeps alive; truth values and
//! texts are copied.

use std::panic::AssertUnwindSafe;
use std::ptr::NonNull;
use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{ArrowPrimitiveType, Float64Type, Int64Type};
use arrow_array::{
    ArrayRef, BooleanArray, PrimitiveArray, RecordBatch, RecordBatchIterator, RecordBatchOptions,
    StringArray,
};
use arrow_buffer::{Buffer, ScalarBuffer};
use arrow_schema::{Field, Schema};
use numpy::{Element, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// Name that the interface prescribes for a capsule with a stream.
const STREAM: &std::ffi::CStr = c"arrow_array_stream";

/// Capsule with a stream of one batch: `(name, values)` for each column, the values a contiguous
/// array of float64, int64 or bool, or a list of str.
///
/// # Errors
/// TypeError for other values, ValueError for columns of unequal lengths.
#[pyfunction]
pub(crate) fn arrow_stream<'py>(
    py: Python<'py>,
    columns: Vec<(String, Bound<'py, PyAny>)>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let mut fields = Vec::with_capacity(columns.len());
    let mut arrays = Vec::with_capacity(columns.len());
    for (name, values) in &columns {
        let array = array(values)?;
        fields.push(Field::new(name, array.data_type().clone(), true));
        arrays.push(array);
    }
    let rows = arrays.first().map_or(0, |array| array.len());
    let schema = Arc::new(Schema::new(fields));
    let options = RecordBatchOptions::new().with_row_count(Some(rows));
    let batch = RecordBatch::try_new_with_options(Arc::clone(&schema), arrays, &options)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let batches = RecordBatchIterator::new([Ok(batch)], schema);
    PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), STREAM)
}

/// Arrow array of the values of a column.
fn array(values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    if let Ok(numbers) = values.cast::<PyArray1<f64>>() {
        return shared::<Float64Type>(numbers);
    }
    if let Ok(numbers) = values.cast::<PyArray1<i64>>() {
        return shared::<Int64Type>(numbers);
    }
    if let Ok(truths) = values.cast::<PyArray1<bool>>() {
        return Ok(Arc::new(BooleanArray::from(truths.to_vec()?)));
    }
    let texts: Vec<String> = values.extract().map_err(|_| {
        PyTypeError::new_err("accepted columns: arrays of float64, int64 or bool, lists of str")
    })?;
    Ok(Arc::new(StringArray::from(texts)))
}

/// Arrow array in the memory of a contiguous NumPy array.
fn shared<T>(numbers: &Bound<'_, PyArray1<T::Native>>) -> PyResult<ArrayRef>
where
    T: ArrowPrimitiveType,
    T::Native: Element,
{
    let length = numbers.len();
    let address = NonNull::new(numbers.data().cast::<u8>()).filter(|_| numbers.is_contiguous());
    let Some(address) = address.filter(|at| at.cast::<T::Native>().is_aligned()) else {
        return Err(PyValueError::new_err("the arrays of columns must be contiguous and aligned"));
    };
    // Pointers to Python's objects may be dropped on any thread.
    let owner = Arc::new(AssertUnwindSafe(numbers.clone().unbind()));
    #[expect(unsafe_code, reason = "memory of another owner")]
    // SAFETY: `address` is the start of `length` contiguous numbers, which live as long as `owner`
    // does: NumPy frees and resizes no memory of an array that something else refers to.
    let buffer =
        unsafe { Buffer::from_custom_allocation(address, length * size_of::<T::Native>(), owner) };
    Ok(Arc::new(PrimitiveArray::<T>::new(ScalarBuffer::new(buffer, 0, length), None)))
}
