//! The posterior distribution of the unknowns, as weighted draws.

mod options;
mod reach;
mod summary;

use std::cell::RefCell;

use crate::convergence::{effective_sample_size, r_hat};
use crate::covariance::Covariance;
use crate::dense::upper_root;
use crate::error::{IdentifyError, check_size};
use crate::fit::{Fit, Progress, Stage};
use crate::importance::{effective_draws, normalised, pareto_shape};
use crate::model::{ForwardModel, Predictions};
use crate::problem::Problem;
use crate::profile::Profile;
use crate::sampler::{Chains, Plan, run};
use crate::surrogate::{REACH, Surrogate, SurrogateOptions, Training, Whitening, sample};

pub use options::{PosteriorMethod, PosteriorOptions};
use reach::unreached;
pub use summary::Band;

/// Walkers of the smallest ensemble: fewer move together.
const LEAST_WALKERS: usize = 16;
/// Whitened coordinates beyond which draws crowd the end of the response surface.
const CROWDED: f64 = 0.9 * REACH;
/// Share of crowding draws that asks for another round; a normal distribution has none.
const MOST_CROWDED: f64 = 0.001;
/// By how much the next surface reaches farther when draws crowd the end of this one.
const WIDENING: f64 = 1.5;

/// How far the draws can be trusted.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriorDiagnostics {
    /// Rank-normalised split R-hat of every unknown, each ensemble one chain of its walkers' steps in
    /// turn; below 1.01 is good.
    pub r_hat: Vec<f64>,
    /// Effective sample size of every unknown, of all kept steps: the smaller of the bulk size over
    /// walkers and the one that the ensembles' means have.
    pub effective_sample_size: Vec<f64>,
    /// Steps after which a walker has forgotten where it was: kept steps over the effective
    /// sample size, of every unknown.
    pub autocorrelation_time: Vec<f64>,
    /// Share of accepted moves.
    pub acceptance: f64,
    /// Effective number of weighted draws, at most their number.
    pub effective_draws: f64,
    /// Pareto shape of the largest weights: below 0.7 weighted means are trustworthy. `None`
    /// where the weights are exact or too few.
    pub pareto_shape: Option<f64>,
    /// Share of draws next to the end of the response surface's range.
    pub crowded: f64,
    /// Response surfaces trained; 0 for the exact method.
    pub rounds: usize,
    /// Largest leave-out error of the last surface, in standard deviations of an observation.
    pub surrogate_error: f64,
    /// Training points the model answered at, and draws, of all rounds; for the exact method all
    /// points asked for.
    pub evaluations: usize,
    /// Unknowns whose draws leave out a quarter or more of what their profile allows: then the
    /// surface has lost a part of the distribution.
    pub unreached: Vec<usize>,
}

/// Draws from the posterior distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Values of the unknowns, a row per draw.
    pub draws: Vec<Vec<f64>>,
    /// Weight of every draw; they sum to 1.
    pub weights: Vec<f64>,
    /// The model's predictions at every draw; empty where it refuses (weight 0).
    pub predictions: Vec<Predictions>,
    /// How far they can be trusted.
    pub diagnostics: PosteriorDiagnostics,
}

/// Samples `exp(-cost(x))` in working coordinates within the bounds: the loss gives the
/// likelihood (a pseudo-likelihood unless squared), the priors count, and the observations'
/// variances are multiplied by the covariance's noise factor squared.
///
/// Chains run on a [`Surrogate`]; of their steps [`PosteriorOptions::draws`] evenly spread ones
/// are evaluated on the model and weighted by exact over surrogate density, so that errors of
/// the surface cost draws but bias nothing it reaches. While the effective share of draws is below
/// [`PosteriorOptions::wanted_share`], or draws crowd the end of the surface's range, a new
/// surface is trained on these draws and a new sample about them; the best round counts.
/// Results depend on the seed, not on the number of threads.
///
/// A tail that no surface reaches is lost without a sign in the weights: of a distribution that is
/// bent over many of its widths and heavy-tailed, compare with [`PosteriorMethod::Exact`] or a
/// [`crate::profile()`].
///
/// # Errors
///
/// Options out of range, the errors of [`Surrogate::train`], [`IdentifyError::Size`] for a fit or
/// covariance of another model, [`IdentifyError::AllRefused`] if no draw has an exact density.
pub fn posterior(
    model: &dyn ForwardModel,
    fit: &Fit,
    covariance: &Covariance,
    profiles: &[Profile],
    options: &PosteriorOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Posterior, IdentifyError> {
    options.check()?;
    let problem = Problem::of_fit(model, fit, covariance.noise_factor.powi(2))?;
    check_size("unknowns of the covariance", covariance.centre.len(), problem.unknowns.len())?;
    let whitening = Whitening { centre: covariance.centre.clone(), root: covariance.root.clone() };
    let mut found = match options.method {
        PosteriorMethod::Surrogate => {
            by_surrogate(&problem, whitening, profiles, options, progress)
        }
        PosteriorMethod::Exact => exactly(&problem, &whitening, options, progress),
    }?;
    found.diagnostics.unreached = unreached(&found, profiles);
    Ok(found)
}

fn plan(dimensions: usize, options: &PosteriorOptions, round: usize) -> Plan {
    Plan {
        dimensions,
        ensembles: options.ensembles,
        walkers: 2 * (dimensions * options.walkers_per_unknown).div_ceil(2).max(LEAST_WALKERS / 2),
        burn_in: options.burn_in,
        steps: options.steps,
        seed: options.seed.wrapping_add(0x5eed * round as u64),
    }
}

fn by_surrogate(
    problem: &Problem<'_>,
    mut whitening: Whitening,
    profiles: &[Profile],
    options: &PosteriorOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Posterior, IdentifyError> {
    let mut training = Training::default();
    let mut best: Option<(f64, Posterior)> = None;
    let mut evaluations = 0;
    for round in 1..=options.most_rounds {
        let valleys = if round == 1 { profiles } else { &[] };
        let seed = options.seed.wrapping_add(round as u64);
        let choice = SurrogateOptions { oversampling: options.oversampling, seed };
        let fresh = sample(problem, &whitening, valleys, &choice, progress)?;
        evaluations += fresh.points.len();
        training.points.extend(fresh.points);
        training.predictions.extend(fresh.predictions);
        let surface = match Surrogate::from_training(problem, whitening.clone(), &training) {
            Ok(surface) => surface,
            // So wide, the model often has no answer.
            Err(IdentifyError::OftenMissing { .. } | IdentifyError::TooFewTraining { .. })
                if best.is_none() && round < options.most_rounds =>
            {
                whitening = whitening.halved();
                training = Training::default();
                continue;
            }
            // A later surface that fails leaves the earlier rounds' result.
            Err(error) if best.is_none() => return Err(error),
            Err(_) => break,
        };
        let chains = run(
            &|z| surface_density(problem, &surface, z),
            &plan(whitening.centre.len(), options, round),
        );
        progress(Progress {
            stage: Stage::Sampling,
            done: round,
            of: options.most_rounds,
            cost: f64::INFINITY,
        });
        let z = spread(&chains, options.draws);
        let x: Vec<Vec<f64>> = z.iter().map(|z| whitening.to_working(z)).collect();
        let answers = problem.predict(&x);
        evaluations += x.len();
        progress(Progress {
            stage: Stage::Draws,
            done: round,
            of: options.most_rounds,
            cost: f64::INFINITY,
        });
        let ratios: Vec<f64> = answers
            .iter()
            .zip(x.iter().zip(&z))
            .map(|(answer, (x, z))| match answer {
                Ok(predictions) => {
                    -problem.cost(&problem.residuals(predictions), x)
                        - surface_density(problem, &surface, z)
                }
                Err(_) => f64::NEG_INFINITY,
            })
            .collect();
        let weights = normalised(&ratios);
        let crowd = z.iter().filter(|z| z.iter().any(|z| z.abs() > CROWDED)).count();
        let crowded = crowd as f64 / z.len() as f64;
        let effective = effective_draws(&weights);
        let diagnostics = PosteriorDiagnostics {
            pareto_shape: pareto_shape(&weights),
            effective_draws: effective,
            crowded,
            rounds: round,
            surrogate_error: surface.leave_out_errors.iter().copied().fold(0.0, f64::max),
            evaluations,
            ..chain_diagnostics(&chains, whitening.centre.len())
        };
        let narrow = crowded > MOST_CROWDED;
        let enough = effective >= options.wanted_share * z.len() as f64 && !narrow;
        // Local training: what the model said at the draws, and the earlier points among them.
        let next = localised(&x, &weights);
        for (x, answer) in x.iter().zip(&answers) {
            if let Ok(predictions) = answer {
                training.points.push(x.clone());
                training.predictions.push(predictions.clone());
            }
        }
        // What a surface cannot reach is worse than draws that weigh little.
        let score = if narrow { 0.25 * effective } else { effective };
        if effective > 0.0 && best.as_ref().is_none_or(|(before, _)| score > *before) {
            let draws = x.iter().map(|x| problem.values_at(x)).collect();
            let predictions = answers.into_iter().map(Result::unwrap_or_default).collect();
            best = Some((score, Posterior { draws, weights, predictions, diagnostics }));
        }
        if enough {
            break;
        }
        if let Some(mut next) = next {
            if narrow {
                next.root.iter_mut().flatten().for_each(|entry| *entry *= WIDENING);
            }
            keep_near(&mut training, &next);
            whitening = next;
        }
    }
    let refused = || IdentifyError::AllRefused {
        points: options.draws,
        reason: "no draw of the response surface has a density".to_owned(),
    };
    let (_, mut posterior) = best.ok_or_else(refused)?;
    posterior.diagnostics.evaluations = evaluations;
    Ok(posterior)
}

thread_local! {
    /// Monomials and residuals of the response surface.
    static SCRATCH: RefCell<(Vec<f64>, Vec<f64>)> = const { RefCell::new((Vec::new(), Vec::new())) };
}

/// Logarithm of the density that the response surface gives, minus infinity outside its range.
fn surface_density(problem: &Problem<'_>, surface: &Surrogate, z: &[f64]) -> f64 {
    if z.iter().any(|z| z.abs() > REACH) {
        return f64::NEG_INFINITY;
    }
    let x = surface.whitening().to_working(z);
    if !problem.inside(&x) {
        return f64::NEG_INFINITY;
    }
    SCRATCH.with_borrow_mut(|(monomials, residuals)| {
        surface.residuals(z, monomials, residuals);
        -problem.cost(residuals, &x)
    })
}

/// Centre and spread of weighted draws. Weights are cut at `mean * sqrt(count)` (E. L. Ionides,
/// J. Comp. Graph. Stat. 17, 295, 2008), so that a few heavy draws do not shrink the spread.
fn localised(x: &[Vec<f64>], weights: &[f64]) -> Option<Whitening> {
    let limit = (weights.len() as f64).sqrt().recip();
    let cut: Vec<f64> = weights.iter().map(|weight| weight.min(limit)).collect();
    let total: f64 = cut.iter().sum();
    let size = x.first()?.len();
    let mean = |j: usize| x.iter().zip(&cut).map(|(x, w)| x[j] * w).sum::<f64>() / total;
    let centre: Vec<f64> = (0..size).map(mean).collect();
    let entry = |i: usize, j: usize| {
        let product = |(x, w): (&Vec<f64>, &f64)| w * (x[i] - centre[i]) * (x[j] - centre[j]);
        x.iter().zip(&cut).map(product).sum::<f64>() / total
    };
    let covariance: Vec<Vec<f64>> =
        (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect();
    Some(Whitening { centre, root: upper_root(&covariance)? })
}

/// Drops training points outside the new surface's range.
fn keep_near(training: &mut Training, whitening: &Whitening) {
    let near = |x: &Vec<f64>| whitening.to_white(x).iter().all(|z| z.abs() <= REACH);
    let keep: Vec<bool> = training.points.iter().map(near).collect();
    let mut flags = keep.iter();
    training.points.retain(|_| flags.next().is_some_and(|&keep| keep));
    let mut flags = keep.iter();
    training.predictions.retain(|_| flags.next().is_some_and(|&keep| keep));
}

/// States evenly spread over steps, from one walker after the other.
fn spread(chains: &Chains, draws: usize) -> Vec<Vec<f64>> {
    let walkers = chains.walkers.len();
    let steps = chains.walkers.first().map_or(0, Vec::len);
    let count = draws.min(walkers * steps);
    (0..count).map(|k| chains.walkers[k % walkers][k * steps / count].clone()).collect()
}

fn chain_diagnostics(chains: &Chains, dimensions: usize) -> PosteriorDiagnostics {
    let of = |j: usize| -> Vec<Vec<f64>> {
        chains.walkers.iter().map(|chain| chain.iter().map(|state| state[j]).collect()).collect()
    };
    let kept: usize = chains.walkers.iter().map(Vec::len).sum();
    let size = |j: usize| {
        let chains_of_walkers = of(j);
        let ensembles = ensemble_means(&chains_of_walkers, chains.ensembles);
        let worth =
            effective_sample_size(&ensembles) * variance(&chains_of_walkers) / variance(&ensembles);
        effective_sample_size(&chains_of_walkers).min(worth)
    };
    let sizes: Vec<f64> = (0..dimensions).map(size).collect();
    PosteriorDiagnostics {
        r_hat: (0..dimensions).map(|j| r_hat(&whole_ensembles(&of(j), chains.ensembles))).collect(),
        autocorrelation_time: sizes.iter().map(|size| kept as f64 / size).collect(),
        effective_sample_size: sizes,
        acceptance: chains.acceptance,
        effective_draws: 0.0,
        pareto_shape: None,
        crowded: 0.0,
        rounds: 0,
        surrogate_error: 0.0,
        evaluations: 0,
        unreached: Vec::new(),
    }
}

/// Each ensemble as one chain: all its walkers' first steps, then all second ones, and so on.
fn whole_ensembles(walkers: &[Vec<f64>], ensembles: usize) -> Vec<Vec<f64>> {
    let in_turn = |group: &[Vec<f64>]| {
        (0..group[0].len()).flat_map(|n| group.iter().map(move |chain| chain[n])).collect()
    };
    walkers.chunks(walkers.len() / ensembles).map(in_turn).collect()
}

/// The mean over each ensemble's walkers, step by step. Its autocorrelation sees what walkers do
/// together, which chains taken one by one do not (Goodman and Weare 2010, section 3).
fn ensemble_means(walkers: &[Vec<f64>], ensembles: usize) -> Vec<Vec<f64>> {
    let together = |group: &[Vec<f64>]| {
        let mean = |n: usize| group.iter().map(|chain| chain[n]).sum::<f64>() / group.len() as f64;
        (0..group[0].len()).map(mean).collect()
    };
    walkers.chunks(walkers.len() / ensembles).map(together).collect()
}

fn variance(chains: &[Vec<f64>]) -> f64 {
    let count: usize = chains.iter().map(Vec::len).sum();
    let mean = chains.iter().flatten().sum::<f64>() / count as f64;
    chains.iter().flatten().map(|value| (value - mean).powi(2)).sum::<f64>() / count as f64
}

fn exactly(
    problem: &Problem<'_>,
    whitening: &Whitening,
    options: &PosteriorOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Posterior, IdentifyError> {
    let density = |z: &[f64]| {
        let x = whitening.to_working(z);
        if !problem.inside(&x) {
            return f64::NEG_INFINITY;
        }
        match problem.predict(std::slice::from_ref(&x)).first() {
            Some(Ok(predictions)) => -problem.cost(&problem.residuals(predictions), &x),
            _ => f64::NEG_INFINITY,
        }
    };
    let plan = plan(whitening.centre.len(), options, 0);
    let chains = run(&density, &plan);
    progress(Progress { stage: Stage::Sampling, done: 1, of: 1, cost: f64::INFINITY });
    let x: Vec<Vec<f64>> =
        spread(&chains, options.draws).iter().map(|z| whitening.to_working(z)).collect();
    let answers = problem.predict(&x);
    let usable = answers.iter().filter(|answer| answer.is_ok()).count();
    if usable == 0 {
        let reason = answers.into_iter().find_map(Result::err).unwrap_or_default();
        return Err(IdentifyError::AllRefused { points: x.len(), reason });
    }
    let share = |answer: &Result<Predictions, String>| {
        if answer.is_ok() { 1.0 / usable as f64 } else { 0.0 }
    };
    let diagnostics = PosteriorDiagnostics {
        effective_draws: usable as f64,
        evaluations: plan.ensembles * plan.walkers * (plan.burn_in + plan.steps + 1) + x.len(),
        ..chain_diagnostics(&chains, whitening.centre.len())
    };
    Ok(Posterior {
        draws: x.iter().map(|x| problem.values_at(x)).collect(),
        weights: answers.iter().map(share).collect(),
        predictions: answers.into_iter().map(Result::unwrap_or_default).collect(),
        diagnostics,
    })
}
