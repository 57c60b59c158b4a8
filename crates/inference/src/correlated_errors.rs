//! Errors of observations that share causes.

use faer::{Mat, Side};

use crate::error::{InferenceError, check_size};

/// Normal errors that are not independent of each other.
///
/// Each error has a part of its own, of variance `v_i`, and parts `b_ij` of causes `j` that it shares with others, which
/// are independent and of variance 1:
///
/// ```text
/// S = diag(v) + B B^T = diag(s) C diag(s),    C = L L^T,
/// ```
///
/// with the standard deviations `s` and the correlation matrix `C`. Residuals `r` in standard deviations become
/// `L^-1 r`, which are independent of each other, and whose squares sum to `r^T C^-1 r`: each is the part of a
/// residual that the residuals before it do not tell.
///
/// ```
/// use asperity_inference::CorrelatedErrors;
///
/// // Two readings of a sensor whose gain is off by 3 %.
/// let errors = CorrelatedErrors::new(&[1.0, 1.0], &[vec![3.0], vec![3.0]])?;
/// assert!((errors.standard_deviations()[0] - 10.0_f64.sqrt()).abs() < 1e-14);
/// // Equal residuals tell of the gain, and hardly more than one of them alone.
/// let mut residuals = [1.0, 1.0];
/// errors.make_independent(&mut residuals);
/// assert!(residuals[0] == 1.0 && residuals[1].abs() < 0.3);
/// # Ok::<(), asperity_inference::InferenceError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CorrelatedErrors {
    deviations: Vec<f64>,
    /// Rows of `L` up to the diagonal.
    root: Vec<Vec<f64>>,
}

impl CorrelatedErrors {
    /// Errors with `variances` of their own, and a row of parts for each.
    ///
    /// # Errors
    /// [`InferenceError::Size`] unless there is a row for each variance; [`InferenceError::Singular`] where errors
    /// determine another one, or numbers are not finite.
    pub fn new(variances: &[f64], parts: &[Vec<f64>]) -> Result<Self, InferenceError> {
        check_size("rows of the parts of errors", parts.len(), variances.len())?;
        let count = variances.len();
        let shared = |i: usize, j: usize| -> f64 {
            parts[i].iter().zip(&parts[j]).map(|(a, b)| a * b).sum()
        };
        let deviations: Vec<f64> =
            (0..count).map(|i| (variances[i] + shared(i, i)).sqrt()).collect();
        if deviations.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(InferenceError::Singular("correlation of errors"));
        }
        let correlation = Mat::from_fn(count, count, |i, j| match i.cmp(&j) {
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Greater => shared(i, j) / (deviations[i] * deviations[j]),
        });
        let singular = |_| InferenceError::Singular("correlation of errors");
        let factor = correlation.llt(Side::Lower).map_err(singular)?;
        let row = |i: usize| (0..=i).map(|j| factor.L()[(i, j)]).collect();
        let root = (0..count).map(row).collect();
        Ok(Self { deviations, root })
    }

    /// Standard deviation of each error.
    pub fn standard_deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// Replaces residuals in standard deviations, one for each error, by independent ones.
    pub fn make_independent(&self, residuals: &mut [f64]) {
        for (i, row) in self.root.iter().enumerate().take(residuals.len()) {
            let known: f64 = row[..i].iter().zip(&residuals[..i]).map(|(l, r)| l * r).sum();
            residuals[i] = (residuals[i] - known) / row[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applied to both sides of the correlation matrix the transformation leaves the unit matrix; errors that are
    /// determined by others are refused.
    #[test]
    fn residuals_become_independent() {
        let entry = |i: usize, j: usize| ((7 * i + 3 * j) as f64).sin();
        let variances: Vec<f64> = (0..8).map(|i| 0.01 + 0.1 * f64::from(i)).collect();
        let parts: Vec<Vec<f64>> = (0..8).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect();
        let errors = CorrelatedErrors::new(&variances, &parts).unwrap();
        let s = errors.standard_deviations();
        let covariance = |i: usize, j: usize| {
            let shared: f64 = (0..3).map(|k| parts[i][k] * parts[j][k]).sum();
            shared + if i == j { variances[i] } else { 0.0 }
        };
        let mut columns: Vec<Vec<f64>> =
            (0..8).map(|j| (0..8).map(|i| covariance(i, j) / (s[i] * s[j])).collect()).collect();
        for column in &mut columns {
            errors.make_independent(column);
        }
        for i in 0..8 {
            let mut row: Vec<f64> = columns.iter().map(|column| column[i]).collect();
            errors.make_independent(&mut row);
            for (j, x) in row.iter().enumerate() {
                assert!((x - f64::from(i == j)).abs() < 1e-13, "{i} {j} {x}");
            }
        }
        assert!(CorrelatedErrors::new(&[0.0, 0.0], &[vec![1.0], vec![2.0]]).is_err());
        assert!(CorrelatedErrors::new(&[f64::NAN], &[vec![]]).is_err());
        assert!(CorrelatedErrors::new(&[1.0], &[]).is_err());
    }
}
