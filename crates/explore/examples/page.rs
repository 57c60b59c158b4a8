//! Serves the page of a scenario until the program is ended:
//! `cargo run -p asperity-explore --example page -- rig.json [analysis.json]`.
#![allow(clippy::print_stdout, reason = "an example shows its address")]

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_explore::{ExploreOptions, Server};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let scenario = arguments.next().ok_or("the scenario is missing")?;
    let mut options = ExploreOptions::default();
    options.data = arguments.next();
    let server = Server::open(&scenario, &options)?;
    println!("{}", server.url());
    server.run(&Arc::new(AtomicBool::new(false)))?;
    Ok(())
}
