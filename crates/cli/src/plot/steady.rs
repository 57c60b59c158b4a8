//! Steady responses over frequency: stable parts solid, unstable dashed.

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Panel, Series};
use asperity_harmonic::{Branch, PeriodicResponse};
use asperity_study::steady::Steady;

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
    let frequency = || Axis::linear("Frequency", "Hz");
    let mut amplitude = all(
        Panel::new(frequency(), Axis::linear("Amplitude A_{1}", "µm").scale(1e6)),
        &branches,
        |point| point.amplitude(1),
    );
    if let Some(backbones) = &found.backbones {
        let lines = [
            ("phase resonance", &backbones.phase_resonance, Dash::DashDot),
            ("damped mode", &backbones.mode, Dash::Dotted),
        ];
        for (name, outcome, dash) in lines {
            if let Ok(branch) = outcome {
                let (x, y) = columns(&branch.points, |point| point.amplitude(1));
                amplitude =
                    amplitude.series(Series::line(name, x, y).color(Color::BLACK).dash(dash));
            }
        }
    }
    let ratio = all(
        Panel::new(frequency(), Axis::linear("Ratio A_{2}/A_{1}", "")).legend(Legend::None),
        &branches,
        PeriodicResponse::harmonic_ratio,
    );
    let pressure = all(
        Panel::new(frequency(), Axis::linear("Lowest pressure", "MPa").scale(1e-6))
            .legend(Legend::None),
        &branches,
        |point| point.pressures.iter().map(|range| range.lowest).fold(f64::INFINITY, f64::min),
    );
    let figure = Figure::new("Steady responses").panel(amplitude).panel(ratio).panel(pressure);
    Some(figure.columns(1).width_mm(120.0))
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
