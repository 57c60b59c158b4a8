//! Random numbers for samples of laws.

use std::ops::RangeInclusive;

/// A source of random numbers: of a seeded generator, of a property test, or of the bytes of a fuzzer.
pub trait Draw {
    /// The next number, uniform in `[0, 1)`.
    fn unit(&mut self) -> f64;

    /// A number in `[low, high)`, with four significant digits.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        rounded(low + (high - low) * self.unit())
    }

    /// A number whose logarithm is uniform between those of two positive bounds, with four
    /// significant digits.
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        rounded(low * (high / low).powf(self.unit()))
    }

    /// True with this probability.
    fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// A whole number of the range, with equal probabilities.
    fn whole(&mut self, range: RangeInclusive<usize>) -> usize {
        let (first, last) = (*range.start(), *range.end());
        first + ((self.unit() * (last - first + 1) as f64) as usize).min(last - first)
    }
}

/// `value` with four significant digits, so that files stay short and no rounding of a machine
/// shows in them.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
