//! Importance weights of draws from an approximate distribution.

/// Weights with unit sum from logarithmic ratios; all zero if no ratio is finite.
pub(crate) fn normalised(log_ratios: &[f64]) -> Vec<f64> {
    let largest = log_ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return vec![0.0; log_ratios.len()];
    }
    let raw: Vec<f64> = log_ratios.iter().map(|ratio| (ratio - largest).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|weight| weight / sum).collect()
}

/// Kish's effective number of equally weighted draws, `1 / sum w^2`.
pub(crate) fn effective_draws(weights: &[f64]) -> f64 {
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    if squares > 0.0 { 1.0 / squares } else { 0.0 }
}

/// Largest Pareto shape of weights whose means are reliable.
pub const RELIABLE_SHAPE: f64 = 0.7;

/// The shape `k` of a generalised Pareto distribution fitted to the largest weights: below 0.7
/// weighted means are reliable. `None` for too few weights.
///
/// Sources: J. Zhang, M. A. Stephens, Technometrics 51, 316 (2009) for the estimate; A. Vehtari
/// et al., J. Mach. Learn. Res. 25, 72 (2024) for its use.
pub(crate) fn pareto_shape(weights: &[f64]) -> Option<f64> {
    let mut sorted = weights.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let tail = (0.2 * count).min(3.0 * count.sqrt()).ceil() as usize;
    if tail < 5 || tail >= sorted.len() {
        return None;
    }
    let (body, top) = sorted.split_at(sorted.len() - tail);
    let threshold = body[body.len() - 1];
    let excess: Vec<f64> = top.iter().map(|weight| weight - threshold).collect();
    let largest = excess[tail - 1];
    let quartile = excess[((0.25 * tail as f64 + 0.5).floor() as usize).clamp(1, tail) - 1];
    // Weights equal up to rounding have no tail.
    if largest <= 1e-12 * threshold || quartile <= 0.0 {
        return (largest <= 1e-12 * threshold).then_some(f64::NEG_INFINITY);
    }
    let candidates = 30 + (tail as f64).sqrt().floor() as usize;
    let shape = |theta: f64| excess.iter().map(|x| (-theta * x).ln_1p()).sum::<f64>() / tail as f64;
    let thetas: Vec<f64> = (1..=candidates)
        .map(|j| {
            let root = (candidates as f64 / (j as f64 - 0.5)).sqrt();
            1.0 / largest + (1.0 - root) / (3.0 * quartile)
        })
        .collect();
    let likelihood = |&theta: &f64| {
        let k = shape(theta);
        tail as f64 * ((-theta / k).ln() - k - 1.0)
    };
    let logs: Vec<f64> = thetas.iter().map(likelihood).collect();
    let shares = normalised(
        &logs.iter().map(|l| if l.is_nan() { f64::NEG_INFINITY } else { *l }).collect::<Vec<_>>(),
    );
    let theta: f64 = thetas.iter().zip(&shares).map(|(theta, share)| theta * share).sum();
    let k = shape(theta);
    // A weak prior at 1/2 with the weight of ten draws, for small tails.
    Some((k * tail as f64 + 5.0) / (tail as f64 + 10.0))
}
