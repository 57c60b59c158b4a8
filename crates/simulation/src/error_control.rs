//! Modal responses to an accuracy: step and modes are refined until the estimated errors are small
//! enough.
//!
//! Hits of one structure and one shape of force have like relative errors while contact holds. So
//! they are estimated once, for a pilot with the next power of two above the peak of a hit, and
//! hits take the step, the modes and the errors of their pilot; their results do not depend on
//! other hits. A hit that loses contact is refined by itself. A response that does not converge is
//! integrated once more under a force larger by 1e-12: if the two part, it depends on rounding.
//!
//! One response, its estimated errors, and the next step and modes are in `task`.

mod task;

use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{Batch, DynamicsError, Excitation, HitResponse, HitSimulation};
use asperity_signal::Complex64;

use crate::accuracy::ErrorEstimate;
use crate::error::SimulationError;
use crate::observable_extractor::ObservableExtractor;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;
use crate::quantity::Quantity;
pub(crate) use task::contact_is_lost;
use task::{Level, Response, Task};

/// Relative change of the force of the twin that shows dependence on rounding.
const PERTURBATION: f64 = 1e-12;

/// Difference of two displacements, over the largest, from which on they count as parted.
const PARTED: f64 = 1e-3;

/// A modal hit to be carried out to the accuracy of its scenario.
#[derive(Debug, Clone)]
pub struct Request {
    /// The structure at rest, and the accuracy.
    pub prepared: Arc<PreparedScenario>,
    /// The force.
    pub excitation: Excitation,
    /// Duration \[s\]; that of the scenario if not given.
    pub duration: Option<f64>,
}

/// A hit with the step and the modes that were chosen, and its observables with their errors.
#[derive(Debug)]
pub struct Controlled {
    /// The hit.
    pub hit: HitSimulation,
    /// Its observables, with [estimated errors](Observables::estimate).
    pub observables: Observables,
    /// Modes of each body, the rigid one included.
    pub counts: Vec<usize>,
    record: HitResponse,
}

/// Integrates hits to the accuracy of their scenarios.
#[derive(Debug)]
pub struct ErrorControl {
    batch: Batch,
    extractor: ObservableExtractor,
    pilots: Mutex<Vec<Pilot>>,
    /// Frequency up to which records are kept, beyond what the observables need \[Hz\].
    kept_hz: f64,
}

/// A hit whose step, modes and errors are those of others.
#[derive(Debug, Clone)]
struct Pilot {
    request: Request,
    /// None if the pilot failed, lost contact, or did not reach the accuracy.
    outcome: Option<Arc<(Level, Observables)>>,
}

/// Pilots kept at a time.
const MOST_PILOTS: usize = 64;

impl Controlled {
    fn is_reached(&self) -> bool {
        self.observables.estimate().is_some_and(ErrorEstimate::is_reached)
    }
}

impl Request {
    /// The request of the pilot: of the next power of two above the peak. None where forces of one
    /// shape are not told from others.
    fn pilot(&self) -> Option<Self> {
        let (unit, factor) = self.excitation.unit();
        if unit.peak() != 1.0 || factor == 0.0 {
            return None;
        }
        let octave = factor.abs().log2().ceil().exp2().copysign(factor);
        let excitation = unit.scaled(octave);
        Some(Self { prepared: Arc::clone(&self.prepared), excitation, duration: self.duration })
    }

    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.prepared, &other.prepared)
            && (&self.excitation, self.duration) == (&other.excitation, other.duration)
    }
}

impl ErrorControl {
    /// Hits integrated by `batch`.
    pub fn new(batch: Batch) -> Self {
        let (extractor, pilots) = (ObservableExtractor::default(), Mutex::default());
        Self { batch, extractor, pilots, kept_hz: 0.0 }
    }

    /// The same, whose hits have receptances up to this frequency \[Hz\].
    #[must_use]
    pub fn keeping(self, kept_hz: f64) -> Self {
        Self { kept_hz, ..self }
    }

    /// The receptance of a hit at `frequencies` \[Hz\] \[m/N\]; none without a force.
    pub fn receptance(&self, hit: &Controlled, frequencies: &[f64]) -> Option<Vec<Complex64>> {
        self.extractor.receptance(&hit.hit, &hit.record, frequencies)
    }

    /// The outcome of each request, in order; none depends on the others.
    pub fn run(&self, requests: &[Request]) -> Vec<Result<Controlled, SimulationError>> {
        let (mut tasks, mut places): (Vec<Task<'_>>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut outcomes: Vec<Option<Result<Controlled, SimulationError>>> = Vec::new();
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
        let pilots = self.pilots(&tasks);
        for (task, pilot) in tasks.iter_mut().zip(&pilots) {
            task.level = pilot.as_ref().map_or(Level::default(), |pilot| pilot.0);
        }
        let led: Vec<usize> = (0..tasks.len()).filter(|&n| pilots[n].is_some()).collect();
        self.integrate_fine(&mut tasks, &led);
        for (task, pilot) in tasks.iter_mut().zip(&pilots) {
            if let Some(pilot) = pilot {
                task.follow(pilot);
            }
        }
        let alone = (0..tasks.len()).filter(|&n| tasks[n].done.is_none()).collect();
        self.refine(&mut tasks, alone);
        for (task, place) in tasks.into_iter().zip(places) {
            outcomes[place] = task.done;
        }
        let lost = || {
            let set = self.batch.instructions;
            Err(SimulationError::from(DynamicsError::InstructionSet { set }))
        };
        outcomes.into_iter().map(|outcome| outcome.unwrap_or_else(lost)).collect()
    }

    /// The hit of a request with the first step that a refinement begins with, and the modes of each
    /// body.
    ///
    /// # Errors
    /// [`SimulationError`] when the hit cannot be set up.
    pub fn first_level(request: &Request) -> Result<(HitSimulation, Vec<usize>), SimulationError> {
        let task = Task::new(request)?;
        Ok((task.hit_at(task.level)?, task.counts_at(task.level)))
    }

    /// The pilot of each task, if it has one that it can follow.
    fn pilots(&self, tasks: &[Task<'_>]) -> Vec<Option<Arc<(Level, Observables)>>> {
        let wanted: Vec<Option<Request>> = tasks.iter().map(|task| task.request.pilot()).collect();
        let lock = || self.pilots.lock().unwrap_or_else(PoisonError::into_inner);
        let mut known = lock().clone();
        let mut missing: Vec<Request> = Vec::new();
        for request in wanted.iter().flatten() {
            let is_known = known.iter().any(|pilot| pilot.request.is(request))
                || missing.iter().any(|other| other.is(request));
            if !is_known {
                missing.push(request.clone());
            }
        }
        let (mut pilots, mut of): (Vec<Task<'_>>, Vec<&Request>) = (Vec::new(), Vec::new());
        for request in &missing {
            if let Ok(task) = Task::pilot(request) {
                pilots.push(task);
                of.push(request);
            }
        }
        let all = (0..pilots.len()).collect();
        self.refine(&mut pilots, all);
        for (task, request) in pilots.into_iter().zip(of) {
            let outcome = match task.done {
                Some(Ok(done)) if !contact_is_lost(&done.record.contacts) && done.is_reached() => {
                    Some(Arc::new((task.level, done.observables)))
                }
                _ => None,
            };
            known.push(Pilot { request: request.clone(), outcome });
        }
        let found = wanted.iter().map(|request| {
            let request = request.as_ref()?;
            known.iter().find(|pilot| pilot.request.is(request))?.outcome.clone()
        });
        let found = found.collect();
        if !missing.is_empty() {
            let excess = known.len().saturating_sub(MOST_PILOTS);
            known.drain(..excess);
            *lock() = known;
        }
        found
    }

    /// The outcome of one request.
    ///
    /// # Errors
    /// [`SimulationError`] when the hit cannot be set up, or not integrated at any step tried.
    pub fn run_one(&self, request: &Request) -> Result<Controlled, SimulationError> {
        let lost = || DynamicsError::InstructionSet { set: self.batch.instructions };
        self.run(std::slice::from_ref(request)).pop().unwrap_or_else(|| Err(lost().into()))
    }

    /// Refines the tasks of `numbers` until each is done.
    fn refine(&self, tasks: &mut [Task<'_>], mut numbers: Vec<usize>) {
        let all = numbers.clone();
        while !numbers.is_empty() {
            self.integrate_fine(tasks, &numbers);
            let compared =
                |n: &&usize| matches!(tasks[**n].fine, Some(Ok(_))) && tasks[**n].other.is_none();
            let open: Vec<usize> = numbers.iter().filter(compared).copied().collect();
            let others = self.respond(tasks, &open, |task| task.hit_at(task.other_level()));
            for (&n, other) in open.iter().zip(others) {
                tasks[n].other = Some(other);
            }
            let lacking = |n: &usize| tasks[*n].lacks_truncation();
            let open: Vec<usize> = numbers.iter().copied().filter(lacking).collect();
            let fewer = self.respond(tasks, &open, |task| task.hit_at(task.fewer_level()));
            for (n, fewer) in open.into_iter().zip(fewer) {
                tasks[n].fewer = Some(fewer);
            }
            let suspect = numbers.iter().copied().filter(|&n| tasks[n].is_suspect()).collect();
            for (n, twin) in self.twins(tasks, suspect) {
                if let (Some(Ok(fine)), Ok(twin)) = (&tasks[n].fine, twin) {
                    let parted = parting(&fine.record, &twin.record);
                    tasks[n].parted = parted.map(|from| (from, twin.observables));
                }
            }
            for &n in &numbers {
                tasks[n].judge();
            }
            numbers.retain(|&n| tasks[n].done.is_none());
        }
        self.compare_with_twins(tasks, &all);
    }

    fn integrate_fine(&self, tasks: &mut [Task<'_>], numbers: &[usize]) {
        let open: Vec<usize> =
            numbers.iter().copied().filter(|&n| tasks[n].fine.is_none()).collect();
        let responses = self.respond(tasks, &open, |task| task.hit_at(task.level));
        for (n, response) in open.into_iter().zip(responses) {
            tasks[n].fine = Some(response);
        }
    }

    /// Marks responses that did not converge where they depend on rounding.
    fn compare_with_twins(&self, tasks: &mut [Task<'_>], numbers: &[usize]) {
        let doubtful = |n: &usize| match &tasks[*n].done {
            Some(Ok(Controlled { observables, .. })) => {
                let known = observables.get(Quantity::SensitiveFrom, None).is_some();
                !known && !observables.estimate().is_some_and(ErrorEstimate::is_reached)
            }
            _ => false,
        };
        let doubtful = numbers.iter().copied().filter(doubtful).collect();
        for (n, twin) in self.twins(tasks, doubtful) {
            let Some(Ok(done)) = &mut tasks[n].done else { continue };
            match twin {
                Ok(twin) => {
                    if let Some(time) = parting(&done.record, &twin.record) {
                        done.observables.set_sensitive(time, Some(&twin.observables));
                    }
                }
                // One of the two went beyond all bounds.
                Err(_) => done.observables.set_sensitive(0.0, None),
            }
        }
    }

    /// Responses of tasks at their level to slightly larger forces.
    fn twins(
        &self,
        tasks: &[Task<'_>],
        numbers: Vec<usize>,
    ) -> Vec<(usize, Result<Response, SimulationError>)> {
        let twins = self.respond(tasks, &numbers, |task| {
            task.hit(task.level, perturbed(&task.request.excitation))
        });
        numbers.into_iter().zip(twins).collect()
    }

    /// Responses to a hit of each task of `numbers`.
    fn respond(
        &self,
        tasks: &[Task<'_>],
        numbers: &[usize],
        hit: impl for<'a, 'b> Fn(&'a Task<'b>) -> Result<HitSimulation, SimulationError>,
    ) -> Vec<Result<Response, SimulationError>> {
        let (mut hits, mut of) = (Vec::new(), Vec::new());
        let mut responses: Vec<Result<Response, SimulationError>> = Vec::new();
        let mut failed = Vec::new();
        for &n in numbers {
            match hit(&tasks[n]) {
                Ok(hit) => {
                    hits.push(hit);
                    of.push(n);
                    failed.push(None);
                }
                Err(error) => failed.push(Some(error)),
            }
        }
        let prepared = |index: usize| &tasks[of[index]].request.prepared;
        let decimation = |index: usize, step: f64| {
            let natural = prepared(index).at_rest.natural_frequency_hz;
            self.extractor.decimation(natural, self.kept_hz, step)
        };
        let mut records = self.batch.run(&hits, &decimation).into_iter();
        let mut hits = hits.into_iter().enumerate();
        for error in failed {
            responses.push(match error {
                Some(error) => Err(error),
                None => match (records.next(), hits.next()) {
                    (Some(record), Some((index, hit))) => {
                        record.map_err(SimulationError::from).and_then(|record| {
                            let observables =
                                self.extractor.observables(prepared(index), &hit, &record)?;
                            Ok(Response { hit, record, observables })
                        })
                    }
                    _ => Err(DynamicsError::InstructionSet { set: self.batch.instructions }.into()),
                },
            });
        }
        responses
    }
}

/// The force of a response that shows dependence on rounding.
pub(crate) fn perturbed(excitation: &Excitation) -> Excitation {
    excitation.scaled(1.0 + PERTURBATION)
}

/// Sample from which on two displacements differ.
pub(crate) fn parting_sample(a: &[f64], b: &[f64]) -> Option<usize> {
    let largest = a.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    a.iter().zip(b).position(|(a, b)| (a - b).abs() > PARTED * largest)
}

/// Time \[s\] from which on the displacements of two responses differ.
fn parting(a: &HitResponse, b: &HitResponse) -> Option<f64> {
    let sample = parting_sample(&a.displacement, &b.displacement)?;
    // The filter delays by half its length.
    let steps = (sample * a.decimation.factor).saturating_sub(a.decimation.taps.len() / 2);
    Some(steps as f64 * a.step)
}
