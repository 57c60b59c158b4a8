//! Steady responses as CSV.

use asperity_harmonic::Branch;
use asperity_table::CsvWriter;

use super::{Backbones, Steady, TimeSweep};

/// A harmonic is a column if it exceeds this share of the fundamental at some point.
const MATTERS: f64 = 1e-4;

/// `steady.csv`: a row per point of every branch, in the order of the request, with harmonics up to the
/// highest that matters.
pub fn steady_csv(steady: &Steady, interfaces: &[&str]) -> String {
    let branches: Vec<&Branch> =
        steady.levels.iter().filter_map(|level| level.outcome.as_ref().ok()).collect();
    let harmonics = harmonics_that_matter(&branches);
    let mut names: Vec<String> =
        ["branch", "point", "force_n", "frequency_hz"].map(str::to_owned).into();
    names.extend((1..=harmonics).map(|k| format!("amplitude_{k}_m")));
    names.push("phase_1_rad".to_owned());
    for name in interfaces {
        names.extend([format!("{name}:pressure_min_pa"), format!("{name}:pressure_max_pa")]);
    }
    names.extend(["stable", "contact_lost"].map(str::to_owned));
    let mut csv = CsvWriter::with_header(names);
    for (index, level) in steady.levels.iter().enumerate() {
        let points = level.outcome.as_ref().map_or(&[][..], |branch| &branch.points);
        for (number, point) in points.iter().enumerate() {
            csv.numbers([(index + 1) as f64, (number + 1) as f64]);
            csv.numbers([point.force, point.frequency_hz()]);
            csv.numbers(
                (1..=harmonics).map(|k| (k <= point.harmonics()).then(|| point.amplitude(k))),
            );
            csv.number(point.phase());
            for range in level.pressures(point) {
                csv.numbers([range.lowest, range.highest]);
            }
            csv.text(point.stable().map_or("", truth)).text(truth(point.contact_lost())).end_row();
        }
    }
    csv.into_string()
}

/// The highest harmonic that matters at any point; two at least, as far as they were computed.
fn harmonics_that_matter(branches: &[&Branch]) -> usize {
    let computed = branches.iter().map(|branch| branch.harmonics).max().unwrap_or(1);
    let points = || branches.iter().flat_map(|branch| &branch.points);
    let matters =
        |k: usize| points().any(|point| point.amplitude(k) > MATTERS * point.amplitude(1));
    (1..=computed).rev().find(|&k| matters(k)).unwrap_or(1).max(computed.min(2))
}

fn truth(value: bool) -> &'static str {
    if value { "true" } else { "false" }
}

/// `steady_time.csv`: a row per frequency of every stepped sine by time integration, in its order.
pub fn steady_time_csv(sweeps: &[TimeSweep]) -> String {
    let mut csv = CsvWriter::with_header([
        "force_n",
        "direction",
        "frequency_hz",
        "amplitude_1_m",
        "amplitude_2_m",
        "phase_1_rad",
        "periods",
        "change",
        "settled",
    ]);
    for sweep in sweeps {
        for point in sweep.outcome.as_ref().map_or(&[][..], |points| points) {
            csv.number(sweep.force_n).text(sweep.direction()).number(point.frequency_hz);
            csv.numbers([point.amplitude_1_m, point.amplitude_2_m, point.phase_1_rad]);
            csv.numbers([point.periods as f64, point.change]);
            csv.text(truth(point.settled)).end_row();
        }
    }
    csv.into_string()
}

/// `backbone.csv`: a row per point of both backbones. Modes have a damping ratio, phase resonances
/// a force.
pub fn backbone_csv(backbones: &Backbones) -> String {
    let mut csv = CsvWriter::with_header([
        "backbone",
        "point",
        "force_n",
        "frequency_hz",
        "amplitude_1_m",
        "harmonic_ratio",
        "damping_ratio",
        "modal_amplitude_m_sqrt_kg",
        "contact_lost",
    ]);
    let named = [("phase_resonance", &backbones.phase_resonance), ("mode", &backbones.mode)];
    for (name, outcome) in named {
        let points = outcome.as_ref().map_or(&[][..], |branch| &branch.points);
        for (number, point) in points.iter().enumerate() {
            let is_mode = name == "mode";
            csv.text(name).number((number + 1) as f64);
            csv.number((!is_mode).then_some(point.force));
            csv.numbers([point.frequency_hz(), point.amplitude(1), point.harmonic_ratio()]);
            csv.number(is_mode.then(|| point.damping_ratio())).number(point.modal_amplitude());
            csv.text(truth(point.contact_lost())).end_row();
        }
    }
    csv.into_string()
}
