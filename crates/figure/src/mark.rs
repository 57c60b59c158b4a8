//! Point symbols.

use crate::{Color, Marker, svg::Canvas, svg::number, trace::Point};
use std::fmt::Write as _;

/// How the symbols of one series look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    pub(crate) marker: Marker,
    /// Diameter of the circle; the other symbols have about its area.
    pub(crate) size: f64,
    pub(crate) line: f64,
    pub(crate) color: Color,
    pub(crate) filled: bool,
}

/// Draws one symbol at each point.
pub(crate) fn draw(canvas: &mut Canvas, points: &[Point], look: &Look) {
    let mut data = String::new();
    for &point in points {
        append(&mut data, point, look);
    }
    let open = matches!(look.marker, Marker::Cross | Marker::Plus);
    let fill = if open {
        "none".to_owned()
    } else if look.filled {
        look.color.to_string()
    } else {
        Color::WHITE.to_string()
    };
    let (color, width) = (look.color, number(look.line));
    canvas.path(
        &data,
        &format!(
            r#"fill="{fill}" stroke="{color}" stroke-width="{width}" stroke-linejoin="round" stroke-linecap="round""#
        ),
    );
}

fn append(data: &mut String, (x, y): Point, look: &Look) {
    let r = look.size / 2.0;
    let moves = |pairs: &[(f64, f64)], close: &str| {
        let mut text = String::new();
        for (index, (dx, dy)) in pairs.iter().enumerate() {
            let command = if index == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(text, "{command}{} {}", number(x + dx), number(y + dy));
        }
        text + close
    };
    let shape = match look.marker {
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
