//! First pass: headers and positions of the functions.

use std::sync::Arc;

use crate::notice::Notices;
use crate::source::{Position, Source, decode_text};
use crate::uff::binary::Payload;
use crate::uff::fields::text;
use crate::uff::header::FunctionHeader;
use crate::uff::system::System;
use crate::{FilePosition, MeasureError, Notice};

/// Functions of one record. Boxes keep growing vectors of large entries small, and their memory is
/// freed after a group is read.
#[allow(clippy::vec_box, reason = "see above")]
pub(crate) type Group = Vec<Box<FunctionEntry>>;

/// A function: its header and the position of its numbers.
#[derive(Debug)]
pub(crate) struct FunctionEntry {
    pub(crate) header: FunctionHeader,
    pub(crate) context: Arc<FileContext>,
    pub(crate) data: Data,
}

/// Position of the numbers.
#[derive(Debug)]
pub(crate) enum Data {
    Printed(Position),
    Binary(Payload),
}

/// Content of datasets 151 and 164 before a function.
#[derive(Debug, Clone, Default)]
pub(crate) struct FileContext {
    pub(crate) title: String,
    pub(crate) date: String,
    pub(crate) system: Option<System>,
}

/// Finds every function of the file.
pub(crate) fn index(source: &mut Source<'_>, notices: &mut Notices) -> Result<Group, MeasureError> {
    let mut entries = Vec::new();
    let mut context = Arc::new(FileContext::default());
    let mut line = Vec::new();
    loop {
        let place = source.place();
        if !source.read_line(&mut line)? {
            return Ok(entries);
        }
        match line.trim_ascii() {
            b"" => continue,
            b"-1" => {}
            _ => {
                notices.add(Notice::TextBetweenDatasets { place });
                continue;
            }
        }
        let place = source.place();
        if !source.read_line(&mut line)? {
            return Ok(entries);
        }
        let (kind, _) = decode_text(&line);
        let kind = kind.trim();
        let (dataset, rest) =
            kind.split_at(kind.find(|c: char| !c.is_ascii_digit()).unwrap_or(kind.len()));
        let binary = rest.strip_prefix(['b', 'B']);
        match dataset {
            "" => return Err(source.malformed(place, "a dataset's number", kind, "digits")),
            "58" => {
                let kind = kind.to_owned();
                let binary = binary.map(str::to_owned);
                let header = FunctionHeader::read(source, notices)?;
                let data = match binary {
                    Some(fields) => {
                        Data::Binary(Payload::locate(source, place, &fields, &header, notices)?)
                    }
                    None => printed(source, &mut line, &header)?,
                };
                if header.points == 0 {
                    let array = if header.name.is_empty() { kind } else { header.name };
                    notices.left_out(array, "it has no points");
                } else {
                    let context = Arc::clone(&context);
                    entries.push(Box::new(FunctionEntry { header, context, data }));
                }
            }
            "151" => {
                let lines = first_lines(source, &mut line, place)?;
                let stated = |index: usize| text(lines.get(index).map_or("", String::as_str));
                let title = [stated(0), stated(1)].into_iter().find(|line| !line.is_empty());
                let context = Arc::make_mut(&mut context);
                context.title = title.unwrap_or_default();
                context.date = text(lines.get(3).map_or("", |line| date_of(line)));
            }
            "164" => {
                let lines = first_lines(source, &mut line, place)?;
                let factors = lines.get(1..).unwrap_or_default().join(" ");
                Arc::make_mut(&mut context).system = Some(System::parse(source, place, &factors)?);
            }
            _ => {
                first_lines(source, &mut line, place)?;
            }
        }
    }
}

/// Date and time, the first two fields of ten columns.
fn date_of(line: &str) -> &str {
    let end = line.char_indices().nth(20).map_or(line.len(), |(index, _)| index);
    line[..end].trim()
}

/// Skips printed numbers, which are checked when they are read.
fn printed(
    source: &mut Source<'_>,
    line: &mut Vec<u8>,
    header: &FunctionHeader,
) -> Result<Data, MeasureError> {
    let (place, start) = (source.place(), source.mark());
    // Each value takes at least a digit and a blank.
    let values = header.points.saturating_mul(header.values_per_point());
    source.need(values.saturating_mul(2), "the numbers of the announced points")?;
    to_closing_tag(source, line, place, |_| ())?;
    Ok(Data::Printed(start))
}

/// The first lines of a dataset; reads up to its closing tag.
fn first_lines(
    source: &mut Source<'_>,
    line: &mut Vec<u8>,
    place: FilePosition,
) -> Result<Vec<String>, MeasureError> {
    const MOST: usize = 8;
    let mut lines = Vec::with_capacity(MOST);
    to_closing_tag(source, line, place, |line| {
        if lines.len() < MOST {
            lines.push(decode_text(line).0.into_owned());
        }
    })?;
    Ok(lines)
}

fn to_closing_tag(
    source: &mut Source<'_>,
    line: &mut Vec<u8>,
    place: FilePosition,
    mut each: impl FnMut(&[u8]),
) -> Result<(), MeasureError> {
    while source.read_line(line)? {
        if line.trim_ascii() == b"-1" {
            return Ok(());
        }
        each(line);
    }
    Err(source.malformed(place, "a dataset", "open at the end of the file", "a closing `    -1`"))
}
