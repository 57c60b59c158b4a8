//! Exact solutions the crate is held to.

#![allow(clippy::unwrap_used, reason = "the builders of test hits run in tests only")]

mod damping;
mod forms;
mod harmonics;
mod oscillator;
mod receptance;
mod robustness;
mod transform;
