//! The structure between the contacts: bodies, interfaces, support, and the
//! finite-difference grid on which they move.
//!
//! A [`Stack`] is a chain of elastic bars, body over interface over body, down
//! to a [`Support`]. Each body obeys the paper's Eq. (1),
//!
//! ```text
//! rho A (u'' + h u' - g) = d/dx (E A du/dx)
//! ```
//!
//! and each interface carries a pressure that depends on its closure through
//! an `asperity_law::ContactLaw`. This crate never looks inside a law: it
//! stores it, and hands it on.
//!
//! | module | holds |
//! |---|---|
//! | [`body`] | one elastic bar: mass, wave speed, impedance |
//! | [`stack`] | the chain of bodies and interfaces, and the weight each contact carries |
//! | [`grid`] | the finite-difference grid with half-cell ends, and its stability limit |
//! | [`structure`] | mass, stiffness and named points of a discretised structure, whatever its origin |
//! | [`component_modes`] | modes, residual flexibility and named points, whatever their origin |
//! | [`bar`] | the closed-form dynamic stiffness of a bar, for exact modes |
//!
//! The convention throughout: `x` and `u` point down, lengths in metres,
//! forces in newtons, everything else in SI units.

pub mod bar;
pub mod body;
pub mod component_modes;
pub mod error;
pub mod grid;

pub mod stack;
pub mod structure;

pub use bar::BarStiffness;
pub use body::Body;
pub use component_modes::{ComponentModes, ModeCount, NormalMode, ResidualFlexibility};
pub use error::MeshError;
pub use grid::{BarGrid, Grid};
pub use stack::{Interface, Stack, Support, static_pressures};
pub use structure::{ContactPair, LinearStructure};
