//! Identification of contact laws, or of any numbers of a scenario, from measured responses.
//!
//! A [`problem`] names a scenario, the parameters to identify, and data: features of hits,
//! receptances, backbones, records, stiffnesses, ratios. The scenario is the forward model of a
//! weighted least-squares problem,
//!
//! ```text
//! cost(x) = 1/2 sum_i rho(((prediction_i(x) - value_i) / sd_i)^2) + priors,
//! ```
//!
//! which `asperity_inference` solves: best fit, covariance, profiles, posterior,
//! comparison with other laws, design of further measurements. The derivatives of the predictions are exact.
//!
//! | module | content |
//! |---|---|
//! | [`problem`], `identification_problem` | the problem file; the problem with its scenario |
//! | `problem_parameters`, `monotone` | parameters as numbers of a scenario, gains and steps of a law |
//! | `free_law`, `latent_sampling` | a law without an assumed form; its posterior, smoothness and resolution |
//! | `measured_forces` | the force of each hit of an analysis, from its record |
//! | `data_loader`, `analysed_hits`, `data_files`, `records` | data to simulated hits and observations |
//! | `stepped_sine` | steady responses to a shaker, measured and simulated |
//! | `scenario_laws` | the named laws of a scenario and their stiffnesses |
//! | `hit`, `observed_quantity`, `scenario_model` | simulated hits and their results at a point |
//! | `structure_hits` | hits on structures of matrices |
//! | `forward_model`, `derivatives` | predictions in batches, and their exact derivatives |
//! | `force_noise`, `shared_errors` | errors that the lines of a measured receptance share, made independent |
//! | `built_model`, `build` | models with their observations: of the problem, of compared laws, of planned hits |
//! | `identification`, `hit_numerics` | fit, uncertainty, comparison; estimated errors of the simulated hits |
//! | `law_band`, `law_comparison`, `design` | the law with its credible band; other laws; ranking of further measurements |
//! | `given_numbers` | numbers of the scenario that no parameter changes, and their effect on the law |
//! | `correlation` | correlation of residuals, which widens what rests on a misfit |
//! | `sampled_fit` | fit, profiles and posterior, repeated from a draw of lower cost |
//! | `explanations` | changes of the model that would explain the data better |
//! | `checks` | agreement with the data, as a whole and in groups |
//! | `judgement` | the use that the law allows, and the reasons |
//! | `starts` | agreement of the starts of the fit |
//! | `work`, `incomplete` | progress of the whole, requests to stop, the result until then |
//! | `conclusions`, `report` | conclusions in sentences; JSON and tables |
//!
//! # Example
//! ```no_run
//! use asperity_identify::{IdentificationError, IdentificationProblem, identify};
//!
//! let problem = IdentificationProblem::read("problem.json")?;
//! let found = identify(&problem)?;
//! for sentence in found.conclusions() {
//!     println!("{sentence}");
//! }
//! # Ok::<(), IdentificationError>(())
//! ```

mod analysed_hits;
mod build;
mod built_model;
mod checks;
mod conclusions;
mod correlation;
mod data_files;
mod data_loader;
mod derivatives;
mod design;
mod error;
mod explanations;
mod force_noise;
mod forward_model;
mod free_law;
mod given_numbers;
mod hit;
mod hit_numerics;
mod identification;
mod identification_problem;
mod incomplete;
mod judgement;
mod latent_sampling;
mod law_band;
mod law_comparison;
mod measured_forces;
mod monotone;
mod observed_quantity;
pub mod problem;
mod problem_parameters;
mod records;
mod report;
mod response_factor;
mod sampled_fit;
mod scenario_laws;
mod scenario_model;
mod shared_errors;
mod starts;
mod stepped_sine;
mod structure_hits;
#[cfg(test)]
mod tests;
mod unfinished;
mod work;

pub use analysed_hits::{MeasuredHits, measured_hits};
pub use checks::PredictiveCheck;
pub use conclusions::PressureDependence;
pub use design::{CandidateMeasurement, DesignRanking, MeasurementKind};
pub use error::IdentificationError;
pub use explanations::Explanation;
pub use given_numbers::{GivenNumber, RigidSupport};
pub use hit_numerics::{FeatureErrors, HitNumerics};
pub use identification::{Identification, identify, identify_with_progress};
pub use identification_problem::IdentificationProblem;
pub use incomplete::IncompleteIdentification;
pub use judgement::{Judgement, Reason, ReasonKind, Usability};
pub use latent_sampling::{FreeLawFindings, SmoothnessProbability};
pub use law_band::{
    ComparedForm, INFORMED_SHARE, LawBand, RESOLVED, StiffnessEstimate, StiffnessOrigin,
};
pub use report::{DRAWS_SCHEMA, Estimate, IDENTIFICATION_SCHEMA, PredictedObservation};
pub use starts::StartAgreement;
pub use work::{Work, WorkProgress, WorkStage};

pub use asperity_inference as inference;
