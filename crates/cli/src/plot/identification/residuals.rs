//! Standardised residuals over what they were measured at, and against a normal distribution.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_inference::normal_quantile;

use super::Row;
use super::feature_name::{feature_name, order};
use super::rows::{Kind, column, groups};

/// Most features with a mark of their own.
const MOST_FEATURES: usize = 7;

const MARKERS: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Plus,
    Marker::Cross,
];

/// A panel per abscissa, and one against normal quantiles.
pub(super) fn residuals(rows: &[Row<'_>]) -> Option<Figure> {
    let known: Vec<&Row<'_>> = rows.iter().filter(|row| row.residual.is_finite()).collect();
    if known.is_empty() {
        return None;
    }
    let largest = column(&known, |row| row.residual.abs()).into_iter().fold(2.5, f64::max);
    let axis = || {
        let label = "Residual";
        Axis::linear(label, "standard deviations").range(-1.1 * largest, 1.1 * largest)
    };
    let mut figure = Figure::new("Standardised residuals").columns(2).width_mm(170.0);
    figure = figure.row_height_mm(70.0);
    // An amplitude is drawn on a logarithmic axis.
    let shown = |row: &Row<'_>| row.at.is_finite() && (row.kind != Kind::Backbone || row.at > 0.0);
    for kind in [Kind::Hit, Kind::Receptance, Kind::Backbone, Kind::Stiffness] {
        let of = known.iter().copied().filter(|row| row.kind == kind && shown(row));
        let mut of = groups(of, |row| row.feature);
        of.sort_by_key(|group| order(group.0));
        if of.is_empty() {
            continue;
        }
        let across = match kind {
            Kind::Hit => Axis::linear("Peak force", "N"),
            Kind::Receptance => Axis::linear("Frequency", "Hz"),
            Kind::Backbone => Axis::log("Amplitude", "m"),
            Kind::Stiffness => Axis::linear("Pressure", "MPa").scale(1e-6),
        };
        let mut panel = Panel::new(across, axis()).horizontal(0.0, "");
        for (index, (feature, rows)) in of.iter().enumerate() {
            let name = if index < MOST_FEATURES { feature_name(feature).0 } else { String::new() };
            let (x, y) = (column(rows, |row| row.at), column(rows, |row| row.residual));
            let series = Series::points(name, x, y).marker(MARKERS[index % MARKERS.len()]);
            panel = panel.series(series.color(Color::category(index)));
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
    use super::normal_quantiles;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // The quartiles of a normal distribution are at 0.67449 standard deviations.
        let [low, high] = normal_quantiles(2)[..] else { panic!("two") };
        assert!((low + 0.674_489_750_2).abs() < 1e-8 && (high - 0.674_489_750_2).abs() < 1e-8);
        assert!(normal_quantiles(3)[1].abs() < 1e-12);
    }
}
