//! Strokes: colour, width and dashes of a line.

use crate::{
    Color, Dash,
    frame::Point,
    markup::{PX_PER_PT, number},
    svg::Canvas,
    trace,
};

/// Strokes the parts of a curve.
pub(crate) fn stroke(
    canvas: &mut Canvas,
    parts: &[Vec<Point>],
    color: Color,
    dash: Dash,
    points: f64,
) {
    let style = format!(r#"fill="none" {}"#, line_style(color, dash, points));
    canvas.path(&trace::path(parts, false), &style);
}

/// The attributes of a line `points` wide.
pub(crate) fn line_style(color: Color, dash: Dash, points: f64) -> String {
    let width = points * PX_PER_PT;
    let lengths: &[f64] = match dash {
        Dash::Solid => &[],
        Dash::Dashed => &[4.2, 2.4],
        Dash::Dotted => &[0.01, 2.3],
        Dash::DashDot => &[5.0, 2.2, 0.01, 2.2],
    };
    let cap = if dash == Dash::Dashed { "butt" } else { "round" };
    // Dashes follow the line width, but thin lines do not get crowded dashes.
    let unit = width.max(1.1);
    let list: Vec<String> = lengths.iter().map(|length| number(length * unit)).collect();
    let list = if list.is_empty() {
        String::new()
    } else {
        format!(r#" stroke-dasharray="{}""#, list.join(" "))
    };
    format!(
        r#"stroke="{color}" stroke-width="{}" stroke-linejoin="round" stroke-linecap="{cap}"{list}"#,
        number(width)
    )
}
