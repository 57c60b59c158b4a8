//! Measured against predicted: features, receptance, backbone and standardised residuals.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_inference::normal_quantile;

use super::observations::{ObservationKind, ObservationRow, column, feature_name, groups, order};
use crate::axes::axis;
use crate::{capital, fitted};

/// Most features and most sets of data of a figure.
const MOST_PANELS: usize = 6;
/// Most sets of data of a panel: beyond, colours cannot be told apart.
const MOST_DATA: usize = 6;

/// Most features with a name in a panel of residuals.
const MOST_FEATURES: usize = 7;

/// Features of hits over force.
pub(super) fn features(rows: &[ObservationRow<'_>]) -> Option<Figure> {
    let hits = rows.iter().filter(|row| row.kind == ObservationKind::Hit && row.at.is_finite());
    let mut features = groups(hits, |row| row.feature);
    features.sort_by_key(|feature| order(feature.0));
    features.truncate(MOST_PANELS);
    let several =
        features.iter().any(|(_, of)| groups(of.iter().copied(), |row| row.data).len() > 1);
    let panels = features.iter().enumerate().map(|(index, (feature, of))| {
        let (label, unit) = feature_name(feature);
        let axes = [Axis::linear("Peak force", "N"), axis(label, unit)];
        // One key is enough unless it has to tell sets of data apart.
        panel(axes, of, index == 0, several)
    });
    figure("Features of hits over force", panels.collect())
}

/// Parts of the receptance over frequency.
pub(super) fn receptance(rows: &[ObservationRow<'_>]) -> Option<Figure> {
    let lines = rows.iter().filter(|row| row.kind == ObservationKind::Receptance);
    let panels =
        groups(lines, |row| row.data).into_iter().take(MOST_PANELS / 2).flat_map(|(data, of)| {
            let parts = groups(of.iter().copied(), |row| row.feature);
            let drawn = parts.iter().enumerate().map(|(index, (feature, of))| {
                let (label, unit) = feature_name(feature);
                let label = label.strip_prefix("Receptance, ").map_or(label.clone(), capital);
                let axes = [Axis::linear("Frequency", "Hz"), axis(label, unit)];
                panel(axes, of, index == 0, false).title(fitted(data, 44))
            });
            drawn.collect::<Vec<_>>()
        });
    figure("Receptance", panels.collect())
}

/// Amplitude and phase of steady responses over frequency, a panel for each level.
pub(super) fn steady(rows: &[ObservationRow<'_>]) -> Option<Figure> {
    let lines = rows.iter().filter(|row| row.kind == ObservationKind::Steady);
    let features = groups(lines, |row| row.feature).into_iter().take(MOST_PANELS).enumerate();
    let panels = features.map(|(index, (feature, of))| {
        let (label, unit) = feature_name(feature);
        panel([Axis::linear("Frequency", "Hz"), axis(label, unit)], &of, index == 0, false)
    });
    figure("Steady responses", panels.collect())
}

/// Frequency and damping over amplitude along decays.
pub(super) fn backbone(rows: &[ObservationRow<'_>]) -> Option<Figure> {
    let points = rows.iter().filter(|row| row.kind == ObservationKind::Backbone && row.at > 0.0);
    let parts = groups(points, |row| (row.data, row.feature));
    let panels = parts.into_iter().take(MOST_PANELS).enumerate();
    let panels = panels.map(|(index, ((data, feature), of))| {
        let (label, unit) = feature_name(feature);
        let axes = [Axis::log("Amplitude", "m"), axis(label, unit)];
        panel(axes, &of, index == 0, false).title(fitted(data, 44))
    });
    figure("Backbone", panels.collect())
}

fn figure(title: &str, panels: Vec<Panel>) -> Option<Figure> {
    let columns = panels.len().min(2);
    crate::figure(title, columns, if columns == 1 { 110.0 } else { 170.0 }, panels)
}

/// One feature; each set of data in its own colour.
fn panel([x, y]: [Axis; 2], rows: &[&ObservationRow<'_>], legend: bool, several: bool) -> Panel {
    let mut panel = Panel::new(x, y);
    let every = groups(rows.iter().copied(), |row| row.data);
    let (mut bands, mut lines, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (data, mut of)) in every.into_iter().take(MOST_DATA).enumerate() {
        of.sort_by(|a, b| a.at.total_cmp(&b.at));
        let at = column(&of, |row| row.at);
        let color = Color::category(index + 1);
        // Several sets of data are told apart by their marks; the caption explains the lines.
        let name = |words: &str| match (legend, several) {
            (true, false) => words.to_owned(),
            (true, true) if words == "measured" => fitted(data, 24),
            _ => String::new(),
        };
        let [low, high] = [0, 1].map(|side: usize| column(&of, |row| row.band[side]));
        if of.len() > 1 && low.iter().any(|end| end.is_finite()) {
            bands.push(Series::band(name("band of the fit"), &at, low, high).color(color));
        }
        let predicted = column(&of, |row| row.predicted);
        if predicted.iter().any(|value| value.is_finite()) {
            let line = Series::line(name("best fit"), &at, &predicted);
            let series = if several { line.category(index) } else { line }.color(color);
            // A single point makes no line.
            let lone = if of.len() == 1 { Marker::Plus } else { Marker::None };
            lines.push(series.marker(lone));
        }
        let errors = column(&of, |row| 2.0 * row.standard_deviation);
        let series = Series::points(name("measured"), &at, column(&of, |row| row.value));
        let shade = if several { color } else { Color::BLACK };
        points.push(series.errors(errors).category(index).color(shade));
    }
    panel = panel.all_series(bands).all_series(lines).all_series(points);
    panel.legend(if legend { Legend::Auto } else { Legend::None })
}

/// A panel per abscissa, and one against normal quantiles.
pub(super) fn residuals(rows: &[ObservationRow<'_>]) -> Option<Figure> {
    let known: Vec<&ObservationRow<'_>> =
        rows.iter().filter(|row| row.residual.is_finite()).collect();
    if known.is_empty() {
        return None;
    }
    let largest = column(&known, |row| row.residual.abs()).into_iter().fold(2.5, f64::max);
    let axis = Axis::linear("Residual", "standard deviations");
    let axis = || axis.clone().range(-1.1 * largest, 1.1 * largest);
    let figure = Figure::new("Standardised residuals").columns(2).width_mm(170.0);
    let mut figure = figure.row_height_mm(70.0);
    // An amplitude is drawn on a logarithmic axis.
    let shown = |row: &ObservationRow<'_>| {
        row.at.is_finite() && (row.kind != ObservationKind::Backbone || row.at > 0.0)
    };
    for (kind, across) in [
        (ObservationKind::Hit, Axis::linear("Peak force", "N")),
        (ObservationKind::Receptance, Axis::linear("Frequency", "Hz")),
        (ObservationKind::Steady, Axis::linear("Frequency", "Hz")),
        (ObservationKind::Backbone, Axis::log("Amplitude", "m")),
        (ObservationKind::Stiffness, Axis::linear("Pressure", "MPa").scale(1e-6)),
    ] {
        let of = known.iter().copied().filter(|row| row.kind == kind && shown(row));
        let mut of = groups(of, |row| row.feature);
        of.sort_by_key(|group| order(group.0));
        if of.is_empty() {
            continue;
        }
        let mut panel = Panel::new(across, axis()).horizontal(0.0, "");
        for (index, (feature, rows)) in of.iter().enumerate() {
            let name = if index < MOST_FEATURES { feature_name(feature).0 } else { String::new() };
            let (x, y) = (column(rows, |row| row.at), column(rows, |row| row.residual));
            panel = panel.series(Series::points(name, x, y).category(index));
        }
        figure = figure.panel(panel.horizontal(2.0, "").horizontal(-2.0, "").legend(Legend::Above));
    }
    let mut sorted = column(&known, |row| row.residual);
    sorted.sort_by(f64::total_cmp);
    let normal = normal_quantiles(sorted.len());
    let reach = normal.last().copied().unwrap_or(0.0).max(2.0) * 1.1;
    let (points, line) = (
        Series::points("residuals", &normal, &sorted).color(Color::BLUE),
        Series::line("as the standard deviations say", [-reach, reach], [-reach, reach]),
    );
    let panel = Panel::new(Axis::linear("Normal quantile", "").range(-reach, reach), axis());
    let panel = panel.series(line.color(Color::GREY).dash(Dash::Dashed)).series(points);
    Some(figure.panel(panel.legend(Legend::Above)))
}

/// The normal quantiles at which `count` sorted numbers are expected: of (i - 1/2) / n.
fn normal_quantiles(count: usize) -> Vec<f64> {
    (0..count).map(|i| normal_quantile((i as f64 + 0.5) / count as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // The quartiles of a normal distribution are at 0.67449 standard deviations.
        let [low, high] = normal_quantiles(2)[..] else { panic!("two") };
        assert!((low + 0.674_489_750_2).abs() < 1e-8 && (high - 0.674_489_750_2).abs() < 1e-8);
        assert!(normal_quantiles(3)[1].abs() < 1e-12);
    }
}
