//! What can go wrong between a table and a picture.

/// The ways a table, a figure or a picture can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A column does not have the length of the columns before it.
    #[error("column `{name}` has {found} rows, the table has {expected}")]
    UnequalLengths {
        /// The offending column.
        name: String,
        /// Rows of the table so far.
        expected: usize,
        /// Rows of the column.
        found: usize,
    },
    /// A column name is used twice.
    #[error("column `{name}` is already in the table")]
    DuplicateColumn {
        /// The repeated name.
        name: String,
    },
    /// A table has no column of that name.
    #[error("no column `{name}`; the table has {available:?}")]
    UnknownColumn {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: Vec<String>,
    },
    /// A line of a CSV text has the wrong number of fields.
    #[error("line {line} has {found} fields, the header has {expected}")]
    FieldCount {
        /// One-based line number.
        line: usize,
        /// Fields in the header.
        expected: usize,
        /// Fields in the line.
        found: usize,
    },
    /// A field of a CSV text is not a number.
    #[error("line {line}, column `{column}`: `{field}` is not a number")]
    NotANumber {
        /// One-based line number.
        line: usize,
        /// The column of the field.
        column: String,
        /// The field as written.
        field: String,
    },
    /// A CSV text has no header line.
    #[error("the CSV text has no header line")]
    MissingHeader,
    /// A figure has no panel.
    #[error("figure `{figure}` has no panel")]
    NoPanel {
        /// Title of the figure.
        figure: String,
    },
    /// The abscissae and ordinates of a series differ in number.
    #[error("series `{series}` has {x} abscissae and {y} ordinates")]
    SeriesLengths {
        /// Name of the series.
        series: String,
        /// Number of abscissae.
        x: usize,
        /// Number of ordinates.
        y: usize,
    },
    /// A series has no point that can be drawn on its axes.
    #[error("series `{series}` has no finite point its axes can show")]
    EmptySeries {
        /// Name of the series.
        series: String,
    },
    /// An axis range is empty, not finite, or not positive on a logarithmic axis.
    #[error("axis `{axis}` cannot span {low} to {high}")]
    AxisRange {
        /// Label of the axis.
        axis: String,
        /// Lower end, in display units.
        low: f64,
        /// Upper end, in display units.
        high: f64,
    },
    /// The picture would have no pixel, or too many.
    #[error("a picture of {width} by {height} pixels cannot be made")]
    PictureSize {
        /// Width in pixels.
        width: f64,
        /// Height in pixels.
        height: f64,
    },
    /// An SVG text could not be read.
    #[error("the SVG text cannot be read: {reason}")]
    InvalidSvg {
        /// The reader's message.
        reason: String,
    },
    /// A picture could not be encoded as PNG.
    #[error("the picture cannot be encoded: {reason}")]
    Encoding {
        /// The encoder's message.
        reason: String,
    },
}
