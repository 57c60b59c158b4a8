//! Histories and receptance of one run.

use asperity_dynamics::History;
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_signal::{Frf, decay_length};
use asperity_simulation::summary::Summary;

use super::magnitude::{MagnitudeAxis, phase_axis, phase_line};

/// Force, acceleration, displacement and pressures over time, until the motion has decayed.
pub fn history(history: &History, interfaces: &[&str]) -> Figure {
    let decays = [&history.displacement, &history.acceleration].map(|motion| decay_length(motion));
    let last = decays[0].max(decays[1]).saturating_sub(1);
    let end = history.time.get(last).map_or(0.0, |time| 1e3 * time);
    let time = || {
        let axis = Axis::linear("Time", "ms").scale(1e3);
        if end > 0.0 { axis.range(0.0, end) } else { axis }
    };
    let single = |label: &str, unit: &str, scale: f64, values: &[f64]| {
        Panel::new(time(), Axis::linear(label, unit).scale(scale))
            .series(Series::line("", &history.time, values).color(Color::BLACK))
            .legend(Legend::None)
    };
    let mut pressures = Panel::new(time(), Axis::linear("Contact pressure", "MPa").scale(1e-6));
    for (index, (name, columns)) in interfaces.iter().zip(&history.interfaces).enumerate() {
        let dash = if index == 0 { Dash::Solid } else { Dash::Dashed };
        let line = Series::line(*name, &history.time, &columns.pressure);
        pressures = pressures.series(line.color(Color::category(index)).dash(dash));
    }
    Figure::new("Response over time")
        .panel(single("Force", "N", 1.0, &history.force))
        .panel(single("Acceleration", "m/s²", 1.0, &history.acceleration))
        .panel(single("Displacement", "µm", 1e6, &history.displacement))
        .panel(pressures)
        .columns(2)
        .width_mm(170.0)
}

/// Magnitude and phase of the receptance, with its peaks and the natural frequency at rest marked.
pub fn frf(frf: &Frf, summary: &Summary, axis: MagnitudeAxis) -> Figure {
    let magnitude = frf.magnitude();
    // Zero frequency has no place among the resonances.
    let (frequency, magnitude) = (&frf.frequency_hz[1..], &magnitude[1..]);
    let phase: Vec<f64> = frf.values[1..].iter().map(|value| value.arg()).collect();
    let across = || Axis::linear("Frequency", "Hz");
    let marked = |panel: Panel, texts: bool| {
        let text = |text: &'static str| if texts { text } else { "" };
        let marks = [
            ("at rest", summary.at_rest.natural_frequency_hz),
            ("f_{1}", summary.fundamental.map(|peak| peak.frequency_hz)),
            ("f_{2}", summary.second_harmonic.map(|peak| peak.frequency_hz)),
        ];
        let known = marks.into_iter().filter_map(|(name, at)| Some((name, at?)));
        let panel = panel.legend(Legend::None);
        known.fold(panel, |panel, (name, at)| panel.vertical(at, text(name)))
    };
    let shown: Vec<f64> = magnitude.iter().map(|value| axis.value(*value)).collect();
    let up = axis.axis("Receptance", "m/N", magnitude.iter().copied());
    let mut upper = marked(Panel::new(across(), up), true)
        .series(Series::line("", frequency, &shown).color(Color::BLUE));
    let first = summary.fundamental.map(|peak| (peak.frequency_hz, peak.receptance_m_per_n));
    let second = summary.second_harmonic.map(|peak| (peak.frequency_hz, peak.receptance_m_per_n));
    for (frequency, receptance) in first.into_iter().chain(second) {
        let text = format!("{frequency:.1} Hz");
        upper = upper.note(frequency, axis.value(receptance), text);
    }
    let (x, y) = phase_line(frequency, &phase);
    let lower = marked(Panel::new(across(), phase_axis()), false)
        .series(Series::line("", x, y).color(Color::BLUE));
    let figure = Figure::new("Receptance").panel(upper).panel(lower);
    figure.columns(1).width_mm(120.0).row_height_mm(62.0)
}
