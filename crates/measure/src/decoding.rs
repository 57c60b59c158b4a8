//! Decoding of a file: its records, and the memory that they may take.

use crate::notice::Notices;
use crate::source::Source;
use crate::{FilePosition, Format, MeasureError, ReadOptions, Record};

/// The records of a format, one after the other.
pub(crate) trait Records: Send {
    /// The format.
    fn format(&self) -> Format;

    /// The next record; none at the end.
    fn next_record(&mut self, notices: &mut Notices) -> Result<Option<Record>, MeasureError>;
}

/// Records decoded at once.
pub(crate) struct DecodedRecords {
    format: Format,
    records: std::vec::IntoIter<Record>,
}

impl DecodedRecords {
    pub(crate) fn new(format: Format, records: Vec<Record>) -> Self {
        Self { format, records: records.into_iter() }
    }
}

impl Records for DecodedRecords {
    fn format(&self) -> Format {
        self.format
    }

    fn next_record(&mut self, _: &mut Notices) -> Result<Option<Record>, MeasureError> {
        Ok(self.records.next())
    }
}

/// Limit of the memory of decoding.
pub(crate) struct Budget {
    file: String,
    limit: u64,
    taken: u64,
}

impl Budget {
    pub(crate) fn new(source: &Source<'_>, options: &ReadOptions) -> Self {
        let limit = source.len().saturating_mul(options.expansion).max(1 << 20);
        Self { file: source.name().to_owned(), limit, taken: 0 }
    }

    /// Accounts for `bytes`, or rejects them.
    pub(crate) fn take(
        &mut self,
        bytes: u64,
        place: FilePosition,
        quantity: &'static str,
    ) -> Result<(), MeasureError> {
        self.taken = self.taken.saturating_add(bytes);
        if self.taken <= self.limit {
            return Ok(());
        }
        Err(MeasureError::TooLarge {
            file: self.file.clone(),
            place,
            quantity,
            announced: self.taken,
            limit: self.limit,
        })
    }
}
