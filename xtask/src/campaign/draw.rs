//! Seeded random numbers for scenarios.

use asperity_law::Draw as _;
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

    /// One of several, with equal probabilities.
    pub(super) fn one_of<'a, T>(&mut self, options: &'a [T]) -> &'a T {
        &options[self.whole(0..=options.len() - 1)]
    }

    /// The place of one of several, with probabilities in proportion to their weights.
    pub(super) fn weighted(&mut self, weights: &[f64]) -> usize {
        let mut left = weights.iter().sum::<f64>() * self.unit();
        for (place, weight) in weights.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                return place;
            }
        }
        weights.len() - 1
    }
}

impl asperity_law::Draw for Draw {
    fn unit(&mut self) -> f64 {
        self.0.random()
    }
}
