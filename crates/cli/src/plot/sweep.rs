//! What a sweep found, against its first numeric variation.

use std::collections::BTreeMap;

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_study::summary::Summary;
use asperity_study::sweep::{SweepRun, Variation};

/// Most lines of one panel: beyond, colours say nothing any more.
const MOST_LINES: usize = 7;

type Observable = fn(&Summary) -> Option<f64>;

/// The observables drawn: label, unit, value.
const OBSERVABLES: [(&str, &str, Observable); 4] = [
    ("Fundamental f_{1}", "Hz", |s| s.fundamental.map(|f| f.frequency_hz)),
    ("Amplitude A_{1}", "m/N", |s| s.fundamental.map(|f| f.receptance_m_per_n)),
    ("Ratio A_{2}/A_{1}", "", |s| s.harmonic_ratio),
    ("Lowest pressure", "Pa", |s| {
        s.interfaces.iter().map(|contact| contact.pressure_min_pa).reduce(f64::min)
    }),
];

/// A panel per observable, a line per combination of the other variations;
/// none if no variation is numeric.
pub(crate) fn sweep(variations: &[Variation], runs: &[SweepRun]) -> Option<Figure> {
    let numeric = |variation: &Variation| {
        variation.values.len() > 1 && variation.values.iter().all(|v| v.parse::<f64>().is_ok())
    };
    let across = variations.iter().position(numeric)?;
    let mut lines: BTreeMap<String, Vec<&SweepRun>> = BTreeMap::new();
    for run in runs {
        let others = run.values.iter().enumerate().filter(|(index, _)| *index != across);
        let name: Vec<&str> = others.map(|(_, value)| value.as_str()).collect();
        lines.entry(name.join(", ")).or_default().push(run);
    }
    let key = variations[across].pointer.rsplit('/').next().unwrap_or_default();
    let mut figure = Figure::new("Sweep").columns(2).width_mm(170.0);
    let mut drawn = false;
    for (label, unit, observable) in OBSERVABLES {
        let mut panel = Panel::new(Axis::linear(key, ""), Axis::linear(label, unit));
        panel = panel.legend(if lines.len() > 1 { Legend::Auto } else { Legend::None });
        let mut any = false;
        for (index, (name, runs)) in lines.iter().take(MOST_LINES).enumerate() {
            let points = runs.iter().filter_map(|run| {
                let x = run.values[across].parse::<f64>().ok()?;
                Some((x, observable(run.outcome.as_ref().ok()?)?))
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
