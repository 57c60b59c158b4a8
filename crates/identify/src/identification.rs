//! The identification: fit, uncertainty, law with its band, comparison, design.

use std::time::Instant;

use asperity_inference::{
    ComparisonOptions, Covariance, Fit, FitOptions, FitSolution, ForwardModel, GoodnessOfFit,
    Identifiability, Linearisation, Loss, ModelComparison, NoiseScale, Observation, Posterior,
    PosteriorOptions, Profile, ProfileOptions, ProgressCallback, ScaledNoise,
    compare_with_progress, fit_with_progress,
};

use crate::data_loader::{BuiltModel, ObservationLabel};
use crate::design::{DesignModel, DesignRanking};
use crate::error::IdentificationError;
use crate::hit_numerics::HitNumerics;
use crate::identification_problem::IdentificationProblem;
use crate::law_band::{LawBand, check_pressures};
use crate::problem::{CandidateSpec, LossSpec, NoiseSpec};
use crate::scenario_model::ScenarioModel;
use asperity_scenario::Laws;
use asperity_study::provenance::InputFile;

/// Relative reduction of the cost at which a fit has converged.
const TOLERANCE: f64 = 1e-7;

/// Relative step of difference derivatives: large against the tables' errors of 1e-6, with an error
/// of 1e-4 from the curvature.
const DIFFERENCE: f64 = 1e-2;

/// Largest number of folds of the cross-validation.
const MAX_FOLDS: usize = 6;

/// Starts of the fits of compared laws.
const COMPARED_STARTS: usize = 2;

/// A finished identification.
#[derive(Debug)]
pub struct Identification {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// The best fit.
    pub fit: FitSolution,
    /// Predictions there, with exact derivatives.
    pub linearisation: Linearisation,
    /// Combinations of parameters that the data determine.
    pub identifiability: Identifiability,
    /// Uncertainty near the optimum.
    pub covariance: Covariance,
    /// Goodness of the fit with the standard deviations as given.
    pub goodness: GoodnessOfFit,
    /// Factor of all standard deviations in the results.
    pub noise_factor: f64,
    /// Profile likelihoods, one per parameter.
    pub profiles: Vec<Profile>,
    /// Draws from the posterior.
    pub posterior: Posterior,
    /// The identified law with its credible band.
    pub law: LawBand,
    /// Comparison with other laws; the problem's own is the first, a constant stiffness the
    /// second.
    pub comparison: Option<ModelComparison>,
    /// Factor of the standard deviations in the comparison.
    pub comparison_noise_factor: f64,
    /// Ranking of further hits.
    pub design: Option<DesignRanking>,
    /// The laws at the best fit.
    pub laws: Laws,
    /// Step, modes and estimated errors of each simulated hit at the best fit.
    pub hits: Vec<HitNumerics>,
    /// Notices on replaced or omitted data and settings, and warnings about simulated hits.
    pub notices: Vec<String>,
    /// Files that the result depends on, beside problem and scenario.
    pub files: Vec<InputFile>,
    /// Probability of the intervals.
    pub level: f64,
    /// Wall-clock time \[s\].
    pub wall_s: f64,
    pub(super) about: Vec<ObservationLabel>,
    pub(super) observations: Vec<Observation>,
}

/// Carries out the identification that `problem` describes.
///
/// # Errors
/// [`IdentificationError`] where the data do not fit the scenario, or the scenario cannot be run at
/// any start.
///
/// # Example
/// ```no_run
/// use asperity_identify::{IdentificationError, IdentificationProblem, identify};
///
/// let found = identify(&IdentificationProblem::read("problem.json")?)?;
/// for estimate in found.estimates() {
///     println!("{}: {} +- {}", estimate.name, estimate.value, estimate.standard_deviation);
/// }
/// # Ok::<(), IdentificationError>(())
/// ```
pub fn identify(problem: &IdentificationProblem) -> Result<Identification, IdentificationError> {
    identify_with_progress(problem, &|_| ())
}

/// As [`identify`], with a callback that receives the progress.
///
/// # Errors
/// Those of [`identify`].
pub fn identify_with_progress(
    problem: &IdentificationProblem,
    progress: &ProgressCallback<'_>,
) -> Result<Identification, IdentificationError> {
    let started = Instant::now();
    let BuiltModel { mut forward, about, mut notices } = problem.model()?;
    let law_name = problem.law()?;
    let files = problem.input_files()?;
    notices.splice(0..0, problem.notices.iter().cloned());
    let spec = &problem.spec;
    // Errors of the request come before any computation.
    check_pressures(problem)?;
    let candidates = candidates(problem)?;
    let planned = spec.design.as_ref().map(|asked| DesignModel::new(problem, &forward, asked));
    let planned = planned.transpose()?;

    let options = fit_options(problem, spec.starts);
    let mut given = fit_with_progress(&forward, &options, progress)?.into_solution();
    // Step and modes are those that the start needs; the best fit may need finer ones.
    if forward.hold(&forward.controlled(&given.point)?) {
        given = fit_with_progress(&forward, &options, progress)?.into_solution();
    }
    let given = Fit::resumed(&forward, given, progress)?;
    let goodness = given.goodness();
    let factor = match spec.noise {
        NoiseSpec::Given => 1.0,
        NoiseSpec::AtLeastGiven => goodness.noise_factor,
    };
    // All results below are those of the model with scaled standard deviations.
    let model = ScaledNoise::new(&forward, factor);
    let best = if factor > 1.0 { fit_with_progress(&model, &options, progress)? } else { given };
    let hits = HitNumerics::of(&forward, &forward.controlled(&best.point)?);
    notices.extend(HitNumerics::notices(&hits));
    let linearisation = best.linearise()?;
    let covariance = linearisation.covariance(NoiseScale::Given)?;
    let all: Vec<usize> = (0..best.point.len()).collect();
    let options = ProfileOptions { level: spec.level, ..ProfileOptions::default() };
    let profiles = best.profile(&covariance, &all, &options)?;
    let options =
        PosteriorOptions { draws: spec.draws, seed: spec.seed, ..PosteriorOptions::default() };
    let posterior = best.posterior(&covariance, &profiles, &options)?;
    let law = LawBand::new(problem, &forward, &law_name, &best.point, &posterior)?;

    let (comparison, comparison_noise_factor) =
        compare_laws(problem, &forward, &law, candidates, progress)?;
    let design =
        planned.map(|hits| hits.rank(&law, &best.point, &covariance, factor)).transpose()?;
    Ok(Identification {
        names: forward.parameters().iter().map(|parameter| parameter.name().to_owned()).collect(),
        laws: forward.laws(&best.point)?,
        observations: model.observations().to_vec(),
        identifiability: linearisation.identifiability()?,
        fit: best.into_solution(),
        linearisation,
        covariance,
        goodness,
        noise_factor: factor,
        profiles,
        posterior,
        law,
        comparison,
        comparison_noise_factor,
        design,
        hits,
        notices,
        files,
        level: spec.level,
        wall_s: started.elapsed().as_secs_f64(),
        about,
    })
}

fn fit_options(problem: &IdentificationProblem, starts: usize) -> FitOptions {
    let loss = match problem.spec.loss {
        LossSpec::Squared => Loss::Squared,
        LossSpec::Huber { threshold } => Loss::Huber { threshold },
        LossSpec::Cauchy { scale } => Loss::Cauchy { scale },
    };
    let seed = problem.spec.seed;
    FitOptions {
        loss,
        starts,
        seed,
        tolerance: TOLERANCE,
        difference_step: DIFFERENCE,
        ..FitOptions::default()
    }
}

/// The laws that the problem compares with its own, by their names.
fn candidates(
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
fn compare_laws(
    problem: &IdentificationProblem,
    forward: &ScenarioModel,
    law: &LawBand,
    candidates: Vec<(String, BuiltModel)>,
    progress: &ProgressCallback<'_>,
) -> Result<(Option<ModelComparison>, f64), IdentificationError> {
    let of_law =
        (0..forward.parameters().len()).any(|parameter| forward.parameters.is_of_law(parameter));
    let mut built = Vec::new();
    if of_law {
        let constant = IdentificationProblem::constant(&law.name, law.stiffness_at_rest);
        built.push((constant.name.clone(), problem.candidate(&constant)?));
    }
    built.extend(candidates);
    if built.is_empty() {
        return Ok((None, 1.0));
    }
    let own = format!("the problem's law \"{}\"", law.name);
    let mut factor = 1.0;
    loop {
        let scaled: Vec<(&str, ScaledNoise<'_>)> = std::iter::once((own.as_str(), forward))
            .chain(built.iter().map(|(name, built)| (name.as_str(), &built.forward)))
            .map(|(name, model)| (name, ScaledNoise::new(model, factor)))
            .collect();
        let models: Vec<(&str, &dyn ForwardModel)> =
            scaled.iter().map(|(name, model)| (*name, model as &dyn ForwardModel)).collect();
        let options = ComparisonOptions {
            fit: fit_options(problem, COMPARED_STARTS),
            folds: MAX_FOLDS,
            seed: problem.spec.seed,
        };
        let comparison = compare_with_progress(&models, &options, progress)?;
        let goodness = comparison.candidates[comparison.best].goodness;
        let reduced = goodness.chi_square / goodness.degrees_of_freedom.max(1) as f64;
        if factor > 1.0 || reduced <= MAX_REDUCED {
            return Ok((Some(comparison), factor));
        }
        factor = reduced.sqrt();
    }
}

/// Reduced chi-square of the best law above which the standard deviations are scaled.
const MAX_REDUCED: f64 = 2.0;
