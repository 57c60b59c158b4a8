//! Named columns of numbers, and the one CSV text of the workspace.
//!
//! A [`Table`] holds columns of numbers, a [`DataTable`] also integers, truth values and texts;
//! [`CsvWriter`] writes any rows. All write a number `x` as the shortest decimal that reads back to
//! the same bits, and leave the field empty where `x` is not finite, as JSON writes `null` there.
//!
//! ```
//! use asperity_table::Table;
//! let table = Table::new()
//!     .with_column("frequency_hz", [1.0, 2.0])?
//!     .with_column("receptance_m_per_n", [1.5e-7, f64::NAN])?;
//! assert_eq!(table.to_csv(), "frequency_hz,receptance_m_per_n\n1,1.5e-7\n2,\n");
//! # Ok::<(), asperity_table::TableError>(())
//! ```
//!
//! A text that a spreadsheet would run as a formula gets an apostrophe before it ([`quoted`]).
//!
//! | module | holds |
//! |---|---|
//! | `data_table` | [`DataTable`], [`ColumnData`]: columns of several types |
//! | `table` | [`Table`], [`Column`], [`TableError`] |
//! | `csv` | [`CsvWriter`], and [`columns_to_csv`] for borrowed columns |

mod csv;
mod data_table;
mod table;

pub use csv::{CsvWriter, Decimal, columns_to_csv, quoted, unquoted};
pub use data_table::{ColumnData, DataTable};
pub use table::{Column, Table, TableError};
