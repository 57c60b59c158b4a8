//! The time of a posterior, estimated before it.

use super::options::PosteriorOptions;
use crate::surrogate::{evaluation_seconds, training_points};

/// Points and time of a round of a posterior on a response surface, and of its diagnostics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceCost {
    /// Training points of a surface.
    pub training: usize,
    /// Time of the chains on it \[s\], on the threads of the current pool.
    pub chains_s: f64,
    /// Time of the diagnostics of the chains at the end \[s\].
    pub diagnostics_s: f64,
}

/// Time of a step of a walker beside its response surface, over a share of the time of the surface, and of the
/// diagnostics of a kept number \[s\]: an estimate of the sizes of both, for the time left.
const STEP_S: f64 = 1e-7;
const STEP_SHARE: f64 = 1.2;
const DIAGNOSED_S: f64 = 2.8e-7;

impl PosteriorOptions {
    /// Points and time of a round with so many parameters and observations, estimated from an evaluation of a surface of their
    /// sizes on this machine.
    ///
    /// ```
    /// let options = asperity_inference::PosteriorOptions::default();
    /// let [few, many] = [3, 9].map(|parameters| options.surface_cost(parameters, 100));
    /// assert_eq!(few.training, 50);
    /// assert_eq!(many.training, 550);
    /// assert!(few.chains_s > 0.0 && many.diagnostics_s > few.diagnostics_s);
    /// ```
    pub fn surface_cost(&self, parameters: usize, observations: usize) -> SurfaceCost {
        let layout = self.layout(parameters, 1);
        let walkers = (layout.ensembles * layout.walkers) as f64;
        let threads = rayon::current_num_threads().min(layout.ensembles).max(1) as f64;
        let step = STEP_S + STEP_SHARE * evaluation_seconds(parameters, observations);
        let states = walkers * (self.burn_in + self.steps) as f64;
        let kept = walkers * self.steps as f64 * parameters as f64;
        SurfaceCost {
            training: training_points(parameters, self.oversampling),
            chains_s: states * step / threads,
            diagnostics_s: kept * DIAGNOSED_S / threads,
        }
    }
}
