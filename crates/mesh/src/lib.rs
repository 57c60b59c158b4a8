//! Meshes: bodies, contact interfaces and support, their finite-difference grid, and component
//! modes.
//!
//! A [`Stack`] is a chain of elastic bars, body over interface over body, down to a [`Support`].
//! Each body obeys the paper's Eq. (1),
//!
//! ```text
//! rho A (u'' + h u' - g) = d/dx (E A du/dx)
//! ```
//!
//! with E the operator `E (1 + b d/dt)` where it has [`BodyDamping`],
//! and each interface carries a pressure that depends on its closure by an
//! `asperity_law::ContactLaw`. Solvers use a stack on a [`Grid`], or the [`ComponentModes`] of any
//! structure: of bars in closed form, of mass and stiffness matrices, or given as numbers.
//!
//! | module | holds |
//! |---|---|
//! | [`body`] | one elastic bar: mass, wave speed, impedance |
//! | [`body_damping`] | internal damping of a body: Kelvin-Voigt, loss factor |
//! | [`stack`] | the chain of bodies and interfaces, and the weight on each contact |
//! | [`grid`] | the finite-difference grid with half-cell ends, and its stability limit |
//! | [`port`] | places where loads act, contacts join and sensors read |
//! | [`component_modes`] | free-interface modes with residual flexibility at ports |
//! | [`bar_modes`] | component modes of bars in closed form |
//! | [`mode_count`] | number of modes kept, by count or by error bound |
//! | [`matrix_modes`] | component modes of mass and stiffness matrices |
//! | [`sparse_body`] | a body given by sparse mass and stiffness matrices |
//! | [`reduction`] | its lowest modes, and the flexibility of all others at ports |
//! | [`bar_stiffness`] | the closed-form dynamic stiffness of a bar, for exact modes |
//!
//! The convention throughout: `x` and `u` point down, lengths in metres, forces in newtons,
//! everything else in SI units. No part of this crate evaluates a law.
//!
//! ```
//! use std::sync::Arc;
//!
//! use asperity_law::Constant;
//! use asperity_mesh::{Body, ComponentModes, Interface, ModeCount, Stack, Support};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
//! let law = Arc::new(Constant::new(8.5e11)?);
//! let contact = Interface::new("guide-disc", 1.15e-4, law)?;
//! let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
//! assert!((stack.static_pressures()[0] - 0.1373e6).abs() < 0.1e3);
//!
//! let modes = ComponentModes::of_stack(&stack, ModeCount::PerBody(3), &[])?;
//! assert_eq!(modes.modes()[0].angular_frequency, 0.0);
//! # Ok(())
//! # }
//! ```

pub mod bar_modes;
pub mod bar_stiffness;
pub mod body;
pub mod body_damping;
pub mod component_modes;
pub mod error;
pub mod grid;
pub mod matrix_modes;
pub mod mode_count;
pub mod port;
pub mod reduction;
pub mod sparse_body;
pub mod stack;

pub use bar_stiffness::BarStiffness;
pub use body::Body;
pub use body_damping::BodyDamping;
pub use component_modes::{ComponentModes, NormalMode, ResidualFlexibility, massless_forces};
pub use error::MeshError;
pub use grid::{BarGrid, Grid};
pub use mode_count::ModeCount;
pub use port::{Port, PortPair};
pub use reduction::{PortPattern, ReducedBody, RowShapes};
pub use sparse_body::SparseBody;
pub use stack::{Interface, Stack, Support, static_pressures};
