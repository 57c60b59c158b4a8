//! Reports: sections with figures and tables, as one HTML page or as Markdown.

mod embed;
mod html;
mod markdown;

pub use embed::embedded_fonts;

use crate::interactive::InteractiveFigure;

/// Columns of points of a panel of an interactive figure.
const COLUMNS: usize = 30_000;

/// Outcome of comparing a number with a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ClaimOutcome {
    /// Within its tolerance.
    Pass,
    /// Outside its tolerance.
    Fail,
    /// Within reach of a looser tolerance, or with a reservation.
    Warn,
}

impl ClaimOutcome {
    /// The word shown.
    pub fn word(self) -> &'static str {
        self.shown().0
    }

    /// Word, class of the badge in HTML, and sign in Markdown.
    fn shown(self) -> (&'static str, &'static str, char) {
        match self {
            Self::Pass => ("pass", "pass", '✓'),
            Self::Fail => ("fail", "fail", '✗'),
            Self::Warn => ("note", "warn", '△'),
        }
    }
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TableCell {
    /// Plain text.
    Text(String),
    /// A number already written as text, aligned right.
    Number(String),
    /// An outcome, shown as a badge.
    Outcome(ClaimOutcome),
}

impl From<&str> for TableCell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for TableCell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<ClaimOutcome> for TableCell {
    fn from(outcome: ClaimOutcome) -> Self {
        Self::Outcome(outcome)
    }
}

impl TableCell {
    /// A standard deviation as [`two_digits`] writes it; a dash without one.
    pub fn deviation(value: impl Into<Option<f64>>) -> Self {
        Self::Number(two_digits(value.into().unwrap_or(f64::NAN)))
    }
}

impl From<f64> for TableCell {
    /// The number as [`four_digits`] writes it.
    fn from(value: f64) -> Self {
        Self::Number(four_digits(value))
    }
}

/// A number as text with four significant digits; a dash where it is not finite.
pub fn four_digits(value: f64) -> String {
    digits(value, 4)
}

/// A number as text with `count` significant digits, all digits before the point kept; a dash where it is
/// not finite.
pub fn digits(value: f64, count: usize) -> String {
    let magnitude = value.abs();
    if !value.is_finite() {
        "–".to_owned()
    } else if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&magnitude) {
        let places = count as f64 - 1.0 - magnitude.log10().floor();
        format!("{value:.*}", places.max(0.0) as usize).replace('-', "−")
    } else {
        let text = format!("{value:.*e}", count.saturating_sub(1)).replace('-', "−");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{mantissa}×10^{{{exponent}}}")
    }
}

/// A standard deviation as text with two significant digits; a dash where it is not finite.
pub fn two_digits(deviation: f64) -> String {
    let rounded = format!("{deviation:.1e}").parse().unwrap_or(f64::NAN);
    digits(rounded, 2)
}

#[derive(Debug, Clone, PartialEq)]
enum ReportBlock {
    Section { title: String },
    Subsection { title: String },
    Paragraph { text: String },
    Figure { id: String, caption: String, svg: String, data: String },
    Table { headers: Vec<String>, rows: Vec<Vec<TableCell>> },
    KeyValues { pairs: Vec<(String, String)> },
}

/// True for a column of `rows` that holds a number.
fn is_numeric(rows: &[Vec<TableCell>], column: usize) -> bool {
    rows.iter().any(|row| matches!(row.get(column), Some(TableCell::Number(_))))
}

/// A page of sections, built from top to bottom.
///
/// ```
/// use asperity_figure::report::{TableCell, Report, ClaimOutcome};
/// let report = Report::new("Receptance of two beams")
///     .intro("Computed & measured frequencies.")
///     .section("Claims")
///     .table(
///         ["quantity", "value", "outcome"],
///         [vec!["first mode (Hz)".into(), TableCell::from(132.4), ClaimOutcome::Pass.into()]],
///     );
/// assert!(report.to_html().contains("Computed &amp; measured"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    title: String,
    intro: Vec<String>,
    blocks: Vec<ReportBlock>,
}

impl Report {
    /// An empty report.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), intro: Vec::new(), blocks: Vec::new() }
    }

    fn with(mut self, block: ReportBlock) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a paragraph under the title.
    #[must_use]
    pub fn intro(mut self, paragraph: impl Into<String>) -> Self {
        self.intro.push(paragraph.into());
        self
    }

    /// Starts a section, which the table of contents lists.
    #[must_use]
    pub fn section(self, title: impl Into<String>) -> Self {
        self.with(ReportBlock::Section { title: title.into() })
    }

    /// Starts a part of a section.
    #[must_use]
    pub fn subsection(self, title: impl Into<String>) -> Self {
        self.with(ReportBlock::Subsection { title: title.into() })
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn paragraph(self, text: impl Into<String>) -> Self {
        self.with(ReportBlock::Paragraph { text: text.into() })
    }

    /// Adds a figure: an identifier (link target and file name), a caption, an SVG text.
    #[must_use]
    pub fn figure(
        self,
        id: impl Into<String>,
        caption: impl Into<String>,
        svg: impl Into<String>,
    ) -> Self {
        let (id, caption, svg) = (id.into(), caption.into(), svg.into());
        self.with(ReportBlock::Figure { id, caption, svg, data: String::new() })
    }

    /// Adds a figure whose panels the HTML page zooms and reads out.
    ///
    /// Dragging zooms, with the shift key it moves; a double click shows the whole again; the values
    /// of the nearest point are shown at the pointer. Panels with the same horizontal axis are zoomed
    /// together along it. Without scripts, and in print, the figure is as in [`Report::figure`].
    #[must_use]
    pub fn interactive_figure(
        self,
        id: impl Into<String>,
        caption: impl Into<String>,
        figure: &crate::Figure,
    ) -> Self {
        let InteractiveFigure { svg, data } = figure.to_interactive(COLUMNS);
        self.with(ReportBlock::Figure { id: id.into(), caption: caption.into(), svg, data })
    }

    /// Adds a table; short rows are filled with empty cells, long ones are cut.
    #[must_use]
    pub fn table<H: Into<String>>(
        self,
        headers: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<TableCell>>,
    ) -> Self {
        let headers: Vec<String> = headers.into_iter().map(Into::into).collect();
        let fill = |mut row: Vec<TableCell>| {
            row.resize(headers.len(), TableCell::Text(String::new()));
            row
        };
        let rows = rows.into_iter().map(fill).collect();
        self.with(ReportBlock::Table { headers, rows })
    }

    /// Adds a list of names and values.
    #[must_use]
    pub fn key_values<K: Into<String>, V: Into<String>>(
        self,
        pairs: impl IntoIterator<Item = (K, V)>,
    ) -> Self {
        let pairs = pairs.into_iter().map(|(key, value)| (key.into(), value.into())).collect();
        self.with(ReportBlock::KeyValues { pairs })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(four_digits(132.04), "132.0");
        assert_eq!(four_digits(-0.5), "−0.5000");
        assert_eq!(four_digits(4.2e9), "4.200×10^{9}");
        assert_eq!(four_digits(1e-7), "1.000×10^{−7}");
        assert_eq!(four_digits(f64::NAN), "–");
    }

    #[test]
    fn deviations_have_two_digits() {
        for (deviation, text) in [
            (132.04, "130"),
            (0.023_46, "0.023"),
            (0.999, "1.0"),
            (13.2, "13"),
            (4.26e9, "4.3×10^{9}"),
            (1e-7, "1.0×10^{−7}"),
            (0.0, "0"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(two_digits(deviation), text, "{deviation}");
        }
    }
}
