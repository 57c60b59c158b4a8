//! Observables of a sweep over its first numeric variation.

use std::collections::BTreeMap;

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_study::sweep::{Sweep, Variation};

/// Most lines of one panel: more colours cannot be told apart.
const MOST_LINES: usize = 7;

/// Most points of a line; of more runs an even selection is drawn.
const MOST_POINTS: usize = 500;

/// The observables drawn: label, unit, and the end of the names of their columns, of which the least
/// value is drawn.
const OBSERVABLES: [(&str, &str, &str); 4] = [
    ("Fundamental f_{1}", "Hz", "fundamental.frequency_hz"),
    ("Amplitude A_{1}", "m/N", "fundamental.receptance_m_per_n"),
    ("Ratio A_{2}/A_{1}", "", "harmonic_ratio"),
    ("Lowest pressure", "Pa", ".pressure_min_pa"),
];

/// A panel per observable, a line per combination of the other variations;
/// none if no variation is numeric.
pub(crate) fn sweep(sweep: &Sweep) -> Option<Figure> {
    let numeric = |variation: &Variation| {
        variation.values.len() > 1 && variation.values.iter().all(|v| v.parse::<f64>().is_ok())
    };
    let across = sweep.variations.iter().position(numeric)?;
    let mut lines: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for run in 0..sweep.runs.len() {
        let values = sweep.values(run);
        let others = values.iter().enumerate().filter(|(index, _)| *index != across);
        let name: Vec<&str> = others.map(|(_, value)| *value).collect();
        lines.entry(name.join(", ")).or_default().push(run);
    }
    let key = sweep.variations[across].pointer.rsplit('/').next().unwrap_or_default();
    let mut figure = Figure::new("Sweep").columns(2).width_mm(170.0);
    let mut drawn = false;
    for (label, unit, ending) in OBSERVABLES {
        let columns: Vec<usize> = (0..sweep.columns.len())
            .filter(|&column| sweep.columns[column].ends_with(ending))
            .collect();
        let mut panel = Panel::new(Axis::linear(key, ""), Axis::linear(label, unit));
        panel = panel.legend(if lines.len() > 1 { Legend::Auto } else { Legend::None });
        let mut any = false;
        for (index, (name, runs)) in lines.iter().take(MOST_LINES).enumerate() {
            let every = runs.len().div_ceil(MOST_POINTS);
            let points = runs.iter().step_by(every).filter_map(|&run| {
                let x = sweep.values(run)[across].parse::<f64>().ok()?;
                let numbers = sweep.runs[run].as_ref().ok()?;
                let found = columns.iter().map(|&column| numbers[column]);
                Some((x, found.filter(|y| !y.is_nan()).reduce(f64::min)?))
            });
            let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
            if !x.is_empty() {
                let series = Series::line_points(name.as_str(), x, y);
                let series = series.color(Color::category(index)).marker(Marker::Circle);
                panel = panel.series(series);
                any = true;
            }
        }
        if any {
            figure = figure.panel(panel);
            drawn = true;
        }
    }
    drawn.then_some(figure)
}
