//! Results of a sweep over its first numeric variation.

use std::collections::BTreeMap;

use asperity_figure::{Axis, Color, Figure, Legend, Panel, Series};
use asperity_simulation::quantity::Quantity;
use asperity_simulation::sweep::{Sweep, Variation};

use super::figure;

/// Most lines of one panel: more colours cannot be told apart.
const MOST_LINES: usize = 7;

/// Most points of a line; of more runs, every so many are drawn.
const MOST_POINTS: usize = 500;

/// The quantities drawn; of several interfaces the least value counts.
const DRAWN: [Quantity; 4] = [
    Quantity::FundamentalFrequency,
    Quantity::FundamentalReceptance,
    Quantity::HarmonicRatio,
    Quantity::PressureMin,
];

/// A panel per observable, a line per combination of the other variations;
/// none if no variation is numeric.
pub fn sweep(sweep: &Sweep) -> Option<Figure> {
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
    let panels = DRAWN.map(|quantity| {
        let is_drawn = |column: &usize| {
            Quantity::of_name(&sweep.columns[*column]).is_some_and(|(found, _)| found == quantity)
        };
        let columns: Vec<usize> = (0..sweep.columns.len()).filter(is_drawn).collect();
        let axis = Axis::linear(quantity.label(), quantity.unit());
        let mut panel = Panel::new(Axis::linear(key, ""), axis);
        panel = panel.legend(if lines.len() > 1 { Legend::Auto } else { Legend::None });
        for (index, (name, runs)) in lines.iter().take(MOST_LINES).enumerate() {
            let every = runs.len().div_ceil(MOST_POINTS);
            let points = runs.iter().step_by(every).filter_map(|&run| {
                let x = sweep.values(run)[across].parse::<f64>().ok()?;
                let numbers = sweep.runs[run].as_ref().ok()?;
                let found = columns.iter().map(|&column| numbers[column]);
                Some((x, found.filter(|y| !y.is_nan()).reduce(f64::min)?))
            });
            let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
            let series = Series::line_points(name.as_str(), x, y).color(Color::category(index));
            panel = panel.series_if_visible(series);
        }
        panel
    });
    figure("Sweep", 2, 170.0, panels)
}
