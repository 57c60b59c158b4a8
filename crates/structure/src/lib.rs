//! Structures with contacts at rest under their preload.
//!
//! A [`Stack`](asperity_mesh::Stack) of bodies rests under its own weight. Every contact then
//! carries a static pressure `p0`, and the motion `w` about that state obeys
//!
//! ```text
//! M w'' + h M w' + k w = f(t) - sum_i S_i (p_i(d_i) - p_i0) (e_above - e_below)
//! ```
//!
//! so that gravity, the static strain and the static pressures cancel exactly. A
//! [`PreloadedStructure`] is that state: mesh, contacts at rest, and mass-proportional damping `h`,
//! built once for every solver. Linearised about rest, contacts being springs `K(p0) S`, it has
//! [natural frequencies and modes](PreloadedStructure::modes).
//!
//! | module | holds |
//! |---|---|
//! | [`preloaded`] | mesh, contacts at rest and damping as one value |
//! | [`contact`] | one contact at rest |
//! | [`equilibrium`] | nonlinear static equilibrium of a stack under weight |
//! | [`patch_equilibrium`] | nonlinear static equilibrium of any structure in component modes |
//! | [`linearised`] | linearised modes of any structure in component modes |
//! | [`damping`] | damping of the bodies and its document form |
//! | [`guide`] | a guide with friction |
//! | [`time_function`] | pulses, sines and samples over time, of unit amplitude |
//! | [`load_case`] | a function of time, its amplitude, and the port or base that it acts on |
//! | [`excitation`], [`place`] | excitations, places and sensors as documents give them |
//! | [`modal_damping`] | damping ratios of linearised modes |
//! | [`modes`] | linearised natural frequencies and shapes, exact for elastic bars |
//! | [`error`] | errors |

pub mod contact;
pub mod damping;
pub mod equilibrium;
pub mod error;
pub mod excitation;
pub mod guide;
pub mod linearised;
pub mod load_case;
pub mod modal_damping;
pub mod modes;
pub mod patch_equilibrium;
pub mod place;
pub mod preloaded;
pub mod time_function;

pub use contact::PreloadedContact;
pub use damping::{
    Damping, DampingSpec, ModalDampingSpec, RatioAtFrequency, RayleighFault, RayleighSpec,
};
pub use equilibrium::StaticDisplacement;
pub use error::StructureError;
pub use excitation::{
    AccelerationSpec, DisplacementSpec, ExcitationSpec, SamplesFile, VelocitySpec,
};
pub use guide::Guide;
pub use linearised::PortMode;
pub use load_case::{BaseQuantity, LoadCase};
pub use modal_damping::DampedMode;
pub use modes::LinearisedMode;
pub use patch_equilibrium::{StaticState, UnloadedContact, contacts_at_rest, static_state};
pub use place::{Along, End, PlaceSpec, SensorKind, SensorSpec};
pub use preloaded::PreloadedStructure;
pub use time_function::{Order, SampledFunction, SteppedSine, TimeFunction};
