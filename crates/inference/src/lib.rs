//! The statistics of identification: from measured numbers and a model that predicts them to the
//! model's unknowns, and how sure they are.
//!
//! A [`ForwardModel`] has unknowns, observations and predictions. An unknown has bounds, a working
//! coordinate `x` (its value or the logarithm) and perhaps a normal prior; an observation has a
//! standard deviation. Everything here follows from one cost,
//!
//! ```text
//! cost(x) = 1/2 sum_i rho(((prediction_i(x) - value_i) / sd_i)^2) + 1/2 sum_j ((x_j - mean_j) / sd_j)^2,
//! ```
//!
//! with `rho` the [`Loss`]:
//!
//! | question | by |
//! |---|---|
//! | which values fit best, from where | [`fit()`] |
//! | what the data determine at all | [`linearise`], [`identifiability()`] |
//! | how sure, near the optimum | [`covariance()`] |
//! | how sure, where the model bends | [`profile()`] |
//! | how sure, altogether | [`posterior()`], on a [`Surrogate`] with exact weights |
//! | whether Markov chains have converged | [`r_hat`], [`effective_sample_size`] |
//! | which of several models | [`compare`] |
//! | what to measure next | [`expected_information`], [`design_sequence`] |
//!
//! The crate knows numbers. It knows no mechanics, reads no files and prints nothing. A model is
//! asked for many points at a time; all random numbers come from seeds in the options.
//!
//! ```
//! use asperity_inference::{
//!     FitOptions, ForwardModel, NoiseScale, Observation, Predictions, Refusal, Scale, Unknown,
//!     covariance, fit, linearise,
//! };
//!
//! /// A stiffness that grows with a power of the pressure.
//! struct Power {
//!     unknowns: Vec<Unknown>,
//!     observations: Vec<Observation>,
//! }
//!
//! impl ForwardModel for Power {
//!     fn unknowns(&self) -> &[Unknown] {
//!         &self.unknowns
//!     }
//!     fn observations(&self) -> &[Observation] {
//!         &self.observations
//!     }
//!     fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
//!         let at = |c: &Vec<f64>| Ok((1..=5).map(|p| Some(c[0] * f64::from(p).powf(c[1]))).collect());
//!         points.iter().map(at).collect()
//!     }
//! }
//!
//! let unknowns = vec![
//!     Unknown::new("coefficient", 1.0, [0.01, 100.0], Scale::Logarithmic, None)?,
//!     Unknown::new("exponent", 0.3, [0.0, 1.0], Scale::Linear, None)?,
//! ];
//! let measured = |p: i32| 3.0 * f64::from(p).sqrt();
//! let observations = (1..=5).map(|p| Observation {
//!     label: format!("pressure {p}"),
//!     block: p as usize,
//!     value: measured(p),
//!     standard_deviation: 0.1,
//! });
//! let model = Power { unknowns, observations: observations.collect() };
//! let best = fit(&model, &FitOptions::default(), &|_| ())?;
//! assert!((best.point[0] - 3.0).abs() < 1e-5 && (best.point[1] - 0.5).abs() < 1e-5);
//! let sure = covariance(&model, &best, &linearise(&model, &best)?, NoiseScale::Given)?;
//! let [low, high] = sure.interval(1, 0.95)?;
//! assert!(low < 0.5 && 0.5 < high);
//! # Ok::<(), asperity_inference::IdentifyError>(())
//! ```

mod choice;
mod convergence;
mod covariance;
mod dense;
mod design;
mod distribution;
mod error;
mod fit;
mod identifiability;
mod importance;
mod linearisation;
mod loss;
mod model;
mod polynomial;
mod posterior;
mod problem;
mod profile;
mod random;
mod sampler;
mod stencil;
mod subset;
mod surrogate;
mod unknown;

pub use choice::{
    CandidateOutcome, Choice, ChoiceOptions, CrossValidation, FITS, MISFIT, ModelVerdict,
    REJECTION_AICC, REJECTION_ERRORS, compare,
};
pub use convergence::{effective_sample_size, r_hat};
pub use covariance::{Covariance, GoodnessOfFit, NoiseScale, covariance, goodness_of_fit};
pub use design::{DesignCandidate, DesignGain, design_sequence, expected_information};
pub use distribution::normal_quantile;
pub use error::IdentifyError;
pub use fit::{Ending, Fit, FitOptions, Optimum, Progress, Stage, StartOutcome, fit};
pub use identifiability::{Identifiability, UNDETERMINED_SHARE, Undetermined, identifiability};
pub use linearisation::{Linearisation, linearise};
pub use loss::Loss;
pub use model::{Derivatives, ForwardModel, Observation, Predictions, Refusal};
pub use posterior::{
    Band, Posterior, PosteriorDiagnostics, PosteriorMethod, PosteriorOptions, posterior,
};
pub use profile::{Profile, ProfileEnd, ProfileOptions, ProfilePoint, profile};
pub use surrogate::{Surrogate, SurrogateOptions};
pub use unknown::{Prior, Scale, Unknown};
