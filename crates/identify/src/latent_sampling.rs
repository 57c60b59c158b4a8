//! The posterior of a problem, with or without a law of free form; its smoothness and resolution.

use asperity_inference::{
    Covariance, Fit, InferenceError, LatentPosterior, Linearisation, Posterior, PosteriorOptions,
    Profile, ProfileOptions,
};
use serde::Serialize;

use crate::error::IdentificationError;
use crate::free_law::FreeLaw;
use crate::identification_problem::IdentificationProblem;
use crate::scenario_model::ScenarioModel;

/// Dropped and kept steps of every walker of a posterior with latents.
const STEPS: [usize; 2] = [500, 1500];

/// Findings about a law without an assumed form, beside its band.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeLawFindings {
    /// Its name.
    pub law: String,
    /// Pressures of its table \[Pa\].
    pub pressures_pa: Vec<f64>,
    /// Standard deviation of the slope d ln K / d ln p about that of the scenario's law: lower end of
    /// the interval, median and upper end of the posterior, on the grid of the prior.
    pub roughness: [f64; 3],
    /// Length in ln p over which the slope changes, in the same way.
    pub length: [f64; 3],
    /// Number of combinations of the latents that the data inform: a precision above 0.03 of that of
    /// the prior.
    pub informed_combinations: usize,
    /// Precision of the data along each combination over that of the prior, largest first.
    pub information: Vec<f64>,
    /// Spread in ln p of the averaging kernel at every pressure,
    ///
    /// ```text
    /// 12 integral of (x - x')^2 a(x')^2 dx' / (integral of a)^2,    x = ln p,
    /// ```
    ///
    /// the width of a kernel that is constant about x and zero elsewhere: the linearised estimate of
    /// ln K at a pressure is the integral of the kernel `a` times the true ln K. At least the distance
    /// of the pressures of the table; large where the data resolve nothing. Source: G. Backus, F.
    /// Gilbert, Phil. Trans. R. Soc. A 266, 123 (1970).
    pub resolution_ln_p: Vec<f64>,
}

impl FreeLawFindings {
    /// Spread of the averaging kernel at a pressure \[Pa\], in ln p; `None` outside the
    /// pressures of the table.
    pub fn resolution(&self, pressure: f64) -> Option<f64> {
        let next = self.pressures_pa.partition_point(|&known| known < pressure);
        let (low, high) = (next.checked_sub(1)?, self.pressures_pa.get(next)?);
        let share = (pressure / self.pressures_pa[low]).ln() / (high / self.pressures_pa[low]).ln();
        let [a, b] = [self.resolution_ln_p[low], self.resolution_ln_p[next]];
        Some(a + share * (b - a))
    }
}

/// The profiles of the parameters; none with a free law, whose smoothness is integrated over instead.
pub(super) fn profiles(
    problem: &IdentificationProblem,
    forward: &ScenarioModel,
    best: &Fit<'_>,
    covariance: &Covariance,
) -> Result<Vec<Profile>, InferenceError> {
    if forward.parameters.free.is_some() {
        return Ok(Vec::new());
    }
    let all: Vec<usize> = (0..best.point.len()).collect();
    let options = ProfileOptions { level: problem.spec.level, ..ProfileOptions::default() };
    best.profile(covariance, &all, &options)
}

/// Draws from the posterior, and the findings about a free law.
pub(super) fn posterior_of(
    problem: &IdentificationProblem,
    forward: &ScenarioModel,
    best: &Fit<'_>,
    (linearisation, covariance, profiles): (&Linearisation, &Covariance, &[Profile]),
    noise_factor: f64,
) -> Result<(Posterior, Option<FreeLawFindings>), IdentificationError> {
    let spec = &problem.spec;
    let options =
        PosteriorOptions { draws: spec.draws, seed: spec.seed, ..PosteriorOptions::default() };
    let (Some((first, law)), Some(prior)) =
        (&forward.parameters.free, forward.parameters.latent_prior()?)
    else {
        return Ok((best.posterior(covariance, profiles, &options)?, None));
    };
    let [burn_in, steps] = STEPS;
    let options = PosteriorOptions { burn_in, steps, ..options };
    // The model's standard deviations are scaled already.
    debug_assert!(noise_factor >= 1.0);
    let found = best.latent_posterior(linearisation, 1.0, &prior, &options)?;
    let shares = found.component_probabilities(&prior);
    let grid = law.grid();
    let tail = 0.5 * (1.0 - spec.level);
    let of = |value: &dyn Fn(usize) -> f64| {
        let pairs = shares.iter().enumerate().map(|(k, share)| (value(k), *share));
        let pairs: Vec<(f64, f64)> = pairs.collect();
        [tail, 0.5, 1.0 - tail].map(|probability| quantile(pairs.clone(), probability))
    };
    let latents = &best.point[*first..first + law.count()];
    let findings = FreeLawFindings {
        law: law.name.clone(),
        pressures_pa: law.pressures.clone(),
        roughness: of(&|k| grid[k].roughness),
        length: of(&|k| grid[k].length),
        informed_combinations: found.active,
        information: found.information.clone(),
        resolution_ln_p: resolution(law, latents, &found),
    };
    Ok((found.posterior, Some(findings)))
}

/// The least value whose cumulative share is at least `probability`.
fn quantile(mut pairs: Vec<(f64, f64)>, probability: f64) -> f64 {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pairs.iter().map(|pair| pair.1).sum();
    let mut below = 0.0;
    for (value, share) in &pairs {
        below += share / total;
        if below >= probability {
            return *value;
        }
    }
    pairs.last().map_or(f64::NAN, |pair| pair.0)
}

/// Spread of the averaging kernel at every pressure of a law.
fn resolution(law: &FreeLaw, latents: &[f64], found: &LatentPosterior) -> Vec<f64> {
    let count = law.count();
    let step = (law.pressures[1] / law.pressures[0]).ln();
    // Column i: the change of the estimate if the true ln K is higher at pressure i.
    let columns: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let mut change = vec![0.0; count];
            change[i] = 1.0;
            let truth = law.latent_change(latents, &change);
            let estimate: Vec<f64> = found
                .resolution
                .iter()
                .map(|row| row.iter().zip(&truth).map(|(r, z)| r * z).sum())
                .collect();
            law.log_stiffness_change(latents, &estimate)
        })
        .collect();
    let width = |j: usize| {
        let (mut sum, mut second) = (0.0, 0.0);
        for (i, column) in columns.iter().enumerate() {
            let distance = step * (i as f64 - j as f64);
            sum += column[j];
            second += (distance * column[j]).powi(2);
        }
        (12.0 * second / step / (sum * sum)).max(step)
    };
    (0..count).map(width).collect()
}
