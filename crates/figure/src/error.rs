//! Errors of figures and pictures.

/// Reasons why a figure or a picture cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
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
    /// A picture or page could not be encoded.
    #[error("the picture cannot be encoded: {reason}")]
    Encoding {
        /// The encoder's message.
        reason: String,
    },
    /// An SVG text holds something that is not written to PDF.
    #[error("{what} cannot be written to PDF")]
    NotInPdf {
        /// The parts.
        what: &'static str,
    },
}
