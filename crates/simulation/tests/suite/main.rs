//! Whole scenarios against closed forms, references and second methods.
#![allow(clippy::print_stderr, reason = "a test without its data says that it was skipped")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[path = "../../../../xtask/src/hexahedron.rs"]
mod hexahedron;

mod accuracy;
mod bars_and_matrices;
mod brake_reuss;
mod bricks;
mod contact_path;
mod finite_elements;
mod instants;
mod many_cells;
mod masked_peaks;
mod output_rate;
mod ports;
mod samples;
mod sensitivity;
mod steady;
mod structures;
mod sweep;
