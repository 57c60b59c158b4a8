//! The colour bar beside a frame.

use crate::{
    Axis, Color,
    frame::Frame,
    ruler::Ruler,
    svg::{Align, Canvas, TextStyle},
    text::{self, LABEL_FONT, TITLE_FONT},
};

/// Room between frame and bar.
const GAP: f64 = 9.0;
/// Width of the bar.
const WIDTH: f64 = 9.0;
/// Room between bar and labels, and between labels and title.
const LABEL_GAP: f64 = 4.0;
/// Slices of the bar.
const SLICES: usize = 96;

/// A bar that relates the colours of a ramp to values.
///
/// ```
/// use asperity_figure::{Color, ColorBar};
/// let bar = ColorBar::continuous("Peak force", "N", 9.0, 31.0);
/// assert_eq!(bar.color(20.0), Color::ramp(0.5));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ColorBar {
    axis: Axis,
    low: f64,
    high: f64,
}

impl ColorBar {
    /// A bar from `low` to `high`.
    pub fn continuous(
        label: impl Into<String>,
        unit: impl Into<String>,
        low: f64,
        high: f64,
    ) -> Self {
        Self { axis: Axis::linear(label, unit).range(low, high), low, high }
    }

    /// The colour that stands for `value`.
    pub fn color(&self, value: f64) -> Color {
        Color::ramp((value - self.low) / (self.high - self.low))
    }

    /// Room the bar takes at the right of a frame of this height.
    pub(crate) fn room(&self, height: f64) -> f64 {
        let labels = self.ruler(0.0, height).label_width();
        GAP + WIDTH + LABEL_GAP + labels + LABEL_GAP + TITLE_FONT
    }

    fn ruler(&self, top: f64, bottom: f64) -> Ruler {
        Ruler::new(&self.axis, std::iter::empty(), false, (bottom, top), false)
    }

    /// Draws the bar at the right of `frame`.
    pub(crate) fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        let left = frame.right + GAP;
        let height = frame.height() / SLICES as f64;
        for index in 0..SLICES {
            let color = Color::ramp_step(index, SLICES);
            let top = frame.bottom - (index as f64 + 1.0) * height;
            // Slices overlap downwards so that no seam shows between them.
            let overlap = if index == 0 { 0.0 } else { 0.5 };
            canvas.rectangle(left, top, WIDTH, height + overlap, &format!(r#"fill="{color}""#));
        }
        let rim = r##"fill="none" stroke="#000000" stroke-width="0.7""##;
        canvas.rectangle(left, frame.top, WIDTH, frame.height(), rim);

        let right = left + WIDTH + LABEL_GAP;
        let ruler = self.ruler(frame.top, frame.bottom);
        let style = TextStyle::new(LABEL_FONT, Align::Left);
        for (y, label) in &ruler.major {
            canvas.text(right, y + 0.5 * text::CAP_HEIGHT * LABEL_FONT, label, style);
        }
        let x = right + ruler.label_width() + LABEL_GAP + TITLE_FONT * 0.8;
        let y = 0.5 * (frame.top + frame.bottom);
        let style = TextStyle::new(TITLE_FONT, Align::Center).turned(90.0);
        canvas.text(x, y, &ruler.title, style);
    }
}
