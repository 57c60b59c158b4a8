//! Bodies between contacts in steady responses: with their inertia, or condensed.

use std::sync::Arc;

use asperity_harmonic::{
    Branch, CondensedStack, ContactSystem, Continuation, HarmonicError, HarmonicSettings,
    LawEvaluation, PeriodicResponse, PressureRange, Termination, trace,
};
use asperity_mesh::Port;
use asperity_structure::PreloadedStructure;
use serde::Serialize;

use crate::assemble::Assembly;
use crate::error::SimulationError;

/// Frequency of a body on its contacts, over the highest of the band, from which it may be condensed:
/// its inertia then changes frequencies by about half a per cent at most.
const FAR_ABOVE: f64 = 10.0;

/// Treatment of light bodies between contacts, whose frequency on their contacts is ten times the
/// highest of the band or more.
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
        let frequency = |body: usize| CondensedStack::body_frequency(structure, body);
        let name = |body: usize| structure.stack().bodies()[body].name().to_owned();
        // A body that is loaded or read keeps its inertia.
        let ports: Vec<Port> =
            [assembly.load.port()].into_iter().chain(assembly.sensor_ports()).collect();
        let has_port = |body: usize| {
            ports.iter().any(|port| matches!(port, Port::Point { body: own, .. } if *own == body))
        };
        let mut candidates = CondensedStack::candidates(structure);
        candidates.retain(|&body| !has_port(body));
        let light: Vec<usize> = match model {
            BodyModel::Elastic => Vec::new(),
            BodyModel::Auto | BodyModel::Condensed => {
                let far = |body: &usize| frequency(*body) >= FAR_ABOVE * highest;
                candidates.iter().copied().filter(far).collect()
            }
        };
        if light.is_empty() {
            return match model {
                BodyModel::Condensed => Err(nothing_to_condense(structure, &candidates, highest)),
                BodyModel::Auto | BodyModel::Elastic => Ok(None),
            };
        }
        let stack = CondensedStack::new(structure, &light, evaluation)?
            .with_ports(ports[0], &ports[1..])?;
        let body =
            |&body: &usize| CondensedBody { name: name(body), frequency_hz: frequency(body) };
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

fn nothing_to_condense(
    structure: &PreloadedStructure,
    candidates: &[usize],
    highest: f64,
) -> SimulationError {
    let bodies = structure.stack().bodies();
    let all: Vec<String> = candidates
        .iter()
        .map(|&body| {
            let hz = CondensedStack::body_frequency(structure, body);
            format!("{} at {hz:.1} Hz", bodies[body].name())
        })
        .collect();
    let found = if all.is_empty() { "none".to_owned() } else { all.join(", ") };
    SimulationError::NothingToCondense { found, least_hz: FAR_ABOVE * highest }
}

/// The system of a branch: with all bodies, or with the light ones condensed.
pub(super) struct BodyChoice<'a> {
    pub(super) elastic: &'a ContactSystem,
    pub(super) light: Option<&'a Arc<LightBodies>>,
    pub(super) model: BodyModel,
}

impl BodyChoice<'_> {
    /// The branch, and the reason for which it is one with condensed bodies, if it is.
    pub(super) fn trace(
        &self,
        continuation: &Continuation,
        settings: &HarmonicSettings,
    ) -> (Result<Branch, HarmonicError>, Option<Condensation>) {
        let Some(light) = self.light else {
            return (trace(self.elastic, continuation, settings), None);
        };
        let mut reason = CondensationReason::Requested;
        if self.model == BodyModel::Auto {
            let until_lost = HarmonicSettings { until_contact_lost: true, ..*settings };
            let elastic = trace(self.elastic, continuation, &until_lost);
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
        (trace(light.stack.system(), continuation, settings), Some(condensation))
    }
}
