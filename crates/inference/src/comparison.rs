//! Comparison of models by information criteria and cross-validation.

use std::collections::BTreeMap;

use crate::error::{InferenceError, check_range, check_size};
use crate::fit::{Fit, FitSolution, fit_with_progress};
use crate::fit_options::FitOptions;
use crate::fit_problem::FitProblem;
use crate::goodness::GoodnessOfFit;
use crate::model::ForwardModel;
use crate::progress::{NO_PROGRESS, ProgressCallback, Stage, report};
use crate::random::{chi_square_tail, generator, shuffle};
use crate::search::{Search, run_all};

/// Number of standard errors of the difference by which the cross-validation score of a rejected
/// candidate is worse.
pub const REJECTION_ERRORS: f64 = 2.5;
/// Difference of the corrected Akaike criterion beyond which a candidate may be rejected.
pub const REJECTION_AICC: f64 = 10.0;

/// p-value below which a candidate is a misfit by its residuals alone.
pub const MISFIT_P_VALUE: f64 = 1e-6;
/// p-value of a candidate from which on others can be misfits.
pub const GOOD_P_VALUE: f64 = 1e-3;

/// Options of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparisonOptions {
    /// Options of the fits.
    pub fit: FitOptions,
    /// Largest number of folds of the cross-validation, at least 2; at most the number of blocks.
    pub folds: usize,
    /// Seed of the assignment of blocks to folds.
    pub seed: u64,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self { fit: FitOptions::default(), folds: 10, seed: 1 }
    }
}

/// Assessment of a candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModelAssessment {
    /// Of those that their residuals do not reject, the lowest corrected Akaike criterion among those
    /// whose cross-validation score is within one standard error of the highest; among all where any
    /// has no score.
    Best,
    /// Cross-validation and the Akaike criterion both reject it.
    Rejected {
        /// Difference of the scores in standard errors; infinite if it is the same in every block.
        standard_errors: f64,
        /// Difference of the corrected Akaike criteria.
        aicc_difference: f64,
    },
    /// Its residuals reject it: their p-value is below [`MISFIT_P_VALUE`], that of another candidate at
    /// least [`GOOD_P_VALUE`]. This comes first: with few observations the Akaike criterion is infinite,
    /// and cross-validation has few blocks of very different score.
    Misfit {
        /// p-value of its residuals.
        p_value: f64,
        /// Difference of the corrected Akaike criteria; not finite with too few observations.
        aicc_difference: f64,
    },
    /// The data do not distinguish it from the best.
    Undecided,
}

impl ModelAssessment {
    /// True if the candidate is rejected.
    pub fn is_rejected(self) -> bool {
        matches!(self, Self::Rejected { .. } | Self::Misfit { .. })
    }
}

/// Prediction of left-out data: a higher score is better.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossValidation {
    /// Sum over all left-out observations of the logarithm of their normal density, at the
    /// parameters fitted without their block. With a robust loss `-rho / 2` replaces the exponent.
    /// A missing prediction counts as [`FitOptions::missing_residual`].
    pub score: f64,
    /// The part of every block, in increasing order of the blocks' numbers.
    pub blocks: Vec<f64>,
    /// Folds used.
    pub folds: usize,
}

/// One candidate of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedModel {
    /// The name given.
    pub name: String,
    /// Its fit to all data.
    pub fit: FitSolution,
    /// Goodness of that fit.
    pub goodness: GoodnessOfFit,
    /// `2 cost + 2 k + 2 k (k + 1) / (n - k - 1)` for `k` parameters and `n` observations;
    /// infinite where `n <= k + 1`. Latents count as many parameters as the data determine of them,
    /// `sum s^2 / (1 + s^2)` over the singular values `s` of the standardised Jacobian, and their prior
    /// is no part of the cost (T. Hastie, R. Tibshirani, *Generalized Additive Models*, 1990, section
    /// 6.8).
    pub aicc: f64,
    /// `2 cost + k ln n`.
    pub bic: f64,
    /// Cross-validation; `None` with fewer than two blocks or a fold that cannot be fitted.
    pub cross_validation: Option<CrossValidation>,
    /// Score less the score of the best candidate.
    pub score_difference: Option<f64>,
    /// Standard error of that difference over blocks.
    pub difference_error: Option<f64>,
    /// The assessment.
    pub assessment: ModelAssessment,
}

/// A comparison of candidates.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelComparison {
    /// The candidates, in the order given.
    pub candidates: Vec<ComparedModel>,
    /// Index of the best.
    pub best: usize,
}

/// Fits every candidate and compares them by the corrected Akaike criterion, BIC and
/// cross-validation over whole blocks.
///
/// Blocks are assigned to folds in a seeded random order; each fold is predicted by a fit to the
/// others, started from the fit to all. [`ModelAssessment`] states the rules.
///
/// Sources: K. P. Burnham, D. R. Anderson, *Model Selection and Multimodel Inference*, 2002;
/// A. Vehtari, A. Gelman, J. Gabry, Stat. Comput. 27, 1413 (2017) for the standard error.
///
/// # Errors
///
/// Those of [`fit`](crate::fit()), and [`InferenceError::Size`] without candidates or if they have different
/// numbers of observations.
///
/// # Example
///
/// ```
/// # use asperity_inference::*;
/// let times: Vec<f64> = (0..20).map(f64::from).collect();
/// let observations = Observation::list(&times.iter().map(|t| 1.0 + t).collect::<Vec<_>>(), 0.1);
/// let parameter = |name| Parameter::linear(name, 0.5, [-5.0, 5.0]);
/// let constant = FunctionModel {
///     parameters: vec![parameter("mean")?],
///     observations: observations.clone(),
///     function: |x: &[f64]| vec![x[0]; 20],
/// };
/// let line = FunctionModel {
///     parameters: vec![parameter("intercept")?, parameter("slope")?],
///     observations,
///     function: |x: &[f64]| times.iter().map(|t| x[0] + x[1] * t).collect(),
/// };
/// let models: [(&str, &dyn ForwardModel); 2] = [("constant", &constant), ("line", &line)];
/// let comparison = compare(&models, &ComparisonOptions::default())?;
/// assert_eq!(comparison.candidates[comparison.best].name, "line");
/// assert!(comparison.candidates[0].assessment.is_rejected());
/// # Ok::<(), InferenceError>(())
/// ```
pub fn compare(
    candidates: &[(&str, &dyn ForwardModel)],
    options: &ComparisonOptions,
) -> Result<ModelComparison, InferenceError> {
    compare_with_progress(candidates, options, NO_PROGRESS)
}

/// As [`compare`], with a callback that receives the progress.
///
/// # Errors
///
/// Those of [`compare`].
pub fn compare_with_progress<'m>(
    candidates: &[(&str, &'m dyn ForwardModel)],
    options: &ComparisonOptions,
    progress: &'m ProgressCallback<'m>,
) -> Result<ModelComparison, InferenceError> {
    let fits = candidates
        .iter()
        .map(|&(name, model)| Ok((name, fit_with_progress(model, &options.fit, progress)?)))
        .collect::<Result<Vec<_>, InferenceError>>()?;
    compare_fits(fits, options, progress)
}

/// As [`compare_with_progress`], with the fits of the candidates; the options of the fits are their
/// own.
///
/// # Errors
///
/// Those of [`compare`].
pub fn compare_fits(
    candidates: Vec<(&str, Fit<'_>)>,
    options: &ComparisonOptions,
    progress: &ProgressCallback<'_>,
) -> Result<ModelComparison, InferenceError> {
    let Some((_, first)) = candidates.first() else {
        return Err(InferenceError::Size { quantity: "candidates", found: 0, expected: 1 });
    };
    let folds = options.folds as f64;
    check_range("the number of folds", folds, 2.0..=f64::INFINITY, "at least 2")?;
    let expected = first.predictions.len();
    let count = candidates.len();
    let mut outcomes = Vec::with_capacity(count);
    for (done, (name, found)) in candidates.into_iter().enumerate() {
        check_size("observations of a candidate", found.predictions.len(), expected)?;
        let (k, n) = (found.effective_parameters(), expected as f64);
        let deviance = 2.0 * found.cost - found.latent_prior_chi_square();
        let room = n - k - 1.0;
        let correction = if room > 0.0 { 2.0 * k * (k + 1.0) / room } else { f64::INFINITY };
        outcomes.push(ComparedModel {
            name: name.to_owned(),
            goodness: found.goodness(),
            aicc: deviance + 2.0 * k + correction,
            bic: deviance + k * n.ln(),
            cross_validation: cross_validate(&found, options),
            fit: found.into_solution(),
            score_difference: None,
            difference_error: None,
            assessment: ModelAssessment::Undecided,
        });
        report(progress, Stage::Comparison, done + 1, count);
    }
    let best = assess(&mut outcomes);
    Ok(ModelComparison { candidates: outcomes, best })
}

fn cross_validate(full: &Fit<'_>, options: &ComparisonOptions) -> Option<CrossValidation> {
    let whole = &full.problem;
    let mut fold_of: BTreeMap<usize, usize> =
        whole.observations.iter().map(|observation| (observation.block, 0)).collect();
    let folds = options.folds.min(fold_of.len());
    if folds < 2 {
        return None;
    }
    let mut order: Vec<usize> = (0..fold_of.len()).collect();
    shuffle(&mut order, &mut generator(options.seed, 0xf01d));
    fold_of.values_mut().zip(&order).for_each(|(fold, place)| *fold = place % folds);
    let mut scores: BTreeMap<usize, f64> = fold_of.keys().map(|&block| (block, 0.0)).collect();
    // All folds advance together, from the fit to all.
    let known = full.known();
    let mut problems = Vec::with_capacity(folds);
    for fold in 0..folds {
        let counted = whole.observations.iter().map(|one| fold_of[&one.block] != fold).collect();
        // Too few may be left to determine the parameters.
        problems.push(whole.with_counted(counted)?);
    }
    let problems: Vec<&FitProblem<'_>> = problems.iter().collect();
    let search = |problem: &&FitProblem<'_>| Search::at(problem, &full.options, known.clone());
    let mut searches: Vec<Search> = problems.iter().map(search).collect();
    run_all(&problems, &mut searches, &full.options, Stage::Fit, NO_PROGRESS);
    for (fold, search) in searches.iter().enumerate() {
        if !search.cost.is_finite() {
            return None;
        }
        for (i, observation) in whole.observations.iter().enumerate() {
            if fold_of[&observation.block] != fold {
                continue;
            }
            let residual = whole.residual(i, search.predictions[i]);
            let density = -0.5 * full.options.loss.value(residual)
                - observation.standard_deviation.ln()
                - 0.5 * std::f64::consts::TAU.ln();
            if let Some(score) = scores.get_mut(&observation.block) {
                *score += density;
            }
        }
    }
    let blocks: Vec<f64> = scores.into_values().collect();
    Some(CrossValidation { score: blocks.iter().sum(), blocks, folds })
}

/// Assesses every candidate; returns the index of the best.
fn assess(outcomes: &mut [ComparedModel]) -> usize {
    let residuals: Vec<f64> = outcomes.iter().map(residual_p_value).collect();
    // Residuals reject before any criterion, which too few observations do not have.
    let explains = residuals.iter().any(|p_value| *p_value >= GOOD_P_VALUE);
    let is_misfit = |k: usize| explains && residuals[k] < MISFIT_P_VALUE;
    let left: Vec<usize> = (0..outcomes.len()).filter(|&k| !is_misfit(k)).collect();
    let score =
        |o: &ComparedModel| o.cross_validation.as_ref().map_or(f64::NEG_INFINITY, |c| c.score);
    let by_score = |a: &&usize, b: &&usize| score(&outcomes[**a]).total_cmp(&score(&outcomes[**b]));
    let highest = left.iter().max_by(by_score).copied().unwrap_or(0);
    // Scores are used only if all candidates have one.
    let scored = left.iter().all(|&k| outcomes[k].cross_validation.is_some());
    let near = |candidate: &ComparedModel| match difference(candidate, &outcomes[highest]) {
        Some((difference, error)) => -difference <= error,
        None => false,
    };
    let best = left
        .iter()
        .copied()
        .filter(|&k| !scored || k == highest || near(&outcomes[k]))
        .min_by(|&a, &b| outcomes[a].aicc.total_cmp(&outcomes[b].aicc))
        .unwrap_or(highest);
    for k in 0..outcomes.len() {
        let difference = difference(&outcomes[k], &outcomes[best]);
        let aicc_difference = outcomes[k].aicc - outcomes[best].aicc;
        let assessment = match difference {
            _ if k == best => ModelAssessment::Best,
            Some((lead, error))
                if -lead > REJECTION_ERRORS * error && aicc_difference > REJECTION_AICC =>
            {
                ModelAssessment::Rejected { standard_errors: -lead / error, aicc_difference }
            }
            _ if is_misfit(k) => ModelAssessment::Misfit { p_value: residuals[k], aicc_difference },
            _ => ModelAssessment::Undecided,
        };
        outcomes[k].score_difference = difference.map(|d| d.0);
        outcomes[k].difference_error = difference.map(|d| d.1);
        outcomes[k].assessment = assessment;
    }
    best
}

/// p-value of the residuals; as of one degree of freedom where there is none.
fn residual_p_value(outcome: &ComparedModel) -> f64 {
    let ComparedModel { goodness, .. } = outcome;
    chi_square_tail(goodness.chi_square, goodness.degrees_of_freedom.max(1)).unwrap_or(0.0)
}

/// Difference of two scores, with the standard error `sqrt(n var)` over `n` blocks.
fn difference(one: &ComparedModel, other: &ComparedModel) -> Option<(f64, f64)> {
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
