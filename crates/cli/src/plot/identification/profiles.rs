//! The deviance over each unknown.

use asperity_figure::{Anchor, Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_identify::Identification;
use asperity_inference::{Profile, ProfileEnd, normal_quantile};

use super::short;

/// Most unknowns.
const MOST_PANELS: usize = 12;

/// A panel per unknown; none without profiles.
pub(super) fn profiles(found: &Identification) -> Option<Figure> {
    let level = deviance_at(found.level);
    let panels: Vec<Panel> = found
        .profiles
        .iter()
        .filter(|profile| {
            profile.points.iter().any(|point| point.value.is_finite() && point.deviance.is_finite())
        })
        .take(MOST_PANELS)
        .map(|profile| panel(found, profile, level))
        .collect();
    if panels.is_empty() {
        return None;
    }
    let columns = panels.len().min(3);
    let figure = panels.into_iter().fold(Figure::new("Profile likelihoods"), Figure::panel);
    let figure = figure.columns(columns).row_height_mm(50.0);
    Some(figure.width_mm(if columns == 1 { 90.0 } else { 175.0 }))
}

fn panel(found: &Identification, profile: &Profile, level: f64) -> Panel {
    let name = found.names.get(profile.unknown).map_or("", String::as_str);
    let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
    let points = profile.points.iter().map(|point| (point.value, point.deviance));
    let points: Vec<(f64, f64)> = points.filter(finite).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    // Beyond twice the level a profile says nothing more.
    let most = y.iter().copied().fold(1.3 * level, f64::max);
    let deviance = Axis::linear("Deviance", "").range(0.0, most.min(2.0 * level));
    let best = found.fit.point.get(profile.unknown).copied().unwrap_or(f64::NAN);
    let (line_x, line_y): (Vec<f64>, Vec<f64>) = curve(&points, best).into_iter().unzip();
    let line = Series::line("", line_x, line_y).color(Color::BLUE);
    let marks = Series::points("", &x, &y).color(Color::BLUE).marker(Marker::Circle);
    let mut panel = Panel::new(Axis::linear(short(name, 24), ""), deviance)
        .series(line)
        .series(marks.marker_size(2.6))
        .horizontal(level, "")
        .note_at(
            0.5 * (profile.interval[0] + profile.interval[1]),
            level,
            super::findings::percent(found.level),
            Anchor::Above,
            Color::GREY,
        )
        .legend(Legend::None);
    for (end, at) in profile.ends.iter().zip(profile.interval) {
        if *end == ProfileEnd::Crossed {
            panel = panel.vertical(at, "");
        }
    }
    panel
}

/// The deviance between the points of a profile: its root, negative below the best value, is linear
/// there, as it is everywhere for a linear model.
fn curve(points: &[(f64, f64)], best: f64) -> Vec<(f64, f64)> {
    const PARTS: usize = 16;
    let root = |&(value, deviance): &(f64, f64)| {
        let root = deviance.max(0.0).sqrt();
        if value < best { -root } else { root }
    };
    let between = |pair: &[(f64, f64)]| {
        let (start, end) = (pair[0], pair[1]);
        let roots = [root(&start), root(&end)];
        (0..PARTS)
            .map(|part| part as f64 / PARTS as f64)
            .map(|part| {
                let root = roots[0] + part * (roots[1] - roots[0]);
                (start.0 + part * (end.0 - start.0), root * root)
            })
            .collect::<Vec<_>>()
    };
    points.windows(2).flat_map(between).chain(points.last().copied()).collect()
}

/// The deviance that a parameter's true value exceeds with a probability of 1 - `level`: the
/// quantile of chi-square with one degree of freedom, the square of the normal half-width.
pub(super) fn deviance_at(level: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * level).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_of_a_linear_model_is_drawn_as_its_parabola() {
        let parabola = |x: f64| 4.0 * (x - 1.0).powi(2);
        let points = [-1.0, 1.0, 1.5, 3.0].map(|x| (x, parabola(x)));
        let drawn = curve(&points, 1.0);
        assert!(drawn.len() > 40);
        assert!(drawn.iter().all(|&(x, y)| (y - parabola(x)).abs() < 1e-12), "{drawn:?}");
    }

    #[test]
    fn levels_are_those_of_the_tables() {
        // Quantiles of chi-square with one degree of freedom, from tables.
        for (level, deviance) in [(0.95, 3.841_459), (0.682_689_5, 1.0), (0.99, 6.634_897)] {
            assert!((deviance_at(level) - deviance).abs() < 2e-5, "{}", deviance_at(level));
        }
    }
}
