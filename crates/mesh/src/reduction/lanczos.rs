//! Lowest modes of a sparse body by block Lanczos iteration on `(K + shift M)^-1 M`.
//!
//! Every block is made orthogonal, in the product with M, to all before it, twice; the modes are the
//! Rayleigh-Ritz vectors in the space of all blocks. When the wanted modes have converged, a further
//! random block is added: modes that the first blocks cannot show, as copies of a repeated one, appear
//! then. Source: G. H. Golub, R. Underwood, The block Lanczos method for computing eigenvalues,
//! Mathematical Software III, 1977, 361.

use faer::{Mat, Side};

use super::factor::Factor;
use crate::{MeshError, SparseBody};

/// Vectors of a block: more than the rigid motions of a body.
const BLOCK: usize = 8;

/// Residual of a converged vector over its eigenvalue: what a rigid motion has of modes left out appears in
/// their flexibility, over the shift.
const CONVERGED: f64 = 1e-12;

/// Relative change of an eigenvalue by a further block that is none.
const CONFIRMED: f64 = 1e-9;

/// Share of a vector's length, after its projection on others is taken off, below which nothing is left
/// of it.
const NOTHING_LEFT: f64 = 1e-10;

/// Blocks over those that just hold the wanted modes before the iteration fails.
const MOST_BLOCKS: usize = 40;

/// Squared angular frequencies \[1/s2\], lowest first, and mass-normalised shapes by columns.
pub(super) struct Eigenpairs {
    pub(super) squares: Vec<f64>,
    pub(super) shapes: Mat<f64>,
}

/// Vectors of the iteration, and the projection of `(K + shift M)^-1 M` on them.
struct Krylov<'a> {
    body: &'a SparseBody,
    factor: &'a Factor,
    basis: Mat<f64>,
    /// Number of vectors in the basis.
    count: usize,
    projected: Mat<f64>,
    random: Random,
}

/// The `wanted` lowest modes, or all of a body that has not more.
///
/// # Errors
/// [`MeshError::Matrix`] when the iteration does not converge.
pub(super) fn lowest(
    body: &SparseBody,
    factor: &Factor,
    shift: f64,
    wanted: usize,
) -> Result<Eigenpairs, MeshError> {
    let size = body.size();
    let wanted = wanted.min(size);
    let most = size.min(wanted + MOST_BLOCKS * BLOCK + wanted);
    let mut krylov = Krylov {
        body,
        factor,
        basis: Mat::zeros(size, most),
        count: 0,
        projected: Mat::zeros(most, most),
        random: Random(0x9e37_79b9_7f4a_7c15),
    };
    let mut block = krylov.random_block(BLOCK.min(most));
    let mut last: Option<Vec<f64>> = None;
    while block.ncols() > 0 {
        let (next, couplings) = krylov.extend(block);
        let (values, vectors) = krylov.ritz()?;
        if krylov.count >= wanted && is_converged(&values[..wanted], &vectors, &couplings) {
            let found = &values[..wanted];
            let same = |(a, b): (&f64, &f64)| (a - b).abs() <= CONFIRMED * a.abs();
            if last.is_some_and(|last| last.iter().zip(found).all(same)) {
                return Ok(krylov.eigenpairs(shift, found, &vectors));
            }
            last = Some(found.to_vec());
            block = krylov.random_block(BLOCK.min(most - krylov.count));
        } else {
            block = next;
        }
    }
    let (values, vectors) = krylov.ritz()?;
    if krylov.count == most && most < size {
        let problem = "without converging eigenvalues";
        return Err(MeshError::Matrix { matrix: "stiffness", problem });
    }
    // The basis holds every motion with mass.
    let wanted = wanted.min(krylov.count);
    Ok(krylov.eigenpairs(shift, &values[..wanted], &vectors))
}

/// True if the residuals of the vectors are small: `couplings` times their parts in the last block.
fn is_converged(values: &[f64], vectors: &Mat<f64>, couplings: &Mat<f64>) -> bool {
    let columns = couplings.ncols();
    let last = vectors.subrows(vectors.nrows() - columns, columns).subcols(0, values.len());
    let residuals = couplings * last;
    values.iter().enumerate().all(|(k, value)| residuals.col(k).norm_l2() <= CONVERGED * value)
}

impl Krylov<'_> {
    /// Takes `block`, orthonormal and orthogonal to the basis, into the basis. The next block, and its
    /// couplings to this one, by which the basis is no invariant space.
    fn extend(&mut self, block: Mat<f64>) -> (Mat<f64>, Mat<f64>) {
        let (from, added) = (self.count, block.ncols());
        self.basis.subcols_mut(from, added).copy_from(&block);
        self.count += added;
        let mut image = self.body.mass_times(block.as_ref());
        self.factor.solve(&mut image);
        let lengths = self.lengths(&image);
        let mut along = Mat::zeros(self.count, added);
        for _ in 0..2 {
            along += self.take_off(&mut image);
        }
        self.projected.submatrix_mut(0, from, self.count, added).copy_from(&along);
        let room = self.basis.ncols() - self.count;
        self.orthonormal(&image, &lengths, room)
    }

    /// Takes the part along the basis off the columns of `vectors`, and returns it.
    fn take_off(&self, vectors: &mut Mat<f64>) -> Mat<f64> {
        let basis = self.basis.subcols(0, self.count);
        let along = basis.transpose() * self.body.mass_times(vectors.as_ref());
        *vectors -= basis * &along;
        along
    }

    /// At most `room` orthonormal columns that span those of `vectors`, and the coordinates of `vectors`
    /// in them. A column of which next to nothing is left of its first length is replaced by a random one;
    /// where nothing is left that is orthogonal to all, there are fewer columns.
    fn orthonormal(
        &mut self,
        vectors: &Mat<f64>,
        lengths: &[f64],
        room: usize,
    ) -> (Mat<f64>, Mat<f64>) {
        let (size, given) = (vectors.nrows(), vectors.ncols());
        let mut block = Mat::zeros(size, given.min(room));
        let mut coordinates = Mat::zeros(given.min(room), given);
        let mut done = 0;
        for column in 0..given {
            let mut vector = vectors.subcols(column, 1).to_owned();
            self.off_block(&mut vector, &block, done, Some((&mut coordinates, column)));
            let mut length = self.lengths(&vector)[0];
            if done == block.ncols() {
                continue;
            }
            if length > NOTHING_LEFT * lengths[column] {
                coordinates[(done, column)] = length;
            } else {
                vector = self.random_image(1);
                let before = self.lengths(&vector)[0];
                for _ in 0..2 {
                    self.take_off(&mut vector);
                    self.off_block(&mut vector, &block, done, None);
                }
                length = self.lengths(&vector)[0];
                if length <= NOTHING_LEFT * before {
                    continue;
                }
            }
            for row in 0..size {
                block[(row, done)] = vector[(row, 0)] / length;
            }
            done += 1;
        }
        (block.subcols(0, done).to_owned(), coordinates.subrows(0, done).to_owned())
    }

    /// Takes the part along the first `done` columns of `block` off `vector`, twice, and adds it to
    /// a column of coordinates.
    fn off_block(
        &self,
        vector: &mut Mat<f64>,
        block: &Mat<f64>,
        done: usize,
        mut coordinates: Option<(&mut Mat<f64>, usize)>,
    ) {
        for _ in 0..2 {
            let along = block.subcols(0, done).transpose() * self.body.mass_times(vector.as_ref());
            *vector -= block.subcols(0, done) * &along;
            if let Some((coordinates, column)) = &mut coordinates {
                for row in 0..done {
                    coordinates[(row, *column)] += along[(row, 0)];
                }
            }
        }
    }

    /// Lengths of the columns of `vectors` \[kg^1/2 m\].
    fn lengths(&self, vectors: &Mat<f64>) -> Vec<f64> {
        let image = self.body.mass_times(vectors.as_ref());
        let square = |k: usize| vectors.col(k).transpose() * image.col(k);
        (0..vectors.ncols()).map(|k| square(k).max(0.0).sqrt()).collect()
    }

    /// At most `count` random vectors, orthonormal and orthogonal to the basis.
    fn random_block(&mut self, count: usize) -> Mat<f64> {
        let mut block = self.random_image(count);
        let lengths = self.lengths(&block);
        for _ in 0..2 {
            self.take_off(&mut block);
        }
        self.orthonormal(&block, &lengths, count).0
    }

    /// The operator times random vectors: nothing of them is without mass.
    fn random_image(&mut self, count: usize) -> Mat<f64> {
        let random = Mat::from_fn(self.body.size(), count, |_, _| self.random.next());
        let mut image = self.body.mass_times(random.as_ref());
        self.factor.solve(&mut image);
        image
    }

    /// The modes of the `values` \[s2\], with their coordinates by columns.
    fn eigenpairs(&self, shift: f64, values: &[f64], vectors: &Mat<f64>) -> Eigenpairs {
        let squares = values.iter().map(|value| 1.0 / value - shift).collect();
        let coordinates = vectors.subcols(0, values.len());
        Eigenpairs { squares, shapes: self.basis.subcols(0, self.count) * coordinates }
    }

    /// Eigenvalues of the projected operator, the largest first, and their vectors by columns.
    fn ritz(&self) -> Result<(Vec<f64>, Mat<f64>), MeshError> {
        let count = self.count;
        let symmetric =
            Mat::from_fn(count, count, |i, j| self.projected[(i.min(j), i.max(j))]);
        let found = symmetric.self_adjoint_eigen(Side::Lower).map_err(|_| {
            let problem = "without converging eigenvalues";
            MeshError::Matrix { matrix: "stiffness", problem }
        })?;
        let values = found.S().column_vector();
        let values = (0..count).rev().map(|k| values[k]).collect();
        Ok((values, Mat::from_fn(count, count, |i, k| found.U()[(i, count - 1 - k)])))
    }
}

/// Numbers between -1 and 1, the same in every run.
///
/// Source: G. Marsaglia, Xorshift RNGs, J. Stat. Softw. 2003, 8(14), doi 10.18637/jss.v008.i14.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
