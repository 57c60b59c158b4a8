//! Identifications against truths: twins by independent methods, judgements, laws of every form.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]
#![allow(missing_docs, unreachable_pub, dead_code, reason = "examples share the twins")]

#[path = "../support/lattice.rs"]
mod lattice;
#[path = "../support/laws.rs"]
mod laws;
#[path = "../support/losses.rs"]
mod losses;
#[path = "../support/twin.rs"]
mod twin;
#[path = "../support/wrong_models.rs"]
mod wrong_models;

mod damping_laws;
mod designs;
mod explained_models;
mod free_law;
mod identification;
mod judgement;
mod structures;
