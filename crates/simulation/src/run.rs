//! One transient run: equilibrium, integration, observables.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use asperity_dynamics::{Batch, Modal, Transient};
use asperity_scenario::{Document, Scenario};
use asperity_signal::{Complex64, Frf};
use asperity_structure::PreloadedStructure;
use tracing::info_span;

use crate::assemble::{Assembly, Interfaces};
use crate::error::SimulationError;
use crate::error_control::{ConvergedRun, ErrorControl, RunRequest};
use crate::finite_differences::{FineResponse, integrate};
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;
use crate::provenance::Provenance;
use crate::response_parts::history_response;
use crate::summary::{Numerics, Summary};

/// Zero padding of the FRF that is written and drawn.
const FRF_PADDING: usize = 4;

/// Highest frequency of the FRF that is written, over the static frequency.
const FRF_RANGE: f64 = 6.0;

/// A finished run.
#[derive(Debug)]
pub struct Run<S = PreloadedStructure> {
    /// The assembled scenario.
    pub assembly: Assembly<S>,
    /// The response.
    pub transient: Transient,
    /// Its observables.
    pub observables: Observables,
    /// The observables as `summary.json` has them.
    pub summary: Summary,
}

/// Carries out the run that `document` describes.
///
/// Warnings about the response are in the summary, and logged.
///
/// # Errors
/// [`SimulationError`] when the parts cannot be built or the run fails.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::run::simulate;
/// let document = Document::read("examples/block.json")?;
/// let run = simulate(&document, &document.scenario()?)?;
/// let fundamental = run.summary.fundamental.unwrap();
/// let at_rest = run.summary.at_rest.natural_frequency_hz.unwrap();
/// assert!((fundamental.frequency_hz / at_rest - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(document: &Document, scenario: &Scenario) -> Result<Run, SimulationError> {
    simulate_with_progress(document, scenario, &|_| ())
}

/// As [`simulate`]; `progress` receives the fraction done.
///
/// # Errors
/// Those of [`simulate`].
pub fn simulate_with_progress(
    document: &Document,
    scenario: &Scenario,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Run, SimulationError> {
    simulate_unless(document, scenario, &AtomicBool::new(false), progress)
}

/// As [`simulate_with_progress`]; once `stop` is set, a run ends within some steps, by finite differences within 64
/// samples.
///
/// # Errors
/// Those of [`simulate`], and [`Stopped`](asperity_dynamics::DynamicsError::Stopped).
pub fn simulate_unless(
    document: &Document,
    scenario: &Scenario,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Run, SimulationError> {
    let started = Instant::now();
    let prepared = info_span!("assemble")
        .in_scope(|| PreparedScenario::new(scenario, document.folder()).map(Arc::new))?;
    let (transient, observables, modes_per_body) = if let Some(modal) = prepared.modal() {
        let (transient, found, counts) = converged(&prepared, modal, stop, progress)?;
        (transient, found, Some(counts))
    } else {
        let FineResponse { mut transient, readings, observables } =
            integrate(&prepared.assembly, &prepared.at_rest, stop, progress)?;
        transient.history = transient.history.every(readings);
        (transient, observables, None)
    };
    let (assembly, at_rest) = (prepared.assembly.clone(), prepared.at_rest.clone());
    for warning in &observables.warnings {
        tracing::warn!("{warning}");
    }
    let numerics = Numerics {
        method: assembly.method.name(),
        step_s: transient.step,
        steps: transient.steps,
        modes_per_body,
        instructions: format!("{:?}", assembly.method.instructions()).to_lowercase(),
        wall_s: started.elapsed().as_secs_f64(),
    };
    let provenance = Provenance::of_scenario(document, scenario)?;
    let title = scenario.title.clone();
    let summary = Summary::new(title, &assembly, at_rest, &observables, numerics, provenance);
    Ok(Run { assembly, transient, observables, summary })
}

/// The modal response to the accuracy of the scenario, its observables, and the modes of each body. The observables are
/// those of the response whose errors were estimated, as in a row of a sweep; the history is of one whose steps
/// meet its samples.
fn converged(
    prepared: &Arc<PreparedScenario>,
    modal: Modal,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(Transient, Observables, Vec<usize>), SimulationError> {
    let Assembly { sampling, .. } = &prepared.assembly;
    let batch = Batch { instructions: modal.instructions };
    let requests = RunRequest::at_sensors(prepared, &prepared.assembly.load, None);
    let stage = info_span!("choose step and modes").entered();
    let chosen = ErrorControl::new(batch).run_unless(&requests, stop);
    let chosen = ConvergedRun::joined(chosen)?;
    drop(stage);
    progress(0.5);
    let _stage = info_span!("integrate and analyse").entered();
    let transient = batch.transient_unless(&chosen.case, sampling, stop)?;
    progress(1.0);
    Ok((transient, chosen.observables, chosen.counts))
}

/// The frequency response at a sensor from its displacement, relative to the base: the receptance
/// \[m/N\], or with a motion of the base the relative displacement per base acceleration \[s2\]. Up to
/// six times the static frequency (or the whole band without one); none for a run without a load.
///
/// # Errors
/// [`SimulationError::Signal`] when the response cannot be analysed.
pub fn receptance<S: Interfaces>(
    run: &Run<S>,
    sensor: usize,
) -> Result<Option<Frf>, SimulationError> {
    let (history, rate) = (&run.transient.history, run.assembly.sampling.rate());
    let displacement = &history.sensors[sensor].displacement;
    let has_friction = run.assembly.structure.has_friction();
    let Some(response) = history_response(&history.load, displacement, rate, has_friction)? else {
        return Ok(None);
    };
    let mut frf = response.receptance(FRF_PADDING);
    if let Some(natural) = run.summary.at_rest.natural_frequency_hz {
        let kept = frf.frequency_hz.partition_point(|&f| f <= FRF_RANGE * natural);
        frf.frequency_hz.truncate(kept);
        frf.values.truncate(kept);
    }
    Ok(Some(frf))
}

/// The transmissibility at a sensor: its absolute motion over the motion of the base, from the `frf` of
/// its relative displacement per base acceleration, `s - (2 pi f)^2 H` with the part `s` of the motion of the base
/// that the sensor reads.
pub fn transmissibility(frf: &Frf, base_share: f64) -> Frf {
    let pairs = frf.frequency_hz.iter().zip(&frf.values);
    let value =
        |(frequency, value): (&f64, &Complex64)| base_share - (TAU * frequency).powi(2) * value;
    Frf { values: pairs.map(value).collect(), ..frf.clone() }
}
