//! The posterior of a problem, with or without a law of free form; its smoothness and resolution.

use asperity_inference::{
    Covariance, Fit, InferenceError, LatentPosterior, Linearisation, Posterior, PosteriorOptions,
    Profile, ProfileOptions,
};
use serde::Serialize;

use crate::error::IdentificationError;
use crate::free_law::PriorComponent;
use crate::identification_problem::IdentificationProblem;
use crate::problem::SlopeSmoothness;
use crate::scenario_model::ScenarioModel;

/// Dropped and kept steps of every walker of a posterior with latents.
const STEPS: [usize; 2] = [500, 1500];

/// Findings about a law without an assumed form, beside its band.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FreeLawFindings {
    /// Its name.
    pub law: String,
    /// Names of the unknown numbers of the form that it deviates from.
    pub form_unknowns: Vec<String>,
    /// Pressures of its table \[Pa\].
    pub pressures_pa: Vec<f64>,
    /// Standard deviation of the slope d ln K / d ln p about the slope of the scenario's law: lower
    /// end of the interval, median and upper end of the posterior, on the grid of the prior.
    pub roughness: [f64; 3],
    /// Length in ln p over which the slope changes, in the same way.
    pub length: [f64; 3],
    /// Posterior probabilities of the kinds of smoothness of the slope.
    pub smoothness: Vec<SmoothnessProbability>,
    /// Number of combinations of the latents that the data inform: their precision is above 0.03 of
    /// the prior precision.
    pub informed_combinations: usize,
    /// Precision of the data over the prior precision along each combination, largest first.
    pub information: Vec<f64>,
    /// Width in ln p of the averaging kernel at every pressure: the linearised estimate of ln K at
    /// `x = ln p` is the integral of the kernel `a` times the true ln K (G. Backus, F. Gilbert, Phil.
    /// Trans. R. Soc. A 266, 123, 1970), and half of the integral of |a| is within a quarter of the
    /// width of x,
    ///
    /// ```text
    /// integral of |a| over |x' - x| < width / 4  =  half of the integral over all x',
    /// ```
    ///
    /// so that the width of a kernel that is constant about x and zero elsewhere is its support. The
    /// width is at least the distance of the pressures of the table, and up to four times the range of
    /// the table where the estimate depends on the data at other pressures.
    pub resolution_ln_p: Vec<f64>,
}

/// Posterior probability of a kind of smoothness of the slope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SmoothnessProbability {
    /// The kind.
    pub kind: SlopeSmoothness,
    /// Its posterior probability.
    pub probability: f64,
}

impl FreeLawFindings {
    /// Width of the averaging kernel at a pressure \[Pa\], in ln p; `None` outside the
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
    if forward.parameters.free.is_some() || problem.is_fast {
        return Ok(Vec::new());
    }
    let all: Vec<usize> = (0..best.point.len()).collect();
    let options = ProfileOptions { level: problem.spec.level, ..ProfileOptions::default() };
    best.profile(covariance, &all, &options)
}

/// Options of the posterior, with or without a law of free form.
pub(super) fn posterior_options(problem: &IdentificationProblem, free: bool) -> PosteriorOptions {
    let spec = &problem.spec;
    let options =
        PosteriorOptions { draws: spec.draws, seed: spec.seed, ..PosteriorOptions::default() };
    let [burn_in, steps] = if free { STEPS } else { [options.burn_in, options.steps] };
    PosteriorOptions { burn_in, steps, ..options }
}

/// Draws from the posterior, and the findings about a free law.
pub(super) fn posterior_of(
    problem: &IdentificationProblem,
    forward: &ScenarioModel,
    best: &Fit<'_>,
    (linearisation, covariance, profiles): (&Linearisation, &Covariance, &[Profile]),
    options: &PosteriorOptions,
) -> Result<(Posterior, Option<FreeLawFindings>), IdentificationError> {
    let spec = &problem.spec;
    let parameters = &forward.parameters;
    let (Some((first, law)), Some(prior)) = (&parameters.free, parameters.latent_prior()?) else {
        return Ok((best.posterior(covariance, profiles, options)?, None));
    };
    // The model's standard deviations are scaled already.
    let found = best.latent_posterior(linearisation, 1.0, &prior, options)?;
    let shares = found.component_probabilities(&prior);
    let grid = &law.components;
    let tail = 0.5 * (1.0 - spec.level);
    let of = |value: &dyn Fn(usize) -> f64| {
        let pairs = shares.iter().enumerate().map(|(k, share)| (value(k), *share));
        let pairs: Vec<(f64, f64)> = pairs.collect();
        [tail, 0.5, 1.0 - tail].map(|probability| quantile(pairs.clone(), probability))
    };
    let of_form = parameters.of_form();
    let labels = parameters.labels(&forward.scenario);
    let findings = FreeLawFindings {
        law: law.name.clone(),
        form_unknowns: of_form.iter().map(|&parameter| labels[parameter].clone()).collect(),
        pressures_pa: law.pressures.clone(),
        roughness: of(&|k| grid[k].roughness),
        length: of(&|k| grid[k].length),
        smoothness: smoothness_probabilities(grid, &shares),
        informed_combinations: found.active,
        information: found.information.clone(),
        resolution_ln_p: resolution(forward, *first, &found)?,
    };
    Ok((found.posterior, Some(findings)))
}

fn smoothness_probabilities(grid: &[PriorComponent], shares: &[f64]) -> Vec<SmoothnessProbability> {
    let mut found: Vec<SmoothnessProbability> = Vec::new();
    for (component, share) in grid.iter().zip(shares) {
        match found.iter_mut().find(|one| one.kind == component.smoothness) {
            Some(one) => one.probability += share,
            None => found
                .push(SmoothnessProbability { kind: component.smoothness, probability: *share }),
        }
    }
    found
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

/// Four times the distance from place `at` of a kernel within which half of its sum lies, every entry
/// being spread evenly over its cell; at least 1. The entries are not negative.
fn kernel_width(kernel: &[f64], at: usize) -> f64 {
    let entry = |place: Option<usize>| place.and_then(|place| kernel.get(place)).unwrap_or(&0.0);
    let half = 0.5 * kernel.iter().sum::<f64>();
    let mut inside = 0.0;
    for distance in 0..kernel.len() {
        let (from, ring) = match distance {
            0 => (0.0, 0.5),
            _ => (distance as f64 - 0.5, 1.0),
        };
        let both = match distance {
            0 => kernel[at],
            _ => entry(at.checked_sub(distance)) + entry(at.checked_add(distance)),
        };
        if inside + both >= half {
            return (4.0 * (from + ring * (half - inside) / both)).max(1.0);
        }
        inside += both;
    }
    4.0 * kernel.len() as f64
}

/// Width of the averaging kernel at every pressure of the free law, whose latents are parameters from
/// index `first` on.
fn resolution(
    forward: &ScenarioModel,
    first: usize,
    found: &LatentPosterior,
) -> Result<Vec<f64>, IdentificationError> {
    let point = &found.linearised_at;
    let Some(law) = forward.parameters.free_law_at(&forward.scenario, point)? else {
        return Ok(Vec::new());
    };
    let count = law.count();
    let own = first..first + count;
    let latents = &point[own.clone()];
    let of_form = forward.parameters.of_form();
    let slopes = |&j: &usize| forward.log_stiffness_derivative(&law.name, &law.pressures, point, j);
    let slopes = of_form.iter().map(slopes).collect::<Result<Vec<_>, _>>()?;
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
            let mut moved = law.log_stiffness_change(latents, &estimate[own.clone()]);
            for (j, slopes) in of_form.iter().zip(&slopes) {
                moved.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += estimate[*j] * slope);
            }
            moved
        })
        .collect();
    let of = |j: usize| {
        let kernel: Vec<f64> = columns.iter().map(|column| column[j].abs()).collect();
        step * kernel_width(&kernel, j)
    };
    Ok((0..count).map(of).collect())
}

#[cfg(test)]
mod tests {
    use super::kernel_width;

    #[test]
    fn an_even_kernel_has_its_own_width() {
        for cells in [1_usize, 5, 9] {
            let at = 20;
            let inside = |i: usize| i.abs_diff(at) <= cells / 2;
            let kernel: Vec<f64> = (0..41).map(|i| f64::from(u8::from(inside(i)))).collect();
            let width = kernel_width(&kernel, at);
            assert!((width - cells as f64).abs() < 1e-12, "{width} {cells}");
        }
        // All of the kernel is at one place ten cells away.
        let mut kernel = vec![0.0; 41];
        kernel[30] = 2.0;
        assert!((kernel_width(&kernel, 20) - 40.0).abs() < 1e-12);
        assert!((kernel_width(&kernel, 30) - 1.0).abs() < 1e-12);
    }
}
