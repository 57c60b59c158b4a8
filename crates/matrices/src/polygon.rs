//! Convex polygons in a plane.

use crate::face_shape::triangle_rule;

/// Corners of a polygon, anticlockwise.
pub(crate) type Polygon = Vec<[f64; 2]>;

/// Twice the area of the triangle `a`, `b`, `c`; positive if it is anticlockwise.
pub(crate) fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Area; negative if the corners are clockwise.
pub(crate) fn area(polygon: &[[f64; 2]]) -> f64 {
    let fan = polygon.windows(2).skip(1);
    fan.map(|pair| 0.5 * cross(polygon[0], pair[0], pair[1])).sum()
}

/// True if no corner of an anticlockwise polygon turns to the right by more than rounding.
pub(crate) fn is_convex(polygon: &[[f64; 2]]) -> bool {
    let (count, size) = (polygon.len(), area(polygon));
    let turn = |i: usize| cross(polygon[i], polygon[(i + 1) % count], polygon[(i + 2) % count]);
    size > 0.0 && (0..count).all(|i| turn(i) >= -1e-9 * size)
}

/// The part of `polygon` inside the convex anticlockwise polygon `clip`; empty if there is none.
/// Source: I. E. Sutherland, G. W. Hodgman, Commun. ACM 1974, 17, 32, doi 10.1145/360767.360802.
pub(crate) fn clipped(polygon: &[[f64; 2]], clip: &[[f64; 2]]) -> Polygon {
    let mut inside = polygon.to_vec();
    for (i, &from) in clip.iter().enumerate() {
        let to = clip[(i + 1) % clip.len()];
        let mut kept = Polygon::with_capacity(inside.len() + 1);
        for (k, &point) in inside.iter().enumerate() {
            let before = inside[(k + inside.len() - 1) % inside.len()];
            let (here, there) = (cross(from, to, point), cross(from, to, before));
            if (here < 0.0) != (there < 0.0) {
                let share = there / (there - here);
                kept.push([0, 1].map(|x| before[x] + share * (point[x] - before[x])));
            }
            if here >= 0.0 {
                kept.push(point);
            }
        }
        inside = kept;
        if inside.len() < 3 {
            return Polygon::new();
        }
    }
    inside
}

/// Points and weights \[area\] of a rule over a convex polygon that is exact to the fifth degree.
pub(crate) fn rule(polygon: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
    let mut points = Vec::new();
    for pair in polygon.windows(2).skip(1) {
        let (a, b, c) = (polygon[0], pair[0], pair[1]);
        let double = cross(a, b, c);
        for ([x, y], weight) in triangle_rule() {
            let place = [0, 1].map(|k| a[k] + x * (b[k] - a[k]) + y * (c[k] - a[k]));
            points.push((place, double * weight));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];

    #[test]
    fn polygons_are_clipped() {
        let diamond = [[1.0, -1.0], [3.0, 1.0], [1.0, 3.0], [-1.0, 1.0]];
        assert!((area(&clipped(&diamond, &SQUARE)) - 4.0).abs() < 1e-15);
        let triangle = [[1.0, 1.0], [5.0, 1.0], [1.0, 5.0]];
        assert!((area(&clipped(&triangle, &SQUARE)) - 1.0).abs() < 1e-15);
        let beside = [[2.5, 0.0], [3.0, 0.0], [3.0, 1.0]];
        assert!(clipped(&beside, &SQUARE).is_empty());
        assert!(is_convex(&SQUARE));
        assert!(!is_convex(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]));
    }

    #[test]
    fn integrals_over_a_polygon_are_exact() {
        let sum: f64 = rule(&SQUARE).iter().map(|([x, y], w)| w * x.powi(3) * y * y).sum();
        assert!((sum - 4.0 * 8.0 / 3.0).abs() < 1e-13);
    }
}
