//! Steady responses over frequency: stable parts solid, unstable dashed.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_harmonic::{Branch, PeriodicResponse};
use asperity_study::steady::Steady;

use super::figure;

/// Most force amplitudes in the legend.
const MOST_NAMED: usize = 8;

type Observable = fn(&PeriodicResponse) -> f64;

/// Amplitude with backbones, harmonic ratio, and lowest pressure over frequency; none without a
/// branch.
pub(crate) fn steady(found: &Steady) -> Option<Figure> {
    let branches: Vec<(f64, &Branch)> = found
        .levels
        .iter()
        .filter_map(|level| Some((level.force_n, level.outcome.as_ref().ok()?)))
        .collect();
    if branches.is_empty() {
        return None;
    }
    let panel = |axis: Axis, observable: Observable| {
        all(Panel::new(Axis::linear("Frequency", "Hz"), axis), &branches, observable)
    };
    let amplitude = Axis::linear("Amplitude A_{1}", "µm").scale(1e6);
    let mut amplitude = panel(amplitude, |point| point.amplitude(1));
    if let Some(backbones) = &found.backbones {
        let lines = [
            ("phase resonance", &backbones.phase_resonance, Dash::DashDot),
            ("damped mode", &backbones.mode, Dash::Dotted),
        ];
        for (name, outcome, dash) in lines {
            if let Ok(branch) = outcome {
                let (x, y) = columns(&branch.points, |point| point.amplitude(1));
                let line = Series::line(name, x, y).color(Color::BLACK);
                amplitude = amplitude.series(line.dash(dash));
            }
        }
    }
    let ratio = panel(Axis::linear("Ratio A_{2}/A_{1}", ""), PeriodicResponse::harmonic_ratio);
    let pressure = panel(Axis::linear("Lowest pressure", "MPa").scale(1e-6), |point| {
        point.pressures.iter().map(|range| range.lowest).fold(f64::INFINITY, f64::min)
    });
    let panels = [amplitude, ratio.legend(Legend::None), pressure.legend(Legend::None)];
    figure("Steady responses", 1, 120.0, panels)
}

fn all(mut panel: Panel, branches: &[(f64, &Branch)], observable: Observable) -> Panel {
    for (index, (force, branch)) in branches.iter().enumerate() {
        let color = Color::ramp_step(index, branches.len());
        let mut name = if index < MOST_NAMED { format!("{force} N") } else { String::new() };
        for (stable, points) in parts(&branch.points) {
            let (x, y) = columns(points, observable);
            let dash = if stable { Dash::Solid } else { Dash::Dashed };
            panel =
                panel.series(Series::line(std::mem::take(&mut name), x, y).color(color).dash(dash));
        }
    }
    panel
}

/// Consecutive points of equal stability; each part ends with the first point of the next, so that
/// the line is not broken.
fn parts(points: &[PeriodicResponse]) -> Vec<(bool, &[PeriodicResponse])> {
    let stable = |point: &PeriodicResponse| point.stable() != Some(false);
    let mut parts = Vec::new();
    let mut start = 0;
    for end in 1..=points.len() {
        if end == points.len() || stable(&points[end]) != stable(&points[start]) {
            parts.push((stable(&points[start]), &points[start..(end + 1).min(points.len())]));
            start = end;
        }
    }
    parts
}

fn columns(points: &[PeriodicResponse], observable: Observable) -> (Vec<f64>, Vec<f64>) {
    points.iter().map(|point| (point.frequency_hz(), observable(point))).unzip()
}
