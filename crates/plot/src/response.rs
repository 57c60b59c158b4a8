//! Histories and receptance of one run.

use asperity_figure::{Axis, Color, Figure, Legend, Panel, Series};
use asperity_scenario::SensorKind;
use asperity_signal::{Frf, decay_length};
use asperity_simulation::patches::PatchRun;
use asperity_simulation::record::motions;
use asperity_simulation::run::Run;
use asperity_simulation::summary::{Amplitude, Fundamental, Summary};

use super::magnitude::{MagnitudeAxis, phase_axis, phase_line};

/// Load, motion at each sensor and pressures over time, until the motion has decayed.
pub fn history<S>(run: &Run<S>) -> Figure {
    let history = &run.transient.history;
    let motions = motions(run);
    let decays = motions.iter().map(|motion| decay_length(motion.relative));
    let last = decays.max().unwrap_or_default().saturating_sub(1);
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
    let interfaces = run.summary.interfaces.iter();
    for (index, (interface, columns)) in interfaces.zip(&history.interfaces).enumerate() {
        let line = Series::line(&interface.name, &history.time, &columns.pressure);
        pressures = pressures.series(line.category(index));
    }
    let load = match run.assembly.load.base() {
        None => single("Force", "N", 1.0, &history.load),
        Some(_) => single("Base acceleration", "m/s²", 1.0, &history.load),
    };
    let mut figure = Figure::new("Response over time").panel(load);
    let mut motions = motions;
    if motions.iter().all(|motion| motion.name.is_none()) {
        motions.reverse();
    }
    for motion in &motions {
        let (word, unit, scale) = match motion.kind {
            SensorKind::Displacement => ("Displacement", "µm", 1e6),
            SensorKind::Velocity => ("Velocity", "m/s", 1.0),
            SensorKind::Acceleration => ("Acceleration", "m/s²", 1.0),
        };
        let relative = if motion.absolute.is_some() { "Relative " } else { "" };
        let word = if relative.is_empty() { word.to_owned() } else { word.to_lowercase() };
        let at = motion.name.map_or(String::new(), |name| format!(", {name}"));
        let label = format!("{relative}{word}{at}");
        figure = figure.panel(single(&label, unit, scale, motion.relative));
    }
    figure.panel(pressures).columns(2).width_mm(170.0)
}

/// Most cells drawn.
const MOST_CELLS: usize = 10;

/// Pressure and closure of the cells that a run records, of more than ten of the first ten, until the motion has decayed;
/// none without such cells.
pub fn cell_histories(run: &PatchRun) -> Option<Figure> {
    if run.cell_histories.is_empty() {
        return None;
    }
    let time = &run.run.transient.history.time;
    let decays = motions(&run.run).into_iter().map(|motion| decay_length(motion.relative));
    let end = decays.max().unwrap_or_default().min(time.len());
    let across = || Axis::linear("Time", "ms").scale(1e3);
    let mut pressures = Panel::new(across(), Axis::linear("Pressure of cell", "MPa").scale(1e-6));
    let mut closures = Panel::new(across(), Axis::linear("Closure of cell", "µm").scale(1e6));
    for (index, cell) in run.cell_histories.iter().take(MOST_CELLS).enumerate() {
        let name = format!("{} {}", cell.interface, cell.cell);
        let line = |values: &[f64]| {
            Series::line(name.clone(), &time[..end], &values[..end]).category(index)
        };
        pressures = pressures.series(line(&cell.history.pressure));
        closures = closures.series(line(&cell.history.closure));
    }
    let figure = Figure::new("Cells over time").panel(pressures).panel(closures);
    Some(figure.columns(1).width_mm(150.0))
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
    let per_base = |peak: Fundamental| matches!(peak.amplitude, Amplitude::PerBase { .. });
    let (label, unit) = if summary.fundamental.is_some_and(per_base) {
        ("Displacement per base acceleration", "s²")
    } else {
        ("Receptance", "m/N")
    };
    let up = axis.axis(label, unit, magnitude.iter().copied());
    let mut upper = marked(Panel::new(across(), up), true)
        .series(Series::line("", frequency, &shown).color(Color::BLUE));
    let first = summary.fundamental.map(|peak| (peak.frequency_hz, peak.amplitude.value()));
    let second = summary.second_harmonic.map(|peak| (peak.frequency_hz, peak.amplitude.value()));
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

/// A measured receptance \[m/N\]: a series for [`Figure::with`](asperity_figure::Figure::with) a figure of
/// [`frf`].
pub fn measured_frf(frequency: &[f64], magnitude: &[f64], axis: MagnitudeAxis) -> Figure {
    let up = axis.axis("Receptance", "m/N", magnitude.iter().copied());
    let shown: Vec<f64> = magnitude.iter().map(|value| axis.value(*value)).collect();
    let line = Series::line("measured", frequency, shown).color(Color::RED);
    Figure::new("Measured").panel(Panel::new(Axis::linear("Frequency", "Hz"), up).series(line))
}
