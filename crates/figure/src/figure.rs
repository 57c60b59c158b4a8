//! Panels on a page.

use crate::{FigureError, Panel};

/// Width of one column of a journal page, in millimetres.
const COLUMN_MM: f64 = 85.0;
/// Width of a page of two columns, in millimetres.
const PAGE_MM: f64 = 175.0;

/// Panels laid out left to right, tagged (a), (b) where there are several.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    pub(crate) title: String,
    pub(crate) panels: Vec<Panel>,
    pub(crate) width_mm: Option<f64>,
    pub(crate) row_height_mm: Option<f64>,
    pub(crate) columns: Option<usize>,
    pub(crate) tags: bool,
}

impl Figure {
    /// A figure without panels. The title is the accessible name of the SVG text and is not drawn.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            panels: Vec::new(),
            width_mm: None,
            row_height_mm: None,
            columns: None,
            tags: true,
        }
    }

    /// Adds a panel at the right of the last, or below when the columns are used up.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// Sets the width; otherwise 85 mm for one column of panels and 175 mm for more.
    #[must_use]
    pub fn width_mm(mut self, width: f64) -> Self {
        self.width_mm = Some(width);
        self
    }

    /// Sets the height of each row of panels; otherwise it follows the width.
    #[must_use]
    pub fn row_height_mm(mut self, height: f64) -> Self {
        self.row_height_mm = Some(height);
        self
    }

    /// Sets the number of columns; otherwise up to three panels stand in one row, and more in rows
    /// of two.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = Some(columns.max(1));
        self
    }

    /// Sets the tags (a), (b) of several panels, which are on unless set.
    #[must_use]
    pub fn tags(mut self, tags: bool) -> Self {
        self.tags = tags;
        self
    }

    /// Draws the lines and points of another figure in grey below those of each panel with the same axis
    /// labels, under `name` in the legend of the first; fixed ranges are widened to hold both.
    ///
    /// ```
    /// use asperity_figure::{Axis, Figure, Panel, Series};
    /// let drawn = |y: [f64; 2]| {
    ///     let panel = Panel::new(Axis::linear("x", ""), Axis::linear("y", ""));
    ///     Figure::new("now").panel(panel.series(Series::line("now", [0.0, 1.0], y)))
    /// };
    /// let both = drawn([1.0, 2.0]).over(&drawn([3.0, 4.0]), "before");
    /// assert!(both.to_svg().contains("before"));
    /// ```
    #[must_use]
    pub fn over(mut self, earlier: &Self, name: &str) -> Self {
        let mut name = Some(name);
        for (panel, other) in self.pairs(earlier) {
            panel.put_over(other, name.take().unwrap_or_default());
        }
        self
    }

    /// Adds the series of another figure to the panels with the same axis labels; fixed ranges are widened to
    /// hold both.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        for (panel, other) in self.pairs(other) {
            panel.put_series(other);
        }
        self
    }

    /// The panels with their partners of the same axes in another figure.
    fn pairs<'a>(
        &'a mut self,
        other: &'a Self,
    ) -> impl Iterator<Item = (&'a mut Panel, &'a Panel)> {
        let mut others: Vec<&Panel> = other.panels.iter().collect();
        self.panels.iter_mut().filter_map(move |panel| {
            let at = others.iter().position(|other| panel.has_axes_of(other))?;
            Some((panel, others.remove(at)))
        })
    }

    /// Checks that everything can be drawn.
    ///
    /// # Errors
    /// [`FigureError::NoPanel`], [`FigureError::SeriesLengths`], [`FigureError::EmptySeries`] or
    /// [`FigureError::AxisRange`], the first found.
    pub fn check(&self) -> Result<(), FigureError> {
        if self.panels.is_empty() {
            return Err(FigureError::NoPanel { figure: self.title.clone() });
        }
        self.panels.iter().try_for_each(Panel::check)
    }

    pub(crate) fn column_count(&self) -> usize {
        let panels = self.panels.len().max(1);
        self.columns.unwrap_or(if panels <= 3 { panels } else { 2 }).min(panels)
    }

    pub(crate) fn page_width_mm(&self) -> f64 {
        let default = if self.column_count() == 1 { COLUMN_MM } else { PAGE_MM };
        self.width_mm.filter(|width| width.is_finite()).unwrap_or(default).clamp(20.0, 2000.0)
    }
}
