//! Names and units from the lines above the numbers of a text.

use super::dialect::{Dialect, NumberRun, words};
use crate::heading::{Heading, are_units};
use crate::{ChannelUnit, FilePosition, MeasureError};

/// Heading of each column: one row; a row of names and one of units; a comment with as many words as
/// columns; or rows that begin with what they hold, such as `Point Id`, `X Unit` and `Y Unit`.
pub(crate) fn headings(lines: &[&[u8]], dialect: Dialect, run: NumberRun) -> Vec<Option<Heading>> {
    let above = || lines[..run.start].iter().rev().filter(|line| !line.trim_ascii().is_empty());
    let labelled = Labelled::of(above().map(|line| row(line, dialect)));
    let is_complete =
        |words: &Vec<String>| words.len() >= run.fields && !words.iter().all(String::is_empty);
    let rows = above().map(|line| row(line, dialect));
    let mut rows =
        rows.skip_while(|row| Label::of(row).is_some()).map(|row| Some(row).filter(is_complete));
    let named = |name: &str| (!name.is_empty()).then(|| Heading::parse(name));
    let mut found: Vec<Option<Heading>> = match rows.next().flatten() {
        Some(last) if are_units(&last) => {
            let names = rows.next().flatten().filter(|row| Label::of(row).is_none());
            let names = names.unwrap_or_default();
            let name = |index: usize| names.get(index).map_or("", String::as_str);
            let with_unit = |(index, unit): (usize, &String)| {
                Some(Heading {
                    name: asperity_table::unquoted(name(index)).to_owned(),
                    unit: ChannelUnit::of_text(unit),
                })
            };
            last.iter().enumerate().map(with_unit).collect()
        }
        Some(last) => last.iter().map(|name| named(name)).collect(),
        None => Vec::new(),
    };
    labelled.apply(&mut found, run.fields);
    found
}

/// Words of a line, without the mark of a comment.
fn row(line: &[u8], dialect: Dialect) -> Vec<String> {
    let line = line.trim_ascii_end();
    let bare = line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"%")).unwrap_or(line);
    words(bare.trim_ascii_start(), dialect.delimiter)
}

/// Content of a row of a header that its first word says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Label {
    Names,
    /// Unit of the abscissa, in the first column.
    AxisUnit,
    /// Units of the channels, in the other columns.
    Units,
    Other,
}

impl Label {
    /// The label of a row; none for a row that does not begin with one.
    fn of(row: &[String]) -> Option<Self> {
        const NAMES: [&str; 10] = [
            "point id",
            "point",
            "channel name",
            "channel names",
            "signal",
            "signal name",
            "response",
            "kanal",
            "kanalname",
            "name",
        ];
        const UNITS: [&str; 7] =
            ["y unit", "y units", "y-unit", "unit", "units", "einheit", "y axis unit"];
        const AXIS: [&str; 4] = ["x unit", "x units", "x-unit", "x axis unit"];
        const OTHERS: [&str; 16] = [
            "y label",
            "x label",
            "y axis",
            "x axis",
            "x quantity",
            "y quantity",
            "function",
            "function type",
            "reference",
            "direction",
            "description",
            "dof",
            "serial",
            "serial number",
            "range",
            "sensitivity",
        ];
        let (first, others) = row.split_first()?;
        if others.iter().all(String::is_empty) {
            return None;
        }
        let first = first.trim().trim_end_matches([':', '.']).to_lowercase().replace('_', " ");
        let is = |known: &[&str]| known.contains(&first.as_str());
        match () {
            () if is(&AXIS) => Some(Self::AxisUnit),
            () if is(&UNITS) => Some(Self::Units),
            // One word more may be an ordinary heading.
            () if is(&NAMES) => Some(Self::Names),
            () if is(&OTHERS) => Some(Self::Other),
            () => None,
        }
    }
}

/// The rows of a header that say what they hold.
#[derive(Default)]
struct Labelled {
    names: Vec<String>,
    units: Vec<String>,
    axis_unit: Option<String>,
}

impl Labelled {
    /// By the rows above the numbers, from the last.
    fn of(rows: impl Iterator<Item = Vec<String>>) -> Self {
        const MOST: usize = 64;
        let mut found = Self::default();
        for row in rows.take(MOST) {
            match Label::of(&row) {
                Some(Label::Names) if found.names.is_empty() => found.names = row,
                Some(Label::Units) if found.units.is_empty() => found.units = row,
                Some(Label::AxisUnit) if found.axis_unit.is_none() => {
                    found.axis_unit = row.into_iter().skip(1).find(|word| !word.is_empty());
                }
                _ => {}
            }
        }
        // A row `name` without units is an ordinary heading.
        if found.units.is_empty() { Self::default() } else { found }
    }

    fn apply(&self, headings: &mut Vec<Option<Heading>>, fields: usize) {
        if self.units.is_empty() {
            return;
        }
        headings.resize(fields.max(headings.len()), None);
        for (index, heading) in headings.iter_mut().enumerate() {
            let text = |row: &[String]| row.get(index).filter(|word| !word.is_empty()).cloned();
            let named = |name: String| Heading::parse(&name);
            if index == 0 {
                let unit = self.axis_unit.as_deref().map(ChannelUnit::of_text);
                let mut axis = heading.take().unwrap_or_else(|| Heading::bare("time".to_owned()));
                if let Some(unit @ ChannelUnit::Known(_)) = unit {
                    axis.unit = unit;
                }
                *heading = Some(axis);
                continue;
            }
            let mut channel = text(&self.names).map(named).or(heading.take());
            if let Some(unit) = text(&self.units) {
                let known = channel.get_or_insert_with(|| Heading::bare(String::new()));
                known.unit = ChannelUnit::of_text(&unit);
            }
            *heading = channel;
        }
    }
}

/// Refuses decimal commas between columns that commas separate, which cannot be told apart.
///
/// The rows then have two fields for each heading, and no number has a point.
pub(crate) fn check_decimal_comma(
    file: &str,
    place: FilePosition,
    lines: &[&[u8]],
    dialect: Dialect,
    run: NumberRun,
) -> Result<(), MeasureError> {
    if dialect.delimiter != b',' || run.start == 0 {
        return Ok(());
    }
    let above = lines[..run.start].iter().rev().find(|line| !line.trim_ascii().is_empty());
    let named = above.map_or(0, |line| {
        let words = row(line, dialect);
        if words.iter().all(|word| !word.is_empty() && dialect.number(word.as_bytes()).is_none()) {
            words.len()
        } else {
            0
        }
    });
    let rows = || lines[run.start..].iter().take(run.lines);
    let has_point = rows().any(|line| line.contains(&b'.'));
    if named < 2 || run.fields != 2 * named || has_point {
        return Ok(());
    }
    let found = format!("{} numbers under {named} names", run.fields);
    let expected = "one number for each name; decimal commas between commas cannot be told apart: \
                    save the file with semicolons or tabs between its columns";
    Err(MeasureError::malformed(file, place, "a row", format!("`{found}`"), expected))
}
