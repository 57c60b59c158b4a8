//! The scenario as a forward model: values of the unknowns to predictions, in batches.

use std::path::PathBuf;

use asperity_dynamics::{Batch, Hit, HitRecord};
use asperity_inference::{Derivatives, ForwardModel, Observation, Predictions, Refusal, Unknown};
use rayon::prelude::*;
use serde_json::Value;

use crate::row::{Columns, Outcome, Outcomes, Row, backbone_of};
use crate::strike::{Prepared, Rig, Strike};
use crate::unknowns::{Gains, Unknowns};
use asperity_scenario::{LawRef, Laws};
use asperity_study::assemble::build_law;
use asperity_study::error::StudyError;
use asperity_study::observable_extractor::ObservableExtractor;
use asperity_study::quantity::Quantity;

/// A scenario with unknowns, strikes, and what is predicted of them.
#[derive(Debug)]
pub(super) struct Forward {
    pub(super) unknowns: Unknowns,
    /// The scenario without the changes of any data.
    pub(super) scenario: Value,
    pub(super) folder: PathBuf,
    pub(super) rigs: Vec<Rig>,
    pub(super) strikes: Vec<Strike>,
    pub(super) rows: Vec<Row>,
    pub(super) observations: Vec<Observation>,
    /// Laws and pressures \[Pa\] at which stiffness is asked for.
    pub(super) stiffness: Vec<(String, f64)>,
    pub(super) columns: Columns,
    pub(super) batch: Batch,
    pub(super) extractor: ObservableExtractor,
}

impl ForwardModel for Forward {
    fn unknowns(&self) -> &[Unknown] {
        &self.unknowns.list
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
        let seen = |(point, outcomes): (&Vec<f64>, Result<Outcomes, StudyError>)| {
            let outcomes = outcomes.map_err(refusal)?;
            let gains = self.gains(point);
            let value = |row: &Row| row.value(&outcomes, &gains, &self.columns);
            Ok(self.rows.iter().map(value).collect())
        };
        // Enough points at a time to fill the lanes of a batch, not so many that cores go idle.
        let abreast = self.abreast().min(points.len().div_ceil(rayon::current_num_threads()));
        points
            .par_chunks(abreast.max(1))
            .flat_map_iter(|points| {
                let outcomes = self.outcomes(points);
                points.iter().zip(outcomes).map(seen).collect::<Vec<_>>()
            })
            .collect()
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, Refusal>> {
        Some(self.derivatives(point).map_err(refusal))
    }
}

#[allow(clippy::needless_pass_by_value, reason = "the shape that map_err takes")]
fn refusal(error: StudyError) -> Refusal {
    Refusal { reason: error.to_string() }
}

impl Forward {
    /// Every rig at `point`.
    pub(super) fn prepare(&self, point: &[f64]) -> Result<Vec<Prepared>, StudyError> {
        self.rigs.iter().map(|rig| rig.prepare(&self.unknowns, point, &self.folder)).collect()
    }

    /// The gains of every strike's sensors at `point`.
    pub(super) fn gains(&self, point: &[f64]) -> Vec<Gains> {
        self.strikes.iter().map(|strike| strike.sensors.gains(point)).collect()
    }

    /// Points whose strikes fill the lanes of a batch best.
    fn abreast(&self) -> usize {
        let (room, strikes) = (self.batch.room(), self.strikes.len().max(1));
        let waste = |points: &usize| {
            let hits = points * strikes;
            hits.div_ceil(room) * room * 1000 / hits + points
        };
        (1..=MOST_ABREAST).min_by_key(waste).unwrap_or(1)
    }

    /// What comes of every strike at each of some `points`, all in one batch.
    pub(super) fn outcomes(&self, points: &[Vec<f64>]) -> Vec<Result<Outcomes, StudyError>> {
        let prepared: Vec<Result<Ready, StudyError>> =
            points.iter().map(|point| self.hits(point)).collect();
        let count = self.strikes.len();
        let ready: Vec<&Ready> = prepared.iter().flatten().collect();
        let all: Vec<Hit> = ready.iter().flat_map(|(_, hits)| hits).cloned().collect();
        let thinning = |index: usize, step: f64| {
            let (point, strike) = (index / count, &self.strikes[index % count]);
            let natural = ready[point].0[strike.rig].case.at_rest.natural_frequency_hz;
            let highest = strike.frequencies.iter().copied().fold(0.0, f64::max);
            self.extractor.thinning(natural, highest, step)
        };
        let mut records = self.batch.run(&all, &thinning).into_iter();
        let finish = |(point, prepared): (&Vec<f64>, Result<Ready, StudyError>)| {
            let (rigs, hits) = prepared?;
            // All records of a point are taken before any of them can fail it.
            let own: Vec<_> = records.by_ref().take(count).collect();
            let mut strikes = Vec::with_capacity(count);
            for ((record, hit), strike) in own.into_iter().zip(&hits).zip(&self.strikes) {
                strikes.push(self.outcome(&rigs[strike.rig], strike, hit, &record?)?);
            }
            Ok(Outcomes { strikes, stiffness: self.stiffnesses(point)? })
        };
        points.iter().zip(prepared).map(finish).collect()
    }

    /// The rigs at `point`, and the strikes on them as hits.
    fn hits(&self, point: &[f64]) -> Result<Ready, StudyError> {
        let rigs = self.prepare(point)?;
        let hit = |strike: &Strike| {
            let gains = strike.sensors.gains(point);
            strike.hit(&rigs[strike.rig], gains, &self.folder)
        };
        let hits = self.strikes.iter().map(hit).collect::<Result<_, _>>()?;
        Ok((rigs, hits))
    }

    /// What comes of a strike, from its record.
    fn outcome(
        &self,
        rig: &Prepared,
        strike: &Strike,
        hit: &Hit,
        record: &HitRecord,
    ) -> Result<Outcome, StudyError> {
        let observables = self.extractor.observables(&rig.case, hit, record)?;
        let fundamental = observables.get(Quantity::FundamentalFrequency, None);
        let mut outcome = Outcome { columns: observables.values.into(), ..Outcome::default() };
        if !strike.frequencies.is_empty() {
            let found = self.extractor.receptance(hit, record, &strike.frequencies);
            outcome.receptance = found.unwrap_or_default();
        }
        if let (true, Some(first)) = (strike.backbone, fundamental)
            && let Some((decay, rate)) = self.extractor.decay(hit, record)
        {
            outcome.backbone = backbone_of(decay, rate, first);
        }
        Ok(outcome)
    }

    /// The stiffnesses asked for at `point` \[Pa/m\].
    pub(super) fn stiffnesses(&self, point: &[f64]) -> Result<Vec<f64>, StudyError> {
        if self.stiffness.is_empty() {
            return Ok(Vec::new());
        }
        let laws = self.laws(point)?;
        let at = |(law, pressure): &(String, f64)| stiffness(&laws, law, *pressure);
        self.stiffness.iter().map(at).collect()
    }

    /// The stiffness \[Pa/m\] of `law` at some `pressures` \[Pa\], with the unknowns at `point`.
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
        let fail = |reason: String| StudyError::Scenario { reason };
        let mut scenario = self.scenario.clone();
        self.unknowns.write(&mut scenario, point).map_err(|error| fail(error.to_string()))?;
        let laws = scenario.get_mut("laws").map(Value::take).unwrap_or_default();
        serde_json::from_value(laws).map_err(|error| fail(error.to_string()))
    }
}

/// The rigs at a point, and the strikes on them.
type Ready = (Vec<Prepared>, Vec<Hit>);

/// Most points of one batch.
const MOST_ABREAST: usize = 6;

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
