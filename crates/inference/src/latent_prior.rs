//! Prior of latents whose covariance is itself unknown: a mixture of normal distributions.

use crate::error::{InferenceError, check_positive, check_size};
use crate::linear_algebra::{upper_root, upper_times};
use crate::parameter::Parameter;
use crate::random::{latin_hypercube, normal_quantile};

/// The prior of consecutive [latents](Parameter::latent) `z`: a mixture of normal distributions of mean
/// zero,
///
/// ```text
/// p(z) = sum_k weight_k N(z; 0, S_k),
/// ```
///
/// for example of a Gaussian process whose amplitude and length are known only up to a distribution
/// over a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct LatentPrior {
    first: usize,
    weights: Vec<f64>,
    covariances: Vec<Vec<Vec<f64>>>,
    /// `root root^T = covariance`, upper triangular.
    roots: Vec<Vec<Vec<f64>>>,
}

impl LatentPrior {
    /// The prior of the latents from index `first` on, by weights (any positive scale) and covariances.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Size`] without components or if their sizes differ,
    /// [`InferenceError::Option`] for a weight that is not positive, [`InferenceError::Singular`] for
    /// a covariance that is not positive definite.
    pub fn new(
        first: usize,
        components: Vec<(f64, Vec<Vec<f64>>)>,
    ) -> Result<Self, InferenceError> {
        let Some(count) = components.first().map(|(_, covariance)| covariance.len()) else {
            return Err(InferenceError::Size { quantity: "components", found: 0, expected: 1 });
        };
        let total: f64 = components.iter().map(|(weight, _)| weight).sum();
        let (mut weights, mut covariances, mut roots) = (Vec::new(), Vec::new(), Vec::new());
        for (weight, covariance) in components {
            check_positive("the weight of a component", weight)?;
            check_size("rows of a covariance", covariance.len(), count)?;
            for row in &covariance {
                check_size("columns of a covariance", row.len(), count)?;
            }
            let singular = InferenceError::Singular("covariance of the latents");
            roots.push(upper_root(&covariance).ok_or(singular)?);
            weights.push(weight / total);
            covariances.push(covariance);
        }
        Ok(Self { first, weights, covariances, roots })
    }

    /// Index of the first latent among the parameters.
    pub fn first(&self) -> usize {
        self.first
    }

    /// Number of latents.
    pub fn count(&self) -> usize {
        self.covariances[0].len()
    }

    /// Weights of the components, with unit sum.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Covariances of the components.
    pub fn covariances(&self) -> &[Vec<Vec<f64>>] {
        &self.covariances
    }

    /// The covariance with other weights of the components, of unit sum.
    pub(crate) fn pooled(&self, weights: &[f64]) -> Vec<Vec<f64>> {
        let count = self.count();
        let entry = |i: usize, j: usize| -> f64 {
            self.covariances.iter().zip(weights).map(|(s, weight)| weight * s[i][j]).sum()
        };
        (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
    }

    /// True for the index of one of the latents.
    pub(crate) fn contains(&self, parameter: usize) -> bool {
        (self.first..self.first + self.count()).contains(&parameter)
    }

    /// The component at a place in [0, 1) of the cumulative `weights`.
    pub(crate) fn component_at(place: f64, weights: &[f64]) -> usize {
        let mut left = place * weights.iter().sum::<f64>();
        for (k, weight) in weights.iter().enumerate() {
            left -= weight;
            if left < 0.0 {
                return k;
            }
        }
        weights.len() - 1
    }
}

/// Draws of the parameters' values before the measurement: normal where there is a prior (within the
/// bounds), uniform in the working coordinate without one, and latents from their mixture. A Latin
/// hypercube: one draw in each of `count` strata of every coordinate.
///
/// ```
/// use asperity_inference::{Parameter, prior_draws};
///
/// let draws = prior_draws(&[Parameter::latent("z")], &[], 1000, 1);
/// let variance = draws.iter().map(|z| z[0] * z[0]).sum::<f64>() / 1000.0;
/// assert!((variance - 1.0).abs() < 0.01);
/// ```
pub fn prior_draws(
    parameters: &[Parameter],
    latents: &[LatentPrior],
    count: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    // One coordinate more for each mixture: that of its component.
    let unit = latin_hypercube(count, parameters.len() + latents.len(), seed);
    let draw = |unit: &Vec<f64>| {
        let mut point: Vec<f64> = parameters
            .iter()
            .zip(unit)
            .map(|(parameter, &part)| {
                let [lower, upper] = parameter.working_bounds();
                parameter.from_working(match parameter.prior() {
                    Some(prior) => prior.mean + prior.standard_deviation * normal_quantile(part),
                    None => lower + part * (upper - lower),
                })
            })
            .collect();
        for (place, prior) in unit[parameters.len()..].iter().zip(latents) {
            let component = LatentPrior::component_at(*place, &prior.weights);
            let own = prior.first..prior.first + prior.count();
            let z = upper_times(&prior.roots[component], &point[own.clone()]);
            point[own].copy_from_slice(&z);
        }
        point
    };
    unit.iter().map(draw).collect()
}
