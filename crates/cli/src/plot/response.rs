//! Histories and receptance of one run.

use asperity_dynamics::History;
use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_signal::Frf;
use asperity_study::summary::Summary;

/// Force, acceleration, displacement and pressures over time.
pub(crate) fn history(history: &History, interfaces: &[&str]) -> Figure {
    let time = || Axis::linear("Time", "ms").scale(1e3);
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

/// Magnitude of the receptance, with its peaks marked.
pub(crate) fn frf(frf: &Frf, summary: &Summary) -> Figure {
    let magnitude = frf.magnitude();
    // Zero frequency has no place among the resonances.
    let (frequency, magnitude) = (&frf.frequency_hz[1..], &magnitude[1..]);
    let mut panel = Panel::new(Axis::linear("Frequency", "Hz"), Axis::log("Receptance", "m/N"))
        .series(Series::line("", frequency, magnitude).color(Color::BLUE))
        .legend(Legend::None);
    let first = summary.fundamental.map(|peak| (peak.frequency_hz, peak.receptance_m_per_n));
    let second = summary.second_harmonic.map(|peak| (peak.frequency_hz, peak.receptance_m_per_n));
    for (frequency, receptance) in first.into_iter().chain(second) {
        panel = panel.note(frequency, receptance, format!("{frequency:.1} Hz"));
    }
    Figure::new("Receptance").panel(panel).width_mm(120.0)
}
