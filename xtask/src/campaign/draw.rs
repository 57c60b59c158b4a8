//! Seeded random numbers for scenarios.

use std::ops::RangeInclusive;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A stream of random numbers that depends on a seed and two numbers alone.
pub(super) struct Draw(Pcg64);

impl Draw {
    /// The stream of scenario `number` of a campaign with this seed, at its `attempt`.
    pub(super) fn new(seed: u64, number: u64, attempt: u64) -> Self {
        // The finaliser of splitmix64 keeps neighbouring streams apart.
        let mix = |mut x: u64| {
            x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            x ^ (x >> 31)
        };
        let step = |state: u64, part: u64| mix(state.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ part);
        Self(Pcg64::seed_from_u64(step(step(step(0, seed), number), attempt)))
    }

    /// A number in `[low, high)`, with four significant digits.
    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        rounded(low + (high - low) * self.0.random::<f64>())
    }

    /// A number whose logarithm is uniform between those of two positive bounds, with four
    /// significant digits.
    pub(super) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        rounded(low * (high / low).powf(self.0.random::<f64>()))
    }

    /// True with this probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// A whole number of the range.
    pub(super) fn whole(&mut self, range: RangeInclusive<usize>) -> usize {
        self.0.random_range(range)
    }

    /// One of several, with equal probabilities.
    pub(super) fn one_of<'a, T>(&mut self, options: &'a [T]) -> &'a T {
        &options[self.whole(0..=options.len() - 1)]
    }

    /// The place of one of several, with probabilities in proportion to their weights.
    pub(super) fn weighted(&mut self, weights: &[f64]) -> usize {
        let mut left = weights.iter().sum::<f64>() * self.0.random::<f64>();
        for (place, weight) in weights.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                return place;
            }
        }
        weights.len() - 1
    }
}

/// `value` with four significant digits, so that files stay short and no rounding of a machine
/// shows in them.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
