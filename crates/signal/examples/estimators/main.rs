//! Bias and spread of every estimator on simulated hits, as Markdown tables.
//!
//! ```console
//! $ cargo run -p asperity-signal --release --example estimators
//! ```

#![allow(clippy::print_stdout, reason = "printing the tables is all this program does")]

#[path = "../../tests/suite/noise.rs"]
mod noise;
mod simulation;
mod tables;

fn main() {
    print!("{}", tables::tables());
}
