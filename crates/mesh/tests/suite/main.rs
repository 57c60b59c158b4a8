//! Component modes of bars and matrices.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod component_modes;
