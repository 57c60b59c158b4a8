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
use super::elimination_tree::Branch;
use super::supernodes::{self, SIDES};
use crate::{MeshError, SparseBody};

/// Most columns that are solved for at once: more take more memory and little less time.
const AT_ONCE: usize = 32;

/// `K + shift M = L L^T`.
pub(super) struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// Of a factor in dense columns.
    tree: Option<Branch>,
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
            Ok(()) => {
                let tree = match symbolic.raw() {
                    SymbolicCholeskyRaw::Supernodal(columns) => Branch::of(columns),
                    SymbolicCholeskyRaw::Simplicial(_) => None,
                };
                Ok(Self { symbolic, values, tree })
            }
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
        match (self.symbolic.raw(), &self.tree) {
            (SymbolicCholeskyRaw::Supernodal(symbolic), Some(tree)) if right.ncols() <= SIDES => {
                self.solve_few(SupernodalLltRef::new(symbolic, &self.values), tree, right);
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
    fn solve_few(
        &self,
        factor: SupernodalLltRef<'_, usize, f64>,
        tree: &Branch,
        mut right: MatMut<'_, f64>,
    ) {
        let columns = right.ncols();
        let order = self.symbolic.perm().map(|perm| perm.arrays().0);
        let place = |row: usize| order.map_or(row, |order| order[row]);
        let mut rows = vec![[0.0; SIDES]; right.nrows()];
        for (number, row) in rows.iter_mut().enumerate() {
            for (column, value) in row.iter_mut().enumerate().take(columns) {
                *value = right[(place(number), column)];
            }
        }
        supernodes::solve(factor, tree, &mut rows);
        for (number, row) in rows.iter().enumerate() {
            for (column, value) in row.iter().enumerate().take(columns) {
                right[(place(number), column)] = *value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
    use faer::sparse::{SparseColMat, Triplet};

    use super::*;

    /// Blocks of `counts` masses, each joined to those within two places along each axis, that nothing joins to each
    /// other, in an order that mixes them.
    fn blocks(blocks: &[[usize; 3]], has_places: bool) -> SparseBody {
        let mut places = Vec::new();
        for (block, counts) in blocks.iter().enumerate() {
            for n in 0..counts.iter().product() {
                let at = [n % counts[0], n / counts[0] % counts[1], n / counts[0] / counts[1]];
                places.push((block, at));
            }
        }
        let count = places.len();
        let places: Vec<_> = (0..count).map(|n| places[(n * 7919) % count]).collect();
        let (mut stiffness, mut mass) = (Vec::new(), Vec::new());
        for (column, (block, at)) in places.iter().enumerate() {
            mass.push(Triplet::new(column, column, 1.0 + (column % 7) as f64));
            stiffness.push(Triplet::new(column, column, 130.0));
            for (row, (other, to)) in places.iter().enumerate().skip(column + 1) {
                if block == other && at.iter().zip(to).all(|(a, b)| a.abs_diff(*b) <= 2) {
                    stiffness.push(Triplet::new(
                        row,
                        column,
                        -1.0 + 0.1 * ((row + column) % 5) as f64,
                    ));
                }
            }
        }
        let matrix =
            |entries: &[_]| SparseColMat::try_new_from_triplets(count, count, entries).unwrap();
        let place = |(block, at): &(usize, [usize; 3])| {
            Some([at[0] as f64 + 1e3 * *block as f64, at[1] as f64, at[2] as f64])
        };
        let places = if has_places { places.iter().map(place).collect() } else { Vec::new() };
        SparseBody::new(matrix(&stiffness), matrix(&mass), places).unwrap()
    }

    fn supernodes(factor: &Factor) -> &SymbolicSupernodalCholesky<usize> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = factor.symbolic.raw() else {
            panic!("a factor without dense columns")
        };
        symbolic
    }

    /// Sweeps over branches side by side against the solutions of the crate of the factor, with any number of
    /// branches, for one body and for several that nothing couples, in our order and in the crate's.
    #[test]
    fn branches_side_by_side_solve_the_whole() {
        for (sizes, has_places) in [
            (&[[9, 8, 11]][..], true),
            (&[[9, 8, 11]], false),
            (&[[6, 7, 8], [5, 5, 9], [4, 9, 6]], true),
            (&[[6, 7, 8], [5, 5, 9], [4, 9, 6]], false),
        ] {
            let body = blocks(sizes, has_places);
            let mut factor = Factor::new(&body, 0.3).unwrap();
            let mixed =
                |i: usize, j: usize| ((i * 7919 + j * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let right = Mat::from_fn(body.size(), SIDES, mixed);
            let mut expected = right.clone();
            factor.solve_many(expected.as_mut());
            let mut most = 0;
            for least in [usize::MAX, 20_000, 3000, 400, 1] {
                let tree = Branch::with_branches(supernodes(&factor), least).unwrap();
                most = most.max(count(&tree));
                factor.tree = Some(tree);
                let mut found = right.clone();
                factor.solve(&mut found);
                let difference = (&found - &expected).norm_max();
                assert!(difference < 1e-12 * expected.norm_max(), "{least}: {difference:e}");
            }
            assert!(most > 8, "{most} branches");
        }
    }

    /// Branches within one, and all within those.
    fn count(branch: &Branch) -> usize {
        branch.branches.iter().map(|branch| 1 + count(branch)).sum()
    }
}
