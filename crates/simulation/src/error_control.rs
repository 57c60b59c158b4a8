//! Modal responses to an accuracy: step and modes are refined until the estimated errors are small
//! enough.
//!
//! Runs of one structure under one shape of force have like relative errors while contact holds. The
//! errors are estimated once, for a reference run whose amplitude is the next power of two above the
//! amplitude of the run, and runs take the step, the modes and the errors of their reference run; the results
//! of a run do not depend on other runs. A run that loses contact is refined by itself, at steps of its own; one that
//! comes near opening under a law that never separates is refined by itself too. A reference run for which equal steps
//! would take longer has steps of its own, and so have the runs that it serves.
//!
//! A request may name a structure near its own ([`RunRequest::near`]), as rows of a study do. Then the
//! reference run is of that structure, which other rows share. Runs that lose contact there take steps and
//! errors of the near run, of almost their own amplitude, if their times without contact are close.
//!
//! A run that does not converge is repeated as a perturbed run, under a force larger by 1e-12: if the two diverge, the
//! response depends on rounding.
//!
//! | module | holds |
//! |---|---|
//! | `converged_run` | requests, and the runs that reach their accuracy |
//! | `level` | steps and modes of the levels of a refinement |
//! | `response` | the responses that a request is judged by |
//! | `task` | one request while its step and modes are refined |
//! | `work` | the work of a response, and how much of it a refinement may ask for |

mod converged_run;
mod level;
mod response;
mod task;
mod work;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{Batch, CaseResponse, DynamicsError, TransientCase};
use asperity_signal::Complex64;
use rayon::prelude::*;

use crate::accuracy::ErrorEstimate;
use crate::error::SimulationError;
use crate::observable_extractor::ObservableExtractor;
use crate::prepared_scenario::PreparedScenario;
use crate::quantity::Quantity;
pub use converged_run::{ConvergedRun, RunRequest};
use response::{Response, ResponseKind, divergence};
pub(crate) use response::{contact_is_lost, divergence_sample, perturbed};
use task::{Chosen, Task};

/// Integrates transient cases to the accuracy of their scenarios.
#[derive(Debug)]
pub struct ErrorControl {
    batch: Batch,
    extractor: ObservableExtractor,
    references: Mutex<Vec<ReferenceRun>>,
    /// Frequency up to which records are kept, beyond what the observables need \[Hz\].
    kept_hz: f64,
}

/// A run whose step, modes and errors are those of other runs.
#[derive(Debug, Clone)]
struct ReferenceRun {
    request: RunRequest,
    kind: Reference,
    /// None if the run failed, did not reach the accuracy, or, of an octave, opened.
    outcome: Option<Arc<Chosen>>,
}

/// Runs that a reference run serves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reference {
    /// All amplitudes of an octave, while no contact opens.
    Octave,
    /// Requests with this near run.
    Near,
}

/// Reference runs kept at a time.
const MOST_REFERENCES: usize = 256;

impl ErrorControl {
    /// Cases integrated by `batch`.
    pub fn new(batch: Batch) -> Self {
        let (extractor, references) = (ObservableExtractor::default(), Mutex::default());
        Self { batch, extractor, references, kept_hz: 0.0 }
    }

    /// The same, whose runs have receptances up to this frequency \[Hz\].
    #[must_use]
    pub fn keeping(self, kept_hz: f64) -> Self {
        Self { kept_hz, ..self }
    }

    /// The receptance of a run at `frequencies` \[Hz\] \[m/N\]; none without a force.
    pub fn receptance(&self, run: &ConvergedRun, frequencies: &[f64]) -> Option<Vec<Complex64>> {
        self.extractor.receptance(&run.case, &run.record, frequencies)
    }

    /// The outcome of each request, in order; none depends on the others.
    pub fn run(&self, requests: &[RunRequest]) -> Vec<Result<ConvergedRun, SimulationError>> {
        self.run_unless(requests, &AtomicBool::new(false))
    }

    /// As [`run`](Self::run); once `stop` is set, requests that are not done end with
    /// [`DynamicsError::Stopped`], within some steps.
    pub fn run_unless(
        &self,
        requests: &[RunRequest],
        stop: &AtomicBool,
    ) -> Vec<Result<ConvergedRun, SimulationError>> {
        self.with_tasks(requests, stop, |mut tasks| {
            for kind in [Reference::Octave, Reference::Near] {
                self.follow_references(&mut tasks, kind, stop);
            }
            let alone = (0..tasks.len()).filter(|&n| tasks[n].done.is_none()).collect();
            self.refine(&mut tasks, alone, stop);
            tasks.into_iter().map(|task| task.done).collect()
        })
    }

    /// A response to each request without an estimate of its errors, at the step that a refinement begins with; where
    /// contact is lost at steps of its own. For pictures that better ones follow.
    pub fn draft(
        &self,
        requests: &[RunRequest],
        stop: &AtomicBool,
    ) -> Vec<Result<ConvergedRun, SimulationError>> {
        self.with_tasks(requests, stop, |mut tasks| {
            let all: Vec<usize> = (0..tasks.len()).collect();
            self.integrate_fine(&mut tasks, &all, stop);
            tasks.iter_mut().for_each(Task::vary_steps_of_draft);
            self.integrate_fine(&mut tasks, &all, stop);
            tasks.into_iter().map(Task::drafted).collect()
        })
    }

    /// The outcomes of the tasks of some requests, in their order, or the errors of those that cannot be set up.
    fn with_tasks<'a>(
        &self,
        requests: &'a [RunRequest],
        stop: &AtomicBool,
        work: impl FnOnce(Vec<Task<'a>>) -> Vec<Option<Result<ConvergedRun, SimulationError>>>,
    ) -> Vec<Result<ConvergedRun, SimulationError>> {
        let (mut tasks, mut places): (Vec<Task<'a>>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut outcomes: Vec<Option<Result<ConvergedRun, SimulationError>>> = Vec::new();
        for (place, request) in requests.iter().enumerate() {
            outcomes.push(match Task::new(request) {
                Ok(task) => {
                    tasks.push(task);
                    places.push(place);
                    None
                }
                Err(error) => Some(Err(error)),
            });
        }
        for (done, place) in work(tasks).into_iter().zip(places) {
            outcomes[place] = done;
        }
        let lost = || Err(self.without_response(stop));
        outcomes.into_iter().map(|outcome| outcome.unwrap_or_else(lost)).collect()
    }

    /// The transient case of a request with the first step that a refinement begins with, and the modes
    /// of each body.
    ///
    /// # Errors
    /// [`SimulationError`] when the case cannot be set up.
    pub fn first_level(
        request: &RunRequest,
    ) -> Result<(TransientCase, Vec<usize>), SimulationError> {
        let task = Task::new(request)?;
        Ok((task.case_of(ResponseKind::Fine)?, task.counts()))
    }

    /// Integrates the tasks that are not done and have a reference run of this kind as that run was, and
    /// accepts those that are like it.
    fn follow_references(&self, tasks: &mut [Task<'_>], kind: Reference, stop: &AtomicBool) {
        let references = self.reference_runs(tasks, kind, stop);
        for (task, reference) in tasks.iter_mut().zip(&references) {
            if let Some(reference) = reference {
                task.follow(reference);
            }
        }
        let referred: Vec<usize> = (0..tasks.len()).filter(|&n| references[n].is_some()).collect();
        self.integrate_fine(tasks, &referred, stop);
        for (task, reference) in tasks.iter_mut().zip(&references) {
            if let Some(reference) = reference {
                task.accept_as(reference);
            }
        }
    }

    /// The outcome of the reference run of each task that is not done, if there is one.
    fn reference_runs(
        &self,
        tasks: &[Task<'_>],
        kind: Reference,
        stop: &AtomicBool,
    ) -> Vec<Option<Arc<Chosen>>> {
        let of_task = |task: &Task<'_>| match kind {
            _ if task.done.is_some() => None,
            Reference::Octave => task.request.reference(),
            Reference::Near => task.request.near_run(),
        };
        let wanted: Vec<Option<RunRequest>> = tasks.iter().map(of_task).collect();
        let lock = || self.references.lock().unwrap_or_else(PoisonError::into_inner);
        let mut known = lock().clone();
        let mut missing: Vec<RunRequest> = Vec::new();
        let is_of = |reference: &ReferenceRun, request: &RunRequest| {
            reference.kind == kind && reference.request.is(request)
        };
        for request in wanted.iter().flatten() {
            let is_known = known.iter().any(|reference| is_of(reference, request))
                || missing.iter().any(|other| other.is(request));
            if !is_known {
                missing.push(request.clone());
            }
        }
        let (mut runs, mut of): (Vec<Task<'_>>, Vec<&RunRequest>) = (Vec::new(), Vec::new());
        for request in &missing {
            if let Ok(task) = Task::reference(request, kind) {
                runs.push(task);
                of.push(request);
            }
        }
        let all = (0..runs.len()).collect();
        self.refine(&mut runs, all, stop);
        for (task, request) in runs.into_iter().zip(of) {
            let outcome = task.chosen().map(Arc::new);
            known.push(ReferenceRun { request: request.clone(), kind, outcome });
        }
        let found = wanted.iter().map(|request| {
            let request = request.as_ref()?;
            known.iter().find(|reference| is_of(reference, request))?.outcome.clone()
        });
        let found = found.collect();
        // What was stopped is not known.
        if !missing.is_empty() && !stop.load(Ordering::Relaxed) {
            let excess = known.len().saturating_sub(MOST_REFERENCES);
            known.drain(..excess);
            *lock() = known;
        }
        found
    }

    /// The error of a run without a response: it was stopped, or the instructions are missing.
    fn without_response(&self, stop: &AtomicBool) -> SimulationError {
        let set = self.batch.instructions;
        SimulationError::from(if stop.load(Ordering::Relaxed) {
            DynamicsError::Stopped { steps: 0 }
        } else {
            DynamicsError::InstructionSet { set }
        })
    }

    /// The outcome of one request.
    ///
    /// # Errors
    /// [`SimulationError`] when the case cannot be set up, or not integrated at any step tried.
    pub fn run_one(&self, request: &RunRequest) -> Result<ConvergedRun, SimulationError> {
        let never = AtomicBool::new(false);
        let found = self.run_unless(std::slice::from_ref(request), &never).pop();
        found.unwrap_or_else(|| Err(self.without_response(&never)))
    }

    /// Refines the tasks of `numbers` until each is done.
    fn refine(&self, tasks: &mut [Task<'_>], mut numbers: Vec<usize>, stop: &AtomicBool) {
        let all = numbers.clone();
        while !numbers.is_empty() && !stop.load(Ordering::Relaxed) {
            self.integrate_missing(tasks, &numbers, stop);
            for &n in &numbers {
                tasks[n].vary_steps_if_open();
            }
            numbers.retain(|&n| tasks[n].done.is_none());
            while self.integrate_missing(tasks, &numbers, stop) {}
            let suspect = numbers.iter().copied().filter(|&n| tasks[n].is_suspect()).collect();
            for (n, perturbed) in self.perturbed_runs(tasks, suspect, stop) {
                if let (Some(Ok(fine)), Ok(perturbed)) = (&tasks[n].fine, perturbed) {
                    let diverged = divergence(&fine.record, &perturbed.record);
                    tasks[n].diverged = diverged.map(|from| (from, perturbed.observables));
                }
            }
            for &n in &numbers {
                tasks[n].accept_or_refine();
            }
            numbers.retain(|&n| tasks[n].done.is_none());
        }
        self.compare_with_perturbed(tasks, &all, stop);
    }

    /// Integrates what tasks miss at their level; false if they miss nothing.
    fn integrate_missing(
        &self,
        tasks: &mut [Task<'_>],
        numbers: &[usize],
        stop: &AtomicBool,
    ) -> bool {
        let of_task = |&n: &usize| tasks[n].missing().map(move |kind| (n, kind));
        let missing: Vec<(usize, ResponseKind)> = numbers.iter().flat_map(of_task).collect();
        self.integrate(tasks, &missing, stop);
        !missing.is_empty()
    }

    fn integrate_fine(&self, tasks: &mut [Task<'_>], numbers: &[usize], stop: &AtomicBool) {
        let open = numbers.iter().filter(|&&n| tasks[n].fine.is_none());
        let missing: Vec<(usize, ResponseKind)> = open.map(|&n| (n, ResponseKind::Fine)).collect();
        self.integrate(tasks, &missing, stop);
    }

    fn integrate(
        &self,
        tasks: &mut [Task<'_>],
        wanted: &[(usize, ResponseKind)],
        stop: &AtomicBool,
    ) {
        for (&(n, kind), response) in wanted.iter().zip(self.respond(tasks, wanted, stop)) {
            tasks[n].take(kind, response);
        }
    }

    /// Marks responses that did not converge where they depend on rounding.
    fn compare_with_perturbed(&self, tasks: &mut [Task<'_>], numbers: &[usize], stop: &AtomicBool) {
        let doubtful = |n: &usize| match &tasks[*n].done {
            Some(Ok(ConvergedRun { observables, .. })) => {
                let known = observables.get(Quantity::SensitiveFrom, None).is_some();
                !known && !observables.estimate().is_some_and(ErrorEstimate::is_reached)
            }
            _ => false,
        };
        let doubtful = numbers.iter().copied().filter(doubtful).collect();
        for (n, perturbed) in self.perturbed_runs(tasks, doubtful, stop) {
            let Some(Ok(done)) = &mut tasks[n].done else { continue };
            match perturbed {
                Ok(perturbed) => {
                    if let Some(time) = divergence(&done.record, &perturbed.record) {
                        done.observables.set_sensitive(time, Some(&perturbed.observables));
                    }
                }
                // One of the two went beyond all bounds.
                Err(_) => done.observables.set_sensitive(0.0, None),
            }
        }
    }

    /// Responses of tasks at their level to slightly larger forces.
    fn perturbed_runs(
        &self,
        tasks: &[Task<'_>],
        numbers: Vec<usize>,
        stop: &AtomicBool,
    ) -> Vec<(usize, Result<Response, SimulationError>)> {
        let wanted: Vec<_> = numbers.iter().map(|&n| (n, ResponseKind::Perturbed)).collect();
        numbers.into_iter().zip(self.respond(tasks, &wanted, stop)).collect()
    }

    /// Responses of tasks, in order: those of a kind in one batch, the kinds on threads of their own.
    fn respond(
        &self,
        tasks: &[Task<'_>],
        wanted: &[(usize, ResponseKind)],
        stop: &AtomicBool,
    ) -> Vec<Result<Response, SimulationError>> {
        let mut cases: Vec<(usize, TransientCase)> = Vec::new();
        let mut responses: Vec<Option<Result<Response, SimulationError>>> = Vec::new();
        for (place, &(n, kind)) in wanted.iter().enumerate() {
            responses.push(match tasks[n].case_of(kind) {
                Ok(case) => {
                    cases.push((place, case));
                    None
                }
                Err(error) => Some(Err(error)),
            });
        }
        let kind = |(place, _): &(usize, TransientCase)| wanted[*place].1;
        cases.sort_by_key(kind);
        let groups: Vec<_> = cases.chunk_by(|a, b| kind(a) == kind(b)).collect();
        let found = groups.into_par_iter().flat_map_iter(|group| {
            let (places, cases): (Vec<usize>, Vec<TransientCase>) = group.iter().cloned().unzip();
            let prepared = places.iter().map(|&place| &*tasks[wanted[place].0].request.prepared);
            let found = self.respond_to(cases, &prepared.collect::<Vec<_>>(), stop);
            places.into_iter().zip(found)
        });
        for (place, response) in found.collect::<Vec<_>>() {
            responses[place] = Some(response);
        }
        let lost = || Err(self.without_response(stop));
        responses.into_iter().map(|response| response.unwrap_or_else(lost)).collect()
    }

    /// Responses to cases of prepared scenarios, in order.
    fn respond_to(
        &self,
        cases: Vec<TransientCase>,
        prepared: &[&PreparedScenario],
        stop: &AtomicBool,
    ) -> Vec<Result<Response, SimulationError>> {
        let decimation = |index: usize, step: f64| {
            let PreparedScenario { assembly, at_rest, .. } = prepared[index];
            let natural = at_rest.natural_frequency_hz;
            self.extractor.decimation_to(assembly.accuracy, natural, self.kept_hz, step)
        };
        let records = self.batch.run_unless(&cases, &decimation, stop);
        let response = |((case, record), prepared): ((TransientCase, _), &&PreparedScenario)| {
            let record: CaseResponse = record?;
            let observables = self.extractor.observables(prepared, &case, &record)?;
            Ok(Response { case, record, observables })
        };
        cases.into_iter().zip(records).zip(prepared).map(response).collect()
    }
}
