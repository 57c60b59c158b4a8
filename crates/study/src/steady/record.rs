//! Steady responses as CSV and as a summary. Writing to a string cannot fail.

use std::fmt::Write as _;

use asperity_harmonic::{Branch, BranchEnd, HarmonicError, Response, Special};
use serde_json::{Value, json};

use super::{Backbones, Steady, SteadyLevel};
use asperity_table::{push_number, quoted};

/// `steady.csv`: a row per point of every branch, in the order of the request.
pub fn steady_csv(steady: &Steady, interfaces: &[&str]) -> String {
    let branches: Vec<&Branch> =
        steady.levels.iter().filter_map(|level| level.outcome.as_ref().ok()).collect();
    let harmonics = branches.iter().map(|branch| branch.harmonics).max().unwrap_or(1);
    let mut text = String::from("branch,point,force_n,frequency_hz");
    for k in 1..=harmonics {
        let _ = write!(text, ",amplitude_{k}_m");
    }
    text.push_str(",phase_1_rad");
    for name in interfaces {
        for what in ["pressure_min_pa", "pressure_max_pa"] {
            text.push(',');
            text.push_str(&quoted(&format!("{name}:{what}")));
        }
    }
    text.push_str(",stable,contact_lost\n");
    for (index, level) in steady.levels.iter().enumerate() {
        let points = level.outcome.as_ref().map_or(&[][..], |branch| &branch.points);
        for (number, point) in points.iter().enumerate() {
            let _ = write!(text, "{},{}", index + 1, number + 1);
            push(&mut text, &[point.force, point.frequency_hz()]);
            for k in 1..=harmonics {
                let kept = k <= point.harmonics();
                push(&mut text, &[if kept { point.amplitude(k) } else { f64::NAN }]);
            }
            push(&mut text, &[point.phase()]);
            for range in &point.pressures {
                push(&mut text, &[range.lowest, range.highest]);
            }
            let stable = point.stable().map_or("", |stable| if stable { "true" } else { "false" });
            let _ = writeln!(text, ",{stable},{}", point.contact_lost());
        }
    }
    text
}

/// `backbone.csv`: a row per point of both backbones. Modes have a damping ratio, phase resonances
/// a force.
pub fn backbone_csv(backbones: &Backbones) -> String {
    let mut text = String::from(
        "backbone,point,force_n,frequency_hz,amplitude_1_m,harmonic_ratio,damping_ratio,\
         modal_amplitude_m_sqrt_kg,contact_lost\n",
    );
    let named = [("phase_resonance", &backbones.phase_resonance), ("mode", &backbones.mode)];
    for (name, outcome) in named {
        let points = outcome.as_ref().map_or(&[][..], |branch| &branch.points);
        for (number, point) in points.iter().enumerate() {
            let is_mode = name == "mode";
            let only = |given: bool, value: f64| if given { value } else { f64::NAN };
            let _ = write!(text, "{name},{}", number + 1);
            push(
                &mut text,
                &[
                    only(!is_mode, point.force),
                    point.frequency_hz(),
                    point.amplitude(1),
                    point.harmonic_ratio(),
                    only(is_mode, point.damping_ratio()),
                    point.modal_amplitude(),
                ],
            );
            let _ = writeln!(text, ",{}", point.contact_lost());
        }
    }
    text
}

fn push(text: &mut String, values: &[f64]) {
    for value in values {
        text.push(',');
        push_number(text, *value);
    }
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
        "peak_frequency_hz": peak.map(Response::frequency_hz),
        "peak_amplitude_1_m": peak.map(|peak| peak.amplitude(1)),
        "harmonic_ratio": peak.map(Response::harmonic_ratio),
        "peak_is_inside": branch.of_kind(Special::Peak).next().is_some(),
        "points": branch.points.len(),
        "harmonics": branch.harmonics,
        "truncation": branch.truncation(),
        "end": end(&branch.end),
        "contact_lost": branch.points.iter().any(Response::contact_lost),
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
            "end": end(&branch.end),
            "last_frequency_hz": branch.points.last().map(Response::frequency_hz),
            "last_amplitude_1_m": branch.points.last().map(|point| point.amplitude(1)),
        }),
        Err(error) => json!({"error": error.to_string()}),
    }
}

fn kind(kind: Special) -> &'static str {
    match kind {
        Special::Fold => "fold",
        Special::Peak => "peak",
        Special::PeriodDoubling => "period_doubling",
        Special::NeimarkSacker => "neimark_sacker",
        Special::BranchPoint => "branch_point",
    }
}

fn end(end: &BranchEnd) -> Value {
    match end {
        BranchEnd::Reached => json!("reached"),
        BranchEnd::Returned => json!("returned"),
        BranchEnd::NotConverged => json!("not_converged"),
        BranchEnd::PointLimit => json!("point_limit"),
        BranchEnd::BeyondLaw { interface, closure } => {
            json!({"beyond_law": {"interface": interface, "closure_m": closure}})
        }
    }
}
