//! Equilibrium, modes and component modes against exact results and second methods.
#![allow(clippy::print_stderr, reason = "a test without its data says that it was skipped")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod equilibrium;
mod finite_elements;
#[path = "../../../mesh/tests/suite/linear_structure.rs"]
mod linear_structure;
mod modes;
mod rigs;
