//! Options of a posterior.

use crate::error::InferenceError;

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
            oversampling: 2.5,
        }
    }
}

impl PosteriorOptions {
    /// Checks the ranges of the options.
    pub(crate) fn check(&self) -> Result<(), InferenceError> {
        let within = |quantity, value: usize, expected, least: usize, most: usize| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(InferenceError::Option { quantity, value: value as f64, expected })
            }
        };
        within("the number of draws", self.draws, "10 to 1000000", 10, 1_000_000)?;
        within("the number of ensembles", self.ensembles, "2 to 64", 2, 64)?;
        let quantity = "the number of walkers per parameter";
        within(quantity, self.walkers_per_parameter, "4 to 1000", 4, 1000)?;
        within("the number of steps", self.steps, "10 to 1000000", 10, 1_000_000)?;
        within("the number of dropped steps", self.burn_in, "at most 1000000", 0, 1_000_000)?;
        within("the number of rounds", self.max_rounds, "1 to 20", 1, 20)?;
        if !(0.0..=1.0).contains(&self.target_share) {
            let (quantity, value) = ("the target share", self.target_share);
            return Err(InferenceError::Option { quantity, value, expected: "0 to 1" });
        }
        Ok(())
    }
}
