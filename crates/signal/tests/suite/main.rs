//! Tests against exact solutions.

#![allow(clippy::unwrap_used, reason = "the builders of test hits run in tests only")]
#![allow(clippy::print_stderr, reason = "a test without its data reports that it was skipped")]

mod averages;
mod backbones;
mod book;
mod calibration;
#[allow(dead_code, reason = "bias and range are for the printed table only")]
mod calibration_cases;
mod circles;
mod damping;
mod forms;
mod free_decays;
mod hammer;
mod harmonics;
mod hits;
mod measured;
mod noise;
mod oscillator;
mod quality;
mod receptance;
mod response_kinds;
mod robustness;
mod shared_force;
#[allow(dead_code, reason = "names of rows and columns are for the printed table only")]
#[path = "../../examples/estimators/simulation.rs"]
mod simulation;
mod statistics;
#[path = "../../examples/estimators/tables.rs"]
mod tables;
mod transform;
mod uncertainty;
mod windows;
