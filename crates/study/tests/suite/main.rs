//! Studies: identical bytes whatever interrupts or divides them, and what is refused.

#![allow(clippy::unwrap_used, reason = "studies of tests are valid")]
#![allow(clippy::print_stderr, reason = "a test without its tool says that it was skipped")]

mod answers;
mod memory;
mod parquet;
mod plans;
mod receptance;
mod runs;
mod support;
mod tables;
