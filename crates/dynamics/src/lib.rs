//! Time integration of preloaded structures with implicit contact.
//!
//! A [`PreloadedStructure`](asperity_structure::PreloadedStructure) answers an [`Excitation`] with
//! a [`Transient`]. All integrators work with the perturbation about static equilibrium,
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
//! | [`difference`] | the derivative of a closed form from four values |
//! | [`excitation`] | the hammer's pulse, the shaker's sine, a measured record |
//! | [`finite_difference`] | the paper's explicit scheme, Eqs. (2) to (5) |
//! | [`modal`] | exact modal steps with implicit contact, many hits in vector lanes |
//! | [`integrator`] | the choice of integrator |
//! | [`transient`] | what every integrator returns: history, contact record, energy ledger |

pub mod difference;
pub mod error;
pub mod excitation;
pub mod finite_difference;
pub mod instruction_set;
pub mod integrator;
pub mod modal;
pub mod transient;

pub use difference::{RELATIVE_STEP, STENCIL, central_difference};
pub use error::DynamicsError;
pub use excitation::{Excitation, ForceRecord};
pub use finite_difference::{ContactForm, FiniteDifference};
pub use instruction_set::InstructionSet;
pub use integrator::{Integrator, RunOutline};
pub use modal::{
    Batch, ContactMeasures, Course, Hit, HitRecord, Modal, ModalRig, Sensitivity, Thinning,
    Variation,
};
pub use transient::{ContactRecord, EnergyLedger, History, InterfaceHistory, Sampling, Transient};
