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
    let cap = if dash == Dash::Dashed { "butt" } else { "round" };
    let list = match dash_array(dash, points) {
        list if list.is_empty() => list,
        list => format!(r#" stroke-dasharray="{list}""#),
    };
    format!(
        r#"stroke="{color}" stroke-width="{}" stroke-linejoin="round" stroke-linecap="{cap}"{list}"#,
        number(points * PX_PER_PT)
    )
}

/// Lengths of dashes and gaps of a line `points` wide; empty for a solid one.
pub(crate) fn dash_array(dash: Dash, points: f64) -> String {
    let lengths: &[f64] = match dash {
        Dash::Solid => &[],
        Dash::Dashed => &[4.2, 2.4],
        Dash::Dotted => &[0.01, 2.3],
        Dash::DashDot => &[5.0, 2.2, 0.01, 2.2],
    };
    // Dashes follow the line width, but thin lines do not get crowded dashes.
    let unit = (points * PX_PER_PT).max(1.1);
    let list: Vec<String> = lengths.iter().map(|length| number(length * unit)).collect();
    list.join(" ")
}
