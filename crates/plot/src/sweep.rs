//! Results of a sweep over its first numeric variation.

use asperity_figure::{Color, Figure, Legend, Panel, Series};
use asperity_simulation::quantity::Quantity;
use asperity_simulation::sweep::{Sweep, Variation};

use super::axes::{pointer_axis, pointer_value, quantity_axis};
use super::{figure, fitted};

/// Most lines of one panel: more colours cannot be told apart.
const MOST_LINES: usize = 7;

/// Most characters of the words of an axis, and of the name of a line.
const MOST_LABEL: usize = 40;
const MOST_NAME: usize = 44;

/// Most points of a line; of more runs, every so many are drawn.
const MOST_POINTS: usize = 500;

/// The quantities drawn; of several interfaces the least value counts.
const DRAWN: [Quantity; 5] = [
    Quantity::FundamentalFrequency,
    Quantity::FundamentalReceptance,
    Quantity::HarmonicRatio,
    Quantity::PressureMin,
    Quantity::StiffnessAverage,
];

/// A panel per observable, a line per combination of the other variations in their order;
/// none if no variation is numeric.
pub fn sweep(sweep: &Sweep) -> Option<Figure> {
    let numeric = |variation: &Variation| {
        variation.values.len() > 1 && variation.values.iter().all(|v| v.parse::<f64>().is_ok())
    };
    let across = sweep.variations.iter().position(numeric)?;
    let mut lines: Vec<(String, Vec<usize>)> = Vec::new();
    for run in 0..sweep.runs.len() {
        let values = sweep.values(run);
        let others = values.iter().enumerate().filter(|(index, _)| *index != across);
        let text =
            |(index, value): (usize, &&str)| pointer_value(&sweep.variations[index].pointer, value);
        let name = others.map(text).collect::<Vec<_>>().join(", ");
        match lines.iter_mut().find(|line| line.0 == name) {
            Some(line) => line.1.push(run),
            None => lines.push((name, vec![run])),
        }
    }
    let panels = DRAWN.iter().enumerate().map(|(place, &quantity)| {
        let is_drawn = |column: &usize| {
            Quantity::of_name(&sweep.columns[*column]).is_some_and(|(found, _)| found == quantity)
        };
        let columns: Vec<usize> = (0..sweep.columns.len()).filter(is_drawn).collect();
        let x_axis = pointer_axis(&sweep.variations[across].pointer, MOST_LABEL);
        let mut panel = Panel::new(x_axis, quantity_axis(quantity, quantity.label()));
        // One legend is enough.
        let is_named = lines.len() > 1 && place == 0;
        panel = panel.legend(if is_named { Legend::Auto } else { Legend::None });
        for (index, (name, runs)) in lines.iter().take(MOST_LINES).enumerate() {
            let every = runs.len().div_ceil(MOST_POINTS);
            let points = runs.iter().step_by(every).filter_map(|&run| {
                let x = sweep.values(run)[across].parse::<f64>().ok()?;
                let numbers = sweep.runs[run].as_ref().ok()?;
                let found = columns.iter().map(|&column| numbers[column]);
                Some((x, found.filter(|y| !y.is_nan()).reduce(f64::min)?))
            });
            let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
            let series = Series::line_points(fitted(name, MOST_NAME), x, y).category(index);
            panel = panel.series_if_visible(series);
        }
        panel
    });
    figure("Sweep", 2, 170.0, panels)
}

/// Series of hits in a figure of levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HitSeries {
    /// Measured values, with bars of two standard deviations.
    Measured,
    /// Computed values of each hit under its own measured force.
    Computed,
}

/// Values of hits over the force: series for [`Figure::with`](asperity_figure::Figure::with) a figure of a [`sweep`] over
/// `pointer`.
///
/// - `columns`: quantities with their points: force, value, standard deviation, in SI units; NaN for no deviation.
pub fn hit_levels(
    pointer: &str,
    columns: &[(Quantity, Vec<[f64; 3]>)],
    series: HitSeries,
) -> Figure {
    let panel = |(quantity, points): &(Quantity, Vec<[f64; 3]>)| {
        let column = |at: usize| -> Vec<f64> { points.iter().map(|point| point[at]).collect() };
        let drawn = match series {
            HitSeries::Measured => {
                let errors: Vec<f64> = points.iter().map(|point| 2.0 * point[2]).collect();
                let drawn = Series::points("measured", column(0), column(1)).errors(errors);
                drawn.color(Color::RED).filled(true)
            }
            HitSeries::Computed => {
                let name = "computed, own force";
                Series::points(name, column(0), column(1)).color(Color::RED)
            }
        };
        let axis = quantity_axis(*quantity, quantity.label());
        Panel::new(pointer_axis(pointer, MOST_LABEL), axis)
            .series_if_visible(drawn.marker_size(3.0))
    };
    columns.iter().map(panel).fold(Figure::new("Hits"), Figure::panel)
}
