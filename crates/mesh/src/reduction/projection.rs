//! Products of tall matrices in pieces of their rows, side by side.
//!
//! The pieces depend on the number of rows alone, and so do the results.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Most rows of a piece.
const ROWS: usize = 16_384;

/// `left^T right`.
pub(super) fn along(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Mat<f64> {
    if left.nrows() <= ROWS {
        return left.transpose() * right;
    }
    let middle = left.nrows() / 2;
    let (upper_left, lower_left) = left.split_at_row(middle);
    let (upper_right, lower_right) = right.split_at_row(middle);
    let (upper, lower) =
        rayon::join(|| along(upper_left, upper_right), || along(lower_left, lower_right));
    upper + lower
}

/// `vectors -= basis along`.
pub(super) fn take_off(vectors: MatMut<'_, f64>, basis: MatRef<'_, f64>, along: MatRef<'_, f64>) {
    if basis.nrows() <= ROWS {
        return matmul(vectors, Accum::Add, basis, along, -1.0, Par::Seq);
    }
    let middle = basis.nrows() / 2;
    let (upper, lower) = vectors.split_at_row_mut(middle);
    let (upper_basis, lower_basis) = basis.split_at_row(middle);
    rayon::join(|| take_off(upper, upper_basis, along), || take_off(lower, lower_basis, along));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_those_of_one_product() {
        let entry = |i: usize, j: usize| ((i * 7919 + j * 104_729) % 1009) as f64 / 1009.0 - 0.5;
        let (basis, mut vectors) =
            (Mat::from_fn(5 * ROWS + 3, 5, entry), Mat::from_fn(5 * ROWS + 3, 3, entry));
        let expected = basis.transpose() * &vectors;
        let found = along(basis.as_ref(), vectors.as_ref());
        assert!((&found - &expected).norm_max() < 1e-9);
        let expected = &vectors - &basis * &found;
        take_off(vectors.as_mut(), basis.as_ref(), found.as_ref());
        assert!((&vectors - &expected).norm_max() < 1e-9);
    }
}
