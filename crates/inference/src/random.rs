//! Probability distributions and seeded random numbers.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// The quantile of the standard normal distribution at a probability, which is clamped to 0 and 1,
/// where it is infinite.
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability.clamp(0.0, 1.0))
}

/// The half-width, in standard deviations, of the central normal interval of a level.
pub(crate) fn normal_half_width(level: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * level)
}

/// The probability that chi-square with these degrees of freedom exceeds `value`; `None` without
/// degrees of freedom.
///
/// ```
/// let p = asperity_inference::chi_square_tail(49.5, 31).unwrap_or(f64::NAN);
/// assert!((p - 0.0188).abs() < 2e-4);
/// ```
pub fn chi_square_tail(value: f64, degrees_of_freedom: usize) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom as f64).ok()?;
    Some(distribution.sf(value.max(0.0)))
}

/// A generator whose numbers depend on the seed and the stream alone.
pub(crate) fn generator(seed: u64, stream: u64) -> Pcg64 {
    // The golden ratio's bits keep neighbouring streams apart.
    Pcg64::seed_from_u64(seed ^ stream.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// A uniform number in [0, 1).
pub(crate) fn uniform(generator: &mut Pcg64) -> f64 {
    generator.random::<f64>()
}

/// A standard normal number.
pub(crate) fn normal(generator: &mut Pcg64) -> f64 {
    normal_quantile((uniform(generator) + 0.5 * f64::EPSILON).min(1.0 - f64::EPSILON))
}

/// A Latin hypercube: `count` points in the unit cube, in every coordinate one per stratum.
///
/// Source: M. D. `McKay`, R. J. Beckman, W. J. Conover, Technometrics 21, 239 (1979).
pub(crate) fn latin_hypercube(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut generator = generator(seed, 0x1a71);
    let mut points = vec![vec![0.0; dimensions]; count];
    let mut strata: Vec<usize> = (0..count).collect();
    for j in 0..dimensions {
        shuffle(&mut strata, &mut generator);
        for (point, &stratum) in points.iter_mut().zip(&strata) {
            point[j] = (stratum as f64 + uniform(&mut generator)) / count as f64;
        }
    }
    points
}

/// A random permutation in place.
pub(crate) fn shuffle(items: &mut [usize], generator: &mut Pcg64) {
    for last in (1..items.len()).rev() {
        items.swap(last, generator.random_range(0..=last));
    }
}
