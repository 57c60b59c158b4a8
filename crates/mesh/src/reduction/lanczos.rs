//! Lowest modes of a sparse body by block Lanczos iteration on `(K + s M)^-1 M` with a small shift `s`.
//!
//! Every block is made orthogonal, in the product with M, to all before it, twice; the modes are the
//! Rayleigh-Ritz vectors in the space of all blocks. Rigid motions, whose eigenvalue `1 / s` is far above
//! all others, are found first and kept out of the iteration: their rounding would be larger than
//! the others. Of a repeated mode a block shows as many copies as it has vectors: where so many are found, further
//! iterations without the known modes look for others.
//!
//! Source: G. H. Golub, R. Underwood, The block Lanczos method for computing eigenvalues, Mathematical
//! Software III, 1977, 361.

use std::ops::{AddAssign, Range};

use faer::{Mat, MatRef, Side};

use super::factor::Factor;
use super::projection;
use super::supernodes::SIDES;
use crate::{MeshError, SparseBody};

/// Vectors of a block: more than the rigid motions of a body. Larger blocks need more vectors in all, and the
/// solutions for these are as fast as the factor is read.
const BLOCK: usize = SIDES;

/// Residual of a converged vector over its eigenvalue.
const CONVERGED: f64 = 1e-10;

/// Residual over the largest eigenvalue that is rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Relative difference of eigenvalues that is none.
const EQUAL: f64 = 1e-9;

/// Relative difference of squares up to which modes may be copies of one.
const COPIES: f64 = 1e-3;

/// Share of a vector's length, after its projection on others is taken off, below which nothing is left
/// of it.
const NOTHING_LEFT: f64 = 1e-10;

/// Share of a vector's length, after its projection on others of its block is taken off, from which on the image is as exact as
/// the vector.
const MUCH_LEFT: f64 = 0.1;

/// Most vectors of the iteration: so many, and twice the wanted modes.
const MOST_VECTORS: usize = 1000;

/// Squared angular frequencies \[1/s2\], lowest first, and mass-normalised shapes by columns.
pub(super) struct Eigenpairs {
    pub(super) squares: Vec<f64>,
    pub(super) shapes: Mat<f64>,
}

/// Vectors of the iteration, and the projection of the operator on them.
struct Krylov<'a> {
    body: &'a SparseBody,
    factor: &'a Factor,
    /// Modes that are known, to which all vectors are orthogonal.
    known: Mat<f64>,
    known_images: Mat<f64>,
    /// Vectors, and their images under M: the parts of others along them need no product with M.
    basis: Columns,
    images: Columns,
    /// The first vector that the next image may have a part along by more than rounding.
    coupled_from: usize,
    /// Most vectors of the basis.
    most: usize,
    projected: Mat<f64>,
    /// The same for all iterations: another start of the same vectors would miss the copies that the first missed.
    random: &'a mut Random,
}

/// Columns in one piece of memory, which grows without being copied each time.
struct Columns {
    size: usize,
    values: Vec<f64>,
}

impl Columns {
    fn all(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.size, self.values.len() / self.size)
    }

    fn append(&mut self, columns: &Mat<f64>) {
        for column in columns.col_iter() {
            self.values.extend(column.iter());
        }
    }
}

/// Blocks by which rigid motions are found.
const RIGID_BLOCKS: usize = 2;

/// The `wanted` lowest modes, or all of a body that has not more; all modes of squares up to `rigid`
/// \[1/s2\] have the square zero.
///
/// # Errors
/// [`MeshError::Matrix`] for a square below `-rigid`, or when the iteration does not converge.
pub(super) fn lowest(
    body: &SparseBody,
    factor: &Factor,
    (shift, rigid): (f64, f64),
    wanted: usize,
) -> Result<Eigenpairs, MeshError> {
    let mut known = Eigenpairs { squares: Vec::new(), shapes: Mat::zeros(body.size(), 0) };
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    loop {
        let elastic = wanted.saturating_sub(known.squares.len()).max(1);
        let mut krylov = Krylov::new(body, factor, &mut random, (&known, elastic));
        match krylov.lowest(shift, rigid, elastic)? {
            Found::Rigid(more) => known = known.and(&more),
            Found::Elastic(more) => {
                known = known.and(&more);
                break;
            }
        }
    }
    let count = known.squares.len();
    while known.has_copies() {
        let mut krylov = Krylov::new(body, factor, &mut random, (&known, BLOCK));
        let (Found::Rigid(more) | Found::Elastic(more)) = krylov.lowest(shift, rigid, BLOCK)?;
        let highest = known.squares.last().copied().unwrap_or_default();
        if more.squares.first().is_none_or(|square| *square > (1.0 - EQUAL) * highest) {
            break;
        }
        known = known.and(&more).first(count);
    }
    Ok(known)
}

/// New modes that an iteration ended with.
enum Found {
    /// Rigid motions, which are to be kept out of another iteration.
    Rigid(Eigenpairs),
    Elastic(Eigenpairs),
}

/// The columns of `left`, and after them the columns of `right`.
fn beside(left: &Mat<f64>, right: &Mat<f64>) -> Mat<f64> {
    let columns = left.ncols();
    Mat::from_fn(left.nrows().max(right.nrows()), columns + right.ncols(), |i, j| {
        if j < columns { left[(i, j)] } else { right[(i, j - columns)] }
    })
}

/// Eigenvalues of the projected operator \[s2\], the largest first, the squares of their angular
/// frequencies, and their vectors by columns.
struct Ritz {
    values: Vec<f64>,
    squares: Vec<f64>,
    vectors: Mat<f64>,
}

impl Ritz {
    /// True if the residuals of the first `wanted` vectors are small: `couplings` times their parts in the
    /// last block.
    fn is_converged(&self, wanted: usize, couplings: &Mat<f64>) -> bool {
        let columns = couplings.ncols();
        let from = self.vectors.nrows() - columns;
        let residuals = couplings * self.vectors.subrows(from, columns).subcols(0, wanted);
        let bound = |value: f64| (CONVERGED * value).max(ROUNDING * self.values[0]);
        let values = self.values[..wanted].iter().enumerate();
        values.into_iter().all(|(k, &value)| residuals.col(k).norm_l2() <= bound(value))
    }
}

impl Eigenpairs {
    /// These and others, the lowest first.
    fn and(&self, others: &Self) -> Self {
        let shapes = beside(&self.shapes, &others.shapes);
        let squares = [self.squares.as_slice(), &others.squares].concat();
        let mut order: Vec<usize> = (0..squares.len()).collect();
        order.sort_by(|&a, &b| squares[a].total_cmp(&squares[b]));
        Self {
            squares: order.iter().map(|&k| squares[k]).collect(),
            shapes: Mat::from_fn(shapes.nrows(), order.len(), |i, k| shapes[(i, order[k])]),
        }
    }

    /// The first `count` of them.
    fn first(mut self, count: usize) -> Self {
        self.squares.truncate(count);
        self.shapes = self.shapes.subcols(0, count).to_owned();
        self
    }

    /// True if as many elastic modes are nearly equal as a block has vectors: there may be more of them than one
    /// iteration shows.
    fn has_copies(&self) -> bool {
        let elastic = self.squares.iter().filter(|square| **square > 0.0).copied();
        let elastic: Vec<f64> = elastic.collect();
        elastic.windows(BLOCK).any(|group| group[BLOCK - 1] - group[0] <= COPIES * group[0])
    }
}

/// Vectors that are orthonormal in the product with M, and their images `M v`.
struct Block {
    vectors: Mat<f64>,
    images: Mat<f64>,
}

impl Block {
    fn count(&self) -> usize {
        self.vectors.ncols()
    }

    /// Takes the part along the first `done` columns off `vector` and its `image`, twice, and adds it to a
    /// column of coordinates.
    fn take_off(
        &self,
        (vector, image): (&mut Mat<f64>, &mut Mat<f64>),
        done: usize,
        mut coordinates: Option<(&mut Mat<f64>, usize)>,
    ) {
        for _ in 0..2 {
            let along = self.images.subcols(0, done).transpose() * &*vector;
            *vector -= self.vectors.subcols(0, done) * &along;
            *image -= self.images.subcols(0, done) * &along;
            if let Some((coordinates, column)) = &mut coordinates {
                for row in 0..done {
                    coordinates[(row, *column)] += along[(row, 0)];
                }
            }
        }
    }
}

/// Length of a vector with this image \[kg^1/2 m\].
fn length_of(vector: &Mat<f64>, image: &Mat<f64>) -> f64 {
    (vector.col(0).transpose() * image.col(0)).max(0.0).sqrt()
}

impl<'a> Krylov<'a> {
    /// No vectors yet, and room for those that `elastic` modes beside known ones need.
    fn new(
        body: &'a SparseBody,
        factor: &'a Factor,
        random: &'a mut Random,
        (known, elastic): (&Eigenpairs, usize),
    ) -> Self {
        let known = known.shapes.clone();
        let most = (2 * elastic + MOST_VECTORS).min(body.size() - known.ncols());
        Self {
            body,
            factor,
            known_images: body.mass_times(known.as_ref()),
            known,
            basis: Columns { size: body.size(), values: Vec::new() },
            images: Columns { size: body.size(), values: Vec::new() },
            coupled_from: 0,
            most,
            projected: Mat::zeros(most, most),
            random,
        }
    }

    /// The `elastic` lowest modes that are not known, or rigid motions that are not.
    fn lowest(&mut self, shift: f64, rigid: f64, elastic: usize) -> Result<Found, MeshError> {
        let elastic = elastic.min(self.most);
        let mut block = self.random_block(BLOCK);
        let mut blocks = 0;
        while block.count() > 0 {
            let (next, couplings) = self.extend(&block);
            block = next;
            blocks += 1;
            let is_last = block.count() == 0;
            let is_early = blocks == RIGID_BLOCKS || is_last;
            if !is_early && self.count() < elastic {
                continue;
            }
            let found = self.ritz(shift)?;
            let is_converged =
                self.count() >= elastic && !is_last && found.is_converged(elastic, &couplings);
            if (is_early || is_converged)
                && let Some(motions) = self.rigid_motions(&found, rigid)?
            {
                return Ok(Found::Rigid(motions));
            }
            if is_converged {
                return Ok(Found::Elastic(self.elastic(&found, elastic)));
            }
        }
        if self.room() == 0 && self.most < self.body.size() - self.known.ncols() {
            let problem = "without converging eigenvalues";
            return Err(MeshError::Matrix { matrix: "stiffness", problem });
        }
        if self.count() == 0 {
            let none = Eigenpairs { squares: Vec::new(), shapes: Mat::zeros(self.body.size(), 0) };
            return Ok(Found::Elastic(none));
        }
        // The basis holds every motion with mass.
        let found = self.ritz(shift)?;
        Ok(Found::Elastic(self.elastic(&found, elastic.min(self.count()))))
    }

    /// The vectors with squares up to `rigid` after an inverse iteration, which takes off what they have of other
    /// modes, without known ones; none if there are none.
    ///
    /// # Errors
    /// [`MeshError::Matrix`] for a square below `-rigid`.
    fn rigid_motions(&mut self, found: &Ritz, rigid: f64) -> Result<Option<Eigenpairs>, MeshError> {
        if found.squares[0] < -rigid {
            let problem = "not positive semidefinite";
            return Err(MeshError::Matrix { matrix: "stiffness", problem });
        }
        let count = found.squares.iter().filter(|square| **square <= rigid).count();
        if count == 0 {
            return Ok(None);
        }
        let mut improved = self.body.mass_times(self.shapes(&found.vectors, count).as_ref());
        self.factor.solve(&mut improved);
        let lengths = self.lengths(&improved);
        self.take_off(&mut improved, 0..0);
        let shapes = self.orthonormal(&improved, &lengths, count).0.vectors;
        let squares = vec![0.0; shapes.ncols()];
        Ok((shapes.ncols() > 0).then_some(Eigenpairs { squares, shapes }))
    }

    /// Number of vectors in the basis.
    fn count(&self) -> usize {
        self.basis.all().ncols()
    }

    /// Number of vectors that the basis has room for.
    fn room(&self) -> usize {
        self.most - self.count()
    }

    /// Takes `block`, orthonormal and orthogonal to the basis, into the basis. The next block, and its
    /// couplings to this one, by which the basis is no invariant space.
    fn extend(&mut self, Block { vectors, images }: &Block) -> (Block, Mat<f64>) {
        let (from, added) = (self.count(), vectors.ncols());
        self.basis.append(vectors);
        self.images.append(images);
        let mut image = images.clone();
        self.factor.solve(&mut image);
        // The image has parts along the last two blocks, and by rounding along others.
        let coupled = self.coupled_from..from + added;
        let mut along = Mat::zeros(from + added, added);
        for range in [coupled, 0..from + added] {
            along
                .subrows_mut(range.start, range.len())
                .add_assign(self.take_off(&mut image, range));
        }
        self.projected.submatrix_mut(0, from, from + added, added).copy_from(&along);
        self.coupled_from = from;
        // At least as long as its part in the basis.
        let lengths: Vec<f64> = along.col_iter().map(|column| column.norm_l2()).collect();
        let room = self.room();
        self.orthonormal(&image, &lengths, room)
    }

    /// Takes the parts along known modes and vectors of the basis off the columns of `vectors`, and returns
    /// the second.
    fn take_off(&self, vectors: &mut Mat<f64>, basis: Range<usize>) -> Mat<f64> {
        let (from, count) = (basis.start, basis.len());
        let (basis, images) = (self.basis.all(), self.images.all());
        let parts = [
            (self.known.as_ref(), self.known_images.as_ref()),
            (basis.subcols(from, count), images.subcols(from, count)),
        ];
        let [_, along] = parts.map(|(basis, images)| {
            let along = projection::along(images, vectors.as_ref());
            projection::take_off(vectors.as_mut(), basis, along.as_ref());
            along
        });
        along
    }

    /// At most `room` orthonormal columns that span the columns of `vectors`, and the coordinates of `vectors`
    /// in them. A column of which next to nothing is left of its first length is replaced by a random one;
    /// where nothing is left that is orthogonal to all, there are fewer columns.
    fn orthonormal(
        &mut self,
        vectors: &Mat<f64>,
        lengths: &[f64],
        room: usize,
    ) -> (Block, Mat<f64>) {
        let (size, given) = (vectors.nrows(), vectors.ncols());
        let zeros = || Mat::zeros(size, given.min(room));
        let mut block = Block { vectors: zeros(), images: zeros() };
        let mut coordinates = Mat::zeros(given.min(room), given);
        let images = self.body.mass_times(vectors.as_ref());
        let mut done = 0;
        for column in 0..given {
            let [mut vector, mut image] =
                [vectors, &images].map(|all| all.subcols(column, 1).to_owned());
            let before = length_of(&vector, &image);
            let pair = (&mut vector, &mut image);
            block.take_off(pair, done, Some((&mut coordinates, column)));
            if done == block.count() {
                continue;
            }
            let mut length = length_of(&vector, &image);
            if length < MUCH_LEFT * before {
                // The rounding of what was taken off would be large in what is left.
                image = self.body.mass_times(vector.as_ref());
                length = length_of(&vector, &image);
            }
            if length > NOTHING_LEFT * lengths[column] {
                coordinates[(done, column)] = length;
            } else {
                vector = self.random_image(1);
                let before = self.lengths(&vector)[0];
                for _ in 0..2 {
                    self.take_off(&mut vector, 0..self.count());
                    block.take_off((&mut vector, &mut image), done, None);
                }
                image = self.body.mass_times(vector.as_ref());
                length = length_of(&vector, &image);
                if length <= NOTHING_LEFT * before {
                    continue;
                }
            }
            for row in 0..size {
                block.vectors[(row, done)] = vector[(row, 0)] / length;
                block.images[(row, done)] = image[(row, 0)] / length;
            }
            done += 1;
        }
        let [vectors, images] =
            [block.vectors, block.images].map(|columns| columns.subcols(0, done).to_owned());
        (Block { vectors, images }, coordinates.subrows(0, done).to_owned())
    }

    /// Lengths of the columns of `vectors` \[kg^1/2 m\].
    fn lengths(&self, vectors: &Mat<f64>) -> Vec<f64> {
        let image = self.body.mass_times(vectors.as_ref());
        let square = |k: usize| vectors.col(k).transpose() * image.col(k);
        (0..vectors.ncols()).map(|k| square(k).max(0.0).sqrt()).collect()
    }

    /// At most `count` random vectors, orthonormal and orthogonal to the basis.
    fn random_block(&mut self, count: usize) -> Block {
        let count = count.min(self.room());
        let mut block = self.random_image(count);
        let lengths = self.lengths(&block);
        for _ in 0..2 {
            self.take_off(&mut block, 0..self.count());
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

    /// The first `count` modes of the basis.
    fn elastic(&self, found: &Ritz, count: usize) -> Eigenpairs {
        let squares = found.squares[..count].to_vec();
        Eigenpairs { squares, shapes: self.shapes(&found.vectors, count) }
    }

    /// Shapes of the first `count` vectors.
    fn shapes(&self, vectors: &Mat<f64>, count: usize) -> Mat<f64> {
        self.basis.all() * vectors.subcols(0, count)
    }

    /// Eigenvalues and vectors of the projected operator.
    fn ritz(&self, shift: f64) -> Result<Ritz, MeshError> {
        let count = self.count();
        // The eigenvalue algorithm loses digits of numbers far below 1.
        let scale = (0..count).map(|k| self.projected[(k, k)]).fold(0.0, f64::max);
        let entry = |i: usize, j: usize| self.projected[(i.min(j), i.max(j))] / scale;
        let symmetric = Mat::from_fn(count, count, entry);
        let found = symmetric.self_adjoint_eigen(Side::Lower).map_err(|_| {
            let problem = "without converging eigenvalues";
            MeshError::Matrix { matrix: "stiffness", problem }
        })?;
        let values = found.S().column_vector();
        let values: Vec<f64> = (0..count).rev().map(|k| scale * values[k]).collect();
        let squares = values.iter().map(|value| 1.0 / value - shift).collect();
        let vectors = Mat::from_fn(count, count, |i, k| found.U()[(i, count - 1 - k)]);
        Ok(Ritz { values, squares, vectors })
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
