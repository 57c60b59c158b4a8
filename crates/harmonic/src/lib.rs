//! Steady periodic responses of structures with rough contacts: harmonic balance, continuation,
//! stability and backbones.
//!
//! A structure vibrates about its rest under weight, driven by `F cos(w t)` at one point. Between
//! its contact faces it is linear and enters by its compliance there alone; the unknowns are the
//! closure increments at the interfaces, as truncated Fourier series. With the compliance G at
//! each harmonic, g that of the driving point, and the series P of the contact force increments
//! `S (p - p0)`, harmonic balance asks
//!
//! ```text
//! X_k + G(k w) P_k = g(k w) F_k,  k = 1..H,        P_0 = 0,
//! ```
//!
//! the last line because a chain of bodies is statically determinate: the mean pressures are the
//! static ones, and the mean closures go where the laws need them (other structures: see
//! [`MeanBalance`]). P comes from the laws at samples of the period (alternating frequency-time),
//! its derivative from their tangents; a lost contact is a tangent of zero.
//!
//! [`trace`] follows a [`Path`] of solutions by arc length: responses over frequency or force,
//! phase resonances, or damped nonlinear modes. It passes and locates folds, locates peaks, judges
//! stability if asked, locates and names bifurcations, and keeps every point it finds.
//!
//! | module | holds |
//! |---|---|
//! | `linear_system` | what is asked of the linear structure: [`LinearSystem`], [`Compliance`], [`MeanBalance`] |
//! | `oscillator`, `elastic_bars`, `modal_system` | a rigid mass; bars in closed form; modes with residual flexibility |
//! | `bar_modes` | the free modes of a stack's bars |
//! | `contact`, `contact_system` | laws about the static state; a structure with its contacts |
//! | `fourier`, `balance` | series and samples; the equations with their derivatives |
//! | `linear_response` | the response of the linearised structure |
//! | `path`, `problem` | what is varied; the equations in scaled unknowns |
//! | `factorization`, `arc_length` | elimination; predictor, corrector, step control, location of places |
//! | `floquet` | stability: Hill's matrix projected, or integration in time |
//! | `settings`, `trace`, `recorder` | settings; a path from start to end; its points and what is special |
//! | `response`, `branch` | what comes out |
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
//!     Contact, ContactSystem, Evaluation, HarmonicError, Oscillator, Path, Settings, trace,
//! };
//! use asperity_law::Power;
//!
//! let law = Arc::new(Power::new(0.9e10, 0.35, 0.0).map_err(|source| HarmonicError::Law {
//!     interface: "guide".into(),
//!     source,
//! })?);
//! let contact = Contact::new("guide", 1.15e-4, 1.37e5, law, Evaluation::default())?;
//! let natural = (contact.stiffness() / 1.61).sqrt() / std::f64::consts::TAU;
//! let system = ContactSystem::new(Arc::new(Oscillator::new(1.61, 420.0)?), vec![contact])?;
//!
//! let sweep = Path::Frequency { force: 0.5, from: 700.0, to: 1200.0 };
//! let branch = trace(&system, &sweep, &Settings::default())?;
//! let peak = branch.highest().ok_or(HarmonicError::EmptyRange {
//!     quantity: "frequency [Hz]",
//!     from: 700.0,
//!     to: 1200.0,
//! })?;
//! // Softer than the linear resonance, with a second harmonic.
//! assert!(branch.is_complete() && peak.frequency_hz() < 0.995 * natural);
//! assert!(peak.harmonic_ratio() > 0.01);
//! # Ok::<(), HarmonicError>(())
//! ```

mod arc_length;
mod balance;
mod bar_modes;
mod branch;
mod contact;
mod contact_system;
mod elastic_bars;
mod error;
mod factorization;
mod floquet;
mod fourier;
mod linear_response;
mod linear_system;
mod modal_system;
mod oscillator;
mod path;
mod problem;
mod recorder;
mod response;
mod settings;
mod trace;

pub use branch::{Branch, BranchEnd, Special, SpecialPoint};
pub use contact::{Contact, Evaluation};
pub use contact_system::ContactSystem;
pub use elastic_bars::ElasticBars;
pub use error::HarmonicError;
pub use floquet::{Floquet, FloquetMethod};
pub use linear_response::linear_receptance;
pub use linear_system::{Compliance, LinearSystem, MeanBalance, Receptance};
pub use modal_system::ModalSystem;
pub use oscillator::Oscillator;
pub use path::Path;
pub use response::{PressureRange, Response};
pub use settings::{Resolution, Settings, StepControl};
pub use trace::trace;
