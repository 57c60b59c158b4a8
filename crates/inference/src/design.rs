//! Design of experiments: the information expected from a measurement.

use crate::error::{InferenceError, check_positive, check_size};
use crate::linear_algebra::dot;

/// A possible measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignCandidate {
    /// Description, for reports.
    pub name: String,
    /// A row per measured number: derivatives of the prediction with respect to the working
    /// coordinates, in the unit of the observation.
    pub jacobian: Vec<Vec<f64>>,
    /// The standard deviation of each of these numbers.
    pub standard_deviations: Vec<f64>,
}

/// The expected result of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedInformation {
    /// Index of the candidate.
    pub candidate: usize,
    /// Mean standard deviation of the targets after the measurement over that before, at most 1; 1
    /// without targets.
    pub target_ratio: f64,
    /// Information about all parameters, `1/2 ln(det C / det C')`, in nats.
    pub information: f64,
}

/// The information expected from each candidate, measured alone.
///
/// With the present covariance `C` of the working coordinates and a candidate's standardised
/// rows `A`, the covariance after it is `C' = (C^-1 + A^T A)^-1`: exact for a linear model with
/// normal noise. A target is a quantity with gradient `g` with respect to the working coordinates and
/// standard deviation `sqrt(g^T C g)`.
///
/// Source: K. Chaloner, I. Verdinelli, Statistical Science 10, 273 (1995).
///
/// # Errors
///
/// [`InferenceError::Size`] for rows, gradients or deviations of another size than the covariance
/// or each other; [`InferenceError::Option`] for a standard deviation that is not positive;
/// [`InferenceError::Singular`] for entries that are not finite.
///
/// # Example
///
/// Measuring a parameter of variance 1 with variance 1 halves the variance:
/// ```
/// # use asperity_inference::*;
/// let measurement = DesignCandidate {
///     name: "once".to_owned(),
///     jacobian: vec![vec![1.0]],
///     standard_deviations: vec![1.0],
/// };
/// let expected = expected_information(&[vec![1.0]], &[measurement], &[vec![1.0]])?;
/// assert!((expected[0].target_ratio - 0.5_f64.sqrt()).abs() < 1e-12);
/// assert!((expected[0].information - 0.5 * 2.0_f64.ln()).abs() < 1e-12);
/// # Ok::<(), InferenceError>(())
/// ```
pub fn expected_information(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Result<Vec<ExpectedInformation>, InferenceError> {
    check(covariance, candidates, targets)?;
    Ok(each_alone(covariance, candidates, targets)
        .into_iter()
        .map(|(expected, _)| expected)
        .collect())
}

/// A sequence of `count` measurements, found greedily: each is the best after those before it, by
/// the ratio of the targets or, without targets, by information. A candidate may occur repeatedly.
///
/// # Errors
///
/// As [`expected_information`].
pub fn design_sequence(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
    count: usize,
) -> Result<Vec<ExpectedInformation>, InferenceError> {
    check(covariance, candidates, targets)?;
    let mut now = covariance.to_vec();
    let mut sequence = Vec::with_capacity(count.min(1024));
    for _ in 0..count {
        let better = |a: &(ExpectedInformation, Vec<Vec<f64>>),
                      b: &(ExpectedInformation, Vec<Vec<f64>>)| {
            let by_target = a.0.target_ratio.total_cmp(&b.0.target_ratio);
            by_target.then(b.0.information.total_cmp(&a.0.information))
        };
        let Some((expected, after)) =
            each_alone(&now, candidates, targets).into_iter().min_by(better)
        else {
            break;
        };
        sequence.push(expected);
        now = after;
    }
    Ok(sequence)
}

fn each_alone(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Vec<(ExpectedInformation, Vec<Vec<f64>>)> {
    let before = mean_deviation(covariance, targets);
    let one = |(candidate, measured): (usize, &DesignCandidate)| {
        let (after, information) = updated(covariance, measured);
        let ratio = mean_deviation(&after, targets) / before;
        let target_ratio = if ratio.is_finite() { ratio } else { 1.0 };
        (ExpectedInformation { candidate, target_ratio, information }, after)
    };
    candidates.iter().enumerate().map(one).collect()
}

/// The covariance after a measurement and its information, one number after the other:
/// `C' = C - C a a^T C / (1 + a^T C a)`.
fn updated(covariance: &[Vec<f64>], measured: &DesignCandidate) -> (Vec<Vec<f64>>, f64) {
    let mut after = covariance.to_vec();
    let mut information = 0.0;
    for (row, deviation) in measured.jacobian.iter().zip(&measured.standard_deviations) {
        let a: Vec<f64> = row.iter().map(|entry| entry / deviation).collect();
        let product: Vec<f64> = after.iter().map(|row| dot(row, &a)).collect();
        let signal = dot(&product, &a).max(0.0);
        information += 0.5 * signal.ln_1p();
        for (row, left) in after.iter_mut().zip(&product) {
            for (entry, right) in row.iter_mut().zip(&product) {
                *entry -= left * right / (1.0 + signal);
            }
        }
    }
    (after, information)
}

fn mean_deviation(covariance: &[Vec<f64>], targets: &[Vec<f64>]) -> f64 {
    let deviation = |gradient: &Vec<f64>| {
        let product: Vec<f64> = covariance.iter().map(|row| dot(row, gradient)).collect();
        dot(&product, gradient).max(0.0).sqrt()
    };
    targets.iter().map(deviation).sum::<f64>() / targets.len() as f64
}

fn check(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Result<(), InferenceError> {
    let parameters = covariance.len();
    let rows = candidates.iter().flat_map(|candidate| &candidate.jacobian);
    for row in covariance.iter().chain(targets).chain(rows) {
        check_size("entries of a row", row.len(), parameters)?;
        if row.iter().any(|entry| !entry.is_finite()) {
            return Err(InferenceError::Singular("covariance, Jacobian or gradient"));
        }
    }
    for candidate in candidates {
        let (found, expected) = (candidate.standard_deviations.len(), candidate.jacobian.len());
        check_size("standard deviations of a candidate", found, expected)?;
        for &deviation in &candidate.standard_deviations {
            check_positive("a standard deviation", deviation)?;
        }
    }
    Ok(())
}
