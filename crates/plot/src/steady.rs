//! Steady responses over frequency: stable parts solid, unstable dashed, parts whose harmonics do not suffice dotted.

mod report;

use asperity_figure::{Axis, Color, Dash, Figure, Legend, Marker, Panel, Series};
use asperity_harmonic::{Branch, PeriodicResponse, SpecialPointKind};
use asperity_simulation::steady::{Steady, SteadyLevel, TimeSweepPoint};

pub use report::steady_report;

use super::figure;

/// Most force amplitudes in the legend.
const MOST_NAMED: usize = 8;

type Observable = fn(&SteadyLevel, &PeriodicResponse) -> f64;

/// Amplitude with backbones, displacement ratio, and lowest pressure over one range of frequencies, with
/// the special points of each branch; none without a branch.
pub fn steady(found: &Steady) -> Option<Figure> {
    let branches: Vec<(&SteadyLevel, &Branch)> =
        found.parts().filter_map(|level| Some((level, level.outcome.as_ref().ok()?))).collect();
    if branches.is_empty() {
        return None;
    }
    let backbones: Vec<(&str, &Branch, Dash, f64)> = found
        .backbones
        .iter()
        .flat_map(|found| {
            [
                ("damped mode", &found.mode, Dash::Solid, 2.0),
                ("phase resonance", &found.phase_resonance, Dash::DashDot, 0.8),
            ]
        })
        .filter_map(|(name, outcome, dash, width)| {
            Some((name, outcome.as_ref().ok()?, dash, width))
        })
        .collect();
    let drawn = branches.iter().map(|(_, branch)| *branch);
    let drawn = drawn.chain(backbones.iter().map(|(_, branch, ..)| *branch));
    let (low, high) = drawn
        .flat_map(|branch| &branch.points)
        .map(PeriodicResponse::frequency_hz)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), hz| (low.min(hz), high.max(hz)));
    let panel = |axis: Axis, observable: Observable| {
        let frequency = Axis::linear("Frequency", "Hz").range(low, high);
        all(Panel::new(frequency, axis), &branches, found.unit(), observable)
    };
    let amplitude = Axis::linear("Amplitude u_{1}", "µm").scale(1e6);
    let mut amplitude = panel(amplitude, |_, point| point.at_sensor(0, 1).norm());
    for (mut name, marker, rising) in SWEEPS {
        for sweep in found.time_sweeps.iter().filter(|sweep| sweep.rising == rising) {
            let points = sweep.outcome.as_ref().map_or(&[][..], |points| points);
            let (x, y) = some(points, usize::from(rising));
            let level = branches.iter().position(|(level, _)| level.force_n == sweep.force_n);
            let color = level.map_or(Color::BLACK, |_| color(&branches, sweep.force_n));
            let series = Series::points(std::mem::take(&mut name), x, y).color(color);
            let series = series.marker(marker).filled(true).marker_size(2.8);
            amplitude = amplitude.series_if_visible(series);
        }
    }
    for (name, branch, dash, width) in backbones {
        let amplitude_1 = |point: &PeriodicResponse| point.at_sensor(0, 1).norm();
        let (x, y) = columns(&branch.points, amplitude_1);
        // Both coincide but for small differences: the wider one is paler.
        let color = if width > 1.0 { Color::GREY.lighten(0.5) } else { Color::BLACK };
        let line = Series::line(name, x, y).color(color).dash(dash);
        amplitude = amplitude.series(line.width(width));
    }
    let ratio = panel(Axis::linear("Ratio u_{2}/u_{1}", ""), |_, point| {
        (point.at_sensor(0, 2) / point.at_sensor(0, 1)).norm()
    });
    let pressure = panel(Axis::linear("Lowest pressure", "MPa").scale(1e-6), |level, point| {
        level.pressures(point).iter().map(|range| range.lowest).fold(f64::INFINITY, f64::min)
    });
    let panels = [amplitude, ratio.legend(Legend::None), pressure.legend(Legend::None)];
    figure("Steady responses", 1, 120.0, panels)
}

fn all(
    mut panel: Panel,
    branches: &[(&SteadyLevel, &Branch)],
    unit: &str,
    observable: Observable,
) -> Panel {
    for (index, (level, branch)) in branches.iter().enumerate() {
        let color = color(branches, level.force_n);
        let is_other_part = branches[..index].iter().any(|(one, _)| one.force_n == level.force_n);
        let mut name = if index < MOST_NAMED && !is_other_part {
            format!("{} {unit}", level.force_n)
        } else {
            String::new()
        };
        for (kind, points) in parts(&branch.points) {
            let (x, y) = columns(points, |point| observable(level, point));
            let line = Series::line(std::mem::take(&mut name), x, y).color(color);
            panel = panel.series(match kind {
                Part::Stable => line,
                Part::Unstable => line.dash(Dash::Dashed),
                Part::Unresolved => line.dash(Dash::Dotted),
            });
        }
    }
    for mark in MARKS {
        let at = branches.iter().flat_map(|(level, branch)| {
            let points = (mark.places)(branch).into_iter();
            points.map(move |point| (point.frequency_hz(), observable(level, point)))
        });
        let (x, y): (Vec<f64>, Vec<f64>) = at.unzip();
        if !x.is_empty() {
            let series = Series::points(mark.name, x, y).color(Color::BLACK).marker(mark.marker);
            panel = panel.series(series.filled(mark.filled).marker_size(4.5));
        }
    }
    panel
}

/// The colour of a force amplitude, that of all parts of its branch.
fn color(branches: &[(&SteadyLevel, &Branch)], force_n: f64) -> Color {
    let mut forces: Vec<f64> = Vec::new();
    for (level, _) in branches {
        if !forces.contains(&level.force_n) {
            forces.push(level.force_n);
        }
    }
    let at = forces.iter().position(|&force| force == force_n).unwrap_or(0);
    Color::ramp_step(at, forces.len())
}

/// Stepped sines by time integration: name, symbol, and whether the frequency rises. The colour is that
/// of the branch of the same force.
const SWEEPS: [(&str, Marker, bool); 2] = [
    ("time integration, up", Marker::Triangle, true),
    ("time integration, down", Marker::Plus, false),
];

/// Symbols of a stepped sine, beside those at its jumps: the branch stays visible between them.
const MOST_SYMBOLS: usize = 20;

/// Change of the amplitude from one frequency to the next that is a jump, over the largest amplitude.
const JUMP: f64 = 0.15;

/// Frequencies and amplitudes of some points of a stepped sine: of equal distance, shifted by the half of
/// it where `half` is 1, and at both sides of jumps.
fn some(points: &[TimeSweepPoint], half: usize) -> (Vec<f64>, Vec<f64>) {
    let every = points.len().div_ceil(MOST_SYMBOLS).max(1);
    let largest = points.iter().map(|point| point.amplitude_1_m).fold(0.0, f64::max);
    let jumps = |at: usize| {
        let pair = points.get(at).zip(points.get(at + 1));
        pair.is_some_and(|(a, b)| (b.amplitude_1_m - a.amplitude_1_m).abs() > JUMP * largest)
    };
    let is_shown = |at: &usize| {
        (at + half * every / 2).is_multiple_of(every) || jumps(*at) || (*at > 0 && jumps(at - 1))
    };
    let shown = (0..points.len()).filter(is_shown);
    shown.map(|at| (points[at].frequency_hz, points[at].amplitude_1_m)).unzip()
}

/// A symbol for points of a branch.
struct Mark {
    name: &'static str,
    marker: Marker,
    filled: bool,
    places: fn(&Branch) -> Vec<&PeriodicResponse>,
}

const MARKS: [Mark; 6] = [
    Mark {
        name: "fold",
        marker: Marker::Circle,
        filled: false,
        places: |branch| branch.of_kind(SpecialPointKind::Fold).collect(),
    },
    Mark {
        name: "period doubling",
        marker: Marker::Square,
        filled: false,
        places: |branch| branch.of_kind(SpecialPointKind::PeriodDoubling).collect(),
    },
    Mark {
        name: "Neimark-Sacker",
        marker: Marker::Diamond,
        filled: false,
        places: |branch| branch.of_kind(SpecialPointKind::NeimarkSacker).collect(),
    },
    Mark {
        name: "branch point",
        marker: Marker::Triangle,
        filled: false,
        places: |branch| branch.of_kind(SpecialPointKind::BranchPoint).collect(),
    },
    Mark { name: "contact lost", marker: Marker::Cross, filled: false, places: changes_of_contact },
    Mark {
        name: "end of the branch",
        marker: Marker::Square,
        filled: true,
        places: |branch| {
            branch.points.last().filter(|_| !branch.is_complete()).into_iter().collect()
        },
    },
];

/// The first and the last point of each part of a branch on which contact is lost.
fn changes_of_contact(branch: &Branch) -> Vec<&PeriodicResponse> {
    let pairs = branch.points.windows(2);
    let changes = pairs.filter(|pair| pair[0].contact_lost() != pair[1].contact_lost());
    changes.map(|pair| if pair[0].contact_lost() { &pair[0] } else { &pair[1] }).collect()
}

/// Parts of a branch that are drawn alike.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Stable,
    Unstable,
    /// Of responses whose harmonics do not suffice.
    Unresolved,
}

/// Consecutive points that are drawn alike; each part ends with the first point of the next, so that
/// the line is not broken.
fn parts(points: &[PeriodicResponse]) -> Vec<(Part, &[PeriodicResponse])> {
    let part = |point: &PeriodicResponse| match point.stable() {
        _ if !point.is_resolved() => Part::Unresolved,
        Some(false) => Part::Unstable,
        _ => Part::Stable,
    };
    let mut parts = Vec::new();
    let mut start = 0;
    for end in 1..=points.len() {
        if end == points.len() || part(&points[end]) != part(&points[start]) {
            parts.push((part(&points[start]), &points[start..(end + 1).min(points.len())]));
            start = end;
        }
    }
    parts
}

fn columns(
    points: &[PeriodicResponse],
    observable: impl Fn(&PeriodicResponse) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    points.iter().map(|point| (point.frequency_hz(), observable(point))).unzip()
}
