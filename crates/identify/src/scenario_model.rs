//! The scenario as a forward model: predictions in batches.

mod derivatives;

use std::path::PathBuf;
use std::sync::Arc;

use asperity_dynamics::{Batch, HitResponse, HitSimulation};
use asperity_inference::{
    Derivatives, ForwardModel, Observation, Parameter, PredictionError, Predictions,
};
use rayon::prelude::*;
use serde_json::Value;

use crate::hit::{HitResolution, PreparedRig, SimulatedHit};
use crate::observed_quantity::{
    HitOutcome, ObservedQuantity, PointOutcomes, SummaryColumns, backbone_of,
};
use crate::problem_parameters::{Gains, ProblemParameters};
use asperity_scenario::{LawRef, Laws};
use asperity_study::assemble::build_law;
use asperity_study::error::StudyError;
use asperity_study::error_control::{Controlled, ErrorControl, Request};
use asperity_study::observable_extractor::ObservableExtractor;
use asperity_study::quantity::Quantity;

/// A scenario with parameters, simulated hits and observed quantities.
#[derive(Debug)]
pub(super) struct ScenarioModel {
    pub(super) parameters: ProblemParameters,
    /// The scenario without the changes of any data.
    pub(super) scenario: Value,
    pub(super) folder: PathBuf,
    /// Scenarios with the changes of some data.
    pub(super) rigs: Vec<Value>,
    pub(super) hits: Vec<SimulatedHit>,
    pub(super) quantities: Vec<ObservedQuantity>,
    pub(super) observations: Vec<Observation>,
    /// Laws and pressures \[Pa\] of requested stiffnesses.
    pub(super) stiffness: Vec<(String, f64)>,
    pub(super) columns: SummaryColumns,
    pub(super) batch: Batch,
    pub(super) extractor: ObservableExtractor,
}

impl ForwardModel for ScenarioModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters.list
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let predict = |(point, outcomes): (&Vec<f64>, Result<PointOutcomes, StudyError>)| {
            let outcomes = outcomes.map_err(prediction_error)?;
            let gains = self.gains(point);
            let value =
                |quantity: &ObservedQuantity| quantity.value(&outcomes, &gains, &self.columns);
            Ok(self.quantities.iter().map(value).collect())
        };
        // Enough points per call to fill a batch, few enough to use all cores.
        let points_per_batch =
            self.points_per_batch().min(points.len().div_ceil(rayon::current_num_threads()));
        points
            .par_chunks(points_per_batch.max(1))
            .flat_map_iter(|points| {
                let outcomes = self.outcomes(points);
                points.iter().zip(outcomes).map(predict).collect::<Vec<_>>()
            })
            .collect()
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, PredictionError>> {
        Some(self.derivatives(point).map_err(prediction_error))
    }
}

#[allow(clippy::needless_pass_by_value, reason = "the shape that map_err takes")]
fn prediction_error(error: StudyError) -> PredictionError {
    PredictionError { reason: error.to_string() }
}

impl ScenarioModel {
    /// Every rig at `point`.
    pub(super) fn prepare(&self, point: &[f64]) -> Result<Vec<PreparedRig>, StudyError> {
        let prepare = |rig| PreparedRig::new(rig, &self.parameters, point, &self.folder);
        self.rigs.iter().map(prepare).collect()
    }

    /// The gains of every hit's sensors at `point`.
    pub(super) fn gains(&self, point: &[f64]) -> Vec<Gains> {
        self.hits.iter().map(|hit| hit.sensors.gains(point)).collect()
    }

    /// Number of points whose hits fill a batch best.
    fn points_per_batch(&self) -> usize {
        let (room, hits) = (self.batch.room(), self.hits.len().max(1));
        let waste = |points: &usize| {
            let simulations = points * hits;
            simulations.div_ceil(room) * room * 1000 / simulations + points
        };
        (1..=MAX_POINTS).min_by_key(waste).unwrap_or(1)
    }

    /// Results of every hit at some `points`, in one batch.
    pub(super) fn outcomes(&self, points: &[Vec<f64>]) -> Vec<Result<PointOutcomes, StudyError>> {
        let prepared: Vec<Result<Ready, StudyError>> =
            points.iter().map(|point| self.prepare_hits(point)).collect();
        let count = self.hits.len();
        let ready: Vec<&Ready> = prepared.iter().flatten().collect();
        let all: Vec<HitSimulation> =
            ready.iter().flat_map(|(_, simulations)| simulations).cloned().collect();
        let decimation = |index: usize, step: f64| {
            let (point, hit) = (index / count, &self.hits[index % count]);
            let natural = ready[point].0[hit.rig].case.at_rest.natural_frequency_hz;
            let highest = hit.frequencies.iter().copied().fold(0.0, f64::max);
            self.extractor.decimation(natural, highest, step)
        };
        let mut records = self.batch.run(&all, &decimation).into_iter();
        let finish = |(point, prepared): (&Vec<f64>, Result<Ready, StudyError>)| {
            let (rigs, simulations) = prepared?;
            // All records of a point are consumed before an error of one of them.
            let own: Vec<_> = records.by_ref().take(count).collect();
            let mut hits = Vec::with_capacity(count);
            for ((record, simulation), hit) in own.into_iter().zip(&simulations).zip(&self.hits) {
                hits.push(self.outcome(&rigs[hit.rig], hit, simulation, &record?)?);
            }
            Ok(PointOutcomes { hits, stiffness: self.stiffnesses(point)? })
        };
        points.iter().zip(prepared).map(finish).collect()
    }

    /// The rigs at `point`, and the hits on them as simulations.
    fn prepare_hits(&self, point: &[f64]) -> Result<Ready, StudyError> {
        let rigs = self.prepare(point)?;
        let simulation = |hit: &SimulatedHit| {
            let gains = hit.sensors.gains(point);
            hit.simulation(&rigs[hit.rig], gains, &self.folder)
        };
        let simulations = self.hits.iter().map(simulation).collect::<Result<_, _>>()?;
        Ok((rigs, simulations))
    }

    /// Every hit at `point` to the accuracy of its scenario: step and modes, observables with their
    /// errors.
    pub(super) fn controlled(
        &self,
        point: &[f64],
    ) -> Result<Vec<Result<Controlled, StudyError>>, StudyError> {
        let rigs = self.prepare(point)?;
        let request = |hit: &SimulatedHit| -> Result<Request, StudyError> {
            let rig = &rigs[hit.rig];
            let excitation = hit.excitation(rig, hit.sensors.gains(point), &self.folder)?;
            Ok(Request { prepared: Arc::clone(&rig.case), excitation, duration: hit.duration })
        };
        let requests: Vec<Request> = self.hits.iter().map(request).collect::<Result<_, _>>()?;
        Ok(ErrorControl::new(self.batch).run(&requests))
    }

    /// Holds step and modes of every hit: those that `controlled` hits have. One that cannot be
    /// integrated has a step of its own at every point. True if any is finer than before.
    pub(super) fn hold(&mut self, controlled: &[Result<Controlled, StudyError>]) -> bool {
        let mut finer = false;
        for (hit, controlled) in self.hits.iter_mut().zip(controlled) {
            let Ok(Controlled { hit: HitSimulation { step: Some(step), .. }, counts, .. }) =
                controlled
            else {
                continue;
            };
            let asked = HitResolution { step: *step, counts: counts.clone() };
            if !hit.resolution.as_ref().is_some_and(|held| held.covers(&asked)) {
                finer = true;
                hit.resolution = Some(asked);
            }
        }
        finer
    }

    /// Holds step and modes that the hits need at the start of the parameters.
    pub(super) fn hold_at_start(&mut self) {
        let start: Vec<f64> = self.parameters.list.iter().map(Parameter::start).collect();
        if let Ok(controlled) = self.controlled(&start) {
            self.hold(&controlled);
        }
    }

    /// Results of a hit, from its record.
    fn outcome(
        &self,
        rig: &PreparedRig,
        hit: &SimulatedHit,
        simulation: &HitSimulation,
        record: &HitResponse,
    ) -> Result<HitOutcome, StudyError> {
        let observables = self.extractor.observables(&rig.case, simulation, record)?;
        let fundamental = observables.get(Quantity::FundamentalFrequency, None);
        let mut outcome =
            HitOutcome { columns: observables.values.into(), ..HitOutcome::default() };
        if !hit.frequencies.is_empty() {
            let found = self.extractor.receptance(simulation, record, &hit.frequencies);
            outcome.receptance = found.unwrap_or_default();
        }
        if let (true, Some(first)) = (hit.backbone, fundamental)
            && let Some((decay, rate)) = self.extractor.decay(simulation, record)
        {
            outcome.backbone = backbone_of(decay, rate, first);
        }
        Ok(outcome)
    }

    /// The requested stiffnesses at `point` \[Pa/m\].
    pub(super) fn stiffnesses(&self, point: &[f64]) -> Result<Vec<f64>, StudyError> {
        if self.stiffness.is_empty() {
            return Ok(Vec::new());
        }
        let laws = self.laws(point)?;
        let at = |(law, pressure): &(String, f64)| stiffness(&laws, law, *pressure);
        self.stiffness.iter().map(at).collect()
    }

    /// The stiffness \[Pa/m\] of `law` at some `pressures` \[Pa\], with the parameters at `point`.
    pub(super) fn curve(
        &self,
        law: &str,
        pressures: &[f64],
        point: &[f64],
    ) -> Result<Vec<f64>, StudyError> {
        let laws = self.laws(point)?;
        pressures.iter().map(|&pressure| stiffness(&laws, law, pressure)).collect()
    }

    /// The laws at `point`.
    pub(super) fn laws(&self, point: &[f64]) -> Result<Laws, StudyError> {
        let fail = |reason: String| StudyError::Scenario(reason);
        let mut scenario = self.scenario.clone();
        self.parameters.write(&mut scenario, point).map_err(|error| fail(error.to_string()))?;
        let laws = scenario.get_mut("laws").map(Value::take).unwrap_or_default();
        serde_json::from_value(laws).map_err(|error| fail(error.to_string()))
    }
}

/// The rigs at a point, and the hits on them.
type Ready = (Vec<PreparedRig>, Vec<HitSimulation>);

/// Most points of one batch.
const MAX_POINTS: usize = 6;

/// Least pressure \[Pa\] that laws which never separate are built for.
const LEAST_PRESSURE: f64 = 1.0;

/// Stiffness \[Pa/m\] of a law at a pressure \[Pa\].
fn stiffness(laws: &Laws, name: &str, pressure: f64) -> Result<f64, StudyError> {
    let reference = LawRef::Named(name.to_owned());
    let law = build_law(&reference, laws, pressure.max(LEAST_PRESSURE)).map_err(|source| {
        StudyError::Law { law: name.to_owned(), interface: None, pressure_pa: pressure, source }
    })?;
    Ok(law.stiffness(pressure))
}
