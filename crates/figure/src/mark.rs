//! Point symbols.

use crate::{
    Color, Marker, Panel,
    frame::Point,
    markup::{PX_PER_PT, number},
    svg::Canvas,
};
use std::fmt::Write as _;

/// Shape, size and colour of the markers of one series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MarkerStyle {
    pub(crate) marker: Marker,
    /// Diameter of the circle; the other symbols have about its area.
    pub(crate) size: f64,
    pub(crate) line: f64,
    pub(crate) color: Color,
    pub(crate) filled: bool,
}

impl MarkerStyle {
    /// Style of series `index` of a panel.
    pub(crate) fn of(panel: &Panel, index: usize) -> Self {
        let series = &panel.series[index];
        Self {
            marker: series.marker,
            size: series.marker_size * PX_PER_PT,
            line: (series.width * PX_PER_PT).min(1.1),
            color: panel.series_color(index),
            filled: series.filled,
        }
    }
}

/// Draws one symbol at each point.
pub(crate) fn draw(canvas: &mut Canvas, points: &[Point], style: &MarkerStyle) {
    let mut data = String::new();
    for &point in points {
        append(&mut data, point, style);
    }
    let open = matches!(style.marker, Marker::Cross | Marker::Plus);
    let fill = if open {
        "none".to_owned()
    } else if style.filled {
        style.color.to_string()
    } else {
        Color::WHITE.to_string()
    };
    let (color, width) = (style.color, number(style.line));
    canvas.path(
        &data,
        &format!(
            r#"fill="{fill}" stroke="{color}" stroke-width="{width}" stroke-linejoin="round" stroke-linecap="round""#
        ),
    );
}

fn append(data: &mut String, (x, y): Point, style: &MarkerStyle) {
    let r = style.size / 2.0;
    let moves = |pairs: &[(f64, f64)], close: &str| {
        let mut text = String::new();
        for (index, (dx, dy)) in pairs.iter().enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(text, "{command}{} {}", number(x + dx), number(y + dy));
        }
        text + close
    };
    let shape = match style.marker {
        Marker::None => String::new(),
        Marker::Circle => {
            let (radius, across) = (number(r), number(2.0 * r));
            format!(
                "M{} {}a{radius} {radius} 0 1 0 {across} 0a{radius} {radius} 0 1 0 -{across} 0Z",
                number(x - r),
                number(y)
            )
        }
        Marker::Triangle => {
            let h = 1.25 * r;
            moves(&[(0.0, -h), (0.866 * h, 0.5 * h), (-0.866 * h, 0.5 * h)], "Z")
        }
        Marker::Square => {
            let a = 0.89 * r;
            moves(&[(-a, -a), (a, -a), (a, a), (-a, a)], "Z")
        }
        Marker::Diamond => {
            let a = 1.25 * r;
            moves(&[(0.0, -a), (a, 0.0), (0.0, a), (-a, 0.0)], "Z")
        }
        Marker::Cross => {
            let a = 0.9 * r;
            moves(&[(-a, -a), (a, a)], "") + &moves(&[(-a, a), (a, -a)], "")
        }
        Marker::Plus => {
            let a = 1.15 * r;
            moves(&[(-a, 0.0), (a, 0.0)], "") + &moves(&[(0.0, -a), (0.0, a)], "")
        }
    };
    data.push_str(&shape);
}
