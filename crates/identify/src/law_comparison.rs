//! Comparison of the problem's law with a constant stiffness and with laws of other forms.

use asperity_inference::{
    ComparedModel, ComparisonOptions, Fit, FitSolution, ForwardModel, InferenceError,
    ModelComparison, ProgressCallback, ScaledNoise, compare_fits, fit_with_progress,
    refit_with_progress,
};

use crate::build::CONSTANT;
use crate::built_model::BuiltModel;
use crate::error::IdentificationError;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::{ComparedForm, LawBand};
use crate::problem::CandidateSpec;
use crate::scenario_model::ScenarioModel;

/// Largest number of folds of the cross-validation.
const MAX_FOLDS: usize = 6;

/// Starts of the fits of compared laws.
const COMPARED_STARTS: usize = 2;

/// The laws that the problem compares with its own, by their names.
pub(super) fn candidates(
    problem: &IdentificationProblem,
) -> Result<Vec<(String, BuiltModel)>, IdentificationError> {
    let candidates = problem.spec.compare.iter();
    let build =
        |candidate: &CandidateSpec| Ok((candidate.name.clone(), problem.candidate(candidate)?));
    candidates.map(build).collect()
}

/// Comparison of the problem's law with a constant stiffness and the candidates; without parameters
/// of a law, with the candidates alone. Where no law explains the data, all standard deviations are
/// multiplied by the root of the reduced chi-square of the best one.
pub(super) fn compare_laws(
    problem: &IdentificationProblem,
    (forward, own_fit): (&ScenarioModel, FitSolution),
    law: &LawBand,
    candidates: Vec<(String, BuiltModel)>,
    progress: &ProgressCallback<'_>,
) -> Result<Compared, IdentificationError> {
    if problem.is_fast {
        return Ok(Compared::default());
    }
    let of_law =
        (0..forward.parameters().len()).any(|parameter| forward.parameters.is_of_law(parameter));
    let mut built: Vec<(String, BuiltModel)> = Vec::new();
    if of_law {
        let constant = IdentificationProblem::constant(&law.name, law.stiffness_at_rest);
        built.push((constant.name.clone(), problem.candidate(&constant)?));
    }
    built.extend(candidates);
    if built.is_empty() {
        return Ok(Compared::default());
    }
    let own = if let Some(name) = &problem.spec.name {
        name.clone()
    } else if of_law {
        format!("the problem's law \"{}\"", law.name)
    } else {
        "the problem's scenario".to_owned()
    };
    let options = ComparisonOptions {
        fit: problem.fit_options(COMPARED_STARTS),
        folds: MAX_FOLDS,
        seed: problem.spec.seed,
    };
    // The fits with the standard deviations as given.
    let mut given = vec![own_fit];
    for (_, candidate) in &mut built {
        let found = fit_candidate(&mut candidate.forward, (forward, &given[0]), &options, progress);
        given.push(found?);
    }
    let models: Vec<(&str, &ScenarioModel)> = std::iter::once((own.as_str(), forward))
        .chain(built.iter().map(|(name, built)| (name.as_str(), &built.forward)))
        .collect();
    let mut factor = 1.0;
    loop {
        let scaled: Vec<ScaledNoise<'_>> =
            models.iter().map(|(_, model)| ScaledNoise::new(*model, factor)).collect();
        let fits = models.iter().zip(&scaled).zip(&given).map(|(((name, _), model), given)| {
            let found = if factor > 1.0 {
                refit_with_progress(model, given, progress)
            } else {
                Fit::resumed(model, given.clone(), progress)
            };
            Ok((*name, found?))
        });
        let fits = fits.collect::<Result<Vec<_>, IdentificationError>>()?;
        let comparison = compare_fits(fits, &options, progress)?;
        let goodness = comparison.candidates[comparison.best].goodness;
        let reduced = goodness.chi_square / goodness.degrees_of_freedom.max(1) as f64;
        if factor > 1.0 || reduced <= MAX_REDUCED {
            let forms = forms(&models, &comparison, law);
            return Ok(Compared { comparison: Some(comparison), noise_factor: factor, forms });
        }
        factor = reduced.sqrt();
    }
}

/// The comparison with other laws.
pub(super) struct Compared {
    pub(super) comparison: Option<ModelComparison>,
    pub(super) noise_factor: f64,
    pub(super) forms: Vec<ComparedForm>,
}

impl Default for Compared {
    fn default() -> Self {
        Self { comparison: None, noise_factor: 1.0, forms: Vec::new() }
    }
}

/// The compared laws of the problem at their best fits.
fn forms(
    models: &[(&str, &ScenarioModel)],
    comparison: &ModelComparison,
    law: &LawBand,
) -> Vec<ComparedForm> {
    // The first is the problem's own.
    let others = models.iter().zip(&comparison.candidates).skip(1);
    let curve = |((name, model), candidate): (&(&str, &ScenarioModel), &ComparedModel)| {
        let stiffness = model.curve(&law.name, &law.pressure, &candidate.fit.point);
        let missing = |_| vec![f64::NAN; law.pressure.len()];
        ComparedForm { name: (*name).to_owned(), stiffness: stiffness.unwrap_or_else(missing) }
    };
    others.filter(|((name, _), _)| *name != CONSTANT).map(curve).collect()
}

/// The fit of a compared law, with step and modes of the problem's own; with those that its best fit
/// needs where that is near the data.
fn fit_candidate(
    model: &mut ScenarioModel,
    (own, own_fit): (&ScenarioModel, &FitSolution),
    options: &ComparisonOptions,
    progress: &ProgressCallback<'_>,
) -> Result<FitSolution, IdentificationError> {
    model.hold_as(own);
    let found = match fit_with_progress(model, &options.fit, progress) {
        Ok(found) => found.into_solution(),
        // Steps that are too long for the start.
        Err(InferenceError::NoPredictions { .. }) => {
            model.hold(&model.converged(&model.start())?);
            fit_with_progress(model, &options.fit, progress)?.into_solution()
        }
        Err(error) => return Err(error.into()),
    };
    if found.chi_square > FAR * own_fit.chi_square.max(found.residuals.len() as f64) {
        return Ok(found);
    }
    Ok(if model.hold(&model.converged(&found.point)?) {
        refit_with_progress(model, &found, progress)?.into_solution()
    } else {
        found
    })
}

/// Least ratio of chi-square of a compared law to the larger of chi-square of the problem's own law and
/// the number of observations at which errors of the steps do not matter.
const FAR: f64 = 100.0;

/// Reduced chi-square of the best law above which the standard deviations are scaled.
const MAX_REDUCED: f64 = 2.0;
