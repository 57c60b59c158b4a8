//! Rows of a sweep or a study of a structure of matrices.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_mesh::Port;
use asperity_scenario::StructureScenario;
use rayon::prelude::*;

use super::structure::ReducedStructures;
use super::system::{PatchSystem, RefinedPatchResponse};
use crate::assemble::load_case_at;
use crate::error::SimulationError;
use crate::observables::Observables;
use crate::quantity::observable_names;
use crate::row_inputs::{RowInputs, magnitudes};

/// Names of the numbers of a row, and the row.
type Row = (Arc<[String]>, Observables);

/// Assembled structures that are kept for other rows.
const MOST_KEPT: usize = 16;

/// Runs rows of a structure of matrices; those that differ in the force alone share one assembly.
#[derive(Debug, Default)]
pub(crate) struct PatchRows {
    reductions: ReducedStructures,
    kept: Mutex<HashMap<Vec<String>, Arc<Prepared>>>,
}

#[derive(Debug)]
struct Prepared {
    system: PatchSystem,
    names: Arc<[String]>,
}

impl Prepared {
    fn new(
        scenario: &StructureScenario,
        folder: &Path,
        reductions: &ReducedStructures,
    ) -> Result<Self, SimulationError> {
        let interfaces: Vec<&str> = scenario.interfaces.iter().map(|one| &*one.name).collect();
        let further: Vec<&str> = scenario.sensors.iter().skip(1).map(|one| &*one.name).collect();
        let system = PatchSystem::new(reductions.assemble(scenario, folder)?)?;
        let base = system.assembly.load.base().is_some();
        Ok(Self { names: observable_names(&interfaces, &further, base).into(), system })
    }
}

impl PatchRows {
    /// Rows, as [`RowRunner::run`](crate::row_runner::RowRunner::run) has them. The first runs alone, so that
    /// the others find its reduction.
    pub(crate) fn run<T: AsRef<str>>(
        &self,
        (inputs, frequencies): (&RowInputs, &[f64]),
        count: usize,
        row: impl Fn(usize) -> Vec<T> + Sync,
        stop: &AtomicBool,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Option<Vec<Result<Row, SimulationError>>> {
        let done = AtomicUsize::new(0);
        let one = |number: usize| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let found = self.one((inputs, frequencies), &row(number), stop);
            progress(done.fetch_add(1, Ordering::Relaxed) + 1);
            Some(found)
        };
        let first: Option<Vec<_>> = (0..count.min(1)).map(one).collect();
        let others: Option<Vec<_>> = (1..count.max(1)).into_par_iter().map(one).collect();
        Some(first?.into_iter().chain(others?).collect())
    }

    /// Names of the numbers of the scenario as it is.
    pub(crate) fn names(inputs: &RowInputs) -> Result<Arc<[String]>, SimulationError> {
        let scenario = inputs.scenario::<&str, StructureScenario>(&[])?;
        let found = Prepared::new(&scenario, inputs.folder(), &ReducedStructures::default())?;
        Ok(found.names)
    }

    fn one<T: AsRef<str>>(
        &self,
        (inputs, frequencies): (&RowInputs, &[f64]),
        row: &[T],
        stop: &AtomicBool,
    ) -> Result<Row, SimulationError> {
        inputs.check(row)?;
        let folder = inputs.folder();
        let prepared = self.prepared(inputs, row)?;
        let port = Port::Number(prepared.system.assembly.structure.load);
        let excitation = inputs.excitation(row)?;
        let load = load_case_at(&excitation, port, folder)?;
        let system = prepared.system.with_load(load, None)?;
        let RefinedPatchResponse { response, .. } = system.refined(stop, &|_| ())?;
        let receptance = || Some(response.receptance(frequencies));
        let frf = magnitudes(frequencies, receptance);
        let mut found = response.observables;
        found.frf = frf;
        Ok((Arc::clone(&prepared.names), found))
    }

    /// The assembled structure of a row.
    fn prepared<T: AsRef<str>>(
        &self,
        inputs: &RowInputs,
        row: &[T],
    ) -> Result<Arc<Prepared>, SimulationError> {
        // The place of the force, or the direction of the base, is a port of the structure.
        let is_port = |place: &str| {
            ["/excitation/at", "/excitation/direction"].iter().any(|port| place.starts_with(port))
        };
        let key = inputs.of_structure(row, is_port);
        let kept = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = kept().get(&key) {
            return Ok(Arc::clone(found));
        }
        let scenario = inputs.scenario(row)?;
        let prepared = Arc::new(Prepared::new(&scenario, inputs.folder(), &self.reductions)?);
        let mut all = kept();
        if all.len() >= MOST_KEPT {
            all.clear();
        }
        Ok(Arc::clone(all.entry(key).or_insert(prepared)))
    }
}
