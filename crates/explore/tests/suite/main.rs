//! The server as a browser sees it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

mod client;
mod computed;
mod controls;
mod guarded;
mod kept;
mod matrices;
mod measured;
mod script;
