//! Studies: identical bytes whatever interrupts or divides them, and what is refused.

#![allow(clippy::unwrap_used, reason = "studies of tests are valid")]

mod answers;
mod plans;
mod runs;
mod support;
