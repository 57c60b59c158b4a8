//! Stiffness over pressure with its band, and the uncertainty left.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_identify::{INFORMED_SHARE, Identification, LawBand, RESOLVED, StiffnessOrigin};

use super::observations::{ObservationKind, ObservationRow, column};

/// Largest factor about the best fit to which the band is drawn.
const MOST_FACTOR: f64 = 6.0;

/// Lowest pressure drawn over the lowest that is marked, and over the highest where that is zero.
const BELOW: f64 = 0.1;
const LEAST: f64 = 1e-3;

/// Distance of marked pressures that have one name, over the length of the axis.
const NEAR: f64 = 0.02;

/// Least number of informed pressures of a law in per cent.
const LEAST_INFORMED: usize = 3;

/// Half width of the band over the median up to which the law is drawn in per cent of it, too.
const THIN: f64 = 0.25;

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
    let low = lowest_drawn(law, &points, top);
    let pressure = || Axis::log("Pressure", "MPa").scale(1e-6).range(1e-6 * low, 1e-6 * top);

    let band = format!("{:.0} % band", 100.0 * found.level);
    let [least, most] = range(found, &points, low);
    let stiffness = Axis::log("Contact stiffness", "Pa/m").range(least, most);
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
    let marks = marks(law, top / low);
    let marked = |panel: Panel, named: bool| {
        let name = |name: &str| if named { name.to_owned() } else { String::new() };
        marks.iter().fold(shaded(panel, law), |panel, (at, text)| panel.vertical(*at, name(text)))
    };
    let shown = marked(shown, true).series(uninformed(low, least));
    let relative = (!is_void).then(|| relative(law, &points, pressure())).flatten();

    let usable = law.remaining.iter().copied().filter(|part| *part > 0.0 && part.is_finite());
    let least = usable.fold(f64::INFINITY, f64::min).clamp(1e-6, 0.1);
    let left = Axis::log("Deviation of ln K, posterior over prior", "").range(0.8 * least, 1.5);
    let left = Panel::new(pressure(), left)
        .legend(Legend::None)
        .series_if_visible(Series::line("", &law.pressure, &law.remaining).color(Color::BLUE));
    let left = marked(left, false).horizontal(INFORMED_SHARE, "1/3");
    let resolution = found.free_law.as_ref().map(|free| {
        let width = |&pressure: &f64| free.resolution(pressure).unwrap_or(f64::NAN);
        let widths: Vec<f64> = law.pressure.iter().map(width).collect();
        let spread = Axis::log("Width of the averaging kernel in ln p", "").range(0.03, 20.0);
        let panel = Panel::new(pressure(), spread).legend(Legend::None);
        let panel = panel.horizontal(RESOLVED, "a decade");
        let line = Series::line("", &law.pressure, widths).color(Color::BLUE);
        marked(panel.series_if_visible(line), false)
    });
    let panels = [Some(shown), relative.map(|panel| marked(panel, false)), Some(left), resolution];
    let figure = Figure::new(format!("Contact law \"{}\"", law.name));
    let figure = panels.into_iter().flatten().fold(figure, Figure::panel);
    figure.columns(1).width_mm(130.0).row_height_mm(66.0)
}

/// The lowest pressure drawn \[Pa\]: a decade below the lowest that is reached, at rest or measured.
fn lowest_drawn(law: &LawBand, points: &[&ObservationRow<'_>], top: f64) -> f64 {
    let marked = [law.reached[0], law.at_rest].into_iter().chain(column(points, |row| row.at));
    let lowest = marked.filter(|at| *at > LEAST * top).fold(top, f64::min);
    let known = law.pressure.iter().copied().find(|pressure| *pressure > 0.0).unwrap_or(0.0);
    let reaches_zero = law.reached[0] <= LEAST * top;
    let low = if reaches_zero { LEAST * top } else { BELOW * lowest };
    low.max(known).min(0.5 * top)
}

/// The pressures marked with their names: lowest and highest reached, and at rest. Those that would be
/// drawn over each other have one mark.
///
/// - `span`: highest over lowest pressure drawn.
fn marks(law: &LawBand, span: f64) -> Vec<(f64, String)> {
    let [lowest, highest] = law.reached;
    let mut all = [(lowest, "lowest"), (law.at_rest, "at rest"), (highest, "highest")];
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut marks: Vec<(f64, String)> = Vec::new();
    for (at, name) in all {
        match marks.last_mut() {
            Some((last, names)) if (at / *last).ln() < NEAR * span.ln() => {
                *names = format!("{names}, {name}");
            }
            _ => marks.push((at, name.to_owned())),
        }
    }
    marks
}

/// Bands, draws, best fit and measured points less the median, in per cent of it; none where the band is
/// wide at the pressures that the data inform, or where they inform none.
fn relative(law: &LawBand, points: &[&ObservationRow<'_>], pressure: Axis) -> Option<Panel> {
    let share = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(&law.median).map(|(value, median)| value / median - 1.0).collect()
    };
    let (lower, upper) = (share(&law.lower), share(&law.upper));
    let ends = lower.iter().zip(&upper).zip(&law.informed).filter(|(_, informed)| **informed);
    let widest = ends.map(|((low, high), _)| high.max(-low)).fold(0.0, f64::max);
    let informed = law.informed.iter().filter(|informed| **informed).count();
    if !(widest > 0.0 && widest < THIN) || informed < LEAST_INFORMED {
        return None;
    }
    let most = 160.0 * widest;
    let up = Axis::linear("Stiffness over its median, less 1", "%").scale(100.0);
    let line = |values: &[f64]| Series::line("", &law.pressure, share(values));
    let band = |low: &[f64], high: &[f64]| Series::band("", &law.pressure, low, high);
    let [first, third] = &law.quartiles;
    let mut panel = Panel::new(pressure, up.range(-most, most))
        .legend(Legend::None)
        .series_if_visible(band(&lower, &upper).color(Color::BLUE))
        .series_if_visible(band(&share(first), &share(third)).color(Color::BLUE).lightness(0.5));
    for draw in &law.draws {
        panel = panel.series_if_visible(line(draw).width(0.4).color(Color::GREY));
    }
    panel = panel.series_if_visible(line(&law.stiffness).width(1.2).color(Color::BLUE));
    let measured = |row: &ObservationRow<'_>| row.value / interpolated(law, row.at) - 1.0;
    if !points.is_empty() {
        let at = column(points, |row| row.at);
        let errors = column(points, |row| 2.0 * row.standard_deviation / interpolated(law, row.at));
        let series = Series::points("", at, column(points, measured)).errors(errors);
        panel = panel.series_if_visible(series.color(Color::BLACK));
    }
    Some(panel)
}

/// The median at a pressure; NaN outside those of the law.
fn interpolated(law: &LawBand, at: f64) -> f64 {
    let next = law.pressure.partition_point(|pressure| *pressure < at);
    let (Some(&high), Some(&value)) = (law.pressure.get(next), law.median.get(next)) else {
        return f64::NAN;
    };
    let Some(before) = next.checked_sub(1) else {
        return if high == at { value } else { f64::NAN };
    };
    let (low, start) = (law.pressure[before], law.median[before]);
    start + (value - start) * (at - low) / (high - low)
}

/// Strokes from the lower to the upper end of the band, one at each pressure of the law, in place of a
/// filled band.
fn hatched(name: String, law: &LawBand) -> Series {
    let ends = law.pressure.iter().zip(law.lower.iter().zip(&law.upper));
    let strokes = ends.flat_map(|(&p, (&low, &high))| [(p, low), (p, high), (p, f64::NAN)]);
    let (x, y): (Vec<f64>, Vec<f64>) = strokes.unzip();
    Series::line(name, x, y).width(0.5)
}

/// The entry of the legend for what [`shaded`] draws: a band without area, in a corner of the panel.
fn uninformed(pressure: f64, stiffness: f64) -> Series {
    let (x, y) = ([pressure, pressure], [stiffness, stiffness]);
    Series::band("not informed by the data", x, y, y).color(Color::GREY).lightness(0.88)
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

/// Range of stiffness \[Pa/m\] drawn from the pressure `from` \[Pa\] on: best fit, points, and the band up
/// to [`MOST_FACTOR`].
fn range(found: &Identification, points: &[&ObservationRow<'_>], from: f64) -> [f64; 2] {
    let law = &found.law;
    let first = law.pressure.partition_point(|pressure| *pressure < from);
    let positive = |value: &f64| *value > 0.0 && value.is_finite();
    let drawn =
        |list: &[f64]| list.iter().copied().skip(first).filter(positive).collect::<Vec<_>>();
    let least = |list: &[f64]| drawn(list).into_iter().fold(f64::INFINITY, f64::min);
    let most = |list: &[f64]| drawn(list).into_iter().fold(0.0, f64::max);
    let best = [least(&law.stiffness), most(&law.stiffness)];
    let band = [least(&law.lower), most(&law.upper)];
    let ends = |sign: f64| {
        let ends = column(points, |row| row.value + sign * row.standard_deviation);
        ends.into_iter().filter(positive).collect::<Vec<_>>()
    };
    let low = ends(-2.0).into_iter().fold(best[0], f64::min);
    let low = band[0].max(best[0] / MOST_FACTOR).min(best[0]).min(low);
    let high = ends(2.0).into_iter().fold(best[1], f64::max);
    let high = band[1].min(best[1] * MOST_FACTOR).max(best[1]).max(high);
    if low.is_finite() && low > 0.0 && high > low { [0.9 * low, 1.1 * high] } else { [1.0, 10.0] }
}
