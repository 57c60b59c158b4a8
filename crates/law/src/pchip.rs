//! Slopes of a monotone piecewise cubic through points (PCHIP).

use crate::spliced::SplicedNode;

/// The pieces between points `(pressure, stiffness)` with given slopes.
pub(crate) fn pieces(points: &[(f64, f64)], slopes: &[f64]) -> Vec<[SplicedNode; 2]> {
    let nodes: Vec<SplicedNode> = points
        .iter()
        .zip(slopes)
        .map(|(&(pressure, stiffness), &slope)| SplicedNode { pressure, stiffness, slope })
        .collect();
    nodes.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Slopes at the points `(x, y)`, x strictly increasing, at least two points.
///
/// Inside, the weighted harmonic mean of the neighbouring secants, zero at a local extremum; at
/// the ends the one-sided three-point formula, limited so that the cell stays monotone. Two points give a
/// straight line.
///
/// Source: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984), doi 10.1137/0905021;
/// the formulas are those of SciPy's `PchipInterpolator`.
pub(crate) fn slopes(points: &[(f64, f64)]) -> Vec<f64> {
    let h: Vec<f64> = points.windows(2).map(|w| w[1].0 - w[0].0).collect();
    let secant: Vec<f64> =
        points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
    let last = h.len() - 1;
    if last == 0 {
        return vec![secant[0]; 2];
    }
    let mut slopes = vec![end(h[0], h[1], secant[0], secant[1])];
    for k in 1..=last {
        slopes.push(inner(h[k - 1], h[k], secant[k - 1], secant[k]));
    }
    slopes.push(end(h[last], h[last - 1], secant[last], secant[last - 1]));
    slopes
}

/// Slope between two cells of widths `h` and secants `s`.
fn inner(h0: f64, h1: f64, s0: f64, s1: f64) -> f64 {
    if s0 * s1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / s0 + w1 / s1)
}

/// Slope at an end whose cell has width `h0` and secant `s0`, the next cell `h1` and `s1`.
fn end(h0: f64, h1: f64, s0: f64, s1: f64) -> f64 {
    let slope = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
    if slope * s0 <= 0.0 {
        0.0
    } else if s0 * s1 < 0.0 && slope.abs() > 3.0 * s0.abs() {
        3.0 * s0
    } else {
        slope
    }
}

/// Steepest end slope \[in secants\] with which a cubic cell stays monotone, when the slope at its
/// other end is `other` secants, 0 <= `other` <= 3.
///
/// The cubic with end slopes a and b (in secants) is monotone inside and on the ellipse
/// `a^2 + a b + b^2 - 6 a - 6 b + 9 = 0` and below it; this is its upper branch. It is 3 at both
/// ends of the range, and never less between.
///
/// Source: Fritsch and Carlson, SIAM J. Numer. Anal. 17, 238 (1980), doi 10.1137/0717021.
pub(crate) fn steepest(other: f64) -> f64 {
    0.5 * (6.0 - other + (3.0 * other * (4.0 - other)).max(0.0).sqrt())
}
