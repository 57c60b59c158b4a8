//! The Sobol sequence with nested uniform scrambling, computed from the number of a row.
//!
//! ```text
//! x_j = XOR over the bits k set in the row of v_jk,
//! v_jk = m_jk / 2^k,  m_jk = 2 a_1 m_j,k-1 ^ 4 a_2 m_j,k-2 ^ ... ^ 2^s m_j,k-s ^ m_j,k-s
//! ```
//!
//! with the coefficients `a` of a primitive polynomial of degree `s`. Scrambling flips each binary
//! digit of `x_j` by a random bit, which is shared by all points with the same digits before it.
//!
//! Sources: P. Bratley, B. L. Fox, ACM Trans. Math. Softw. 14, 88 (1988), doi 10.1145/42288.214372;
//! A. B. Owen, Ann. Stat. 25, 1541 (1997), doi 10.1214/aos/1031594731.

use super::direction_numbers::{ROWS, Row};
use crate::hash::{hash, mix, open_unit};

/// Most coordinates.
pub(super) const MOST_DIMENSIONS: usize = ROWS.len() + 1;

/// Binary digits of the sequence; those of a coordinate beyond them are random.
const BITS: usize = 32;

/// The word that keeps the scrambling apart from other random numbers.
const SCRAMBLE: u64 = 4;

/// A scrambled Sobol sequence.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SobolSequence {
    /// Direction numbers and the key of the scrambling, by coordinate.
    coordinates: Vec<([u32; BITS], u64)>,
}

impl SobolSequence {
    /// The sequence in at most [`MOST_DIMENSIONS`].
    pub(super) fn new(dimensions: usize, seed: u64) -> Self {
        let key = |j| hash(seed, &[SCRAMBLE, j as u64]);
        let directions = std::iter::once(first_directions()).chain(ROWS.iter().map(directions));
        let coordinates = directions.take(dimensions).enumerate();
        Self { coordinates: coordinates.map(|(j, numbers)| (numbers, key(j))).collect() }
    }

    /// A coordinate of a row, in (0, 1).
    pub(super) fn coordinate(&self, row: u32, dimension: usize) -> f64 {
        let (directions, key) = &self.coordinates[dimension];
        open_unit(scrambled(digits(row, directions), *key))
    }
}

/// The digits of a row without scrambling, the first the most significant.
fn digits(row: u32, directions: &[u32; BITS]) -> u32 {
    let set = |k: &usize| row >> k & 1 == 1;
    (0..BITS).filter(set).fold(0, |digits, k| digits ^ directions[k])
}

/// Scrambled digits, followed by random ones.
fn scrambled(digits: u32, key: u64) -> u64 {
    let digits = u64::from(digits);
    let mut result = 0;
    for bit in 0..BITS {
        // The digits before this one, after a leading 1 that tells their number.
        let before = 1_u64 << bit | digits >> (BITS - bit);
        let flip = mix(key.wrapping_add(before.wrapping_mul(0xD6E8_FEB8_6659_FD93))) >> 63;
        let digit = digits >> (BITS - 1 - bit) & 1;
        result = result << 1 | (digit ^ flip);
    }
    let rest = hash(key, &[digits]) >> BITS;
    result << BITS | rest
}

fn first_directions() -> [u32; BITS] {
    std::array::from_fn(|k| 1 << (BITS - 1 - k))
}

fn directions(row: &Row) -> [u32; BITS] {
    let &(degree, coefficients, initial) = row;
    let mut directions = [0_u32; BITS];
    for k in 0..BITS {
        directions[k] = if k < degree {
            initial[k] << (BITS - 1 - k)
        } else {
            let mut next = directions[k - degree] ^ (directions[k - degree] >> degree);
            for i in 1..degree {
                if coefficients >> (degree - 1 - i) & 1 == 1 {
                    next ^= directions[k - i];
                }
            }
            next
        };
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The digits of an independent implementation with its own copy of the direction numbers.
    #[test]
    fn digits_are_those_of_another_implementation() {
        let plain = std::iter::once(first_directions()).chain(ROWS.iter().map(directions));
        for (dimension, directions) in plain.enumerate() {
            for row in (0_u32..1 << 16).step_by(101).chain([1, 2, 4, 0xffff]) {
                let reversed = sobol_burley::parts::sobol_rev(row.reverse_bits(), dimension as u32);
                // The other one has 16 direction numbers, of 16 digits.
                assert_eq!(digits(row, &directions) >> 16, reversed.reverse_bits() >> 16);
            }
        }
    }

    #[test]
    fn every_direction_number_is_odd_over_its_power_of_two() {
        for row in &ROWS {
            let (degree, coefficients, initial) = *row;
            assert_eq!(initial.len(), degree);
            assert!(coefficients < 1 << (degree - 1));
            for (k, direction) in directions(row).iter().enumerate() {
                assert_eq!(direction.trailing_zeros() as usize, BITS - 1 - k);
            }
        }
    }
}
