//! Designs: rows of the unit cube.

mod direction_numbers;
mod sobol_sequence;

use crate::error::{DesignError, check_count};
use crate::hash::{hash, open_unit, permuted};
use sobol_sequence::SobolSequence;

/// Most coordinates of a Sobol sequence; Saltelli's design needs two for each of its dimensions.
pub const MOST_DIMENSIONS: usize = sobol_sequence::MOST_DIMENSIONS;

/// Most rows of a design: those of a Sobol sequence of 32 bits.
pub const MOST_ROWS: u64 = 1 << 32;

/// Words that keep the random numbers of different purposes apart.
const RANDOM: u64 = 1;
const STRATUM: u64 = 2;
const WITHIN: u64 = 3;

/// Rows in the open unit cube, each computed from the seed and its own number alone.
///
/// | design | row `k`, coordinate `j` | a larger design begins with the smaller one |
/// |---|---|---|
/// | [`grid`](Self::grid) | midpoints of `n_j` equal cells, the last coordinate fastest | no |
/// | [`random`](Self::random) | independent | yes |
/// | [`latin_hypercube`](Self::latin_hypercube) | one point in each of `n` equal strata | no |
/// | [`sobol`](Self::sobol) | scrambled Sobol sequence | yes |
/// | [`saltelli`](Self::saltelli) | [`SaltelliBlock`]s of a scrambled Sobol sequence | yes |
///
/// The mean of a smooth function over `n` rows has an error of order `n^-1/2` for random rows, and
/// near `n^-1` or better for a Sobol sequence with `n` a power of 2.
///
/// Sources: Latin hypercube, M. D. `McKay`, R. J. Beckman, W. J. Conover, Technometrics 21, 239
/// (1979), doi 10.2307/1268522; scrambling, A. B. Owen, in Monte Carlo and Quasi-Monte Carlo Methods
/// (Springer 1995), doi 10.1007/978-1-4612-2552-2_19.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    kind: Kind,
    dimensions: usize,
    rows: u64,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Grid { levels: Vec<u64> },
    Random { seed: u64 },
    LatinHypercube { seed: u64 },
    Sobol(SobolSequence),
    Saltelli(SobolSequence),
}

/// Part of Saltelli's design that a row belongs to.
///
/// A row `k` of a Sobol sequence with `2 d` coordinates gives two points `A_k` and `B_k` and those
/// between them, `A_k` with coordinate `i` of `B_k`. They follow each other as `d + 2` rows of the
/// design.
///
/// Source: A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), doi
/// 10.1016/j.cpc.2009.09.018.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SaltelliBlock {
    /// The point `A_k`.
    A,
    /// The point `B_k`.
    B,
    /// The point `A_k` with this coordinate, from 0, of `B_k`.
    Exchanged(usize),
}

impl SaltelliBlock {
    /// Number of the base row, and the part, of a row of Saltelli's design in `dimensions`.
    pub fn of_row(row: u64, dimensions: usize) -> (u64, Self) {
        let size = dimensions as u64 + 2;
        let block = match row % size {
            0 => Self::A,
            1 => Self::B,
            other => Self::Exchanged(other as usize - 2),
        };
        (row / size, block)
    }
}

impl Design {
    /// All combinations of the midpoints of `levels[j]` equal cells of each coordinate, the last
    /// coordinate varying fastest.
    ///
    /// # Errors
    /// [`DesignError::Count`] without coordinates, without levels, or for more than [`MOST_ROWS`].
    pub fn grid(levels: Vec<u64>) -> Result<Self, DesignError> {
        check_dimensions(levels.len(), usize::MAX)?;
        for &count in &levels {
            check_count("the number of levels", count, 1, MOST_ROWS)?;
        }
        let rows = levels.iter().try_fold(1_u64, |rows, &count| rows.checked_mul(count));
        let rows = rows.unwrap_or(u64::MAX);
        let dimensions = levels.len();
        Self::new(Kind::Grid { levels }, dimensions, rows)
    }

    /// Independent random rows.
    ///
    /// # Errors
    /// [`DesignError::Count`] without coordinates or rows, or for more than [`MOST_ROWS`].
    pub fn random(dimensions: usize, rows: u64, seed: u64) -> Result<Self, DesignError> {
        check_dimensions(dimensions, usize::MAX)?;
        Self::new(Kind::Random { seed }, dimensions, rows)
    }

    /// A Latin hypercube: each coordinate has one random point in each of `rows` equal strata, and
    /// the strata of different coordinates are combined at random.
    ///
    /// # Errors
    /// [`DesignError::Count`] without coordinates or rows, or for more than [`MOST_ROWS`].
    pub fn latin_hypercube(dimensions: usize, rows: u64, seed: u64) -> Result<Self, DesignError> {
        check_dimensions(dimensions, usize::MAX)?;
        Self::new(Kind::LatinHypercube { seed }, dimensions, rows)
    }

    /// A Sobol sequence with nested uniform (Owen's) scrambling: every row is uniform in the cube,
    /// and rows together fill it evenly. Powers of 2 are the best numbers of rows.
    ///
    /// # Errors
    /// [`DesignError::Count`] without coordinates or rows, for more than [`MOST_DIMENSIONS`] or
    /// [`MOST_ROWS`].
    pub fn sobol(dimensions: usize, rows: u64, seed: u64) -> Result<Self, DesignError> {
        check_dimensions(dimensions, MOST_DIMENSIONS)?;
        Self::new(Kind::Sobol(SobolSequence::new(dimensions, seed)), dimensions, rows)
    }

    /// Saltelli's design for Sobol indices, of `base_rows (dimensions + 2)` rows in the order of
    /// [`SaltelliBlock::of_row`].
    ///
    /// # Errors
    /// [`DesignError::Count`] without coordinates or rows, for more than half of [`MOST_DIMENSIONS`],
    /// or more than [`MOST_ROWS`] in all.
    pub fn saltelli(dimensions: usize, base_rows: u64, seed: u64) -> Result<Self, DesignError> {
        check_dimensions(dimensions, MOST_DIMENSIONS / 2)?;
        let rows = base_rows.saturating_mul(dimensions as u64 + 2);
        Self::new(Kind::Saltelli(SobolSequence::new(2 * dimensions, seed)), dimensions, rows)
    }

    fn new(kind: Kind, dimensions: usize, rows: u64) -> Result<Self, DesignError> {
        check_count("the number of rows", rows, 1, MOST_ROWS)?;
        Ok(Self { kind, dimensions, rows })
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Number of coordinates of a row.
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// Row number `row`, from 0: coordinates in (0, 1).
    ///
    /// Rows from [`rows`](Self::rows) on are not part of the design.
    pub fn point(&self, row: u64) -> Vec<f64> {
        match &self.kind {
            Kind::Grid { levels } => grid_point(levels, row),
            Kind::Random { seed } => {
                let number = |j| open_unit(hash(*seed, &[RANDOM, j, row]));
                (0..self.dimensions as u64).map(number).collect()
            }
            Kind::LatinHypercube { seed } => {
                let number = |j| {
                    let stratum = permuted(row % self.rows, self.rows, hash(*seed, &[STRATUM, j]));
                    let within = open_unit(hash(*seed, &[WITHIN, j, row]));
                    // Rounding must not bring the last stratum to 1.
                    ((stratum as f64 + within) / self.rows as f64).min(1.0 - f64::EPSILON)
                };
                (0..self.dimensions as u64).map(number).collect()
            }
            Kind::Sobol(sequence) => {
                (0..self.dimensions).map(|j| sequence.coordinate(row as u32, j)).collect()
            }
            Kind::Saltelli(sequence) => {
                let (base, block) = SaltelliBlock::of_row(row, self.dimensions);
                let of_b = |j| match block {
                    SaltelliBlock::A => false,
                    SaltelliBlock::B => true,
                    SaltelliBlock::Exchanged(exchanged) => exchanged == j,
                };
                let place = |j| if of_b(j) { self.dimensions + j } else { j };
                (0..self.dimensions).map(|j| sequence.coordinate(base as u32, place(j))).collect()
            }
        }
    }
}

fn grid_point(levels: &[u64], row: u64) -> Vec<f64> {
    let mut rest = row;
    let mut point: Vec<f64> = levels
        .iter()
        .rev()
        .map(|&count| {
            let level = rest % count;
            rest /= count;
            (level as f64 + 0.5) / count as f64
        })
        .collect();
    point.reverse();
    point
}

fn check_dimensions(dimensions: usize, most: usize) -> Result<(), DesignError> {
    check_count("the number of coordinates", dimensions as u64, 1, most as u64)
}
