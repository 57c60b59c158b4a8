//! Point symbols.

use crate::{
    Color, Marker,
    frame::Point,
    markup::{PX_PER_PT, number},
    series::Series,
    svg::Canvas,
};
use std::fmt::Write as _;

/// Draws one symbol at each point.
pub(crate) fn draw(canvas: &mut Canvas, points: &[Point], series: &Series, color: Color) {
    let radius = 0.5 * series.marker_size * PX_PER_PT;
    let data: String = points.iter().map(|&point| symbol(series.marker, point, radius)).collect();
    canvas.path(&data, &style(series, color));
}

/// Path data and attributes of the symbol of a series at the origin.
pub(crate) fn at_origin(series: &Series, color: Color) -> (String, String) {
    let radius = 0.5 * series.marker_size * PX_PER_PT;
    (symbol(series.marker, (0.0, 0.0), radius), style(series, color))
}

fn style(series: &Series, color: Color) -> String {
    let fill = match series.marker {
        Marker::Cross | Marker::Plus => "none".to_owned(),
        _ if series.filled => color.to_string(),
        _ => Color::WHITE.to_string(),
    };
    let width = number((series.width * PX_PER_PT).min(1.1));
    format!(
        r#"fill="{fill}" stroke="{color}" stroke-width="{width}" stroke-linejoin="round" stroke-linecap="round""#
    )
}

/// Path data of a symbol about the area of a circle of radius `r`.
fn symbol(marker: Marker, (x, y): Point, r: f64) -> String {
    let moves = |pairs: &[(f64, f64)], close: &str| {
        let mut text = String::new();
        for (index, (dx, dy)) in pairs.iter().enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(text, "{command}{} {}", number(x + dx), number(y + dy));
        }
        text + close
    };
    match marker {
        Marker::None => String::new(),
        Marker::Circle => {
            let [left, y, r, d] = [x - r, y, r, 2.0 * r].map(number);
            format!("M{left} {y}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z")
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
    }
}
