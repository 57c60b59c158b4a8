//! Weighted draws of several inputs at once, such as those of a posterior distribution.

use crate::error::DesignError;

/// Weighted draws of several inputs at once: a discrete joint distribution.
///
/// One coordinate `u` of the unit cube selects the draw at which the cumulative weight passes `u`,
/// so that inputs keep their dependence, whatever it is.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightedDraws {
    columns: usize,
    /// Values of all draws, one draw after the other.
    values: Vec<f64>,
    /// Cumulative weights, ending at 1.
    cumulative: Vec<f64>,
}

impl WeightedDraws {
    /// Draws with their weights, which need no common scale; draws of weight zero are never
    /// selected.
    ///
    /// # Errors
    /// [`DesignError::Draws`] without draws, for draws of different or zero length, for numbers that
    /// are not finite, and for weights that are negative, of another number, or all zero.
    pub fn new(draws: &[Vec<f64>], weights: &[f64]) -> Result<Self, DesignError> {
        let fault = |text: String| Err(DesignError::Draws(text));
        let columns = draws.first().map_or(0, Vec::len);
        if columns == 0 {
            return fault("are empty; at least one draw of one number is needed".into());
        }
        if weights.len() != draws.len() {
            let (found, expected) = (weights.len(), draws.len());
            return fault(format!("have {found} weights; expected {expected}"));
        }
        for (row, (draw, weight)) in draws.iter().zip(weights).enumerate() {
            if draw.len() != columns {
                let (found, row) = (draw.len(), row + 1);
                return fault(format!("have {found} numbers in row {row}; expected {columns}"));
            }
            if let Some(value) = draw.iter().find(|value| !value.is_finite()) {
                return fault(format!("have the number {value} in row {}", row + 1));
            }
            if !(weight.is_finite() && *weight >= 0.0) {
                let row = row + 1;
                return fault(format!(
                    "have the weight {weight} in row {row}; it must not be negative"
                ));
            }
        }
        let total: f64 = weights.iter().sum();
        if !(total.is_finite() && total > 0.0) {
            return fault(format!("have weights with the sum {total}; it must be positive"));
        }
        let mut reached = 0.0;
        let cumulative = weights.iter().map(|weight| {
            reached += weight;
            reached / total
        });
        let cumulative = cumulative.collect();
        Ok(Self { columns, values: draws.concat(), cumulative })
    }

    /// Numbers of a draw.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of draws.
    pub fn count(&self) -> usize {
        self.cumulative.len()
    }

    /// The draw at which the cumulative weight passes `unit`, in (0, 1).
    pub fn select(&self, unit: f64) -> &[f64] {
        // Draws of weight zero repeat the cumulative weight before them, so that the first place
        // above `unit` is never one of them; rounding may leave the last place below `unit`.
        let place = self.cumulative.partition_point(|&reached| reached <= unit);
        let last = self.cumulative.iter().rposition(|&r| r < 1.0).map_or(0, |below| below + 1);
        let place = place.min(last.min(self.count() - 1));
        &self.values[place * self.columns..(place + 1) * self.columns]
    }
}
