//! A sketch in millimetres: bodies, grids, springs, arrows, texts.

use crate::{
    Color, Dash, FigureError,
    frame::Point,
    line,
    markup::{PX_PER_MM, PX_PER_PT},
    raster,
    svg::{Canvas, TextStyle},
    symbol, text, trace,
};

/// Colour, width and pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width in points.
    pub width: f64,
    /// Pattern.
    pub dash: Dash,
}

impl Stroke {
    /// A solid line.
    pub const fn new(color: Color, width: f64) -> Self {
        Self { color, width, dash: Dash::Solid }
    }

    /// A solid black line of 0.8 points.
    pub const BLACK: Self = Self::new(Color::BLACK, 0.8);

    /// A solid grey line of 0.5 points.
    pub const THIN: Self = Self::new(Color::GREY, 0.5);
}

/// Horizontal alignment of a text on its point; vertically it is centred on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Align {
    /// The text starts at the point.
    Left,
    /// The text is centred on the point.
    #[default]
    Center,
    /// The text ends at the point.
    Right,
}

/// A canvas in millimetres, x to the right and y downwards from the top left corner.
///
/// ```
/// use asperity_figure::{Align, Color, Drawing, Stroke};
/// let mut drawing = Drawing::new("Mass on a spring", 40.0, 30.0);
/// drawing.rect((10.0, 4.0), (20.0, 8.0), Some(Color::LIGHT_GREY), Some(Stroke::BLACK));
/// drawing.spring((20.0, 12.0), (20.0, 25.0), 2.5, Stroke::BLACK);
/// drawing.ground((10.0, 25.0), (30.0, 25.0), Stroke::BLACK);
/// drawing.text((20.0, 8.0), "m", 8.0, Align::Center);
/// assert!(drawing.to_svg().starts_with("<svg"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    title: String,
    width: f64,
    height: f64,
    canvas: Canvas,
}

fn page((x, y): Point) -> Point {
    (x * PX_PER_MM, y * PX_PER_MM)
}

impl Drawing {
    /// An empty sketch, `width` by `height` in millimetres.
    pub fn new(title: impl Into<String>, width: f64, height: f64) -> Self {
        Self { title: title.into(), width, height, canvas: Canvas::default() }
    }

    /// A rectangle by its top left corner and its size.
    pub fn rect(
        &mut self,
        corner: (f64, f64),
        size: (f64, f64),
        fill: Option<Color>,
        stroke: Option<Stroke>,
    ) {
        let (x, y, w, h) = (corner.0, corner.1, size.0, size.1);
        self.polygon(&[(x, y), (x + w, y), (x + w, y + h), (x, y + h)], fill, stroke);
    }

    /// A closed polygon.
    pub fn polygon(&mut self, points: &[(f64, f64)], fill: Option<Color>, stroke: Option<Stroke>) {
        let points: Vec<Point> = points.iter().copied().map(page).collect();
        let data = trace::path(&trace::finite_runs(&points), true);
        self.canvas.path(&data, &style(fill, stroke));
    }

    /// A straight line.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// A line through points; points that are not finite break it.
    pub fn polyline(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let points: Vec<Point> = points.iter().copied().map(page).collect();
        let parts = trace::finite_runs(&points);
        line::stroke(&mut self.canvas, &parts, stroke.color, stroke.dash, stroke.width);
    }

    /// A circle by its centre and radius.
    pub fn circle(
        &mut self,
        center: (f64, f64),
        radius: f64,
        fill: Option<Color>,
        stroke: Option<Stroke>,
    ) {
        let (x, y) = page(center);
        self.canvas.circle(x, y, radius * PX_PER_MM, &style(fill, stroke));
    }

    /// A line of text of `points` size, centred vertically on `at`; `_{}` and `^{}` are set low and
    /// high.
    pub fn text(&mut self, at: (f64, f64), text: &str, points: f64, align: Align) {
        self.styled_text(at, text, points, align, Color::BLACK, 0.0);
    }

    /// A line of text in a colour, turned anticlockwise by `degrees` about `at`.
    pub fn styled_text(
        &mut self,
        at: (f64, f64),
        text: &str,
        points: f64,
        align: Align,
        color: Color,
        degrees: f64,
    ) {
        let size = points * PX_PER_PT;
        // The baseline lies half a capital below the centre, in the turned direction.
        let drop = 0.5 * text::CAP_HEIGHT * size;
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let (x, y) = page(at);
        let style = TextStyle::new(size, align).color(color).turned(degrees);
        self.canvas.text(x + drop * sine, y + drop * cosine, text, style);
    }

    /// A line with a head at its end.
    pub fn arrow(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        let (head, neck) = symbol::arrow(from, to, 1.0 + 0.9 * stroke.width);
        self.line(from, neck, stroke);
        let solid = Stroke { width: 0.2, dash: Dash::Solid, ..stroke };
        self.polygon(&head, Some(stroke.color), Some(solid));
    }

    /// A line with heads at both ends and a text beside its middle.
    pub fn dimension(&mut self, from: (f64, f64), to: (f64, f64), text: &str, stroke: Stroke) {
        let middle = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        self.arrow(middle, from, stroke);
        self.arrow(middle, to, stroke);
        if (to.0 - from.0).abs() < (to.1 - from.1).abs() {
            self.text((middle.0 + 1.2, middle.1), text, 7.0, Align::Left);
        } else {
            self.text((middle.0, middle.1 - 2.2), text, 7.0, Align::Center);
        }
    }

    /// A zigzag spring of `width` millimetres between two points.
    pub fn spring(&mut self, from: (f64, f64), to: (f64, f64), width: f64, stroke: Stroke) {
        self.polyline(&symbol::spring(from, to, width), stroke);
    }

    /// A dashpot of `width` millimetres between two points.
    pub fn damper(&mut self, from: (f64, f64), to: (f64, f64), width: f64, stroke: Stroke) {
        for part in symbol::damper(from, to, width) {
            self.polyline(&part, stroke);
        }
    }

    /// A rectangle filled with slanted lines `spacing` millimetres apart.
    pub fn hatch(&mut self, corner: (f64, f64), size: (f64, f64), spacing: f64, stroke: Stroke) {
        for (from, to) in symbol::hatch(corner, size, spacing) {
            self.line(from, to, stroke);
        }
    }

    /// A fixed edge: a line with slanted strokes at its right-hand side, seen from `from` to `to`.
    pub fn ground(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.line(from, to, stroke);
        let thin = Stroke { width: 0.6 * stroke.width, ..stroke };
        for (start, end) in symbol::ground(from, to) {
            self.line(start, end, thin);
        }
    }

    /// The sketch as an SVG text.
    pub fn to_svg(&self) -> String {
        let (width, height) = page((self.width, self.height));
        self.canvas.clone().finish(width, height, &self.title)
    }

    /// The sketch as a PNG, rasterised with the bundled font.
    ///
    /// # Errors
    /// Those of [`svg_to_png`](crate::svg_to_png).
    pub fn to_png(&self, pixels_per_mm: f64) -> Result<Vec<u8>, FigureError> {
        raster::svg_to_png(&self.to_svg(), pixels_per_mm)
    }
}

fn style(fill: Option<Color>, stroke: Option<Stroke>) -> String {
    let fill = fill.map_or_else(|| "none".to_owned(), |color| color.to_string());
    let stroke = stroke.map_or_else(String::new, |stroke| {
        let line = line::line_style(stroke.color, stroke.dash, stroke.width);
        format!(" {line}")
    });
    format!(r#"fill="{fill}"{stroke}"#)
}
