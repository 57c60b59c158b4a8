//! Time integration of preloaded structures with implicit contact.
//!
//! A [`PreloadedStructure`](asperity_structure::PreloadedStructure) under a
//! [`LoadCase`](asperity_structure::LoadCase) gives a [`Transient`]. All integrators work with the perturbation about static equilibrium,
//!
//! ```text
//! M w'' + h M w' + k w = f(t) - sum_i S_i (p_i(d_i) - p_i0) (e_above - e_below)
//! ```
//!
//! so gravity, the static strain and the static pressures cancel exactly and
//! a structure without excitation stays at rest to the last bit.
//!
//! ```
//! use std::sync::Arc;
//!
//! use asperity_dynamics::{Integrator, Sampling};
//! use asperity_law::Power;
//! use asperity_mesh::{Body, Interface, Port, Stack, Support};
//! use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
//! let law = Arc::new(Power::new(1.81e10, 0.35, 0.0)?);
//! let contact = Interface::new("guide-disc", 1.15e-4, law)?;
//! let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
//! let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
//!
//! let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 9.0);
//! let sampling = Sampling::new(0.02, 2e5)?;
//! let response = Integrator::default().integrate(&structure, &pulse, &[Port::TOP], &sampling)?;
//! assert_eq!(response.history.sensors[0].displacement.len(), 4000);
//! assert!(response.contacts[0].pressure_min < structure.contacts()[0].pressure());
//! # Ok(())
//! # }
//! ```
//!
//! | module | holds |
//! |---|---|
//! | [`difference`] | the derivative of a closed form from four values |
//! | [`finite_difference`] | the paper's explicit scheme, Eqs. (2) to (5) |
//! | [`modal`] | exact modal steps with implicit contact, many cases in vector lanes |
//! | [`integrator`] | the choice of integrator |
//! | [`run_bounds`] | the largest runs |
//! | [`transient`] | result of a run: history, contact extremes, energy ledger |

mod contact_energy;
pub mod difference;
pub mod error;
pub mod finite_difference;
mod friction_force;
pub mod instruction_set;
pub mod integrator;
pub mod modal;
pub mod run_bounds;
pub mod transient;

pub use difference::{RELATIVE_STEP, STENCIL, central_difference};
pub use error::DynamicsError;
pub use finite_difference::{ContactForm, FiniteDifference};
pub use instruction_set::InstructionSet;
pub use integrator::Integrator;
pub use modal::{
    Batch, COARSE_RESIDUAL, CaseResponse, ContactMeasures, ContactsResponse, ContactsState,
    Decimation, MOST_CONTACTS, ManyContacts, Modal, ModalModel, ParameterVariation, PeriodicMotion,
    Sensitivity, StepHistory, TransientCase,
};
pub use run_bounds::RunOutline;
pub use transient::{
    ContactExtremes, EnergyLedger, History, InterfaceHistory, Sampling, SensorHistory, Transient,
};
