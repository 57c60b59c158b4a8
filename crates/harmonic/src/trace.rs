//! Following a path from its start to its end.

use std::f64::consts::TAU;

use crate::arc_length::{ArcLength, Failure, Station};
use crate::balance::Conditions;
use crate::floquet::Judge;
use crate::problem::Problem;
use crate::recorder::Recorder;
use crate::{Branch, BranchEnd, ContactSystem, HarmonicError, Path, Resolution, Settings};

/// Share of a force at which the search for a first response starts when Newton's method does not
/// find it at once.
const LOW_FORCE: f64 = 1e-3;

/// Harmonics that an automatic choice starts from, and their growth.
const FIRST_HARMONICS: usize = 5;
const SAMPLES_PER_HARMONIC: usize = 16;

/// Follows `path` and returns its branch.
///
/// What goes wrong after the start ends the branch, which is kept and says why
/// ([`BranchEnd`]). With automatic [`Resolution`] the branch is followed again with half as many
/// harmonics more until its truncation is below the tolerance.
///
/// # Errors
/// [`HarmonicError`] for settings or a path out of range, or where no response is found at the
/// start of the path.
pub fn trace(
    system: &ContactSystem,
    path: &Path,
    settings: &Settings,
) -> Result<Branch, HarmonicError> {
    settings.check()?;
    path.check()?;
    match settings.resolution {
        Resolution::Fixed { harmonics, samples } => {
            follow(system, *path, settings, (harmonics, samples.max(4 * harmonics + 2)), None)
        }
        Resolution::Automatic { tolerance, most } => {
            let mut harmonics = FIRST_HARMONICS.min(most);
            loop {
                let samples = (SAMPLES_PER_HARMONIC * harmonics).next_multiple_of(8);
                let limit = (harmonics < most).then_some(tolerance);
                let branch = follow(system, *path, settings, (harmonics, samples), limit);
                let fine = branch.as_ref().is_ok_and(|branch| branch.truncation() <= tolerance);
                if fine || harmonics == most {
                    return branch;
                }
                harmonics = (harmonics + harmonics.div_ceil(2)).min(most);
            }
        }
    }
}

/// The branch at a given resolution; given up as soon as a point exceeds the `limit` of truncation.
fn follow(
    system: &ContactSystem,
    path: Path,
    settings: &Settings,
    (harmonics, samples): (usize, usize),
    limit: Option<f64>,
) -> Result<Branch, HarmonicError> {
    let problem = Problem::new(system, path, harmonics, samples)?;
    let (from, to) = path.range();
    let (start, end) = (problem.parameter(from), problem.parameter(to));
    let sense = (end - start).signum();
    let mut arc = ArcLength::new(problem, settings.steps);
    let judge = match path {
        Path::Mode { .. } => None,
        _ => settings.stability.map(|floquet| Judge::new(system, floquet)),
    };
    let mut recorder = Recorder::new(judge, harmonics, samples);
    let mut station = first(&mut arc, system, path, sense, settings)?;
    recorder.record(&mut arc, &station);
    loop {
        if limit.is_some_and(|limit| recorder.branch.truncation() > limit) {
            return Ok(recorder.branch);
        }
        if recorder.branch.points.len() >= settings.steps.points {
            return Ok(recorder.ended(BranchEnd::PointLimit));
        }
        let (next, step) = match arc.advance(&station) {
            Ok(advanced) => advanced,
            Err(failure) => {
                let end = Recorder::why(system, failure);
                return Ok(recorder.ended(end));
            }
        };
        let parameter = next.place[next.place.len() - 1];
        if sense * (parameter - end) >= 0.0 {
            return Ok(recorder.finish(&mut arc, &station, &next, end));
        }
        if sense * (parameter - start) < 0.0 {
            return Ok(recorder.ended(BranchEnd::Returned));
        }
        recorder.step(&mut arc, &station, &next, step);
        station = next;
    }
}

/// The response at the start: from the linear one, or else along rising forces.
fn first(
    arc: &mut ArcLength<Problem<'_>>,
    system: &ContactSystem,
    path: Path,
    sense: f64,
    settings: &Settings,
) -> Result<Station, HarmonicError> {
    let failure = match arc.curve.linear_start() {
        None => Failure::Stalled(f64::NAN),
        Some(guess) => match arc.solve_at(&guess, sense) {
            Ok(station) => return Ok(station),
            Err(failure) => failure,
        },
    };
    let (frequency_hz, force_n) = match path {
        Path::Frequency { force, from, .. } => (from, force),
        Path::Force { frequency, from, .. } => (frequency, from),
        Path::PhaseResonance { near, from, .. } => (near, from),
        Path::Mode { near, .. } => (near, 0.0),
    };
    let mut end = None;
    if let Path::Frequency { force, from, .. } = path {
        let rising = Path::Force { frequency: from, from: LOW_FORCE * force, to: force };
        let fourier = arc.curve.balance().fourier();
        let resolution = (fourier.harmonics(), fourier.samples());
        let quiet = Settings { stability: None, ..*settings };
        let branch = follow_rising(system, rising, &quiet, resolution).ok();
        if let Some(branch) = &branch
            && let (BranchEnd::Reached, Some(last)) = (&branch.end, branch.points.last())
        {
            let at = Conditions { angular_frequency: TAU * from, anti_damping: 0.0, force };
            let guess = arc.curve.unknowns(&last.closures, &at, from);
            if let Ok(station) = arc.solve_at(&guess, sense) {
                return Ok(station);
            }
        }
        end = branch.map(|branch| branch.end);
    }
    if let Some(BranchEnd::BeyondLaw { interface, closure }) = end {
        return Err(HarmonicError::BeyondLaw {
            interface,
            closure_m: closure,
            frequency_hz,
            force_n,
        });
    }
    Err(match failure {
        Failure::Overflow(overflow) => HarmonicError::BeyondLaw {
            interface: system.contacts()[overflow.interface].name().to_owned(),
            closure_m: overflow.closure,
            frequency_hz,
            force_n,
        },
        Failure::Stalled(residual) => HarmonicError::NoStart { frequency_hz, force_n, residual },
    })
}

/// [`follow`] along forces, which never calls itself again.
fn follow_rising(
    system: &ContactSystem,
    path: Path,
    settings: &Settings,
    resolution: (usize, usize),
) -> Result<Branch, HarmonicError> {
    follow(system, path, settings, resolution, None)
}
