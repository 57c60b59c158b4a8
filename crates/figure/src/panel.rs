//! One pair of axes with its series and notes.

use crate::{Axis, Color, ColorBar, FigureError, Series};

/// Position of the legend.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Legend {
    /// Inside where it covers no data, else above the frame.
    #[default]
    Auto,
    /// Inside, top right.
    TopRight,
    /// Inside, top left.
    TopLeft,
    /// Inside, bottom right.
    BottomRight,
    /// Inside, bottom left.
    BottomLeft,
    /// Above the frame, in columns.
    Above,
    /// No legend.
    None,
}

/// Side of its point on which a note is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Anchor {
    /// To the right, or to the left near the right edge.
    #[default]
    Auto,
    /// To the right.
    Right,
    /// To the left.
    Left,
    /// Above.
    Above,
    /// Below.
    Below,
    /// Centred on the point.
    Center,
}

/// Text at a data point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Note {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) text: String,
    pub(crate) anchor: Anchor,
    pub(crate) color: Color,
}

/// A straight dashed line across the panel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReferenceLine {
    pub(crate) at: f64,
    pub(crate) vertical: bool,
    pub(crate) text: String,
}

/// Axes with series, notes, reference lines, a legend and possibly a colour bar.
///
/// ```
/// use asperity_figure::{Axis, Figure, Panel, Series};
/// let (force, frequency) = ([9.0, 20.0, 32.0], [868.4, 841.0, 822.8]);
/// let panel = Panel::new(Axis::linear("Peak force", "N"), Axis::linear("Frequency", "Hz"))
///     .series(Series::points("simulated", force, frequency))
///     .horizontal(875.5, "at rest");
/// assert!(Figure::new("Softening").panel(panel).check().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    pub(crate) x_axis: Axis,
    pub(crate) y_axis: Axis,
    pub(crate) title: String,
    pub(crate) series: Vec<Series>,
    pub(crate) notes: Vec<Note>,
    pub(crate) references: Vec<ReferenceLine>,
    pub(crate) shades: Vec<(f64, f64)>,
    pub(crate) legend: Legend,
    pub(crate) color_bar: Option<ColorBar>,
    pub(crate) blank: bool,
}

impl Panel {
    /// An empty panel.
    pub fn new(x_axis: Axis, y_axis: Axis) -> Self {
        Self {
            x_axis,
            y_axis,
            title: String::new(),
            series: Vec::new(),
            notes: Vec::new(),
            references: Vec::new(),
            shades: Vec::new(),
            legend: Legend::Auto,
            color_bar: None,
            blank: false,
        }
    }

    /// A place that stays empty, so that the next panel comes further right.
    pub fn blank() -> Self {
        let axis = || Axis::linear("", "").ticks(std::iter::empty::<(f64, String)>());
        Self { blank: true, ..Self::new(axis(), axis()) }
    }

    /// Adds a series; later ones are drawn over earlier ones, bands under all.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds several series.
    #[must_use]
    pub fn all_series(mut self, series: impl IntoIterator<Item = Series>) -> Self {
        self.series.extend(series);
        self
    }

    /// Adds a series if it has a point that the axes can show.
    #[must_use]
    pub fn series_if_visible(self, series: Series) -> Self {
        if self.shows(&series) { self.series(series) } else { self }
    }

    /// True if both axes have the labels, units and scales of another panel's.
    pub(crate) fn has_axes_of(&self, other: &Self) -> bool {
        let same = |a: &Axis, b: &Axis| a.label == b.label && a.unit == b.unit && a.log == b.log;
        !self.blank && same(&self.x_axis, &other.x_axis) && same(&self.y_axis, &other.y_axis)
    }

    /// Adds the series of another panel.
    pub(crate) fn put_series(&mut self, other: &Self) {
        self.x_axis.widen(&other.x_axis);
        self.y_axis.widen(&other.y_axis);
        self.series.extend(other.series.iter().cloned());
    }

    /// Puts the lines and points of another panel below the own ones, in grey.
    pub(crate) fn put_over(&mut self, other: &Self, name: &str) {
        self.x_axis.widen(&other.x_axis);
        self.y_axis.widen(&other.y_axis);
        // Colours go by the number of a series, which changes.
        let colors: Vec<Color> = (0..self.series.len()).map(|at| self.series_color(at)).collect();
        for (series, color) in self.series.iter_mut().zip(colors) {
            series.color = Some(color);
        }
        let drawn = other.series.iter().filter(|series| series.lower.is_empty());
        let mut below: Vec<Series> =
            drawn.map(|series| series.clone().below(Color::GREY.lighten(0.35))).collect();
        if let Some(first) = below.first_mut() {
            name.clone_into(&mut first.name);
        }
        self.series.splice(0..0, below);
    }

    /// True if the panel has no series.
    pub fn is_empty(&self) -> bool {
        self.series.is_empty()
    }

    /// Writes `text` beside the data point `(x, y)`, given in data units.
    #[must_use]
    pub fn note(self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.note_at(x, y, text, Anchor::Auto, Color::BLACK)
    }

    /// Writes `text` on a chosen side of the data point `(x, y)`, given in data units.
    #[must_use]
    pub fn note_at(
        mut self,
        x: f64,
        y: f64,
        text: impl Into<String>,
        anchor: Anchor,
        color: Color,
    ) -> Self {
        self.notes.push(Note { x, y, text: text.into(), anchor, color });
        self
    }

    /// Draws a thin dashed vertical at `x`, in data units, with a text at its top.
    #[must_use]
    pub fn vertical(mut self, x: f64, text: impl Into<String>) -> Self {
        self.references.push(ReferenceLine { at: x, vertical: true, text: text.into() });
        self
    }

    /// Draws a thin dashed horizontal at `y`, in data units, with a text at its right end.
    #[must_use]
    pub fn horizontal(mut self, y: f64, text: impl Into<String>) -> Self {
        self.references.push(ReferenceLine { at: y, vertical: false, text: text.into() });
        self
    }

    /// Shades the part of the panel between two abscissae, in data units; infinite ones, and those
    /// that a logarithmic axis cannot show, stand for its sides.
    #[must_use]
    pub fn shade(mut self, from: f64, to: f64) -> Self {
        self.shades.push((from, to));
        self
    }

    /// Places the legend; it appears when a series has a name.
    #[must_use]
    pub fn legend(mut self, legend: Legend) -> Self {
        self.legend = legend;
        self
    }

    /// Adds a colour bar at the right.
    #[must_use]
    pub fn color_bar(mut self, bar: ColorBar) -> Self {
        self.color_bar = Some(bar);
        self
    }

    /// Writes a title above the frame.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    pub(crate) fn check(&self) -> Result<(), FigureError> {
        crate::scale::check(&self.x_axis)?;
        crate::scale::check(&self.y_axis)?;
        for series in &self.series {
            series.check_lengths()?;
            if !self.shows(series) {
                return Err(FigureError::EmptySeries { series: series.name.clone() });
            }
        }
        Ok(())
    }

    /// True if a point of the series can be shown.
    fn shows(&self, series: &Series) -> bool {
        let shown = |(x, y)| !self.x_axis.shown(x).is_nan() && !self.y_axis.shown(y).is_nan();
        series.extent().any(shown)
    }

    /// Colour of series `index`: its own, or the next of the palette.
    pub(crate) fn series_color(&self, index: usize) -> Color {
        self.series[index].color.unwrap_or_else(|| {
            Color::category(self.series[..index].iter().filter(|s| s.color.is_none()).count())
        })
    }
}
