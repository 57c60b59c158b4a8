//! Hits on structures of matrices: each by itself, at steps that are held for all points.
//!
//! The reduction of a structure depends on no parameter, so that a point needs the equilibrium and the steps of time
//! alone. Many contacts have no exact derivatives: the fit takes differences of predictions.

use std::sync::atomic::AtomicBool;

use asperity_dynamics::DynamicsError;
use asperity_inference::{Derivatives, ForwardModel as _, Predictions};
use asperity_simulation::error::SimulationError;
use asperity_simulation::patches::{PatchResponse, PatchSystem};
use asperity_simulation::quantity::Quantity;
use rayon::prelude::*;

use crate::hit::{ConvergedHit, HitResolution, PreparedRig, SimulatedHit};
use crate::observed_quantity::{HitOutcome, PointOutcomes, backbone_of};
use crate::scenario_model::ScenarioModel;

/// Step of differences in working coordinates, and over the range of a parameter.
const DIFFERENCE: f64 = 1e-2;

/// Doublings at most of the steps between samples of a first response that does not keep the energy.
const MOST_DOUBLINGS: usize = 6;

impl ScenarioModel {
    /// Results of every hit at a point.
    pub(super) fn structure_outcomes(
        &self,
        point: &[f64],
    ) -> Result<PointOutcomes, SimulationError> {
        let rigs = self.prepare(point)?;
        let outcome = |hit: &SimulatedHit| {
            let system = self.on_rig(hit, &rigs[hit.rig], point)?;
            let parts = hit.parts(&system);
            Ok(structure_outcome(hit, &system, system.response(parts)?))
        };
        let hits = self.hits.par_iter().map(outcome).collect::<Result<_, SimulationError>>()?;
        let steady = self.steady(&rigs, point)?;
        Ok(PointOutcomes { hits, stiffness: self.stiffnesses(point)?, steady })
    }

    /// Every hit at `point` to the accuracy of its scenario.
    pub(super) fn converged_structure(
        &self,
        point: &[f64],
    ) -> Result<Vec<Result<ConvergedHit, SimulationError>>, SimulationError> {
        let rigs = self.prepare(point)?;
        let converged = |hit: &SimulatedHit| {
            let system = self.on_rig(hit, &rigs[hit.rig], point)?;
            let found = system.refined(&AtomicBool::new(false), &|_| ())?;
            let peak = system.assembly.load.peak();
            let resolution = Some(resolution(&system, found.parts));
            Ok(ConvergedHit { peak, resolution, observables: found.response.observables })
        };
        Ok(self.hits.par_iter().map(converged).collect())
    }

    /// Holds the first step of a refinement at the start of the parameters; one that does not keep the energy is
    /// halved.
    pub(super) fn hold_first_of_structure(&mut self) {
        let start = self.start();
        let Ok(rigs) = self.prepare(&start) else { return };
        let first = |hit: &SimulatedHit| {
            let system = self.on_rig(hit, &rigs[hit.rig], &start).ok()?;
            let mut parts = system.first_parts();
            for _ in 0..MOST_DOUBLINGS {
                match system.response(parts) {
                    Err(SimulationError::Dynamics(
                        DynamicsError::Coarse { .. } | DynamicsError::Unstable { .. },
                    )) => parts *= 2,
                    _ => break,
                }
            }
            Some(resolution(&system, parts))
        };
        let held: Vec<Option<HitResolution>> = self.hits.par_iter().map(first).collect();
        for (hit, held) in self.hits.iter_mut().zip(held) {
            hit.resolution = held;
        }
    }

    /// Predictions and their central differences at `point`.
    pub(super) fn differences(&self, point: &[f64]) -> Derivatives {
        let ends = self.parameters.list.iter().zip(point).map(|(parameter, &value)| {
            let bounds = parameter.bounds().map(|bound| parameter.to_working(bound));
            let x = parameter.to_working(value);
            let step = DIFFERENCE * (bounds[1] - bounds[0]).min(1.0);
            [x - step, x + step].map(|x| parameter.from_working(x.clamp(bounds[0], bounds[1])))
        });
        let ends: Vec<[f64; 2]> = ends.collect();
        let mut points = vec![point.to_vec()];
        for (j, ends) in ends.iter().enumerate() {
            points.extend(ends.map(|end| {
                let mut moved = point.to_vec();
                moved[j] = end;
                moved
            }));
        }
        let mut found = self
            .predict(&points)
            .into_iter()
            .map(|found| found.unwrap_or_else(|_| vec![None; self.observations.len()]));
        let values = found.next().unwrap_or_default();
        let around: Vec<Predictions> = found.collect();
        let slope = |i: usize, j: usize| {
            let [low, high] = [2 * j, 2 * j + 1].map(|at| around[at][i]);
            Some((high? - low?) / (ends[j][1] - ends[j][0]))
        };
        let row = |i| (0..point.len()).map(|j| slope(i, j)).collect();
        Derivatives { jacobian: (0..values.len()).map(row).collect(), values }
    }

    /// The structure of a rig under the force of a hit.
    fn on_rig(
        &self,
        hit: &SimulatedHit,
        rig: &PreparedRig,
        point: &[f64],
    ) -> Result<PatchSystem, SimulationError> {
        let load = hit.load(rig, hit.sensors.gains(point), &self.folder)?;
        rig.structure()?.with_load(load, hit.duration)
    }
}

impl SimulatedHit {
    /// Steps between samples of the hit.
    fn parts(&self, system: &PatchSystem) -> usize {
        let interval = system.assembly.sampling.interval();
        match &self.resolution {
            Some(held) => ((interval / held.step).round() as usize).max(1),
            None => system.first_parts(),
        }
    }
}

fn resolution(system: &PatchSystem, parts: usize) -> HitResolution {
    HitResolution {
        step: system.assembly.sampling.interval() / parts as f64,
        tolerance: None,
        counts: system.assembly.structure.modes_per_body.clone(),
    }
}

/// Results of a hit, from its response.
fn structure_outcome(
    hit: &SimulatedHit,
    system: &PatchSystem,
    response: PatchResponse,
) -> HitOutcome {
    let mut outcome =
        HitOutcome { pressures: system.pressures(&response), ..HitOutcome::default() };
    if !hit.frequencies.is_empty() {
        outcome.receptance = response.receptance(&hit.frequencies);
    }
    let fundamental = response.observables.get(Quantity::FundamentalFrequency, None);
    if let (true, Some(first)) = (hit.backbone, fundamental) {
        let (decay, rate) = response.decay(system.assembly.load.peak());
        outcome.backbone = backbone_of(decay, rate, first);
    }
    outcome.columns = response.observables.values.into();
    outcome
}
