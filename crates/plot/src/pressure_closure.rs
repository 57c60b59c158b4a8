//! Pressure against closure: the path of each contact during a run, and its law.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_signal::decay_length;
use asperity_simulation::assemble::Interfaces;
use asperity_simulation::contact_path::{ContactPath, contact_paths};
use asperity_simulation::record::motions;
use asperity_simulation::run::Run;

use super::{figure, fitted};

/// Points of the law, and the part of the visited closures by which the law goes on at both ends.
const LAW_POINTS: usize = 201;
const MARGIN: f64 = 0.12;

/// Least distance of two points of a path, over the ranges of closure and pressure.
const RESOLUTION: f64 = 2e-3;

/// Most contacts drawn, and most characters of their names.
const MOST_PANELS: usize = 12;
const MOST_NAME: usize = 40;

/// Traction of each contact over its closure while the motion lasts, with its law and the state at rest: a
/// panel per contact, none without contacts.
///
/// The path of a contact with damping or friction encloses its loss; another path lies on the law. The
/// path of a patch is the mean of its cells, which leaves the law where they differ.
pub fn pressure_closure<S: Interfaces>(run: &Run<S>) -> Option<Figure> {
    let ends = motions(run).into_iter().map(|motion| decay_length(motion.relative));
    let end = ends.max().unwrap_or_default();
    let panels = contact_paths(run).into_iter().take(MOST_PANELS).map(|path| panel(&path, end));
    figure("Pressure against closure", 2, 170.0, panels)
}

/// A contact up to a sample.
fn panel(found: &ContactPath<'_>, end: usize) -> Panel {
    let end = end.min(found.closure.len());
    let (x, y) = path(&found.closure[..end], &found.traction[..end]);
    let (closure, pressure) = found.at_rest();
    let low = x.iter().copied().fold(closure, f64::min);
    let high = x.iter().copied().fold(closure, f64::max);
    let margin = MARGIN * (high - low);
    let (low, width) = (low - margin, high - low + 2.0 * margin);
    let at = |n: usize| low + width * n as f64 / (LAW_POINTS - 1) as f64;
    let law = (0..LAW_POINTS).map(|n| (at(n), found.law(at(n))));
    let (law_x, law_y): (Vec<f64>, Vec<f64>) = law.filter(|(_, p)| p.is_finite()).unzip();
    let label = format!("Pressure, {}", fitted(found.name(), MOST_NAME));
    let rest = Series::points("at rest", [closure], [pressure]);
    Panel::new(Axis::linear("Closure", "µm").scale(1e6), Axis::linear(label, "MPa").scale(1e-6))
        .series(Series::line("path", x, y).color(Color::BLUE))
        .series_if_visible(Series::line("law", law_x, law_y).color(Color::BLACK).dash(Dash::Dashed))
        .series(rest.color(Color::RED).marker_size(4.0).filled(true))
        .legend(Legend::TopLeft)
}

/// The points of a path that differ visibly from the point before.
fn path(closure: &[f64], traction: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let range = |values: &[f64]| {
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = high - values.iter().copied().fold(f64::INFINITY, f64::min);
        if range > 0.0 { RESOLUTION * range } else { f64::INFINITY }
    };
    let (dx, dy) = (range(closure), range(traction));
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (&x, &y) in closure.iter().zip(traction) {
        let differs = |last: &(f64, f64)| (x - last.0).abs() > dx || (y - last.1).abs() > dy;
        if kept.last().is_none_or(differs) {
            kept.push((x, y));
        }
    }
    kept.into_iter().unzip()
}
