//! Covariance of smooth random functions, and their latents.

use crate::error::InferenceError;
use crate::linear_algebra::{upper_root, upper_solve, upper_times};

/// Covariance matrix of a Gaussian process of unit variance at some `places`,
///
/// ```text
/// k(x, x') = (1 + a) exp(-a),    a = sqrt(3) |x - x'| / length,
/// ```
///
/// whose functions have one derivative (Matérn, smoothness 3/2). `places` and `length` have the same
/// unit; the length is positive. In the limit of a long length all values are equal.
///
/// Source: C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, 2006, eq. 4.17.
///
/// ```
/// let covariance = asperity_inference::matern_three_halves(&[0.0, 1.0], 3.0_f64.sqrt());
/// assert_eq!(covariance[0][0], 1.0);
/// assert!((covariance[0][1] - 2.0 * (-1.0_f64).exp()).abs() < 1e-15);
/// ```
pub fn matern_three_halves(places: &[f64], length: f64) -> Vec<Vec<f64>> {
    stationary(places, |distance| {
        let a = 3.0_f64.sqrt() * distance / length;
        (1.0 + a) * (-a).exp()
    })
}

/// Covariance matrix of a Gaussian process of unit variance at some `places`,
///
/// ```text
/// k(x, x') = exp(-|x - x'| / length),
/// ```
///
/// whose functions are continuous without a derivative (Matérn, smoothness 1/2; the process of Ornstein
/// and Uhlenbeck). A function that jumps to an independent value at random places, one a `length` on
/// average, has the same covariance. `places` and `length` have the same unit; the length is positive. In
/// the limit of a long length all values are equal.
///
/// Source: C. E. Rasmussen, C. K. I. Williams, *Gaussian Processes for Machine Learning*, 2006, eqs. 4.17
/// and B.29.
///
/// ```
/// let covariance = asperity_inference::matern_one_half(&[0.0, 1.0, 3.0], 1.0);
/// assert_eq!(covariance[0][0], 1.0);
/// // Markov: the correlation over two intervals is the product of the correlations over each.
/// assert!((covariance[0][2] - covariance[0][1] * covariance[1][2]).abs() < 1e-15);
/// ```
pub fn matern_one_half(places: &[f64], length: f64) -> Vec<Vec<f64>> {
    stationary(places, |distance| (-distance / length).exp())
}

/// The covariance matrix of a covariance that depends on the distance alone.
fn stationary(places: &[f64], covariance: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    let row = |x: &f64| places.iter().map(|other| covariance((x - other).abs())).collect();
    places.iter().map(row).collect()
}

/// Latents `z` of the values `f = U z` of a random function with the covariance `C = U U^T`: standard
/// normal if `f` has that covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct LatentBasis {
    /// Upper triangular.
    root: Vec<Vec<f64>>,
}

impl LatentBasis {
    /// The latents of a function with this reference covariance.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Singular`] for a matrix that is not positive definite.
    pub fn new(covariance: &[Vec<f64>]) -> Result<Self, InferenceError> {
        let singular = InferenceError::Singular("covariance of the function");
        Ok(Self { root: upper_root(covariance).ok_or(singular)? })
    }

    /// The values of the function, as many as latents.
    pub fn values(&self, latents: &[f64]) -> Vec<f64> {
        upper_times(&self.root, latents)
    }

    /// The latents of values of the function.
    pub fn latents(&self, values: &[f64]) -> Vec<f64> {
        upper_solve(&self.root, values)
    }

    /// The covariance `U^-1 C U^-T` of the latents for the covariance `C` of the values; the
    /// identity for the reference.
    ///
    /// ```
    /// use asperity_inference::{LatentBasis, matern_three_halves};
    ///
    /// let covariance = matern_three_halves(&[0.0, 0.5, 2.0], 1.0);
    /// let latents = LatentBasis::new(&covariance)?.latent_covariance(&covariance);
    /// assert!((latents[1][1] - 1.0).abs() < 1e-12 && latents[0][1].abs() < 1e-12);
    /// # Ok::<(), asperity_inference::InferenceError>(())
    /// ```
    pub fn latent_covariance(&self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let half: Vec<Vec<f64>> = values.iter().map(|row| upper_solve(&self.root, row)).collect();
        let column = |j: usize| -> Vec<f64> { half.iter().map(|row| row[j]).collect() };
        (0..half.len()).map(|j| upper_solve(&self.root, &column(j))).collect()
    }
}
