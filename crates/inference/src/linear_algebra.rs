//! Normal matrices and their triangular roots.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{
    qr_in_place, qr_in_place_scratch, recommended_block_size,
};
use faer::linalg::qr::no_pivoting::solve::{solve_lstsq_in_place, solve_lstsq_in_place_scratch};
use faer::linalg::svd::{ComputeSvdVectors, svd, svd_scratch};
use faer::{Mat, Par, Spec};

use crate::error::InferenceError;

/// `(A^T A)^-1` and a root `L` of it, `L L^T = (A^T A)^-1`.
pub(crate) struct InverseNormal {
    pub(crate) matrix: Vec<Vec<f64>>,
    /// Upper triangular in the order of the parameters.
    pub(crate) root: Vec<Vec<f64>>,
}

/// Inverts `A^T A` given the rows of `A`, by QR of `A` with columns scaled to unit length.
pub(crate) fn inverse_normal(
    rows: &[Vec<f64>],
    columns: usize,
    matrix: &'static str,
) -> Result<InverseNormal, InferenceError> {
    let singular = || InferenceError::Singular(matrix);
    let norm = |j: usize| rows.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
    let norms: Vec<f64> = (0..columns).map(norm).collect();
    if rows.len() < columns || norms.iter().any(|norm| !(norm.is_finite() && *norm > 0.0)) {
        return Err(singular());
    }
    let equilibrated = Mat::from_fn(rows.len(), columns, |i, j| rows[i][j] / norms[j]);
    let decomposition = Decomposition::new(&equilibrated);
    // R is solved for the unit vectors by substitution: R^-1 is upper triangular too.
    let mut root = vec![vec![0.0; columns]; columns];
    for (i, k) in (0..columns).flat_map(|k| (0..=k).rev().map(move |i| (i, k))) {
        let unit = if i == k { 1.0 } else { 0.0 };
        let known: f64 = (i + 1..=k).map(|j| decomposition.upper(i, j) * root[j][k]).sum();
        root[i][k] = (unit - known) / decomposition.upper(i, i);
    }
    for (row, norm) in root.iter_mut().zip(&norms) {
        for entry in row {
            *entry /= norm;
        }
    }
    if root.iter().flatten().any(|entry| !entry.is_finite()) {
        return Err(singular());
    }
    let matrix = root.iter().map(|a| root.iter().map(|b| dot(a, b)).collect()).collect();
    Ok(InverseNormal { matrix, root })
}

/// The upper triangular `U` with `U U^T = C`; `None` unless `C` is positive definite.
pub(crate) fn upper_root(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let size = matrix.len();
    let mut root = vec![vec![0.0; size]; size];
    for j in (0..size).rev() {
        for i in (0..=j).rev() {
            let known: f64 = (j + 1..size).map(|k| root[i][k] * root[j][k]).sum();
            let rest = matrix[i][j] - known;
            root[i][j] = if i == j { rest.sqrt() } else { rest / root[j][j] };
            if !(root[i][j].is_finite() && (i != j || root[i][j] > 0.0)) {
                return None;
            }
        }
    }
    Some(root)
}

/// `U z` for upper triangular `U`.
pub(crate) fn upper_times(root: &[Vec<f64>], z: &[f64]) -> Vec<f64> {
    let row = |i: usize| (i..z.len()).map(|k| root[i][k] * z[k]).sum();
    (0..z.len()).map(row).collect()
}

/// The `z` with `U z = y`.
pub(crate) fn upper_solve(root: &[Vec<f64>], y: &[f64]) -> Vec<f64> {
    let mut z = y.to_vec();
    for i in (0..y.len()).rev() {
        let known: f64 = (i + 1..y.len()).map(|k| root[i][k] * z[k]).sum();
        z[i] = (y[i] - known) / root[i][i];
    }
    z
}

/// Scalar product.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Correlation matrix of a covariance matrix.
pub(crate) fn correlation(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| matrix[i][j] / (matrix[i][i] * matrix[j][j]).sqrt();
    let size = matrix.len();
    (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect()
}
/// A QR decomposition of a matrix with at least as many rows as columns, by one thread: the last bits do
/// not depend on the number of others.
pub(crate) struct Decomposition {
    /// Householder vectors below the diagonal, R above.
    factors: Mat<f64>,
    coefficients: Mat<f64>,
}

impl Decomposition {
    pub(crate) fn new(matrix: &Mat<f64>) -> Self {
        let (rows, columns) = matrix.shape();
        let size = rows.min(columns);
        let block = recommended_block_size::<f64>(rows, columns);
        let (mut factors, mut coefficients) = (matrix.clone(), Mat::zeros(block, size));
        let scratch = qr_in_place_scratch::<f64>(rows, columns, block, Par::Seq, Spec::default());
        qr_in_place(
            factors.as_mut(),
            coefficients.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Spec::default(),
        );
        Self { factors, coefficients }
    }

    /// An entry of R, on the diagonal or above.
    pub(crate) fn upper(&self, row: usize, column: usize) -> f64 {
        self.factors[(row, column)]
    }

    /// The least-squares solution of `A x = values`, in the leading entries.
    pub(crate) fn solve(&self, values: &[f64]) -> Mat<f64> {
        let mut right = Mat::from_fn(values.len(), 1, |i, _| values[i]);
        let (rows, columns) = self.factors.shape();
        let block = self.coefficients.nrows();
        let scratch = solve_lstsq_in_place_scratch::<f64>(rows, columns, block, 1, Par::Seq);
        solve_lstsq_in_place(
            self.factors.as_ref(),
            self.coefficients.as_ref(),
            self.factors.get(..columns, ..),
            right.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
        right
    }
}

/// Singular values of a matrix with at least as many rows as columns, largest first, and the right
/// singular vectors; none if it has none. One thread: the last bits do not depend on the number of others.
pub(crate) fn right_singular_vectors(matrix: &Mat<f64>) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let (rows, count) = matrix.shape();
    let (mut values, mut vectors) = (Diag::zeros(count), Mat::zeros(count, count));
    let (left, right) = (ComputeSvdVectors::No, ComputeSvdVectors::Full);
    let scratch = svd_scratch::<f64>(rows, count, left, right, Par::Seq, Spec::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    let (into, right) = (values.as_mut(), Some(vectors.as_mut()));
    svd(matrix.as_ref(), into, None, right, Par::Seq, stack, Spec::default()).ok()?;
    let vector = |k: usize| (0..count).map(|j| vectors[(j, k)]).collect();
    Some((values.column_vector().iter().copied().collect(), (0..count).map(vector).collect()))
}

/// The outcome of `task`, compiled for the vector instructions of the machine. No sum changes its order and no product is
/// fused with a sum, so results are the same on all machines. What `task` calls must be compiled with it.
pub(crate) fn vectorised<R>(task: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(task)
}
