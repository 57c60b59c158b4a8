//! Profile likelihoods and draws from the posterior.

use asperity_figure::{Anchor, Axis, Color, Figure, Legend, Marker, Panel, Series};
use asperity_identify::Identification;
use asperity_inference::{Profile, ProfileEnd, normal_quantile};

use super::percent;
use crate::axes::{display_factor, pointer_axis};
use crate::figure;

/// Most characters of the words of a parameter.
const MOST_NAME: usize = 32;

/// Most profiles that are drawn.
const MOST_PROFILES: usize = 12;

/// Most parameters that are drawn: the first ones.
pub(super) const MOST_PARAMETERS: usize = 6;
/// Most draws of a panel.
const MOST_DRAWS: usize = 400;
/// Bins of a histogram.
const BINS: usize = 20;
/// Sizes of the marks: their area follows the weight.
const SIZES: usize = 5;
/// Diameter of the largest mark, in points.
const LARGEST: f64 = 2.6;

/// A panel per parameter; none without profiles.
pub(super) fn profiles(found: &Identification) -> Option<Figure> {
    let level = deviance_at(found.level);
    let panels: Vec<Panel> = found
        .profiles
        .iter()
        .filter(|profile| {
            profile.points.iter().any(|point| point.value.is_finite() && point.deviance.is_finite())
        })
        .take(MOST_PROFILES)
        .map(|profile| panel(found, profile, level))
        .collect();
    let columns = panels.len().min(3);
    let width = if columns == 1 { 90.0 } else { 175.0 };
    Some(figure("Profile likelihoods", columns, width, panels)?.row_height_mm(50.0))
}

fn panel(found: &Identification, profile: &Profile, level: f64) -> Panel {
    let name = found.names.get(profile.parameter).map_or("", String::as_str);
    let finite = |point: &(f64, f64)| point.0.is_finite() && point.1.is_finite();
    let points = profile.points.iter().map(|point| (point.value, point.deviance));
    let points: Vec<(f64, f64)> = points.filter(finite).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    // The profile is cut at twice the level.
    let most = y.iter().copied().fold(1.3 * level, f64::max);
    let deviance = Axis::linear("Deviance", "").range(0.0, most.min(2.0 * level));
    let best = found.fit.point.get(profile.parameter).copied().unwrap_or(f64::NAN);
    let (line_x, line_y): (Vec<f64>, Vec<f64>) = curve(&points, best).into_iter().unzip();
    let line = Series::line("", line_x, line_y).color(Color::BLUE);
    let marks = Series::points("", &x, &y).color(Color::BLUE).marker(Marker::Circle);
    let mut panel = Panel::new(pointer_axis(name, MOST_NAME), deviance)
        .series(line)
        .series(marks.marker_size(2.6))
        .horizontal(level, "")
        .note_at(
            0.5 * (profile.interval[0] + profile.interval[1]),
            level,
            percent(found.level),
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

/// The deviance between the points of a profile. Its root, negative below the best value, is
/// interpolated linearly, which is exact for a linear model.
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
fn deviance_at(level: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * level).powi(2)
}

/// Pairs of parameters below the diagonal, histograms on it; none without draws.
pub(super) fn pairs(found: &Identification) -> Option<Figure> {
    let posterior = &found.posterior;
    let count = found.names.len().min(MOST_PARAMETERS);
    let whole = |draw: &Vec<f64>| draw.len() >= count && draw.iter().all(|x| x.is_finite());
    let draws: Vec<(&[f64], f64)> = posterior
        .draws
        .iter()
        .zip(&posterior.weights)
        .filter(|(draw, weight)| **weight > 0.0 && whole(draw))
        .map(|(draw, weight)| (draw.as_slice(), *weight))
        .collect();
    if draws.is_empty() || count == 0 {
        return None;
    }
    let column =
        |parameter: usize| draws.iter().map(|draw| draw.0[parameter]).collect::<Vec<f64>>();
    let columns: Vec<Vec<f64>> = (0..count).map(column).collect();
    let weights: Vec<f64> = draws.iter().map(|draw| draw.1).collect();
    let ranges: Vec<[f64; 2]> = columns.iter().map(|values| range(values)).collect();
    let groups = by_weight(&weights);

    let mut figure = Figure::new("Posterior").columns(count).tags(false);
    for row in 0..count {
        for place in 0..count {
            let panel = if place > row {
                Panel::blank()
            } else {
                let axis = |parameter: usize, labelled: bool| {
                    let name = found.names[parameter].as_str();
                    let (words, factor) = (pointer_axis(name, MOST_NAME), display_factor(name));
                    let axis = if labelled { words } else { Axis::linear("", "").scale(factor) };
                    let [low, high] = ranges[parameter];
                    let axis = axis.range(factor * low, factor * high);
                    if labelled { axis } else { axis.ticks(std::iter::empty::<(f64, String)>()) }
                };
                let across = axis(place, row + 1 == count);
                if place == row {
                    histogram(across, &columns[row], &weights, ranges[row])
                } else {
                    let up = axis(row, place == 0);
                    scatter(Panel::new(across, up), &columns[place], &columns[row], &groups)
                }
            };
            figure = figure.panel(panel.legend(Legend::None));
        }
    }
    let (width, height) = (if count <= 2 { 110.0 } else { 178.0 }, 178.0 / count as f64);
    Some(figure.width_mm(width).row_height_mm(height.clamp(30.0, 48.0)))
}

/// Lowest and highest value with a little room.
fn range(values: &[f64]) -> [f64; 2] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let room = if high > low { 0.04 * (high - low) } else { 0.1 * low.abs().max(1e-12) };
    [low - room, high + room]
}

/// Draws of about the same weight, with the diameter of their marks; of more than [`MOST_DRAWS`] an
/// even selection.
fn by_weight(weights: &[f64]) -> Vec<(f64, Vec<usize>)> {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let every = weights.len().div_ceil(MOST_DRAWS).max(1);
    let mut groups: Vec<(f64, Vec<usize>)> = (1..=SIZES)
        .map(|size| (LARGEST * (size as f64 / SIZES as f64).sqrt(), Vec::new()))
        .collect();
    for draw in (0..weights.len()).step_by(every) {
        let size = (weights[draw] / largest * SIZES as f64).ceil() as usize;
        groups[size.clamp(1, SIZES) - 1].1.push(draw);
    }
    groups.retain(|group| !group.1.is_empty());
    groups
}

fn scatter(panel: Panel, x: &[f64], y: &[f64], groups: &[(f64, Vec<usize>)]) -> Panel {
    groups.iter().fold(panel, |panel, (size, draws)| {
        let take = |values: &[f64]| draws.iter().map(|&draw| values[draw]).collect::<Vec<f64>>();
        let series = Series::points("", take(x), take(y)).color(Color::BLUE.lighten(0.35));
        panel.series(series.marker_size(*size).filled(true).width(0.1))
    })
}

/// The share of the weight in each bin, as an area.
fn histogram(across: Axis, values: &[f64], weights: &[f64], [low, high]: [f64; 2]) -> Panel {
    let shares = shares(values, weights, [low, high]);
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (bin, share) in shares.iter().enumerate() {
        for end in [bin, bin + 1] {
            x.push(low + (high - low) * end as f64 / BINS as f64);
            y.push(*share);
        }
    }
    let top = shares.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let up = Axis::linear("", "").range(0.0, 1.1 * top).ticks(std::iter::empty::<(f64, String)>());
    Panel::new(across, up)
        .series(Series::band("", &x, vec![0.0; x.len()], &y).color(Color::BLUE))
        .series(Series::line("", &x, &y).color(Color::BLUE).width(0.8))
}

/// The weight of each bin between two values.
fn shares(values: &[f64], weights: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let mut shares = vec![0.0; BINS];
    for (value, weight) in values.iter().zip(weights) {
        let place = (value - low) / (high - low) * BINS as f64;
        // The highest value itself belongs to the last bin.
        shares[(place.max(0.0) as usize).min(BINS - 1)] += weight;
    }
    shares
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

    #[test]
    fn bins_hold_all_the_weight() {
        let shares = shares(&[0.0, 0.5, 1.0], &[0.25, 0.25, 0.5], [0.0, 1.0]);
        assert_eq!((shares[0], shares[BINS / 2], shares[BINS - 1]), (0.25, 0.25, 0.5));
    }

    #[test]
    fn heavier_draws_have_larger_marks_and_many_are_decimated() {
        let groups = by_weight(&[0.1, 1.0, 0.1]);
        assert_eq!(groups.len(), 2);
        assert_eq!((&groups[0].1[..], &groups[1].1[..]), (&[0, 2][..], &[1][..]));
        assert!(groups[0].0 < groups[1].0);
        let drawn: usize = by_weight(&vec![1.0; 5000]).iter().map(|group| group.1.len()).sum();
        assert!(drawn <= MOST_DRAWS, "{drawn}");
    }
}
