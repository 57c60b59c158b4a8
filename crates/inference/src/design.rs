//! What to measure next: the information that a measurement is expected to bring.

use crate::error::{IdentifyError, check_size};

/// A measurement that could be made.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignCandidate {
    /// What it is, for reports.
    pub name: String,
    /// A row per number it would measure: derivatives of the prediction by the working
    /// coordinates, in the observation's unit.
    pub jacobian: Vec<Vec<f64>>,
    /// The standard deviation of each of these numbers.
    pub standard_deviations: Vec<f64>,
}

/// What a measurement would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignGain {
    /// Index of the candidate.
    pub candidate: usize,
    /// Mean standard deviation of the targets after it over the one before, at most 1; 1 without
    /// targets.
    pub target_ratio: f64,
    /// Information gained about all unknowns, `1/2 ln(det C / det C')`, in nats.
    pub information: f64,
}

/// The gain of each candidate, measured alone.
///
/// With the present covariance `C` of the working coordinates and a candidate's standardised
/// rows `A`, the covariance after it is `C' = (C^-1 + A^T A)^-1`: exact for a linear model with
/// normal noise. A target is a quantity with gradient `g` by the working coordinates and standard
/// deviation `sqrt(g^T C g)`.
///
/// Source: K. Chaloner, I. Verdinelli, Statistical Science 10, 273 (1995).
///
/// # Errors
///
/// [`IdentifyError::Size`] for rows, gradients or deviations of another size than the covariance
/// or each other; [`IdentifyError::Option`] for a standard deviation that is not positive;
/// [`IdentifyError::Singular`] for entries that are not finite.
pub fn expected_information(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Result<Vec<DesignGain>, IdentifyError> {
    check(covariance, candidates, targets)?;
    Ok(gains(covariance, candidates, targets).into_iter().map(|(gain, _)| gain).collect())
}

/// The best sequence of `count` measurements found greedily: each is the best after those before
/// it, by the targets' ratio or, without targets, by information. A candidate may come again.
///
/// # Errors
///
/// As [`expected_information`].
pub fn design_sequence(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
    count: usize,
) -> Result<Vec<DesignGain>, IdentifyError> {
    check(covariance, candidates, targets)?;
    let mut now = covariance.to_vec();
    let mut sequence = Vec::with_capacity(count.min(1024));
    for _ in 0..count {
        let better = |a: &(DesignGain, Vec<Vec<f64>>), b: &(DesignGain, Vec<Vec<f64>>)| {
            let by_target = a.0.target_ratio.total_cmp(&b.0.target_ratio);
            by_target.then(b.0.information.total_cmp(&a.0.information))
        };
        let Some((gain, after)) = gains(&now, candidates, targets).into_iter().min_by(better)
        else {
            break;
        };
        sequence.push(gain);
        now = after;
    }
    Ok(sequence)
}

fn gains(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Vec<(DesignGain, Vec<Vec<f64>>)> {
    let before = mean_deviation(covariance, targets);
    let one = |(candidate, measured): (usize, &DesignCandidate)| {
        let (after, information) = updated(covariance, measured);
        let ratio = mean_deviation(&after, targets) / before;
        let target_ratio = if ratio.is_finite() { ratio } else { 1.0 };
        (DesignGain { candidate, target_ratio, information }, after)
    };
    candidates.iter().enumerate().map(one).collect()
}

/// The covariance after a measurement and the information gained, one number after the other:
/// `C' = C - C a a^T C / (1 + a^T C a)`.
fn updated(covariance: &[Vec<f64>], measured: &DesignCandidate) -> (Vec<Vec<f64>>, f64) {
    let mut after = covariance.to_vec();
    let mut information = 0.0;
    for (row, deviation) in measured.jacobian.iter().zip(&measured.standard_deviations) {
        let a: Vec<f64> = row.iter().map(|entry| entry / deviation).collect();
        let gain: Vec<f64> = after.iter().map(|row| dot(row, &a)).collect();
        let signal = dot(&gain, &a).max(0.0);
        information += 0.5 * signal.ln_1p();
        for (row, left) in after.iter_mut().zip(&gain) {
            for (entry, right) in row.iter_mut().zip(&gain) {
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn check(
    covariance: &[Vec<f64>],
    candidates: &[DesignCandidate],
    targets: &[Vec<f64>],
) -> Result<(), IdentifyError> {
    let unknowns = covariance.len();
    let rows = candidates.iter().flat_map(|candidate| &candidate.jacobian);
    for row in covariance.iter().chain(targets).chain(rows) {
        check_size("entries of a row", row.len(), unknowns)?;
        if row.iter().any(|entry| !entry.is_finite()) {
            return Err(IdentifyError::Singular { matrix: "covariance, Jacobian or gradient" });
        }
    }
    for candidate in candidates {
        let (found, expected) = (candidate.standard_deviations.len(), candidate.jacobian.len());
        check_size("standard deviations of a candidate", found, expected)?;
        for &deviation in &candidate.standard_deviations {
            crate::error::check_positive("a standard deviation", deviation)?;
        }
    }
    Ok(())
}
