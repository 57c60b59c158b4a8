//! The linear equations of a Newton correction, in every lane.
//!
//! The matrix `I + B K` has the pivots of a positive definite one, so elimination needs no
//! pivoting, and its determinant is at least one.

use pulp::Simd;

use crate::modal::simd::block::{Contacts, LanePair};

/// Replaces a matrix by its factors for [`solve_factored`]: the inverse of up to two equations, by Cramer's rule with one
/// division, or else the factors of elimination with the inverse pivots on the diagonal.
#[inline(always)]
pub(super) fn factor<S: Simd, const N: usize>(
    simd: S,
    equations: usize,
    matrix: &mut [Contacts<S, N>],
) {
    let pair = LanePair(simd);
    let one = pair.splat(1.0);
    if N == 2 {
        let ([a, b], [c, d]) =
            ([matrix[0][0], matrix[0][N - 1]], [matrix[N - 1][0], matrix[N - 1][N - 1]]);
        let inverse = pair.div(one, pair.less_mul(b, c, pair.mul(a, d)));
        let less = pair.sub(pair.splat(0.0), inverse);
        matrix[0][0] = pair.mul(d, inverse);
        matrix[0][N - 1] = pair.mul(b, less);
        matrix[N - 1][0] = pair.mul(c, less);
        matrix[N - 1][N - 1] = pair.mul(a, inverse);
        return;
    }
    for k in 0..equations {
        let inverse = pair.div(one, matrix[k][k]);
        matrix[k][k] = inverse;
        for j in k + 1..equations {
            matrix[k][j] = pair.mul(matrix[k][j], inverse);
        }
        for i in k + 1..equations {
            let below = matrix[i][k];
            for j in k + 1..equations {
                matrix[i][j] = pair.less_mul(below, matrix[k][j], matrix[i][j]);
            }
        }
    }
}

/// The solution of equations that were factored.
#[inline(always)]
pub(super) fn solve_factored<S: Simd, const N: usize>(
    simd: S,
    equations: usize,
    factors: &[Contacts<S, N>],
    mut right: Contacts<S, N>,
) -> Contacts<S, N> {
    let pair = LanePair(simd);
    if N == 2 {
        let [r, s] = [right[0], right[N - 1]];
        right[0] = pair.mul_add(factors[0][N - 1], s, pair.mul(factors[0][0], r));
        right[N - 1] = pair.mul_add(factors[N - 1][0], r, pair.mul(factors[N - 1][N - 1], s));
        return right;
    }
    for k in 0..equations {
        right[k] = pair.mul(right[k], factors[k][k]);
        for i in k + 1..equations {
            right[i] = pair.less_mul(factors[i][k], right[k], right[i]);
        }
    }
    for k in (0..equations).rev() {
        for i in 0..k {
            right[i] = pair.less_mul(factors[i][k], right[k], right[i]);
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const N: usize>(matrix: [[f64; N]; N]) {
        let simd = pulp::Scalar::new();
        let solution: [f64; N] = std::array::from_fn(|i| 1.0 + i as f64);
        // The second lane has the transposed equations.
        let both: [[[f64; 2]; N]; N] =
            std::array::from_fn(|i| std::array::from_fn(|j| [matrix[i][j], matrix[j][i]]));
        let right: [[f64; 2]; N] = std::array::from_fn(|i| {
            let sum =
                |of: &dyn Fn(usize) -> f64| -> f64 { (0..N).map(|j| of(j) * solution[j]).sum() };
            [sum(&|j| matrix[i][j]), sum(&|j| matrix[j][i])]
        });
        let mut factors = both;
        factor(simd, N, &mut factors);
        for (found, exact) in solve_factored(simd, N, &factors, right).iter().zip(&solution) {
            // A few roundings of numbers up to ten.
            assert!(found.iter().all(|x| (x - exact).abs() < 1e-14), "{found:?} {exact}");
        }
    }

    /// Against solutions chosen beforehand, by the inverse and by elimination.
    #[test]
    fn equations_are_solved() {
        check([[1.7]]);
        check([[1.5, 0.4], [-0.3, 2.0]]);
        check([[2.0, 0.5, -0.3], [0.4, 1.8, 0.2], [-0.6, 0.1, 1.5]]);
    }
}
