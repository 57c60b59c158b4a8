//! Modal responses to an accuracy: step and modes are refined until the estimated errors are small
//! enough.
//!
//! Hits of one structure and one shape of force have like relative errors while contact holds. So
//! they are estimated once, for a pilot with the next power of two above the peak of a hit, and
//! hits take the step, the modes and the errors of their pilot; their results do not depend on
//! other hits. A hit that loses contact is refined by itself. A response that does not converge is
//! integrated once more under a force larger by 1e-12: if the two part, it depends on rounding.

use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{Batch, DynamicsError, Excitation, HitResponse, HitSimulation, Modal};
use asperity_law::LawError;

use crate::accuracy::ErrorEstimate;
use crate::error::StudyError;
use crate::observable_extractor::ObservableExtractor;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;

/// Halvings of the first step before an accuracy counts as not reached.
const MOST_REFINEMENTS: i32 = 7;

/// Steps of a response beyond which it is not refined any more.
const MOST_STEPS: f64 = 2e6;

/// Most modes of a body: those too fast for the step count as flexibility anyway.
const MOST_MODES: usize = 512;

/// Energy residual above which a response is refined, whatever its estimated errors.
const COARSE_RESIDUAL: f64 = 5e-4;

/// Relative change of the force of the twin that shows dependence on rounding.
const PERTURBATION: f64 = 1e-12;

/// Difference of two displacements, over the largest, from which on they count as parted.
const PARTED: f64 = 1e-3;

/// A modal hit to be carried out to the accuracy of its scenario.
#[derive(Debug, Clone)]
pub(crate) struct Request {
    pub(crate) prepared: Arc<PreparedScenario>,
    pub(crate) excitation: Excitation,
}

/// A hit with the step and the modes that were chosen, and its observables with their errors.
#[derive(Debug)]
pub(crate) struct Controlled {
    pub(crate) hit: HitSimulation,
    pub(crate) observables: Observables,
    /// Modes of each body.
    pub(crate) counts: Vec<usize>,
    record: HitResponse,
}

/// Integrates hits to the accuracy of their scenarios.
#[derive(Debug)]
pub(crate) struct ErrorControl {
    batch: Batch,
    extractor: ObservableExtractor,
    pilots: Mutex<Vec<Pilot>>,
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

/// A response and its observables.
#[derive(Debug)]
struct Response {
    hit: HitSimulation,
    record: HitResponse,
    observables: Observables,
}

fn contact_is_lost(record: &HitResponse) -> bool {
    record.contacts.iter().any(|contact| contact.lost > 0.0)
}

/// A request on its way.
#[derive(Debug)]
struct Task<'a> {
    request: &'a Request,
    /// Modes of each body, and step \[s\], of the first level.
    counts: Vec<usize>,
    first_step: f64,
    duration: f64,
    /// True if the scenario gives the step, or the modes.
    step_is_given: bool,
    modes_are_given: bool,
    level: Level,
    fine: Option<Result<Response, StudyError>>,
    /// The response that the fine one is compared with, of another step; and the one, of fewer
    /// modes, that the modes are judged by.
    other: Option<Result<Response, StudyError>>,
    fewer: Option<Result<Response, StudyError>>,
    /// Errors by the truncation of modes, of a response with so many.
    truncation: Option<(usize, ErrorEstimate)>,
    done: Option<Result<Controlled, StudyError>>,
}

/// Halvings of the first step, and doublings of the first modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
struct Level {
    step: i32,
    modes: i32,
}

impl<'a> Task<'a> {
    fn new(request: &'a Request) -> Result<Self, StudyError> {
        let prepared = &request.prepared;
        let modal = prepared.modal().unwrap_or_default();
        let hit = prepared.hit(&modal, request.excitation.clone())?;
        Ok(Self {
            request,
            counts: first_counts(prepared.mode_counts(&modal, &request.excitation)?, &modal),
            first_step: hit.first_step()?.0,
            duration: hit.duration,
            step_is_given: modal.step.is_some(),
            modes_are_given: modal.modes_per_body.is_some(),
            level: Level::default(),
            fine: None,
            other: None,
            fewer: None,
            truncation: None,
            done: None,
        })
    }

    /// Modes of each body at a level: the rigid one always, of the elastic ones 0, 1, 3, 7, ...
    fn counts_at(&self, level: Level) -> Vec<usize> {
        let factor = f64::from(level.modes).exp2();
        let modes = |&count: &usize| ((count as f64 * factor) as usize).clamp(1, MOST_MODES);
        self.counts.iter().map(modes).collect()
    }

    fn hit(&self, level: Level, excitation: Excitation) -> Result<HitSimulation, StudyError> {
        Ok(HitSimulation {
            model: self.request.prepared.modal_model(&self.counts_at(level))?,
            excitation,
            duration: self.duration,
            step: Some(self.first_step / f64::from(level.step).exp2()),
        })
    }

    /// The hit at a level, if there is one.
    fn hit_at(&self, level: Level) -> Result<HitSimulation, StudyError> {
        self.hit(level, self.request.excitation.clone())
    }

    /// Level of the response that the fine one is compared with: of twice the step, or of half the
    /// step where the step is given.
    fn other_level(&self) -> Level {
        let change = if self.step_is_given { 1 } else { -1 };
        Level { step: self.level.step + change, ..self.level }
    }

    /// Level of the response that the truncation of modes is judged by: of fewer modes.
    fn fewer_level(&self) -> Level {
        Level { modes: self.level.modes - 1, ..self.level }
    }

    /// True if the truncation of the fine response's modes is not judged yet.
    fn lacks_truncation(&self) -> bool {
        let Some(Ok(fine)) = &self.fine else { return false };
        let known = self.truncation.as_ref().map(|(modes, _)| *modes);
        !self.modes_are_given && known != Some(fine.record.modes)
    }

    fn may_halve(&self) -> bool {
        let steps = self.duration / self.first_step * f64::from(self.level.step + 1).exp2();
        !self.step_is_given && self.level.step < MOST_REFINEMENTS && steps <= MOST_STEPS
    }

    fn may_add_modes(&self) -> bool {
        let more = Level { modes: self.level.modes + 1, ..self.level };
        !self.modes_are_given
            && self.level.modes < MOST_REFINEMENTS
            && self.counts_at(more) != self.counts_at(self.level)
    }

    fn accuracy(&self) -> f64 {
        self.request.prepared.assembly.accuracy
    }

    /// Errors by the step.
    fn step_errors(&self, fine: &Response) -> ErrorEstimate {
        let Some(Ok(other)) = &self.other else {
            return ErrorEstimate::unknown(&fine.observables, self.accuracy());
        };
        // Of second order while contact holds, of first where it is lost.
        let lost = contact_is_lost(&fine.record) || contact_is_lost(&other.record);
        let divisor = match (self.step_is_given, lost) {
            (false, false) => 3.0,
            (false, true) => 1.0,
            (true, false) => 0.75,
            (true, true) => 0.5,
        };
        ErrorEstimate::new(&fine.observables, &other.observables, divisor, self.accuracy())
    }

    /// Errors by the truncation of modes, of third order in their number.
    fn truncation_errors(&self, fine: &Response) -> ErrorEstimate {
        match &self.fewer {
            None => ErrorEstimate::none(&fine.observables, self.accuracy()),
            Some(Ok(fewer)) => {
                let lost = contact_is_lost(&fewer.record) || contact_is_lost(&fine.record);
                let divisor = if lost { 1.0 } else { 3.0 };
                ErrorEstimate::new(&fine.observables, &fewer.observables, divisor, self.accuracy())
            }
            Some(Err(_)) => ErrorEstimate::unknown(&fine.observables, self.accuracy()),
        }
    }

    /// Accepts the fine response with the errors of its pilot if contact held; begins anew otherwise.
    fn follow(&mut self, pilot: &(Level, Observables)) {
        let fine = self.fine.take();
        if let (Some(Ok(fine)), Some(estimate)) = (fine, pilot.1.estimate())
            && !contact_is_lost(&fine.record)
            && fine.record.energy.residual_relative() <= COARSE_RESIDUAL
        {
            let estimate = estimate.transferred(&pilot.1, &fine.observables);
            self.done = Some(Ok(accepted(fine, self.counts_at(self.level), estimate)));
        } else {
            self.level = Level::default();
        }
    }

    /// Accepts the fine response, or prepares the next level.
    fn judge(&mut self) {
        match self.fine.take() {
            None => {}
            Some(Err(error)) if self.may_halve() && is_mended_by_refinement(&error) => {
                self.level.step += 1;
                self.other = None;
            }
            Some(Err(StudyError::Dynamics(source))) if self.level.step > 0 => {
                let step_s = self.first_step / f64::from(self.level.step).exp2();
                self.done = Some(Err(StudyError::NotResolved { step_s, source }));
            }
            Some(Err(error)) => self.done = Some(Err(error)),
            Some(Ok(fine)) => {
                let by_step = self.step_errors(&fine);
                let by_modes = match (self.truncation.take(), &self.fewer) {
                    (Some((_, known)), None) => known,
                    _ => self.truncation_errors(&fine),
                };
                self.fewer = None;
                tracing::debug!(
                    step_s = fine.record.step,
                    modes = fine.record.modes,
                    error_by_step = by_step.relative,
                    of = ?by_step.worst,
                    error_by_modes = by_modes.relative,
                    of_modes = ?by_modes.worst,
                    "errors estimated"
                );
                let half = 0.5 * self.accuracy();
                let residual = fine.record.energy.residual_relative();
                let halve =
                    self.may_halve() && !(by_step.relative <= half && residual <= COARSE_RESIDUAL);
                // An error that is not a number is not small.
                let truncated = by_modes.relative.is_nan() || by_modes.relative > half;
                let add_modes = self.may_add_modes() && truncated;
                if add_modes {
                    self.level.modes += 1;
                    self.level.step += i32::from(halve);
                    self.other = None;
                } else if halve {
                    self.level.step += 1;
                    self.truncation = Some((fine.record.modes, by_modes));
                    self.other = Some(Ok(fine));
                } else {
                    let counts = self.counts_at(self.level);
                    self.done = Some(Ok(accepted(fine, counts, by_step.plus(&by_modes))));
                }
            }
        }
    }
}

/// Modes of each body at the first level: at least one elastic, whose share can be seen.
fn first_counts(mut counts: Vec<usize>, modal: &Modal) -> Vec<usize> {
    if modal.modes_per_body.is_none() {
        for count in &mut counts {
            *count = (*count).max(2);
        }
    }
    counts
}

fn accepted(response: Response, counts: Vec<usize>, estimate: ErrorEstimate) -> Controlled {
    Controlled {
        counts,
        record: response.record,
        observables: response.observables.with_estimate(estimate),
        hit: response.hit,
    }
}

fn is_mended_by_refinement(error: &StudyError) -> bool {
    let StudyError::Dynamics(error) = error else { return false };
    match error {
        DynamicsError::Unstable { .. } | DynamicsError::Coarse { .. } => true,
        DynamicsError::Law { source, .. } => matches!(source, LawError::Unresolved { .. }),
        _ => false,
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
        Some(Self { prepared: Arc::clone(&self.prepared), excitation: unit.scaled(octave) })
    }

    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.prepared, &other.prepared) && self.excitation == other.excitation
    }
}

impl ErrorControl {
    pub(crate) fn new(batch: Batch) -> Self {
        let (extractor, pilots) = (ObservableExtractor::default(), Mutex::default());
        Self { batch, extractor, pilots }
    }

    /// The outcome of each request, in order; none depends on the others.
    pub(crate) fn run(&self, requests: &[Request]) -> Vec<Result<Controlled, StudyError>> {
        let (mut tasks, mut places): (Vec<Task<'_>>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut outcomes: Vec<Option<Result<Controlled, StudyError>>> = Vec::new();
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
            Err(StudyError::from(DynamicsError::InstructionSet { set }))
        };
        outcomes.into_iter().map(|outcome| outcome.unwrap_or_else(lost)).collect()
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
            if let Ok(task) = Task::new(request) {
                pilots.push(task);
                of.push(request);
            }
        }
        let all = (0..pilots.len()).collect();
        self.refine(&mut pilots, all);
        for (task, request) in pilots.into_iter().zip(of) {
            let outcome = match task.done {
                Some(Ok(done)) if !contact_is_lost(&done.record) && done.is_reached() => {
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
    pub(crate) fn run_one(&self, request: &Request) -> Result<Controlled, StudyError> {
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
            Some(Ok(done)) => !done.is_reached(),
            _ => false,
        };
        let doubtful: Vec<usize> = numbers.iter().copied().filter(doubtful).collect();
        let twins = self.respond(tasks, &doubtful, |task| {
            task.hit(task.level, perturbed(&task.request.excitation))
        });
        for (n, twin) in doubtful.into_iter().zip(twins) {
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

    /// Responses to a hit of each task of `numbers`.
    fn respond(
        &self,
        tasks: &[Task<'_>],
        numbers: &[usize],
        hit: impl for<'a, 'b> Fn(&'a Task<'b>) -> Result<HitSimulation, StudyError>,
    ) -> Vec<Result<Response, StudyError>> {
        let (mut hits, mut of) = (Vec::new(), Vec::new());
        let mut responses: Vec<Result<Response, StudyError>> = Vec::new();
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
            self.extractor.decimation(natural, 0.0, step)
        };
        let mut records = self.batch.run(&hits, &decimation).into_iter();
        let mut hits = hits.into_iter().enumerate();
        for error in failed {
            responses.push(match error {
                Some(error) => Err(error),
                None => match (records.next(), hits.next()) {
                    (Some(record), Some((index, hit))) => {
                        record.map_err(StudyError::from).and_then(|record| {
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
