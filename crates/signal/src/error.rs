//! Errors of invalid samples and options.

use thiserror::Error as Derive;

/// The result of this crate's fallible functions.
pub(crate) type Result<T> = std::result::Result<T, SignalError>;

/// Invalid samples or options.
#[derive(Debug, Clone, PartialEq, Derive)]
#[non_exhaustive]
pub enum SignalError {
    /// A signal without samples.
    #[error("the {signal} has no samples; at least one is needed")]
    Empty {
        /// The signal.
        signal: &'static str,
    },
    /// Force and response of different lengths.
    #[error("{force} force samples but {response} response samples; the numbers must be equal")]
    LengthMismatch {
        /// Number of force samples.
        force: usize,
        /// Number of response samples.
        response: usize,
    },
    /// An infinite sample or one that is not a number.
    #[error("sample {index} of the {signal} is {value}; samples must be finite")]
    NotFinite {
        /// The signal.
        signal: &'static str,
        /// Index of the first such sample.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A sample rate that is not a positive finite number.
    #[error("the sample rate is {value} Hz; it must be positive and finite")]
    SampleRate {
        /// The rate given, in hertz.
        value: f64,
    },
    /// A zero padding outside the accepted range.
    #[error("the padding is {value}; it must be 1 to {limit}")]
    Padding {
        /// The padding factor given.
        value: usize,
        /// The largest factor accepted.
        limit: usize,
    },
    /// A force that is zero throughout, by which nothing can be divided.
    #[error("all {samples} force samples are zero; at least one must not be")]
    NoForce {
        /// Number of force samples.
        samples: usize,
    },
    /// An option outside its valid range.
    #[error("{quantity} is {value}, it must be {expected}")]
    Option {
        /// The option, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The values accepted, in words.
        expected: &'static str,
    },
    /// A number of response channels other than that announced.
    #[error("{found} response channels, {expected} expected")]
    Channels {
        /// Channels found.
        found: usize,
        /// Channels announced.
        expected: usize,
    },
    /// A record longer than the average it is added to.
    #[error("a record of {samples} samples; the average accepts at most {limit}")]
    TooLong {
        /// Samples of the record.
        samples: usize,
        /// The most samples accepted.
        limit: usize,
    },
    /// A force that does not rise above its noise.
    #[error("the largest force is {largest} N, a hit needs {needed} N in this noise")]
    NoHit {
        /// Largest force sample, in newtons.
        largest: f64,
        /// The force needed, in newtons.
        needed: f64,
    },
    /// Fewer hits than an averaged quantity needs.
    #[error("the {quantity} needs {needed} averages, there are {averages}")]
    TooFewAverages {
        /// The quantity.
        quantity: &'static str,
        /// Hits averaged so far.
        averages: usize,
        /// The fewest hits needed.
        needed: usize,
    },
}

/// Rejects an option (named in words) that is not positive and finite.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(SignalError::Option { quantity, value, expected: "positive and finite" })
    }
}

/// Rejects an empty signal and one with a sample that is not finite.
pub(crate) fn check_samples(signal: &'static str, samples: &[f64]) -> Result<()> {
    if samples.is_empty() {
        return Err(SignalError::Empty { signal });
    }
    match samples.iter().position(|sample| !sample.is_finite()) {
        Some(index) => Err(SignalError::NotFinite { signal, index, value: samples[index] }),
        None => Ok(()),
    }
}

/// Rejects a sample rate (Hz) that is not positive and finite.
pub(crate) fn check_rate(sample_rate_hz: f64) -> Result<()> {
    if sample_rate_hz.is_finite() && sample_rate_hz > 0.0 {
        Ok(())
    } else {
        Err(SignalError::SampleRate { value: sample_rate_hz })
    }
}
