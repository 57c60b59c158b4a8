//! Reports: sections with figures, tables and verdicts, as one HTML page or as Markdown.

mod embed;
mod html;
mod markdown;

/// Whether a number meets what was claimed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Within its tolerance.
    Pass,
    /// Outside its tolerance.
    Fail,
    /// Within reach of a looser tolerance, or with a reservation.
    Warn,
    /// Not judged.
    Skip,
}

impl Verdict {
    /// The word shown.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Warn => "note",
            Self::Skip => "not judged",
        }
    }
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Plain text.
    Text(String),
    /// A number already written as text, aligned right.
    Number(String),
    /// A verdict, shown as a badge.
    Verdict(Verdict),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Verdict> for Cell {
    fn from(verdict: Verdict) -> Self {
        Self::Verdict(verdict)
    }
}

impl From<f64> for Cell {
    /// Four significant digits.
    fn from(value: f64) -> Self {
        let magnitude = value.abs();
        Self::Number(if !value.is_finite() {
            "–".to_owned()
        } else if value == 0.0 {
            "0".to_owned()
        } else if (1e-3..1e5).contains(&magnitude) {
            let places = (3 - magnitude.log10().floor() as i32).max(0) as usize;
            format!("{value:.places$}").replace('-', "−")
        } else {
            match format!("{value:.3e}").replace('-', "−").split_once('e') {
                Some((mantissa, exponent)) => format!("{mantissa}×10^{{{exponent}}}"),
                None => String::new(),
            }
        })
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Block {
    Section { title: String },
    Subsection { title: String },
    Paragraph { text: String },
    Code { text: String },
    Figure { id: String, caption: String, svg: String },
    Table { headers: Vec<String>, rows: Vec<Vec<Cell>> },
    KeyValues { pairs: Vec<(String, String)> },
}

/// A page of sections, built from top to bottom.
///
/// ```
/// use asperity_figure::report::{Cell, Report, Verdict};
/// let report = Report::new("Receptance of two beams")
///     .intro("What was computed & how it compares.")
///     .section("Claims")
///     .table(
///         ["quantity", "value", "verdict"],
///         [vec!["first mode (Hz)".into(), Cell::from(132.4), Verdict::Pass.into()]],
///     );
/// assert!(report.to_html().contains("computed &amp; how"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    title: String,
    intro: Vec<String>,
    footer: String,
    blocks: Vec<Block>,
}

impl Report {
    /// An empty report.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), intro: Vec::new(), footer: String::new(), blocks: Vec::new() }
    }

    fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds a paragraph under the title.
    #[must_use]
    pub fn intro(mut self, paragraph: impl Into<String>) -> Self {
        self.intro.push(paragraph.into());
        self
    }

    /// Sets the last line of the page: versions, dates.
    #[must_use]
    pub fn footer(mut self, text: impl Into<String>) -> Self {
        self.footer = text.into();
        self
    }

    /// Starts a section, which the table of contents lists.
    #[must_use]
    pub fn section(self, title: impl Into<String>) -> Self {
        self.with(Block::Section { title: title.into() })
    }

    /// Starts a part of a section.
    #[must_use]
    pub fn subsection(self, title: impl Into<String>) -> Self {
        self.with(Block::Subsection { title: title.into() })
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn paragraph(self, text: impl Into<String>) -> Self {
        self.with(Block::Paragraph { text: text.into() })
    }

    /// Adds text in a fixed pitch, line by line as it stands.
    #[must_use]
    pub fn code(self, text: impl Into<String>) -> Self {
        self.with(Block::Code { text: text.into() })
    }

    /// Adds a figure: an identifier (link target and file name), a caption, an SVG text.
    #[must_use]
    pub fn figure(
        self,
        id: impl Into<String>,
        caption: impl Into<String>,
        svg: impl Into<String>,
    ) -> Self {
        self.with(Block::Figure { id: id.into(), caption: caption.into(), svg: svg.into() })
    }

    /// Adds a table; short rows are filled with empty cells, long ones are cut.
    #[must_use]
    pub fn table<H: Into<String>>(
        self,
        headers: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<Cell>>,
    ) -> Self {
        let headers: Vec<String> = headers.into_iter().map(Into::into).collect();
        let fill = |mut row: Vec<Cell>| {
            row.resize(headers.len(), Cell::Text(String::new()));
            row
        };
        let rows = rows.into_iter().map(fill).collect();
        self.with(Block::Table { headers, rows })
    }

    /// Adds a list of names and values.
    #[must_use]
    pub fn key_values<K: Into<String>, V: Into<String>>(
        self,
        pairs: impl IntoIterator<Item = (K, V)>,
    ) -> Self {
        let pairs = pairs.into_iter().map(|(key, value)| (key.into(), value.into())).collect();
        self.with(Block::KeyValues { pairs })
    }

    /// The report as one self-contained HTML page: style, font and figures inside.
    pub fn to_html(&self) -> String {
        html::render(self)
    }

    /// The report as Markdown (GitHub's flavour); `figure_path` gives the path of the picture of a
    /// figure from its identifier.
    pub fn to_markdown(&self, figure_path: impl Fn(&str) -> String) -> String {
        markdown::render(self, figure_path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let written = |value: f64| match Cell::from(value) {
            Cell::Number(text) => text,
            _ => String::new(),
        };
        assert_eq!(written(132.04), "132.0");
        assert_eq!(written(-0.5), "−0.5000");
        assert_eq!(written(4.2e9), "4.200×10^{9}");
        assert_eq!(written(1e-7), "1.000×10^{−7}");
        assert_eq!(written(f64::NAN), "–");
    }
}
