//! A figure on the page: frames of all panels, aligned in rows and columns.

use crate::{
    Color, Figure, FigureError, Legend, Marker, Panel,
    frame::Frame,
    interactive::{self, InteractiveFigure},
    legend::LegendBlock,
    markup::PX_PER_MM,
    note, pdf,
    plot::{Plot, TICK_GAP},
    raster,
    ruler::Ruler,
    svg::{Align, Canvas, TextStyle},
    text::{self, LABEL_FONT, TITLE_FONT},
};

/// Room between neighbouring panels.
const GAP: (f64, f64) = (12.0, 10.0);
/// Height of the line above a frame that holds tag and title.
const HEAD: f64 = 15.0;
/// Least room around the frames.
const RIM: f64 = 4.0;
/// Height of a row of panels over its width, and its bounds in millimetres.
const ASPECT: (f64, f64, f64) = (0.74, 46.0, 68.0);

impl Figure {
    /// The figure as SVG text. A panel that [`Figure::check`] refuses shows the error in red.
    pub fn to_svg(&self) -> String {
        self.drawn(Canvas::default(), 0).0
    }

    /// The figure for [`INTERACTIVE_SCRIPT`](crate::INTERACTIVE_SCRIPT): as SVG text whose moving parts are
    /// grouped, and its points as JSON.
    ///
    /// - `columns`: number of columns into which the points of a panel are gathered, over its lines; at least 400
    ///   and at most 5000 of a line. More show more in a zoom.
    pub fn to_interactive(&self, columns: usize) -> InteractiveFigure {
        let (svg, data) = self.drawn(Canvas::grouped(), columns);
        InteractiveFigure { svg, data }
    }

    fn drawn(&self, mut canvas: Canvas, columns: usize) -> (String, String) {
        let interactive = canvas.is_grouped();
        let page = PageLayout::new(self);
        // A legend without a free place goes above its frame, which moves the frames: once.
        let first = page.plots(self, &vec![0.0; self.panels.len()]);
        let above: Vec<Option<LegendBlock<'_>>> =
            first.iter().map(|(_, plot)| legend_above(plot)).collect();
        let height = |block: &LegendBlock<'_>| block.height() + 5.0;
        let heads: Vec<f64> =
            above.iter().map(|block| block.as_ref().map_or(0.0, height)).collect();
        let is_moved = heads.iter().any(|head| *head > 0.0);
        let plots = if is_moved { page.plots(self, &heads) } else { first };
        let drawn = plots.iter().enumerate().filter(|(_, (_, plot))| !plot.panel.blank);
        for (number, (index, (start, plot))) in drawn.enumerate() {
            draw_panel(&mut canvas, plot, number);
            if let Some(block) = &above[index] {
                block.draw(&mut canvas, &block.above(&plot.frame));
            } else if let Some(block) = LegendBlock::new(plot.panel) {
                // The second layout may have made the frame smaller; a corner always has a place.
                let place = |legend| block.place(legend, &plot.frame, &note::obstacles(plot));
                if let Some(place) = place(plot.panel.legend).or_else(|| place(Legend::TopRight)) {
                    block.draw(&mut canvas, &place);
                }
            }
            page.head(&mut canvas, self, index, (*start, plot), heads[index]);
        }
        let data = if interactive {
            interactive::data(self, plots.iter().map(|(_, plot)| plot), columns)
        } else {
            String::new()
        };
        (canvas.finish(page.width, page.height(), &self.title), data)
    }

    /// The figure as a PNG, rasterised with the bundled font.
    ///
    /// # Errors
    /// Those of [`Figure::check`] and of [`svg_to_png`](crate::svg_to_png).
    pub fn to_png(&self, pixels_per_mm: f64) -> Result<Vec<u8>, FigureError> {
        self.check()?;
        raster::svg_to_png(&self.to_svg(), pixels_per_mm)
    }

    /// The figure as a PDF page of its size, with text as text in the bundled font.
    ///
    /// # Errors
    /// Those of [`Figure::check`] and of [`svg_to_pdf`](crate::svg_to_pdf).
    pub fn to_pdf(&self) -> Result<Vec<u8>, FigureError> {
        self.check()?;
        pdf::svg_to_pdf(&self.to_svg())
    }
}

/// The legend of a panel, where it has no free place inside its frame.
fn legend_above<'a>(plot: &Plot<'a>) -> Option<LegendBlock<'a>> {
    let block = LegendBlock::new(plot.panel)?;
    let inside = block.place(plot.panel.legend, &plot.frame, &note::obstacles(plot));
    inside.is_none().then(|| block.spread(plot.frame.width()))
}

/// Draws all of a panel but legend and head.
fn draw_panel(canvas: &mut Canvas, plot: &Plot<'_>, number: usize) {
    plot.draw(canvas, number);
    canvas.open(number);
    note::draw(canvas, plot);
    canvas.close();
    if let Some(bar) = &plot.panel.color_bar {
        bar.draw(canvas, &plot.frame);
    }
    if let Err(error) = plot.panel.check() {
        let style = TextStyle::new(LABEL_FONT, Align::Center).color(Color::RED).halo();
        let (x, y) = plot.frame.middle();
        canvas.text(x, y, &error.to_string(), style);
    }
}

/// Rows of equal height; frames of equal size.
#[derive(Debug, Clone)]
struct PageLayout {
    width: f64,
    columns: usize,
    rows: usize,
    row_height: f64,
    /// Distance of the tops of two rows.
    pitch: f64,
    tagged: bool,
}

impl PageLayout {
    fn new(figure: &Figure) -> Self {
        let columns = figure.column_count();
        let rows = figure.panels.len().div_ceil(columns).max(1);
        let width = figure.page_width_mm() * PX_PER_MM;
        let across = (width - GAP.0 * (columns - 1) as f64) / columns as f64;
        let (aspect, least, most) = ASPECT;
        let down = match figure.row_height_mm {
            Some(height) if height.is_finite() => height.clamp(15.0, 2000.0),
            _ => (aspect * across / PX_PER_MM).clamp(least, most),
        };
        let tagged = figure.tags && figure.panels.len() > 1;
        let row_height = down * PX_PER_MM;
        // Below rows whose axes have no titles there is less room.
        let mut upper = figure.panels.iter().take(columns * (rows - 1));
        let untitled = rows > 1 && upper.all(|panel| panel.x_axis.label.is_empty());
        let spared = if untitled { TITLE_FONT + 4.0 } else { 0.0 };
        Self { width, columns, rows, row_height, pitch: row_height + GAP.1 - spared, tagged }
    }

    fn height(&self) -> f64 {
        self.row_height + self.pitch * (self.rows - 1) as f64
    }

    /// Width of every frame, beside the room at the left and right of each column.
    fn frame_width(&self, sides: &[(f64, f64)]) -> f64 {
        let taken: f64 = sides.iter().map(|(left, right)| left + right).sum();
        let gaps = GAP.0 * (self.columns - 1) as f64;
        ((self.width - gaps - taken) / self.columns as f64).max(20.0)
    }

    /// Lays all panels out, each with the left end of its column; `heads` is the room each needs above
    /// its frame for a legend.
    fn plots<'a>(&self, figure: &'a Figure, heads: &[f64]) -> Vec<(f64, Plot<'a>)> {
        let panels = &figure.panels;
        let bottom = TICK_GAP + LABEL_FONT + 4.0 + TITLE_FONT + RIM;
        let column = |index: usize| index % self.columns;
        let row = |index: usize| index / self.columns;
        let mut head = 0.0_f64;
        for (panel, legend) in panels.iter().zip(heads) {
            let titled = if panel.title.is_empty() { 0.0 } else { HEAD };
            let tagged = if self.tagged { HEAD } else { 0.0 };
            head = head.max((titled + legend).max(tagged).max(RIM + 0.4 * LABEL_FONT));
        }
        let spans: Vec<(f64, f64)> = (0..panels.len())
            .map(|index| {
                let above = row(index) as f64 * self.pitch;
                (above + head, above + self.row_height - bottom)
            })
            .collect();

        let mut sides = vec![(0.0_f64, 0.0_f64); self.columns];
        let vertical = |(panel, &(top, low))| vertical(panel, top, f64::max(low, top + 10.0));
        let verticals: Vec<Ruler> = panels.iter().zip(&spans).map(vertical).collect();
        for (index, ruler) in verticals.iter().enumerate() {
            let (left, right) = &mut sides[column(index)];
            *left = left.max(TICK_GAP + ruler.label_width() + 6.0 + TITLE_FONT);
            let height = spans[index].1 - spans[index].0;
            let bar = panels[index].color_bar.as_ref().map_or(0.0, |bar| bar.room(height) + RIM);
            *right = right.max(bar).max(RIM);
        }
        // The last label of a horizontal axis may stick out of its frame.
        let width = self.frame_width(&sides);
        let mut out = vec![0.0_f64; self.columns];
        for (index, panel) in panels.iter().enumerate() {
            let room = width + sides[column(index)].1;
            let half = |label: &str| 0.5 * text::width(label, LABEL_FONT);
            let ruler = horizontal(panel, 0.0, width);
            let beyond = ruler.major.iter().map(|(x, label)| x + half(label) + 1.0 - room);
            out[column(index)] = beyond.fold(out[column(index)], f64::max);
        }
        for (side, out) in sides.iter_mut().zip(out) {
            side.1 += out;
        }
        let width = self.frame_width(&sides);
        let mut lefts = Vec::with_capacity(self.columns);
        let mut start = 0.0;
        for (left, right) in &sides {
            lefts.push(start + left);
            start += left + width + right + GAP.0;
        }
        panels
            .iter()
            .zip(verticals)
            .enumerate()
            .map(|(index, (panel, y))| {
                let left = lefts[column(index)];
                let right = left + width;
                let (top, bottom) = (spans[index].0, spans[index].1.max(spans[index].0 + 10.0));
                let frame = Frame { left, top, right, bottom };
                let start = left - sides[column(index)].0;
                (start, Plot { panel, frame, x: horizontal(panel, left, right), y })
            })
            .collect()
    }

    /// Tag and title of a panel, above its frame.
    fn head(
        &self,
        canvas: &mut Canvas,
        figure: &Figure,
        index: usize,
        (start, plot): (f64, &Plot<'_>),
        legend: f64,
    ) {
        let panel = &figure.panels[index];
        if self.tagged {
            let style = TextStyle::new(TITLE_FONT, Align::Left).bold();
            let before = figure.panels[..index].iter().filter(|panel| !panel.blank);
            canvas.text(start + 1.0, plot.frame.top - 5.0, &tag(before.count()), style);
        }
        let middle = 0.5 * (plot.frame.left + plot.frame.right);
        let style = TextStyle::new(TITLE_FONT, Align::Center);
        canvas.text(middle, plot.frame.top - 5.0 - legend, &panel.title, style);
    }
}

/// (a) to (z), then by number.
fn tag(index: usize) -> String {
    match u8::try_from(index) {
        Ok(index) if index < 26 => format!("({})", char::from(b'a' + index)),
        _ => format!("({})", index + 1),
    }
}

fn vertical(panel: &Panel, top: f64, bottom: f64) -> Ruler {
    let data = panel.series.iter().flat_map(|series| series.extent().map(|point| point.1));
    Ruler::new(&panel.y_axis, data, true, (bottom, top), false)
}

fn horizontal(panel: &Panel, left: f64, right: f64) -> Ruler {
    // Curves run from side to side; markers keep clear of the sides.
    let padded = panel.series.iter().any(|series| series.marker != Marker::None);
    let data = panel.series.iter().flat_map(|series| series.extent().map(|point| point.0));
    Ruler::new(&panel.x_axis, data, padded, (left, right), true)
}
