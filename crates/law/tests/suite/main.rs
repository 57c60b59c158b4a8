//! Contact laws: one conformance suite for all, reference values, compiled tables, invalid laws.

#![allow(clippy::unwrap_used, reason = "a test that cannot build its law panics")]

mod compiled;
mod conformance;
mod friction;
mod gap_table;
mod invalid;
mod laws;
mod laws_in_series;
mod overclosure;
mod reference;
mod relative_table;
mod rough_surfaces;
