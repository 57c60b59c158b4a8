//! Steady responses as CSV and as a summary.

use asperity_harmonic::{Branch, HarmonicError, PeriodicResponse, SpecialPointKind, Termination};
use serde_json::{Value, json};

use super::{Backbones, Steady, SteadyLevel};
use asperity_table::CsvWriter;

/// `steady.csv`: a row per point of every branch, in the order of the request.
pub fn steady_csv(steady: &Steady, interfaces: &[&str]) -> String {
    let branches: Vec<&Branch> =
        steady.levels.iter().filter_map(|level| level.outcome.as_ref().ok()).collect();
    let harmonics = branches.iter().map(|branch| branch.harmonics).max().unwrap_or(1);
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
            for range in &point.pressures {
                csv.numbers([range.lowest, range.highest]);
            }
            csv.text(point.stable().map_or("", truth)).text(truth(point.contact_lost())).end_row();
        }
    }
    csv.into_string()
}

fn truth(value: bool) -> &'static str {
    if value { "true" } else { "false" }
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

/// The levels and backbones as they stand in `summary.json`.
pub fn steady_summary(steady: &Steady) -> Value {
    json!({
        "levels": steady.levels.iter().map(level).collect::<Vec<_>>(),
        "backbone": steady.backbones.as_ref().map(|backbones| json!({
            "phase_resonance": backbone(&backbones.phase_resonance),
            "mode": backbone(&backbones.mode),
        })),
        "wall_s": steady.wall_s,
    })
}

fn level(level: &SteadyLevel) -> Value {
    let branch = match &level.outcome {
        Ok(branch) => branch,
        Err(error) => return json!({"force_n": level.force_n, "error": error.to_string()}),
    };
    let peak = branch.highest();
    let check = level.check.map(|check| {
        json!({
            "frequency_hz": check.frequency_hz,
            "amplitude_1_m": check.amplitude_1_m,
            "integrated_1_m": check.integrated_1_m,
            "relative_difference": check.relative_difference(),
        })
    });
    json!({
        "force_n": level.force_n,
        "peak_frequency_hz": peak.map(PeriodicResponse::frequency_hz),
        "peak_amplitude_1_m": peak.map(|peak| peak.amplitude(1)),
        "harmonic_ratio": peak.map(PeriodicResponse::harmonic_ratio),
        "peak_is_inside": branch.of_kind(SpecialPointKind::Peak).next().is_some(),
        "points": branch.points.len(),
        "harmonics": branch.harmonics,
        "truncation": branch.truncation(),
        "end": end(&branch.termination),
        "contact_lost": branch.points.iter().any(PeriodicResponse::contact_lost),
        "bifurcations": branch.special.iter()
            .filter(|special| special.kind.is_bifurcation())
            .map(|special| json!({
                "kind": kind(special.kind),
                "frequency_hz": special.response.frequency_hz(),
                "amplitude_1_m": special.response.amplitude(1),
            }))
            .collect::<Vec<_>>(),
        "verify": check,
        "wall_s": level.wall_s,
    })
}

fn backbone(outcome: &Result<Branch, HarmonicError>) -> Value {
    match outcome {
        Ok(branch) => json!({
            "points": branch.points.len(),
            "end": end(&branch.termination),
            "last_frequency_hz": branch.points.last().map(PeriodicResponse::frequency_hz),
            "last_amplitude_1_m": branch.points.last().map(|point| point.amplitude(1)),
        }),
        Err(error) => json!({"error": error.to_string()}),
    }
}

fn kind(kind: SpecialPointKind) -> &'static str {
    match kind {
        SpecialPointKind::Fold => "fold",
        SpecialPointKind::Peak => "peak",
        SpecialPointKind::PeriodDoubling => "period_doubling",
        SpecialPointKind::NeimarkSacker => "neimark_sacker",
        SpecialPointKind::BranchPoint => "branch_point",
    }
}

fn end(end: &Termination) -> Value {
    match end {
        Termination::Reached => json!("reached"),
        Termination::Returned => json!("returned"),
        Termination::NotConverged => json!("not_converged"),
        Termination::PointLimit => json!("point_limit"),
        Termination::BeyondLaw { interface, closure } => {
            json!({"beyond_law": {"interface": interface, "closure_m": closure}})
        }
    }
}
