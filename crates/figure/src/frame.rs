//! Rectangles on the page, and the obstacles inside them.

/// A point on the page, in CSS pixels.
pub(crate) type Point = (f64, f64);

/// A rectangle on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Frame {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(crate) fn middle(&self) -> Point {
        (0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom))
    }

    /// True if the point lies inside or within a hundredth of a pixel of the border.
    pub(crate) fn holds(&self, (x, y): Point) -> bool {
        x >= self.left - 0.01
            && x <= self.right + 0.01
            && y >= self.top - 0.01
            && y <= self.bottom + 0.01
    }

    /// The rectangle grown by `by` on every side.
    pub(crate) fn grown(&self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            right: self.right + by,
            bottom: self.bottom + by,
        }
    }

    /// True if two rectangles share a point.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    /// The part of the segment inside, by the parametric method of Liang and Barsky.
    pub(crate) fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let sides = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        for (direction, distance) in sides {
            if direction == 0.0 {
                if distance < 0.0 {
                    return None;
                }
            } else if direction < 0.0 {
                enter = enter.max(distance / direction);
            } else {
                leave = leave.min(distance / direction);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        // The ends themselves, where they are inside, are kept to the bit.
        let start = if enter == 0.0 { a } else { at(enter) };
        let end = if leave == 1.0 { b } else { at(leave) };
        (enter <= leave).then_some((start, end))
    }
}

/// Curves, markers and texts that a legend or note keeps clear of.
#[derive(Debug, Clone, Default)]
pub(crate) struct Obstacles {
    pub(crate) lines: Vec<Vec<Point>>,
    pub(crate) points: Vec<Point>,
    pub(crate) boxes: Vec<Frame>,
    /// Outlines of bands; a legend keeps clear of them, a note may cover them.
    pub(crate) areas: Vec<Vec<Point>>,
}

impl Obstacles {
    /// True if anything but an area lies in `place`.
    pub(crate) fn meet(&self, place: &Frame) -> bool {
        self.boxes.iter().any(|other| place.meets(other))
            || self.points.iter().any(|&point| place.grown(2.0).holds(point))
            || crossed(&self.lines, place)
    }
}

/// True if a line passes through `place`.
pub(crate) fn crossed(lines: &[Vec<Point>], place: &Frame) -> bool {
    lines.iter().any(|line| match line[..] {
        [only] => place.holds(only),
        _ => line.windows(2).any(|pair| place.clip(pair[0], pair[1]).is_some()),
    })
}
