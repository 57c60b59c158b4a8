//! Stepped sine by time integration: amplitudes over rising or falling frequency, with jumps.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_dynamics::{
    Batch, CaseResponse, Decimation, DynamicsError, Modal, Sampling, TransientCase,
};
use num_complex::Complex64;
use rayon::prelude::*;

use super::settled::slowest_rate;
use asperity_structure::{LoadCase, SteppedSine, StructureError, TimeFunction};

use crate::assemble::Assembly;

/// Transients of a change of frequency are integrated until they have fallen to this; a change that
/// makes the motion jump takes longer.
const REMAINS: f64 = 1e-4;

/// Periods over which a fundamental is evaluated; those before serve for the change.
const EVALUATED: usize = 4;

/// Periods of a frequency, at least and at most.
const FEWEST_PERIODS: usize = 4 * EVALUATED;
const MOST_PERIODS: usize = 1000;

/// Relative change of the fundamental over its last periods up to which it has settled.
const SETTLED: f64 = 1e-3;

/// Doublings of the periods of frequencies that have not settled.
const DOUBLINGS: usize = 3;

/// Steps of the time integration are this part of those for a single hit.
const STEP: f64 = 0.5;

/// Relative change of the fundamental over one frequency step beyond which it is a jump if the steps
/// beside it change it by a third at most.
const JUMP: f64 = 0.1;

/// Directions of a stepped sine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepDirection {
    /// Rising frequency.
    Up,
    /// Falling frequency.
    Down,
    /// One after the other.
    Both,
}

/// A stepped sine by time integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeSweepRequest {
    /// Directions.
    pub direction: SweepDirection,
    /// Number of frequencies, both ends of the range included.
    pub frequencies: usize,
}

impl TimeSweepRequest {
    /// Most frequencies accepted.
    pub const MOST_FREQUENCIES: usize = 2000;
}

/// A stepped sine in one direction at one force amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSweep {
    /// Force amplitude \[N\].
    pub force_n: f64,
    /// True for rising frequency.
    pub rising: bool,
    /// A point for each frequency, in the order of the sweep, or the error.
    pub outcome: Result<Vec<TimeSweepPoint>, DynamicsError>,
}

/// The motion at one frequency of a stepped sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeSweepPoint {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Amplitude of the fundamental of the top \[m\].
    pub amplitude_1_m: f64,
    /// Amplitude of the second harmonic \[m\].
    pub amplitude_2_m: f64,
    /// Phase of the fundamental against the force \[rad\], negative when it lags.
    pub phase_1_rad: f64,
    /// Periods integrated at this frequency.
    pub periods: usize,
    /// Relative change of the fundamental between the last periods and those before.
    pub change: f64,
    /// True if that is at most 1e-3.
    pub settled: bool,
}

impl TimeSweep {
    /// `"up"` or `"down"`.
    pub fn direction(&self) -> &'static str {
        if self.rising { "up" } else { "down" }
    }

    /// Pairs of neighbouring frequencies \[Hz\] between which the fundamental jumps: over which it
    /// changes by more than a tenth, and by more than three times as much as over the steps beside.
    pub fn jumps(&self) -> Vec<[f64; 2]> {
        let points = self.outcome.as_ref().map_or(&[][..], |points| points);
        let changes: Vec<f64> = points
            .windows(2)
            .map(|pair| (pair[1].amplitude_1_m / pair[0].amplitude_1_m).ln().abs())
            .collect();
        let beside = |n: usize| {
            let before = n.checked_sub(1).and_then(|n| changes.get(n)).copied().unwrap_or(0.0);
            before.max(changes.get(n + 1).copied().unwrap_or(0.0))
        };
        let jumps = |n: &usize| changes[*n] > JUMP && changes[*n] > 3.0 * beside(*n);
        let ends = |n: usize| [points[n].frequency_hz, points[n + 1].frequency_hz];
        (0..changes.len()).filter(jumps).map(ends).collect()
    }
}

/// Integrates the structure with all of its bodies' inertia through the frequencies `range` \[Hz\] at
/// each force amplitude \[N\], from rest at the first frequency: one frequency after another without a
/// pause, as a shaker does, amplitudes and directions side by side in vector lanes.
///
/// # Errors
/// [`DynamicsError`] for a request out of range, or a structure that cannot be integrated.
pub fn time_sweeps(
    assembly: &Assembly,
    amplitudes: &[f64],
    range: (f64, f64),
    request: TimeSweepRequest,
) -> Result<Vec<TimeSweep>, DynamicsError> {
    let runner = Runner::new(assembly, range.0.min(range.1), range.0.max(range.1))?;
    sweeps_by(&runner, amplitudes, range, request)
}

/// Integrates sequences of frequencies, one sequence for each force amplitude \[N\].
pub(crate) trait SequenceRunner: Sync {
    /// Rate \[1/s\] at which transients decay.
    fn decay_rate(&self) -> f64;

    /// Sequences that run side by side.
    fn room(&self) -> usize;

    /// The displacement at the first sensor under each sequence, with its step \[s\].
    fn run(&self, sequences: &[(SteppedSine, f64)]) -> Vec<Result<(Vec<f64>, f64), DynamicsError>>;
}

/// As [`time_sweeps`], by any integration.
pub(crate) fn sweeps_by(
    runner: &dyn SequenceRunner,
    amplitudes: &[f64],
    range: (f64, f64),
    request: TimeSweepRequest,
) -> Result<Vec<TimeSweep>, DynamicsError> {
    let count = request.frequencies;
    if !(2..=TimeSweepRequest::MOST_FREQUENCIES).contains(&count) {
        let (quantity, value) = ("number of frequencies", count as f64);
        return Err(DynamicsError::Setting { quantity, value, accepted: "2 to 2000" });
    }
    let (low, high) = (range.0.min(range.1), range.0.max(range.1));
    let place = |n: usize| low + (high - low) * n as f64 / (count - 1) as f64;
    let rising: Vec<f64> = (0..count).map(place).collect();
    let falling: Vec<f64> = rising.iter().rev().copied().collect();
    let directions: &[bool] = match request.direction {
        SweepDirection::Up => &[true],
        SweepDirection::Down => &[false],
        SweepDirection::Both => &[true, false],
    };
    let first_periods = |frequency: f64| {
        let decay = -REMAINS.ln() * frequency / runner.decay_rate();
        (decay.ceil() as usize).saturating_add(EVALUATED).clamp(FEWEST_PERIODS, MOST_PERIODS)
    };
    let mut lanes: Vec<Lane> = Vec::new();
    for &force_n in amplitudes {
        for &up in directions {
            let frequencies = if up { &rising } else { &falling };
            let periods = |&hz: &f64| (hz, first_periods(hz));
            let parts = frequencies.iter().map(periods).collect();
            lanes.push(Lane { force_n, rising: up, parts, found: None });
        }
    }
    for _ in 0..=DOUBLINGS {
        let mut open: Vec<&mut Lane> =
            lanes.iter_mut().filter_map(|lane| lane.is_open().then_some(lane)).collect();
        open.par_chunks_mut(runner.room().max(1)).for_each(|lanes| run(runner, lanes));
    }
    let sweep = |lane: Lane| TimeSweep {
        force_n: lane.force_n,
        rising: lane.rising,
        outcome: lane.found.unwrap_or(Ok(Vec::new())),
    };
    Ok(lanes.into_iter().map(sweep).collect())
}

/// A sweep in work.
struct Lane {
    force_n: f64,
    rising: bool,
    /// Frequencies with their numbers of periods.
    parts: Vec<(f64, usize)>,
    found: Option<Result<Vec<TimeSweepPoint>, DynamicsError>>,
}

impl Lane {
    /// True before the first run, and while frequencies have not settled that may have more periods.
    fn is_open(&mut self) -> bool {
        match &self.found {
            None => true,
            Some(Err(_)) => false,
            Some(Ok(points)) => {
                let mut longer = false;
                for (part, point) in self.parts.iter_mut().zip(points) {
                    if !point.settled && part.1 < MOST_PERIODS {
                        part.1 = (2 * part.1).min(MOST_PERIODS);
                        longer = true;
                    }
                }
                longer
            }
        }
    }
}

/// Runs sweeps side by side.
fn run(runner: &dyn SequenceRunner, lanes: &mut [&mut Lane]) {
    let sequence = |lane: &&mut Lane| Ok((SteppedSine::new(&lane.parts)?, lane.force_n));
    let sequences: Result<Vec<_>, StructureError> = lanes.iter().map(sequence).collect();
    let sequences = match sequences.map_err(DynamicsError::from) {
        Ok(sequences) => sequences,
        Err(error) => {
            for lane in lanes.iter_mut() {
                lane.found = Some(Err(error.clone()));
            }
            return;
        }
    };
    for ((lane, (sequence, _)), response) in
        lanes.iter_mut().zip(&sequences).zip(runner.run(&sequences))
    {
        let points = |(displacement, step): (Vec<f64>, f64)| {
            points(&lane.parts, sequence, (&displacement, step))
        };
        lane.found = Some(response.map(points));
    }
}

/// Model, step and vector instructions of all sweeps of a stack.
struct Runner<'a> {
    assembly: &'a Assembly,
    template: TransientCase,
    batch: Batch,
}

impl<'a> Runner<'a> {
    fn new(assembly: &'a Assembly, low: f64, high: f64) -> Result<Self, DynamicsError> {
        let sequence = SteppedSine::new(&[(high, 1)])?;
        let shaker = LoadCase::force(TimeFunction::SteppedSine(sequence), 1.0);
        let shaker = shaker.at(assembly.load.port());
        let sampling = Sampling::new(100.0 / low, 64.0 * high)?;
        let mut template = Modal::default().case(
            &assembly.structure,
            &shaker,
            &assembly.sensor_ports()[..1],
            &sampling,
        )?;
        let (step, _) = template.first_step()?;
        template.step = Some(STEP * step);
        Ok(Self { assembly, template, batch: Batch::default() })
    }
}

impl SequenceRunner for Runner<'_> {
    fn decay_rate(&self) -> f64 {
        slowest_rate(self.assembly)
    }

    fn room(&self) -> usize {
        self.batch.room()
    }

    fn run(&self, sequences: &[(SteppedSine, f64)]) -> Vec<Result<(Vec<f64>, f64), DynamicsError>> {
        let every_step = Decimation::every_step();
        // Lanes run together as long as the longest; the others stay at their last frequency.
        let duration = sequences.iter().map(|(sequence, _)| sequence.end()).fold(0.0, f64::max);
        let port = self.template.load.port();
        let case = |(sequence, force_n): &(SteppedSine, f64)| {
            let function = TimeFunction::SteppedSine(sequence.clone());
            let load = LoadCase::force(function, *force_n).at(port);
            TransientCase { load, duration, ..self.template.clone() }
        };
        let cases: Vec<TransientCase> = sequences.iter().map(case).collect();
        let responses = self.batch.run(&cases, &|_, _| Arc::clone(&every_step));
        let samples = |response: CaseResponse| (response.displacement, response.step);
        responses.into_iter().map(|response| response.map(samples)).collect()
    }
}

/// The motion at each frequency, from its last periods and those before.
fn points(
    parts: &[(f64, usize)],
    sequence: &SteppedSine,
    response: (&[f64], f64),
) -> Vec<TimeSweepPoint> {
    let point = |(place, &(frequency_hz, periods)): (usize, &(f64, usize))| {
        let start = sequence.start(place).unwrap_or(f64::NAN);
        let harmonic = |k: f64, skipped: usize| {
            let end = (periods - skipped) as f64 / frequency_hz;
            let length = EVALUATED as f64 / frequency_hz;
            fourier(response, (start, end - length, length), k * frequency_hz)
        };
        let (last, before) = (harmonic(1.0, 0), harmonic(1.0, EVALUATED));
        let change = (last - before).norm() / last.norm();
        // The force is a sine: a quarter of a turn behind the cosine of the amplitude.
        let phase = (last * Complex64::I).arg();
        TimeSweepPoint {
            frequency_hz,
            amplitude_1_m: last.norm(),
            amplitude_2_m: harmonic(2.0, 0).norm(),
            phase_1_rad: phase,
            periods,
            change,
            settled: change <= SETTLED,
        }
    };
    parts.iter().enumerate().map(point).collect()
}

/// Complex amplitude of `frequency` \[Hz\] in a displacement with its step \[s\] over a window of Hann, which begins `from`
/// after `start` and is `length` long \[s\]; phases count from `start`.
fn fourier(
    (displacement, h): (&[f64], f64),
    (start, from, length): (f64, f64, f64),
    frequency: f64,
) -> Complex64 {
    let first = ((start + from) / h).ceil().max(0.0) as usize;
    let last = (((start + from + length) / h).floor() as usize).min(displacement.len());
    let (mut sum, mut weights) = (Complex64::ZERO, 0.0);
    for (n, sample) in displacement.iter().enumerate().take(last).skip(first) {
        let time = n as f64 * h - start;
        let weight = (PI * (time - from) / length).sin().powi(2);
        let turn = Complex64::from_polar(weight, -TAU * frequency * time);
        sum += turn * sample;
        weights += weight;
    }
    sum * (2.0 / weights)
}
