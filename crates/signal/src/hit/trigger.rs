//! Trigger level and length of hits.

use crate::error::{Result, SignalError, check_positive};
use crate::noise::robust_level;

/// The force at which a hit begins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TriggerLevel {
    /// A force, in newtons.
    Absolute(f64),
    /// A fraction of the largest force in the record, 0 to 1.
    Fraction(f64),
    /// A level between the noise and the hits, from the record itself.
    ///
    /// The peaks of every pulse above `10` robust deviations from the
    /// median (and 1e-3 of the largest) are sorted, preceded by that bound. The
    /// level is the geometric mean of the two values on either side of the widest gap of their
    /// logarithms. It fails if one spike exceeds the hits by more than the hits exceed the noise.
    Automatic,
}

/// Length of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HitLength {
    /// This many samples, the pre-trigger included; further pulses inside belong to the same hit.
    Samples(usize),
    /// Up to the pre-trigger of the next hit, but at most this many samples.
    UntilNext {
        /// The most samples of a hit, the pre-trigger included.
        limit: usize,
    },
}

impl HitLength {
    /// The most samples a hit can have.
    pub fn most(self) -> usize {
        match self {
            Self::Samples(samples) => samples,
            Self::UntilNext { limit } => limit,
        }
    }
}

/// Options of the division of records into hits.
#[derive(Debug, Clone, PartialEq)]
pub struct HitOptions {
    /// Trigger level; the force is positive when the hammer pushes.
    pub trigger_level: TriggerLevel,
    /// Samples kept before the trigger, fewer at the beginning of the record.
    pub pre_trigger: usize,
    /// Length of a hit.
    pub length: HitLength,
    /// Samples after a trigger in which no further hit begins.
    ///
    /// With [`HitLength::UntilNext`] it must exceed the pre-trigger.
    pub hold_off: usize,
}

impl HitOptions {
    /// Rejects a length without samples after the trigger and a hold-off that is too short.
    pub(super) fn check(&self) -> Result<()> {
        if self.length.most() < self.pre_trigger.saturating_add(2) {
            let value = self.length.most() as f64;
            let expected = "at least two samples longer than the pre-trigger";
            return Err(SignalError::Option { quantity: "the length of a hit", value, expected });
        }
        let until_next = matches!(self.length, HitLength::UntilNext { .. });
        if until_next && self.hold_off <= self.pre_trigger {
            let value = self.hold_off as f64;
            let expected = "longer than the pre-trigger";
            return Err(SignalError::Option { quantity: "the hold-off", value, expected });
        }
        Ok(())
    }
}

/// The trigger level used, with the noise and the largest force of the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trigger {
    /// The level, in newtons.
    pub level_n: f64,
    /// Robust standard deviation of the force over the whole record, in newtons.
    pub noise_n: f64,
    /// The largest force, in newtons.
    pub largest_n: f64,
}

/// Smallest peak of the automatic level, over the noise.
const NOISE_FACTOR: f64 = 10.0;
/// Smallest peak of the automatic level, over the largest force.
const LEAST_FRACTION: f64 = 1e-3;
/// Smallest ratio of the largest force to the smallest peak.
const LEAST_GAP: f64 = 2.0;

impl Trigger {
    /// The trigger level of a record.
    ///
    /// # Errors
    /// [`SignalError::Option`] for a level that is not positive and finite or a
    /// fraction above 1; [`SignalError::NoHit`] if the force does not rise above the noise
    /// (automatic) or is nowhere positive (fraction).
    pub fn of(force: &[f64], options: &HitOptions) -> Result<Self> {
        let level = robust_level(force);
        let noise_n = level.map_or(0.0, |level| level.deviation);
        let largest_n = force.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        let level_n = match options.trigger_level {
            TriggerLevel::Absolute(newtons) => {
                check_positive("the trigger level", newtons)?;
                newtons
            }
            TriggerLevel::Fraction(fraction) => {
                if !(fraction > 0.0 && fraction <= 1.0) {
                    let (quantity, expected) = ("the trigger fraction", "above 0 and at most 1");
                    return Err(SignalError::Option { quantity, value: fraction, expected });
                }
                if largest_n <= 0.0 {
                    return Err(SignalError::NoHit { largest: largest_n, needed: 0.0 });
                }
                fraction * largest_n
            }
            TriggerLevel::Automatic => {
                let offset = level.map_or(0.0, |level| level.median);
                Self::automatic(force, offset, noise_n, options.hold_off)?
            }
        };
        Ok(Self { level_n, noise_n, largest_n })
    }

    /// The level of [`TriggerLevel::Automatic`], in newtons.
    fn automatic(force: &[f64], offset: f64, noise: f64, hold_off: usize) -> Result<f64> {
        let above = |x: f64| x - offset;
        let largest = force.iter().copied().filter(|x| x.is_finite()).map(above);
        let largest = largest.fold(0.0, f64::max);
        let bound = (NOISE_FACTOR * noise).max(LEAST_FRACTION * largest);
        if largest.is_nan() || largest <= LEAST_GAP * bound {
            return Err(SignalError::NoHit {
                largest: largest + offset,
                needed: LEAST_GAP * bound,
            });
        }
        let mut peaks = vec![bound];
        let mut begun: Option<usize> = None;
        for (index, x) in force.iter().copied().map(above).enumerate() {
            let inside = begun.is_some_and(|begin| index - begin <= hold_off);
            if let (true, Some(peak)) = (inside, peaks.last_mut()) {
                *peak = peak.max(x);
            } else if x > bound {
                begun = Some(index);
                peaks.push(x);
            }
        }
        peaks.sort_by(f64::total_cmp);
        let gap = |pair: &&[f64]| pair[1] / pair[0];
        let widest = peaks.windows(2).max_by(|a, b| gap(a).total_cmp(&gap(b)));
        let middle = widest.map_or(bound, |pair| (pair[0] * pair[1]).sqrt());
        Ok(offset + middle)
    }
}
