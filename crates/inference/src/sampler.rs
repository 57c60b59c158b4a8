//! Ensemble Markov chains, by the crate hammer-and-sample.
//!
//! Source: J. Goodman, J. Weare, Comm. App. Math. Comp. Sci. 5, 65 (2010): stretch moves, which
//! are invariant to scales and correlation of the parameters.

use hammer_and_sample::{MinChainLen, Model, Serial, Stretch, sample};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::random::{generator, normal};

/// Numbers and lengths of the chains.
#[derive(Clone, Copy)]
pub(crate) struct ChainLayout {
    pub(crate) dimensions: usize,
    pub(crate) ensembles: usize,
    /// In each ensemble; even, at least twice the dimensions.
    pub(crate) walkers: usize,
    pub(crate) burn_in: usize,
    pub(crate) steps: usize,
    pub(crate) seed: u64,
}

/// The kept steps of every walker, ensembles one after the other.
pub(crate) struct Chains {
    pub(crate) walkers: Vec<Vec<Vec<f64>>>,
    pub(crate) ensembles: usize,
    /// Share of accepted moves, burn-in included.
    pub(crate) acceptance: f64,
}

struct LogDensity<'a>(&'a (dyn Fn(&[f64]) -> f64 + Sync));

impl Model for LogDensity<'_> {
    type Params = Vec<f64>;

    fn log_prob(&self, state: &Vec<f64>) -> f64 {
        let value = (self.0)(state);
        if value.is_nan() { f64::NEG_INFINITY } else { value }
    }
}

/// Samples a logarithmic density (up to a constant, minus infinity outside) from normal starts
/// about zero. Every walker has its own random numbers, independent of threads.
pub(crate) fn sample_chains(
    density: &(dyn Fn(&[f64]) -> f64 + Sync),
    layout: &ChainLayout,
) -> Chains {
    let one = |ensemble: usize| {
        let walker = |walker: usize| {
            let stream = (ensemble * layout.walkers + walker) as u64;
            let mut generator = generator(layout.seed, stream);
            (start(density, layout.dimensions, &mut generator), generator)
        };
        let length = layout.walkers * (layout.burn_in + layout.steps);
        let walkers = (0..layout.walkers).map(walker);
        let model = LogDensity(density);
        sample(&model, &Stretch::default(), walkers, MinChainLen(length), Serial)
    };
    let ensembles: Vec<(Vec<Vec<f64>>, usize)> =
        (0..layout.ensembles).into_par_iter().map(one).collect();
    let accepted: usize = ensembles.iter().map(|ensemble| ensemble.1).sum();
    let moves = layout.ensembles * layout.walkers * (layout.burn_in + layout.steps);
    let mut walkers: Vec<Vec<Vec<f64>>> = Vec::with_capacity(layout.ensembles * layout.walkers);
    for (chain, _) in ensembles {
        let first = walkers.len();
        walkers.extend((0..layout.walkers).map(|_| Vec::with_capacity(layout.steps)));
        for (place, state) in chain.into_iter().enumerate().skip(layout.walkers * layout.burn_in) {
            walkers[first + place % layout.walkers].push(state);
        }
    }
    Chains {
        walkers,
        ensembles: layout.ensembles,
        acceptance: accepted as f64 / moves.max(1) as f64,
    }
}

/// A start of positive density: normal numbers of shrinking spread.
fn start(
    density: &(dyn Fn(&[f64]) -> f64 + Sync),
    dimensions: usize,
    generator: &mut Pcg64,
) -> Vec<f64> {
    let mut spread = 1.0;
    for _ in 0..100 {
        let z: Vec<f64> = (0..dimensions).map(|_| spread * normal(generator)).collect();
        if density(&z).is_finite() {
            return z;
        }
        spread *= 0.9;
    }
    vec![0.0; dimensions]
}
