//! `summary.json` of steady responses, under the names of the contract.

use asperity_harmonic::{Branch, HarmonicError, PeriodicResponse, SpecialPointKind, Termination};
use serde_json::{Value, json};

use super::{Steady, SteadyLevel};
use crate::static_state::StaticSummary;
use crate::summary::Provenance;

/// Identifier of the summary's format.
pub const STEADY_SCHEMA: &str = "asperity/steady/1";

impl Steady {
    /// `summary.json`, for a scenario with this title and state at rest.
    pub fn summary(
        &self,
        title: Option<&str>,
        at_rest: &StaticSummary,
        provenance: &Provenance,
    ) -> Value {
        let backbones = self.backbones.as_ref().map(|found| {
            json!({
                "phase_resonance": backbone(&found.phase_resonance),
                "mode": backbone(&found.mode),
            })
        });
        json!({
            "schema": STEADY_SCHEMA,
            "title": title,
            "static": at_rest,
            "levels": self.levels.iter().map(level).collect::<Vec<_>>(),
            "backbone": backbones,
            "wall_s": self.wall_s,
            "provenance": provenance,
        })
    }
}

fn level(level: &SteadyLevel) -> Value {
    let branch = match &level.outcome {
        Ok(branch) => branch,
        Err(error) => return json!({"force_n": level.force_n, "error": error.to_string()}),
    };
    let peak = branch.highest();
    let bifurcations = branch.special.iter().filter(|special| special.kind.is_bifurcation());
    let bifurcations = bifurcations.map(|special| {
        json!({
            "kind": special.kind.name(),
            "frequency_hz": special.response.frequency_hz(),
            "amplitude_1_m": special.response.amplitude(1),
        })
    });
    json!({
        "force_n": level.force_n,
        "peak_frequency_hz": peak.map(PeriodicResponse::frequency_hz),
        "peak_amplitude_1_m": peak.map(|peak| peak.amplitude(1)),
        "harmonic_ratio": peak.map(PeriodicResponse::harmonic_ratio),
        // False for a peak at the end of the frequencies.
        "peak_is_inside": branch.of_kind(SpecialPointKind::Peak).next().is_some(),
        "points": branch.points.len(),
        "harmonics": branch.harmonics,
        "truncation": branch.truncation(),
        "end": end(&branch.termination),
        "contact_lost": branch.points.iter().any(PeriodicResponse::contact_lost),
        "bifurcations": bifurcations.collect::<Vec<_>>(),
        "verify": level.check,
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

fn end(termination: &Termination) -> Value {
    match termination {
        Termination::Reached => json!("reached"),
        Termination::Returned => json!("returned"),
        Termination::NotConverged => json!("not_converged"),
        Termination::PointLimit => json!("point_limit"),
        Termination::BeyondLaw { interface, closure } => {
            json!({"beyond_law": {"interface": interface, "closure_m": closure}})
        }
    }
}
