//! Frequency response functions of a file.

use asperity_experiment::MeasuredFrf;
use asperity_figure::{Axis, Figure, Legend, Panel, Series};

use super::magnitude::{MagnitudeAxis, phase_axis, phase_line};
use super::{figure, fitted};

/// Most functions that are drawn: more cannot be told apart.
const MOST_FUNCTIONS: usize = 7;
/// Most characters of a name.
const MOST_NAME: usize = 44;

/// Magnitude and phase of the receptances of a file, and their coherences; none without any.
pub fn frf_file(functions: &[MeasuredFrf], axis: MagnitudeAxis) -> Option<Figure> {
    let drawn = &functions[..functions.len().min(MOST_FUNCTIONS)];
    let magnitudes = drawn.iter().flat_map(|one| one.receptance.magnitude());
    let magnitudes: Vec<f64> = magnitudes.collect();
    let up = axis.axis("Receptance", "m/N", magnitudes.into_iter());
    let panel = |up: Axis| Panel::new(Axis::linear("Frequency", "Hz"), up).legend(Legend::None);
    let mut magnitude = panel(up).legend(Legend::Auto);
    let mut phase = panel(phase_axis());
    let mut coherence = panel(Axis::linear("Coherence", "").range(0.0, 1.0));
    for (number, one) in drawn.iter().enumerate() {
        let line = |name: &str, x: &[f64], y: &[f64]| {
            Series::line(fitted(name.trim(), MOST_NAME), x, y).category(number).width(0.8)
        };
        let x = &one.receptance.frequency_hz;
        let y: Vec<f64> = one.receptance.magnitude().into_iter().map(|m| axis.value(m)).collect();
        magnitude = magnitude.series_if_visible(line(&one.name, x, &y));
        let (phase_x, phase_y) = phase_line(x, &one.receptance.phase());
        phase = phase.series_if_visible(line("", &phase_x, &phase_y));
        if let Some(values) = &one.coherence {
            coherence = coherence.series_if_visible(line("", x, values));
        }
    }
    let panels = [magnitude, phase, coherence];
    Some(figure("Frequency response functions", 1, 150.0, panels)?.row_height_mm(58.0))
}
