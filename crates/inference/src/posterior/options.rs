//! Options of a posterior.

use crate::error::{InferenceError, check_range};
use crate::sampler::ChainLayout;

/// Smallest number of walkers of an ensemble: fewer do not move independently.
const MIN_WALKERS: usize = 16;

/// The density on which the Markov chains run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PosteriorMethod {
    /// A response surface; its draws are then evaluated on the model and weighted.
    Surrogate,
    /// The model itself, one point per call: for cheap models only.
    Exact,
}

/// Options of a posterior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosteriorOptions {
    /// The density on which the chains run.
    pub method: PosteriorMethod,
    /// Draws kept, 10 to 1 000 000.
    pub draws: usize,
    /// Independent ensembles, 2 to 64.
    pub ensembles: usize,
    /// Walkers per parameter in each ensemble, at least 4.
    pub walkers_per_parameter: usize,
    /// Dropped first steps of every walker.
    pub burn_in: usize,
    /// Kept steps of every walker, at least 10.
    pub steps: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Largest number of response surfaces, each trained at the draws of the last one.
    pub max_rounds: usize,
    /// Effective share of weighted draws at which the rounds end.
    pub target_share: f64,
    /// Draws evaluated at most beside those asked for, over those, where weights leave too few.
    pub most_times: usize,
    /// True to end after the round in which a draw is so much lower than the fit that [`Fit::better_draw`], or with latents
    /// [`Fit::better_latent_draw`], tells it: the fit is no minimum then, and the draws are of the wrong place.
    ///
    /// [`Fit::better_draw`]: crate::Fit::better_draw
    /// [`Fit::better_latent_draw`]: crate::Fit::better_latent_draw
    pub ends_at_lower: bool,
    /// Training points per coefficient of the response surface.
    pub oversampling: f64,
}

impl Default for PosteriorOptions {
    fn default() -> Self {
        Self {
            method: PosteriorMethod::Surrogate,
            draws: 1000,
            ensembles: 4,
            walkers_per_parameter: 4,
            burn_in: 1000,
            steps: 4000,
            seed: 1,
            max_rounds: 3,
            target_share: 0.5,
            most_times: 10,
            ends_at_lower: false,
            oversampling: 2.5,
        }
    }
}

impl PosteriorOptions {
    /// Layout of the chains of a round.
    pub(super) fn layout(&self, dimensions: usize, round: usize) -> ChainLayout {
        let walkers = 2 * (dimensions * self.walkers_per_parameter).div_ceil(2);
        ChainLayout {
            dimensions,
            ensembles: self.ensembles,
            walkers: walkers.max(MIN_WALKERS),
            burn_in: self.burn_in,
            steps: self.steps,
            seed: self.seed.wrapping_add(0x5eed * round as u64),
        }
    }

    /// Checks the ranges of the options.
    pub(crate) fn check(&self) -> Result<(), InferenceError> {
        let many = 1_000_000;
        check_range("the number of draws", self.draws as f64, 10..=many, "10 to 1000000")?;
        check_range("the number of ensembles", self.ensembles as f64, 2..=64, "2 to 64")?;
        let (quantity, walkers) =
            ("the number of walkers per parameter", self.walkers_per_parameter as f64);
        check_range(quantity, walkers, 4..=1000, "4 to 1000")?;
        check_range("the number of steps", self.steps as f64, 10..=many, "10 to 1000000")?;
        check_range(
            "the number of dropped steps",
            self.burn_in as f64,
            0..=many,
            "at most 1000000",
        )?;
        let (quantity, times) = ("the multiple of draws evaluated", self.most_times as f64);
        check_range(quantity, times, 0..=1000, "at most 1000")?;
        check_range("the number of rounds", self.max_rounds as f64, 1..=20, "1 to 20")?;
        check_range("the target share", self.target_share, 0.0..=1.0, "0 to 1")
    }
}
