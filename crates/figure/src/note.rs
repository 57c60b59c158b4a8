//! Texts inside a frame: in a corner, along reference lines, at points.

use crate::{
    Anchor, Color,
    frame::{Frame, Obstacles, Point},
    panel::{Note, ReferenceLine},
    plot::{MARKS, Plot},
    svg::{Align, Canvas, TextStyle},
    text::{self, LABEL_FONT},
};

/// Room between a point and its note.
const CLEAR: f64 = 6.0;
/// Room between a text and curves, markers and other texts.
const LINE_ROOM: f64 = 1.5;
/// Distance of the lines of text at which a place beside a vertical is looked for.
const LINE: f64 = 1.4 * LABEL_FONT;
/// Half the height of a capital.
const HALF: f64 = 0.5 * text::CAP_HEIGHT * LABEL_FONT;

/// A line of text on the page.
#[derive(Debug, Clone)]
struct Label {
    at: Point,
    text: String,
    style: TextStyle,
}

/// Draws the texts of a panel.
pub(crate) fn draw(canvas: &mut Canvas, plot: &Plot<'_>) {
    let has_texts = plot.panel.references.iter().any(|line| !line.text.is_empty());
    if !has_texts && plot.panel.notes.is_empty() {
        return;
    }
    for label in labels(plot).0 {
        canvas.text(label.at.0, label.at.1, &label.text, label.style);
    }
}

/// Curves, markers and texts that a legend must not cover.
pub(crate) fn obstacles(plot: &Plot<'_>) -> Obstacles {
    labels(plot).1
}

/// The texts, each at its first free place, and all obstacles for a legend.
fn labels(plot: &Plot<'_>) -> (Vec<Label>, Obstacles) {
    let mut obstacles = plot.curves();
    let mut labels = Vec::new();
    // Texts keep clear of the marks of the axes.
    let frame = plot.frame.grown(-MARKS.0);
    let mut place = |candidates: Vec<Label>| {
        let free = candidates.iter().find(|label| {
            let bounds = label.bounds();
            let inside = frame.holds((bounds.left, bounds.top))
                && frame.holds((bounds.right, bounds.bottom));
            inside && !obstacles.meet(&bounds.grown(LINE_ROOM))
        });
        if let Some(label) = free.or(candidates.first()) {
            obstacles.boxes.push(label.bounds());
            labels.push(label.clone());
        }
    };
    for reference in plot.panel.references.iter().filter(|line| !line.text.is_empty()) {
        place(beside_line(plot, reference));
    }
    for note in &plot.panel.notes {
        place(beside_point(plot, note));
    }
    (labels, obstacles)
}

/// Both sides of both ends of a reference line, the last end first; of a vertical then down along it.
fn beside_line(plot: &Plot<'_>, reference: &ReferenceLine) -> Vec<Label> {
    let Some(line) = plot.reference_line(reference) else {
        return Vec::new();
    };
    let ends = [line[line.len() - 1], line[0]];
    let color = Color::GREY.mix(Color::BLACK, 0.4);
    let label = |at, align| Label::new(at, &reference.text, align, color);
    let y = ends[0].1;
    let (heights, sides) = if reference.vertical {
        let sides = [(ends[0].0 + 4.0, Align::Left), (ends[0].0 - 4.0, Align::Right)];
        let (first, last) = (y + 14.0, ends[1].1 - 9.0);
        let lines = ((last - first) / LINE).max(0.0) as usize;
        let between = (1..=lines).map(|line| first + LINE * line as f64);
        ([first, last].into_iter().chain(between).collect::<Vec<f64>>(), sides)
    } else {
        let sides = [(ends[0].0 - 7.0, Align::Right), (ends[1].0 + 7.0, Align::Left)];
        (vec![y - 3.5, y + 3.5 + 2.0 * HALF], sides)
    };
    heights.into_iter().flat_map(|y| sides.map(|(x, align)| label((x, y), align))).collect()
}

/// The chosen side of a point, or all eight around it, then further to the sides.
fn beside_point(plot: &Plot<'_>, note: &Note) -> Vec<Label> {
    let (x, y) = (plot.x.scale.datum(note.x), plot.y.scale.datum(note.y));
    if !plot.frame.holds((x, y)) {
        return Vec::new();
    }
    let label_at = |times: f64, (dx, dy, align): (f64, f64, _)| {
        Label::new((x + times * dx, y + dy), &note.text, align, note.color)
    };
    let label = |place| label_at(1.0, place);
    let (right, left) = ((CLEAR, HALF, Align::Left), (-CLEAR, HALF, Align::Right));
    let (above, below) = ((0.0, -CLEAR, Align::Center), (0.0, CLEAR + 2.0 * HALF, Align::Center));
    let (up, down) = (-0.6 * CLEAR, 0.6 * CLEAR + 2.0 * HALF);
    let side = 0.6 * CLEAR;
    match note.anchor {
        Anchor::Right => vec![label(right)],
        Anchor::Left => vec![label(left)],
        Anchor::Above => vec![label(above)],
        Anchor::Below => vec![label(below)],
        Anchor::Center => vec![label((0.0, HALF, Align::Center))],
        Anchor::Auto => {
            let (right_up, right_down) = ((side, up, Align::Left), (side, down, Align::Left));
            let (left_up, left_down) = ((-side, up, Align::Right), (-side, down, Align::Right));
            let mut around = [right, left, above, below, left_up, right_up, right_down, left_down];
            let width = text::width(&note.text, LABEL_FONT);
            if x + CLEAR + width > plot.frame.right {
                around.swap(0, 1);
            }
            // A text further away is still told from others by its height.
            let further = [4.0, 8.0].into_iter().flat_map(|times| {
                around.iter().filter(|place| place.0 != 0.0).map(move |place| (times, *place))
            });
            let near = around.iter().map(|place| (1.0, *place));
            near.chain(further).map(|(times, place)| label_at(times, place)).collect()
        }
    }
}

impl Label {
    fn new(at: Point, text: &str, align: Align, color: Color) -> Self {
        let style = TextStyle::new(LABEL_FONT, align).color(color).halo();
        Self { at, text: text.to_owned(), style }
    }

    fn bounds(&self) -> Frame {
        let width = text::width(&self.text, LABEL_FONT);
        let left = match self.style.align {
            Align::Left => self.at.0,
            Align::Center => self.at.0 - 0.5 * width,
            Align::Right => self.at.0 - width,
        };
        let (top, bottom) = (self.at.1 - 0.8 * LABEL_FONT, self.at.1 + 0.22 * LABEL_FONT);
        Frame { left, top, right: left + width, bottom }
    }
}
