//! Random numbers without a state: a hash of the seed and of the place where a number is used.
//!
//! ```text
//! h_0 = mix(seed + c),  h_(i+1) = mix(h_i + c + word_i)
//! ```
//!
//! with `c` the odd integer next to `2^64` over the golden ratio. `mix` is the finaliser of
//! `SplitMix64`.
//!
//! Source: G. L. Steele, D. Lea, C. H. Flood, Fast splittable pseudorandom number generators,
//! OOPSLA 2014, doi 10.1145/2660193.2660195.

const INCREMENT: u64 = 0x9E37_79B9_7F4A_7C15;

/// A bijection of 64 bits, each output bit of which depends on all input bits.
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// 64 random bits of a seed and a place.
pub(crate) fn hash(seed: u64, place: &[u64]) -> u64 {
    place.iter().fold(mix(seed.wrapping_add(INCREMENT)), |state, word| {
        mix(state.wrapping_add(INCREMENT).wrapping_add(*word))
    })
}

/// The number in (0, 1) of the upper 52 of 64 random bits: the middle of one of `2^52` cells, so
/// that neither end is met.
pub(crate) fn open_unit(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// Place of `index` in a random permutation of `0..length`, by a Feistel network over the next even
/// number of bits that is applied until the place is in range (cycle walking).
///
/// Source: J. Black, P. Rogaway, Ciphers with arbitrary finite domains, CT-RSA 2002, doi
/// 10.1007/3-540-45760-7_9.
pub(crate) fn permuted(index: u64, length: u64, key: u64) -> u64 {
    const ROUNDS: u64 = 8;
    // Networks over fewer bits reach permutations unequally.
    const LEAST_HALF: u32 = 3;
    let bits = 64 - length.saturating_sub(1).leading_zeros();
    let half = bits.div_ceil(2).max(LEAST_HALF);
    let mask = (1_u64 << half) - 1;
    let mut place = index;
    loop {
        let (mut left, mut right) = (place >> half, place & mask);
        for round in 0..ROUNDS {
            (left, right) = (right, left ^ (hash(key, &[round, right]) & mask));
        }
        place = (left << half) | right;
        if place < length {
            return place;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_numbers_never_meet_the_ends() {
        assert!(open_unit(0) > 0.0);
        assert!(open_unit(u64::MAX) < 1.0);
        assert_eq!(open_unit(1 << 63), 0.5 + 0.5 / (1_u64 << 52) as f64);
    }

    #[test]
    fn permutations_hold_every_place_once() {
        for length in [1, 2, 3, 7, 64, 65, 1000] {
            let mut places: Vec<u64> = (0..length).map(|i| permuted(i, length, 5)).collect();
            let identity: Vec<u64> = (0..length).collect();
            assert!(length < 7 || places != identity);
            places.sort_unstable();
            assert_eq!(places, identity);
        }
    }

    /// All 24 permutations of four places appear equally often: chi-square with 23 degrees of
    /// freedom stays below its 0.9999 quantile.
    #[test]
    fn permutations_are_equally_frequent() {
        const KEYS: u64 = 24_000;
        let mut counts = std::collections::BTreeMap::new();
        for key in 0..KEYS {
            let permutation = [0, 1, 2, 3].map(|i| permuted(i, 4, hash(key, &[])));
            *counts.entry(permutation).or_insert(0_u64) += 1;
        }
        assert_eq!(counts.len(), 24);
        let expected = KEYS as f64 / 24.0;
        let chi: f64 = counts.values().map(|&n| (n as f64 - expected).powi(2) / expected).sum();
        assert!(chi < 57.0, "chi-square {chi}");
    }
}
