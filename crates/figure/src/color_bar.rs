//! The colour bar beside a frame.

use crate::{
    Axis, Color,
    frame::Frame,
    ruler::Ruler,
    svg::{Canvas, HorizontalAlign, TextStyle},
    text::{self, LABEL_FONT, TITLE_FONT},
    tick_label,
};

/// Room between frame and bar.
const GAP: f64 = 9.0;
/// Width of the bar.
const WIDTH: f64 = 9.0;
/// Room between bar and labels, and between labels and title.
const LABEL_GAP: f64 = 4.0;
/// Slices of a continuous bar.
const SLICES: usize = 96;

/// A bar that relates the colours of a ramp to values.
///
/// ```
/// use asperity_figure::{Color, ColorBar};
/// let bar = ColorBar::levels("Peak force", "N", &[9.0, 20.0, 32.0]);
/// assert_eq!(bar.color(20.0), Color::ramp(0.5));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ColorBar {
    pub(crate) label: String,
    pub(crate) unit: String,
    pub(crate) steps: Option<Vec<(f64, Color)>>,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) log: bool,
}

impl ColorBar {
    /// One swatch a level, coloured by [`Color::ramp_step`] in the order given.
    pub fn levels(label: impl Into<String>, unit: impl Into<String>, levels: &[f64]) -> Self {
        let steps = levels
            .iter()
            .enumerate()
            .map(|(index, &level)| (level, Color::ramp_step(index, levels.len())))
            .collect();
        Self {
            label: label.into(),
            unit: unit.into(),
            steps: Some(steps),
            low: 0.0,
            high: 1.0,
            log: false,
        }
    }

    /// A continuous bar from `low` to `high`.
    pub fn continuous(
        label: impl Into<String>,
        unit: impl Into<String>,
        low: f64,
        high: f64,
    ) -> Self {
        Self { label: label.into(), unit: unit.into(), steps: None, low, high, log: false }
    }

    /// Spaces a continuous bar logarithmically.
    #[must_use]
    pub fn log(mut self) -> Self {
        self.log = true;
        self
    }

    /// The colour that stands for `value`: that of the nearest level, or of the ramp.
    pub fn color(&self, value: f64) -> Color {
        if let Some(steps) = &self.steps {
            let nearest =
                steps.iter().min_by(|a, b| (a.0 - value).abs().total_cmp(&(b.0 - value).abs()));
            return nearest.map_or(Color::BLACK, |step| step.1);
        }
        let place = |v: f64| if self.log { v.max(f64::MIN_POSITIVE).log10() } else { v };
        Color::ramp((place(value) - place(self.low)) / (place(self.high) - place(self.low)))
    }

    /// Room the bar takes at the right of a frame of this height.
    pub(crate) fn room(&self, height: f64) -> f64 {
        GAP + WIDTH + LABEL_GAP + widest(&self.marks(0.0, height)) + LABEL_GAP + TITLE_FONT
    }

    /// Labels and their positions from `bottom` up to `top`.
    fn marks(&self, top: f64, bottom: f64) -> Vec<(f64, String)> {
        let Some(steps) = &self.steps else {
            return self.ruler(top, bottom).major;
        };
        let height = (bottom - top) / steps.len().max(1) as f64;
        // Of labels closer than their height every so many are kept, always the first.
        let every = (LABEL_FONT * 1.15 / height).ceil().max(1.0) as usize;
        let middle = |index: usize| bottom - (index as f64 + 0.5) * height;
        steps
            .iter()
            .enumerate()
            .step_by(every)
            .map(|(index, step)| (middle(index), tick_label::free(step.0)))
            .collect()
    }

    fn ruler(&self, top: f64, bottom: f64) -> Ruler {
        let (label, unit) = (self.label.as_str(), self.unit.as_str());
        let axis = if self.log { Axis::log(label, unit) } else { Axis::linear(label, unit) };
        let axis = axis.range(self.low, self.high);
        Ruler::new(&axis, std::iter::empty(), false, (bottom, top), false)
    }

    /// Draws the bar at the right of `frame`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        let left = frame.right + GAP;
        let count = self.steps.as_ref().map_or(SLICES, Vec::len);
        let height = frame.height() / count.max(1) as f64;
        for index in 0..count {
            let color = match &self.steps {
                Some(steps) => steps[index].1,
                None => Color::ramp_step(index, count),
            };
            let top = frame.bottom - (index as f64 + 1.0) * height;
            // Slices overlap downwards so that no seam shows between them.
            let overlap = if index == 0 { 0.0 } else { 0.5 };
            canvas.rectangle(left, top, WIDTH, height + overlap, &format!(r#"fill="{color}""#));
        }
        let rim = r##"fill="none" stroke="#000000" stroke-width="0.7""##;
        canvas.rectangle(left, frame.top, WIDTH, frame.height(), rim);

        let right = left + WIDTH + LABEL_GAP;
        let marks = self.marks(frame.top, frame.bottom);
        let style = TextStyle::new(LABEL_FONT, HorizontalAlign::Start);
        for (y, label) in &marks {
            canvas.text(right, y + 0.5 * text::CAP_HEIGHT * LABEL_FONT, label, style);
        }
        let title = match self.steps {
            Some(_) => tick_label::title(&self.label, &self.unit, 0),
            None => self.ruler(frame.top, frame.bottom).title,
        };
        let x = right + widest(&marks) + LABEL_GAP + TITLE_FONT * 0.8;
        let y = 0.5 * (frame.top + frame.bottom);
        let style = TextStyle::new(TITLE_FONT, HorizontalAlign::Middle).turned(90.0);
        canvas.text(x, y, &title, style);
    }
}

fn widest(marks: &[(f64, String)]) -> f64 {
    marks.iter().map(|mark| text::width(&mark.1, LABEL_FONT, false)).fold(0.0, f64::max)
}
