//! Faults of Parquet files in words.

use std::panic::{AssertUnwindSafe, catch_unwind};

use parquet::errors::ParquetError;

/// Words for an error of reading.
pub(crate) fn words(error: ParquetError) -> String {
    match error {
        ParquetError::NYI(text) => format!("{text}; accepted: Snappy or no compression"),
        other => format!("cannot be read as Parquet: {other}"),
    }
}

/// Panics of the crate `parquet`, which asserts what a damaged file may break, as errors.
pub(crate) fn guarded<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("is damaged".into()))
}
