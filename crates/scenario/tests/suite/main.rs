//! Scenario files: the accepted fixtures and the messages of the malformed ones.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod accepted;
mod malformed;
