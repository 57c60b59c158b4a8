//! Component modes of bars and matrices; matrices of a grid.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod component_modes;
mod grid_matrices;
mod linear_structure;
mod reduction;
