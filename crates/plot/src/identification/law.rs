//! Stiffness over pressure with its band, and the uncertainty left.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_identify::{INFORMED_SHARE, Identification, LawBand, RESOLVED, StiffnessOrigin};

use super::observations::{ObservationKind, ObservationRow, column};

/// Largest factor about the best fit to which the band is drawn.
const MOST_FACTOR: f64 = 6.0;

/// Part of the largest pressure below which the lowest pressure has no name in the figure.
const LEAST_PLACE: f64 = 0.01;

/// Colours of compared laws of fixed form.
const FORMS: [Color; 4] = [Color::RED, Color::GREEN, Color::ORANGE, Color::PURPLE];

/// The law of an identification.
pub(super) fn law(found: &Identification, rows: &[ObservationRow<'_>]) -> Figure {
    let law = &found.law;
    let feature = format!("stiffness of {}", law.name);
    let points: Vec<&ObservationRow<'_>> = rows
        .iter()
        .filter(|row| row.kind == ObservationKind::Stiffness && row.feature == feature)
        .collect();
    let top = law.pressure.last().copied().unwrap_or(1.0);
    let top = column(&points, |row| row.at).into_iter().fold(top, f64::max);
    let pressure = || Axis::linear("Pressure", "MPa").scale(1e-6).range(0.0, 1e-6 * top);

    let band = format!("{:.0} % band", 100.0 * found.level);
    let [low, high] = range(found, &points);
    let stiffness = Axis::log("Contact stiffness", "Pa/m").range(low, high);
    let is_void = found.judgement().is_void();
    let band = if is_void {
        hatched(format!("{band}, void: not to be used"), law)
    } else {
        Series::band(band, &law.pressure, &law.lower, &law.upper)
    };
    let best = Series::line("best fit", &law.pressure, &law.stiffness).width(1.2);
    let given: Vec<f64> = law
        .stiffness
        .iter()
        .zip(&law.origin)
        .map(|(k, origin)| if *origin == StiffnessOrigin::Given { *k } else { f64::NAN })
        .collect();
    let given = Series::line("given, not measured", &law.pressure, given).width(2.4);
    let [first, third] = &law.quartiles;
    let half = Series::band("50 % band", &law.pressure, first, third);
    let mut shown = Panel::new(pressure(), stiffness).series_if_visible(band.color(Color::BLUE));
    if !is_void {
        shown = shown.series_if_visible(half.color(Color::BLUE).lightness(0.5));
    }
    for (place, draw) in law.draws.iter().enumerate() {
        let name = if place == 0 { "draws" } else { "" };
        let draw = Series::line(name, &law.pressure, draw).width(0.4);
        shown = shown.series_if_visible(draw.color(Color::GREY));
    }
    for (form, color) in found.forms.iter().zip(FORMS) {
        let line = Series::line(&form.name, &law.pressure, &form.stiffness).width(0.9);
        shown = shown.series_if_visible(line.color(color).dash(Dash::Dashed));
    }
    shown = shown
        .series_if_visible(best.color(Color::BLUE))
        .series_if_visible(given.color(Color::GREY));
    if !points.is_empty() {
        let errors = column(&points, |row| 2.0 * row.standard_deviation);
        let series = Series::points(
            "measured, ±2 standard deviations",
            column(&points, |row| row.at),
            column(&points, |row| row.value),
        );
        shown = shown.series(series.errors(errors).color(Color::BLACK).marker(Marker::Circle));
    }
    // At the side there is no room for a name.
    let lowest = if law.reached[0] > LEAST_PLACE * top { "lowest" } else { "" };
    shown = shaded(shown, law)
        .vertical(law.reached[0], lowest)
        .vertical(law.reached[1], "highest")
        .vertical(law.at_rest, "at rest");

    let usable = law.remaining.iter().copied().filter(|part| *part > 0.0 && part.is_finite());
    let least = usable.fold(f64::INFINITY, f64::min).clamp(1e-6, 0.1);
    let left = Axis::log("Uncertainty left, of that before", "").range(0.8 * least, 1.5);
    let left = Panel::new(pressure(), left)
        .legend(Legend::None)
        .series_if_visible(Series::line("", &law.pressure, &law.remaining).color(Color::BLUE));
    let left = shaded(left, law)
        .vertical(law.reached[0], "")
        .vertical(law.reached[1], "")
        .vertical(law.at_rest, "")
        .horizontal(INFORMED_SHARE, "1/3");
    let resolution = found.free_law.as_ref().map(|free| {
        let width = |&pressure: &f64| free.resolution(pressure).unwrap_or(f64::NAN);
        let widths: Vec<f64> = law.pressure.iter().map(width).collect();
        let spread = Axis::log("Width of the averaging kernel in ln p", "").range(0.03, 20.0);
        let panel = Panel::new(pressure(), spread).legend(Legend::None);
        let panel = panel.horizontal(RESOLVED, "a decade");
        let line = Series::line("", &law.pressure, widths).color(Color::BLUE);
        shaded(panel.series_if_visible(line), law).vertical(law.at_rest, "")
    });
    let figure = Figure::new(format!("Contact law \"{}\"", law.name));
    let figure = figure.panel(shown).panel(left);
    let figure = match resolution {
        Some(panel) => figure.panel(panel),
        None => figure,
    };
    figure.columns(1).width_mm(130.0).row_height_mm(66.0)
}

/// Strokes from the lower to the upper end of the band, one at each pressure of the law, in place of a
/// filled band.
fn hatched(name: String, law: &LawBand) -> Series {
    let ends = law.pressure.iter().zip(law.lower.iter().zip(&law.upper));
    let strokes = ends.flat_map(|(&p, (&low, &high))| [(p, low), (p, high), (p, f64::NAN)]);
    let (x, y): (Vec<f64>, Vec<f64>) = strokes.unzip();
    Series::line(name, x, y).width(0.5)
}

/// The panel with all pressures shaded but those that the data inform.
fn shaded(mut panel: Panel, law: &LawBand) -> Panel {
    let mut from = f64::NEG_INFINITY;
    for [low, high] in law.ranges(StiffnessOrigin::Data) {
        panel = panel.shade(from, low);
        from = high;
    }
    panel.shade(from, f64::INFINITY)
}

/// Range of stiffness \[Pa/m\] drawn: best fit, points, and the band up to [`MOST_FACTOR`].
fn range(found: &Identification, points: &[&ObservationRow<'_>]) -> [f64; 2] {
    let law = &found.law;
    let positive = |value: &f64| *value > 0.0 && value.is_finite();
    let least = |list: &[f64]| list.iter().copied().filter(positive).fold(f64::INFINITY, f64::min);
    let most = |list: &[f64]| list.iter().copied().filter(positive).fold(0.0, f64::max);
    let best = [least(&law.stiffness), most(&law.stiffness)];
    let band = [least(&law.lower), most(&law.upper)];
    let ends = |sign: f64| column(points, |row| row.value + sign * row.standard_deviation);
    let low = band[0].max(best[0] / MOST_FACTOR).min(best[0]).min(least(&ends(-2.0)));
    let high = band[1].min(best[1] * MOST_FACTOR).max(best[1]).max(most(&ends(2.0)));
    if low.is_finite() && low > 0.0 && high > low { [0.9 * low, 1.1 * high] } else { [1.0, 10.0] }
}
