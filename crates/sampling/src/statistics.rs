//! Statistics of a model's results over the rows of a design.
//!
//! | module | holds |
//! |---|---|
//! | `sample` | quantiles and exceedance probabilities of weighted values in memory |
//! | `column_summary` | the same of a column on the disk, and its histogram, in constant memory |
//! | `order_statistics` | exact selection in such a column |
//! | `interval` | confidence intervals of both |
//! | `sobol_indices` | first-order and total Sobol indices with bootstrap intervals |

mod column_summary;
mod interval;
mod order_statistics;
mod sample;
mod sobol_indices;

pub use column_summary::{ColumnSummary, Histogram, SummaryRequest};
pub use order_statistics::ValueColumn;
pub use sample::WeightedSample;
pub use sobol_indices::{SensitivitySums, SobolIndices};

use crate::error::DesignError;

/// An estimate with a confidence interval.
///
/// An end is infinite where the sample does not bound the quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalEstimate {
    /// The estimate.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl IntervalEstimate {
    /// True if the interval holds `value`.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// Checks a probability strictly between 0 and 1.
fn check_probability(quantity: &'static str, value: f64) -> Result<(), DesignError> {
    if value > 0.0 && value < 1.0 {
        return Ok(());
    }
    Err(DesignError::Value { quantity, value, expected: "between 0 and 1, both excluded" })
}
