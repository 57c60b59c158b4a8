//! The sparse factorisation of a shifted stiffness matrix, behind which its crate is hidden.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::Perm;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, Mat, MatMut, Par, Side, Spec};

use super::dissection;
use super::supernodes::{self, SIDES};
use crate::{MeshError, SparseBody};

/// Most columns that are solved for at once: more take more memory and little less time.
const AT_ONCE: usize = 32;

/// `K + shift M = L L^T`.
pub(super) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Factor {
    /// Factorises `K + shift M`.
    ///
    /// # Errors
    /// [`MeshError::Matrix`] unless the matrix is positive definite and its factor fits into memory.
    pub(super) fn new(body: &SparseBody, shift: f64) -> Result<Self, MeshError> {
        let matrix = body.shifted(shift);
        let fault = |problem| MeshError::Matrix { matrix: "stiffness", problem };
        let large = |_| fault("too large for the memory");
        let size = body.size();
        let forward = dissection::order(matrix.symbolic(), body.places());
        let permutation = forward.map(|forward| {
            let mut inverse = vec![0; size];
            for (new, &old) in forward.iter().enumerate() {
                inverse[old] = new;
            }
            Perm::new_checked(forward.into(), inverse.into(), size)
        });
        let ordering = match &permutation {
            Some(permutation) => SymmetricOrdering::Custom(permutation.as_ref()),
            None => SymmetricOrdering::Amd,
        };
        let parameters = CholeskySymbolicParams::default();
        let symbolic =
            factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, ordering, parameters)
                .map_err(large)?;
        let mut values = Vec::new();
        values
            .try_reserve_exact(symbolic.len_val())
            .map_err(|_| fault("too large for the memory"))?;
        values.resize(symbolic.len_val(), 0.0);
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut buffer =
            MemBuffer::try_new(scratch).map_err(|_| fault("too large for the memory"))?;
        let factorised = symbolic.factorize_numeric_llt(
            &mut values,
            matrix.as_ref(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut buffer),
            Spec::default(),
        );
        match factorised.map(|_| ()) {
            Ok(()) => Ok(Self { symbolic, values }),
            Err(_) => {
                Err(fault("not positive semidefinite, or massless in a motion without stiffness"))
            }
        }
    }

    /// Replaces the columns of `right` by the solutions for them. Pieces of many columns are solved for side by
    /// side; they depend on the number of columns alone, and so do the results.
    pub(super) fn solve(&self, right: &mut Mat<f64>) {
        let columns = right.ncols();
        let piece = if columns > SIDES { AT_ONCE.min(columns.div_ceil(2)) } else { SIDES };
        self.solve_pieces(right.as_mut(), piece);
    }

    fn solve_pieces(&self, right: MatMut<'_, f64>, piece: usize) {
        let pieces = right.ncols().div_ceil(piece);
        if pieces > 1 {
            let (left, right) = right.split_at_col_mut(pieces / 2 * piece);
            rayon::join(|| self.solve_pieces(left, piece), || self.solve_pieces(right, piece));
            return;
        }
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) if right.ncols() <= SIDES => {
                self.solve_few(SupernodalLltRef::new(symbolic, &self.values), right);
            }
            _ => self.solve_many(right),
        }
    }

    fn solve_many(&self, right: MatMut<'_, f64>) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(right.ncols(), Par::Seq);
        let mut buffer = MemBuffer::new(scratch);
        let factor = LltRef::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, right, Par::Seq, MemStack::new(&mut buffer));
    }

    /// Solves for at most [`SIDES`] columns.
    fn solve_few(&self, factor: SupernodalLltRef<'_, usize, f64>, mut right: MatMut<'_, f64>) {
        let columns = right.ncols();
        let order = self.symbolic.perm().map(|perm| perm.arrays().0);
        let place = |row: usize| order.map_or(row, |order| order[row]);
        let mut rows = vec![[0.0; SIDES]; right.nrows()];
        for (number, row) in rows.iter_mut().enumerate() {
            for (column, value) in row.iter_mut().enumerate().take(columns) {
                *value = right[(place(number), column)];
            }
        }
        supernodes::solve(factor, &mut rows);
        for (number, row) in rows.iter().enumerate() {
            for (column, value) in row.iter().enumerate().take(columns) {
                right[(place(number), column)] = *value;
            }
        }
    }
}
