//! The posterior of a model with latents.

use crate::error::{InferenceError, check_positive, check_size};
use crate::fit::Fit;
use crate::fit_problem::FitProblem;
use crate::importance::normalised;
use crate::latent_prior::LatentPrior;
use crate::latent_subspace::{LatentSubspace, SubspaceModel};
use crate::linear_algebra::{dot, inverse_normal, upper_root, upper_solve};
use crate::linearisation::Linearisation;
use crate::model::Predictions;
use crate::posterior::{Posterior, PosteriorOptions, SurfaceTarget, by_surrogate};
use crate::progress::Stage;
use crate::search::{Known, Search, run};
use crate::surrogate::Whitening;

/// The posterior of a model with latents.
#[derive(Debug, Clone, PartialEq)]
pub struct LatentPosterior {
    /// Draws of all parameters, latents included. The diagnostics of a latent are the worst ones of the
    /// informed combinations.
    pub posterior: Posterior,
    /// Component of the prior that each draw belongs to.
    pub components: Vec<usize>,
    /// Precision of the data along every combination of latents over the prior's, largest first;
    /// without units.
    pub information: Vec<f64>,
    /// Number of combinations that were sampled with the data, those above
    /// [`ACTIVE_INFORMATION`](crate::ACTIVE_INFORMATION).
    pub active: usize,
    /// Resolution matrix of the linearised model, a row for every parameter and a column for every latent:
    /// the mean of the posterior, in the working coordinate of a parameter that is no latent, changes by
    /// this times a change of the true latents, without noise. Source: A. Tarantola, *Inverse Problem
    /// Theory*, 2005, section 3.3.
    pub resolution: Vec<Vec<f64>>,
    /// Values of all parameters where the model was linearised for resolution and combinations: the optimum
    /// under the pooled prior of the components.
    pub linearised_at: Vec<f64>,
}

impl LatentPosterior {
    /// Posterior probabilities of the components of the prior.
    pub fn component_probabilities(&self, prior: &LatentPrior) -> Vec<f64> {
        let mut shares = vec![0.0; prior.weights().len()];
        for (&component, weight) in self.components.iter().zip(&self.posterior.weights) {
            shares[component] += weight;
        }
        shares
    }
}

impl Fit<'_> {
    /// Samples `exp(-cost(x))` as [`posterior`](Fit::posterior) does, with the mixture `prior` in place
    /// of the standard normal prior of the latents.
    ///
    /// The linearised model at the optimum gives the evidence of each component of the prior, the pooled
    /// covariance of the latents, and the combinations of latents that the data inform. The model is then
    /// linearised twice more, at the optimum under that pooled prior, which may be far from that under
    /// the standard normal one. The combinations found there are
    /// sampled with all other parameters on a response surface, under the exact marginal density of the
    /// mixture; the component and the uninformed combinations of each draw follow from their exact
    /// conditional distribution, by random numbers that depend on the seed and the draw's index alone.
    /// The weights of the draws compare the model at all parameters with the surface, so that neither
    /// the surface nor the split causes a bias.
    ///
    /// # Errors
    ///
    /// Those of [`posterior`](Fit::posterior); [`InferenceError::Size`] for a prior or a linearisation of
    /// another model.
    pub fn latent_posterior(
        &self,
        linearisation: &Linearisation,
        noise_factor: f64,
        prior: &LatentPrior,
        options: &PosteriorOptions,
    ) -> Result<LatentPosterior, InferenceError> {
        options.check()?;
        check_positive("the noise factor", noise_factor)?;
        let parameters = self.problem.parameters;
        let columns = linearisation.jacobian.first().map_or(0, Vec::len);
        check_size("columns of the Jacobian", columns, parameters.len())?;
        let latents = parameters.iter().filter(|parameter| parameter.is_latent()).count();
        check_size("latents of the prior", prior.count(), latents)?;
        let mut at = (self.clone(), linearisation.clone());
        for _ in 0..RELINEARISATIONS {
            let parts = LinearParts::new(&at, noise_factor, prior)?;
            let model = SubspaceModel::new(self.problem.model(), &parts.subspace);
            let problem = self.subspace_problem(&model, noise_factor)?;
            let values = problem.values_at(&whitening(&at, &model, &problem, noise_factor)?.centre);
            let (others, informed) = values.split_at(model.others());
            let point = model.point(others, &parts.subspace.latents(informed, &[]));
            // Without predictions there, or a peak, those before are near enough for draws with weights.
            let moved = self.moved(point).filter(|fit| fit.missing == self.missing);
            let Some(fit) = moved else { break };
            let Ok(linearisation) = fit.linearise() else { break };
            at = (fit, linearisation);
        }
        let LinearParts { linear, weights, subspace } = LinearParts::new(&at, noise_factor, prior)?;
        let model = SubspaceModel::new(self.problem.model(), &subspace);
        let problem = self.subspace_problem(&model, noise_factor)?;
        let whitening = whitening(&at, &model, &problem, noise_factor)?;
        let target = LatentTarget { model: &model, whole: &self.problem, seed: options.seed };
        let is_lower = |values: &[f64], found: &Predictions| self.is_lower_latent(values, found);
        let found =
            by_surrogate((&problem, &is_lower), &target, whitening, &[], options, self.progress)?;
        let mut posterior = found.posterior;
        let components = posterior.draws.iter().zip(&found.numbers).map(|(draw, &number)| {
            let (_, z) = model.split(draw);
            subspace.complete(&subspace.informed(&z), options.seed, number).0
        });
        let components = components.collect();
        spread_diagnostics(&mut posterior, &model);
        Ok(LatentPosterior {
            posterior,
            components,
            active: subspace.active,
            resolution: linear.resolution(&prior.pooled(&weights), &model)?,
            linearised_at: at.0.point.clone(),
            information: subspace.information,
        })
    }

    /// Posterior probabilities of the components of a prior in the model linearised at the optimum, with the derivatives
    /// of the search.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Singular`] for derivatives that are not finite.
    pub fn component_probabilities(&self, prior: &LatentPrior) -> Result<Vec<f64>, InferenceError> {
        LinearModel::new(self, &self.weighted_rows(), 1.0, prior).component_weights(prior)
    }

    /// The problem of the informed combinations and the other parameters.
    fn subspace_problem<'a>(
        &self,
        model: &'a SubspaceModel<'a>,
        noise_factor: f64,
    ) -> Result<FitProblem<'a>, InferenceError> {
        let problem = FitProblem::new(model, self.problem.loss, self.problem.missing_residual)?;
        Ok(problem.with_noise_factor(noise_factor))
    }
}

/// Linearisations after that at the optimum of the fit, whose prior is not the mixture's.
const RELINEARISATIONS: usize = 2;

/// The linearised model at a point, the probabilities of the prior's components in it, and the combinations
/// of latents that the data inform.
struct LinearParts {
    linear: LinearModel,
    weights: Vec<f64>,
    subspace: LatentSubspace,
}

impl LinearParts {
    fn new(
        (fit, linearisation): &(Fit<'_>, Linearisation),
        noise_factor: f64,
        prior: &LatentPrior,
    ) -> Result<Self, InferenceError> {
        let linear = LinearModel::new(fit, &linearisation.weighted_rows(), noise_factor, prior);
        let weights = linear.component_weights(prior)?;
        let subspace = LatentSubspace::new(prior, &linear.of_latents, &weights)?;
        Ok(Self { linear, weights, subspace })
    }
}

/// Standardised residuals of the linearised model, `offset + of_latents z + of_others (x - start)`.
struct LinearModel {
    offset: Vec<f64>,
    of_latents: Vec<Vec<f64>>,
    /// Times the standard deviations of the others before the measurement.
    of_others: Vec<Vec<f64>>,
    /// These standard deviations.
    deviations: Vec<f64>,
}

impl LinearModel {
    fn new(fit: &Fit<'_>, rows: &[Vec<f64>], noise_factor: f64, prior: &LatentPrior) -> Self {
        let parameters = fit.problem.parameters;
        let others = parameters.iter().enumerate().filter(|(j, _)| !prior.contains(*j));
        let mut own = Self {
            offset: Vec::new(),
            of_latents: Vec::new(),
            of_others: Vec::new(),
            deviations: others.map(|(_, parameter)| parameter.initial_deviation()).collect(),
        };
        let optimum = fit.optimum();
        for (i, row) in rows.iter().enumerate() {
            if fit.predictions[i].is_none() {
                continue;
            }
            let mut offset = fit.weights[i].sqrt() * fit.residuals[i];
            let (mut latents, mut others) = (Vec::new(), Vec::new());
            for (j, (parameter, entry)) in parameters.iter().zip(row).enumerate() {
                // Without a prior the centre is the optimum.
                let centre = parameter.prior().map_or(optimum[j], |prior| prior.mean);
                offset -= entry * (optimum[j] - centre);
                if prior.contains(j) {
                    latents.push(entry / noise_factor);
                } else {
                    others.push(entry * parameter.initial_deviation() / noise_factor);
                }
            }
            own.offset.push(offset / noise_factor);
            own.of_latents.push(latents);
            own.of_others.push(others);
        }
        own
    }

    /// Covariance of the residuals before the measurement, from noise, others and latents.
    fn covariance(&self, latents: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let spread: Vec<Vec<f64>> = self
            .of_latents
            .iter()
            .map(|row| latents.iter().map(|column| dot(row, column)).collect())
            .collect();
        let count = self.offset.len();
        let entry = |i: usize, j: usize| {
            let noise = if i == j { 1.0 } else { 0.0 };
            noise
                + dot(&spread[i], &self.of_latents[j])
                + dot(&self.of_others[i], &self.of_others[j])
        };
        (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
    }

    /// Posterior probabilities of the components in the linearised model,
    /// `weight N(offset; 0, 1 + J S J^T + J_o P J_o^T)`.
    fn component_weights(&self, prior: &LatentPrior) -> Result<Vec<f64>, InferenceError> {
        let log = |covariance: &Vec<Vec<f64>>| {
            let root = upper_root(&self.covariance(covariance))?;
            let white = upper_solve(&root, &self.offset);
            let volume: f64 = (0..root.len()).map(|i| root[i][i].ln()).sum();
            Some(-volume - 0.5 * dot(&white, &white))
        };
        let logs: Option<Vec<f64>> = prior.covariances().iter().map(log).collect();
        let logs = logs.ok_or(InferenceError::Singular("covariance of the residuals"))?;
        let weighted: Vec<f64> =
            logs.iter().zip(prior.weights()).map(|(log, weight)| log + weight.ln()).collect();
        Ok(normalised(&weighted))
    }

    /// `S J^T C^-1 J` for the latents and `P J_o^T C^-1 J` for the others, with the covariance `C` of the
    /// residuals.
    fn resolution(
        &self,
        latents: &[Vec<f64>],
        model: &SubspaceModel<'_>,
    ) -> Result<Vec<Vec<f64>>, InferenceError> {
        let root = upper_root(&self.covariance(latents))
            .ok_or(InferenceError::Singular("covariance of the residuals"))?;
        let white_column = |rows: &[Vec<f64>], j: usize| {
            upper_solve(&root, &rows.iter().map(|row| row[j]).collect::<Vec<f64>>())
        };
        let white: Vec<Vec<f64>> =
            (0..latents.len()).map(|j| white_column(&self.of_latents, j)).collect();
        let precision =
            |i: usize| white.iter().map(|own| dot(&white[i], own)).collect::<Vec<f64>>();
        let precision: Vec<Vec<f64>> = (0..latents.len()).map(precision).collect();
        // The precision is symmetric.
        let of_latent = |prior: &Vec<f64>| precision.iter().map(|own| dot(prior, own)).collect();
        let of_other = |(j, deviation): (usize, &f64)| {
            let own = white_column(&self.of_others, j);
            white.iter().map(|latent| deviation * dot(&own, latent)).collect()
        };
        let others: Vec<Vec<f64>> = self.deviations.iter().enumerate().map(of_other).collect();
        let (before, after) = others.split_at(model.subspace.first);
        let latents: Vec<Vec<f64>> = latents.iter().map(of_latent).collect();
        Ok([before, &latents, after].concat())
    }
}

/// The normal approximation in the subspace, about its own optimum under the pooled prior.
fn whitening(
    (fit, linearisation): &(Fit<'_>, Linearisation),
    model: &SubspaceModel<'_>,
    problem: &FitProblem<'_>,
    noise_factor: f64,
) -> Result<Whitening, InferenceError> {
    let subspace_row = |row: &Vec<f64>| -> Vec<f64> {
        let (others, latents) = model.split(row);
        [others, model.subspace.informed_row(&latents)].concat()
    };
    let rows: Vec<Vec<f64>> = linearisation.jacobian.iter().map(subspace_row).collect();
    let slopes = rows.iter().zip(problem.observations).map(|(row, observation)| {
        row.iter().map(|entry| entry * observation.standard_deviation).collect()
    });
    let (others, latents) = model.split(&fit.optimum());
    let mut x = [others, model.subspace.informed(&latents)].concat();
    problem.clamp(&mut x);
    let known =
        Known { x: x.clone(), predictions: fit.predictions.clone(), slopes: slopes.collect() };
    let mut searches = vec![Search::near(x, vec![false; problem.parameters.len()], known)];
    run(problem, &mut searches, &fit.options, Stage::Fit, fit.progress);
    let search = &searches[0];
    let mut rows: Vec<Vec<f64>> = linearisation.weighted_rows().iter().map(subspace_row).collect();
    rows.iter_mut().flatten().for_each(|entry| *entry /= noise_factor);
    let count = problem.parameters.len();
    for (j, parameter) in problem.parameters.iter().enumerate() {
        let mut row = vec![0.0; count];
        row[j] = 1.0 / parameter.initial_deviation();
        rows.push(row);
    }
    let root = inverse_normal(&rows, count, "normal matrix")?.root;
    Ok(Whitening { centre: search.x.clone(), root })
}

/// The mixture in the informed combinations, and draws completed by the uninformed ones.
struct LatentTarget<'a> {
    model: &'a SubspaceModel<'a>,
    whole: &'a FitProblem<'a>,
    seed: u64,
}

impl SurfaceTarget for LatentTarget<'_> {
    fn log_factor(&self, x: &[f64]) -> f64 {
        self.model.subspace.log_factor(&x[self.model.others()..])
    }

    fn evaluate(
        &self,
        problem: &FitProblem<'_>,
        x: &[Vec<f64>],
        first: usize,
    ) -> (Vec<Vec<f64>>, Vec<Result<Predictions, String>>) {
        let complete = |(index, x): (usize, &Vec<f64>)| {
            let values = problem.values_at(x);
            let (others, informed) = values.split_at(self.model.others());
            let (_, z) = self.model.subspace.complete(informed, self.seed, first + index);
            self.model.point(others, &z)
        };
        let points: Vec<Vec<f64>> = x.iter().enumerate().map(complete).collect();
        let working: Vec<Vec<f64>> =
            points.iter().map(|point| self.whole.to_working(point)).collect();
        let answers = self.whole.predict(&working);
        (points, answers)
    }
}

/// Gives every parameter of the model its diagnostics.
fn spread_diagnostics(posterior: &mut Posterior, model: &SubspaceModel<'_>) {
    let found = &mut posterior.diagnostics;
    let others = model.others();
    let of_all = |list: &mut Vec<f64>, worst: fn(f64, f64) -> f64| {
        let informed = list.split_off(others.min(list.len()));
        let of_latents = informed.into_iter().reduce(worst).unwrap_or(1.0);
        *list = model.point(list, &vec![of_latents; model.subspace.count()]);
    };
    of_all(&mut found.r_hat, f64::max);
    of_all(&mut found.effective_sample_size, f64::min);
    of_all(&mut found.autocorrelation_time, f64::max);
}
