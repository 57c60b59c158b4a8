//! How a stack of bodies moves: static equilibrium, linearised modes, and time
//! integration with implicit contact.
//!
//! A [`Stack`](asperity_mesh::Stack) rests under its own weight
//! ([`Equilibrium`]), vibrates about that state at its linearised natural
//! frequencies ([`modes`](mod@modes)), and answers an [`Excitation`] with a [`Transient`].
//! All integrators work with the perturbation about static equilibrium,
//!
//! ```text
//! M w'' + h M w' + k w = f(t) - sum_i S_i (p_i(d_i) - p_i0) (e_above - e_below)
//! ```
//!
//! so gravity, the static strain and the static pressures cancel exactly and
//! an unstruck rig stays at rest to the last bit.
//!
//! | module | holds |
//! |---|---|
//! | [`equilibrium`] | nonlinear static equilibrium |
//! | [`modes`](mod@modes) | natural frequencies and shapes, exact for elastic bars |
//! | [`grid_modes`] | the same from a discretised structure, by a dense eigensolver |
//! | [`damping`] | mass-proportional viscosity from a damping ratio |
//! | [`difference`] | the derivative of a closed form from four values |
//! | [`excitation`] | the hammer's pulse, the shaker's sine, a measured record |
//! | [`finite_difference`] | the paper's explicit scheme, Eqs. (2) to (5) |
//! | [`modal`] | exact modal steps with implicit contact, many hits in vector lanes |
//! | [`integrator`] | either integrator behind one face |
//! | [`transient`] | what every integrator returns: history, contact record, energy ledger |

pub mod damping;
pub mod difference;
pub mod equilibrium;
pub mod error;
pub mod excitation;
pub mod finite_difference;
pub mod grid_modes;
pub mod instruction_set;
pub mod integrator;
pub mod modal;
pub mod modes;
pub mod transient;

pub use damping::Damping;
pub use difference::{RELATIVE_STEP, STENCIL, central_difference};
pub use equilibrium::{Equilibrium, StaticContact};
pub use error::DynamicsError;
pub use excitation::{Excitation, ForceRecord};
pub use finite_difference::{ContactForm, FiniteDifference};
pub use grid_modes::grid_frequencies;
pub use instruction_set::InstructionSet;
pub use integrator::{Integrator, Outline};
pub use modal::{
    Batch, ContactMeasures, Course, Hit, HitRecord, Modal, ModalContact, ModalRig, Sensitivity,
    Thinning, Variation,
};
pub use modes::{Mode, modes};
pub use transient::{ContactRecord, EnergyLedger, History, InterfaceHistory, Sampling, Transient};
