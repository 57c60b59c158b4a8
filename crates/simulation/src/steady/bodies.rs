//! Bodies between contacts in steady responses: with their inertia, or condensed.

use std::sync::Arc;

use asperity_harmonic::{
    Branch, CondensedStack, ContactSystem, Continuation, HarmonicError, HarmonicSettings,
    LawEvaluation, PeriodicResponse, PressureRange, Termination, trace_with_progress,
};
use asperity_mesh::{Body, Port};
use serde::Serialize;

use crate::assemble::Assembly;
use crate::error::SimulationError;

/// Frequency of a body on its contacts, over the highest of the band, from which it may be condensed.
const FAR_ABOVE: f64 = 10.0;

/// Largest share of all condensed bodies in the kinetic energy of a mode: their inertia then changes
/// frequencies and peaks by half a per cent at most.
const SMALL_SHARE: f64 = 0.01;

/// Modes up to this multiple of the highest frequency of the band count, for the harmonics.
const HARMONICS: f64 = 3.0;

/// Treatment of light bodies between contacts. A body is light if its frequency on its contacts is ten times
/// the highest of the band or more, and if its share, together with lighter ones, in the kinetic energy of
/// the modes up to three times the band is at most 1 %.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BodyModel {
    /// Elastic, and condensed where contact is lost on a branch.
    #[default]
    Auto,
    /// Elastic bodies with their inertia always.
    Elastic,
    /// Condensed always.
    Condensed,
}

/// A body without inertia in a branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CondensedBody {
    /// Name of the body.
    pub name: String,
    /// Frequency of the rigid body on its contacts at rest \[Hz\].
    pub frequency_hz: f64,
    /// Largest share of the body in the kinetic energy of a mode up to three times the band
    /// ([`CondensedStack::inertia_shares`]).
    pub inertia_share: f64,
}

/// Reason for which bodies are condensed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum CondensationReason {
    /// Contact is lost on the branch with their inertia.
    ContactLost {
        /// Frequency of the first response that loses it \[Hz\].
        from_hz: f64,
    },
    /// It was asked for.
    Requested,
}

/// The light bodies without inertia on a branch, and the reason.
#[derive(Debug, Clone)]
pub struct Condensation {
    /// The bodies.
    pub light: Arc<LightBodies>,
    /// The reason.
    pub reason: CondensationReason,
}

/// A stack with its light bodies condensed.
#[derive(Debug, Clone)]
pub struct LightBodies {
    stack: CondensedStack,
    bodies: Vec<CondensedBody>,
}

impl LightBodies {
    /// The light bodies of a structure below the band that ends at `highest` \[Hz\]; none without any.
    pub(super) fn of(
        assembly: &Assembly,
        highest: f64,
        model: BodyModel,
        evaluation: LawEvaluation,
    ) -> Result<Option<Self>, SimulationError> {
        let structure = &assembly.structure;
        // A body that is loaded or read keeps its inertia.
        let ports: Vec<Port> =
            [assembly.load.port()].into_iter().chain(assembly.sensor_ports()).collect();
        let has_port = |body: usize| {
            ports.iter().any(|port| matches!(port, Port::Point { body: own, .. } if *own == body))
        };
        let mut candidates = CondensedStack::candidates(structure);
        candidates.retain(|&body| !has_port(body));
        if model == BodyModel::Elastic || (model == BodyModel::Auto && candidates.is_empty()) {
            return Ok(None);
        }
        let shares = inertia_shares(assembly, HARMONICS * highest)?;
        let body = |&body: &usize| CondensedBody {
            name: structure.stack().bodies()[body].name().to_owned(),
            frequency_hz: CondensedStack::body_frequency(structure, body),
            inertia_share: shares[body],
        };
        candidates.sort_by(|&a, &b| shares[a].total_cmp(&shares[b]));
        let mut sum = 0.0;
        let mut light = candidates.clone();
        light.retain(|own| {
            let found = body(own);
            let is_light = found.frequency_hz >= FAR_ABOVE * highest
                && sum + found.inertia_share <= SMALL_SHARE;
            sum += if is_light { found.inertia_share } else { 0.0 };
            is_light
        });
        light.sort_unstable();
        if light.is_empty() {
            let all: Vec<CondensedBody> = candidates.iter().map(body).collect();
            return match model {
                BodyModel::Condensed => Err(nothing_to_condense(&all, highest)),
                BodyModel::Auto | BodyModel::Elastic => Ok(None),
            };
        }
        let stack = CondensedStack::new(structure, &light, evaluation)?
            .with_ports(ports[0], &ports[1..])?;
        Ok(Some(Self { stack, bodies: light.iter().map(body).collect() }))
    }

    /// The bodies, from the top.
    pub fn bodies(&self) -> &[CondensedBody] {
        &self.bodies
    }

    /// Extremes of the pressure at each interface of the scenario over a response without their inertia.
    pub fn pressures(&self, response: &PeriodicResponse) -> Vec<PressureRange> {
        self.stack.pressures(response)
    }
}

/// Shares of the bodies in the kinetic energy; under a moving base at least in the mass, which drives it.
fn inertia_shares(assembly: &Assembly, highest: f64) -> Result<Vec<f64>, SimulationError> {
    let mut shares = CondensedStack::inertia_shares(&assembly.structure, highest)?;
    if assembly.load.base().is_some() {
        let bodies = assembly.structure.stack().bodies();
        let mass: f64 = bodies.iter().map(Body::mass).sum();
        for (share, body) in shares.iter_mut().zip(bodies) {
            *share = share.max(body.mass() / mass);
        }
    }
    Ok(shares)
}

fn nothing_to_condense(found: &[CondensedBody], highest: f64) -> SimulationError {
    let words = |body: &CondensedBody| {
        let CondensedBody { name, frequency_hz, inertia_share } = body;
        format!("{name} at {frequency_hz:.1} Hz with {:.2} %", 100.0 * inertia_share)
    };
    let all: Vec<String> = found.iter().map(words).collect();
    let found = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
    let (least_hz, most_share) = (FAR_ABOVE * highest, SMALL_SHARE);
    SimulationError::NothingToCondense { found, least_hz, most_share }
}

/// The system of a branch: with all bodies, or with the light ones condensed.
pub(super) struct BodyChoice<'a> {
    pub(super) elastic: &'a ContactSystem,
    pub(super) light: Option<&'a Arc<LightBodies>>,
    pub(super) model: BodyModel,
    /// Called after each point.
    pub(super) progress: &'a (dyn Fn() + Sync),
}

impl BodyChoice<'_> {
    /// The branch, and the reason for which it is one with condensed bodies, if it is.
    pub(super) fn trace(
        &self,
        continuation: &Continuation,
        settings: &HarmonicSettings,
    ) -> (Result<Branch, HarmonicError>, Option<Condensation>) {
        let trace = |system: &ContactSystem, settings: &HarmonicSettings| {
            trace_with_progress(system, continuation, settings, self.progress)
        };
        let Some(light) = self.light else {
            return (trace(self.elastic, settings), None);
        };
        let mut reason = CondensationReason::Requested;
        if self.model == BodyModel::Auto {
            let until_lost = HarmonicSettings { until_contact_lost: true, ..*settings };
            let elastic = trace(self.elastic, &until_lost);
            let lost = elastic
                .as_ref()
                .ok()
                .filter(|branch| branch.termination == Termination::ContactLost);
            let Some(last) = lost.and_then(|branch| branch.points.last()) else {
                return (elastic, None);
            };
            reason = CondensationReason::ContactLost { from_hz: last.frequency_hz() };
        }
        let condensation = Condensation { light: Arc::clone(light), reason };
        (trace(light.stack.system(), settings), Some(condensation))
    }
}
