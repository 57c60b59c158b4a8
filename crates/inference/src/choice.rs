//! Which of several models the data support.

use std::collections::BTreeMap;

use crate::covariance::{GoodnessOfFit, goodness};
use crate::error::{IdentifyError, check_size};
use crate::fit::{Fit, FitOptions, Progress, Stage, fit, fit_from};
use crate::model::ForwardModel;
use crate::problem::Problem;
use crate::random::{generator, shuffle};
use crate::subset::Subset;

/// A candidate is rejected only if its cross-validation score is worse by more than this many
/// standard errors of the difference, ...
pub const REJECTION_ERRORS: f64 = 2.5;
/// ... and its corrected Akaike criterion is larger by more than this.
pub const REJECTION_AICC: f64 = 10.0;

/// Probability of its residuals below which a candidate may be excluded by them alone, ...
pub const MISFIT: f64 = 1e-6;
/// ... and that of the best candidate's residuals from which on they may be so used.
pub const FITS: f64 = 1e-3;

/// Options of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChoiceOptions {
    /// How each candidate is fitted.
    pub fit: FitOptions,
    /// Most folds of the cross-validation, at least 2; no more than there are blocks.
    pub folds: usize,
    /// Seed of the order in which blocks go to folds.
    pub seed: u64,
}

impl Default for ChoiceOptions {
    fn default() -> Self {
        Self { fit: FitOptions::default(), folds: 10, seed: 1 }
    }
}

/// What the data say about a candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModelVerdict {
    /// The lowest corrected Akaike criterion among those whose cross-validation score is within
    /// one standard error of the highest; among all where any has no score.
    Best,
    /// Both cross-validation and the Akaike criterion speak against it.
    Rejected {
        /// By how many standard errors it predicts worse; infinite if every block says so alike.
        standard_errors: f64,
        /// By how much its corrected Akaike criterion is larger.
        aicc_difference: f64,
    },
    /// The data exclude it by themselves: residuals as large as its own have a probability below
    /// [`MISFIT`], those of the best at least [`FITS`], and the Akaike criterion agrees. Few blocks
    /// of very different score leave cross-validation undecided where this does not.
    Misfit {
        /// Probability of residuals as large as its own.
        p_value: f64,
        /// By how much its corrected Akaike criterion is larger.
        aicc_difference: f64,
    },
    /// The data do not tell it from the best.
    Undecided,
}

impl ModelVerdict {
    /// Whether the data speak against the candidate.
    pub fn is_rejected(self) -> bool {
        matches!(self, Self::Rejected { .. } | Self::Misfit { .. })
    }
}

/// Left-out data predicted: the higher the score, the better.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossValidation {
    /// Sum over all left-out observations of the logarithm of their normal density, at the
    /// values fitted without their block. With a robust loss `-rho / 2` takes the place of the
    /// exponent. A missing prediction counts with its stand-in residual.
    pub score: f64,
    /// The part of every block, in increasing order of the blocks' numbers.
    pub blocks: Vec<f64>,
    /// Folds used.
    pub folds: usize,
}

/// One candidate with the evidence.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateOutcome {
    /// The name given.
    pub name: String,
    /// Its fit to all data.
    pub fit: Fit,
    /// Whether the residuals are as large as they should be.
    pub goodness: GoodnessOfFit,
    /// `2 cost + 2 k + 2 k (k + 1) / (n - k - 1)` for `k` unknowns and `n` observations;
    /// infinite where `n <= k + 1`.
    pub aicc: f64,
    /// `2 cost + k ln n`.
    pub bic: f64,
    /// Cross-validation; `None` with fewer than two blocks or a fold that cannot be fitted.
    pub cross_validation: Option<CrossValidation>,
    /// Score less that of the best candidate.
    pub score_difference: Option<f64>,
    /// Standard error of that difference over blocks.
    pub difference_error: Option<f64>,
    /// The verdict.
    pub verdict: ModelVerdict,
}

/// A comparison of candidates.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The candidates, in the order given.
    pub candidates: Vec<CandidateOutcome>,
    /// Index of the best.
    pub best: usize,
}

/// Fits every candidate and weighs them by the corrected Akaike criterion, BIC and cross-validation over whole blocks.
///
/// Blocks are dealt to the folds in a seeded random order; each fold is predicted by a fit to
/// the others that starts from the fit to all. See [`ModelVerdict`] for the rules.
///
/// Sources: K. P. Burnham, D. R. Anderson, *Model Selection and Multimodel Inference*, 2002;
/// A. Vehtari, A. Gelman, J. Gabry, Stat. Comput. 27, 1413 (2017) for the standard error.
///
/// # Errors
///
/// Those of [`fit()`], and [`IdentifyError::Size`] without candidates or if they have different
/// numbers of observations.
pub fn compare(
    candidates: &[(&str, &dyn ForwardModel)],
    options: &ChoiceOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Choice, IdentifyError> {
    let Some((_, first)) = candidates.first() else {
        return Err(IdentifyError::Size { quantity: "candidates", found: 0, expected: 1 });
    };
    if options.folds < 2 {
        let (quantity, value) = ("the number of folds", options.folds as f64);
        return Err(IdentifyError::Option { quantity, value, expected: "at least 2" });
    }
    let expected = first.observations().len();
    let mut outcomes = Vec::with_capacity(candidates.len());
    for (done, &(name, model)) in candidates.iter().enumerate() {
        check_size("observations of a candidate", model.observations().len(), expected)?;
        let found = fit(model, &options.fit, progress)?;
        let problem = Problem::of_fit(model, &found, 1.0)?;
        let (k, n) = (problem.unknowns.len() as f64, expected as f64);
        let room = n - k - 1.0;
        let correction = if room > 0.0 { 2.0 * k * (k + 1.0) / room } else { f64::INFINITY };
        outcomes.push(CandidateOutcome {
            name: name.to_owned(),
            goodness: goodness(&problem, &found),
            aicc: 2.0 * found.cost + 2.0 * k + correction,
            bic: 2.0 * found.cost + k * n.ln(),
            cross_validation: cross_validate(model, &found, options)?,
            fit: found,
            score_difference: None,
            difference_error: None,
            verdict: ModelVerdict::Undecided,
        });
        let of = candidates.len();
        progress(Progress {
            stage: Stage::CrossValidation,
            done: done + 1,
            of,
            cost: f64::INFINITY,
        });
    }
    let best = judge(&mut outcomes);
    Ok(Choice { candidates: outcomes, best })
}

fn cross_validate(
    model: &dyn ForwardModel,
    full: &Fit,
    options: &ChoiceOptions,
) -> Result<Option<CrossValidation>, IdentifyError> {
    let mut fold_of: BTreeMap<usize, usize> =
        model.observations().iter().map(|observation| (observation.block, 0)).collect();
    let folds = options.folds.min(fold_of.len());
    if folds < 2 {
        return Ok(None);
    }
    let mut order: Vec<usize> = (0..fold_of.len()).collect();
    shuffle(&mut order, &mut generator(options.seed, 0xf01d));
    fold_of.values_mut().zip(&order).for_each(|(fold, place)| *fold = place % folds);
    let mut scores: BTreeMap<usize, f64> = fold_of.keys().map(|&block| (block, 0.0)).collect();
    for fold in 0..folds {
        let others = Subset::new(model, |observation| fold_of[&observation.block] != fold);
        let problem = match Problem::new(&others, options.fit.loss, options.fit.missing_residual) {
            Ok(problem) => problem,
            // Too few are left to determine the unknowns.
            Err(IdentifyError::TooFew { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let start = problem.to_working(&full.point);
        let Ok(found) = fit_from(&problem, &[start], &options.fit, &|_| ()) else {
            return Ok(None);
        };
        let left_out = Subset::new(model, |observation| fold_of[&observation.block] == fold);
        let Some(Ok(predictions)) = left_out.predict(&[found.point]).into_iter().next() else {
            return Ok(None);
        };
        for (observation, prediction) in left_out.observations().iter().zip(predictions) {
            let deviation = observation.standard_deviation;
            let answered = prediction.filter(|value| value.is_finite());
            let residual = answered
                .map_or(options.fit.missing_residual, |p| (p - observation.value) / deviation);
            let density = -0.5 * options.fit.loss.value(residual)
                - deviation.ln()
                - 0.5 * std::f64::consts::TAU.ln();
            if let Some(score) = scores.get_mut(&observation.block) {
                *score += density;
            }
        }
    }
    let blocks: Vec<f64> = scores.into_values().collect();
    Ok(Some(CrossValidation { score: blocks.iter().sum(), blocks, folds }))
}

/// Gives every candidate its verdict; returns the best one's index.
fn judge(outcomes: &mut [CandidateOutcome]) -> usize {
    let score =
        |o: &CandidateOutcome| o.cross_validation.as_ref().map_or(f64::NEG_INFINITY, |c| c.score);
    let highest = (0..outcomes.len())
        .max_by(|&a, &b| score(&outcomes[a]).total_cmp(&score(&outcomes[b])))
        .unwrap_or(0);
    // Where too few data are left for the unknowns of any, scores are of no use for all.
    let scored = outcomes.iter().all(|outcome| outcome.cross_validation.is_some());
    let near = |candidate: &CandidateOutcome| match difference(candidate, &outcomes[highest]) {
        Some((difference, error)) => -difference <= error,
        None => false,
    };
    let best = (0..outcomes.len())
        .filter(|&k| !scored || k == highest || near(&outcomes[k]))
        .min_by(|&a, &b| outcomes[a].aicc.total_cmp(&outcomes[b].aicc))
        .unwrap_or(highest);
    for k in 0..outcomes.len() {
        let difference = difference(&outcomes[k], &outcomes[best]);
        let aicc_difference = outcomes[k].aicc - outcomes[best].aicc;
        let verdict = match difference {
            _ if k == best => ModelVerdict::Best,
            Some((lead, error))
                if -lead > REJECTION_ERRORS * error && aicc_difference > REJECTION_AICC =>
            {
                ModelVerdict::Rejected { standard_errors: -lead / error, aicc_difference }
            }
            _ => match (outcomes[k].goodness.p_value, outcomes[best].goodness.p_value) {
                (Some(p_value), Some(p_best))
                    if p_value < MISFIT && p_best >= FITS && aicc_difference > REJECTION_AICC =>
                {
                    ModelVerdict::Misfit { p_value, aicc_difference }
                }
                _ => ModelVerdict::Undecided,
            },
        };
        outcomes[k].score_difference = difference.map(|d| d.0);
        outcomes[k].difference_error = difference.map(|d| d.1);
        outcomes[k].verdict = verdict;
    }
    best
}

/// Score of one less that of the other, with the standard error `sqrt(n var)` over `n` blocks.
fn difference(one: &CandidateOutcome, other: &CandidateOutcome) -> Option<(f64, f64)> {
    let (one, other) = (one.cross_validation.as_ref()?, other.cross_validation.as_ref()?);
    if one.blocks.len() != other.blocks.len() {
        return None;
    }
    let count = one.blocks.len() as f64;
    let apart: Vec<f64> = one.blocks.iter().zip(&other.blocks).map(|(a, b)| a - b).collect();
    let mean = apart.iter().sum::<f64>() / count;
    let variance = apart.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Some((mean * count, (count * variance).sqrt()))
}
