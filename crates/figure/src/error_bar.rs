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
    for [start, end] in segments(series, x, y, frame) {
        if let Some((a, b)) = frame.clip(start, end) {
            parts.push(vec![a, b]);
        }
        let vertical = start.0.to_bits() == end.0.to_bits();
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

/// Both ends of the bars of a series, in the frame or beyond.
pub(crate) fn segments(
    series: &Series,
    x: &AxisScale,
    y: &AxisScale,
    frame: &Frame,
) -> Vec<[Point; 2]> {
    // A lower end that a logarithmic axis cannot show lies beyond the frame.
    let beyond = |scale: &AxisScale, value: f64, side: f64| {
        if scale.log && value <= 0.0 { side } else { scale.datum(value) }
    };
    let ends = series.error_ends().map(|[low, high]| {
        let start = (beyond(x, low.0, frame.left), beyond(y, low.1, frame.bottom));
        [start, (x.datum(high.0), y.datum(high.1))]
    });
    ends.filter(|[start, end]| {
        let finite = [start.0, start.1, end.0, end.1].iter().all(|value| value.is_finite());
        finite && start != end
    })
    .collect()
}
