//! Rows of a sweep of a structure of matrices.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_scenario::Document;
use rayon::prelude::*;

use super::run::respond;
use crate::error::SimulationError;
use crate::observables::Observables;
use crate::quantity::observable_names;

/// Names of the numbers of a row, and the row.
pub(crate) type PatchRow = Result<(Arc<[String]>, Observables), SimulationError>;

/// The rows of a sweep, row `n` with the values `values(n)` at `pointers`. The first runs alone, so that the
/// others find its reduction.
pub(crate) fn rows<'a>(
    document: &Document,
    pointers: &[&str],
    count: usize,
    values: impl Fn(usize) -> Vec<&'a str> + Sync,
    progress: &(dyn Fn(usize) + Sync),
) -> Vec<PatchRow> {
    let done = AtomicUsize::new(0);
    let row = |number: usize| {
        let row = one(document, pointers, &values(number));
        progress(done.fetch_add(1, Ordering::Relaxed) + 1);
        row
    };
    let mut rows: Vec<PatchRow> = (0..count.min(1)).map(row).collect();
    rows.par_extend((1..count.max(1)).into_par_iter().map(row));
    rows
}

fn one(document: &Document, pointers: &[&str], values: &[&str]) -> PatchRow {
    let mut document = document.clone();
    for (pointer, value) in pointers.iter().zip(values) {
        document.set(pointer, value)?;
    }
    let scenario = document
        .structure_scenario()
        .map_err(|error| SimulationError::Scenario(error.to_string()))?;
    let (_, found) = respond(&scenario, document.folder(), &|_| ())?;
    let interfaces: Vec<&str> = scenario.interfaces.iter().map(|one| one.name.as_str()).collect();
    let sensors = scenario.sensors.iter().skip(1);
    let further: Vec<&str> = sensors.map(|sensor| sensor.name.as_str()).collect();
    Ok((observable_names(&interfaces, &further, false).into(), found.response.observables))
}
