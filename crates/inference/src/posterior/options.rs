//! How a posterior is sampled.

use crate::error::IdentifyError;

/// What the Markov chains run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PosteriorMethod {
    /// A response surface; its draws are then evaluated on the model and weighted.
    Surrogate,
    /// The model itself, one point a call: for cheap models only.
    Exact,
}

/// Options of a posterior.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosteriorOptions {
    /// What the chains run on.
    pub method: PosteriorMethod,
    /// Draws kept, 10 to 1 000 000.
    pub draws: usize,
    /// Independent ensembles, 2 to 64.
    pub ensembles: usize,
    /// Walkers per unknown in each ensemble, at least 4.
    pub walkers_per_unknown: usize,
    /// Steps of every walker that are dropped.
    pub burn_in: usize,
    /// Steps of every walker that are kept, at least 10.
    pub steps: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Most response surfaces, each trained where the last one led.
    pub most_rounds: usize,
    /// The effective share of weighted draws that ends the rounds.
    pub wanted_share: f64,
    /// Training points per coefficient of the response surface.
    pub oversampling: f64,
}

impl Default for PosteriorOptions {
    fn default() -> Self {
        Self {
            method: PosteriorMethod::Surrogate,
            draws: 1000,
            ensembles: 4,
            walkers_per_unknown: 4,
            burn_in: 1000,
            steps: 4000,
            seed: 1,
            most_rounds: 3,
            wanted_share: 0.5,
            oversampling: 2.5,
        }
    }
}

impl PosteriorOptions {
    /// Refuses what makes no sense.
    pub(crate) fn check(&self) -> Result<(), IdentifyError> {
        let within = |quantity, value: usize, expected, least: usize, most: usize| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(IdentifyError::Option { quantity, value: value as f64, expected })
            }
        };
        within("the number of draws", self.draws, "10 to 1000000", 10, 1_000_000)?;
        within("the number of ensembles", self.ensembles, "2 to 64", 2, 64)?;
        let quantity = "the number of walkers per unknown";
        within(quantity, self.walkers_per_unknown, "4 to 1000", 4, 1000)?;
        within("the number of steps", self.steps, "10 to 1000000", 10, 1_000_000)?;
        within("the number of dropped steps", self.burn_in, "at most 1000000", 0, 1_000_000)?;
        within("the number of rounds", self.most_rounds, "1 to 20", 1, 20)?;
        if !(0.0..=1.0).contains(&self.wanted_share) {
            let (quantity, value) = ("the wanted share", self.wanted_share);
            return Err(IdentifyError::Option { quantity, value, expected: "0 to 1" });
        }
        Ok(())
    }
}
