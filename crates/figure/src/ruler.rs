//! An axis on the page: scale, marks, labels and title, for the room there is.

use crate::{
    Axis,
    scale::{self, AxisScale},
    text::{self, LABEL_FONT},
    tick_label,
    ticks::{self, Ticks},
};

/// Least room between neighbouring labels of a horizontal axis.
const LABEL_GAP: f64 = 7.0;

/// A laid out axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ruler {
    pub(crate) scale: AxisScale,
    /// Labelled marks: position on the page and label.
    pub(crate) major: Vec<(f64, String)>,
    /// Positions of the short marks.
    pub(crate) minor: Vec<f64>,
    pub(crate) title: String,
}

impl Ruler {
    /// Lays `axis` out from page coordinate `start` to `end`, over the range it fixes or that of
    /// `data`.
    pub(crate) fn new(
        axis: &Axis,
        data: impl Iterator<Item = f64>,
        padded: bool,
        (start, end): (f64, f64),
        horizontal: bool,
    ) -> Self {
        let (low, high) = scale::range(axis, data, padded);
        let scale = AxisScale::new(axis, (low, high), start, end);
        let length = (end - start).abs();
        let most = (length / if horizontal { 38.0 } else { 26.0 }).clamp(2.0, 8.0) as usize;
        let plain = axis.log || axis.ticks.is_some();
        let exponent = if plain { 0 } else { tick_label::common_exponent(low, high) };
        let title = tick_label::title(&axis.label, &axis.unit, exponent);
        let mut ruler = Self { scale, major: Vec::new(), minor: Vec::new(), title };
        if let Some(fixed) = &axis.ticks {
            let inside = |at: f64| at >= low && at <= high;
            let marks = fixed.iter().filter(|mark| inside(mark.0));
            ruler.major = marks.map(|(at, text)| (scale.shown(*at), text.clone())).collect();
            return ruler;
        }
        for target in (1..=most).rev() {
            let marks = if axis.log {
                ticks::logarithmic(low, high, target)
            } else {
                ticks::linear(low, high, target)
            };
            ruler.set(&marks, exponent);
            if !horizontal || ruler.labels_fit() {
                break;
            }
        }
        ruler
    }

    fn set(&mut self, marks: &Ticks, exponent: i32) {
        let labels = match marks.decimals {
            None => tick_label::logarithmic(&marks.major),
            Some(decimals) => {
                let label = |&value| tick_label::linear(value, exponent, decimals);
                marks.major.iter().map(label).collect()
            }
        };
        let place = |&value: &f64| self.scale.shown(value);
        self.major = marks.major.iter().map(place).zip(labels).collect();
        self.minor = marks.minor.iter().map(place).collect();
    }

    fn labels_fit(&self) -> bool {
        self.major.windows(2).all(|pair| {
            let halves = pair.iter().map(|mark| 0.5 * text::width(&mark.1, LABEL_FONT));
            (pair[1].0 - pair[0].0).abs() >= halves.sum::<f64>() + LABEL_GAP
        })
    }

    /// Width of the widest label.
    pub(crate) fn label_width(&self) -> f64 {
        text::widest(&self.major)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_a_horizontal_axis_do_not_touch() {
        for length in [40.0, 80.0, 160.0, 300.0] {
            for high in [1.0, 24_000.0, 9.9e4, 3.3e-7] {
                let axis = Axis::linear("a", "");
                let ruler = Ruler::new(&axis, [0.0, high].into_iter(), false, (0.0, length), true);
                assert!(ruler.labels_fit() || ruler.major.len() <= 2, "{length} {high}");
                assert!(!ruler.major.is_empty());
            }
        }
    }

    #[test]
    fn display_factor_and_exponent_reach_labels_and_title() {
        let axis = Axis::linear("Pressure", "MPa").scale(1e-6);
        let ruler = Ruler::new(&axis, [0.0, 4e6].into_iter(), false, (0.0, 200.0), true);
        let labels: Vec<_> = ruler.major.iter().map(|mark| mark.1.as_str()).collect();
        assert_eq!(labels, ["0", "1", "2", "3", "4"]);
        assert_eq!(ruler.title, "Pressure (MPa)");

        let axis = Axis::linear("Stiffness", "N/m³");
        let ruler = Ruler::new(&axis, [0.0, 3.0e9].into_iter(), false, (200.0, 0.0), false);
        assert_eq!(ruler.title, "Stiffness (10^{9} N/m³)");
        assert!(ruler.major.iter().all(|mark| mark.1.len() <= 3), "{:?}", ruler.major);
    }
}
