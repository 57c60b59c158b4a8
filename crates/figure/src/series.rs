//! A named set of points with its line and markers.

use crate::{Color, FigureError};

/// Line pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Dash {
    /// Unbroken.
    #[default]
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// A dash and a dot in turn.
    DashDot,
}

/// Line patterns in order of use.
const DASHES: [Dash; 4] = [Dash::Solid, Dash::Dashed, Dash::DashDot, Dash::Dotted];

/// Point symbols in order of use.
const MARKERS: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Plus,
    Marker::Cross,
];

/// Point symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Marker {
    /// No symbol.
    #[default]
    None,
    /// Circle.
    Circle,
    /// Triangle, point up.
    Triangle,
    /// Diagonal cross.
    Cross,
    /// Square.
    Square,
    /// Diamond.
    Diamond,
    /// Upright cross.
    Plus,
}

/// Share of white in the fill of a band, unless set.
const BAND_LIGHTNESS: f64 = 0.78;

/// Connection of the points of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Join {
    /// Nothing: markers only.
    Points,
    /// A polyline, broken at points that are not finite.
    Line,
    /// A filled area between the ordinates and `lower`.
    Band,
}

/// Points with a name, a colour, a line and a marker.
///
/// Points whose abscissa or ordinate is not finite, or not positive on a logarithmic axis, break
/// the line. An empty name keeps the series out of the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub(crate) name: String,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) error_x: Vec<f64>,
    pub(crate) error_y: Vec<f64>,
    pub(crate) join: Join,
    pub(crate) color: Option<Color>,
    pub(crate) dash: Dash,
    pub(crate) marker: Marker,
    pub(crate) marker_size: f64,
    pub(crate) marker_every: usize,
    pub(crate) width: f64,
    pub(crate) filled: bool,
    pub(crate) lightness: f64,
}

impl Series {
    fn new(name: impl Into<String>, x: &[f64], y: &[f64], join: Join, marker: Marker) -> Self {
        Self {
            name: name.into(),
            x: x.to_vec(),
            y: y.to_vec(),
            lower: Vec::new(),
            error_x: Vec::new(),
            error_y: Vec::new(),
            join,
            color: None,
            dash: Dash::Solid,
            marker,
            marker_size: 3.6,
            marker_every: 1,
            width: 1.0,
            filled: false,
            lightness: BAND_LIGHTNESS,
        }
    }

    /// A line through the points `(x, y)`.
    pub fn line(name: impl Into<String>, x: impl AsRef<[f64]>, y: impl AsRef<[f64]>) -> Self {
        Self::new(name, x.as_ref(), y.as_ref(), Join::Line, Marker::None)
    }

    /// Markers at the points `(x, y)`.
    pub fn points(name: impl Into<String>, x: impl AsRef<[f64]>, y: impl AsRef<[f64]>) -> Self {
        Self::new(name, x.as_ref(), y.as_ref(), Join::Points, Marker::Circle)
    }

    /// Markers at the points `(x, y)`, joined by a line.
    pub fn line_points(
        name: impl Into<String>,
        x: impl AsRef<[f64]>,
        y: impl AsRef<[f64]>,
    ) -> Self {
        Self::new(name, x.as_ref(), y.as_ref(), Join::Line, Marker::Circle)
    }

    /// A pale area between the ordinates `lower` and `upper`: an uncertainty or a range.
    pub fn band(
        name: impl Into<String>,
        x: impl AsRef<[f64]>,
        lower: impl AsRef<[f64]>,
        upper: impl AsRef<[f64]>,
    ) -> Self {
        let mut series =
            Self::new(name, x.as_ref(), upper.as_ref(), Join::Band, Marker::None).filled(true);
        series.lower = lower.as_ref().to_vec();
        series
    }

    /// Sets the colour; without it the panel takes the next of the categorical palette.
    #[must_use]
    pub fn color(mut self, color: Color) -> Self {
        self.color = Some(color);
        self
    }

    /// Sets the colour, the line pattern and, of a series with symbols, the point symbol to number
    /// `index` of each, so that series differ in grey as well.
    #[must_use]
    pub fn category(self, index: usize) -> Self {
        let marker = match self.marker {
            Marker::None => Marker::None,
            _ => MARKERS[index % MARKERS.len()],
        };
        self.color(Color::category(index)).dash(DASHES[index % DASHES.len()]).marker(marker)
    }

    /// Sets the line pattern.
    #[must_use]
    pub fn dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }

    /// Sets the point symbol.
    #[must_use]
    pub fn marker(mut self, marker: Marker) -> Self {
        self.marker = marker;
        self
    }

    /// Sets the size of the point symbol, in points (3.6 unless set).
    #[must_use]
    pub fn marker_size(mut self, points: f64) -> Self {
        self.marker_size = points;
        self
    }

    /// Draws a marker at each `every`-th point only, the line through all of them.
    #[must_use]
    pub fn marker_every(mut self, every: usize) -> Self {
        self.marker_every = every.max(1);
        self
    }

    /// Sets the line width, in points (1 unless set).
    #[must_use]
    pub fn width(mut self, points: f64) -> Self {
        self.width = points;
        self
    }

    /// Fills the markers with the colour; otherwise they are white inside.
    #[must_use]
    pub fn filled(mut self, filled: bool) -> Self {
        self.filled = filled;
        self
    }

    /// Sets the share of white in the fill of a band (0.78 unless set): less of it for a band inside
    /// another.
    #[must_use]
    pub fn lightness(mut self, share: f64) -> Self {
        self.lightness = share;
        self
    }

    /// Draws a vertical bar through each point, `errors` long above and below.
    ///
    /// An error that is not finite has no bar.
    #[must_use]
    pub fn errors(mut self, errors: impl AsRef<[f64]>) -> Self {
        self.error_y = errors.as_ref().to_vec();
        self
    }

    /// Draws a horizontal bar through each point, `errors` long to the left and to the right.
    #[must_use]
    pub fn horizontal_errors(mut self, errors: impl AsRef<[f64]>) -> Self {
        self.error_x = errors.as_ref().to_vec();
        self
    }

    /// The series as a reference for others: in one colour, without a name and error bars.
    pub(crate) fn below(mut self, color: Color) -> Self {
        self.name = String::new();
        self.error_x.clear();
        self.error_y.clear();
        self.width = self.width.max(1.4);
        self.color(color)
    }

    /// Every abscissa and ordinate the series reaches, as pairs.
    pub(crate) fn extent(&self) -> impl Iterator<Item = (f64, f64)> {
        let pair = |values| self.x.iter().copied().zip(values);
        let points = pair(self.y.iter().copied()).chain(pair(self.lower.iter().copied()));
        points.chain(self.error_ends().flatten())
    }

    /// Both ends of every error bar.
    pub(crate) fn error_ends(&self) -> impl Iterator<Item = [(f64, f64); 2]> {
        let points = || self.x.iter().copied().zip(self.y.iter().copied());
        let across = points().zip(&self.error_x).map(|((x, y), e)| [(x - e, y), (x + e, y)]);
        let along = points().zip(&self.error_y).map(|((x, y), e)| [(x, y - e), (x, y + e)]);
        across.chain(along)
    }

    pub(crate) fn check_lengths(&self) -> Result<(), FigureError> {
        let lower = if self.join == Join::Band { self.lower.len() } else { self.x.len() };
        let errors = |errors: &[f64]| if errors.is_empty() { self.x.len() } else { errors.len() };
        for ordinates in [self.y.len(), lower, errors(&self.error_x), errors(&self.error_y)] {
            if ordinates != self.x.len() {
                return Err(FigureError::SeriesLengths {
                    series: self.name.clone(),
                    x: self.x.len(),
                    y: ordinates,
                });
            }
        }
        Ok(())
    }
}
