//! Steady responses to a shaker: one branch per force amplitude, and the backbones.

mod bodies;
mod check;
mod motion;
mod own_state;
mod settled;
mod shaken;
mod summary;
mod table;
mod time_sweep;

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use asperity_harmonic::{
    Branch, ContactSystem, Continuation, Floquet, FourierResolution, HarmonicError,
    HarmonicSettings, LawEvaluation, PeriodicResponse, PressureRange, StepControl, Termination,
};
use asperity_structure::PreloadedContact;
use rayon::prelude::*;
use serde::Serialize;

use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::warning::Warning;

use bodies::BodyChoice;
pub use bodies::{BodyModel, Condensation, CondensationReason, CondensedBody, LightBodies};
pub use check::TimeCheck;
pub use motion::IntegratedMotion;
pub(crate) use settled::{SAMPLES, periods_to_decay_at, settled_by};
pub use settled::{SettledAmplitude, SteadyMotion, first_periods};
pub use shaken::Shaken;
pub use summary::{
    BackboneSummary, BackbonesSummary, BifurcationSummary, BranchSummary, LevelSummary,
    LoadAmplitude, STEADY_SCHEMA, SteadySummary, TerminationSummary, TimeSweepSummary,
    UnfinishedSummary,
};
pub use table::{backbone_table, steady_table, steady_time_table};
pub(crate) use time_sweep::{SequenceRunner, sweeps_by};
pub use time_sweep::{SweepDirection, TimeSweep, TimeSweepPoint, TimeSweepRequest, time_sweeps};

/// Truncation that the automatic choice of harmonics aims at, and most harmonics. More would reach
/// the modes of light samples, where branches with loss of contact fold without end.
const TOLERANCE: f64 = 1e-5;
const MOST_HARMONICS: usize = 30;
const FEWEST_HARMONICS: usize = 3;

/// Most points of a branch.
const MOST_POINTS: usize = 10_000;

/// Most force amplitudes, most equations of a point, interfaces times Fourier coefficients, and most
/// of amplitudes times the cube of the equations: hours at the most points.
const MOST_AMPLITUDES: usize = 1000;
const MOST_EQUATIONS: usize = 2000;
const MOST_WORK: f64 = 1e11;

/// The same where equations are solved by iteration: equations, and amplitudes times equations times contacts; and most
/// numbers of a branch, points times equations, a gigabyte.
const MOST_ITERATED: usize = 40_000;
const MOST_ITERATED_WORK: f64 = 4e8;
const MOST_NUMBERS: usize = 20_000_000;

/// Samples per harmonic where the number of harmonics is given.
const SAMPLES_PER_HARMONIC: usize = 16;

/// A backbone starts at this part of the largest force.
const LOWEST_FORCE: f64 = 1e-3;

/// Range and force amplitudes of steady responses.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyRequest {
    /// Amplitudes of the force \[N\], or of the acceleration of the base \[m/s2\].
    pub amplitudes: Vec<f64>,
    /// Frequency at which each branch starts \[Hz\].
    pub from_hz: f64,
    /// Frequency at which each branch ends \[Hz\].
    pub to_hz: f64,
    /// Number of harmonics; chosen from the truncation if none is given.
    pub harmonics: Option<usize>,
    /// Adds the backbones: phase resonance and the damped mode.
    pub backbone: bool,
    /// Adds a response of each branch by time integration.
    pub verify: bool,
    /// Light bodies between contacts.
    pub bodies: BodyModel,
    /// Adds a stepped sine by time integration at each force amplitude.
    pub time_sweep: Option<TimeSweepRequest>,
}

/// The responses at one force amplitude.
#[derive(Debug)]
pub struct SteadyLevel {
    /// Amplitude of the force \[N\], or of the acceleration of the base \[m/s2\].
    pub force_n: f64,
    /// The branch, or the error.
    pub outcome: Result<Branch, HarmonicError>,
    /// The reason for which the branch is one with its light bodies condensed, if it is: its contacts
    /// are then those of the condensed stack.
    pub condensed: Option<Condensation>,
    /// A response by time integration, if requested.
    pub check: Option<TimeCheck>,
    /// The largest stable response by time integration from its own state, where it loses contact and no body is
    /// condensed.
    pub from_own_state: Option<TimeCheck>,
    /// Ranges of frequency in which neither part of the branch has a stable response \[Hz\], those included that they do
    /// not reach.
    pub ranges_without_stable_hz: Vec<[f64; 2]>,
    /// Motions by time integration at frequencies in these ranges.
    pub motions: Vec<IntegratedMotion>,
    /// The reason for which stability is not known at every point, if it is not.
    pub stability_unknown: Option<StabilityUnknown>,
    /// Warnings about the responses.
    pub warnings: Vec<Warning>,
    /// Contacts of each interface, where it has several.
    cells: Vec<Range<usize>>,
    /// Time of the computation \[s\].
    pub wall_s: f64,
}

/// Reason for which stability was not computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StabilityUnknown {
    /// A mode is too fast to be integrated over a period.
    FastMode,
}

impl SteadyLevel {
    /// Extremes of the pressure at each interface of the scenario over a response of the branch; of a patch,
    /// those of all of its cells.
    pub fn pressures(&self, response: &PeriodicResponse) -> Vec<PressureRange> {
        let all = match &self.condensed {
            Some(condensed) => condensed.light.pressures(response),
            None => response.pressures.clone(),
        };
        if self.cells.is_empty() {
            return all;
        }
        let widest = |cells: &Range<usize>| {
            let cells = &all[cells.clone()];
            let lowest = cells.iter().map(|one| one.lowest).fold(f64::INFINITY, f64::min);
            let highest = cells.iter().map(|one| one.highest).fold(f64::NEG_INFINITY, f64::max);
            let contact_lost = cells.iter().any(|one| one.contact_lost);
            PressureRange { lowest, highest, contact_lost }
        };
        self.cells.iter().map(widest).collect()
    }
}

/// The backbones.
#[derive(Debug)]
pub struct Backbones {
    /// Phase resonance over force.
    pub phase_resonance: Result<Branch, HarmonicError>,
    /// The damped mode over amplitude.
    pub mode: Result<Branch, HarmonicError>,
}

/// Everything computed for a [`SteadyRequest`].
#[derive(Debug)]
pub struct Steady {
    /// The levels, in the order of the request.
    pub levels: Vec<SteadyLevel>,
    /// The branch from the other end of the range, for each that leaves the range where it came in: the level has the
    /// one of the two that covers the range, or else that from the start.
    pub other_parts: Vec<SteadyLevel>,
    /// The backbones, if requested.
    pub backbones: Option<Backbones>,
    /// The stepped sines by time integration, if requested.
    pub time_sweeps: Vec<TimeSweep>,
    /// True if amplitudes are those of an acceleration of the base \[m/s2\], not of a force \[N\].
    pub is_base_motion: bool,
    /// Names of the sensors; none for the top of a scenario without sensors.
    pub sensors: Vec<Option<String>>,
    /// Part of a motion of the base that each sensor reads.
    pub base_shares: Vec<f64>,
    /// Time of the whole computation \[s\].
    pub wall_s: f64,
}

impl Steady {
    /// The branches of all levels, then the other parts, as tables number them from 1.
    pub fn parts(&self) -> impl Iterator<Item = &SteadyLevel> {
        self.levels.iter().chain(&self.other_parts)
    }

    /// Unit of the amplitudes.
    pub fn unit(&self) -> &'static str {
        if self.is_base_motion { "m/s²" } else { "N" }
    }
}

/// Computes the steady responses of an assembled scenario to a harmonic force at the place of its
/// excitation, or to a harmonic acceleration of the base where its excitation moves the base, read at its
/// sensors; the time function of the excitation has no part in them.
///
/// Levels go over all threads.
///
/// # Errors
/// [`SimulationError`] for a request out of range or a structure that cannot be balanced. A level without
/// a response does not end the others: its outcome is the error.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::assemble::Assembly;
/// # use asperity_simulation::steady::{BodyModel, SteadyRequest, steady};
/// let document = Document::read("examples/block.json")?;
/// let assembly = Assembly::new(&document.scenario()?, document.folder())?;
/// let request = SteadyRequest {
///     amplitudes: vec![0.2],
///     from_hz: 1200.0,
///     to_hz: 1900.0,
///     harmonics: Some(5),
///     backbone: false,
///     verify: false,
///     bodies: BodyModel::Auto,
///     time_sweep: None,
/// };
/// let found = steady(&assembly, &request)?;
/// let peak = found.levels[0].outcome.as_ref().unwrap().highest().unwrap();
/// assert!((1200.0..1900.0).contains(&peak.frequency_hz()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn steady<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
) -> Result<Steady, SimulationError> {
    steady_with_progress(assembly, request, &|_| ())
}

/// A part of [`steady`] that has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SteadyProgress {
    /// One point of a branch, found or analysed.
    Point,
    /// The branch of one force amplitude.
    Level,
}

/// As [`steady`]; `progress` is called after each point and each level.
///
/// # Errors
/// Those of [`steady`].
pub fn steady_with_progress<S: Shaken>(
    assembly: &Assembly<S>,
    request: &SteadyRequest,
    progress: &(dyn Fn(SteadyProgress) + Sync),
) -> Result<Steady, SimulationError> {
    let started = Instant::now();
    let _stage = tracing::info_span!("continue branches").entered();
    check_range(request)?;
    let evaluation = LawEvaluation::default();
    let system = S::contact_system(assembly, evaluation)?;
    let most = check_work(&system, request)?;
    let highest = request.from_hz.max(request.to_hz);
    let light = S::light_bodies(assembly, highest, request.bodies, evaluation)?.map(Arc::new);
    let choice = BodyChoice {
        elastic: &system,
        light: light.as_ref(),
        model: request.bodies,
        progress: &|| progress(SteadyProgress::Point),
    };
    let settings = settings(request, most, system.contacts().len());
    let found = request
        .amplitudes
        .par_iter()
        .map(|&force_n| {
            let found = level(assembly, &choice, request, &settings, force_n);
            progress(SteadyProgress::Level);
            found
        })
        .collect::<Result<Vec<_>, SimulationError>>()?;
    let (levels, other_parts): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let other_parts: Vec<SteadyLevel> = other_parts.into_iter().flatten().collect();
    for level in levels.iter().chain(&other_parts) {
        for warning in &level.warnings {
            tracing::warn!(force_n = level.force_n, "{warning}");
        }
    }
    let backbones = request.backbone.then(|| backbones(assembly, &choice, request, &settings));
    let range = (request.from_hz, request.to_hz);
    let sweeps = |sweep| S::time_sweeps(assembly, &request.amplitudes, range, sweep);
    let time_sweeps = request.time_sweep.map(sweeps).transpose()?.unwrap_or_default();
    Ok(Steady {
        levels,
        other_parts,
        backbones,
        time_sweeps,
        is_base_motion: assembly.load.base().is_some(),
        sensors: assembly.sensors.iter().map(|sensor| sensor.name.clone()).collect(),
        base_shares: assembly.sensors.iter().map(|sensor| sensor.base_share).collect(),
        wall_s: started.elapsed().as_secs_f64(),
    })
}

/// Refuses requests out of range.
fn check_range(request: &SteadyRequest) -> Result<(), HarmonicError> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let (from, to) = (request.from_hz, request.to_hz);
    if !(positive(from) && positive(to)) || from == to {
        return Err(HarmonicError::EmptyRange { quantity: "frequency [Hz]", from, to });
    }
    if request.amplitudes.is_empty() {
        let quantity = "number of force amplitudes";
        return Err(HarmonicError::Setting { quantity, value: 0.0, accepted: "at least 1" });
    }
    if let Some(value) = request.amplitudes.iter().copied().find(|&force| !positive(force)) {
        let quantity = "force amplitude [N]";
        return Err(HarmonicError::Setting { quantity, value, accepted: "positive and finite" });
    }
    if let Some(value) = request.harmonics
        && !(1..=FourierResolution::MOST_HARMONICS).contains(&value)
    {
        let (quantity, value) = ("number of harmonics", value as f64);
        return Err(HarmonicError::Setting { quantity, value, accepted: "1 to 400" });
    }
    Ok(())
}

/// The most harmonics of a system; refuses requests whose work exceeds the bounds.
fn check_work(system: &ContactSystem, request: &SteadyRequest) -> Result<usize, HarmonicError> {
    let contacts = system.contacts().len();
    let iterates = system.is_modal();
    let most = if iterates { MOST_ITERATED } else { MOST_EQUATIONS };
    let possible = (most / contacts).saturating_sub(1) / 2;
    let harmonics = request.harmonics.unwrap_or(MOST_HARMONICS.min(possible.max(FEWEST_HARMONICS)));
    let amplitudes = request.amplitudes.len() as f64;
    let equations = (contacts * (2 * harmonics + 1)) as f64;
    let (work, most_work) = if iterates {
        let quantity = "number of force amplitudes times contacts squared times (2 harmonics + 1)";
        let value = amplitudes * equations * contacts as f64;
        ((quantity, value), (MOST_ITERATED_WORK, "at most 4e8"))
    } else {
        let quantity = "number of force amplitudes times the cube of contacts (2 harmonics + 1)";
        ((quantity, amplitudes * equations.powi(3)), (MOST_WORK, "at most 1e11"))
    };
    let accepted = if iterates { "at most 40000" } else { "at most 2000" };
    let checks = [
        ("number of force amplitudes", amplitudes, MOST_AMPLITUDES as f64, "at most 1000"),
        ("number of contacts times (2 harmonics + 1)", equations, most as f64, accepted),
        (work.0, work.1, most_work.0, most_work.1),
    ];
    match checks.into_iter().find(|(_, value, limit, _)| value > limit) {
        Some((quantity, value, _, accepted)) => {
            Err(HarmonicError::Setting { quantity, value, accepted })
        }
        None => Ok(harmonics),
    }
}

fn settings(request: &SteadyRequest, most: usize, contacts: usize) -> HarmonicSettings {
    let resolution = match request.harmonics {
        Some(harmonics) => FourierResolution::Fixed {
            harmonics,
            samples: (SAMPLES_PER_HARMONIC * harmonics).max(64),
        },
        None => FourierResolution::Automatic { tolerance: TOLERANCE, most },
    };
    let points = MOST_POINTS.min(MOST_NUMBERS / (contacts * (2 * most + 1)));
    let steps = StepControl { points, ..StepControl::default() };
    let stability = Some(Floquet::default());
    HarmonicSettings { resolution, steps, stability, until_contact_lost: false }
}

/// The responses at one amplitude; the second where the branch has another part.
fn level<S: Shaken>(
    assembly: &Assembly<S>,
    choice: &BodyChoice<'_>,
    request: &SteadyRequest,
    settings: &HarmonicSettings,
    force_n: f64,
) -> Result<(SteadyLevel, Option<SteadyLevel>), SimulationError> {
    let (from, to) = (request.from_hz, request.to_hz);
    let trace = |from: f64, to: f64| {
        let started = Instant::now();
        let path = Continuation::Frequency { force: force_n, from, to };
        let (outcome, condensed) = choice.trace(&path, settings);
        FoundBranch { outcome, condensed, wall_s: started.elapsed().as_secs_f64() }
    };
    let (mut first, mut second) = (trace(from, to), None);
    if first.ended_as(&Termination::Returned) {
        second = Some(trace(to, from)).filter(|part| part.outcome.is_ok());
        if let Some(part) = second.as_mut().filter(|part| part.ended_as(&Termination::Reached)) {
            std::mem::swap(&mut first, part);
        }
    }
    let [branch, other_part] = [Some(&first), second.as_ref()]
        .map(|part| part.and_then(|part| part.outcome.as_ref().ok()));
    let branches = [branch, other_part].into_iter().flatten();
    let ranges = Branch::ranges_without_stable(branches, from, to);
    let motions = S::motions(assembly, force_n, &ranges);
    let place = branch.and_then(|branch| TimeCheck::place(branch, other_part));
    let checked = place.filter(|_| request.verify);
    let check = checked.map(|response| S::time_check(assembly, response)).transpose()?;
    // The state of bodies without inertia is not known.
    let is_kept = || {
        let response = checked.filter(|_| first.condensed.is_none());
        let own = response.and_then(|response| S::from_own_state(assembly, response));
        own.is_some_and(|own| own.is_kept())
    };
    let differs = check.as_ref().and_then(|check| check.warning(is_kept));
    let level = |found: FoundBranch| found.level(assembly, force_n, &ranges);
    let second = second.map(level);
    let mut first = SteadyLevel { check, motions, ..level(first) };
    first.warnings.extend(differs);
    Ok((first, second))
}

/// A branch with what it took.
struct FoundBranch {
    outcome: Result<Branch, HarmonicError>,
    condensed: Option<Condensation>,
    wall_s: f64,
}

impl FoundBranch {
    fn ended_as(&self, end: &Termination) -> bool {
        self.outcome.as_ref().is_ok_and(|branch| branch.termination == *end)
    }

    /// The level of the branch, without what is integrated from rest.
    fn level<S: Shaken>(
        self,
        assembly: &Assembly<S>,
        force_n: f64,
        ranges_without_stable_hz: &[[f64; 2]],
    ) -> SteadyLevel {
        let Self { outcome, condensed, wall_s } = self;
        // The state of bodies without inertia is not known.
        let whole = outcome.as_ref().ok().filter(|_| condensed.is_none());
        let from_own_state = whole
            .and_then(Branch::highest_stable)
            .filter(|response| response.contact_lost())
            .and_then(|response| S::from_own_state(assembly, response));
        let points = outcome.as_ref().map_or(&[][..], |branch| &branch.points);
        let unknown = points.iter().any(|point| point.stable().is_none());
        let level = SteadyLevel {
            force_n,
            outcome,
            condensed,
            check: None,
            from_own_state,
            ranges_without_stable_hz: ranges_without_stable_hz.to_vec(),
            motions: Vec::new(),
            stability_unknown: unknown.then_some(StabilityUnknown::FastMode),
            warnings: Vec::new(),
            cells: assembly.structure.cells(),
            wall_s,
        };
        let warnings = warnings(&level, assembly.structure.interfaces());
        SteadyLevel { warnings, ..level }
    }
}

/// Warnings about the contacts whose pressures leave the measured range on a branch, about a largest response whose
/// harmonics do not suffice, and about one that time integration leaves.
fn warnings(level: &SteadyLevel, contacts: &[PreloadedContact]) -> Vec<Warning> {
    let points = level.outcome.as_ref().map_or(&[][..], |branch| &branch.points);
    let all: Vec<Vec<PressureRange>> = points.iter().map(|point| level.pressures(point)).collect();
    let outside = |(i, contact): (usize, &PreloadedContact)| {
        let ranges = || all.iter().filter_map(|ranges| ranges.get(i));
        let lowest = ranges().map(|range| range.lowest).fold(f64::INFINITY, f64::min);
        let highest = ranges().map(|range| range.highest).fold(f64::NEG_INFINITY, f64::max);
        Warning::outside_measured_range(contact, lowest, highest)
    };
    let branch = level.outcome.as_ref().ok();
    let highest = branch.and_then(|branch| Some((branch.highest()?, branch.harmonics)));
    let unresolved = highest.filter(|(peak, _)| !peak.is_resolved()).map(|(peak, harmonics)| {
        let (frequency_hz, truncation) = (peak.frequency_hz(), peak.truncation);
        Warning::Unresolved { frequency_hz, harmonics, truncation }
    });
    let left = level.from_own_state.as_ref().and_then(TimeCheck::not_kept);
    let outside = contacts.iter().enumerate().filter_map(outside);
    outside.chain(unresolved).chain(left).collect()
}

/// Phase resonance up to the largest force, and the damped mode up to the amplitude reached there.
fn backbones<S: Shaken>(
    assembly: &Assembly<S>,
    choice: &BodyChoice<'_>,
    request: &SteadyRequest,
    settings: &HarmonicSettings,
) -> Backbones {
    let middle = 0.5 * (request.from_hz + request.to_hz);
    let near = assembly.structure.natural_frequency_hz().unwrap_or(middle);
    let largest = request.amplitudes.iter().copied().fold(0.0, f64::max);
    let settings = HarmonicSettings { stability: None, ..*settings };
    let path = Continuation::PhaseResonance { near, from: LOWEST_FORCE * largest, to: largest };
    let (phase_resonance, _) = choice.trace(&path, &settings);
    let mode = match &phase_resonance {
        Ok(branch) => match (branch.points.first(), branch.points.last()) {
            (Some(first), Some(last)) => {
                let (from, to) = (first.amplitude(1), last.amplitude(1));
                choice.trace(&Continuation::Mode { near, from, to }, &settings).0
            }
            _ => Err(HarmonicError::NoLinearResponse { frequency_hz: near }),
        },
        Err(error) => Err(error.clone()),
    };
    Backbones { phase_resonance, mode }
}
