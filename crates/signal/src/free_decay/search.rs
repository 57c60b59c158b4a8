//! Free decays in a record without a force.

use crate::error::{Result, SignalError, check_positive, check_rate, check_samples};
use crate::noise::robust_level;

/// Level of a block over the largest of the blocks before it, from which it contains a blow.
const JUMP: f64 = 2.5;
/// Blocks (cycles) before a blow, and of a rest.
const BEFORE: usize = 8;
/// Level of noise over the level of its quiet blocks.
const NOISE: f64 = 2.5;
/// Least level of a decay over the level of the quiet blocks, and over the largest level of the
/// record.
const ABOVE_NOISE: f64 = 4.0;
const LEAST: f64 = 1e-3;
/// Least fall of a decay.
const FALL: f64 = 3.0;
/// Level over the largest at which a decay begins.
const KNEE: f64 = 0.9;
/// Largest ratio of the levels of a stationary stretch.
const STATIONARY: f64 = 1.05;
/// Fewest samples before a blow in the first block of a record.
const FEWEST_BEFORE: usize = 16;
/// Part of the blocks that are quieter than the quiet level.
const QUIET: f64 = 0.05;
/// Power of the quiet blocks of a record that begins at exact rest, over the largest.
const LEAST_POWER: f64 = 1e-18;

/// Origin of a free decay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecayOrigin {
    /// A blow: the level rises within a cycle.
    Blow,
    /// The end of a sustained excitation.
    Release,
    /// The record begins in the decay.
    RecordStart,
}

/// End of the samples of a free decay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DecayEnd {
    /// The next excitation.
    NextDecay,
    /// The end of the record.
    RecordEnd,
}

/// Place of a free decay in its record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FoundDecay {
    /// Index of the first sample of the blow, or of the first after the excitation.
    pub onset: usize,
    /// Index after the last sample before the next excitation, or of the record.
    pub end: usize,
    /// Origin of the decay.
    pub origin: DecayOrigin,
    /// End of the samples: the next excitation or the end of the record.
    pub ended_by: DecayEnd,
}

/// Levels of the blocks of a record, and the quiet level.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    values: Vec<f64>,
    block: usize,
    quiet: f64,
    largest: f64,
}

/// Finds the free decays of responses that are sampled together, without their force.
///
/// The level of a block of one cycle is the root of the sum over the responses of its mean square
/// about the median, each over the level of its quiet blocks. A decay begins
///
/// - at a blow: a block 2.5 times above the largest of the eight before it;
/// - after a sustained excitation: at the last block of at least 0.9 of its level;
///
/// and is accepted if the level then falls to a third. Beating, whose level rises again but not
/// above its largest of eight cycles, is not divided.
///
/// - `responses`: any units, not empty, of equal lengths.
/// - `cycle_hz`: frequency of the lowest strong mode, in hertz: a block is one of its cycles.
///
/// # Errors
/// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::SampleRate`],
/// [`SignalError::Option`], [`SignalError::Channels`] for responses of different lengths.
///
/// ```
/// use asperity_signal::{DecayOrigin, find_decays};
///
/// // Two blows, 0.5 s apart, on a mode at 200 Hz.
/// let rate = 1e4;
/// let ring = |t: f64| if t < 0.0 { 0.0 } else { (-20.0 * t).exp() * (1256.6 * t).sin() };
/// let record: Vec<f64> = (0..12_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| ring(t - 0.1) + 0.3 * ring(t - 0.6))
///     .collect();
/// let found = find_decays(&[&record], rate, 200.0)?;
/// assert_eq!(found.len(), 2);
/// assert!(found.iter().all(|decay| decay.origin == DecayOrigin::Blow));
/// assert!(found[1].onset.abs_diff(6000) < 5);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
pub fn find_decays(
    responses: &[&[f64]],
    sample_rate_hz: f64,
    cycle_hz: f64,
) -> Result<Vec<FoundDecay>> {
    let Some(first) = responses.first() else {
        return Err(SignalError::Channels { found: 0, expected: 1 });
    };
    check_rate(sample_rate_hz)?;
    check_positive("the frequency of a cycle", cycle_hz)?;
    for response in responses {
        check_samples("response", response)?;
        if response.len() != first.len() {
            let (force, response) = (first.len(), response.len());
            return Err(SignalError::LengthMismatch { force, response });
        }
    }
    let centred: Vec<Vec<f64>> = responses.iter().map(|response| about_median(response)).collect();
    let Some(levels) = Levels::of(&centred, sample_rate_hz / cycle_hz) else {
        return Ok(Vec::new());
    };
    let segments = levels.segments();
    let mut found: Vec<FoundDecay> = Vec::new();
    for (number, &(begin, is_jump)) in segments.iter().enumerate() {
        let next = segments.get(number + 1).copied();
        let end = next.map_or(levels.values.len(), |(begin, _)| begin);
        let Some((start, origin)) = levels.decay(begin, end, is_jump) else { continue };
        let begun = levels.onset(&centred, begin);
        // A blow may be in the first block.
        let struck = origin == DecayOrigin::RecordStart && begun >= FEWEST_BEFORE;
        let origin = if struck { DecayOrigin::Blow } else { origin };
        let onset = match origin {
            DecayOrigin::Blow => begun,
            DecayOrigin::RecordStart => 0,
            DecayOrigin::Release => (start + 1) * levels.block,
        };
        let (end, ended_by) = match next {
            // The block before a blow may contain its beginning.
            Some((at, true)) => (at.saturating_sub(1) * levels.block, DecayEnd::NextDecay),
            Some((at, false)) => (at * levels.block, DecayEnd::NextDecay),
            None => (first.len(), DecayEnd::RecordEnd),
        };
        if end > onset + levels.block {
            found.push(FoundDecay { onset, end, origin, ended_by });
        }
    }
    Ok(found)
}

/// Largest level of a record over its quiet level, and its fall after the largest: the evidence
/// where [`find_decays`] finds none. `None` for responses that are constant or shorter than a block.
pub fn level_range(responses: &[&[f64]], sample_rate_hz: f64, cycle_hz: f64) -> Option<(f64, f64)> {
    let centred: Vec<Vec<f64>> = responses.iter().map(|response| about_median(response)).collect();
    let levels = Levels::of(&centred, sample_rate_hz / cycle_hz)?;
    let largest = levels.values.iter().position(|level| *level >= levels.largest)?;
    let least = levels.values[largest..].iter().copied().fold(f64::INFINITY, f64::min);
    Some((levels.largest / levels.quiet, levels.largest / least))
}

fn about_median(samples: &[f64]) -> Vec<f64> {
    let median = robust_level(samples).map_or(0.0, |level| level.median);
    samples.iter().map(|x| x - median).collect()
}

/// The level below which a twentieth of the blocks lies; zero without a block.
fn quiet_level(levels: &[f64]) -> f64 {
    let mut sorted = levels.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((QUIET * levels.len() as f64) as usize).copied().unwrap_or(0.0)
}

impl Levels {
    /// Levels of blocks of `cycle` samples, 8 at least; `None` without a whole block or without a
    /// response that is not constant.
    fn of(centred: &[Vec<f64>], cycle: f64) -> Option<Self> {
        let block = (cycle.round() as usize).max(8);
        let count = centred.first()?.len() / block;
        let mut squares = vec![0.0; count];
        for samples in centred {
            let own: Vec<f64> = samples
                .chunks_exact(block)
                .map(|part| part.iter().map(|x| x * x).sum::<f64>())
                .collect();
            let least =
                quiet_level(&own).max(LEAST_POWER * own.iter().copied().fold(0.0, f64::max));
            if least > 0.0 {
                squares.iter_mut().zip(own).for_each(|(sum, square)| *sum += square / least);
            }
        }
        let values: Vec<f64> = squares.into_iter().map(f64::sqrt).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        let quiet = quiet_level(&values).max(LEAST_POWER.sqrt() * largest);
        (largest > 0.0).then_some(Self { values, block, quiet, largest })
    }

    /// First blocks of the stretches with one excitation each, and whether they begin with a blow.
    fn segments(&self) -> Vec<(usize, bool)> {
        let values = &self.values;
        let mut segments = vec![(0, false)];
        let mut rest = 0;
        let mut last_jump = None;
        for (k, &level) in values.iter().enumerate() {
            let before = values[k.saturating_sub(BEFORE)..k].iter().copied().fold(0.0, f64::max);
            let is_above = level > ABOVE_NOISE * self.quiet && level > LEAST * self.largest;
            if k > 0 && is_above && level > JUMP * before {
                // A blow near the end of a block rises again in the next.
                if last_jump.is_none_or(|last| k > last + 2) {
                    segments.push((k, true));
                }
                last_jump = Some(k);
            } else if rest >= BEFORE && is_above {
                segments.push((k, false));
            }
            if level <= NOISE * self.quiet {
                rest += 1;
            } else if is_above {
                rest = 0;
            }
        }
        segments
    }

    /// First block of the decay of a stretch, and its origin.
    fn decay(&self, begin: usize, end: usize, is_jump: bool) -> Option<(usize, DecayOrigin)> {
        let values = &self.values[begin..end];
        let largest = values.iter().copied().fold(0.0, f64::max);
        if largest < ABOVE_NOISE * self.quiet || largest < LEAST * self.largest {
            return None;
        }
        let last_above = |level: f64| values.iter().rposition(|value| *value >= level);
        let mut start = last_above(KNEE * largest)?;
        let over = values[start..].iter().position(|value| *value <= NOISE * self.quiet);
        let over = over.map_or(values.len(), |at| start + at);
        // A sustained excitation may begin with an overshoot.
        let run = (2 * BEFORE).max((over - start) / 8);
        let stationary = (start + run..=over).rev().find_map(|to| {
            let part = &values[to - run..to];
            let most = part.iter().copied().fold(0.0, f64::max);
            let least = part.iter().copied().fold(f64::INFINITY, f64::min);
            (most <= STATIONARY * least && least >= 0.2 * largest).then_some(least)
        });
        if let Some(level) = stationary.filter(|level| *level > 2.0 * NOISE * self.quiet) {
            start = last_above(KNEE * level)?;
        }
        let least = values[start..].iter().copied().fold(f64::INFINITY, f64::min);
        if values[start] < FALL * least {
            return None;
        }
        let origin = if start >= BEFORE || !(is_jump || begin == 0) {
            DecayOrigin::Release
        } else if is_jump {
            DecayOrigin::Blow
        } else {
            DecayOrigin::RecordStart
        };
        let start = if origin == DecayOrigin::Blow { begin } else { begin + start };
        Some((start, origin))
    }

    /// First sample of the blow in a block or the one before it: the first above 1.5 times the
    /// largest of the two blocks before.
    fn onset(&self, centred: &[Vec<f64>], block: usize) -> usize {
        let end = ((block + 1) * self.block).min(centred[0].len());
        let first = block.saturating_sub(1) * self.block;
        let before = first.saturating_sub(2 * self.block)..first;
        let rise = |samples: &Vec<f64>| {
            let level = samples[before.clone()].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let most = samples[first..end].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let limit = (1.5 * level).max(0.05 * most);
            samples[first..end].iter().position(|x| x.abs() > limit)
        };
        first + centred.iter().filter_map(rise).min().unwrap_or(self.block)
    }
}
