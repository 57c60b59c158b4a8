//! Tracing of a branch from its start to its end.

use std::f64::consts::TAU;

use crate::arc_length::{ArcLength, CorrectorFailure, CurvePoint};
use crate::balance::Conditions;
use crate::branch_recorder::{Arc, BranchRecorder};
use crate::continuation_problem::{ContinuationProblem, is_iterative};
use crate::floquet::FloquetSolver;
use crate::{
    Branch, ContactSystem, Continuation, FourierResolution, HarmonicError, HarmonicSettings,
    PeriodicResponse, Termination, UnfinishedBranch,
};

/// Share of a force at which the search for a first response starts when Newton's method does not
/// find it at once.
const LOW_FORCE: f64 = 1e-3;

/// Harmonics that an automatic choice starts from, and their growth.
const FIRST_HARMONICS: usize = 5;
const SAMPLES_PER_HARMONIC: usize = 16;

/// Harmonics that find the place where contact is lost.
const SEARCH_HARMONICS: usize = 12;

/// Most points times unknowns of a branch whose harmonics are chosen, ten seconds to some minutes, and of a branch
/// with fewer that takes the place of one beyond it.
const MOST_WORK: usize = 2_000_000;
const MOST_COARSER_WORK: usize = 400_000;

/// Both, where equations are solved by iteration, whose work grows little faster than the number of unknowns.
const ITERATIVE_SHARE: usize = 10;

/// Points of a branch after which the turn aimed at is twice as large: it folds many times.
const MANY_POINTS: usize = 1000;

/// Traces the branch of periodic responses that `continuation` describes.
///
/// A failure after the start ends the branch, which is kept with its [`Termination`]. With automatic
/// [`FourierResolution`] the branch is traced again with half as many harmonics more, with one and a half times as many more
/// where contact is lost, until its truncation is below the tolerance. Where a branch over frequency with the most harmonics does not converge, or has more
/// than 2 000 000 points times unknowns, the one with the most of two thirds, four ninths ... as many that covers the
/// range takes its place, and [`Branch::finer`] tells where the other ended.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_harmonic::{
///     ContactSystem, Continuation, HarmonicSettings, LawEvaluation, RigidMass, trace,
/// };
/// use asperity_law::Power;
/// use asperity_structure::PreloadedContact;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let law = Arc::new(Power::new(0.9e10, 0.35, 0.0)?);
/// let contact = PreloadedContact::new("guide", 1.15e-4, law, 1.37e5)?;
/// let mass = Arc::new(RigidMass::new(1.61, 420.0)?);
/// let system = ContactSystem::new(mass, vec![contact], LawEvaluation::default())?;
/// let backbone = Continuation::Mode { near: 1000.0, from: 1e-9, to: 1e-7 };
/// let branch = trace(&system, &backbone, &HarmonicSettings::default())?;
/// let frequencies: Vec<f64> = branch.points.iter().map(|point| point.frequency_hz()).collect();
/// assert!(frequencies[0] > frequencies[frequencies.len() - 1]); // softening
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`HarmonicError`] for settings or a continuation out of range, or where no response is found at
/// its start.
pub fn trace(
    system: &ContactSystem,
    continuation: &Continuation,
    settings: &HarmonicSettings,
) -> Result<Branch, HarmonicError> {
    trace_with_progress(system, continuation, settings, &|| ())
}

/// As [`trace`]; `progress` is called after each point that is found or analysed, of all branches that are tried.
///
/// # Errors
/// Those of [`trace`].
pub fn trace_with_progress(
    system: &ContactSystem,
    continuation: &Continuation,
    settings: &HarmonicSettings,
    progress: &dyn Fn(),
) -> Result<Branch, HarmonicError> {
    settings.check()?;
    continuation.check()?;
    let path = Path { system, continuation: *continuation, settings, progress };
    match settings.resolution {
        FourierResolution::Fixed { harmonics, samples } => {
            let resolution = (harmonics, samples.max(4 * harmonics + 2));
            Ok(path.follow(resolution, Limits::default())?.analysed(progress))
        }
        FourierResolution::Automatic { tolerance, most } => {
            let at = |harmonics: usize, truncation: f64, work: usize| {
                let samples = (SAMPLES_PER_HARMONIC * harmonics).next_multiple_of(8);
                let share = if is_iterative(system, harmonics) { ITERATIVE_SHARE } else { 1 };
                let points = share * work / (system.pairs() * (2 * harmonics + 1));
                path.follow((harmonics, samples), Limits { truncation, points })
            };
            let mut harmonics = FIRST_HARMONICS.min(most);
            let mut finest = loop {
                let limit = if harmonics < most { tolerance } else { f64::INFINITY };
                let found = at(harmonics, limit, MOST_WORK);
                let fine =
                    found.as_ref().is_ok_and(|found| found.branch().truncation() <= tolerance);
                if fine || harmonics == most {
                    break found?;
                }
                if settings.until_contact_lost && harmonics == FIRST_HARMONICS {
                    // The place of a loss of contact needs fewer harmonics than the motion there.
                    let search = at(SEARCH_HARMONICS.min(most), f64::INFINITY, MOST_WORK);
                    if let Ok(search) = search
                        && search.branch().termination == Termination::ContactLost
                    {
                        break search;
                    }
                }
                // Series of a force that vanishes within the period converge slowly.
                let is_lost = |found: &Followed<'_>| {
                    found.branch().points.last().is_some_and(PeriodicResponse::contact_lost)
                };
                let lost = found.as_ref().is_ok_and(is_lost);
                let more = if lost { 3 * harmonics / 2 } else { harmonics.div_ceil(2) };
                harmonics = (harmonics + more).min(most);
            };
            let over_frequency = matches!(continuation, Continuation::Frequency { .. });
            while over_frequency && finest.is_unfinished() && harmonics > FIRST_HARMONICS {
                harmonics = (2 * harmonics / 3).max(FIRST_HARMONICS);
                let coarser = at(harmonics, f64::INFINITY, MOST_COARSER_WORK);
                let Ok(mut coarser) = coarser else { continue };
                if coarser.branch().is_complete() {
                    coarser.recorder.branch.finer = finest.unfinished();
                    finest = coarser;
                }
            }
            Ok(finest.analysed(progress))
        }
    }
}

/// Limits of a branch.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Truncation beyond which more harmonics are to be taken: the branch ends.
    truncation: f64,
    /// Number of points, beside the settings' number.
    points: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { truncation: f64::INFINITY, points: usize::MAX }
    }
}

/// A branch that has ended, before the analysis of its stability.
struct Followed<'a> {
    arc: Arc<'a>,
    recorder: BranchRecorder<'a>,
}

impl Followed<'_> {
    fn branch(&self) -> &Branch {
        &self.recorder.branch
    }

    /// The branch with its stability.
    fn analysed(mut self, progress: &dyn Fn()) -> Branch {
        self.recorder.ended(&mut self.arc, progress)
    }

    /// True if the branch ended for a reason that fewer harmonics may not have.
    fn is_unfinished(&self) -> bool {
        matches!(self.branch().termination, Termination::NotConverged | Termination::PointLimit)
    }

    fn unfinished(&self) -> Option<UnfinishedBranch> {
        let branch = self.branch();
        let last = branch.points.last()?;
        Some(UnfinishedBranch {
            harmonics: branch.harmonics,
            termination: branch.termination.clone(),
            points: branch.points.len(),
            frequency_hz: last.frequency_hz(),
        })
    }
}

/// A continuation to be followed, and the listener that is told of its points.
#[derive(Clone, Copy)]
struct Path<'a, 'p> {
    system: &'a ContactSystem,
    continuation: Continuation,
    settings: &'p HarmonicSettings,
    progress: &'p dyn Fn(),
}

impl<'a> Path<'a, '_> {
    /// The branch at a given resolution.
    fn follow(
        &self,
        (harmonics, samples): (usize, usize),
        limits: Limits,
    ) -> Result<Followed<'a>, HarmonicError> {
        let Self { system, continuation, settings, progress } = *self;
        let problem = ContinuationProblem::new(system, continuation, harmonics, samples)?;
        let (from, to) = continuation.range();
        let (start, end) = (problem.parameter(from), problem.parameter(to));
        let sense = (end - start).signum();
        let mut arc = ArcLength::new(problem, settings.steps);
        let floquet = match continuation {
            Continuation::Mode { .. } => None,
            _ => {
                settings.stability.map(|floquet| FloquetSolver::new(system, floquet)).transpose()?
            }
        };
        let mut recorder = BranchRecorder::new(floquet, harmonics, samples);
        let mut point = self.first(&mut arc, sense)?;
        recorder.record(&mut arc, &point);
        let most = settings.steps.points.min(limits.points);
        let termination = loop {
            progress();
            let last = recorder.branch.points.last();
            if last.is_some_and(|point| point.truncation > limits.truncation) {
                break Termination::NotConverged;
            }
            if settings.until_contact_lost && last.is_some_and(PeriodicResponse::contact_lost) {
                recorder.without_stability();
                break Termination::ContactLost;
            }
            if let Some(beyond) = recorder.beyond_law(system) {
                break beyond;
            }
            if recorder.branch.points.len() >= most {
                break Termination::PointLimit;
            }
            if recorder.branch.points.len() == MANY_POINTS {
                arc.control.turn *= 2.0;
            }
            let (next, step) = match arc.advance(&point) {
                Ok(advanced) => advanced,
                Err(failure) => break BranchRecorder::termination(system, failure),
            };
            let parameter = next.unknowns[next.unknowns.len() - 1];
            if sense * (parameter - end) >= 0.0 {
                let termination = recorder.finish(&mut arc, &point, &next, end);
                break recorder.beyond_law(system).unwrap_or(termination);
            }
            if sense * (parameter - start) < 0.0 {
                break Termination::Returned;
            }
            recorder.step(&mut arc, &point, &next, step);
            point = next;
        };
        recorder.branch.termination = termination;
        Ok(Followed { arc, recorder })
    }

    /// The response at the start: from the linear one, or else along rising forces.
    fn first(
        &self,
        arc: &mut ArcLength<ContinuationProblem<'_>>,
        sense: f64,
    ) -> Result<CurvePoint, HarmonicError> {
        let Self { system, continuation, settings, progress } = *self;
        let (frequency_hz, force_n) = continuation.start();
        let guess =
            arc.curve.linear_start().ok_or(HarmonicError::NoLinearResponse { frequency_hz })?;
        let failure = match arc.solve_at(&guess, sense) {
            Ok(point) => return Ok(point),
            Err(failure) => failure,
        };
        let mut end = None;
        if let Continuation::Frequency { force, from, .. } = continuation {
            let rising =
                Continuation::Force { frequency: from, from: LOW_FORCE * force, to: force };
            let fourier = arc.curve.balance().fourier();
            let resolution = (fourier.harmonics(), fourier.samples());
            let quiet =
                HarmonicSettings { stability: None, until_contact_lost: false, ..*settings };
            let path = Path { continuation: rising, settings: &quiet, ..*self };
            let branch = path.follow(resolution, Limits::default());
            let branch = branch.ok().map(|branch| branch.analysed(progress));
            if let Some(branch) = &branch
                && let (Termination::Reached, Some(last)) =
                    (&branch.termination, branch.points.last())
            {
                let at = Conditions { angular_frequency: TAU * from, anti_damping: 0.0, force };
                let guess = arc.curve.unknowns(&last.closures, &at, from);
                if let Ok(point) = arc.solve_at(&guess, sense) {
                    return Ok(point);
                }
            }
            end = branch.map(|branch| branch.termination);
        }
        if let Some(Termination::BeyondLaw { interface, closure }) = end {
            return Err(HarmonicError::BeyondLaw {
                interface,
                closure_m: closure,
                frequency_hz,
                force_n,
            });
        }
        Err(match failure {
            CorrectorFailure::Overflow(overflow) => HarmonicError::BeyondLaw {
                interface: system.contacts()[overflow.interface].name().to_owned(),
                closure_m: overflow.closure,
                frequency_hz,
                force_n,
            },
            CorrectorFailure::Stalled(residual) => {
                let residual = if residual.is_nan() { f64::INFINITY } else { residual };
                HarmonicError::NoStart { frequency_hz, force_n, residual }
            }
        })
    }
}
