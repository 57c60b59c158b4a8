//! The fit of a problem with its uncertainty, again from a draw of the posterior where that has a lower cost.

use asperity_inference::{
    Agreement, Covariance, Fit, FitOptions, FitSolution, GoodnessOfFit, InferenceError,
    Linearisation, NoiseScale, Posterior, Profile, ProgressCallback, ScaledNoise, Strain,
    StrainKind, fit_with_progress, refit_with_progress,
};
use asperity_scenario::Laws;

use crate::built_model::ObservationLabel;
use crate::correlation::correlation_factor;
use crate::error::IdentificationError;
use crate::hit_numerics::{FeatureErrors, HitNumerics, numerics_at};
use crate::identification_problem::IdentificationProblem;
use crate::latent_sampling::{FreeLawFindings, posterior_of, posterior_options, profiles};
use crate::problem::NoiseSpec;
use crate::response_factor::ResponseFactor;
use crate::scenario_model::ScenarioModel;
use crate::unfinished::Unfinished;
use crate::work::{WorkStage, expected_of_explanations};

/// Relative reduction of the cost at which a fit with latents has converged: an error of a thousandth in chi-square is far below its spread.
const LATENT_TOLERANCE: f64 = 1e-4;

/// Times at most that a fit is repeated from a draw of lower cost.
const MOST_REPEATED: usize = 2;

/// Times at most that the components of a free law's prior are weighted, and sum of the changes of their weights that does
/// not matter.
const MOST_WEIGHTED: usize = 4;
const SAME_WEIGHTS: f64 = 0.2;

/// Share of chi-square, of a fit that does not agree with its data, below which a fit with larger standard deviations
/// shows that it ended short.
const SHORT: f64 = 0.8;

/// Times at most that a search goes on so; a gradual one, of a free law, began so and goes on once.
const MOST_CONTINUED: usize = 4;

/// A fit and what follows from it alone.
pub(super) struct SampledFit {
    /// The fit with the standard deviations as given.
    pub(super) own: FitSolution,
    /// The fit with them times the factor.
    pub(super) best: FitSolution,
    pub(super) factor: f64,
    /// With the standard deviations as given.
    pub(super) goodness: GoodnessOfFit,
    pub(super) hits: Vec<HitNumerics>,
    pub(super) feature_errors: Vec<FeatureErrors>,
    pub(super) linearisation: Linearisation,
    pub(super) covariance: Covariance,
    pub(super) strains: Vec<Strain>,
    pub(super) laws: Laws,
    pub(super) profiles: Vec<Profile>,
    pub(super) sampled: Result<(Posterior, Option<FreeLawFindings>), IdentificationError>,
    /// A draw of lower cost.
    better: Option<Vec<f64>>,
}

/// The fit of a problem, its profiles and its posterior.
///
/// The surface that is sampled may lead out of a minimum that is not the lowest: the fit is then repeated from the best
/// draw, as a further start, and so is all that follows.
pub(super) fn sampled_fit(
    problem: &IdentificationProblem,
    (forward, about): (&mut ScenarioModel, &[ObservationLabel]),
    unfinished: &Unfinished,
    progress: &ProgressCallback<'_>,
) -> Result<SampledFit, IdentificationError> {
    let own = own_fit(problem, forward, unfinished, progress)?;
    problem.work.found();
    let own = continued(problem, (forward, about), own, progress)?;
    let (mut own, mut left) = (own, MOST_REPEATED);
    loop {
        // The last draws are of the fit as it is, whatever is lower.
        let ends_at_lower = left > 0;
        let sampled =
            sampled_from(problem, (forward, about), (own, ends_at_lower), unfinished, progress);
        let mut found = sampled?;
        let Some(better) = found.better.take().filter(|_| ends_at_lower) else { return Ok(found) };
        problem.work.repeat();
        let start = found.own.clone().with_start(better);
        let again = refit_with_progress(forward, &start, progress).map(Fit::into_solution);
        let again = again
            .map_err(IdentificationError::from)
            .and_then(|own| at_held_steps(problem, forward, own, progress));
        (own, left) = match again {
            Ok(again) if again.cost > found.own.cost => (found.own, 0),
            Ok(again) => (again, left - 1),
            // What was finished before a request to stop is kept.
            Err(_) if problem.work.is_stopped() => return Ok(found),
            Err(error) => return Err(error),
        };
    }
}

/// Uncertainty, profiles and posterior of a fit; a posterior that `ends_at_lower` is one of few draws where one is better.
fn sampled_from(
    problem: &IdentificationProblem,
    (forward, about): (&ScenarioModel, &[ObservationLabel]),
    (own, ends_at_lower): (FitSolution, bool),
    unfinished: &Unfinished,
    progress: &ProgressCallback<'_>,
) -> Result<SampledFit, IdentificationError> {
    let (work, spec) = (&problem.work, &problem.spec);
    let given = Fit::resumed(forward, own.clone(), progress)?;
    let goodness = goodness_of(problem, &given);
    let factor = noise_factor(spec.noise, &goodness, (forward, about), &own.residuals);
    // All results below belong to the model with scaled standard deviations.
    let model = ScaledNoise::new(forward, factor);
    let best = if factor > 1.0 { refit_with_progress(&model, &own, progress) } else { Ok(given) };
    if best.is_err() && work.is_stopped() {
        let laws = forward.laws(&own.point)?;
        return Err(unfinished.stopped(WorkStage::Fit, own, None, Vec::new(), laws));
    }
    let best = best?;
    let (hits, feature_errors) = numerics_at(forward, &best.point)?;
    work.begin(WorkStage::Profiles);
    let linearisation = best.linearise()?;
    let covariance = linearisation.covariance(NoiseScale::Given)?;
    let strains = strains_as_given(&linearisation, &best, factor)?;
    let laws = forward.laws(&best.point)?;
    let profiles = profiles(problem, forward, &best, &covariance)?;
    if work.is_stopped() {
        let (fit, covariance) = (best.into_solution(), Some(covariance));
        return Err(unfinished.stopped(WorkStage::Profiles, fit, covariance, Vec::new(), laws));
    }
    work.begin(WorkStage::Posterior);
    let is_free = forward.parameters.free.is_some();
    let disagrees = goodness.agreement() == Agreement::None;
    let mut options = posterior_options(problem, is_free);
    // A free law that agrees with its data has another prior in its draws.
    options.ends_at_lower = ends_at_lower && (disagrees || !is_free);
    if disagrees {
        // A law that is not to be used needs no more draws.
        options.most_times = 0;
    }
    let sampled =
        posterior_of(problem, forward, &best, (&linearisation, &covariance, &profiles), &options);
    if work.is_stopped() {
        let (fit, covariance) = (best.into_solution(), Some(covariance));
        return Err(unfinished.stopped(WorkStage::Posterior, fit, covariance, profiles, laws));
    }
    let better = match &sampled {
        Ok((posterior, None)) => best.better_draw(posterior).map(<[f64]>::to_vec),
        Ok((posterior, Some(_))) if disagrees => {
            best.better_latent_draw(posterior).map(<[f64]>::to_vec)
        }
        _ => None,
    };
    let best = best.into_solution();
    Ok(SampledFit {
        own,
        best,
        factor,
        goodness,
        hits,
        feature_errors,
        linearisation,
        covariance,
        strains,
        laws,
        profiles,
        sampled,
        better,
    })
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
    let options = if free {
        FitOptions { tolerance: LATENT_TOLERANCE, gradual: true, ..problem.fit_options(1) }
    } else {
        problem.fit_options(problem.spec.starts)
    };
    let mut given = match fit_with_progress(forward, &options, progress) {
        Err(InferenceError::NoPredictions { .. }) if work.is_stopped() => {
            return Err(IdentificationError::StoppedAtOnce);
        }
        found => found?.into_solution(),
    };
    given = under_its_own_prior(problem, forward, given, progress)?;
    given = at_held_steps(problem, forward, given, progress)?;
    if work.is_stopped() {
        let laws = forward.laws(&given.point)?;
        return Err(unfinished.stopped(WorkStage::Fit, given, None, Vec::new(), laws));
    }
    Ok(given)
}

/// The fit of a free law under the prior that the data leave: that of its mean covariance, with the components weighted by
/// their posterior probabilities.
///
/// A law with kinks is drawn to one without by the mean covariance before the measurement, and gains, whose priors are then
/// the weaker ones, to what that law needs.
fn under_its_own_prior(
    problem: &IdentificationProblem,
    forward: &mut ScenarioModel,
    mut fit: FitSolution,
    progress: &ProgressCallback<'_>,
) -> Result<FitSolution, IdentificationError> {
    let mut before: Vec<f64> = Vec::new();
    for _ in 0..MOST_WEIGHTED {
        let Some(prior) = forward.parameters.latent_prior()? else { break };
        let found = Fit::resumed(&*forward, fit.clone(), progress)?;
        // Far from the data the linearised model may be singular: the fit stays as it is.
        let Ok(weights) = found.component_probabilities(&prior) else { break };
        let changes = before.iter().zip(&weights).map(|(a, b)| (a - b).abs());
        let is_same = !before.is_empty() && changes.sum::<f64>() < SAME_WEIGHTS;
        if is_same || problem.work.is_stopped() {
            break;
        }
        let same = forward.parameters.weigh(&weights, fit)?;
        fit = match refit_with_progress(&*forward, &same, progress) {
            Err(InferenceError::NoPredictions { .. }) if problem.work.is_stopped() => same,
            found => found?.into_solution(),
        };
        before = weights;
    }
    Ok(fit)
}

/// A fit that does not agree with its data goes on from a fit with larger standard deviations: where residuals are long,
/// the valley of their squares is so narrow and bent that a search ends in it for want of progress, and beside a prior
/// that is of the same size it does not. With a factor of the response that makes the data much nearer at the start of the
/// parameters, no other search reaches them.
fn continued(
    problem: &IdentificationProblem,
    (forward, about): (&mut ScenarioModel, &[ObservationLabel]),
    mut own: FitSolution,
    progress: &ProgressCallback<'_>,
) -> Result<FitSolution, IdentificationError> {
    let is_gradual = forward.parameters.free.is_some();
    let (times, tried) = if is_gradual { (1, 1) } else { (MOST_CONTINUED, 2) };
    for _ in 0..times {
        let goodness = Fit::resumed(&*forward, own.clone(), progress)?.goodness();
        if goodness.agreement() != Agreement::None
            || problem.work.is_stopped()
            || ResponseFactor::of(forward).is_some()
        {
            break;
        }
        // The size of the residuals, and then their correlation too, as the posterior has them.
        let correlated =
            noise_factor(NoiseSpec::AtLeastGiven, &goodness, (&*forward, about), &own.residuals);
        let mut further = None;
        let factors = [goodness.noise_factor, correlated];
        let different = if correlated > factors[0] { tried } else { 1 };
        for factor in factors.into_iter().take(different) {
            further = from_larger_deviations(problem, forward, (&own, factor), progress)?;
            if further.is_some() {
                break;
            }
        }
        let Some(further) = further else { break };
        own = further;
    }
    Ok(own)
}

/// The fit from the end of one with standard deviations that are larger by a factor; none that is hardly better.
fn from_larger_deviations(
    problem: &IdentificationProblem,
    forward: &mut ScenarioModel,
    (own, factor): (&FitSolution, f64),
    progress: &ProgressCallback<'_>,
) -> Result<Option<FitSolution>, IdentificationError> {
    let scaled = {
        let model = ScaledNoise::new(&*forward, factor);
        refit_with_progress(&model, own, progress).map(Fit::into_solution)
    };
    // The fit as it is stands where the other one was stopped or has no predictions.
    let Ok(scaled) = scaled else { return Ok(None) };
    if scaled.chi_square * factor * factor > SHORT * own.chi_square {
        return Ok(None);
    }
    let start = own.clone().with_start(scaled.point);
    let Ok(again) = refit_with_progress(&*forward, &start, progress) else { return Ok(None) };
    let again = at_held_steps(problem, forward, again.into_solution(), progress)?;
    Ok((again.chi_square <= SHORT * own.chi_square).then_some(again))
}

/// A fit at the steps and modes that its end needs, which may be finer than those of the search.
fn at_held_steps(
    problem: &IdentificationProblem,
    forward: &mut ScenarioModel,
    given: FitSolution,
    progress: &ProgressCallback<'_>,
) -> Result<FitSolution, IdentificationError> {
    let work = &problem.work;
    if work.is_stopped() || !forward.hold(&forward.converged(&given.point)?) {
        return Ok(given);
    }
    match refit_with_progress(forward, &given, progress) {
        Err(InferenceError::NoPredictions { .. }) if work.is_stopped() => Ok(given),
        found => Ok(found?.into_solution()),
    }
}

/// The goodness of a fit; one that does not agree needs explanations.
fn goodness_of(problem: &IdentificationProblem, given: &Fit<'_>) -> GoodnessOfFit {
    let goodness = given.goodness();
    if goodness.agreement() == Agreement::None && !problem.is_fast {
        let more = expected_of_explanations(given.point.len());
        problem.work.expect_compared(more);
    }
    goodness
}

/// Factor of the standard deviations: of the size of the residuals, and, where the law does not agree, of their
/// correlation: the errors of a law that agrees are independent.
fn noise_factor(
    noise: NoiseSpec,
    goodness: &GoodnessOfFit,
    (forward, about): (&ScenarioModel, &[ObservationLabel]),
    residuals: &[f64],
) -> f64 {
    match noise {
        NoiseSpec::Given => 1.0,
        NoiseSpec::AtLeastGiven if goodness.agreement() == Agreement::Good => goodness.noise_factor,
        NoiseSpec::AtLeastGiven => {
            let correlated = correlation_factor(&forward.quantities, about, residuals);
            goodness.noise_factor * correlated.sqrt()
        }
    }
}

/// The strains with the standard deviations as given, which are scaled by a factor.
fn strains_as_given(
    linearisation: &Linearisation,
    best: &FitSolution,
    factor: f64,
) -> Result<Vec<Strain>, InferenceError> {
    let mut strains = linearisation.strains(best)?;
    let of_bounds = |strain: &&mut Strain| matches!(strain.kind, StrainKind::Bound(_));
    for strain in strains.iter_mut().filter(of_bounds) {
        strain.deviations *= factor;
    }
    Ok(strains)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::built_model::BuiltModel;

    /// Three receptances of a random rig, whose search for a free law ends at a chi-square of tens of millions with the
    /// standard deviations as given, and from there goes on to its minimum; it gets there with gradual ones by itself. With
    /// 84 numbers and some ten that they inform, chi-square is about 74 +- 12.
    #[test]
    fn a_search_that_starts_far_from_its_data_gets_there() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/problems/receptances_of_a_free_law.json"
        );
        let problem = IdentificationProblem::read(file).unwrap().fast();
        let problem = problem.with_pressures().unwrap();
        let BuiltModel { mut forward, about, .. } = problem.model().unwrap();
        let law = problem.law().unwrap();
        let near = 20.0..110.0;
        let plain = FitOptions { tolerance: LATENT_TOLERANCE, ..problem.fit_options(1) };
        let short = fit_with_progress(&forward, &plain, &|_| ()).unwrap().into_solution();
        assert!(short.chi_square > 1e4, "the search ended at {}", short.chi_square);
        let found = continued(&problem, (&mut forward, &about), short, &|_| ()).unwrap();
        assert!(near.contains(&found.chi_square), "{}", found.chi_square);
        let unfinished = Unfinished::begin(&problem, &forward, &law, Instant::now());
        let own = own_fit(&problem, &mut forward, &unfinished, &|_| ()).unwrap();
        assert!(near.contains(&own.chi_square), "{}", own.chi_square);
    }
}
