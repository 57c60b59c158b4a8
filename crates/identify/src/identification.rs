//! The identification: fit, uncertainty, law with its band, comparison, design.

use std::sync::Arc;
use std::time::Instant;

use asperity_inference::{
    Covariance, FitSolution, ForwardModel, GoodnessOfFit, Identifiability, Linearisation,
    ModelComparison, Observation, Parameter, Posterior, PosteriorDiagnostics, Profile,
    ProgressCallback, ScaledNoise, Strain,
};

use crate::built_model::{BuiltModel, ObservationLabel};
use crate::design::{DesignModel, DesignRanking};
use crate::error::IdentificationError;
use crate::explanations::{Explanation, Unexplained};
use crate::given_numbers::{GivenNumber, GivenNumbers, RigidSupport};
use crate::hit_numerics::{FeatureErrors, HitNumerics};
use crate::identification_problem::IdentificationProblem;
use crate::latent_sampling::FreeLawFindings;
use crate::law_band::{ComparedForm, LawBand, StiffnessEstimate, check_pressures};
use crate::law_comparison::{Compared, candidates, compare_laws};
use crate::observed_quantity::ObservedQuantity;
use crate::problem::ParameterSpec;
use crate::sampled_fit::{SampledFit, sampled_fit};
use crate::scenario_model::ScenarioModel;
use crate::unfinished::Unfinished;
use crate::work::{Work, WorkStage};
use asperity_scenario::Laws;
use asperity_simulation::provenance::InputFile;

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
    /// The compared laws of the problem at their best fits; without the constant stiffness.
    pub forms: Vec<ComparedForm>,
    /// Factor of the standard deviations in the comparison.
    pub comparison_noise_factor: f64,
    /// Ranking of further hits.
    pub design: Option<DesignRanking>,
    /// The laws at the best fit.
    pub laws: Laws,
    /// Step, modes and estimated errors of each simulated hit at the best fit.
    pub hits: Vec<HitNumerics>,
    /// Estimated errors of the integration in the observed features of the hits.
    pub feature_errors: Vec<FeatureErrors>,
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
    /// True if profiles, comparison and explanations were left out on request.
    pub is_fast: bool,
    /// The findings about the law without an assumed form, if the problem has one.
    pub free_law: Option<FreeLawFindings>,
    /// True for the latents among the parameters.
    pub latent: Vec<bool>,
    /// Numbers of the scenario that the law depends on and that no parameter changes.
    pub given: Vec<GivenNumber>,
    /// The assumption of a rigid support and the law; none where the support is elastic.
    pub rigid_support: Option<RigidSupport>,
    /// The reason why there are no draws from the posterior but the best fit.
    pub unsampled: Option<String>,
    /// Changes of the model that would explain the data better, where it does not explain them.
    pub explanations: Vec<Explanation>,
    /// Strains of priors and bounds.
    pub strains: Vec<Strain>,
    /// True for the parameters that belong to the law.
    pub(super) of_law: Vec<bool>,
    /// True if any does.
    pub(super) acts_on_law: bool,
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
    let (law_name, spec) = (problem.law()?, &problem.spec);
    let files = problem.input_files()?;
    // Errors of the request come before any computation.
    check_pressures("/pressures_pa", spec.pressures_pa)?;
    let candidates = candidates(problem)?;
    let planned = DesignModel::asked(problem, &forward)?;

    let work = Arc::clone(&problem.work);
    let progress: &ProgressCallback<'_> = &|now| {
        work.follow(&now, spec.draws);
        progress(now);
    };
    let unfinished = Unfinished::begin(problem, &forward, &law_name, started);
    let found = sampled_fit(problem, (&mut forward, &about), &unfinished, progress)?;
    let SampledFit { own, best, factor, goodness, hits, feature_errors, .. } = found;
    let SampledFit { linearisation, covariance, strains, laws, profiles, sampled, .. } = found;
    notices.extend(HitNumerics::notices(&hits));
    let observations = ScaledNoise::new(&forward, factor).observations().to_vec();
    let linear = (&linearisation, &covariance);
    let drawn = Drawn::new(problem, &forward, linear, (&best, &observations), sampled)?;

    work.begin(WorkStage::Comparison);
    let compared = compare_laws(problem, (&forward, own), &drawn.law, candidates, progress);
    // A request to stop leaves out the comparison and the design.
    let Compared { comparison, noise_factor: comparison_noise_factor, forms } =
        if work.is_stopped() { Compared::default() } else { compared? };
    let unexplained = Unexplained {
        problem,
        forward: &forward,
        linear,
        given: &drawn.given,
        observations: &observations,
        best: &best,
        factor,
        goodness: &goodness,
    };
    let explanations = unexplained.explained(&strains, progress)?;
    let design = ranked(planned, &work, &drawn.law, (&best.point, &covariance), factor)?;
    let each = |is: &dyn Fn(usize) -> bool| (0..best.point.len()).map(is).collect();
    Ok(Identification {
        names: unfinished.names,
        labels: unfinished.labels,
        free_law: drawn.free_law,
        acts_on_law: acts_on_law(&forward),
        explanations,
        rigid_support: drawn.given.rigid_support(&forward.scenario, &drawn.law),
        given: drawn.given.list,
        unsampled: drawn.unsampled,
        of_law: each(&|parameter| forward.parameters.is_of_law(parameter)),
        strains,
        latent: forward.parameters().iter().map(Parameter::is_latent).collect(),
        unknowns: spec.unknowns.clone(),
        of_force: of_force(&forward),
        stopped: work.is_stopped(),
        is_fast: problem.is_fast,
        in_steps: each(&|parameter| forward.parameters.is_of_monotone_law(parameter)),
        stiffnesses: drawn.stiffnesses,
        laws,
        observations,
        identifiability: linearisation.identifiability()?,
        fit: best,
        linearisation,
        covariance,
        goodness,
        noise_factor: factor,
        profiles,
        posterior: drawn.posterior,
        law: drawn.law,
        comparison,
        forms,
        comparison_noise_factor,
        design,
        hits,
        feature_errors,
        notices,
        files,
        level: spec.level,
        wall_s: started.elapsed().as_secs_f64(),
        about,
    })
}

/// The ranking of a plan of further hits; none after a request to stop.
fn ranked(
    planned: Option<DesignModel>,
    work: &Work,
    law: &LawBand,
    (point, covariance): (&[f64], &Covariance),
    factor: f64,
) -> Result<Option<DesignRanking>, IdentificationError> {
    let planned = planned.filter(|_| !work.is_stopped());
    planned.map(|mut plan| plan.rank(law, point, covariance, factor)).transpose()
}

/// True if any parameter belongs to a law.
fn acts_on_law(forward: &ScenarioModel) -> bool {
    (0..forward.parameters().len()).any(|parameter| forward.parameters.is_of_law(parameter))
}

/// The posterior, and the law with its band.
struct Drawn {
    posterior: Posterior,
    free_law: Option<FreeLawFindings>,
    unsampled: Option<String>,
    law: LawBand,
    given: GivenNumbers,
    stiffnesses: Vec<StiffnessEstimate>,
}

impl Drawn {
    /// The law of the draws; without draws, the best fit without a band.
    fn new(
        problem: &IdentificationProblem,
        forward: &ScenarioModel,
        linear: (&Linearisation, &Covariance),
        (best, observations): (&FitSolution, &[Observation]),
        sampled: Result<(Posterior, Option<FreeLawFindings>), IdentificationError>,
    ) -> Result<Self, IdentificationError> {
        let (posterior, free_law, unsampled) = match sampled {
            Ok((posterior, free_law)) => (posterior, free_law, None),
            Err(IdentificationError::Inference(error)) if error.is_of_sampler() => {
                (best_alone(best), None, Some(error.to_string()))
            }
            Err(error) => return Err(error),
        };
        let (name, point, level) = (problem.law()?, &best.point, problem.spec.level);
        let mut law =
            LawBand::new(problem, forward, &name, point, (&posterior, free_law.as_ref()))?;
        let given = if acts_on_law(forward) {
            GivenNumbers::of(problem, forward, linear, (&law, observations), point)?
        } else {
            GivenNumbers::default()
        };
        law.widen(&given.deviation, level);
        if unsampled.is_some() {
            law.leave_open();
        }
        let mut stiffnesses = StiffnessEstimate::all(problem, forward, point, &posterior)?;
        given.widen(&mut stiffnesses, &law, level);
        Ok(Self { posterior, free_law, unsampled, law, given, stiffnesses })
    }
}

/// True for observations of hits, whose abscissa is the peak force.
fn of_force(forward: &ScenarioModel) -> Vec<bool> {
    let is_of_hit =
        |quantity: &ObservedQuantity| matches!(quantity, ObservedQuantity::Feature { .. });
    forward.quantities.iter().map(is_of_hit).collect()
}

/// The best fit in place of draws: no draw is effective, and no chain has converged.
fn best_alone(best: &FitSolution) -> Posterior {
    let count = best.point.len();
    Posterior {
        draws: vec![best.point.clone()],
        weights: vec![1.0],
        predictions: vec![best.predictions.clone()],
        diagnostics: PosteriorDiagnostics {
            r_hat: vec![f64::INFINITY; count],
            effective_sample_size: vec![0.0; count],
            autocorrelation_time: vec![f64::INFINITY; count],
            ..PosteriorDiagnostics::default()
        },
    }
}
