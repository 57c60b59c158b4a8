//! Markov chains of a posterior: their layout, states spread over their steps, diagnostics.

use rayon::prelude::*;

use crate::convergence::{
    effective_sample_size, effective_sample_size_of_scores, r_hat_of_scores, rank_normalised, split,
};
use crate::sampler::Chains;

/// Of how many draws one is evaluated first.
pub(super) const PART: usize = 5;

/// Diagnostics of chains, weights and response surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PosteriorDiagnostics {
    /// Rank-normalised split R-hat of every parameter, each ensemble one chain of its walkers' steps
    /// in turn; below 1.01 is good.
    pub r_hat: Vec<f64>,
    /// Effective sample size of every parameter, of all kept steps: the smaller of the bulk sizes
    /// over walkers and of the ensembles' means.
    pub effective_sample_size: Vec<f64>,
    /// Integrated autocorrelation time of every parameter, in steps: kept steps over effective sample
    /// size.
    pub autocorrelation_time: Vec<f64>,
    /// Share of accepted moves.
    pub acceptance: f64,
    /// Effective number of weighted draws, at most their number.
    pub effective_draws: f64,
    /// Pareto shape of the largest weights, before any cut: below 0.7 weighted means are reliable. `None` where
    /// the weights are equal or too few.
    pub pareto_shape: Option<f64>,
    /// Share of draws at the limit of the response surface's range.
    pub at_range_limit: f64,
    /// Draws that were evaluated on the model: more than are kept where their weights left too few, of
    /// which the kept ones are resampled to equal weights. Weights are then cut at their mean times the
    /// root of their number, which takes a bias for less variance.
    pub evaluated_draws: usize,
    /// Response surfaces trained; 0 for the exact method.
    pub rounds: usize,
    /// Largest leave-one-out error of the last surface, in standard deviations of an observation.
    pub surrogate_error: f64,
    /// Evaluations of the model: training points with predictions and draws of all rounds; for the
    /// exact method all points.
    pub evaluations: usize,
    /// Parameters whose draws leave out more than a quarter of the profile interval: the surface
    /// then misses a part of the distribution.
    pub truncated: Vec<usize>,
}

/// Of `draws` states evenly spread over steps, from one walker after the other, those from `first` to
/// `end` in an order that spreads every beginning over all steps.
pub(super) fn spread(chains: &Chains, draws: usize, first: usize, end: usize) -> Vec<Vec<f64>> {
    let walkers = chains.walkers.len();
    let steps = chains.walkers.first().map_or(0, Vec::len);
    let count = draws.min(walkers * steps);
    let order = (0..PART).flat_map(|offset| (offset..count).step_by(PART));
    let state = |k: usize| chains.walkers[k % walkers][k * steps / count].clone();
    order.skip(first).take(end.saturating_sub(first)).map(state).collect()
}

/// Completes diagnostics by the chains of every parameter.
pub(super) fn chain_diagnostics(
    chains: &Chains,
    of_draws: PosteriorDiagnostics,
) -> PosteriorDiagnostics {
    let dimensions = chains.walkers.first().and_then(|chain| chain.first()).map_or(0, Vec::len);
    let of = |j: usize| -> Vec<Vec<f64>> {
        chains.walkers.iter().map(|chain| chain.iter().map(|state| state[j]).collect()).collect()
    };
    let kept: usize = chains.walkers.iter().map(Vec::len).sum();
    let of_parameter = |j: usize| {
        let chains_of_walkers = of(j);
        let ensembles = ensemble_means(&chains_of_walkers, chains.ensembles);
        let worth =
            effective_sample_size(&ensembles) * variance(&chains_of_walkers) / variance(&ensembles);
        // Both measures rank the same values: the first and the second halves of all walkers, one after the other.
        let scores = rank_normalised(&split(&chains_of_walkers));
        let size = effective_sample_size_of_scores(&scores).min(worth);
        let halves = |offset: usize| -> Vec<Vec<f64>> {
            scores.iter().skip(offset).step_by(2).cloned().collect()
        };
        let together = [0, 1].map(|offset| whole_ensembles(&halves(offset), chains.ensembles));
        (size, r_hat_of_scores(&together.concat()))
    };
    let (sizes, r_hat): (Vec<f64>, Vec<f64>) =
        (0..dimensions).into_par_iter().map(of_parameter).unzip();
    PosteriorDiagnostics {
        r_hat,
        autocorrelation_time: sizes.iter().map(|size| kept as f64 / size).collect(),
        effective_sample_size: sizes,
        acceptance: chains.acceptance,
        ..of_draws
    }
}

/// Each ensemble as one chain: all its walkers' first steps, then all second ones, and so on.
fn whole_ensembles(walkers: &[Vec<f64>], ensembles: usize) -> Vec<Vec<f64>> {
    let in_turn = |group: &[Vec<f64>]| {
        (0..group[0].len()).flat_map(|n| group.iter().map(move |chain| chain[n])).collect()
    };
    walkers.chunks(walkers.len() / ensembles).map(in_turn).collect()
}

/// The mean over the walkers of each ensemble, step by step. Its autocorrelation includes that
/// between walkers, which single chains do not show (Goodman and Weare 2010, section 3).
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
