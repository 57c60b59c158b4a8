//! One run request while its step and modes are refined.
//!
//! At each level the response is compared with two others: one of another step, which shows the error by
//! the step, and one of fewer modes, which shows the error by the modes left out. The response is
//! accepted when all errors together are as small as was asked for; otherwise the next level has half the
//! step, twice the modes, or both.

use asperity_dynamics::{COARSE_RESIDUAL, ContactExtremes, TransientCase};

use super::Reference;
use super::converged_run::{ConvergedRun, RunRequest};
use super::level::{FirstLevel, Level};
use super::response::{Response, ResponseKind, contact_is_lost, perturbed};
use super::work::{MOST_WORK, MOST_WORK_ASKED, MOST_WORK_PRESSED, Work};
use asperity_structure::LoadCase;

use crate::accuracy::ErrorEstimate;
use crate::assemble::DEFAULT_ACCURACY;
use crate::error::SimulationError;
use crate::observables::Observables;
use crate::quantity::Quantity;

/// Halvings of the first step before an accuracy counts as not reached.
const MOST_REFINEMENTS: i32 = 7;

/// Error of the contact pressures within a step, over the largest, of the first level at steps of its
/// own; of each further level a sixteenth.
const FIRST_TOLERANCE: f64 = 4e-6;

/// Halvings of equal steps before steps of a response's own may take their place while contact holds.
const LEAST_EQUAL_HALVINGS: i32 = 2;

/// Refinements of that tolerance before an accuracy counts as not reached: beyond, rounding counts.
const MOST_TOLERANCES: i32 = 3;

/// Difference of two times without contact, over the period of the lowest natural frequency, up to which
/// losses of contact are alike.
const LIKE_LOSS: f64 = 0.1;

/// Errors by equal steps over those by steps of twice the length, at least: the method is of second order.
const HALF_STEP: f64 = 0.25;

/// Errors by the truncation of modes over those of half their number, at least: they are of third order.
const TWICE_MODES: f64 = 0.125;

/// Successive levels without a response after which the run fails.
const MOST_FAILURES: usize = 4;

/// Shares of the accuracy for the errors by the step, by the number of modes, and by modes too fast for
/// the step. The rest is for the errors by the tables of the laws.
const STEP_SHARE: f64 = 0.45;
const COUNT_SHARE: f64 = 0.35;
const FAST_SHARE: f64 = 0.1;

/// Share for the errors by the step and by the number of modes together, at steps of its own.
const OWN_STEPS_SHARE: f64 = 0.9;

/// A response counts as far from converged after this number of halvings of equal steps, and at steps of its own at once,
/// with an estimated error of this multiple of the accuracy.
const SUSPECT_REFINEMENTS: i32 = 2;
const SUSPECT_ERROR: f64 = 10.0;

/// Lengths of the steps of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StepLengths {
    /// Equal, until contact is seen to be lost, or equal ones are slow.
    Equal,
    /// Equal in any case: the step is given, there is friction, or steps of its own have failed or not reached the accuracy.
    AlwaysEqual,
    /// Of its own, short where contact opens and closes.
    Own,
}

/// A request, its level, and the responses at it.
#[derive(Debug)]
pub(super) struct Task<'a> {
    pub(super) request: &'a RunRequest,
    first: FirstLevel,
    duration: f64,
    /// The runs whose level is the level of this run.
    serves: Option<Reference>,
    pub(super) level: Level,
    steps: StepLengths,
    /// Level at which slow equal steps were left for steps of its own.
    slow: Option<Level>,
    /// Successive levels without a response.
    failures: usize,
    pub(super) fine: Option<Result<Response, SimulationError>>,
    /// The response of another step, and the response of fewer modes or more, which show the errors of the fine
    /// response.
    pub(super) other: Option<Result<Response, SimulationError>>,
    pub(super) fewer: Option<Result<Response, SimulationError>>,
    /// Errors by equal steps of twice the length.
    by_longer_step: Option<ErrorEstimate>,
    /// Errors by the truncation of modes at half their number.
    by_half_modes: Option<ErrorEstimate>,
    /// Errors by the truncation of modes, with the number of modes of the response.
    truncation: Option<(usize, ErrorEstimate)>,
    /// The time from which on the fine response and its perturbed run differ, and the observables of the
    /// perturbed run.
    pub(super) diverged: Option<(f64, Observables)>,
    pub(super) done: Option<Result<ConvergedRun, SimulationError>>,
}

/// Step, modes and observables of a run that is done.
#[derive(Debug)]
pub(super) struct Chosen {
    first: FirstLevel,
    level: Level,
    steps: StepLengths,
    observables: Observables,
}

impl<'a> Task<'a> {
    pub(super) fn new(request: &'a RunRequest) -> Result<Self, SimulationError> {
        let prepared = &request.prepared;
        let modal = prepared.modal().unwrap_or_default();
        let mut case = prepared.case(&modal, request.load.clone())?;
        case.sensor = request.sensor;
        case.duration = request.duration.unwrap_or(case.duration);
        Ok(Self {
            request,
            first: FirstLevel::new(
                prepared.mode_counts(&modal, &request.load)?,
                case.first_step()?.0,
                &modal,
            ),
            duration: case.duration,
            serves: None,
            level: Level::default(),
            steps: if modal.step.is_some() || case.model.preloaded().friction().is_some() {
                StepLengths::AlwaysEqual
            } else {
                StepLengths::Equal
            },
            slow: None,
            failures: 0,
            fine: None,
            other: None,
            fewer: None,
            by_longer_step: None,
            by_half_modes: None,
            truncation: None,
            diverged: None,
            done: None,
        })
    }

    /// Modes of each body at the level.
    pub(super) fn counts(&self) -> Vec<usize> {
        self.first.counts_at(self.level)
    }

    /// The transient case at a level under `load`.
    fn case(&self, level: Level, load: LoadCase) -> Result<TransientCase, SimulationError> {
        let tolerance = self.varies_steps().then(|| FIRST_TOLERANCE / 16.0_f64.powi(level.step));
        let counts = self.first.counts_at(level);
        Ok(TransientCase {
            model: self.request.prepared.modal_model(&counts, load.port())?,
            load,
            sensor: self.request.sensor,
            duration: self.duration,
            // At steps of its own the longest, of the rest after contact was lost.
            step: Some(self.first.step_at(level)),
            tolerance,
        })
    }

    /// A run whose level and errors other runs take.
    pub(super) fn reference(
        request: &'a RunRequest,
        kind: Reference,
    ) -> Result<Self, SimulationError> {
        Ok(Self { serves: Some(kind), ..Self::new(request)? })
    }

    /// True for the reference run of an octave, of no use where contact is lost.
    fn is_of_octave(&self) -> bool {
        self.serves == Some(Reference::Octave)
    }

    /// True for a response that loses contact at equal steps and may have steps of its own.
    fn is_open_at_equal_steps(&self) -> bool {
        let Some(Ok(fine)) = &self.fine else { return false };
        fine.loses_contact() && self.steps == StepLengths::Equal
    }

    /// Begins anew at steps of its own if contact is lost; a reference run, of no use then, is done.
    pub(super) fn vary_steps_if_open(&mut self) {
        if !self.is_open_at_equal_steps() {
            return;
        }
        if self.is_of_octave() {
            self.accept_or_refine();
        } else {
            self.begin_anew(StepLengths::Own, self.first.varied());
        }
    }

    /// Begins anew at equal steps: those after the slow ones that were left, if any were.
    fn return_to_equal_steps(&mut self) {
        let next = |slow: Level| Level { step: slow.step + 1, ..slow };
        let level = self.slow.take().map_or_else(Level::default, next);
        self.begin_anew(StepLengths::AlwaysEqual, level);
    }

    fn begin_anew(&mut self, steps: StepLengths, level: Level) {
        (self.steps, self.level, self.fine) = (steps, level, None);
        (self.other, self.fewer, self.truncation) = (None, None, None);
        (self.by_longer_step, self.by_half_modes) = (None, None);
    }

    /// True if the fine response is compared with one of half the step, false for one of twice the step.
    /// Half the step costs more, and is worth it where the longer step then serves many runs.
    fn compares_with_half(&self) -> bool {
        let serves = if self.varies_steps() {
            // Beyond the last tolerance rounding counts.
            self.serves.is_some() && self.level.step < MOST_TOLERANCES
        } else {
            self.is_of_octave()
        };
        serves || self.first.step_is_given
    }

    /// Responses that are missing at the level. Before the fine response those that it is compared with are among
    /// them, unless it may not be of use.
    pub(super) fn missing(&self) -> impl Iterator<Item = ResponseKind> + use<> {
        let known = self.truncation.as_ref().map(|(modes, _)| *modes);
        let (fine, compared, modes) = match &self.fine {
            None => (true, self.steps != StepLengths::Equal && self.failures == 0, known),
            Some(Ok(fine)) => (false, true, Some(fine.record.modes)),
            Some(Err(_)) => (false, false, known),
        };
        let other = compared && self.other.is_none();
        let estimated = known.is_some() && known == modes;
        let fewer = compared && !estimated && self.fewer.is_none();
        let wanted = [
            (ResponseKind::Fine, fine),
            (ResponseKind::Other, other),
            (ResponseKind::Fewer, fewer),
        ];
        wanted.into_iter().filter_map(|(kind, is_missing)| is_missing.then_some(kind))
    }

    /// The transient case of a response.
    pub(super) fn case_of(&self, kind: ResponseKind) -> Result<TransientCase, SimulationError> {
        let step = self.level.step + if self.compares_with_half() { 1 } else { -1 };
        let load = self.request.load.clone();
        match kind {
            ResponseKind::Fine => self.case(self.level, load),
            ResponseKind::Other => self.case(Level { step, ..self.level }, load),
            ResponseKind::Fewer => self.case(self.first.of_other_modes(self.level), load),
            ResponseKind::Perturbed => self.case(self.level, perturbed(&load)),
        }
    }

    /// Takes in a response.
    pub(super) fn take(&mut self, kind: ResponseKind, response: Result<Response, SimulationError>) {
        let of_kind = match kind {
            ResponseKind::Fine => &mut self.fine,
            ResponseKind::Other => &mut self.other,
            ResponseKind::Fewer => &mut self.fewer,
            ResponseKind::Perturbed => return,
        };
        *of_kind = Some(response);
    }

    /// True if the response may depend on rounding: it loses contact, and is far from converged.
    pub(super) fn is_suspect(&self) -> bool {
        let Some(Ok(fine)) = &self.fine else { return false };
        fine.loses_contact() && self.is_far_from_converged(fine)
    }

    fn is_far_from_converged(&self, fine: &Response) -> bool {
        (self.varies_steps() || self.level.step >= SUSPECT_REFINEMENTS)
            && self.step_errors(fine).relative > SUSPECT_ERROR * self.accuracy()
    }

    fn varies_steps(&self) -> bool {
        self.steps == StepLengths::Own
    }

    /// True if half the step is within the limits of work.
    fn may_halve(&self, work: &Work) -> bool {
        let most = if self.varies_steps() { MOST_TOLERANCES } else { MOST_REFINEMENTS };
        !self.first.step_is_given && self.level.step < most && work.may_double_steps()
    }

    /// True if twice the modes are within the limits of work.
    fn may_add_modes(&self, work: &Work) -> bool {
        let more = Level { modes: self.level.modes + 1, ..self.level };
        !self.first.modes_are_given
            && self.level.modes < MOST_REFINEMENTS
            && work.may_double_modes()
            && self.first.counts_at(more) != self.counts()
    }

    /// True for a response at equal steps with this error by the step, for which steps of its own take less time.
    fn is_slow(&self, work: &Work, error: f64) -> bool {
        self.steps == StepLengths::Equal
            && self.level.step >= LEAST_EQUAL_HALVINGS
            && work.is_slow(error / (STEP_SHARE * self.accuracy()))
    }

    /// Work of a response, or of the level without one.
    fn work(&self, fine: Option<&Response>) -> Work {
        let (mut taken, mut modes, mut most) = (0, 1, MOST_WORK);
        if let Some(fine) = fine {
            taken = fine.record.integrated_steps;
            // Equal steps that took over a response have fewer modes than its own, of which the work is.
            modes =
                if self.varies_steps() { self.counts().iter().sum() } else { fine.record.modes };
            if self.varies_steps() && !fine.loses_contact() {
                most = MOST_WORK_PRESSED;
            }
        }
        if self.accuracy() < DEFAULT_ACCURACY {
            most = MOST_WORK_ASKED;
        }
        let steps = (self.duration / self.first.step_at(self.level)).max(taken as f64);
        Work { steps, modes: modes as f64, most }
    }

    fn accuracy(&self) -> f64 {
        self.request.prepared.assembly.accuracy
    }

    /// Errors by the step.
    fn step_errors(&self, fine: &Response) -> ErrorEstimate {
        let Some(Ok(other)) = &self.other else {
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        };
        let [finer, coarser] =
            if self.compares_with_half() { [other, fine] } else { [fine, other] };
        if finer.record.is_of_second_order && !coarser.record.is_of_second_order {
            // The error of the finer one may be the larger.
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        }
        // Of second order while contact holds; of first where it is lost, or friction begins to slip. At steps of its own
        // half the difference from a coarser one is a bound by experience; twice that from a finer one bounds near runs too.
        let kinks = fine.loses_contact() || other.loses_contact() || fine.has_friction();
        let divisor = match (self.compares_with_half(), kinks) {
            (false, _) if self.varies_steps() => 2.0,
            (true, _) if self.varies_steps() => 0.5,
            (false, false) => 3.0,
            (false, true) => 1.0,
            (true, false) => 0.75,
            (true, true) => 0.5,
        };
        let (found, other) = (fine.observables.all(), other.observables.all());
        let found = ErrorEstimate::new(found, other, divisor, self.accuracy());
        // Two responses with wrong phases may agree by chance, three hardly.
        match &self.by_longer_step {
            Some(longer) => found.larger(longer.scaled(HALF_STEP)),
            None => found,
        }
    }

    /// Keeps the errors by equal steps for the level of half the step.
    fn keep_step_errors(&mut self, by_step: &ErrorEstimate) {
        let is_known = by_step.relative.is_finite() && !self.varies_steps();
        self.by_longer_step = is_known.then(|| by_step.clone());
    }

    /// Errors by the truncation of modes, of third order in their number; with loss of contact or
    /// friction of no certain order, the whole difference.
    fn truncation_errors(&self, fine: &Response) -> ErrorEstimate {
        let Some(Ok(fewer)) = &self.fewer else {
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        };
        let kinks = fewer.loses_contact() || fine.loses_contact() || fine.has_friction();
        let [others, modes] = [fewer, fine].map(|response| response.record.modes);
        let divisor = if kinks || others > modes { 1.0 } else { 3.0 };
        let (found, other) = (fine.observables.all(), fewer.observables.all());
        let found = ErrorEstimate::new(found, other, divisor, self.accuracy());
        // Two may agree by chance here too, unless the modes that one lacks are too fast for the step anyway.
        match &self.by_half_modes {
            Some(half) if others != modes => found.larger(half.scaled(TWICE_MODES)),
            _ => found,
        }
    }

    /// Upper bound of the errors by modes that are too fast for the fine response and for the response of
    /// another step.
    fn fast_mode_errors(&self, fine: &Response) -> ErrorEstimate {
        if self.varies_steps() {
            // Steps are short until modes too fast for longer ones are at rest.
            return ErrorEstimate::of_share(fine.observables.all(), 0.0, self.accuracy());
        }
        let step = match &self.other {
            Some(Ok(other)) => other.record.step.min(fine.record.step),
            _ => fine.record.step,
        };
        let error = fine.case.error_of_fast_modes(step, &fine.record);
        ErrorEstimate::of_share(fine.observables.all(), error, self.accuracy())
    }

    /// Errors by the tables of the laws: their largest differences from the laws, over the ranges of
    /// pressure, are those of the forces.
    fn table_errors(&self, fine: &Response) -> ErrorEstimate {
        let Ok(errors) = fine.record.table_errors(&fine.case.model) else {
            return ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
        };
        let share = |(error, contact): (f64, &ContactExtremes)| {
            if error == 0.0 { 0.0 } else { error / (contact.pressure_max - contact.pressure_min) }
        };
        let shares = errors.into_iter().zip(&fine.record.contacts).map(share);
        let largest = shares.fold(0.0, f64::max);
        ErrorEstimate::of_share(fine.observables.all(), largest, self.accuracy())
    }

    /// Step and modes for other runs; none if the run does not serve them: it failed, did not reach the
    /// accuracy, or lost contact at equal steps.
    pub(super) fn chosen(self) -> Option<Chosen> {
        let done = self.done?.ok()?;
        let serves = done.is_reached()
            && done.observables.get(Quantity::SensitiveFrom, None).is_none()
            && (self.steps == StepLengths::Own || !contact_is_lost(&done.record.contacts));
        serves.then_some(Chosen {
            first: self.first,
            level: self.level,
            steps: self.steps,
            observables: done.observables,
        })
    }

    /// Takes the step and the modes of a reference run.
    pub(super) fn follow(&mut self, reference: &Chosen) {
        self.first = reference.first.clone();
        (self.level, self.steps) = (reference.level, reference.steps);
    }

    /// Accepts the fine response with the errors of its reference run if both are alike; begins anew
    /// otherwise.
    pub(super) fn accept_as(&mut self, reference: &Chosen) {
        if let (Some(Ok(fine)), Some(estimate)) =
            (self.fine.take(), reference.observables.estimate())
            && self.is_like(&fine, &reference.observables)
            && fine.record.energy.residual_relative() <= COARSE_RESIDUAL
        {
            let from = reference.observables.all();
            let estimate = estimate.transferred(from, fine.observables.all());
            self.done = Some(Ok(accepted(fine, self.counts(), estimate)));
        } else if let Ok(anew) = Self::new(self.request) {
            *self = anew;
        }
    }

    /// True if contact holds as in a reference run, or is lost about as long as there.
    fn is_like(&self, fine: &Response, reference: &Observables) -> bool {
        let natural = self.request.prepared.at_rest.natural_frequency_hz.unwrap_or(f64::INFINITY);
        let lost = |i: usize| reference.get(Quantity::ContactLost, Some(i)).unwrap_or(0.0);
        let contacts = || fine.record.contacts.iter().enumerate();
        if contacts().all(|(i, _)| lost(i) == 0.0) {
            return !fine.opens();
        }
        contacts().all(|(i, contact)| (contact.lost - lost(i)).abs() * natural <= LIKE_LOSS)
    }

    /// Begins anew at the steps of a draft if contact is lost.
    pub(super) fn vary_steps_of_draft(&mut self) {
        if self.is_open_at_equal_steps() {
            (self.steps, self.level, self.fine) =
                (StepLengths::Own, self.first.draft_varied(), None);
        }
    }

    /// The fine response as it is, without errors.
    pub(super) fn drafted(self) -> Option<Result<ConvergedRun, SimulationError>> {
        let counts = self.counts();
        let run = |Response { case, record, observables }| ConvergedRun {
            case,
            observables,
            counts,
            record,
        };
        Some(self.fine?.map(run))
    }

    /// Accepts the fine response, or prepares the next level.
    pub(super) fn accept_or_refine(&mut self) {
        match self.fine.take() {
            None => {}
            // Equal steps, however short, take what steps of its own do not.
            Some(Err(_)) if self.varies_steps() => self.return_to_equal_steps(),
            Some(Err(error))
                if self.failures < MOST_FAILURES
                    && self.may_halve(&self.work(None))
                    && error.is_mended_by_refinement() =>
            {
                self.failures += 1;
                self.level.step += 1;
                (self.other, self.fewer) = (None, None);
            }
            Some(Err(SimulationError::Dynamics(source))) if self.level.step > 0 => {
                let step_s = self.first.step_at(self.level);
                self.done = Some(Err(SimulationError::NotResolved { step_s, source }));
            }
            Some(Err(error)) => self.done = Some(Err(error)),
            // The runs of this reference are refined one by one.
            Some(Ok(fine))
                if self.is_of_octave() && (fine.opens() || self.is_far_from_converged(&fine)) =>
            {
                let estimate = ErrorEstimate::unknown(fine.observables.all(), self.accuracy());
                self.done = Some(Ok(accepted(fine, self.counts(), estimate)));
            }
            Some(Ok(fine)) => {
                self.failures = 0;
                let by_step = self.step_errors(&fine);
                let by_modes = match (self.truncation.take(), &self.fewer) {
                    (Some((_, known)), None) => known,
                    _ => self.truncation_errors(&fine),
                };
                self.fewer = None;
                let by_fast_modes = self.fast_mode_errors(&fine);
                tracing::debug!(
                    step_s = fine.record.step,
                    modes = fine.record.modes,
                    error_by_step = by_step.relative,
                    of = ?by_step.worst,
                    error_by_modes = by_modes.relative,
                    of_modes = ?by_modes.worst,
                    error_by_fast_modes = by_fast_modes.relative,
                    "errors estimated"
                );
                let residual = fine.record.energy.residual_relative();
                let accuracy = self.accuracy();
                let exceeds = |estimate: &ErrorEstimate, share: f64| {
                    estimate.relative.is_nan() || estimate.relative > share * accuracy
                };
                // At steps of its own, whose levels are far apart, one of the two errors may have what the other leaves.
                let left = |by_other: &ErrorEstimate| {
                    if self.varies_steps() {
                        OWN_STEPS_SHARE - by_other.relative / accuracy
                    } else {
                        0.0
                    }
                };
                let step_share = STEP_SHARE.max(left(&by_modes));
                let count_share = COUNT_SHARE.max(left(&by_step));
                let is_coarse = exceeds(&by_step, step_share)
                    || exceeds(&by_fast_modes, FAST_SHARE)
                    || residual.is_nan()
                    || residual > COARSE_RESIDUAL;
                let work = self.work(Some(&fine));
                let halve = is_coarse && self.may_halve(&work);
                let add_modes = exceeds(&by_modes, count_share) && self.may_add_modes(&work);
                let diverged = self.diverged.take();
                if halve {
                    self.keep_step_errors(&by_step);
                }
                if diverged.is_none() && halve && self.is_slow(&work, by_step.relative) {
                    let modes = self.level.modes + i32::from(add_modes);
                    self.slow = Some(Level { modes, ..self.level });
                    self.begin_anew(StepLengths::Own, Level { modes, ..self.first.varied() });
                } else if diverged.is_none() && add_modes {
                    let is_known = by_modes.relative.is_finite() && !self.varies_steps();
                    self.by_half_modes = is_known.then_some(by_modes);
                    self.level.modes += 1;
                    self.level.step += i32::from(halve);
                    self.other = None;
                } else if diverged.is_none() && halve {
                    self.level.step += 1;
                    self.truncation = Some((fine.record.modes, by_modes));
                    if self.compares_with_half() {
                        self.fine = self.other.take();
                    } else {
                        self.other = Some(Ok(fine));
                    }
                } else {
                    let by_tables = self.table_errors(&fine);
                    let estimate = by_step.plus(&by_modes).plus(&by_fast_modes).plus(&by_tables);
                    if self.slow.is_some() && !estimate.is_reached() && !fine.loses_contact() {
                        self.return_to_equal_steps();
                        return;
                    }
                    let mut done = accepted(fine, self.counts(), estimate);
                    if let Some((from, perturbed)) = diverged {
                        done.observables.set_sensitive(from, Some(&perturbed));
                    }
                    self.done = Some(Ok(done));
                }
            }
        }
    }
}

fn accepted(response: Response, counts: Vec<usize>, estimate: ErrorEstimate) -> ConvergedRun {
    ConvergedRun {
        counts,
        record: response.record,
        observables: response.observables.with_estimate(estimate),
        case: response.case,
    }
}
