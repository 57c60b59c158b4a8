//! Exact solutions, certified values and independent programs the crate is held to.

#![allow(clippy::unwrap_used, reason = "the builders of test models run in tests only")]

mod bounds;
mod certified;
mod chains;
mod comparisons;
mod coverage;
mod derivatives;
mod designs;
mod gaussian;
mod invalid;
mod latents;
mod minpack;
mod models;
mod posteriors;
mod ridge;
mod robust;
mod searches;
