//! Covariance of smooth random functions.

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
    let entry = |x: &f64, other: &f64| {
        let a = 3.0_f64.sqrt() * (x - other).abs() / length;
        (1.0 + a) * (-a).exp()
    };
    places.iter().map(|x| places.iter().map(|other| entry(x, other)).collect()).collect()
}
