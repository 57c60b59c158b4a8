//! Designs of numerical experiments and the statistics of their results, for any model.
//!
//! Inputs `x = (x_1, ..., x_d)` have distributions `F_i`, a model gives an output `y = f(x)`. A
//! [`Design`] places rows in the unit cube, an [`InputSpace`] maps each to inputs,
//!
//! ```text
//! x_i = F_i^-1(v_i),    v = Phi(L Phi^-1(u)) for correlated inputs, v = u otherwise,
//! ```
//!
//! with the normal distribution `Phi` and the Cholesky factor `L` of a correlation matrix. A row
//! depends on the seed of the design and on its own number alone: rows are computed in any order,
//! on any machine.
//!
//! | part | module |
//! |---|---|
//! | distributions and weighted draws | [`Distribution`], [`WeightedDraws`] |
//! | correlation of inputs | [`Correlation`] |
//! | from the unit cube to inputs | [`InputSpace`] |
//! | grid, random, Latin hypercube, scrambled Sobol, Saltelli's design | [`Design`] |
//! | quantiles, exceedance probabilities | [`WeightedSample`]; of columns on the disk [`ColumnSummary`] |
//! | first-order and total Sobol indices | [`SensitivitySums`] |
//!
//! The crate contains no mechanics, reads no files and prints nothing.
//!
//! # Example
//! The mean of `exp(x)` for a normal `x` is `exp(1/2)`:
//! ```
//! use asperity_sampling::{Design, Distribution, InputSpace};
//!
//! let inputs = InputSpace::independent(vec![Distribution::normal(0.0, 1.0)?])?;
//! let design = Design::sobol(inputs.dimensions(), 4096, 1)?;
//! let mut sum = 0.0;
//! for row in 0..design.rows() {
//!     sum += inputs.values(&design.point(row))[0].exp();
//! }
//! assert!((sum / design.rows() as f64 - 0.5_f64.exp()).abs() < 0.01);
//! # Ok::<(), asperity_sampling::DesignError>(())
//! ```

mod correlation;
mod design;
mod distribution;
mod draws;
mod error;
mod hash;
mod input_space;
mod statistics;

pub use correlation::Correlation;
pub use design::{Design, MOST_DIMENSIONS, MOST_ROWS, SaltelliBlock};
pub use distribution::Distribution;
pub use draws::WeightedDraws;
pub use error::DesignError;
pub use input_space::InputSpace;
pub use statistics::{
    ColumnSummary, Histogram, IntervalEstimate, SensitivitySums, SobolIndices, SummaryRequest,
    ValueColumn, WeightedSample,
};
