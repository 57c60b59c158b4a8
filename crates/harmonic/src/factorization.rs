//! Gaussian elimination of dense matrices, of small ones without allocation.

use faer::linalg::solvers::{PartialPivLu, SolveCore};
use faer::{Conj, MatMut, MatRef};

use crate::vector_instructions::vectorised;

/// Rows from which on the factorisation is a blocked one.
const BLOCKED: usize = 200;

/// A square matrix by rows and its factors in place.
///
/// Newton's matrices of a stack have tens of rows: contiguous rows and no call overhead beat a blocked
/// factorisation, which matrices of structures with many contacts have. Rows are exchanged for the largest
/// pivot.
#[derive(Debug, Clone)]
pub(crate) struct Factorization {
    size: usize,
    rows: Vec<f64>,
    exchanged: Vec<usize>,
    /// The factors of a large matrix.
    blocked: Option<PartialPivLu<f64>>,
}

impl Factorization {
    pub(crate) fn new(size: usize) -> Self {
        Self { size, rows: vec![0.0; size * size], exchanged: vec![0; size], blocked: None }
    }

    /// The matrix, to be written by rows before [`factorize`](Self::factorize).
    pub(crate) fn matrix(&mut self) -> &mut [f64] {
        &mut self.rows
    }

    /// Factors the matrix written; false if it is singular or not finite.
    pub(crate) fn factorize(&mut self) -> bool {
        if self.size >= BLOCKED {
            let found = MatRef::from_row_major_slice(&self.rows, self.size, self.size);
            let found = found.partial_piv_lu();
            let pivots = found.U().diagonal().column_vector();
            let regular = (0..self.size).all(|i| pivots[i].is_finite() && pivots[i] != 0.0);
            self.blocked = Some(found);
            return regular;
        }
        vectorised(
            #[inline(always)]
            || {
                let n = self.size;
                for column in 0..n {
                    let (mut pivot, mut largest) = (column, 0.0);
                    for row in column..n {
                        let size = self.rows[row * n + column].abs();
                        if size > largest {
                            (pivot, largest) = (row, size);
                        }
                    }
                    if !(largest > 0.0 && largest.is_finite()) {
                        return false;
                    }
                    self.exchanged[column] = pivot;
                    let (above, below) = self.rows.split_at_mut((column + 1) * n);
                    let top = &mut above[column * n..];
                    if pivot > column {
                        top.swap_with_slice(
                            &mut below[(pivot - column - 1) * n..(pivot - column) * n],
                        );
                    }
                    let inverse = 1.0 / top[column];
                    let tail = &top[column + 1..];
                    for row in below.chunks_exact_mut(n) {
                        let factor = row[column] * inverse;
                        row[column] = factor;
                        if factor != 0.0 {
                            for (x, t) in row[column + 1..].iter_mut().zip(tail) {
                                *x -= factor * t;
                            }
                        }
                    }
                }
                true
            },
        )
    }

    /// Sign of the determinant of the matrix factored.
    pub(crate) fn determinant_sign(&self) -> f64 {
        if let Some(factors) = &self.blocked {
            let pivots = factors.U().diagonal().column_vector();
            let negative = (0..self.size).filter(|&i| pivots[i] < 0.0).count();
            let is_odd = (negative + exchanges(factors.P().arrays().0)) % 2 == 1;
            return if is_odd { -1.0 } else { 1.0 };
        }
        let exchanges = self.exchanged.iter().enumerate().filter(|(row, pivot)| row != *pivot);
        let negative = (0..self.size).filter(|&i| self.rows[i * self.size + i] < 0.0);
        if (exchanges.count() + negative.count()) % 2 == 0 { 1.0 } else { -1.0 }
    }

    /// Solves for one right-hand side, in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        if let Some(factors) = &self.blocked {
            let column = MatMut::from_column_major_slice_mut(x, self.size, 1);
            return factors.solve_in_place_with_conj(Conj::No, column);
        }
        let n = self.size;
        // Rows were exchanged whole, factors included, so all exchanges come first.
        for (column, &pivot) in self.exchanged.iter().enumerate() {
            x.swap(column, pivot);
        }
        for row in 1..n {
            let (known, rest) = x.split_at_mut(row);
            rest[0] -= dot(&self.rows[row * n..row * n + row], known);
        }
        for row in (0..n).rev() {
            let (rest, known) = x.split_at_mut(row + 1);
            let sum = dot(&self.rows[row * n + row + 1..(row + 1) * n], known);
            rest[row] = (rest[row] - sum) / self.rows[row * n + row];
        }
    }
}

/// Number of exchanges, but for even ones, that make a permutation.
fn exchanges(permutation: &[usize]) -> usize {
    let mut seen = vec![false; permutation.len()];
    let mut cycles = 0;
    for start in 0..permutation.len() {
        let mut at = start;
        cycles += usize::from(!seen[at]);
        while !std::mem::replace(&mut seen[at], true) {
            at = permutation[at];
        }
    }
    permutation.len() - cycles
}

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Matrices that need exchanges, a small one and a blocked one, against their known solution.
    #[test]
    fn solves_what_needs_pivots() {
        for n in [9, BLOCKED + 3] {
            check_pivots(n);
        }
        let mut two = Factorization::new(2);
        for (matrix, sign) in [([1.0, 2.0, 3.0, 4.0], -1.0), ([3.0, 4.0, 1.0, 2.0], 1.0)] {
            two.matrix().copy_from_slice(&matrix);
            assert!(two.factorize());
            assert_eq!(two.determinant_sign(), sign);
        }
    }

    fn check_pivots(n: usize) {
        let entry = |i: usize, j: usize| {
            if i == j { 0.0 } else { (1.3 * (i * n + j) as f64).sin() + 0.1 }
        };
        let exact: Vec<f64> = (0..n).map(|i| i as f64 - 3.0).collect();
        let mut x: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| entry(i, j) * exact[j]).sum()).collect();
        let mut factors = Factorization::new(n);
        for (i, row) in factors.matrix().chunks_exact_mut(n).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = entry(i, j);
            }
        }
        assert!(factors.factorize());
        factors.solve(&mut x);
        for (x, exact) in x.iter().zip(&exact) {
            assert!((x - exact).abs() < 1e-9 * n as f64, "{n}: {x} {exact}");
        }
    }

    /// The sign of a permuted and scaled unit matrix, which is the permutation's.
    #[test]
    fn signs_of_large_determinants() {
        let n = BLOCKED;
        for (shift, negative) in [(0, 0), (1, 0), (2, 0), (3, 1), (1, 2)] {
            let mut factors = Factorization::new(n);
            for row in 0..n {
                let value = if row < negative { -2.0 } else { 0.5 };
                factors.matrix()[row * n + (row + shift) % n] = value;
            }
            assert!(factors.factorize());
            // A cycle of n rows is n - 1 exchanges.
            let odd = (shift * (n - 1) + negative) % 2 == 1;
            assert_eq!(factors.determinant_sign(), if odd { -1.0 } else { 1.0 }, "{shift}");
        }
    }

    #[test]
    fn singular_matrices_are_found() {
        let mut factors = Factorization::new(2);
        factors.matrix().copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert!(!factors.factorize());
        factors.matrix().copy_from_slice(&[f64::NAN, 2.0, 2.0, 4.0]);
        assert!(!factors.factorize());
    }
}
