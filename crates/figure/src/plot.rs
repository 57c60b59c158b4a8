//! One panel on the page: frame, axes, curves, markers.

use crate::{
    Color, Dash, Marker, Panel, error_bar,
    frame::{Frame, Obstacles, Point},
    line::stroke,
    mark,
    panel::ReferenceLine,
    ruler::Ruler,
    series::{Join, Series},
    svg::{Align, Canvas, TextStyle},
    text::{self, LABEL_FONT, TITLE_FONT},
    trace,
};

/// Fill of a shaded part of a panel.
const SHADE: Color = Color::hex(0xf0_f0f0);
/// Width of error bars, in points.
const ERROR_LINE: f64 = 0.7;
/// Width of the frame and its marks.
const HAIRLINE: f64 = 0.7;
/// Lengths of labelled and short marks.
pub(crate) const MARKS: (f64, f64) = (4.0, 2.2);
/// Room between the frame and the tick labels.
pub(crate) const TICK_GAP: f64 = 4.5;
/// Least size of the title of an axis over that of one with room.
const LEAST_TITLE: f64 = 0.55;
/// More markers than this are drawn once a third of a pixel.
const MANY_MARKERS: usize = 2000;

/// A panel with its frame and axes laid out.
#[derive(Debug, Clone)]
pub(crate) struct Plot<'a> {
    pub(crate) panel: &'a Panel,
    pub(crate) frame: Frame,
    pub(crate) x: Ruler,
    pub(crate) y: Ruler,
}

impl Plot<'_> {
    /// The points of a series on the page.
    pub(crate) fn points(&self, series: &Series) -> Vec<Point> {
        let place = |(&x, &y)| (self.x.scale.datum(x), self.y.scale.datum(y));
        series.x.iter().zip(&series.y).map(place).collect()
    }

    /// The markers of a series that lie in the frame.
    fn markers(&self, series: &Series) -> Vec<Point> {
        if series.marker == Marker::None {
            return Vec::new();
        }
        let all = self.points(series).into_iter().step_by(series.marker_every);
        let mut shown: Vec<Point> = all.filter(|&point| self.frame.holds(point)).collect();
        if shown.len() > MANY_MARKERS {
            let mut seen = std::collections::HashSet::new();
            shown.retain(|p| seen.insert(((p.0 * 3.0).round() as i64, (p.1 * 3.0).round() as i64)));
        }
        shown
    }

    /// The line parts of a series that lie in the frame.
    fn lines(&self, series: &Series) -> Vec<Vec<Point>> {
        match series.join {
            Join::Points | Join::Band => Vec::new(),
            Join::Line => trace::visible(&self.points(series), &self.frame),
        }
    }

    /// The error bars of a series, each with its caps where these lie in the frame.
    fn errors(&self, series: &Series) -> Vec<Vec<Point>> {
        error_bar::parts(series, &self.x.scale, &self.y.scale, &self.frame)
    }

    /// Both ends of the error bars of a series, in the frame or beyond.
    pub(crate) fn error_segments(&self, series: &Series) -> Vec<[Point; 2]> {
        error_bar::segments(series, &self.x.scale, &self.y.scale, &self.frame)
    }

    /// The polygons of a band that lie in the frame.
    fn areas(&self, series: &Series) -> Vec<Vec<Point>> {
        let areas = self.bands(series);
        let cut = areas.iter().map(|outline| trace::polygon(outline, &self.frame));
        cut.filter(|polygon| polygon.len() > 2).collect()
    }

    /// The outlines of a band.
    pub(crate) fn bands(&self, series: &Series) -> Vec<Vec<Point>> {
        let rows = series.x.iter().zip(series.y.iter().zip(&series.lower));
        let both: Vec<(Point, Point)> = rows
            .map(|(&x, (&upper, &lower))| {
                let x = self.x.scale.datum(x);
                let (upper, low) = (self.y.scale.datum(upper), self.y.scale.datum(lower));
                // A lower end that a logarithmic axis cannot show lies below the frame.
                let below = self.y.scale.log && lower <= 0.0;
                ((x, upper), (x, if below { self.frame.bottom } else { low }))
            })
            .collect();
        both.split(|(upper, lower)| ![upper.0, upper.1, lower.1].iter().all(|v| v.is_finite()))
            .filter(|run| run.len() > 1)
            .map(|run| {
                let (upper, mut lower): (Vec<Point>, Vec<Point>) = run.iter().copied().unzip();
                lower.reverse();
                let mut outline = trace::decimated(&upper, trace::COLUMN);
                outline.extend(trace::decimated(&lower, trace::COLUMN));
                outline
            })
            .collect()
    }

    /// Curves and markers that texts keep clear of.
    pub(crate) fn curves(&self) -> Obstacles {
        let mut obstacles = Obstacles::default();
        for series in &self.panel.series {
            obstacles.lines.extend(self.lines(series));
            obstacles.lines.extend(self.errors(series));
            obstacles.points.extend(self.markers(series));
            for mut area in self.areas(series) {
                area.extend(area.first().copied());
                obstacles.areas.push(area);
            }
        }
        for reference in &self.panel.references {
            obstacles.lines.extend(self.reference_line(reference));
        }
        obstacles
    }

    /// Draws frame, axes, curves and markers of panel `number`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, number: usize) {
        canvas.open(number);
        self.shades(canvas);
        for (index, series) in self.panel.series.iter().enumerate() {
            let fill = self.panel.series_color(index).lighten(series.lightness);
            let style = format!(r#"fill="{fill}""#);
            canvas.path(&trace::path(&self.areas(series), true), &style);
        }
        for reference in &self.panel.references {
            if let Some(line) = self.reference_line(reference) {
                stroke(canvas, &[line], Color::GREY, Dash::Dashed, 0.6);
            }
        }
        self.axes(canvas);
        canvas.close();
        self.titles(canvas);
        canvas.open(number);
        for (index, series) in self.panel.series.iter().enumerate() {
            let color = self.panel.series_color(index);
            stroke(canvas, &self.errors(series), color, Dash::Solid, series.width.min(ERROR_LINE));
            stroke(canvas, &self.lines(series), color, series.dash, series.width);
        }
        for (index, series) in self.panel.series.iter().enumerate() {
            mark::draw(canvas, &self.markers(series), series, self.panel.series_color(index));
        }
        canvas.close();
    }

    fn shades(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.frame;
        for &(from, to) in &self.panel.shades {
            let inside = |at: f64, open: f64| {
                let at = self.x.scale.datum(at);
                if at.is_nan() { open } else { at.clamp(left, right) }
            };
            let (from, to) = (inside(from, left), inside(to, right));
            if to > from {
                let style = format!(r#"fill="{SHADE}""#);
                canvas.rectangle(from, top, to - from, bottom - top, &style);
            }
        }
    }

    /// Frame, marks on all four sides and labels.
    fn axes(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.frame;
        let across = |x: f64, length: f64| {
            [vec![(x, bottom), (x, bottom - length)], vec![(x, top), (x, top + length)]]
        };
        let along = |y: f64, length: f64| {
            [vec![(left, y), (left + length, y)], vec![(right, y), (right - length, y)]]
        };
        let mut marks: Vec<Vec<Point>> = Vec::new();
        marks.extend(self.x.major.iter().flat_map(|mark| across(mark.0, MARKS.0)));
        marks.extend(self.y.major.iter().flat_map(|mark| along(mark.0, MARKS.0)));
        marks.extend(self.x.minor.iter().flat_map(|&x| across(x, MARKS.1)));
        marks.extend(self.y.minor.iter().flat_map(|&y| along(y, MARKS.1)));
        let style = format!(r##"fill="none" stroke="#000000" stroke-width="{HAIRLINE}""##);
        canvas.path(&trace::path(&marks, false), &style);
        canvas.rectangle(left, top, right - left, bottom - top, &style);

        let style = TextStyle::new(LABEL_FONT, Align::Center);
        for (x, label) in &self.x.major {
            canvas.text(*x, bottom + TICK_GAP + text::CAP_HEIGHT * LABEL_FONT, label, style);
        }
        let style = TextStyle::new(LABEL_FONT, Align::Right);
        for (y, label) in &self.y.major {
            canvas.text(left - TICK_GAP, y + 0.5 * text::CAP_HEIGHT * LABEL_FONT, label, style);
        }
    }

    /// Titles of both axes.
    fn titles(&self, canvas: &mut Canvas) {
        let Frame { left, top, right, bottom } = self.frame;
        // A title that is longer than its axis is written smaller.
        let style = |title: &str, room: f64| {
            let share = room / text::width(title, TITLE_FONT).max(1.0);
            TextStyle::new(TITLE_FONT * share.clamp(LEAST_TITLE, 1.0), Align::Center)
        };
        let below = bottom + TICK_GAP + LABEL_FONT + 4.0 + text::CAP_HEIGHT * TITLE_FONT;
        let across = style(&self.x.title, right - left);
        canvas.text(0.5 * (left + right), below, &self.x.title, across);
        let beside = left - TICK_GAP - self.y.label_width() - 6.0;
        let along = style(&self.y.title, bottom - top).turned(90.0);
        canvas.text(beside, 0.5 * (top + bottom), &self.y.title, along);
    }

    pub(crate) fn reference_line(&self, reference: &ReferenceLine) -> Option<Vec<Point>> {
        let Frame { left, top, right, bottom } = self.frame;
        let (start, end) = if reference.vertical {
            let x = self.x.scale.datum(reference.at);
            ((x, bottom), (x, top))
        } else {
            let y = self.y.scale.datum(reference.at);
            ((left, y), (right, y))
        };
        (self.frame.holds(start) && self.frame.holds(end)).then(|| vec![start, end])
    }
}
