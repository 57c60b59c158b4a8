//! Measured against predicted.

use asperity_figure::{Axis, Color, Figure, Legend, Marker, Panel, Series};

use super::feature_name::{capital, feature_name, order};
use super::rows::{Kind, column, groups};
use super::{Row, fitted};

/// Most features and most sets of data of a figure.
const MOST_PANELS: usize = 6;
/// Most sets of data of a panel: beyond, colours say nothing any more.
const MOST_DATA: usize = 6;

/// Marks of the sets of data.
const MARKERS: [Marker; 4] = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];

/// Features of hits over force.
pub(super) fn features(rows: &[Row<'_>]) -> Option<Figure> {
    let hits = rows.iter().filter(|row| row.kind == Kind::Hit && row.at.is_finite());
    let mut features = groups(hits, |row| row.feature);
    features.sort_by_key(|feature| order(feature.0));
    features.truncate(MOST_PANELS);
    let several =
        features.iter().any(|(_, of)| groups(of.iter().copied(), |row| row.data).len() > 1);
    let panels = features.iter().enumerate().map(|(index, (feature, of))| {
        let (label, unit) = feature_name(feature);
        let axes = [Axis::linear("Peak force", "N"), axis(label, unit)];
        // One key is enough unless it has to tell sets of data apart.
        panel(axes, of, if index == 0 { Keys::Words } else { Keys::None }, several)
    });
    figure("Features of hits over force", panels.collect())
}

/// Parts of the receptance over frequency.
pub(super) fn receptance(rows: &[Row<'_>]) -> Option<Figure> {
    let lines = rows.iter().filter(|row| row.kind == Kind::Receptance);
    let panels =
        groups(lines, |row| row.data).into_iter().take(MOST_PANELS / 2).flat_map(|(data, of)| {
            let parts = groups(of.iter().copied(), |row| row.feature);
            let drawn = parts.iter().enumerate().map(|(index, (feature, of))| {
                let (label, unit) = feature_name(feature);
                let label = label.strip_prefix("Receptance, ").map_or(label.clone(), capital);
                let axes = [Axis::linear("Frequency", "Hz"), axis(label, unit)];
                let keys = if index == 0 { Keys::Words } else { Keys::None };
                panel(axes, of, keys, false).title(fitted(data, 44))
            });
            drawn.collect::<Vec<_>>()
        });
    figure("Receptance", panels.collect())
}

/// Frequency over amplitude along decays.
pub(super) fn backbone(rows: &[Row<'_>]) -> Option<Figure> {
    let points = rows.iter().filter(|row| row.kind == Kind::Backbone && row.at > 0.0);
    let panels = groups(points, |row| row.data).into_iter().take(MOST_PANELS).enumerate();
    let panels = panels.map(|(index, (data, of))| {
        let axes = [Axis::log("Amplitude", "m"), Axis::linear("Frequency", "Hz")];
        let keys = if index == 0 { Keys::Words } else { Keys::None };
        panel(axes, &of, keys, false).title(fitted(data, 44))
    });
    figure("Backbone", panels.collect())
}

/// What a panel's legend says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Keys {
    /// What the marks mean.
    Words,
    /// Nothing.
    None,
}

/// The axis of a feature in a unit of handy numbers.
fn axis(label: String, unit: &'static str) -> Axis {
    match unit {
        "m/N" => Axis::linear(label, "nm/N").scale(1e9),
        "Pa" => Axis::linear(label, "MPa").scale(1e-6),
        _ => Axis::linear(label, unit),
    }
}

fn figure(title: &str, panels: Vec<Panel>) -> Option<Figure> {
    if panels.is_empty() {
        return None;
    }
    let columns = panels.len().min(2);
    let figure = panels.into_iter().fold(Figure::new(title), Figure::panel).columns(columns);
    Some(figure.width_mm(if columns == 1 { 110.0 } else { 170.0 }))
}

/// One feature; of several sets of data each in its own colour.
fn panel([x, y]: [Axis; 2], rows: &[&Row<'_>], keys: Keys, several: bool) -> Panel {
    let mut panel = Panel::new(x, y);
    let every = groups(rows.iter().copied(), |row| row.data);
    let (mut bands, mut lines, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (data, mut of)) in every.into_iter().take(MOST_DATA).enumerate() {
        of.sort_by(|a, b| a.at.total_cmp(&b.at));
        let at = column(&of, |row| row.at);
        let color = Color::category(index + 1);
        // Several sets of data are told apart by their marks; what a line is then says the caption.
        let name = |words: &str| match (keys, several) {
            (Keys::Words, false) => words.to_owned(),
            (Keys::Words, true) if words == "measured" => fitted(data, 24),
            _ => String::new(),
        };
        let [low, high] = [0, 1].map(|side: usize| column(&of, |row| row.band[side]));
        if of.len() > 1 && low.iter().any(|end| end.is_finite()) {
            bands.push(Series::band(name("band of the fit"), &at, low, high).color(color));
        }
        let predicted = column(&of, |row| row.predicted);
        if predicted.iter().any(|value| value.is_finite()) {
            let series = Series::line(name("best fit"), &at, &predicted).color(color);
            // A single point makes no line.
            let lone = if of.len() == 1 { Marker::Plus } else { Marker::None };
            lines.push(series.marker(lone));
        }
        let errors = column(&of, |row| 2.0 * row.standard_deviation);
        let series = Series::points(name("measured"), &at, column(&of, |row| row.value));
        let shade = if several { color } else { Color::BLACK };
        points.push(series.errors(errors).color(shade).marker(MARKERS[index % MARKERS.len()]));
    }
    panel = panel.all_series(bands).all_series(lines).all_series(points);
    panel.legend(if keys == Keys::None { Legend::None } else { Legend::Auto })
}
