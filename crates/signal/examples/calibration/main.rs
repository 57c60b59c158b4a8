//! Scatter of the features of simulated hits over the standard deviations stated for them.
//!
//! ```console
//! $ cargo run -p asperity-signal --release --example calibration -- 500
//! ```
//!
//! One row for each quantity, and a column for each noise level: the ratio, in brackets the hits in
//! which both exist.

#![allow(clippy::print_stdout, reason = "printing the tables is all this program does")]
#![allow(clippy::unwrap_used, reason = "the cases are valid")]

#[path = "../../tests/suite/calibration_cases.rs"]
mod calibration_cases;
#[path = "../../tests/suite/noise.rs"]
mod noise;
#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../../tests/suite/oscillator.rs"]
mod oscillator;

use calibration_cases::{Case, QUANTITIES, scatter};

const LEVELS_DB: [f64; 5] = [20.0, 30.0, 40.0, 50.0, 60.0];

fn main() {
    let runs = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(500);
    for (name, damping, quadratic, length_s) in [
        ("damping 3.5 %, linear, 1 s", 0.035, 0.0, 1.0),
        ("damping 3.5 %, quadratic, 0.12 s", 0.035, 0.25, 0.12),
        ("damping 1 %, quadratic, 1 s", 0.01, 0.12, 1.0),
    ] {
        println!("\n{name}\n");
        let columns = LEVELS_DB.map(|signal_to_noise_db| {
            let case = Case { damping, quadratic, length_s, signal_to_noise_db };
            scatter(&case, runs, 2026)
        });
        print!("| quantity |");
        for level in LEVELS_DB {
            print!(" {level} dB |");
        }
        println!("\n|---|---|---|---|---|---|");
        for (n, quantity) in QUANTITIES.iter().enumerate() {
            print!("| {quantity} |");
            for column in &columns {
                let one = &column[n];
                print!(
                    " {:.2} ({}; bias {:.1}, stated {:.1e}, range {:.1}) |",
                    one.over_stated, one.hits, one.bias, one.relative, one.range
                );
            }
            println!();
        }
    }
}
