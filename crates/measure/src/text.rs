//! Columns of numbers as text: CSV, TXT and LabVIEW measurement files.
//!
//! Delimiter and decimal mark are those with the longest run of rows of numbers in the first
//! 64 KiB; the lines above the run are names and units.
//!
//! | module | contents |
//! |---|---|
//! | `dialect` | delimiter, decimal mark, first row of numbers |
//! | `header_rows` | names and units above the numbers |
//! | `labview` | headers of `.lvm` files |
//! | `column_sets` | channels with a time column of their own |
//! | `axis` | time column and sample rate |
//! | `rows` | numbers |
//! | `write` | writing |

mod axis;
mod column_sets;
mod dialect;
mod header_rows;
mod labview;
mod rows;
mod write;

use crate::arrays::check_channels;
use crate::decoding::Records;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    Channel, ChannelQuantity, FilePosition, Format, MeasureError, Notice, ReadOptions, Record,
};

use axis::AxisFinder;
use column_sets::ColumnSet;
use dialect::{Dialect, is_passed_over};
use labview::{FileHeader, HeaderAxis, LvmSegment};
use rows::{NumberColumn, RowBlock, RowReader};
pub(crate) use write::{even_throughout, heading, write};

/// A text of numbers being read.
pub(crate) struct Text<'a> {
    reader: RowReader<'a>,
    labview: Option<FileHeader>,
    segment: LvmSegment,
    /// Columns of the current segment with a common axis; none before its first block.
    sets: Vec<ColumnSet>,
    /// Rows of the current segment read so far.
    rows: u64,
    rate_of_options: Option<f64>,
}

impl<'a> Text<'a> {
    pub(crate) fn open(
        mut source: Source<'a>,
        options: &ReadOptions,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let mut start = vec![0; 1 << 16];
        let length = source.peek(&mut start)?;
        start.truncate(length);
        let mut text = Self {
            reader: RowReader {
                source,
                dialect: Dialect { delimiter: b'\t', decimal: b'.' },
                is_labview: false,
                columns: Vec::new(),
                line: Vec::new(),
                block: options.block,
                invalid_cells: options.invalid_cells,
                invalid: None,
                ended: None,
            },
            labview: None,
            segment: LvmSegment::default(),
            sets: Vec::new(),
            rows: 0,
            rate_of_options: options.sample_rate_hz,
        };
        if start.starts_with(labview::MARK) {
            let header = FileHeader::read(&mut text.reader.source)?;
            text.reader.dialect = header.dialect;
            text.reader.is_labview = true;
            text.labview = Some(header);
            text.next_segment()?;
        } else {
            text.sniff(&start, notices)?;
        }
        Ok(text)
    }

    /// Finds dialect and headings and moves to the first row.
    fn sniff(&mut self, start: &[u8], notices: &mut Notices) -> Result<(), MeasureError> {
        let mark: &[u8] = b"\xef\xbb\xbf";
        let body = start.strip_prefix(mark).unwrap_or(start);
        let lines: Vec<&[u8]> = body.split(|byte| *byte == b'\n').collect();
        // The last line is complete at the end of the file only.
        let whole = if self.reader.source.len() > start.len() as u64 {
            lines.len() - 1
        } else {
            lines.len()
        };
        let lines = &lines[..whole];
        let Some((dialect, run)) = Dialect::sniff(lines) else {
            let file = self.reader.source.name().to_owned();
            return Err(MeasureError::NoSamples { file, expected: "rows of numbers" });
        };
        self.reader.dialect = dialect;
        let headings = header_rows::headings(lines, dialect, run);
        let (file, place) = (self.reader.source.name(), FilePosition::Line(run.start as u64 + 1));
        header_rows::check_decimal_comma(file, place, lines, dialect, run)?;
        if let Some((line, rows)) = dialect.rows_above(&lines[..run.start], run) {
            notices.add(Notice::RowsAboveHeadings { line: line + 1, rows });
        }
        if let Some(line) =
            lines[..run.start].iter().position(|line| std::str::from_utf8(line).is_err())
        {
            notices.add(Notice::Latin1 { place: FilePosition::Line(line as u64 + 1) });
        }
        check_channels(&self.reader.source, run.fields as u64)?;
        let rows = lines[run.start..].iter().filter(|line| !is_passed_over(line)).take(run.lines);
        let mut filled = vec![false; run.fields];
        for row in rows {
            for (field, filled) in dialect.fields(row).zip(&mut filled) {
                *filled |= !field.is_empty();
            }
        }
        self.reader.columns = (0..run.fields)
            .filter(|&index| filled[index])
            .map(|index| NumberColumn { index, heading: headings.get(index).cloned().flatten() })
            .collect();
        let is_time = |column: &&NumberColumn| {
            let heading = column.heading.as_ref();
            heading.is_some_and(|heading| heading.quantity() == ChannelQuantity::Time)
        };
        if self.reader.columns.iter().filter(is_time).count() > 1 {
            self.reader.ended = Some(vec![false; self.reader.columns.len()]);
        }
        let before: usize = lines[..run.start].iter().map(|line| line.len() + 1).sum();
        let offset = start.len() - body.len() + before;
        self.reader.source.skip_to_line(run.start as u64, offset as u64)
    }

    /// The next segment of a LabVIEW file; false at its end.
    fn next_segment(&mut self) -> Result<bool, MeasureError> {
        let Some(header) = &self.labview else { return Ok(false) };
        let (has_abscissa, in_pairs) = (header.has_abscissa, header.many_abscissae);
        let segment =
            LvmSegment::read(&mut self.reader.source, &mut self.reader.line, self.reader.dialect)?;
        let Some(segment) = segment else { return Ok(false) };
        let last = segment.names.len() - usize::from(segment.names.len() > 1);
        let commented = segment.names.last().is_some_and(|name| name == "Comment");
        let names = &segment.names[..if commented { last } else { segment.names.len() }];
        check_channels(&self.reader.source, names.len() as u64)?;
        let heading = |(index, name): (usize, &String)| {
            let mut heading = Heading::parse(name);
            // The line of units has no abscissa.
            if let Some(unit) = index.checked_sub(1).and_then(|place| segment.units.get(place)) {
                heading.unit = crate::ChannelUnit::of_text(unit);
            }
            // Every other column is an abscissa, whatever its name.
            if in_pairs && index.is_multiple_of(2) {
                "X_Value".clone_into(&mut heading.name);
            }
            NumberColumn { index, heading: Some(heading) }
        };
        let skipped = usize::from(!has_abscissa);
        self.reader.columns = names.iter().enumerate().skip(skipped).map(heading).collect();
        self.segment = segment;
        self.sets.clear();
        self.rows = 0;
        Ok(true)
    }

    fn channels(
        &mut self,
        rows: RowBlock,
        notices: &mut Notices,
    ) -> Result<Vec<Channel>, MeasureError> {
        let RowBlock { mut values, roundings, .. } = rows;
        if self.sets.is_empty() {
            self.sets = self.column_sets(&values, &roundings, notices)?;
        }
        let mut sets = std::mem::take(&mut self.sets);
        let mut channels = Vec::with_capacity(values.len());
        for set in &mut sets {
            channels.extend(self.channels_of(set, &mut values, &roundings, notices)?);
        }
        self.sets = sets;
        channels.sort_by_key(|(index, _)| *index);
        Ok(channels.into_iter().map(|(_, channel)| channel).collect())
    }

    fn has_pairs(&self) -> bool {
        self.labview.as_ref().is_some_and(|header| header.many_abscissae)
    }

    fn finder<'f>(&'f self, columns: &'f [NumberColumn], header: &'f HeaderAxis) -> AxisFinder<'f> {
        AxisFinder {
            file: self.reader.source.name(),
            columns,
            header,
            labview: self.labview.is_some(),
            rate_of_options: self.rate_of_options,
        }
    }
}

impl Records for Text<'_> {
    fn format(&self) -> Format {
        Format::Text
    }

    fn next_record(&mut self, notices: &mut Notices) -> Result<Option<Record>, MeasureError> {
        loop {
            // Which columns are times shows in the first block.
            let columns = if self.sets.is_empty() { self.reader.columns.len() } else { 0 };
            let tracked: Vec<usize> = (0..columns).collect();
            let rows = self.reader.read(&tracked, notices)?;
            if rows.count > 0 {
                let count = rows.count as u64;
                let channels = self.channels(rows, notices)?;
                let continues = self.rows > 0;
                self.rows += count;
                let (title, date) = self
                    .labview
                    .as_ref()
                    .map(|header| (header.description.clone(), header.date.clone()))
                    .unwrap_or_default();
                return Ok(Some(Record { channels, continues, title, date }));
            }
            if self.labview.is_none() || !self.next_segment()? {
                return Ok(None);
            }
        }
    }
}
