//! A live page of a scenario, served to the browser of the same machine or shown in a notebook.
//!
//! ```text
//! page: changes of numbers -> server: scenario with the changes -> simulation -> figures of `plot` -> page
//! ```
//!
//! The state of the page is a list of changes, each a JSON Pointer with its value, as `--set` takes them. A
//! request computes one `Part` of the results for one state and has its pictures drawn; a
//! newer request of the same page for the same part stops the older one.
//!
//! | module | holds |
//! |---|---|
//! | `explorer` | a page and its answers, whatever carries them |
//! | `server` | the server: addresses, checks of requests |
//! | `message` | requests and answers |
//! | `jobs` | the newest request of a part wins |
//! | `state` | the scenario with its changes |
//! | `controls` | numbers and choices of a scenario, by its schema |
//! | `settings` | force levels and frequency ranges, which are not part of a scenario |
//! | `session` | answers to requests |
//! | `computation` | results and figures of a part |
//! | `commands` | a state as command lines |
//! | `measured` | measured hits beside computed ones |
//! | `keep` | files of a state |
//! | `page` | HTML, style and script |
//!
//! # Safety of the server
//! It listens on the loopback address alone. Its address holds a random token of 128 bits; requests with
//! another `Host`, or from pages of another origin, are refused. A change may hold no text that is not in the
//! scenario or its schema, so that no file is read but the scenario's own.

mod commands;
mod computation;
mod controls;
mod explorer;
mod jobs;
mod keep;
mod measured;
mod message;
mod page;
mod server;
mod session;
mod settings;
mod state;

pub use explorer::{ExploreError, ExploreOptions, Explorer, Reply};
pub use server::Server;
