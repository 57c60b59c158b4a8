//! Error bars on the page.

use crate::{
    frame::{Frame, Point},
    scale::AxisScale,
    series::Series,
};

/// Half the length of a cap.
const CAP: f64 = 2.2;

/// The bars of a series and their caps, cut to the frame.
pub(crate) fn parts(
    series: &Series,
    x: &AxisScale,
    y: &AxisScale,
    frame: &Frame,
) -> Vec<Vec<Point>> {
    let mut parts = Vec::new();
    for [low, high] in series.error_ends() {
        // A lower end that a logarithmic axis cannot show lies beyond the frame.
        let place = |at: (f64, f64), (left, bottom): (f64, f64)| {
            let beyond = |scale: &AxisScale, value: f64, side: f64| {
                if scale.log && value <= 0.0 { side } else { scale.datum(value) }
            };
            (beyond(x, at.0, left), beyond(y, at.1, bottom))
        };
        let (start, end) =
            (place(low, (frame.left, frame.bottom)), (x.datum(high.0), y.datum(high.1)));
        let finite = [start.0, start.1, end.0, end.1].iter().all(|value| value.is_finite());
        if !finite || start == end {
            continue;
        }
        if let Some((a, b)) = frame.clip(start, end) {
            parts.push(vec![a, b]);
        }
        let vertical = low.0.to_bits() == high.0.to_bits();
        for tip in [start, end] {
            let cap = if vertical { (CAP, 0.0) } else { (0.0, CAP) };
            let sides = ((tip.0 - cap.0, tip.1 - cap.1), (tip.0 + cap.0, tip.1 + cap.1));
            if frame.holds(tip)
                && let Some((a, b)) = frame.clip(sides.0, sides.1)
            {
                parts.push(vec![a, b]);
            }
        }
    }
    parts
}
