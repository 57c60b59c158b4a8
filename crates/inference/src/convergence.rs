//! Convergence of Markov chains and their effective sample size.
//!
//! Source: A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, *Rank-normalization,
//! folding, and localization: an improved R-hat*, Bayesian Analysis 16, 667 (2021).

use crate::linear_algebra::vectorised;
use crate::random::normal_quantile;

/// Rank-normalised split R-hat of chains of one quantity,
///
/// ```text
/// R = sqrt(((n - 1) / n W + B / n) / W)
/// ```
///
/// with the variance `W` within and `B` between half-chains of length `n`, of the normal scores
/// of the values' ranks (eq. 1-4 and 14). Near 1 when the chains agree, above 1.01 before
/// convergence. Infinite if they are constant but differ; NaN with fewer than four steps or if all
/// values are equal.
///
/// ```
/// let chains = [vec![0.1, -0.3, 0.2, -0.1], vec![-0.2, 0.3, -0.1, 0.1]];
/// assert!(asperity_inference::r_hat(&chains) < 1.2);
/// ```
pub fn r_hat(chains: &[Vec<f64>]) -> f64 {
    r_hat_of_scores(&rank_normalised(&split(chains)))
}

/// As [`r_hat`], of half-chains of normal scores.
pub(crate) fn r_hat_of_scores(halves: &[Vec<f64>]) -> f64 {
    let Some(moments) = Moments::of(halves) else { return f64::NAN };
    (moments.total / moments.within).sqrt()
}

/// Bulk effective sample size: the number of independent draws that determine the centre of the
/// distribution as precisely as these chains,
///
/// ```text
/// ESS = m n / (-1 + 2 sum_t P_t),   P_t = rho_2t + rho_2t+1,
/// ```
///
/// over rank-normalised half-chains, with the autocorrelations combined over chains (eq. 10-13)
/// and Geyer's initial monotone sequence. Walkers of one ensemble count as separate chains. NaN
/// where [`r_hat`] is NaN.
pub fn effective_sample_size(chains: &[Vec<f64>]) -> f64 {
    effective_sample_size_of_scores(&rank_normalised(&split(chains)))
}

/// As [`effective_sample_size`], of half-chains of normal scores.
pub(crate) fn effective_sample_size_of_scores(halves: &[Vec<f64>]) -> f64 {
    let Some(moments) = Moments::of(halves) else { return f64::NAN };
    let (count, length) = (halves.len() as f64, halves[0].len());
    let centred = |(chain, mean): (&Vec<f64>, &f64)| chain.iter().map(|v| v - mean).collect();
    let centred: Vec<Vec<f64>> = halves.iter().zip(&moments.means).map(centred).collect();
    let correlation = |lag: usize| {
        let of = |chain: &Vec<f64>| sum_of_products(&chain[lag..], chain) / (length - 1) as f64;
        let covariance = vectorised(|| {
            let mut sum = 0.0;
            for chain in &centred {
                sum += of(chain);
            }
            sum
        });
        1.0 - (moments.within - covariance / count) / moments.total
    };
    let (mut sum, mut last, mut lag) = (0.0, f64::INFINITY, 0);
    while lag + 1 < length {
        let first = if lag == 0 { 1.0 } else { correlation(lag) };
        let pair = (first + correlation(lag + 1)).min(last);
        if pair < 0.0 {
            break;
        }
        sum += pair;
        last = pair;
        lag += 2;
    }
    let draws = count * length as f64;
    // Antithetic chains can exceed their length, but not without limit.
    let time = (2.0 * sum - 1.0).max(1.0 / draws.log10().max(1.0));
    draws / time
}

/// Sum of the products of values at equal places, by sums side by side, which do not wait for each other.
#[allow(clippy::inline_always, reason = "it must be compiled for the vectors of its caller")]
#[inline(always)]
fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    const SIDE_BY_SIDE: usize = 8;
    let (a_parts, b_parts) = (a.chunks_exact(SIDE_BY_SIDE), b.chunks_exact(SIDE_BY_SIDE));
    let left = a.len() - a_parts.remainder().len();
    let rest: f64 = a_parts.remainder().iter().zip(&b[left..]).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; SIDE_BY_SIDE];
    for (a, b) in a_parts.zip(b_parts) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

struct Moments {
    means: Vec<f64>,
    within: f64,
    total: f64,
}

impl Moments {
    fn of(chains: &[Vec<f64>]) -> Option<Self> {
        let length = chains.first().map(Vec::len).filter(|&length| length >= 2)? as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let variance = |values: &[f64]| {
            let centre = mean(values);
            values.iter().map(|v| (v - centre).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)
        };
        let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
        let within = mean(&chains.iter().map(|chain| variance(chain)).collect::<Vec<f64>>());
        let between = if means.len() > 1 { variance(&means) } else { 0.0 };
        Some(Self { total: (length - 1.0) / length * within + between, means, within })
    }
}

/// Halves of the chains, all of the length of the shortest.
pub(crate) fn split(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let half = chains.iter().map(Vec::len).min().unwrap_or(0) / 2;
    let halves = |chain: &Vec<f64>| [chain[..half].to_vec(), chain[chain.len() - half..].to_vec()];
    chains.iter().flat_map(halves).collect()
}

/// Normal scores of the ranks over all chains, ties sharing their mean rank.
pub(crate) fn rank_normalised(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    // Values beside their places, so that comparisons need nothing else.
    let mut order: Vec<(f64, usize, usize)> = Vec::with_capacity(chains.iter().map(Vec::len).sum());
    for (m, chain) in chains.iter().enumerate() {
        order.extend(chain.iter().enumerate().map(|(n, value)| (*value, m, n)));
    }
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut scores: Vec<Vec<f64>> = chains.iter().map(|chain| vec![0.0; chain.len()]).collect();
    let mut first = 0;
    while first < order.len() {
        let mut last = first;
        while last + 1 < order.len() && order[last + 1].0 == order[first].0 {
            last += 1;
        }
        let rank = 0.5 * (first + last) as f64 + 1.0;
        let score = normal_quantile((rank - 0.375) / (order.len() as f64 + 0.25));
        for &(_, m, n) in &order[first..=last] {
            scores[m][n] = score;
        }
        first = last + 1;
    }
    scores
}
