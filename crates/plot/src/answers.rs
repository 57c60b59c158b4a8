//! Answers of a study: distributions and exceedance curves of its observables, and Sobol indices.

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_simulation::quantity::Quantity;
use asperity_study::{FrfBand, ObservableAnswers, StudyAnswers};

use super::axes::{pointer_words, quantity_axis};
use super::{figure, fitted};

/// Width of a figure.
const WIDTH_MM: f64 = 190.0;

/// Most characters of a label of a panel.
const MOST_LABEL: usize = 50;

/// Most characters of the name of an input.
const MOST_NAME: usize = 24;

/// Quantities of the computation, which are not drawn.
const NUMERICS: [Quantity; 5] = [
    Quantity::EnergyNumericalLoss,
    Quantity::EnergyResidual,
    Quantity::Step,
    Quantity::Steps,
    Quantity::EstimatedError,
];

/// The figures with their names; those without anything to draw are left out.
pub fn answers(found: &StudyAnswers, inputs: &[String]) -> Vec<(&'static str, Figure)> {
    // What the solver did is in the tables.
    let is_drawn = |one: &&ObservableAnswers| {
        let quantity = Quantity::of_name(&one.name).map(|found| found.0);
        !quantity.is_some_and(|quantity| NUMERICS.contains(&quantity))
    };
    let panels = |panel: &dyn Fn(&ObservableAnswers) -> Option<Panel>| -> Vec<Panel> {
        found.observables.iter().filter(is_drawn).filter_map(panel).collect()
    };
    // One legend is enough.
    let panels_with_legend = |panel: &dyn Fn(&ObservableAnswers) -> Option<Panel>| {
        let all = panels(panel).into_iter().enumerate();
        let place = |index: usize| if index == 0 { Legend::Above } else { Legend::None };
        all.map(|(index, panel)| panel.legend(place(index))).collect::<Vec<_>>()
    };
    let row_mm = 16.0 + 6.0 * inputs.len() as f64;
    let all = [
        ("frf", figure("Receptance", 1, WIDTH_MM, found.frf.as_ref().map(frf)), 80.0),
        (
            "distributions",
            figure("Distributions of the observables", 3, WIDTH_MM, panels(&distribution)),
            48.0,
        ),
        (
            "exceedance",
            figure("Exceedance of the observables", 3, WIDTH_MM, panels(&exceedance)),
            48.0,
        ),
        (
            "sobol-indices",
            figure("Sobol indices", 2, WIDTH_MM, panels_with_legend(&|one| indices(one, inputs))),
            row_mm.max(40.0),
        ),
    ];
    let drawn = all.into_iter();
    let sized = |figure: Figure, row: f64| figure.row_height_mm(row).tags(false);
    drawn.filter_map(|(name, figure, row)| Some((name, sized(figure?, row)))).collect()
}

/// Median of the receptance over frequency, with the bands of 50 % and 95 %.
fn frf(found: &FrfBand) -> Panel {
    let column = |at: usize| found.quantiles.iter().map(|all| all[at]).collect::<Vec<f64>>();
    let x = &found.frequency_hz;
    let up = Axis::log("Receptance", "m/N");
    Panel::new(Axis::linear("Frequency", "Hz"), up)
        .series(Series::band("95 %", x, column(0), column(4)).color(Color::BLUE))
        .series(Series::band("50 %", x, column(1), column(3)).color(Color::BLUE).lightness(0.5))
        .series(Series::line("median", x, column(2)).color(Color::BLUE).width(0.8))
}

/// Axis of an observable.
fn axis(one: &ObservableAnswers) -> Axis {
    match Quantity::of_name(&one.name) {
        Some((quantity, _)) => quantity_axis(quantity, fitted(quantity.label(), MOST_LABEL)),
        None => super::axes::axis(fitted(&one.name, MOST_LABEL), one.unit()),
    }
}

/// The name of the interface, where the observable has one.
fn interface(one: &ObservableAnswers) -> String {
    let name = Quantity::of_name(&one.name).and_then(|(_, interface)| interface);
    fitted(name.unwrap_or_default(), MOST_LABEL)
}

/// Histogram with the median, and the range between the outermost quantiles shaded.
fn distribution(one: &ObservableAnswers) -> Option<Panel> {
    let histogram = one.histogram.as_ref()?;
    let runs = histogram.counts.iter().sum::<u64>() + histogram.below + histogram.above;
    let joined = joined_bins(runs, histogram.counts.len());
    let edges: Vec<f64> = histogram.edges().into_iter().step_by(joined).collect();
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (edges, counts) in edges.windows(2).zip(histogram.counts.chunks(joined)) {
        x.extend([edges[0], edges[1]]);
        y.extend([counts.iter().sum::<u64>() as f64 / runs as f64; 2]);
    }
    let up = Axis::linear("Share of runs", "%").scale(100.0).low(0.0);
    let mut panel = Panel::new(axis(one), up)
        .title(interface(one))
        .legend(Legend::None)
        .series(Series::band("", &x, vec![0.0; x.len()], &y).color(Color::BLUE))
        .series(Series::line("", &x, &y).color(Color::BLUE).width(0.8));
    if let [(_, first), .., (_, last)] = one.quantiles.as_slice() {
        panel = panel.shade(first.value, last.value);
    }
    if let Some((_, median)) = one.quantiles.iter().find(|(p, _)| (p - 0.5).abs() < 1e-12) {
        panel = panel.vertical(median.value, "");
    }
    Some(panel)
}

/// Number of bins that are drawn as one, a divisor of `bins`: about `2 runs^(1/3)` of them are shown
/// (Rice's rule).
fn joined_bins(runs: u64, bins: usize) -> usize {
    let shown = 2.0 * (runs as f64).cbrt();
    let fits = |joined: &usize| bins.is_multiple_of(*joined) && (bins / joined) as f64 <= shown;
    (1..=bins).find(fits).unwrap_or(bins)
}

/// Probability of values at or above the abscissa, with its interval as an area.
fn exceedance(one: &ObservableAnswers) -> Option<Panel> {
    if one.exceedance_curve.is_empty() {
        return None;
    }
    let column = |of: fn(&asperity_study::IntervalEstimate) -> f64| -> Vec<f64> {
        one.exceedance_curve.iter().map(|(_, share)| of(share)).collect()
    };
    let x: Vec<f64> = one.exceedance_curve.iter().map(|(value, _)| *value).collect();
    let (low, high) = (column(|share| share.low), column(|share| share.high));
    let panel = Panel::new(axis(one), Axis::log("Probability of exceedance", ""))
        .title(interface(one))
        .legend(Legend::None)
        .series(Series::band("", &x, low, high).color(Color::BLUE))
        .series(Series::line("", &x, column(|share| share.value)).color(Color::BLUE).width(0.8));
    Some(panel)
}

/// First-order and total index of each input, the first input on top.
fn indices(one: &ObservableAnswers, inputs: &[String]) -> Option<Panel> {
    let found = one.indices.as_ref()?;
    let place = |input: usize| (inputs.len() - input) as f64;
    let ticks = inputs
        .iter()
        .enumerate()
        .map(|(at, name)| (place(at), fitted(&pointer_words(name).0, MOST_NAME)));
    let x_axis = Axis::linear("Sobol index", "").range(-0.2, 1.2);
    let y_axis = Axis::linear("Input", "").range(0.4, inputs.len() as f64 + 0.6).ticks(ticks);
    let label = Quantity::of_name(&one.name).map_or(one.name.as_str(), |found| found.0.label());
    let title = match interface(one) {
        name if name.is_empty() => label.to_owned(),
        name => format!("{label}, {name}"),
    };
    let mut panel = Panel::new(x_axis, y_axis).title(fitted(&title, MOST_LABEL));
    let orders = [
        ("first order", 0.16, Color::BLUE, Marker::Diamond, &found.first),
        ("total", -0.16, Color::ORANGE, Marker::Circle, &found.total),
    ];
    for (order, offset, color, marker, estimates) in orders {
        let (mut x, mut y, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (input, estimate) in estimates.iter().enumerate() {
            // A gap between intervals.
            x.extend([estimate.low, estimate.high, f64::NAN]);
            y.extend([place(input) + offset, place(input) + offset, f64::NAN]);
            values.push(estimate.value);
        }
        let heights: Vec<f64> = (0..inputs.len()).map(|input| place(input) + offset).collect();
        let points = Series::points(order, values, heights).color(color).marker(marker);
        panel = panel
            .series(Series::line("", x, y).color(color).width(0.9))
            .series(points.filled(order == "total").marker_size(4.0));
    }
    Some(panel)
}
