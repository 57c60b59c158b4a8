//! The identification: fit, uncertainty, law with its band, comparison, design.

use std::sync::Arc;
use std::time::Instant;

use asperity_inference::{
    ComparisonOptions, Covariance, Fit, FitOptions, FitSolution, ForwardModel, GoodnessOfFit,
    Identifiability, InferenceError, Linearisation, Loss, ModelComparison, NoiseScale, Observation,
    Parameter, Posterior, Profile, ProgressCallback, ScaledNoise, compare_fits, fit_with_progress,
    refit_with_progress,
};

use crate::data_loader::{BuiltModel, ObservationLabel};
use crate::design::{DesignModel, DesignRanking};
use crate::error::IdentificationError;
use crate::hit_numerics::HitNumerics;
use crate::identification_problem::IdentificationProblem;
use crate::incomplete::IncompleteIdentification;
use crate::latent_sampling::{FreeLawFindings, posterior_of, profiles};
use crate::law_band::{LawBand, StiffnessEstimate, check_pressures};
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{CandidateSpec, LossSpec, NoiseSpec, ParameterSpec};
use crate::scenario_model::ScenarioModel;
use crate::work::{WorkStage, expected_evaluations};
use asperity_scenario::Laws;
use asperity_study::provenance::InputFile;

/// Relative reduction of the cost at which a fit has converged.
const TOLERANCE: f64 = 1e-7;

/// The same of a fit with latents: an error of a thousandth in chi-square is far below its spread.
const LATENT_TOLERANCE: f64 = 1e-4;

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
    /// Their names in words: a step of a monotone law by the stiffnesses that it relates.
    pub labels: Vec<String>,
    /// Stiffnesses at the pressures of the monotone laws among the parameters.
    pub stiffnesses: Vec<StiffnessEstimate>,
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
    /// True if it was stopped in the comparison with other laws, which is then missing.
    pub stopped: bool,
    /// What was found of the law without an assumed form, if the problem has one.
    pub free_law: Option<FreeLawFindings>,
    /// True for the latents among the parameters.
    pub latent: Vec<bool>,
    /// True for observations of hits, whose abscissa is the peak force.
    pub(super) of_force: Vec<bool>,
    /// The parameters of the problem, with the pressures of a free law.
    pub(super) unknowns: Vec<ParameterSpec>,
    /// True for the parameters that are steps or stiffnesses of a monotone law.
    pub(super) in_steps: Vec<bool>,
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
    let problem = &problem.with_pressures()?;
    let BuiltModel { mut forward, about, mut notices } = problem.model()?;
    let law_name = problem.law()?;
    let files = problem.input_files()?;
    notices.splice(0..0, problem.notices.iter().cloned());
    let spec = &problem.spec;
    // Errors of the request come before any computation.
    check_pressures(problem)?;
    let candidates = candidates(problem)?;
    let planned = DesignModel::asked(problem, &forward)?;

    let work = Arc::clone(&problem.work);
    let unfinished = Unfinished::begin(problem, &forward, &law_name, started);
    let own = own_fit(problem, &mut forward, &unfinished, progress)?;
    let given = Fit::resumed(&forward, own.clone(), progress)?;
    let goodness = given.goodness();
    let factor = match spec.noise {
        NoiseSpec::Given => 1.0,
        NoiseSpec::AtLeastGiven => goodness.noise_factor,
    };
    // All results below are those of the model with scaled standard deviations.
    let model = ScaledNoise::new(&forward, factor);
    let best = if factor > 1.0 { refit_with_progress(&model, &own, progress) } else { Ok(given) };
    if best.is_err() && work.is_stopped() {
        let laws = forward.laws(&own.point)?;
        return Err(unfinished.stopped(WorkStage::Fit, own, None, Vec::new(), laws));
    }
    let best = best?;
    let hits = HitNumerics::of(&forward, &forward.controlled(&best.point)?);
    notices.extend(HitNumerics::notices(&hits));
    work.begin(WorkStage::Profiles);
    let linearisation = best.linearise()?;
    let covariance = linearisation.covariance(NoiseScale::Given)?;
    let laws = forward.laws(&best.point)?;
    let profiles = profiles(problem, &forward, &best, &covariance)?;
    if work.is_stopped() {
        let fit = best.into_solution();
        return Err(unfinished.stopped(
            WorkStage::Profiles,
            fit,
            Some(covariance),
            Vec::new(),
            laws,
        ));
    }
    work.begin(WorkStage::Posterior);
    let sampled =
        posterior_of(problem, &forward, &best, (&linearisation, &covariance, &profiles), factor);
    if work.is_stopped() {
        let fit = best.into_solution();
        return Err(unfinished.stopped(
            WorkStage::Posterior,
            fit,
            Some(covariance),
            profiles,
            laws,
        ));
    }
    let (posterior, free_law) = sampled?;
    let law = LawBand::new(problem, &forward, &law_name, &best.point, &posterior)?;
    let stiffnesses = StiffnessEstimate::all(problem, &forward, &best.point, &posterior)?;

    work.begin(WorkStage::Comparison);
    let compared = compare_laws(problem, (&forward, own), &law, candidates, progress);
    // A request to stop leaves out the comparison and the design.
    let (comparison, comparison_noise_factor) =
        if work.is_stopped() { (None, 1.0) } else { compared? };
    let planned = planned.filter(|_| !work.is_stopped());
    let design =
        planned.map(|mut hits| hits.rank(&law, &best.point, &covariance, factor)).transpose()?;
    Ok(Identification {
        names: unfinished.names,
        labels: unfinished.labels,
        free_law,
        latent: forward.parameters().iter().map(Parameter::is_latent).collect(),
        unknowns: spec.unknowns.clone(),
        of_force: of_force(&forward),
        stopped: work.is_stopped(),
        in_steps: (0..forward.parameters().len())
            .map(|parameter| forward.parameters.is_of_monotone_law(parameter))
            .collect(),
        stiffnesses,
        laws,
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

/// True for observations of hits, whose abscissa is the peak force.
fn of_force(forward: &ScenarioModel) -> Vec<bool> {
    let is_of_hit =
        |quantity: &ObservedQuantity| matches!(quantity, ObservedQuantity::Feature { .. });
    forward.quantities.iter().map(is_of_hit).collect()
}

/// The part of an incomplete identification that is known from the beginning.
struct Unfinished {
    names: Vec<String>,
    labels: Vec<String>,
    law: String,
    started: Instant,
}

impl Unfinished {
    /// Begins the work of a problem.
    fn begin(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        law: &str,
        started: Instant,
    ) -> Self {
        let spec = &problem.spec;
        let (parameters, compared) = (forward.parameters(), spec.compare.len() + 1);
        let expected = expected_evaluations(parameters.len(), spec.starts, spec.draws, compared);
        problem.work.plan(expected);
        Self {
            names: parameters.iter().map(|parameter| parameter.name().to_owned()).collect(),
            labels: forward.parameters.labels(&forward.scenario),
            law: law.to_owned(),
            started,
        }
    }

    fn stopped(
        &self,
        stage: WorkStage,
        fit: FitSolution,
        covariance: Option<Covariance>,
        profiles: Vec<Profile>,
        laws: Laws,
    ) -> IdentificationError {
        IdentificationError::Stopped(Box::new(IncompleteIdentification {
            stage,
            names: self.names.clone(),
            labels: self.labels.clone(),
            fit,
            covariance,
            profiles,
            laws,
            law: self.law.clone(),
            wall_s: self.started.elapsed().as_secs_f64(),
        }))
    }
}

/// The fit with the standard deviations as given, at the step and the modes that it needs.
fn own_fit(
    problem: &IdentificationProblem,
    forward: &mut ScenarioModel,
    unfinished: &Unfinished,
    progress: &ProgressCallback<'_>,
) -> Result<FitSolution, IdentificationError> {
    let work = &problem.work;
    // Latents have one start, the scenario's law: their prior has one mode.
    let free = forward.parameters.free.is_some();
    let options = fit_options(problem, if free { 1 } else { problem.spec.starts });
    let options =
        if free { FitOptions { tolerance: LATENT_TOLERANCE, ..options } } else { options };
    let mut given = match fit_with_progress(forward, &options, progress) {
        Err(InferenceError::NoPredictions { .. }) if work.is_stopped() => {
            return Err(IdentificationError::StoppedAtOnce);
        }
        found => found?.into_solution(),
    };
    // The best fit may need finer steps and more modes than those of the search.
    if !work.is_stopped() && forward.hold(&forward.controlled(&given.point)?) {
        let before = given.clone();
        given = match refit_with_progress(forward, &given, progress) {
            Err(InferenceError::NoPredictions { .. }) if work.is_stopped() => before,
            found => found?.into_solution(),
        };
    }
    if work.is_stopped() {
        let laws = forward.laws(&given.point)?;
        return Err(unfinished.stopped(WorkStage::Fit, given, None, Vec::new(), laws));
    }
    Ok(given)
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
    (forward, own_fit): (&ScenarioModel, FitSolution),
    law: &LawBand,
    candidates: Vec<(String, BuiltModel)>,
    progress: &ProgressCallback<'_>,
) -> Result<(Option<ModelComparison>, f64), IdentificationError> {
    let of_law =
        (0..forward.parameters().len()).any(|parameter| forward.parameters.is_of_law(parameter));
    let mut built: Vec<(String, BuiltModel)> = Vec::new();
    if of_law {
        let constant = IdentificationProblem::constant(&law.name, law.stiffness_at_rest);
        built.push((constant.name.clone(), problem.candidate(&constant)?));
    }
    built.extend(candidates);
    if built.is_empty() {
        return Ok((None, 1.0));
    }
    let own = if of_law {
        format!("the problem's law \"{}\"", law.name)
    } else {
        "the problem's scenario".to_owned()
    };
    let options = ComparisonOptions {
        fit: fit_options(problem, COMPARED_STARTS),
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
            return Ok((Some(comparison), factor));
        }
        factor = reduced.sqrt();
    }
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
            model.hold(&model.controlled(&model.start())?);
            fit_with_progress(model, &options.fit, progress)?.into_solution()
        }
        Err(error) => return Err(error.into()),
    };
    if found.chi_square > FAR * own_fit.chi_square.max(found.residuals.len() as f64) {
        return Ok(found);
    }
    Ok(if model.hold(&model.controlled(&found.point)?) {
        refit_with_progress(model, &found, progress)?.into_solution()
    } else {
        found
    })
}

/// Chi-square of a compared law, over that of the problem's own or the number of observations, from
/// which on errors of the steps do not matter.
const FAR: f64 = 100.0;

/// Reduced chi-square of the best law above which the standard deviations are scaled.
const MAX_REDUCED: f64 = 2.0;
