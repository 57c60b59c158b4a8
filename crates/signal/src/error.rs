//! What can be wrong with a signal.

use thiserror::Error as Derive;

/// The result of this crate's fallible constructors.
pub(crate) type Result<T> = std::result::Result<T, SignalError>;

/// Why samples were refused.
#[derive(Debug, Clone, PartialEq, Derive)]
#[non_exhaustive]
pub enum SignalError {
    /// A signal without samples has no spectrum.
    #[error("the {signal} has no samples")]
    Empty {
        /// Which signal.
        signal: &'static str,
    },
    /// Force and response must be sampled together.
    #[error("{force} force samples but {response} response samples")]
    LengthMismatch {
        /// Number of force samples.
        force: usize,
        /// Number of response samples.
        response: usize,
    },
    /// A sample is infinite or not a number.
    #[error("sample {index} of the {signal} is {value}, not a finite number")]
    NotFinite {
        /// Which signal.
        signal: &'static str,
        /// Index of the first such sample.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The sample rate is not a positive finite number.
    #[error("the sample rate is {value} Hz, it must be positive and finite")]
    SampleRate {
        /// The rate given, in hertz.
        value: f64,
    },
    /// The zero padding is outside what a spectrum accepts.
    #[error("padding {value} is outside 1 to {limit}")]
    Padding {
        /// The padding factor given.
        value: usize,
        /// The largest factor accepted.
        limit: usize,
    },
    /// Every force sample is zero, so nothing can be divided by the force.
    #[error("all {samples} force samples are zero")]
    NoForce {
        /// Number of force samples.
        samples: usize,
    },
    /// An option is outside what makes sense.
    #[error("{quantity} is {value}, it must be {expected}")]
    Option {
        /// Which option, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// A block holds another number of response channels than announced.
    #[error("{found} response channels, {expected} expected")]
    Channels {
        /// Channels in the block.
        found: usize,
        /// Channels announced.
        expected: usize,
    },
    /// A record is longer than what it is averaged with.
    #[error("a record of {samples} samples, at most {limit} fit the average")]
    TooLong {
        /// Samples of the record.
        samples: usize,
        /// The most samples accepted.
        limit: usize,
    },
    /// No force sample stands out from the noise.
    #[error("the largest force is {largest} N, a hit needs {needed} N in this noise")]
    NoHit {
        /// Largest force sample, in newtons.
        largest: f64,
        /// What it would have to exceed, in newtons.
        needed: f64,
    },
    /// A quantity that only an average of several hits has.
    #[error("the {quantity} needs {needed} averages, there are {averages}")]
    TooFewAverages {
        /// What was asked for.
        quantity: &'static str,
        /// Hits averaged so far.
        averages: usize,
        /// The fewest that give an answer.
        needed: usize,
    },
}

/// Refuses an option (named in words) that is not positive and finite.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(SignalError::Option { quantity, value, expected: "positive and finite" })
    }
}

/// Refuses an empty signal and one with a sample that is not finite.
pub(crate) fn check_samples(signal: &'static str, samples: &[f64]) -> Result<()> {
    if samples.is_empty() {
        return Err(SignalError::Empty { signal });
    }
    match samples.iter().position(|sample| !sample.is_finite()) {
        Some(index) => Err(SignalError::NotFinite { signal, index, value: samples[index] }),
        None => Ok(()),
    }
}

/// Refuses a sample rate (Hz) that is not positive and finite.
pub(crate) fn check_rate(sample_rate_hz: f64) -> Result<()> {
    if sample_rate_hz.is_finite() && sample_rate_hz > 0.0 {
        Ok(())
    } else {
        Err(SignalError::SampleRate { value: sample_rate_hz })
    }
}
