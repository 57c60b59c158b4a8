//! The legend: its entries, their size, and a place where they cover no data.

use crate::{
    Color, Legend, Panel,
    frame::{Frame, Obstacles, crossed},
    line::stroke,
    mark,
    series::{Join, Series},
    svg::{Align, Canvas, TextStyle},
    text::{self, LABEL_FONT},
};

/// Height of an entry.
const LINE: f64 = LABEL_FONT * 1.36;
/// Length of the sample of a line, and of a marker where no entry has a line.
const SAMPLES: (f64, f64) = (19.0, 8.0);
/// Room between the sample and the name.
const GAP: f64 = 5.0;
/// Room between columns.
const COLUMN_GAP: f64 = 12.0;
/// Room between the legend and the frame, and between the legend and the data.
const CLEAR: f64 = 5.0;

/// The legend entries of one panel, in columns.
#[derive(Debug, Clone)]
pub(crate) struct LegendBlock<'a> {
    entries: Vec<LegendEntry<'a>>,
    columns: usize,
}

#[derive(Debug, Clone)]
struct LegendEntry<'a> {
    series: &'a Series,
    color: Color,
}

impl<'a> LegendBlock<'a> {
    /// The named series of a panel, in one column; none without a named series.
    pub(crate) fn new(panel: &'a Panel) -> Option<Self> {
        if panel.legend == Legend::None {
            return None;
        }
        let entry = |(index, series)| LegendEntry { series, color: panel.series_color(index) };
        let all = panel.series.iter().enumerate().map(entry);
        let entries: Vec<_> = all.filter(|entry| !entry.series.name.is_empty()).collect();
        (!entries.is_empty()).then_some(Self { entries, columns: 1 })
    }

    /// The same entries in as many columns as fit into `width`.
    pub(crate) fn spread(mut self, width: f64) -> Self {
        self.columns = self.entries.len();
        while self.columns > 1 && self.width() > width {
            self.columns -= 1;
        }
        // Equal columns: 3 + 1 entries become 2 + 2.
        self.columns = self.entries.len().div_ceil(self.rows());
        self
    }

    fn sample(&self) -> f64 {
        let markers_only = self.entries.iter().all(|entry| entry.series.join == Join::Points);
        if markers_only { SAMPLES.1 } else { SAMPLES.0 }
    }

    fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    fn column_width(&self, column: usize) -> f64 {
        let names = self.entries.iter().skip(column * self.rows()).take(self.rows());
        self.sample()
            + GAP
            + names.map(|e| text::width(&e.series.name, LABEL_FONT)).fold(0.0, f64::max)
    }

    fn width(&self) -> f64 {
        let columns: f64 = (0..self.columns).map(|column| self.column_width(column)).sum();
        columns + COLUMN_GAP * (self.columns - 1) as f64
    }

    pub(crate) fn height(&self) -> f64 {
        LINE * self.rows() as f64
    }

    /// The rectangle of the legend in a chosen corner, or the first free of `obstacles`; none if
    /// there is no free one.
    pub(crate) fn place(
        &self,
        position: Legend,
        frame: &Frame,
        obstacles: &Obstacles,
    ) -> Option<Frame> {
        let (width, height) = (self.width(), self.height());
        let left = frame.left + CLEAR + 2.0;
        let right = frame.right - CLEAR - 2.0 - width;
        let top = frame.top + CLEAR;
        let bottom = frame.bottom - CLEAR - height;
        let at = |x: f64, y: f64| Frame { left: x, top: y, right: x + width, bottom: y + height };
        let corners = [at(right, top), at(left, top), at(right, bottom), at(left, bottom)];
        match position {
            Legend::TopRight => return Some(corners[0]),
            Legend::TopLeft => return Some(corners[1]),
            Legend::BottomRight => return Some(corners[2]),
            Legend::BottomLeft => return Some(corners[3]),
            Legend::Above | Legend::None => return None,
            Legend::Auto => {}
        }
        let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let middles = [at(x, top), at(x, bottom), at(right, y), at(left, y)];
        let fits = left <= right && top <= bottom;
        corners.into_iter().chain(middles).find(|place| {
            let room = place.grown(CLEAR - 1.0);
            fits && !obstacles.meet(&room) && !crossed(&obstacles.areas, &room)
        })
    }

    /// The rectangle of the legend above the frame.
    pub(crate) fn above(&self, frame: &Frame) -> Frame {
        let bottom = frame.top - 5.0;
        let left = (frame.right - self.width()).max(frame.left).min(frame.left + 2.0);
        Frame { left, top: bottom - self.height(), right: left + self.width(), bottom }
    }

    /// Draws the entries into their rectangle.
    pub(crate) fn draw(&self, canvas: &mut Canvas, place: &Frame) {
        let mut x = place.left;
        for column in 0..self.columns {
            let entries = self.entries.iter().skip(column * self.rows()).take(self.rows());
            for (row, entry) in entries.enumerate() {
                entry.draw(canvas, self.sample(), x, place.top + LINE * (row as f64 + 0.5));
            }
            x += self.column_width(column) + COLUMN_GAP;
        }
    }
}

impl LegendEntry<'_> {
    fn draw(&self, canvas: &mut Canvas, sample: f64, x: f64, y: f64) {
        let middle = (x + 0.5 * sample, y);
        let &Self { series, color } = self;
        match series.join {
            Join::Line => {
                let line = vec![vec![(x, y), (x + sample, y)]];
                stroke(canvas, &line, color, series.dash, series.width);
            }
            Join::Band => {
                let fill = format!(r#"fill="{}""#, color.lighten(series.lightness));
                canvas.rectangle(x, y - 0.3 * LINE, sample, 0.6 * LINE, &fill);
            }
            Join::Points => {}
        }
        mark::draw(canvas, &[middle], series, color);
        let style = TextStyle::new(LABEL_FONT, Align::Left).color(Color::BLACK).halo();
        let baseline = y + 0.5 * text::CAP_HEIGHT * LABEL_FONT;
        canvas.text(x + sample + GAP, baseline, &series.name, style);
    }
}
