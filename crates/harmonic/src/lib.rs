//! Periodic responses of structures with rough contacts: harmonic balance, continuation, stability
//! and backbones.
//!
//! A structure vibrates about its rest under weight and a load `F cos(w t)` at one port. Between
//! its contact faces it is linear and enters by its compliance there alone; the unknowns are the
//! closure increments at the interfaces, as truncated Fourier series. With springs `K_0` of the
//! contacts' stiffness at rest in its contacts, the compliance G at each harmonic, g the closures per
//! load, and the series P of the contact force increments `S (p - p0)`, harmonic balance is
//!
//! ```text
//! X_k + G(k w) (P_k - K_0 X_k) = g(k w) F_k,  k = 1..H,        P_0 = 0,
//! ```
//!
//! the last equation because a chain of bodies is statically determinate: the mean pressures are
//! the static ones, and the mean closures follow from the laws (other structures: [`MeanBalance`]).
//! Sensors at any ports read motions that are linear in the closures, forces and load found.
//! P comes from the laws at samples of the period (alternating frequency-time method), its
//! derivative from their tangents; the tangent of a lost contact is zero.
//!
//! [`trace`] follows a branch of solutions by arc length in the parameter of a [`Continuation`]:
//! responses over frequency or force, phase resonances, or damped nonlinear modes. It passes and
//! locates folds and peaks, and, with [`Floquet`] multipliers, locates and names bifurcations.
//!
//! | module | holds |
//! |---|---|
//! | `linear_system`, `compliance`, `port` | the linear structure: [`LinearSystem`], [`Compliance`], [`MeanBalance`]; its ports |
//! | `dual` | functions of frequency and anti-damping with their derivatives |
//! | `rigid_mass`, `elastic_bars`, `bars_on_springs`, `bar`, `component_modes` | linear systems: a rigid mass, bars in closed form, component modes |
//! | `modal_damping` | damping ratios of linearised modes in receptances |
//! | `contact_system` | a linear structure with its contacts |
//! | `pressure_increments` | the pressure of a contact over its closure, both from rest |
//! | `condensed_stack` | a stack without the inertia of light bodies between contacts |
//! | `fourier`, `balance` | series and samples; the equations with their derivatives |
//! | `linear_response` | the response of the linearised structure |
//! | `continuation`, `continuation_problem` | the parameter varied; the equations in scaled unknowns |
//! | `factorization`, `complex_elimination` | elimination |
//! | `linearisation`, `gmres` | the linearised equations; their solution by iteration, for many contacts |
//! | `arc_length` | predictor, corrector, step control, location of special points |
//! | `floquet` | stability: Floquet multipliers by integration in time |
//! | `settings`, `trace`, `branch_recorder` | settings; a branch from start to end; its points |
//! | `stepped_sine` | responses at given frequencies and forces, and their derivatives |
//! | `periodic_response`, `branch` | results |
//!
//! # Conventions
//! SI units. Displacements and closures count from rest, down and closing positive. Complex
//! amplitudes belong to `exp(i k w t)`, so a displacement that lags has a negative phase. Series
//! are stored as mean, then cosine and sine coefficient of each harmonic, interface by interface.
//!
//! # Example
//! The guide bar of a rig as a rigid mass on a power-law contact:
//! ```
//! use std::sync::Arc;
//!
//! use asperity_harmonic::{
//!     ContactSystem, Continuation, HarmonicSettings, LawEvaluation, RigidMass, trace,
//! };
//! use asperity_law::Power;
//! use asperity_structure::PreloadedContact;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let law = Arc::new(Power::new(0.9e10, 0.35, 0.0)?);
//! let contact = PreloadedContact::new("guide", 1.15e-4, law, 1.37e5)?;
//! let natural = (contact.spring() / 1.61).sqrt() / std::f64::consts::TAU;
//! let mass = Arc::new(RigidMass::new(1.61, 420.0)?);
//! let system = ContactSystem::new(mass, vec![contact], LawEvaluation::default())?;
//!
//! let sweep = Continuation::Frequency { force: 0.5, from: 700.0, to: 1200.0 };
//! let branch = trace(&system, &sweep, &HarmonicSettings::default())?;
//! let peak = branch.highest().ok_or("an empty branch")?;
//! // Softer than the linear resonance, with a second harmonic.
//! assert!(branch.is_complete() && peak.frequency_hz() < 0.995 * natural);
//! assert!(peak.displacement_ratio() > 0.01);
//! # Ok(())
//! # }
//! ```

mod arc_length;
mod balance;
mod bar;
mod bars_on_springs;
mod branch;
mod branch_recorder;
mod complex_elimination;
mod compliance;
mod component_modes;
mod condensed_stack;
mod contact_system;
mod continuation;
mod continuation_problem;
mod dual;
mod elastic_bars;
mod error;
mod factorization;
mod floquet;
mod fourier;
mod gmres;
mod linear_response;
mod linear_system;
mod linearisation;
#[cfg(test)]
mod many_contacts_tests;
mod modal_damping;
mod periodic_response;
mod port;
mod pressure_increments;
mod rigid_mass;
mod settings;
mod stepped_sine;
mod trace;
mod vector_instructions;

pub use branch::{Branch, SpecialPoint, SpecialPointKind, Termination, UnfinishedBranch};
pub use compliance::{Compliance, MeanBalance};
pub use condensed_stack::CondensedStack;
pub use contact_system::{ContactSystem, LawEvaluation};
pub use continuation::Continuation;
pub use dual::Dual;
pub use error::HarmonicError;
pub use floquet::Floquet;
pub use linear_response::linear_receptance;
pub use linear_system::LinearSystem;
pub use periodic_response::{PeriodicResponse, PressureRange};
pub use port::{PortMotion, SystemPort};
pub use rigid_mass::RigidMass;
pub use settings::{FourierResolution, HarmonicSettings, StepControl};
pub use stepped_sine::{Drive, SineResponse, SineVariation, SteppedSineSolver};
pub use trace::{trace, trace_with_progress};
