//! Closed forms, orders of convergence and exact properties that designs and statistics are held to.

#![allow(clippy::unwrap_used, reason = "inputs of tests are valid")]

mod distributions;
mod inputs;
mod invalid;
mod quantiles;
mod sensitivity;
mod sequences;
