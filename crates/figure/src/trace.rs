//! Curves on the page: clipped to the frame, and decimated without visible loss.

use crate::{
    frame::{Frame, Point},
    markup::number,
};

/// Columns within which a curve is replaced by its first, lowest, highest and last point: half a
/// CSS pixel, 0.13 mm on paper.
pub(crate) const COLUMN: f64 = 0.5;

/// The runs of consecutive finite points.
pub(crate) fn finite_runs(points: &[Point]) -> Vec<Vec<Point>> {
    points
        .split(|point| !(point.0.is_finite() && point.1.is_finite()))
        .filter(|run| !run.is_empty())
        .map(<[Point]>::to_vec)
        .collect()
}

/// The visible parts of a curve; points that are not finite break it.
pub(crate) fn visible(points: &[Point], frame: &Frame) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for run in finite_runs(points) {
        let run = decimated(&run, COLUMN);
        if let [only] = run[..] {
            if frame.holds(only) {
                parts.push(vec![only]);
            }
            continue;
        }
        let mut open = false;
        for pair in run.windows(2) {
            let Some((start, end)) = frame.clip(pair[0], pair[1]) else {
                open = false;
                continue;
            };
            match parts.last_mut() {
                Some(part) if open => part.push(end),
                _ => parts.push(vec![start, end]),
            }
            open = end == pair[1];
        }
    }
    parts
}

/// Consecutive points of one column replaced by the first, the lowest, the highest and the last, in
/// their order: with columns of [`COLUMN`] the same pixels are covered.
pub(crate) fn decimated(points: &[Point], width: f64) -> Vec<Point> {
    // The whole number below, without a call.
    let column = |point: &Point| {
        let place = point.0 / width;
        let cut = place as i64;
        cut - i64::from(cut as f64 > place)
    };
    let mut kept = Vec::new();
    let mut rest = points;
    while let Some(first) = rest.first() {
        let own = column(first);
        let count = 1 + rest[1..].iter().take_while(|point| column(point) == own).count();
        let (group, others) = rest.split_at(count);
        rest = others;
        if group.len() <= 4 {
            kept.extend_from_slice(group);
            continue;
        }
        let (mut lowest, mut highest) = (0, 0);
        for (index, point) in group.iter().enumerate() {
            if point.1 < group[lowest].1 {
                lowest = index;
            }
            if point.1 > group[highest].1 {
                highest = index;
            }
        }
        let mut indices = [0, lowest, highest, group.len() - 1];
        indices.sort_unstable();
        let mut last = None;
        for index in indices {
            if last != Some(index) {
                kept.push(group[index]);
            }
            last = Some(index);
        }
    }
    kept
}

/// A polygon cut to the frame, side after side (Sutherland and Hodgman).
pub(crate) fn polygon(points: &[Point], frame: &Frame) -> Vec<Point> {
    let sides: [(usize, f64, f64); 4] = [
        (0, 1.0, frame.left),
        (0, -1.0, -frame.right),
        (1, 1.0, frame.top),
        (1, -1.0, -frame.bottom),
    ];
    let mut current = points.to_vec();
    for (coordinate, sign, limit) in sides {
        let depth = |p: Point| sign * (if coordinate == 0 { p.0 } else { p.1 }) - limit;
        let mut next = Vec::with_capacity(current.len());
        for (index, &end) in current.iter().enumerate() {
            let start = current[(index + current.len() - 1) % current.len()];
            let (before, after) = (depth(start), depth(end));
            if (before < 0.0) != (after < 0.0) {
                let t = before / (before - after);
                next.push((start.0 + t * (end.0 - start.0), start.1 + t * (end.1 - start.1)));
            }
            if after >= 0.0 {
                next.push(end);
            }
        }
        current = next;
    }
    current
}

/// SVG path data through the points of each part; a lone point becomes a dot.
pub(crate) fn path(parts: &[Vec<Point>], closed: bool) -> String {
    let mut data = String::new();
    for part in parts {
        let mut last = String::new();
        for (index, point) in part.iter().enumerate() {
            let pair = format!("{} {}", number(point.0), number(point.1));
            if pair == last {
                continue;
            }
            data.push_str(match index {
                0 => "M",
                _ if data.ends_with(|c: char| c.is_ascii_digit()) => " ",
                _ => "",
            });
            data.push_str(&pair);
            last = pair;
        }
        match (closed, part.len()) {
            (true, _) => data.push('Z'),
            (false, 1) => data.push_str("h0.01"),
            _ => {}
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 0.0, top: 0.0, right: 100.0, bottom: 50.0 };

    #[test]
    fn nan_breaks_the_line() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 1.0), (4.0, 1.0)];
        let parts = visible(&points, &FRAME);
        assert_eq!(parts.len(), 2);
        assert_eq!(path(&parts, false), "M0 1 1 2M3 1 4 1");
        assert_eq!(path(&visible(&points[..3][1..], &FRAME), false), "M1 2h0.01");
    }

    #[test]
    fn lines_end_at_the_frame() {
        let parts = visible(&[(-10.0, 10.0), (110.0, 10.0), (110.0, 20.0), (50.0, 20.0)], &FRAME);
        assert_eq!(parts, [vec![(0.0, 10.0), (100.0, 10.0)], vec![(100.0, 20.0), (50.0, 20.0)]]);
        assert!(visible(&[(-5.0, -5.0), (105.0, -5.0)], &FRAME).is_empty());
    }

    #[test]
    fn decimation_keeps_the_extremes() {
        let noise = |i: u32| f64::from(i.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24);
        let points: Vec<Point> =
            (0..24_000).map(|i| (f64::from(i) * 300.0 / 24_000.0, 50.0 * noise(i))).collect();
        let kept = decimated(&points, COLUMN);
        assert!(kept.len() <= 4 * 600, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
        for column in 0..600 {
            let extremes = |set: &[Point]| {
                set.iter()
                    .filter(|p| (p.0 / COLUMN).floor() as i32 == column)
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                        (low.min(p.1), high.max(p.1))
                    })
            };
            assert_eq!(extremes(&points), extremes(&kept));
        }
    }

    #[test]
    fn polygons_are_cut_to_the_frame() {
        let cut = polygon(&[(-10.0, 10.0), (50.0, 10.0), (50.0, 70.0), (-10.0, 70.0)], &FRAME);
        assert!(cut.iter().all(|&p| FRAME.holds(p)));
        assert_eq!(cut.len(), 4);
    }
}
