//! Simulation of many cases, each at the step and with the tables that it needs.

use asperity_law::LawError;
use std::cmp::Ordering;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::decimation::Decimation;
use super::energy::ledger;
use super::lane_start::LaneStart;
use super::load_steps::LoadShapes;
use super::prepared_case::PreparedCase;
use super::ring_down;
use super::simd::block::CHUNK;
use super::simd::integrate::{BlockRun, Recording, room};
use super::simd::outcome::{Outcome, RunEnd};
use super::step_model::InterpolationChoice;
use super::step_size::{MOST_HALVINGS, Resolution};
use super::transient_case::{CaseResponse, TransientCase, first_table_exponents, pressure_at};
use super::variable_steps::{self, Ended, Midway};
use crate::error::balanced;
use crate::{ContactExtremes, DynamicsError, InstructionSet};

/// Integrates cases in the lanes of vectors, on the calling thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Batch {
    /// Vector instructions to run on.
    pub instructions: InstructionSet,
}

impl Default for Batch {
    fn default() -> Self {
        Self { instructions: InstructionSet::detected() }
    }
}

/// The next attempt at a case that is not finished.
#[derive(Debug, Clone)]
pub(super) struct Attempt {
    index: usize,
    pub(super) lane: PreparedCase,
    settings: Settings,
    decimation: Arc<Decimation>,
    /// The case where its own steps ended; none for a case from rest.
    midway: Option<Arc<Midway>>,
}

/// Settings of an attempt.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Settings {
    halvings: u32,
    /// Each contact's table ends at `2^exponent` \[Pa\] above rest.
    table_exponents: Vec<i32>,
    interpolation: InterpolationChoice,
    /// False once the rest of the response was found not to be linear.
    may_end_linearly: bool,
}

/// Doublings of the tabulated pressures before a case is given up. With the interpolation of highest
/// order fewer doublings count as an instability of the interpolation, which can arise where fast and
/// slow modes share a contact.
const MOST_DOUBLINGS: i32 = 16;
const MOST_DOUBLINGS_OF_HIGHEST_ORDER: i32 = 4;

/// Doublings of the tabulated pressures after a pressure beyond them.
const DOUBLINGS_AT_ONCE: i32 = 2;

impl Batch {
    /// Cases that are stepped side by side: batches of a multiple of this many waste no lane.
    pub fn room(&self) -> usize {
        room(self.instructions)
    }

    /// The responses to `cases`, in their order; a case that fails has its own error, and no response
    /// depends on the other cases.
    ///
    /// `decimation` gives the filter for the output of case `index` at a step \[s\].
    ///
    /// ```
    /// use asperity_dynamics::{Batch, Decimation, ModalModel, TransientCase};
    /// use asperity_mesh::Port;
    /// use asperity_structure::{LoadCase, TimeFunction};
    /// # use std::sync::Arc;
    /// # use asperity_law::Constant;
    /// # use asperity_mesh::{Body, Interface, ModeCount, Stack, Support};
    /// # use asperity_structure::{Damping, PreloadedStructure};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
    /// # let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
    /// # let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
    /// # let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
    /// let model = Arc::new(ModalModel::of_stack(&structure, &[3], Port::TOP, &[Port::TOP])?);
    /// let cases = [9.0, 32.0].map(|peak| TransientCase {
    ///     model: Arc::clone(&model),
    ///     load: LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, peak),
    ///     sensor: 0,
    ///     duration: 0.02,
    ///     step: None,
    ///     tolerance: None,
    /// });
    /// let all_steps = Decimation::every_step();
    /// let responses = Batch::default().run(&cases, &|_, _| Arc::clone(&all_steps));
    /// let highest = |n: usize| responses[n].as_ref().map_or(0.0, |case| case.contacts[0].pressure_max);
    /// assert!(highest(1) > highest(0));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Steps of their own
    ///
    /// A case with a [tolerance](TransientCase::tolerance) is integrated by itself while its contacts open and
    /// ring, in steps that are its first step halved as often as the tractions ask for; once no contact has been near opening
    /// for one and a half periods of the lowest natural frequency, it goes on at steps of that length, side by
    /// side with others. Within a step a traction is the cubic through
    /// its values and rates at both ends, and modes move exactly under it. The cubic of the step before,
    /// continued, misses the traction at the end of the step; the error of the cubic within the step, as this
    /// difference bounds it, is held below the tolerance times the largest traction so far. Where contact
    /// opens or closes, and the law has a corner or a jump, steps become short by themselves, and times
    /// without contact are found within them. Cases with friction are refused.
    pub fn run(
        &self,
        cases: &[TransientCase],
        decimation: &dyn Fn(usize, f64) -> Arc<Decimation>,
    ) -> Vec<Result<CaseResponse, DynamicsError>> {
        self.run_unless(cases, decimation, &AtomicBool::new(false))
    }

    /// As [`run`](Self::run); once `stop` is set, cases that are not finished end with
    /// [`DynamicsError::Stopped`]. It is looked at every 32 steps, at steps of their own once in each longest step.
    pub fn run_unless(
        &self,
        cases: &[TransientCase],
        decimation: &dyn Fn(usize, f64) -> Arc<Decimation>,
        stop: &AtomicBool,
    ) -> Vec<Result<CaseResponse, DynamicsError>> {
        let mut results: Vec<Option<Result<CaseResponse, DynamicsError>>> = vec![None; cases.len()];
        let mut preparation = Preparation { shapes: LoadShapes::default(), decimation };
        let mut attempts = Vec::with_capacity(cases.len());
        for (index, case) in cases.iter().enumerate() {
            let first = if case.tolerance.is_some() {
                self.own_steps((index, case), &mut preparation, true, stop)
            } else {
                preparation.first(index, case).map(Begun::Attempt)
            };
            match first {
                Ok(Begun::Attempt(attempt)) => attempts.push(attempt),
                Ok(Begun::Done(response)) => results[index] = Some(Ok(*response)),
                Err(error) => results[index] = Some(Err(error)),
            }
        }
        while !attempts.is_empty() {
            // Lanes of one model, one range of its tables and one sensor share their constants.
            attempts.sort_by(|a, b| {
                let settings = || a.settings.cmp(&b.settings);
                a.batch_order(b).then_with(settings).then(a.lane.sensor.cmp(&b.lane.sensor))
            });
            let mut again = Vec::new();
            for compatible in attempts.chunk_by(|a, b| a.batch_order(b) == Ordering::Equal) {
                for group in compatible.chunks(self.room()) {
                    let lanes: Vec<&PreparedCase> =
                        group.iter().map(|attempt| &attempt.lane).collect();
                    let recording = Recording::Decimated(&group[0].decimation);
                    let Some(outcomes) =
                        (BlockRun { lanes: &lanes, recording, stop }).run(self.instructions)
                    else {
                        continue;
                    };
                    for (attempt, outcome) in group.iter().zip(outcomes) {
                        let case = &cases[attempt.index];
                        if let (Some(midway), false) = (&attempt.midway, outcome.is_stopped()) {
                            let whole = || {
                                let case = (attempt.index, case);
                                self.own_steps(case, &mut preparation, false, stop)
                            };
                            let next = attempt.after_midway(midway, outcome).map_or_else(whole, Ok);
                            match next {
                                Ok(Begun::Attempt(next)) => again.push(next),
                                Ok(Begun::Done(done)) => results[attempt.index] = Some(Ok(*done)),
                                Err(error) => results[attempt.index] = Some(Err(error)),
                            }
                            continue;
                        }
                        match attempt.next(case, &outcome, &mut preparation) {
                            Ok(None) => {
                                results[attempt.index] = Some(Ok(attempt.record(outcome)));
                            }
                            Ok(Some(next)) => again.push(next),
                            Err(error) => results[attempt.index] = Some(Err(error)),
                        }
                    }
                }
            }
            attempts = again;
        }
        // No block ran where the machine lacks the instructions.
        let lost = || Err(DynamicsError::InstructionSet { set: self.instructions });
        results.into_iter().map(|result| result.unwrap_or_else(lost)).collect()
    }

    /// A case at steps of its own, to its end or to where equal steps take it on.
    fn own_steps(
        self,
        (index, case): (usize, &TransientCase),
        preparation: &mut Preparation<'_>,
        may_end_midway: bool,
        stop: &AtomicBool,
    ) -> Result<Begun, DynamicsError> {
        let (step, _) = case.first_step()?;
        let decimation = (preparation.decimation)(index, step);
        match variable_steps::respond(case, &decimation, self.instructions, may_end_midway, stop)? {
            Ended::Whole(response, _) => Ok(Begun::Done(response)),
            Ended::Midway(midway, _) => match preparation.first(index, case) {
                Ok(attempt) => Ok(Begun::Attempt(attempt.after(Arc::new(*midway)))),
                Err(_) => self.own_steps((index, case), preparation, false, stop),
            },
        }
    }
}

impl Settings {
    /// The first settings of a case at its first step.
    fn first(case: &TransientCase) -> Self {
        Self {
            halvings: 0,
            table_exponents: first_table_exponents(case),
            interpolation: InterpolationChoice::default(),
            may_end_linearly: true,
        }
    }

    /// The first settings at half the step.
    fn halved(&self, case: &TransientCase) -> Self {
        let may_end_linearly = self.may_end_linearly;
        Self { halvings: self.halvings + 1, may_end_linearly, ..Self::first(case) }
    }

    /// These settings with the tables of more pressures, after a pressure beyond them; none after
    /// too many.
    fn wider(&self, case: &TransientCase, end: RunEnd) -> Option<Self> {
        let first = first_table_exponents(case);
        let most = match self.interpolation {
            InterpolationChoice::HighestOrder => MOST_DOUBLINGS_OF_HIGHEST_ORDER,
            InterpolationChoice::Average => MOST_DOUBLINGS,
        };
        let mut wider = self.clone();
        let mut widen = |i: usize| {
            let may = self.table_exponents[i] - first[i] < most;
            wider.table_exponents[i] += if may { DOUBLINGS_AT_ONCE } else { 0 };
            may
        };
        let widened = match end {
            RunEnd::Beyond(i) => widen(i),
            // Below the table of a law that carries tension there are no numbers.
            RunEnd::NotFinite(..) => {
                let contacts = case.model.contacts().iter().enumerate();
                let bilateral = contacts.filter(|(_, one)| one.law().domain().is_bilateral());
                bilateral.filter(|(i, _)| widen(*i)).count() > 0
            }
            RunEnd::Done | RunEnd::Stopped(_) => false,
        };
        widened.then_some(wider)
    }
}

/// A case that is done, or to be attempted at equal steps.
enum Begun {
    Done(Box<CaseResponse>),
    Attempt(Attempt),
}

/// Preparation of attempts, with what they share.
pub(super) struct Preparation<'a> {
    pub(super) shapes: LoadShapes,
    /// The filter of case `index` at a step \[s\].
    pub(super) decimation: &'a dyn Fn(usize, f64) -> Arc<Decimation>,
}

impl Preparation<'_> {
    pub(super) fn first(
        &mut self,
        index: usize,
        case: &TransientCase,
    ) -> Result<Attempt, DynamicsError> {
        case.model.check(&case.load, case.sensor)?;
        self.attempt(index, case, Settings::first(case))
    }

    fn attempt(
        &mut self,
        index: usize,
        case: &TransientCase,
        settings: Settings,
    ) -> Result<Attempt, DynamicsError> {
        let Resolution { step, steps } = Resolution::halved(case, settings.halvings)?;
        let load = self.shapes.load_steps(&case.load, step, steps);
        let tables = (settings.table_exponents.as_slice(), case.table_tolerance(step)?);
        let tabulated = case.model.prepare(step, tables, settings.interpolation)?;
        let decimation = (self.decimation)(index, step);
        let start = || ring_down::start(&case.model, &load, step, steps);
        let tail = settings.may_end_linearly.then(start).flatten();
        let sensor = case.sensor;
        let tail = tail.and_then(|from| tabulated.linear_tail(sensor, (from, steps), &decimation));
        let (model, amplitude) = (Arc::clone(&case.model), case.load.amplitude());
        let lane =
            PreparedCase { model, tabulated, load, amplitude, sensor, steps, start: None, tail };
        Ok(Attempt { index, lane, settings, decimation, midway: None })
    }
}

impl Attempt {
    /// Orders attempts so that those that can be integrated together are neighbours; among them,
    /// those whose forces end together.
    fn batch_order(&self, other: &Self) -> Ordering {
        let key = |attempt: &Self| {
            let lane = &attempt.lane;
            let modes = lane.tabulated.step_model.modes.len();
            let steps = (lane.first_step(), lane.integrated(), lane.steps);
            let size = (steps, modes, lane.model.rows());
            (size, lane.model.is_dissipative())
        };
        // The lanes of a block share one filter.
        key(self).cmp(&key(other)).then_with(|| self.decimation.order(&other.decimation))
    }

    /// The next attempt after an outcome; none if the outcome is accepted.
    pub(super) fn next(
        &self,
        case: &TransientCase,
        outcome: &Outcome,
        preparation: &mut Preparation<'_>,
    ) -> Result<Option<Self>, DynamicsError> {
        let may_halve = case.step.is_none() && self.settings.halvings < MOST_HALVINGS;
        let mut at = |settings: Settings| preparation.attempt(self.index, case, settings);
        let (i, steps) = match outcome.end {
            RunEnd::Done => {
                if let Some(i) = not_finite(&self.lane, outcome) {
                    (i, self.lane.steps)
                } else {
                    let energy = ledger(&self.lane, outcome);
                    let residual = energy.residual_relative();
                    if may_halve && Resolution::too_coarse(residual) {
                        return at(self.settings.halved(case)).map(Some);
                    }
                    let ends_linearly = self.lane.tail.is_some();
                    if ends_linearly && !ring_down::is_straight(&self.lane, outcome, &energy) {
                        let whole = Settings { may_end_linearly: false, ..self.settings.clone() };
                        return at(whole).map(Some);
                    }
                    balanced(residual, self.lane.tabulated.step_model.step, "step")?;
                    return Ok(None);
                }
            }
            RunEnd::Stopped(steps) => return Err(DynamicsError::Stopped { steps }),
            RunEnd::Beyond(i) => (i, self.lane.steps),
            RunEnd::NotFinite(reached, i) => (i, reached.saturating_sub(8 * CHUNK)),
        };
        let wider = self.settings.wider(case, outcome.end);
        match wider.map(&mut at) {
            // Where no table reaches the pressures, the numbers grow beyond all bounds.
            None | Some(Err(DynamicsError::Law { source: LawError::Unresolved { .. }, .. })) => {}
            Some(next) => return next.map(Some),
        }
        if self.settings.interpolation == InterpolationChoice::HighestOrder {
            let interpolation = InterpolationChoice::Average;
            let table_exponents = first_table_exponents(case);
            at(Settings { table_exponents, interpolation, ..self.settings.clone() }).map(Some)
        } else if may_halve {
            at(self.settings.halved(case)).map(Some)
        } else {
            Err(DynamicsError::Unstable {
                time_s: steps as f64 * self.lane.tabulated.step_model.step,
                interface: self.lane.model.contacts()[i].name().to_owned(),
            })
        }
    }

    /// The attempt from where the steps of its own ended.
    pub(super) fn after(self, midway: Arc<Midway>) -> Self {
        let start = Some(Arc::clone(&midway.start));
        // The rest in closed form begins behind the start.
        let tail = self.lane.tail.filter(|tail| tail.from > midway.start.step + CHUNK);
        Self { lane: PreparedCase { start, tail, ..self.lane }, midway: Some(midway), ..self }
    }

    /// The attempt from a state that is found with its steps and tables.
    pub(super) fn from(self, state: impl FnOnce(&PreparedCase) -> LaneStart) -> Self {
        let start = Some(Arc::new(state(&self.lane)));
        Self { lane: PreparedCase { start, tail: None, ..self.lane }, ..self }
    }

    /// The case as it is integrated.
    pub(super) fn lane(&self) -> &PreparedCase {
        &self.lane
    }

    /// True for an outcome that has reached the end with finite numbers.
    pub(super) fn is_whole(&self, outcome: &Outcome) -> bool {
        outcome.end == RunEnd::Done && not_finite(&self.lane, outcome).is_none()
    }

    /// The whole response of a case that went on at equal steps, or the attempt without a rest in closed
    /// form; none if equal steps do not serve the case.
    fn after_midway(&self, midway: &Midway, outcome: Outcome) -> Option<Begun> {
        if !self.is_whole(&outcome) {
            return None;
        }
        let energy = ledger(&self.lane, &outcome);
        if self.lane.tail.is_some() && !ring_down::is_straight(&self.lane, &outcome, &energy) {
            let lane = PreparedCase { tail: None, ..self.lane.clone() };
            return Some(Begun::Attempt(Self { lane, ..self.clone() }));
        }
        self.joined(midway, outcome).map(|joined| Begun::Done(Box::new(joined)))
    }

    /// The whole response of a case that went on at equal steps; none if these do not serve the case: a contact came
    /// near opening or, but for what they leave out, to an extreme of its pressure, or the energy balance is open.
    pub(super) fn joined(&self, midway: &Midway, outcome: Outcome) -> Option<CaseResponse> {
        let rest = self.record(outcome);
        let mut contacts = self.lane.model.contacts().iter().zip(&rest.contacts);
        let opens = contacts.any(|(contact, seen)| contact.is_near_opening(seen.pressure_min));
        let serves = !opens && midway.keeps_extremes(&rest.contacts);
        let joined = midway.joined(rest);
        let is_balanced = !Resolution::too_coarse(joined.energy.residual_relative());
        (serves && is_balanced).then_some(joined)
    }

    /// The response of an outcome that is accepted.
    pub(super) fn record(&self, outcome: Outcome) -> CaseResponse {
        let step = self.lane.tabulated.step_model.step;
        CaseResponse {
            step,
            steps: self.lane.steps,
            integrated_steps: self.lane.integrated(),
            modes: self.lane.tabulated.step_model.modes.len(),
            decimation: Arc::clone(&self.decimation),
            contacts: contact_extremes(&self.lane, &outcome),
            energy: ring_down::at_end(&self.lane, ledger(&self.lane, &outcome)),
            displacement: outcome.displacement,
            ending: outcome.ending,
            is_of_second_order: self.settings.interpolation == InterpolationChoice::Average,
            table_exponents: self.settings.table_exponents.clone(),
            table_tolerance: self.lane.tabulated.table_tolerance,
        }
    }
}

/// The first contact with a number that is not finite. Closures between steps may be beyond those
/// that a law has, also where those at the steps are not.
fn not_finite(lane: &PreparedCase, outcome: &Outcome) -> Option<usize> {
    let contacts = contact_extremes(lane, outcome);
    let extremes = |one: &ContactExtremes| [one.pressure_min, one.pressure_max];
    let bad = contacts.iter().position(|one| !extremes(one).iter().all(|p| p.is_finite()));
    let samples = outcome.displacement.iter().chain(outcome.traction.iter().flatten());
    let all = samples.copied().all(f64::is_finite);
    bad.or((!all).then_some(0))
}

/// Pressure of faces that just touch, over that at rest.
const TOUCH: f64 = 1e-9;

/// Extremes as pressures, none below loss of contact, and the average stiffness.
pub(super) fn contact_extremes(lane: &PreparedCase, outcome: &Outcome) -> Vec<ContactExtremes> {
    let named = lane.model.contacts().iter().zip(&outcome.contacts).enumerate();
    named
        .map(|(i, (contact, outcome))| {
            let (law, state, seen) = (contact.law(), contact.pressure(), &outcome.extremes);
            let open_below = lane.open_below(i);
            // The pressure rises with the closure, so both have their extremes together.
            let at = |closure: f64| pressure_at(contact, open_below, closure);
            let ([pressure_min, _], [pressure_max, _]) = (at(seen.lowest), at(seen.highest));
            // From steps 1 to N to steps 0 to N - 1, and to the parts of steps without contact; after
            // other steps, to the mean of both.
            let (first, share) = match &lane.start {
                Some(start) => (start.stiffness[i], 0.5),
                None => (at(0.0)[1], 1.0),
            };
            let [_, last] = at(outcome.closure);
            let touching = if seen.open_excess == 0.0 { 0.0 } else { law.stiffness(TOUCH * state) };
            let shifted =
                (share * (first - last) - touching * seen.open_excess) / lane.steps as f64;
            ContactExtremes {
                pressure_min,
                pressure_max,
                lost: seen.open_steps * lane.tabulated.step_model.step,
                stiffness_average: outcome.stiffness + shifted,
            }
        })
        .collect()
}
