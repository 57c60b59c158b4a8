//! The offset of a sensor.

use crate::noise::robust_level;

/// Where an offset was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OffsetSource {
    /// The mean of the samples before the trigger.
    PreTrigger,
    /// The mean of all samples that rest near the median.
    Quiet,
}

/// The constant added to a signal by its sensor, with the evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// The offset, in the samples' unit.
    pub value: f64,
    /// Standard deviation of the samples it was read from, in the same unit.
    pub deviation: f64,
    /// Number of samples it was read from.
    pub samples: usize,
    /// Where it was read.
    pub source: OffsetSource,
}

/// Quiet samples lie within this many robust deviations of the median.
const QUIET: f64 = 5.0;
/// Fewest samples with a mean and a deviation worth the name.
const FEWEST: usize = 8;

impl Offset {
    /// The mean before the trigger, the last `guard` samples left out.
    ///
    /// The guard keeps out the foot of the pulse, and the ringing that a steep
    /// anti-alias filter puts before it. `None` for fewer than 8 samples, or
    /// if one is not finite.
    pub fn before(samples: &[f64], trigger: usize, guard: usize) -> Option<Self> {
        let quiet = samples.get(..trigger.checked_sub(guard)?)?;
        Self::mean(quiet.iter().copied(), OffsetSource::PreTrigger)
    }

    /// The mean of the samples within five robust deviations of the median.
    ///
    /// For a force, which rests except during the blow; for a response only
    /// where more than half of the record has decayed. `None` for fewer than 8 samples.
    pub fn at_rest(samples: &[f64]) -> Option<Self> {
        let level = robust_level(samples)?;
        let quiet = |x: &f64| (x - level.median).abs() <= QUIET * level.deviation;
        Self::mean(samples.iter().copied().filter(quiet), OffsetSource::Quiet)
    }

    /// Standard error of the offset for uncorrelated noise, in the samples' unit.
    pub fn standard_error(&self) -> f64 {
        self.deviation / (self.samples as f64).sqrt()
    }

    /// Takes the offset away.
    pub fn remove(&self, samples: &mut [f64]) {
        for sample in samples {
            *sample -= self.value;
        }
    }

    fn mean(quiet: impl Iterator<Item = f64>, source: OffsetSource) -> Option<Self> {
        // Welford: one pass, and no loss where the offset is far above the noise.
        let (mut samples, mut value, mut square) = (0_usize, 0.0, 0.0);
        for x in quiet {
            samples += 1;
            let difference = x - value;
            value += difference / samples as f64;
            square += difference * (x - value);
        }
        let deviation = (square / (samples.max(2) - 1) as f64).sqrt();
        (samples >= FEWEST && value.is_finite() && deviation.is_finite()).then_some(Self {
            value,
            deviation,
            samples,
            source,
        })
    }
}
