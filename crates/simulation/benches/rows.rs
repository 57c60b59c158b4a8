//! Milliseconds of a row of a study, one thread: structures of their own with and without loss of contact, and
//! forces.
//!
//! `cargo bench -p asperity-simulation --bench rows` prints one table. Each row of it is the least of several runs,
//! taken in turn.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its rig is valid")]

use std::time::Instant;

use asperity_scenario::Document;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_simulation::sweep::on_threads;
use serde_json::json;

const SCENARIO: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-power.json");
const ROUNDS: usize = 3;

/// Varied quantity, its place, its bounds, the force \[N\], and the number of rows.
const STUDIES: [(&str, &str, [f64; 2], &str, u32); 5] = [
    ("damping", "/damping/ratio", [0.02, 0.05], "9", 1024),
    ("length of the bar", "/bodies/0/length_m", [0.22, 0.24], "9", 1024),
    ("force", "/excitation/peak_n", [8.0, 10.0], "9", 4096),
    ("length of the bar", "/bodies/0/length_m", [0.22, 0.24], "32", 128),
    ("force", "/excitation/peak_n", [30.0, 34.0], "32", 128),
];

fn main() {
    let mut least = [f64::INFINITY; STUDIES.len()];
    for _ in 0..ROUNDS {
        for (least, &(_, place, [low, high], force, count)) in least.iter_mut().zip(&STUDIES) {
            let mut document = Document::read(SCENARIO).unwrap();
            document.set("/method", "modal").unwrap();
            document.set("/excitation/peak_n", force).unwrap();
            let simulator = RowSimulator::new(document, vec![vec![place.to_owned()]]).unwrap();
            let simulator = simulator.with_near_structures();
            let value = |row: u32| low + (high - low) * (f64::from(row) + 0.5) / f64::from(count);
            let rows: Vec<_> = (0..count).map(|row| vec![json!(value(row))]).collect();
            let started = Instant::now();
            let found = on_threads(Some(1), || simulator.run(&rows)).unwrap();
            *least = least.min(started.elapsed().as_secs_f64() / f64::from(count));
            assert!(found.iter().all(Result::is_ok));
        }
    }
    println!("| varied | force [N] | rows | ms a row |");
    println!("|---|---|---|---|");
    for (least, (name, _, _, force, count)) in least.iter().zip(&STUDIES) {
        println!("| {name} | {force} | {count} | {:.3} |", 1e3 * least);
    }
}
