//! Solution of linear systems by products alone.

use crate::fourier::long_dot;
use crate::vector_instructions::vectorised;

/// Vectors kept before the iteration starts anew, and starts at most.
const KEPT: usize = 120;
const STARTS: usize = 4;

/// Solves `A x = b` by GMRES from `x = 0`, with `apply` writing `A v`, until the residual is below `accuracy` times
/// b; `b` holds x then. False if it does not get there.
///
/// The number of products is that of the eigenvalues of A away from the others: few where A is a unit matrix plus a
/// part of low rank and a small one. Source: Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 1986, 7, 856,
/// doi 10.1137/0907058.
pub(crate) fn solve(
    mut apply: impl FnMut(&[f64], &mut [f64]),
    b: &mut [f64],
    accuracy: f64,
) -> bool {
    let size = b.len();
    let wanted = accuracy * long_dot(b, b).sqrt();
    let mut x = vec![0.0; size];
    let mut residual = b.to_vec();
    for start in 0..STARTS {
        if start > 0 {
            apply(&x, &mut residual);
            residual.iter_mut().zip(&*b).for_each(|(r, b)| *r = b - *r);
        }
        let length = long_dot(&residual, &residual).sqrt();
        if !length.is_finite() {
            return false;
        }
        if length <= wanted {
            b.copy_from_slice(&x);
            return true;
        }
        let mut cycle = Cycle::new(&residual, length);
        while cycle.columns.len() < KEPT && cycle.left() > wanted {
            let mut next = vec![0.0; size];
            apply(&cycle.basis[cycle.columns.len()], &mut next);
            if !cycle.add(next) {
                break;
            }
        }
        cycle.add_solution(&mut x);
    }
    false
}

/// Arnoldi's iteration from a residual, with the least squares of its matrix by plane rotations.
struct Cycle {
    basis: Vec<Vec<f64>>,
    /// Columns of the triangular factor.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    /// The rotated right-hand side; the size of its last entry is the residual.
    target: Vec<f64>,
}

impl Cycle {
    fn new(residual: &[f64], length: f64) -> Self {
        let first = residual.iter().map(|r| r / length).collect();
        Self {
            basis: vec![first],
            columns: Vec::new(),
            rotations: Vec::new(),
            target: vec![length],
        }
    }

    /// Residual left.
    fn left(&self) -> f64 {
        self.target.last().map_or(0.0, |last| last.abs())
    }

    /// Adds the product of the last vector; false if the space is exhausted, or a number not finite.
    fn add(&mut self, mut next: Vec<f64>) -> bool {
        let before = long_dot(&next, &next).sqrt();
        let mut column: Vec<f64> = Vec::with_capacity(self.basis.len() + 1);
        vectorised(
            #[inline(always)]
            || {
                for vector in &self.basis {
                    let share: f64 = long_dot(&next, vector);
                    next.iter_mut().zip(vector).for_each(|(x, v)| *x -= share * v);
                    column.push(share);
                }
            },
        );
        let length = long_dot(&next, &next).sqrt();
        for (row, (cos, sin)) in self.rotations.iter().enumerate() {
            let (a, b) = (column[row], column[row + 1]);
            (column[row], column[row + 1]) = (cos * a + sin * b, cos * b - sin * a);
        }
        let last = column.len() - 1;
        let size = column[last].hypot(length);
        if !(size.is_finite() && size > 0.0) {
            return false;
        }
        let (cos, sin) = (column[last] / size, length / size);
        column[last] = size;
        let end = self.target[last];
        self.target[last] = cos * end;
        self.target.push(-sin * end);
        self.rotations.push((cos, sin));
        self.columns.push(column);
        let goes_on = length > 1e-15 * before;
        if goes_on {
            for x in &mut next {
                *x /= length;
            }
            self.basis.push(next);
        }
        goes_on
    }

    /// Adds the combination of the basis with the least residual.
    fn add_solution(&self, x: &mut [f64]) {
        let count = self.columns.len();
        let mut shares = self.target[..count].to_vec();
        for row in (0..count).rev() {
            let known: f64 = (row + 1..count).map(|j| self.columns[j][row] * shares[j]).sum();
            shares[row] = (shares[row] - known) / self.columns[row][row];
        }
        for (share, vector) in shares.iter().zip(&self.basis) {
            x.iter_mut().zip(vector).for_each(|(x, v)| *x += share * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factorization::Factorization;

    /// A matrix without symmetry, its solution by elimination; and the number of products for a unit matrix plus one of
    /// rank three, four with the one that ends.
    #[test]
    fn systems_are_solved() {
        const SIZE: usize = 150;
        let entry = |i: usize, j: usize| {
            let own = if i == j { 3.0 + (i % 5) as f64 } else { 0.0 };
            own + (1.7 * (i * SIZE + j) as f64).sin() * 0.2
        };
        let b: Vec<f64> = (0..SIZE).map(|i| (0.3 * i as f64).cos()).collect();
        let mut exact = b.clone();
        let mut factors = Factorization::new(SIZE);
        for (place, value) in factors.matrix().iter_mut().enumerate() {
            *value = entry(place / SIZE, place % SIZE);
        }
        assert!(factors.factorize());
        factors.solve(&mut exact);
        let times = |v: &[f64], out: &mut [f64]| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = (0..SIZE).map(|j| entry(i, j) * v[j]).sum();
            }
        };
        for accuracy in [1e-4, 1e-11] {
            let mut x = b.clone();
            assert!(solve(times, &mut x, accuracy));
            let off = x.iter().zip(&exact).map(|(x, e)| (x - e).abs()).fold(0.0, f64::max);
            assert!(off < 10.0 * accuracy && (accuracy < 1e-8 || off > 1e-9), "{off:.1e}");
        }
        let mut products = 0;
        let mut x = b.clone();
        let low_rank = |v: &[f64], out: &mut [f64]| {
            products += 1;
            let share = |k: usize| (0..SIZE).map(|j| ((k * j) as f64).sin() * v[j]).sum::<f64>();
            let shares = [share(1), share(2), share(3)];
            for (i, out) in out.iter_mut().enumerate() {
                let sum = |k: usize| ((i + k) as f64).cos() * shares[k];
                *out = v[i] + sum(0) - 2.0 * sum(1) + 0.5 * sum(2);
            }
        };
        assert!(solve(low_rank, &mut x, 1e-10));
        assert!(products <= 5, "{products}");
    }

    /// A singular matrix has no solution for most right-hand sides, and numbers that are not finite none at all.
    #[test]
    fn what_has_no_solution_is_told() {
        let first = |v: &[f64], out: &mut [f64]| (out[0], out[1]) = (v[0] + v[1], 0.0);
        assert!(!solve(first, &mut [1.0, 2.0], 1e-8));
        assert!(!solve(|_, out| out.fill(f64::NAN), &mut [1.0, 2.0], 1e-8));
        let mut zero = [0.0; 2];
        assert!(solve(first, &mut zero, 1e-8) && zero == [0.0; 2]);
    }
}
