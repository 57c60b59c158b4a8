//! Offset of a sensor signal.

use crate::noise::robust_level;

/// Samples an offset was determined from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum OffsetSource {
    /// Samples before the trigger.
    PreTrigger,
    /// All samples near the median.
    Quiet,
}

/// The constant offset of a sensor signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// The offset, in the unit of the samples.
    pub value: f64,
    /// Standard deviation of the samples used, in the same unit.
    pub deviation: f64,
    /// Number of samples used.
    pub samples: usize,
    /// Samples used.
    pub source: OffsetSource,
}

/// Largest distance of quiet samples from the median, in robust deviations.
const QUIET: f64 = 5.0;
/// Fewest samples of an offset.
const FEWEST: usize = 8;

impl Offset {
    /// The mean before the trigger, without the last `guard` samples.
    ///
    /// The guard excludes the foot of the pulse and the ringing of
    /// anti-alias filters before it. `None` for fewer than 8 samples, or
    /// if one is not finite.
    pub fn before(samples: &[f64], trigger: usize, guard: usize) -> Option<Self> {
        let quiet = samples.get(..trigger.checked_sub(guard)?)?;
        Self::mean(quiet.iter().copied(), OffsetSource::PreTrigger)
    }

    /// The mean of the samples within five robust deviations of the median.
    ///
    /// Valid for a force, and for a response
    /// that has decayed in more than half of the record. `None` for fewer than 8 samples.
    pub fn at_rest(samples: &[f64]) -> Option<Self> {
        let level = robust_level(samples)?;
        let quiet = |x: &f64| (x - level.median).abs() <= QUIET * level.deviation;
        Self::mean(samples.iter().copied().filter(quiet), OffsetSource::Quiet)
    }

    /// The offset of a response: its mean before the trigger without the last quarter, else, with too few
    /// samples there, [`Offset::at_rest`].
    ///
    /// The mean exceeds five times its error, which is taken from the means of four parts, so that a
    /// vibration before the blow is no offset. `None` for a smaller one.
    ///
    /// ```
    /// use asperity_signal::Offset;
    /// let noise = |n: usize| if n % 3 == 0 { 0.01 } else { -0.005 };
    /// let response = |offset: f64| (0..400).map(|n| offset + noise(n)).collect::<Vec<f64>>();
    /// let found = Offset::of_response(&response(0.5), 200).map(|offset| offset.value);
    /// assert!(found.is_some_and(|value| (value - 0.5).abs() < 1e-3));
    /// assert_eq!(Offset::of_response(&response(0.0), 200), None);
    /// ```
    pub fn of_response(samples: &[f64], trigger: usize) -> Option<Self> {
        const PARTS: usize = 4;
        const SIGNIFICANT: f64 = 5.0;
        let quiet = samples.get(..trigger - trigger / 4).unwrap_or_default();
        let (found, samples) = match Self::before(samples, trigger, trigger / 4) {
            Some(found) => (found, quiet),
            None => (Self::at_rest(samples)?, samples),
        };
        let length = (samples.len() / PARTS).max(1);
        let means = samples
            .chunks_exact(length)
            .take(PARTS)
            .map(|part| part.iter().sum::<f64>() / part.len() as f64);
        let parts = Self { samples: PARTS, ..Self::spread(means, OffsetSource::Quiet) };
        let error = parts.standard_error().max(found.standard_error());
        (found.value.abs() > SIGNIFICANT * error).then_some(found)
    }

    /// Standard error of the offset for uncorrelated noise, in the unit of the samples.
    pub fn standard_error(&self) -> f64 {
        self.deviation / (self.samples as f64).sqrt()
    }

    /// Subtracts the offset.
    pub fn remove(&self, samples: &mut [f64]) {
        for sample in samples {
            *sample -= self.value;
        }
    }

    fn mean(quiet: impl Iterator<Item = f64>, source: OffsetSource) -> Option<Self> {
        let found = Self::spread(quiet, source);
        let usable = found.value.is_finite() && found.deviation.is_finite();
        (found.samples >= FEWEST && usable).then_some(found)
    }

    fn spread(quiet: impl Iterator<Item = f64>, source: OffsetSource) -> Self {
        // Welford: one pass, without cancellation if the offset is far above the noise.
        let (mut samples, mut value, mut square) = (0_usize, 0.0, 0.0);
        for x in quiet {
            samples += 1;
            let difference = x - value;
            value += difference / samples as f64;
            square += difference * (x - value);
        }
        let deviation = (square / (samples.max(2) - 1) as f64).sqrt();
        Self { value, deviation, samples, source }
    }
}
