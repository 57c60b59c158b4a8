//! Shapes of mechanical symbols, in the unit of their points.

use crate::frame::Point;

/// A frame along a segment: its length, and the point `along` it and `across` to the left of it.
fn along(from: Point, to: Point) -> (f64, impl Fn(f64, f64) -> Point) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let (ux, uy) = if length > 0.0 { (dx / length, dy / length) } else { (1.0, 0.0) };
    (length, move |s: f64, n: f64| (from.0 + s * ux + n * uy, from.1 + s * uy - n * ux))
}

/// Head of an arrow that ends at `to`, of the given length or less on a short line, and the junction
/// of line and head.
pub(crate) fn arrow(from: Point, to: Point, head: f64) -> ([Point; 3], Point) {
    let (length, at) = along(from, to);
    let head = head.min(length);
    let half = 0.42 * head;
    let base = length - head;
    ([to, at(base, half), at(base, -half)], at(length - 0.8 * head, 0.0))
}

/// A zigzag between straight ends.
pub(crate) fn spring(from: Point, to: Point, width: f64) -> Vec<Point> {
    let (length, at) = along(from, to);
    let lead = 0.16 * length;
    let coil = length - 2.0 * lead;
    // Flanks of about sixty degrees, four to twelve of them.
    let flanks = ((coil / (0.55 * width)).round() as usize).clamp(4, 12) / 2 * 2;
    let mut points = vec![from, at(lead, 0.0)];
    for flank in 0..flanks {
        let s = lead + coil * (flank as f64 + 0.5) / flanks as f64;
        points.push(at(s, if flank % 2 == 0 { 0.5 * width } else { -0.5 * width }));
    }
    points.extend([at(length - lead, 0.0), to]);
    points
}

/// Rod, cup and piston of a dashpot.
pub(crate) fn damper(from: Point, to: Point, width: f64) -> Vec<Vec<Point>> {
    let (length, at) = along(from, to);
    let half = 0.5 * width;
    let (back, front, piston) = (0.34 * length, 0.66 * length, 0.52 * length);
    vec![
        vec![from, at(back, 0.0)],
        vec![at(front, half), at(back, half), at(back, -half), at(front, -half)],
        vec![at(piston, 0.72 * half), at(piston, -0.72 * half)],
        vec![at(piston, 0.0), to],
    ]
}

/// Lines at 45 degrees across a rectangle.
pub(crate) fn hatch(corner: Point, size: Point, spacing: f64) -> Vec<(Point, Point)> {
    let (width, height) = (size.0.abs(), size.1.abs());
    let step = spacing.max(0.05) * std::f64::consts::SQRT_2;
    let (left, top) = (corner.0.min(corner.0 + size.0), corner.1.min(corner.1 + size.1));
    let count = ((width + height) / step).floor().min(1e4) as usize;
    (1..=count)
        .map(|index| index as f64 * step)
        .map(|c| {
            // The line x + y = c, from its lower left to its upper right end.
            let low = (c - height).max(0.0);
            let high = c.min(width);
            ((left + low, top + c - low), (left + high, top + c - high))
        })
        .collect()
}

/// Slanted strokes at the right-hand side of a line.
pub(crate) fn ground(from: Point, to: Point) -> Vec<(Point, Point)> {
    let (length, at) = along(from, to);
    let count = (length / 1.6).round().clamp(1.0, 400.0);
    let depth = 1.3;
    (0..count as usize)
        .map(|index| {
            let s = (index as f64 + 0.75) * length / count;
            (at(s, 0.0), at(s - depth, -depth))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spring_joins_its_ends_within_its_width() {
        let points = spring((1.0, 2.0), (1.0, 12.0), 3.0);
        assert_eq!((points[0], points[points.len() - 1]), ((1.0, 2.0), (1.0, 12.0)));
        assert!(points.iter().all(|p| (p.0 - 1.0).abs() <= 1.5 + 1e-12));
        assert_eq!(points.len() % 2, 0);
    }

    #[test]
    fn hatching_stays_in_its_rectangle() {
        for (a, b) in hatch((10.0, 20.0), (7.0, 3.0), 1.0) {
            for (x, y) in [a, b] {
                assert!((10.0 - 1e-9..=17.0 + 1e-9).contains(&x), "{x}");
                assert!((20.0 - 1e-9..=23.0 + 1e-9).contains(&y), "{y}");
            }
        }
    }

    #[test]
    fn a_ground_lies_at_the_right_hand() {
        // From left to right, with y downwards, the right hand is below.
        assert!(ground((0.0, 5.0), (20.0, 5.0)).iter().all(|stroke| stroke.1.1 > 5.0));
    }

    #[test]
    fn shapes_of_no_length_are_finite() {
        let point = (1.0, 1.0);
        assert!(spring(point, point, 1.0).iter().all(|p| p.0.is_finite() && p.1.is_finite()));
        assert!(arrow(point, point, 1.0).1.0.is_finite());
    }
}
