//! Ensemble Markov chains; the only file that knows the crate hammer-and-sample.
//!
//! Source: J. Goodman, J. Weare, Comm. App. Math. Comp. Sci. 5, 65 (2010): stretch moves, which
//! do not care about the scales and correlation of the unknowns.

use hammer_and_sample::{MinChainLen, Model, Serial, Stretch, sample};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::random::{generator, normal};

/// How long and how many.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
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

struct Density<'a>(&'a (dyn Fn(&[f64]) -> f64 + Sync));

impl Model for Density<'_> {
    type Params = Vec<f64>;

    fn log_prob(&self, state: &Vec<f64>) -> f64 {
        let value = (self.0)(state);
        if value.is_nan() { f64::NEG_INFINITY } else { value }
    }
}

/// Samples a logarithmic density (up to a constant, minus infinity outside) from normal starts
/// about zero. Every walker has its own random numbers, so threads change nothing.
pub(crate) fn run(density: &(dyn Fn(&[f64]) -> f64 + Sync), plan: &Plan) -> Chains {
    let one = |ensemble: usize| {
        let walker = |walker: usize| {
            let stream = (ensemble * plan.walkers + walker) as u64;
            let mut generator = generator(plan.seed, stream);
            (start(density, plan.dimensions, &mut generator), generator)
        };
        let length = plan.walkers * (plan.burn_in + plan.steps);
        let walkers = (0..plan.walkers).map(walker);
        let model = Density(density);
        sample(&model, &Stretch::default(), walkers, MinChainLen(length), Serial)
    };
    let ensembles: Vec<(Vec<Vec<f64>>, usize)> =
        (0..plan.ensembles).into_par_iter().map(one).collect();
    let accepted: usize = ensembles.iter().map(|ensemble| ensemble.1).sum();
    let moves = plan.ensembles * plan.walkers * (plan.burn_in + plan.steps);
    let mut walkers: Vec<Vec<Vec<f64>>> = Vec::with_capacity(plan.ensembles * plan.walkers);
    for (chain, _) in ensembles {
        let first = walkers.len();
        walkers.extend((0..plan.walkers).map(|_| Vec::with_capacity(plan.steps)));
        for (place, state) in chain.into_iter().enumerate().skip(plan.walkers * plan.burn_in) {
            walkers[first + place % plan.walkers].push(state);
        }
    }
    Chains { walkers, ensembles: plan.ensembles, acceptance: accepted as f64 / moves.max(1) as f64 }
}

/// A start of positive density: normal numbers, drawn closer to zero the longer it takes.
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
