//! Storage for vectors of any instruction set.

use pulp::{Simd, bytemuck};

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;
const NUMBERS_A_LINE: usize = LINE / size_of::<f64>();

/// Numbers that start at a cache line, read as vectors or one by one.
///
/// A vector type has no more than the alignment of its elements; a vector
/// that straddles two cache lines costs twice, and one that was stored so is
/// not forwarded to the load that follows.
#[derive(Debug, Clone)]
pub(super) struct Lanes {
    numbers: Vec<f64>,
    start: usize,
    length: usize,
}

impl Lanes {
    /// `length` zeros; for the vectors of any set, a multiple of 8.
    pub(super) fn zeros(length: usize) -> Self {
        let numbers = vec![0.0; length + NUMBERS_A_LINE];
        // An allocation of numbers can always be aligned within a line of them.
        let start = numbers.as_ptr().align_offset(LINE).min(NUMBERS_A_LINE);
        Self { numbers, start, length }
    }

    pub(super) fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.start..self.start + self.length]
    }

    pub(super) fn vectors_mut<S: Simd>(&mut self) -> &mut [S::f64s] {
        bytemuck::cast_slice_mut(self.numbers_mut())
    }
}

/// Vectors seen as the numbers they hold.
#[inline(always)]
pub(super) fn numbers<S: Simd>(vectors: &[S::f64s]) -> &[f64] {
    bytemuck::cast_slice(vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_start_at_a_cache_line() {
        for length in [8, 16, 24, 232] {
            let mut lanes = Lanes::zeros(length);
            assert_eq!(lanes.numbers_mut().as_ptr() as usize % LINE, 0);
            assert_eq!(lanes.numbers_mut().len(), length);
        }
    }
}
