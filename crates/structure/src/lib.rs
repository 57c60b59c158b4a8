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
//! | [`damping`] | damping of the bodies and its document form |
//! | [`guide`] | a guide with friction |
//! | [`modal_damping`] | damping ratios of linearised modes |
//! | [`modes`] | linearised natural frequencies and shapes, exact for elastic bars |
//! | [`error`] | errors |

pub mod contact;
pub mod damping;
pub mod equilibrium;
pub mod error;
pub mod guide;
pub mod modal_damping;
pub mod modes;
pub mod preloaded;

pub use contact::PreloadedContact;
pub use damping::{
    Damping, DampingSpec, ModalDampingSpec, RatioAtFrequency, RayleighFault, RayleighSpec,
};
pub use equilibrium::StaticDisplacement;
pub use error::StructureError;
pub use guide::Guide;
pub use modal_damping::DampedMode;
pub use modes::LinearisedMode;
pub use preloaded::PreloadedStructure;
