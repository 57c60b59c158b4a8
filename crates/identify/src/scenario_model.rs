//! The scenario of a problem with its parameters: results of all hits at a point.

use std::path::PathBuf;
use std::sync::Arc;

use asperity_dynamics::{Batch, CaseResponse, DynamicsError, TransientCase};
use asperity_inference::{Observation, Parameter};
use asperity_signal::Complex64;
use serde_json::Value;

use crate::hit::{ConvergedHit, HitForce, HitResolution, PreparedRig, SimulatedHit};
use crate::observed_quantity::{
    HitOutcome, ObservedQuantity, PointOutcomes, SummaryColumns, backbone_of,
};
use crate::problem_parameters::{Gains, ProblemParameters};
use crate::scenario_laws::stiffness_curve;
use crate::stepped_sine::SimulatedSweep;
use crate::work::Work;
use asperity_scenario::{Laws, has_matrices};
use asperity_simulation::error::SimulationError;
use asperity_simulation::error_control::{ConvergedRun, ErrorControl, RunRequest};
use asperity_simulation::observable_extractor::ObservableExtractor;
use asperity_simulation::patches::ReducedStructures;
use asperity_simulation::quantity::Quantity;

/// A scenario with parameters, simulated hits and observed quantities.
#[derive(Debug)]
pub(super) struct ScenarioModel {
    pub(super) parameters: ProblemParameters,
    /// The scenario without the changes of any data.
    pub(super) scenario: Value,
    pub(super) folder: PathBuf,
    /// Reductions of structures of matrices.
    pub(super) reductions: Arc<ReducedStructures>,
    /// Scenarios with the changes of some data.
    pub(super) rigs: Vec<Value>,
    pub(super) hits: Vec<SimulatedHit>,
    pub(super) quantities: Vec<ObservedQuantity>,
    pub(super) observations: Vec<Observation>,
    /// Sweeps of steady responses, whose rows are counted on from one to the next.
    pub(super) sweeps: Vec<SimulatedSweep>,
    /// Laws and pressures \[Pa\] of requested stiffnesses.
    pub(super) stiffness: Vec<(String, f64)>,
    pub(super) columns: SummaryColumns,
    pub(super) batch: Batch,
    pub(super) extractor: ObservableExtractor,
    /// Progress, and requests to stop: no point is evaluated after one.
    pub(super) work: Arc<Work>,
}

/// Halvings at most of a first step that does not keep the energy.
const MOST_HALVINGS: usize = 4;

impl ScenarioModel {
    /// Every rig at `point`.
    pub(super) fn prepare(&self, point: &[f64]) -> Result<Vec<PreparedRig>, SimulationError> {
        let files = (&*self.folder, &*self.reductions);
        let prepare = |rig| PreparedRig::new(rig, &self.parameters, point, files);
        self.rigs.iter().map(prepare).collect()
    }

    /// True for a structure of matrices.
    pub(super) fn is_structure(&self) -> bool {
        has_matrices(&self.scenario)
    }

    /// The gains of every hit's sensors at `point`.
    pub(super) fn gains(&self, point: &[f64]) -> Vec<Gains> {
        self.hits.iter().map(|hit| hit.sensors.gains(point)).collect()
    }

    /// Results of every hit at some `points`, in one batch.
    pub(super) fn outcomes(
        &self,
        points: &[Vec<f64>],
    ) -> Vec<Result<PointOutcomes, SimulationError>> {
        if self.is_structure() {
            return points.iter().map(|point| self.structure_outcomes(point)).collect();
        }
        let prepared: Vec<Result<Ready, SimulationError>> =
            points.iter().map(|point| self.prepare_hits(point)).collect();
        let count = self.hits.len();
        let ready: Vec<&Ready> = prepared.iter().flatten().collect();
        let all: Vec<TransientCase> =
            ready.iter().flat_map(|(_, simulations)| simulations).cloned().collect();
        let decimation = |index: usize, step: f64| {
            let (point, hit) = (index / count, &self.hits[index % count]);
            let natural = ready[point].0[hit.rig].at_rest().natural_frequency_hz;
            let highest = hit.frequencies.iter().copied().fold(0.0, f64::max);
            self.extractor.decimation(natural, highest, step)
        };
        let mut records = self.batch.run(&all, &decimation).into_iter();
        let finish = |(point, prepared): (&Vec<f64>, Result<Ready, SimulationError>)| {
            let (rigs, simulations) = prepared?;
            // All records of a point are consumed before an error of one of them.
            let own: Vec<_> = records.by_ref().take(count).collect();
            let mut hits = Vec::with_capacity(count);
            for ((record, simulation), hit) in own.into_iter().zip(&simulations).zip(&self.hits) {
                hits.push(self.outcome(&rigs[hit.rig], hit, simulation, &record?)?);
            }
            let steady = self.steady(&rigs, point)?;
            Ok(PointOutcomes { hits, stiffness: self.stiffnesses(point)?, steady })
        };
        points.iter().zip(prepared).map(finish).collect()
    }

    /// The steady responses at `point` as the sensors show them \[m\].
    pub(super) fn steady(
        &self,
        rigs: &[PreparedRig],
        point: &[f64],
    ) -> Result<Vec<Option<Complex64>>, SimulationError> {
        let mut all = Vec::new();
        for sweep in &self.sweeps {
            let gains = sweep.sensors.gains(point);
            for response in sweep.responses(rigs, gains)? {
                all.push(response.map(|response| gains.response * response.displacement));
            }
        }
        Ok(all)
    }

    /// The rigs at `point`, and the hits on them as simulations.
    fn prepare_hits(&self, point: &[f64]) -> Result<Ready, SimulationError> {
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
    pub(super) fn converged(
        &self,
        point: &[f64],
    ) -> Result<Vec<Result<ConvergedHit, SimulationError>>, SimulationError> {
        if self.is_structure() {
            return self.converged_structure(point);
        }
        let runs = ErrorControl::new(self.batch).run(&self.requests(point)?).into_iter();
        Ok(runs.map(|run| run.map(ConvergedHit::from)).collect())
    }

    /// The hits at `point` as requests of an accuracy.
    fn requests(&self, point: &[f64]) -> Result<Vec<RunRequest>, SimulationError> {
        let rigs = self.prepare(point)?;
        let request = |hit: &SimulatedHit| -> Result<RunRequest, SimulationError> {
            let rig = &rigs[hit.rig];
            let load = hit.load(rig, hit.sensors.gains(point), &self.folder)?;
            let (prepared, duration) = (Arc::clone(rig.bars()?), hit.duration);
            Ok(RunRequest { prepared, load, sensor: 0, duration, near: None })
        };
        self.hits.iter().map(request).collect()
    }

    /// Holds step and modes of every hit: the step and modes of its `converged` run. A hit that cannot be
    /// integrated has a step of its own at every point. True if any is finer than before.
    pub(super) fn hold(&mut self, converged: &[Result<ConvergedHit, SimulationError>]) -> bool {
        let mut finer = false;
        for (hit, run) in self.hits.iter_mut().zip(converged) {
            let Ok(ConvergedHit { resolution: Some(asked), .. }) = run else { continue };
            if !hit.resolution.as_ref().is_some_and(|held| held.covers(asked)) {
                finer = true;
                hit.resolution = Some(asked.clone());
            }
        }
        self.share_resolution_of_records();
        finer
    }

    /// Gives recorded hits of one rig and duration common steps and modes, none coarser: a step of its
    /// own for each record would need tables of its own, and an integration of its own.
    fn share_resolution_of_records(&mut self) {
        if self.is_structure() {
            // Their steps are parts of the time between samples.
            return;
        }
        let is_recorded = |hit: &SimulatedHit| {
            let at_equal_steps = hit.resolution.as_ref().is_none_or(|own| own.tolerance.is_none());
            at_equal_steps && matches!(hit.force, HitForce::Record { .. })
        };
        let key = |hit: &SimulatedHit, step: f64| {
            // The power of two below.
            (hit.rig, hit.duration.map(f64::to_bits), step.log2().floor() as i64)
        };
        let mut shared: Vec<(SharedResolution, Vec<usize>)> = Vec::new();
        for hit in self.hits.iter().filter(|hit| is_recorded(hit)) {
            let Some(own) = &hit.resolution else { continue };
            let of = key(hit, own.step);
            match shared.iter_mut().find(|(known, _)| *known == of) {
                None => shared.push((of, own.counts.clone())),
                Some((_, most)) => {
                    for (most, count) in most.iter_mut().zip(&own.counts) {
                        *most = (*most).max(*count);
                    }
                }
            }
        }
        for hit in self.hits.iter_mut().filter(|hit| is_recorded(hit)) {
            let Some(step) = hit.resolution.as_ref().map(|own| own.step) else { continue };
            let of = key(hit, step);
            if let Some((_, counts)) = shared.iter().find(|(known, _)| *known == of) {
                let step = (of.2 as f64).exp2();
                let counts = counts.clone();
                hit.resolution = Some(HitResolution { step, tolerance: None, counts });
            }
        }
    }

    /// The model with a number of the scenario times a factor, in every rig as it is there.
    pub(super) fn with_scaled(&self, pointer: &str, factor: f64) -> Self {
        self.changed(&|scenario| {
            if let Some(number) = scenario.pointer_mut(pointer)
                && let Some(value) = number.as_f64()
            {
                *number = (factor * value).into();
            }
        })
    }

    /// The model with a member of an object of the scenario, in every rig.
    pub(super) fn with_set(&self, pointer: &str, value: &Value) -> Self {
        self.changed(&|scenario| {
            if let Some((object, key)) = pointer.rsplit_once('/')
                && let Some(object) = scenario.pointer_mut(object).and_then(Value::as_object_mut)
            {
                object.insert(key.to_owned(), value.clone());
            }
        })
    }

    /// The natural frequency of the first rig at `point` \[Hz\].
    pub(super) fn natural_frequency(&self, point: &[f64]) -> Option<f64> {
        self.prepare(point).ok()?.first()?.at_rest().natural_frequency_hz
    }

    /// The model with a change of the scenario and of every rig.
    fn changed(&self, change: &dyn Fn(&mut Value)) -> Self {
        let changed = |scenario: &Value| {
            let mut scenario = scenario.clone();
            change(&mut scenario);
            scenario
        };
        Self {
            parameters: self.parameters.clone(),
            scenario: changed(&self.scenario),
            folder: self.folder.clone(),
            reductions: Arc::clone(&self.reductions),
            rigs: self.rigs.iter().map(changed).collect(),
            hits: self.hits.clone(),
            quantities: self.quantities.clone(),
            observations: self.observations.clone(),
            sweeps: self.sweeps.clone(),
            stiffness: self.stiffness.clone(),
            columns: self.columns.clone(),
            batch: self.batch,
            extractor: ObservableExtractor::default(),
            work: Arc::clone(&self.work),
        }
    }

    /// The start of the parameters.
    pub(super) fn start(&self) -> Vec<f64> {
        self.parameters.list.iter().map(Parameter::start).collect()
    }

    /// Holds the first step and modes of a refinement at the start of the parameters, for the search;
    /// its end is refined. A refinement at a start far from the data may cost much in vain. A first step
    /// that does not keep the energy is halved.
    pub(super) fn hold_first(&mut self) {
        if self.is_structure() {
            return self.hold_first_of_structure();
        }
        let Ok(requests) = self.requests(&self.start()) else { return };
        for (hit, request) in self.hits.iter_mut().zip(&requests) {
            if let Ok((TransientCase { step: Some(step), .. }, counts)) =
                ErrorControl::first_level(request)
            {
                hit.resolution = Some(HitResolution { step, tolerance: None, counts });
            }
        }
        self.share_resolution_of_records();
        for _ in 0..MOST_HALVINGS {
            let Ok(records) = self.records(&self.start()) else { return };
            let coarse = records.iter().map(|record| {
                matches!(record, Err(DynamicsError::Coarse { .. } | DynamicsError::Unstable { .. }))
            });
            let coarse: Vec<bool> = coarse.collect();
            if !coarse.contains(&true) {
                return;
            }
            let held = self.hits.iter_mut().zip(coarse).filter(|(_, is_coarse)| *is_coarse);
            for resolution in held.filter_map(|(hit, _)| hit.resolution.as_mut()) {
                resolution.step *= 0.5;
            }
            self.share_resolution_of_records();
        }
    }

    /// The responses to the hits at `point`.
    fn records(
        &self,
        point: &[f64],
    ) -> Result<Vec<Result<CaseResponse, DynamicsError>>, SimulationError> {
        let (rigs, simulations) = self.prepare_hits(point)?;
        let decimation = |index: usize, step: f64| {
            let natural = rigs[self.hits[index].rig].at_rest().natural_frequency_hz;
            self.extractor.decimation(natural, 0.0, step)
        };
        Ok(self.batch.run(&simulations, &decimation))
    }

    /// Holds step and modes of the hits of another model of the same data.
    pub(super) fn hold_as(&mut self, other: &Self) {
        if self.hits.len() != other.hits.len() {
            return;
        }
        for (hit, other) in self.hits.iter_mut().zip(&other.hits) {
            hit.resolution.clone_from(&other.resolution);
        }
    }

    /// Results of a hit by itself.
    pub(super) fn outcome_alone(
        &self,
        rig: &PreparedRig,
        hit: &SimulatedHit,
        simulation: &TransientCase,
    ) -> Result<HitOutcome, SimulationError> {
        let natural = rig.at_rest().natural_frequency_hz;
        let highest = hit.frequencies.iter().copied().fold(0.0, f64::max);
        let decimation = |_, step: f64| self.extractor.decimation(natural, highest, step);
        let records = self.batch.run(std::slice::from_ref(simulation), &decimation);
        let lost = || DynamicsError::InstructionSet { set: self.batch.instructions };
        let record = records.into_iter().next().ok_or_else(lost)??;
        self.outcome(rig, hit, simulation, &record)
    }

    /// Results of a hit, from its record.
    fn outcome(
        &self,
        rig: &PreparedRig,
        hit: &SimulatedHit,
        simulation: &TransientCase,
        record: &CaseResponse,
    ) -> Result<HitOutcome, SimulationError> {
        let bars = rig.bars()?;
        let observables = self.extractor.observables(bars, simulation, record)?;
        let fundamental = observables.get(Quantity::FundamentalFrequency, None);
        let pressure = |interface: usize| {
            let ends = [Quantity::PressureMin, Quantity::PressureMax];
            ends.map(|end| observables.get(end, Some(interface)).unwrap_or(f64::NAN))
        };
        let pressures = (0..bars.at_rest.interfaces.len()).map(pressure).collect();
        let mut outcome =
            HitOutcome { columns: observables.values.into(), pressures, ..HitOutcome::default() };
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
    pub(super) fn stiffnesses(&self, point: &[f64]) -> Result<Vec<f64>, SimulationError> {
        if self.stiffness.is_empty() {
            return Ok(Vec::new());
        }
        let laws = self.laws(point)?;
        let mut all = Vec::with_capacity(self.stiffness.len());
        for of_law in self.stiffness.chunk_by(|one, next| one.0 == next.0) {
            let pressures: Vec<f64> = of_law.iter().map(|(_, pressure)| *pressure).collect();
            all.extend(stiffness_curve(&laws, &of_law[0].0, &pressures)?);
        }
        Ok(all)
    }

    /// The stiffness \[Pa/m\] of `law` at some `pressures` \[Pa\], with the parameters at `point`.
    pub(super) fn curve(
        &self,
        law: &str,
        pressures: &[f64],
        point: &[f64],
    ) -> Result<Vec<f64>, SimulationError> {
        let laws = self.laws(point)?;
        stiffness_curve(&laws, law, pressures)
    }

    /// Derivatives of ln K of `law` at some `pressures` \[Pa\] with respect to the working coordinate of
    /// a parameter, by differences inside its bounds.
    pub(super) fn log_stiffness_derivative(
        &self,
        law: &str,
        pressures: &[f64],
        point: &[f64],
        parameter: usize,
    ) -> Result<Vec<f64>, SimulationError> {
        let varied = &self.parameters.list[parameter];
        let [low, high] = varied.bounds().map(|bound| varied.to_working(bound));
        let ends = [-LOG_STIFFNESS_STEP, LOG_STIFFNESS_STEP].map(|share| {
            (varied.to_working(point[parameter]) + share * (high - low)).clamp(low, high)
        });
        let curve = |coordinate: f64| {
            let mut moved = point.to_vec();
            moved[parameter] = varied.from_working(coordinate);
            self.curve(law, pressures, &moved)
        };
        let [below, above] = ends.map(curve);
        let slope = |(a, b): (f64, f64)| (b / a).ln() / (ends[1] - ends[0]);
        Ok(below?.into_iter().zip(above?).map(slope).collect())
    }

    /// Gradients of ln K of `law`, one for each of the `pressures` \[Pa\], with respect to the working
    /// coordinates of all parameters.
    pub(super) fn log_stiffness_gradients(
        &self,
        law: &str,
        pressures: &[f64],
        point: &[f64],
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let columns = (0..point.len())
            .map(|j| self.log_stiffness_derivative(law, pressures, point, j))
            .collect::<Result<Vec<_>, _>>()?;
        let gradient = |i: usize| columns.iter().map(|column| column[i]).collect();
        Ok((0..pressures.len()).map(gradient).collect())
    }

    /// The laws at `point`.
    pub(super) fn laws(&self, point: &[f64]) -> Result<Laws, SimulationError> {
        let fail = |reason: String| SimulationError::Scenario(reason);
        let mut scenario = self.scenario.clone();
        self.parameters.write(&mut scenario, point).map_err(|error| fail(error.to_string()))?;
        let laws = scenario.get_mut("laws").map(Value::take).unwrap_or_default();
        serde_json::from_value(laws).map_err(|error| fail(error.to_string()))
    }
}

impl From<ConvergedRun> for ConvergedHit {
    fn from(run: ConvergedRun) -> Self {
        let ConvergedRun { case, observables, counts, .. } = run;
        let resolution =
            |step| HitResolution { step, tolerance: case.tolerance, counts: counts.clone() };
        Self { peak: case.load.peak(), resolution: case.step.map(resolution), observables }
    }
}

/// Step of a parameter over its range for the derivative of ln K.
const LOG_STIFFNESS_STEP: f64 = 1e-5;

/// Rig, bits of the duration, and binary exponent of the step of recorded hits.
type SharedResolution = (usize, Option<u64>, i64);

/// The rigs at a point, and the hits on them.
type Ready = (Vec<PreparedRig>, Vec<TransientCase>);
