//! Statistical inference for any forward model: from measured numbers to the model's parameters and
//! their uncertainty.
//!
//! A [`ForwardModel`] has parameters, observations and predictions. A parameter has bounds, a
//! working coordinate `x` (its value or its logarithm) and optionally a normal prior; an observation
//! has a standard deviation. All results follow from one cost,
//!
//! ```text
//! cost(x) = 1/2 sum_i rho(((prediction_i(x) - value_i) / sd_i)^2) + 1/2 sum_j ((x_j - mean_j) / sd_j)^2,
//! ```
//!
//! with the [`Loss`] `rho`:
//!
//! | result | function |
//! |---|---|
//! | best values, from many starts | [`fit()`] |
//! | derivatives at the optimum | [`Fit::linearise`] |
//! | combinations determined by the data | [`Linearisation::identifiability`] |
//! | strain of priors and bounds | [`Linearisation::strains`] |
//! | uncertainty, normal approximation | [`Fit::covariance`], [`Linearisation::covariance`] |
//! | intervals of a nonlinear model | [`Fit::profile`] |
//! | posterior distribution | [`Fit::posterior`], on a response surface with exact weights |
//! | posterior with an unknown function | [`Fit::latent_posterior`], of [latents](Parameter::latent) with a [`LatentPrior`] |
//! | draws before the measurement | [`prior_draws`] |
//! | errors of observations that share causes | [`CorrelatedErrors`] |
//! | agreement with the data in a word | [`GoodnessOfFit::agreement`] |
//! | convergence of Markov chains | [`r_hat`], [`effective_sample_size`] |
//! | comparison of several models | [`compare`] |
//! | design of the next measurement | [`expected_information`], [`design_sequence`] |
//!
//! The crate contains no mechanics, reads no files and prints nothing. Models are evaluated at many
//! points per call; all random numbers follow from seeds in the options.
//!
//! # Example
//! A stiffness that grows with a power of the pressure:
//! ```
//! use asperity_inference::{FitOptions, FunctionModel, Observation, Parameter, fit};
//!
//! let pressures = [1.0, 2.0, 3.0, 4.0, 5.0_f64];
//! let model = FunctionModel {
//!     parameters: vec![
//!         Parameter::logarithmic("coefficient", 1.0, [0.01, 100.0])?,
//!         Parameter::linear("exponent", 0.3, [0.0, 1.0])?,
//!     ],
//!     observations: Observation::list(&pressures.map(|p| 3.0 * p.sqrt()), 0.1),
//!     function: |c: &[f64]| pressures.iter().map(|p| c[0] * p.powf(c[1])).collect(),
//! };
//! let best = fit(&model, &FitOptions::default())?;
//! assert!((best.point[0] - 3.0).abs() < 1e-5 && (best.point[1] - 0.5).abs() < 1e-5);
//! let [low, high] = best.covariance()?.interval(1, 0.95)?;
//! assert!(low < 0.5 && 0.5 < high);
//! # Ok::<(), asperity_inference::InferenceError>(())
//! ```

mod comparison;
mod convergence;
mod correlated_errors;
mod covariance;
mod design;
mod error;
mod fit;
mod fit_options;
mod fit_problem;
mod gaussian_process;
mod goodness;
mod identifiability;
mod importance;
mod latent_posterior;
mod latent_prior;
mod latent_subspace;
mod linear_algebra;
mod linearisation;
mod loss;
mod model;
mod parameter;
mod polynomial;
mod posterior;
mod profile;
mod progress;
mod random;
mod sampler;
mod search;
mod stencil;
mod strain;
mod surrogate;

pub use comparison::{
    ComparedModel, ComparisonOptions, CrossValidation, GOOD_P_VALUE, MISFIT_P_VALUE,
    ModelAssessment, ModelComparison, REJECTION_AICC, REJECTION_ERRORS, compare, compare_fits,
    compare_with_progress,
};
pub use convergence::{effective_sample_size, r_hat};
pub use correlated_errors::CorrelatedErrors;
pub use covariance::{Covariance, NoiseScale};
pub use design::{DesignCandidate, ExpectedInformation, design_sequence, expected_information};
pub use error::InferenceError;
pub use fit::{
    Fit, FitSolution, Optimum, StartOutcome, fit, fit_with_progress, refit_with_progress,
};
pub use fit_options::FitOptions;
pub use gaussian_process::{LatentBasis, matern_one_half, matern_three_halves};
pub use goodness::{Agreement, GoodnessOfFit};
pub use identifiability::{Identifiability, UNDETERMINED_SHARE, Undetermined};
pub use importance::RELIABLE_SHAPE;
pub use latent_posterior::LatentPosterior;
pub use latent_prior::{LatentPrior, prior_draws};
pub use latent_subspace::ACTIVE_INFORMATION;
pub use linearisation::Linearisation;
pub use loss::Loss;
pub use model::{
    Derivatives, ForwardModel, FunctionModel, Observation, PredictionError, Predictions,
    ScaledNoise,
};
pub use parameter::{Parameter, ParameterScale, Prior};
pub use posterior::{
    CredibleBand, Posterior, PosteriorDiagnostics, PosteriorMethod, PosteriorOptions, SurfaceCost,
};
pub use profile::{Profile, ProfileEnd, ProfileOptions, ProfilePoint};
pub use progress::{Progress, ProgressCallback, Stage};
pub use random::{chi_square_tail, normal_quantile};
pub use search::FitTermination;
pub use strain::{Strain, StrainKind};
