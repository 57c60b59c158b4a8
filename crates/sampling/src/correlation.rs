//! Correlated inputs by a Gaussian copula.

use std::f64::consts::FRAC_PI_6;

use crate::distribution::{normal_cumulative, normal_quantile};
use crate::error::DesignError;

/// Largest deviation of a correlation matrix from symmetry and from a diagonal of one.
const ROUNDING: f64 = 1e-9;

/// Correlation of inputs: a Gaussian copula.
///
/// Independent coordinates `u` of the unit cube become dependent ones,
///
/// ```text
/// v = Phi(L Phi^-1(u)),    L L^T = R,
/// ```
///
/// each of which remains uniform, so that every input keeps its distribution. `R` is the correlation
/// of the normal scores `Phi^-1(v)`. A rank correlation `r_s` (Spearman) of two inputs needs
/// `R = 2 sin(pi r_s / 6)`.
///
/// Source: K. Pearson (1907); see W. H. Kruskal, J. Am. Stat. Assoc. 53, 814 (1958), Eq. (7.5).
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Rows of the lower triangle of the Cholesky factor.
    factor: Vec<Vec<f64>>,
}

impl Correlation {
    /// From a matrix of rank correlations (Spearman).
    ///
    /// # Errors
    /// [`DesignError::Correlation`] unless the matrix is square and symmetric with ones on its
    /// diagonal, and that of the normal scores is positive definite.
    pub fn of_ranks(matrix: &[Vec<f64>]) -> Result<Self, DesignError> {
        check(matrix)?;
        let scores = |row: &Vec<f64>| row.iter().map(|r| 2.0 * (FRAC_PI_6 * r).sin()).collect();
        let scores: Vec<Vec<f64>> = matrix.iter().map(scores).collect();
        Self::of_scores(&scores)
    }

    /// From a matrix of correlations of the normal scores, which for normal inputs are those of the
    /// inputs, and for lognormal inputs those of their logarithms.
    ///
    /// # Errors
    /// [`DesignError::Correlation`] unless the matrix is square and symmetric with ones on its
    /// diagonal, and positive definite.
    pub fn of_scores(matrix: &[Vec<f64>]) -> Result<Self, DesignError> {
        check(matrix)?;
        let mut factor: Vec<Vec<f64>> = Vec::new();
        for (i, row) in matrix.iter().enumerate() {
            let mut next: Vec<f64> = Vec::with_capacity(i + 1);
            for (j, above) in factor.iter().enumerate() {
                let sum: f64 = next.iter().zip(above).map(|(a, b)| a * b).sum();
                next.push((row[j] - sum) / above[j]);
            }
            let rest = 1.0 - next.iter().map(|a| a * a).sum::<f64>();
            if rest < ROUNDING {
                return Err(DesignError::Correlation(format!(
                    "is not positive definite: input {} follows from those before it, or \
                     contradicts them; accepted: correlations of smaller magnitude",
                    i + 1
                )));
            }
            next.push(rest.sqrt());
            factor.push(next);
        }
        Ok(Self { factor })
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.factor.len()
    }

    /// Replaces independent coordinates in (0, 1), one an input, by correlated ones.
    pub fn apply(&self, unit: &mut [f64]) {
        for value in unit.iter_mut() {
            *value = normal_quantile(*value);
        }
        // From the last row up, so that each row finds the scores before it unchanged.
        for (i, row) in self.factor.iter().enumerate().rev() {
            unit[i] = row.iter().zip(&*unit).map(|(a, z)| a * z).sum();
        }
        for value in unit.iter_mut() {
            *value = normal_cumulative(*value);
        }
    }
}

fn check(matrix: &[Vec<f64>]) -> Result<(), DesignError> {
    let fault = |text: String| Err(DesignError::Correlation(text));
    if matrix.is_empty() {
        return fault("is empty".into());
    }
    for (i, row) in matrix.iter().enumerate() {
        if row.len() != matrix.len() {
            let (found, expected) = (row.len(), matrix.len());
            return fault(format!("has {found} numbers in row {}; expected {expected}", i + 1));
        }
        for (j, &value) in row.iter().enumerate() {
            let place = format!("row {}, column {}", i + 1, j + 1);
            let diagonal = i == j;
            if diagonal && (value - 1.0).abs() > ROUNDING {
                return fault(format!("is {value} in {place}; the diagonal must be 1"));
            }
            if !diagonal && !(-1.0..=1.0).contains(&value) {
                return fault(format!("is {value} in {place}; accepted: -1 to 1"));
            }
            if (value - matrix[j].get(i).copied().unwrap_or(value)).abs() > ROUNDING {
                return fault(format!("is not symmetric: {place} differs from its mirror image"));
            }
        }
    }
    Ok(())
}
