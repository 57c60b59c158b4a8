//! The whole way: fit, uncertainty, bands, comparison, design.

use std::time::Instant;

use asperity_inference::{
    Choice, ChoiceOptions, Covariance, Fit, FitOptions, ForwardModel, GoodnessOfFit,
    Identifiability, Linearisation, Loss, NoiseScale, Posterior, PosteriorOptions, Profile,
    ProfileOptions, Stage, compare, covariance, fit, goodness_of_fit, identifiability, linearise,
    posterior, profile,
};

use crate::band::{LawBand, check_pressures};
use crate::design::{self, Designed};
use crate::error::ProblemError;
use crate::inflated::Inflated;
use crate::load::About;
use crate::model::Built;
use crate::problem::{CandidateSpec, LossSpec, NoiseSpec};
use crate::read::Problem;
use asperity_scenario::Laws;

/// Convergence of a fit: the cost no longer falls by this part.
const TOLERANCE: f64 = 1e-7;

/// Step of difference derivatives, over an unknown's length of change: long enough for the tables'
/// errors of 1e-6 to be small in it, and the curvature in it is yet 1e-4.
const DIFFERENCE: f64 = 1e-2;

/// Most folds of the cross-validation.
const FOLDS: usize = 6;

/// Starts of the laws that are compared.
const COMPARED_STARTS: usize = 2;

/// What is being done, and how much of it is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// In words.
    pub name: &'static str,
    /// Parts done.
    pub done: usize,
    /// Parts there are.
    pub of: usize,
}

/// A finished identification.
#[derive(Debug)]
pub struct Identification {
    /// Names of the unknowns.
    pub names: Vec<String>,
    /// The best fit.
    pub fit: Fit,
    /// Predictions there, with exact derivatives.
    pub linearisation: Linearisation,
    /// What the data determine.
    pub identifiability: Identifiability,
    /// Uncertainty near the optimum.
    pub covariance: Covariance,
    /// Whether residuals are as large as the standard deviations say, as these were given.
    pub goodness: GoodnessOfFit,
    /// What all standard deviations were multiplied by.
    pub noise_factor: f64,
    /// Profile likelihoods, one an unknown.
    pub profiles: Vec<Profile>,
    /// Draws from the posterior.
    pub posterior: Posterior,
    /// The law that was asked for, with its band.
    pub law: LawBand,
    /// Comparison with other laws; the problem's own is the first, a constant stiffness the
    /// second.
    pub choice: Option<Choice>,
    /// What the standard deviations were multiplied by for the comparison.
    pub choice_noise_factor: f64,
    /// Hits that could be made next.
    pub design: Option<Designed>,
    /// The laws at the best fit.
    pub laws: Laws,
    /// What was taken or left out.
    pub notices: Vec<String>,
    /// Probability of the intervals.
    pub level: f64,
    /// Time it took \[s\].
    pub wall_s: f64,
    pub(super) about: Vec<About>,
    pub(super) observations: Vec<asperity_inference::Observation>,
}

/// Carries out the identification that `problem` describes. `progress` hears what is being done.
///
/// # Errors
/// [`ProblemError`] where the data do not fit the scenario, or no point can be run.
pub fn identify(
    problem: &Problem,
    progress: &(dyn Fn(Step) + Sync),
) -> Result<Identification, ProblemError> {
    let started = Instant::now();
    let Built { forward, about, mut notices } = problem.model()?;
    let law_name = problem.law()?;
    notices.splice(0..0, problem.notices.iter().cloned());
    let spec = &problem.spec;
    // Whatever is wrong with the request is told before any work is done.
    check_pressures(problem)?;
    let rivals = rivals(problem)?;
    let plan = spec.design.as_ref().map(|asked| design::plan(problem, &forward, asked));
    let plan = plan.transpose()?;
    let hear = |told: asperity_inference::Progress| {
        progress(Step { name: words(told.stage), done: told.done, of: told.of });
    };

    let given = fit(&forward, &fit_options(problem, spec.starts), &hear)?;
    let (goodness, wanted) = goodness_of_fit(&forward, &given)?;
    let factor = match spec.noise {
        NoiseSpec::Given => 1.0,
        NoiseSpec::AtLeastGiven => wanted,
    };
    // All that follows is of the model with the standard deviations that the residuals ask for.
    let model = Inflated::new(&forward, factor);
    let best =
        if factor > 1.0 { fit(&model, &fit_options(problem, spec.starts), &hear)? } else { given };
    let linearisation = linearise(&model, &best)?;
    let identifiability = identifiability(&model, &best, &linearisation)?;
    let covariance = covariance(&model, &best, &linearisation, NoiseScale::Given)?;
    let all: Vec<usize> = (0..best.point.len()).collect();
    let options = ProfileOptions { level: spec.level, ..ProfileOptions::default() };
    let profiles = profile(&model, &best, &covariance, &all, &options, &hear)?;
    let options =
        PosteriorOptions { draws: spec.draws, seed: spec.seed, ..PosteriorOptions::default() };
    let posterior = posterior(&model, &best, &covariance, &profiles, &options, &hear)?;
    let law = LawBand::new(problem, &forward, &law_name, &best, &posterior)?;

    let (choice, choice_noise_factor) = choose(problem, &forward, &law, rivals, &hear)?;
    let design = plan.map(|plan| design::rank(&plan, &law, &best, (&covariance, factor)));
    let design = design.transpose()?;
    Ok(Identification {
        names: forward.unknowns().iter().map(|unknown| unknown.name().to_owned()).collect(),
        laws: forward.laws(&best.point)?,
        observations: model.observations().to_vec(),
        fit: best,
        linearisation,
        identifiability,
        covariance,
        goodness,
        noise_factor: factor,
        profiles,
        posterior,
        law,
        choice,
        choice_noise_factor,
        design,
        notices,
        level: spec.level,
        wall_s: started.elapsed().as_secs_f64(),
        about,
    })
}

fn fit_options(problem: &Problem, starts: usize) -> FitOptions {
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
fn rivals(problem: &Problem) -> Result<Vec<(String, Built)>, ProblemError> {
    let candidates = problem.spec.compare.iter();
    let build =
        |candidate: &CandidateSpec| Ok((candidate.name.clone(), problem.candidate(candidate)?));
    candidates.map(build).collect()
}

/// The problem's law against a constant stiffness and the candidates; none where its unknowns are
/// not of the law. Where no law explains the data, all are compared with standard deviations as
/// large as the best one's residuals.
fn choose(
    problem: &Problem,
    forward: &crate::forward::Forward,
    law: &LawBand,
    rivals: Vec<(String, Built)>,
    hear: &(dyn Fn(asperity_inference::Progress) + Sync),
) -> Result<(Option<Choice>, f64), ProblemError> {
    let of_law = (0..forward.unknowns().len()).any(|unknown| forward.unknowns.is_of_law(unknown));
    let mut built = Vec::new();
    if of_law {
        let constant = Problem::constant(&law.name, law.stiffness_at_rest);
        built.push((constant.name.clone(), problem.candidate(&constant)?));
    }
    built.extend(rivals);
    if built.is_empty() {
        return Ok((None, 1.0));
    }
    let own = format!("the problem's law \"{}\"", law.name);
    let mut factor = 1.0;
    loop {
        let inflated: Vec<(&str, Inflated<'_>)> = std::iter::once((own.as_str(), forward))
            .chain(built.iter().map(|(name, built)| (name.as_str(), &built.forward)))
            .map(|(name, model)| (name, Inflated::new(model, factor)))
            .collect();
        let models: Vec<(&str, &dyn ForwardModel)> =
            inflated.iter().map(|(name, model)| (*name, model as &dyn ForwardModel)).collect();
        let options = ChoiceOptions {
            fit: fit_options(problem, COMPARED_STARTS),
            folds: FOLDS,
            seed: problem.spec.seed,
        };
        let choice = compare(&models, &options, hear)?;
        let goodness = choice.candidates[choice.best].goodness;
        let reduced = goodness.chi_square / goodness.degrees_of_freedom.max(1) as f64;
        if factor > 1.0 || reduced <= MOST_REDUCED {
            return Ok((Some(choice), factor));
        }
        factor = reduced.sqrt();
    }
}

/// Reduced chi-square of the best law above which residuals count as scatter that the standard
/// deviations do not hold.
const MOST_REDUCED: f64 = 2.0;

fn words(stage: Stage) -> &'static str {
    match stage {
        Stage::Fit => "fitting",
        Stage::Profile => "profiles",
        Stage::Surrogate => "response surface",
        Stage::Sampling => "sampling",
        Stage::Draws => "draws",
        Stage::CrossValidation => "comparing laws",
        _ => "working",
    }
}
