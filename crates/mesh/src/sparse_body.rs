//! Bodies given by sparse mass and stiffness matrices.

use faer::sparse::{SparseColMat, SparseColMatRef};
use faer::{Mat, MatRef};

use crate::MeshError;

/// A body without its contacts, `M u'' + K u = f`, in sparse symmetric matrices.
///
/// K \[N/m\] may be singular: a free body has rigid motions. Rotations, amplitudes of incompatible modes
/// and other degrees of freedom that are no displacements are rows like any other.
#[derive(Debug, Clone)]
pub struct SparseBody {
    stiffness: SparseColMat<usize, f64>,
    mass: SparseColMat<usize, f64>,
    places: Vec<Option<[f64; 3]>>,
}

impl SparseBody {
    /// A body from the lower triangles, diagonals included, of its `stiffness` K \[N/m\] and `mass` M
    /// \[kg\].
    ///
    /// `places` are the positions \[m\] of the rows, where they are known, or empty; they make the
    /// factorisation cheaper, and change no result but by rounding.
    ///
    /// # Errors
    /// [`MeshError::Matrix`] for matrices that are not square or not of one size, for an entry above the
    /// diagonal or not finite, for a negative diagonal, and for `places` of another number than rows.
    pub fn new(
        stiffness: SparseColMat<usize, f64>,
        mass: SparseColMat<usize, f64>,
        places: Vec<Option<[f64; 3]>>,
    ) -> Result<Self, MeshError> {
        let size = stiffness.nrows();
        for (name, matrix) in [("stiffness", stiffness.as_ref()), ("mass", mass.as_ref())] {
            let fault = |problem| Err(MeshError::Matrix { matrix: name, problem });
            if size == 0 || matrix.nrows() != size || matrix.ncols() != size {
                return fault("not square, or not of the size of the other");
            }
            for column in 0..size {
                for (row, value) in entries(matrix, column) {
                    if row < column {
                        return fault("not a lower triangle");
                    }
                    if !value.is_finite() {
                        return fault("not finite");
                    }
                    if row == column && value < 0.0 {
                        return fault("negative on its diagonal");
                    }
                }
            }
        }
        if !(places.is_empty() || places.len() == size) {
            let problem = "not of the size of the list of places";
            return Err(MeshError::Matrix { matrix: "stiffness", problem });
        }
        Ok(Self { stiffness, mass, places })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.stiffness.nrows()
    }

    /// Lower triangle of the stiffness matrix \[N/m\].
    pub fn stiffness(&self) -> SparseColMatRef<'_, usize, f64> {
        self.stiffness.as_ref()
    }

    /// Lower triangle of the mass matrix \[kg\].
    pub fn mass(&self) -> SparseColMatRef<'_, usize, f64> {
        self.mass.as_ref()
    }

    /// Positions of the rows \[m\], where they are known; empty without any.
    pub fn places(&self) -> &[Option<[f64; 3]>] {
        &self.places
    }

    /// The mass matrix times the columns of `vectors`.
    pub fn mass_times(&self, vectors: MatRef<'_, f64>) -> Mat<f64> {
        times(self.mass.as_ref(), vectors)
    }

    /// Lower triangle of `K + shift M`.
    pub(crate) fn shifted(&self, shift: f64) -> SparseColMat<usize, f64> {
        let size = self.size();
        let mut starts = vec![0];
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for column in 0..size {
            let mut of_mass = entries(self.mass.as_ref(), column).peekable();
            for (row, value) in entries(self.stiffness.as_ref(), column) {
                while let Some((own, mass)) = of_mass.next_if(|&(own, _)| own < row) {
                    rows.push(own);
                    values.push(shift * mass);
                }
                let mass = of_mass.next_if(|&(own, _)| own == row).map_or(0.0, |(_, mass)| mass);
                rows.push(row);
                values.push(value + shift * mass);
            }
            for (row, mass) in of_mass {
                rows.push(row);
                values.push(shift * mass);
            }
            starts.push(rows.len());
        }
        let symbolic =
            faer::sparse::SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
        SparseColMat::new(symbolic, values)
    }

    /// Median over the rows with mass of the stiffness over the mass on the diagonals \[1/s2\].
    pub(crate) fn typical_square(&self) -> f64 {
        let diagonal = |matrix: SparseColMatRef<'_, usize, f64>, column: usize| {
            entries(matrix, column).find(|&(row, _)| row == column).map_or(0.0, |(_, value)| value)
        };
        let ratios = (0..self.size()).filter_map(|row| {
            let mass = diagonal(self.mass.as_ref(), row);
            (mass > 0.0).then(|| diagonal(self.stiffness.as_ref(), row) / mass)
        });
        let mut ratios: Vec<f64> = ratios.collect();
        if ratios.is_empty() {
            return 0.0;
        }
        let middle = ratios.len() / 2;
        *ratios.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

/// Rows, ascending, and values of a column.
pub(crate) fn entries(
    matrix: SparseColMatRef<'_, usize, f64>,
    column: usize,
) -> impl Iterator<Item = (usize, f64)> {
    let rows = matrix.symbolic().row_idx_of_col_raw(column).iter();
    rows.copied().zip(matrix.val_of_col(column).iter().copied())
}

/// Columns that are multiplied at once: the entries of the matrix are read from memory once for all of them.
const AT_ONCE: usize = 8;

/// The symmetric matrix with the lower triangle `lower` times the columns of `vectors`.
fn times(lower: SparseColMatRef<'_, usize, f64>, vectors: MatRef<'_, f64>) -> Mat<f64> {
    let mut product = Mat::zeros(vectors.nrows(), vectors.ncols());
    let mut first = 0;
    while first < vectors.ncols() {
        first += if vectors.ncols() - first > 1 {
            times_some::<AT_ONCE>(lower, vectors, first, &mut product)
        } else {
            times_some::<1>(lower, vectors, first, &mut product)
        };
    }
    product
}

/// Writes the product with `N` columns from `first` on, or as many as there are, into `product`; gives their number.
fn times_some<const N: usize>(
    lower: SparseColMatRef<'_, usize, f64>,
    vectors: MatRef<'_, f64>,
    first: usize,
    product: &mut Mat<f64>,
) -> usize {
    let size = vectors.nrows();
    let count = N.min(vectors.ncols() - first);
    let (mut from, mut into) = (vec![[0.0; N]; size], vec![[0.0; N]; size]);
    for (row, values) in from.iter_mut().enumerate() {
        for (k, value) in values.iter_mut().enumerate().take(count) {
            *value = vectors[(row, first + k)];
        }
    }
    // Plain loops, compiled for the vector instructions of the processor.
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            for column in 0..size {
                let at = from[column];
                let mut sums = [0.0; N];
                for (row, value) in entries(lower, column) {
                    if row != column {
                        for (sum, x) in sums.iter_mut().zip(&from[row]) {
                            *sum += value * x;
                        }
                    }
                    for (y, x) in into[row].iter_mut().zip(&at) {
                        *y += value * x;
                    }
                }
                for (y, sum) in into[column].iter_mut().zip(&sums) {
                    *y += sum;
                }
            }
        },
    );
    for k in 0..count {
        for (row, values) in into.iter().enumerate() {
            product[(row, first + k)] = values[k];
        }
    }
    count
}
