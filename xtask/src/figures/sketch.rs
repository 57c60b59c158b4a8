//! A sketch in millimetres as SVG: bodies, springs, arrows, texts; x to the right, y downwards.

use std::fmt::Write as _;

use asperity_figure::Color;

/// Millimetres a point.
const POINT: f64 = 25.4 / 72.0;
/// Height of a capital over the font size.
const CAP_HEIGHT: f64 = 0.727;

/// A place, or a size, in millimetres.
pub(super) type Point = (f64, f64);

/// Colour and width of a line, in points.
#[derive(Clone, Copy)]
pub(super) struct Stroke(pub(super) Color, pub(super) f64);

impl Stroke {
    pub(super) const BLACK: Self = Self(Color::BLACK, 0.8);
    pub(super) const THIN: Self = Self(Color::GREY, 0.5);
}

/// Horizontal alignment of a text on its point; vertically it is centred on it.
#[derive(Clone, Copy)]
pub(super) enum Align {
    Left,
    Center,
    Right,
}

/// The shapes drawn so far.
pub(super) struct Sketch {
    body: String,
    size: Point,
    title: &'static str,
}

impl Sketch {
    pub(super) fn new(title: &'static str, width: f64, height: f64) -> Self {
        Self { body: String::new(), size: (width, height), title }
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[Point], stroke: Stroke) {
        self.shape("polyline", points, None, stroke);
    }

    /// A filled rectangle by its top left corner and its size.
    pub(super) fn rect(&mut self, (x, y): Point, (w, h): Point, fill: Color, stroke: Stroke) {
        let corners = [(x, y), (x + w, y), (x + w, y + h), (x, y + h)];
        self.shape("polygon", &corners, Some(fill), stroke);
    }

    /// A filled circle.
    pub(super) fn circle(&mut self, (x, y): Point, radius: f64, fill: Color, stroke: Stroke) {
        let place = format!(r#"cx="{x:.3}" cy="{y:.3}" r="{radius:.3}""#);
        self.element("circle", &place, Some(fill), stroke);
    }

    /// A line of text of some points' size; it holds no character that XML would have escaped.
    pub(super) fn text(&mut self, at: Point, text: &str, points: f64, align: Align, color: Color) {
        let anchor = match align {
            Align::Left => "start",
            Align::Center => "middle",
            Align::Right => "end",
        };
        let size = points * POINT;
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.body,
            r#"<text x="{:.3}" y="{:.3}" font-size="{size:.3}" text-anchor="{anchor}" fill="{color}">{text}</text>"#,
            at.0,
            at.1 + 0.5 * CAP_HEIGHT * size,
        );
    }

    /// A line with a head at its end.
    pub(super) fn arrow(&mut self, from: Point, to: Point, stroke: Stroke) {
        let (length, at) = along(from, to);
        let head = (1.0 + 0.9 * stroke.1).min(length);
        let (base, half) = (length - head, 0.42 * head);
        self.line(&[from, at(length - 0.8 * head, 0.0)], stroke);
        let head = [to, at(base, half), at(base, -half)];
        self.shape("polygon", &head, Some(stroke.0), Stroke(stroke.0, 0.2));
    }

    /// A vertical line with heads at both ends and a text at the right of its middle.
    pub(super) fn height(&mut self, from: Point, to: Point, text: &str, stroke: Stroke) {
        let middle = (from.0, 0.5 * (from.1 + to.1));
        self.arrow(middle, from, stroke);
        self.arrow(middle, to, stroke);
        self.text((middle.0 + 1.2, middle.1), text, 7.0, Align::Left, Color::BLACK);
    }

    /// A zigzag spring of `width` millimetres.
    pub(super) fn spring(&mut self, from: Point, to: Point, width: f64, stroke: Stroke) {
        let (length, at) = along(from, to);
        let lead = 0.16 * length;
        let coil = length - 2.0 * lead;
        // Flanks of about sixty degrees, four to twelve of them.
        let flanks = ((coil / (0.55 * width)).round() as u32).clamp(4, 12) / 2 * 2;
        let mut points = vec![from, at(lead, 0.0)];
        points.extend((0..flanks).map(|flank| {
            let side = if flank % 2 == 0 { 0.5 } else { -0.5 };
            at(lead + coil * (f64::from(flank) + 0.5) / f64::from(flanks), side * width)
        }));
        points.extend([at(length - lead, 0.0), to]);
        self.line(&points, stroke);
    }

    /// Lines at 45 degrees across a rectangle, `spacing` millimetres apart.
    pub(super) fn hatch(&mut self, (x, y): Point, (w, h): Point, spacing: f64, stroke: Stroke) {
        let step = spacing * std::f64::consts::SQRT_2;
        let count = ((w + h) / step) as u32;
        for c in (1..=count).map(|index| f64::from(index) * step) {
            let (low, high) = ((c - h).max(0.0), c.min(w));
            self.line(&[(x + low, y + c - low), (x + high, y + c - high)], stroke);
        }
    }

    /// A fixed edge: a line with slanted strokes at its right-hand side, seen from `from` to `to`.
    pub(super) fn ground(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.line(&[from, to], stroke);
        let (length, at) = along(from, to);
        let count = (length / 1.6).round();
        for index in 0..count as u32 {
            let s = (f64::from(index) + 0.75) * length / count;
            self.line(&[at(s, 0.0), at(s - 1.3, -1.3)], Stroke(stroke.0, 0.6 * stroke.1));
        }
    }

    /// The sketch as an SVG text.
    pub(super) fn to_svg(&self) -> String {
        let ((width, height), title, body) = (self.size, self.title, &self.body);
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}" font-family="Inter, Noto Sans Math, Helvetica, Arial, sans-serif" role="img">
<title>{title}</title>
<rect width="{width}" height="{height}" fill="#ffffff"/>
{body}</svg>
"##
        )
    }

    fn shape(&mut self, kind: &str, points: &[Point], fill: Option<Color>, stroke: Stroke) {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.3},{y:.3}")).collect();
        self.element(kind, &format!(r#"points="{}""#, points.join(" ")), fill, stroke);
    }

    fn element(
        &mut self,
        kind: &str,
        place: &str,
        fill: Option<Color>,
        Stroke(color, width): Stroke,
    ) {
        let fill = fill.map_or_else(|| "none".to_owned(), |color| color.to_string());
        let width = width * POINT;
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.body,
            r#"<{kind} {place} fill="{fill}" stroke="{color}" stroke-width="{width:.3}" stroke-linejoin="round" stroke-linecap="round"/>"#
        );
    }
}

/// The length of a segment, and the point `along` it and `across` to the left of it.
fn along(from: Point, to: Point) -> (f64, impl Fn(f64, f64) -> Point) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (ux, uy) = (dx / length, dy / length);
    (length, move |s: f64, n: f64| (from.0 + s * ux + n * uy, from.1 + s * uy - n * ux))
}
