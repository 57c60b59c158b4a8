//! The table of a study as Parquet: one nullable column of numbers or texts for each of CSV's.
//!
//! The file's metadata has, as JSON, `asperity:identity`, from which the bytes follow, and
//! `asperity:columns`, a list of objects with `name`, `role` (input, observable, error or warnings)
//! and `unit`.

use std::io::{self, Write};
use std::sync::Arc;

use asperity_simulation::quantity::unit_of;
use asperity_table::unquoted;
use csv::StringRecord;
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};
use serde_json::{Value, json};

/// Most numbers of a row group, 32 MB.
const GROUP_NUMBERS: usize = 1 << 22;

/// Most rows of a row group.
const GROUP_ROWS: usize = 1 << 17;

/// Bytes of texts at which a row group ends.
const GROUP_TEXT: usize = 1 << 24;

/// Part of a column in a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// A number that the design gives.
    Input,
    /// A text that the design gives.
    TextInput,
    /// A number of the response.
    Observable,
    /// Reason of a failure.
    Error,
    /// Kinds of warnings.
    Warnings,
}

impl Role {
    pub(crate) const ALL: [Self; 5] =
        [Self::Input, Self::TextInput, Self::Observable, Self::Error, Self::Warnings];

    /// Its name in a manifest.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::TextInput => "text_input",
            Self::Observable => "observable",
            Self::Error => "error",
            Self::Warnings => "warnings",
        }
    }

    pub(super) fn is_number(self) -> bool {
        matches!(self, Self::Input | Self::Observable)
    }
}

/// A table that is being written, row group by row group.
pub(super) struct ParquetTable<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    columns: Vec<Values>,
    rows: usize,
    text: usize,
}

/// Values of a column in the present row group.
enum Values {
    Numbers(Nullable<f64>),
    Texts { values: Nullable<ByteArray>, keeps_empty: bool },
}

/// Values that are there, and a level for each row: 1 where there is one.
struct Nullable<T> {
    values: Vec<T>,
    levels: Vec<i16>,
}

impl<T> Nullable<T> {
    fn new() -> Self {
        Self { values: Vec::new(), levels: Vec::new() }
    }

    fn push(&mut self, value: Option<T>) {
        self.levels.push(value.is_some().into());
        self.values.extend(value);
    }

    fn write<D: DataType<T = T>, W: Write + Send>(
        &mut self,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        if let Some(mut column) = group.next_column()? {
            column.typed::<D>().write_batch(&self.values, Some(&self.levels), None)?;
            column.close()?;
        }
        self.values.clear();
        self.levels.clear();
        Ok(())
    }
}

impl<W: Write + Send> ParquetTable<W> {
    /// A table with these columns.
    pub(super) fn new(file: W, columns: &[(String, Role)], identity: &Value) -> io::Result<Self> {
        let describe = |(name, role): &(String, Role)| {
            let unit = unit_of(name);
            json!({ "name": name, "role": role.key(), "unit": unit })
        };
        let described: Value = columns.iter().map(describe).collect();
        let entry = |key: &str, value: &Value| KeyValue::new(key.to_owned(), value.to_string());
        let properties = WriterProperties::builder()
            .set_created_by(concat!("asperity ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(vec![
                entry("asperity:identity", identity),
                entry("asperity:columns", &described),
            ]))
            .build();
        let schema = schema(columns).map_err(io::Error::other)?;
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties))
            .map_err(io::Error::other)?;
        let values = |(_, role): &(String, Role)| match role {
            role if role.is_number() => Values::Numbers(Nullable::new()),
            role => {
                Values::Texts { values: Nullable::new(), keeps_empty: *role == Role::TextInput }
            }
        };
        Ok(Self { writer, columns: columns.iter().map(values).collect(), rows: 0, text: 0 })
    }

    /// Adds a row of CSV's.
    pub(super) fn push(&mut self, row: &StringRecord) -> io::Result<()> {
        for (column, field) in self.columns.iter_mut().zip(row) {
            match column {
                Values::Numbers(values) if field.is_empty() => values.push(None),
                Values::Numbers(values) => {
                    let number = field.parse::<f64>();
                    values.push(Some(number.map_err(|_| io::ErrorKind::InvalidData)?));
                }
                Values::Texts { values, keeps_empty } => {
                    let text = unquoted(field);
                    self.text += text.len();
                    let is_there = *keeps_empty || !text.is_empty();
                    values.push(is_there.then(|| ByteArray::from(text)));
                }
            }
        }
        self.rows += 1;
        let most = (GROUP_NUMBERS / self.columns.len().max(1)).clamp(1, GROUP_ROWS);
        if self.rows >= most || self.text >= GROUP_TEXT { self.end_group() } else { Ok(()) }
    }

    fn end_group(&mut self) -> io::Result<()> {
        if self.rows > 0 {
            self.write_group().map_err(io::Error::other)?;
        }
        (self.rows, self.text) = (0, 0);
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for column in &mut self.columns {
            match column {
                Values::Numbers(values) => values.write::<DoubleType, W>(&mut group)?,
                Values::Texts { values, .. } => values.write::<ByteArrayType, W>(&mut group)?,
            }
        }
        group.close()?;
        Ok(())
    }

    /// Ends the file.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.end_group()?;
        self.writer.close().map(|_| ()).map_err(io::Error::other)
    }
}

fn schema(columns: &[(String, Role)]) -> Result<TypePtr, ParquetError> {
    let field = |(name, role): &(String, Role)| {
        let builder = if role.is_number() {
            Type::primitive_type_builder(name, PhysicalType::DOUBLE)
        } else {
            Type::primitive_type_builder(name, PhysicalType::BYTE_ARRAY)
                .with_logical_type(Some(LogicalType::String))
        };
        builder.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("study").with_fields(fields).build().map(Arc::new)
}
