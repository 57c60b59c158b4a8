//! Bias and spread of every estimator on simulated hits, as Markdown tables.
//!
//! ```console
//! $ cargo run -p asperity-signal --release --example estimators
//! ```

#![allow(clippy::print_stdout, reason = "printing the tables is all this program does")]

#[path = "../../tests/suite/noise.rs"]
mod noise;
mod simulation;

use simulation::{AVERAGE_NOISE, AVERAGE_ROWS, CASES, ROWS, Statistic, averages, statistics};

/// Hits of a column.
const RUNS: usize = 200;
/// Hits of an average.
const HITS: usize = 8;

fn main() {
    let columns = CASES.map(|case| statistics(&case, RUNS, 1));
    let header = |first: &str, names: &[&str]| {
        println!("| {first} | {} |", names.join(" | "));
        println!("|---|{}", "---|".repeat(names.len()));
    };
    let names = CASES.map(|case| case.name);
    header("bias ± spread, %", &names);
    for (row, name) in ROWS.iter().enumerate() {
        let cells = columns.map(|column| cell(&column[row]));
        println!("| {name} | {} |", cells.join(" | "));
    }
    println!();
    header("spread over what was stated", &names[1..7]);
    for (row, name) in ROWS.iter().enumerate().take(5) {
        let over = |column: &[Statistic; 9]| {
            let Some(over) = column[row].over_stated else {
                return "not stated".to_owned();
            };
            format!("{over:.2}{}", part(column[row].stated))
        };
        let cells: Vec<String> = columns[1..7].iter().map(over).collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
    println!();
    let columns =
        AVERAGE_NOISE.map(|(_, force, response)| averages((force, response), HITS, RUNS, 2));
    header(&format!("{HITS} hits: bias ± spread, %"), &AVERAGE_NOISE.map(|(name, ..)| name));
    for (row, name) in AVERAGE_ROWS.iter().enumerate() {
        let cells = columns.map(|column| cell(&column[row]));
        println!("| {name} | {} |", cells.join(" | "));
    }
}

/// How many hits, where it is not all of them.
fn part(found: usize) -> String {
    if found < RUNS { format!(" ({found} of {RUNS})") } else { String::new() }
}

fn cell(statistic: &Statistic) -> String {
    if statistic.found == 0 {
        return "none".into();
    }
    let digits = |x: f64| {
        let percent = 100.0 * x;
        if percent.abs() < 1e-3 { "0".to_owned() } else { format!("{percent:.3}") }
    };
    format!("{} ± {}{}", digits(statistic.bias), digits(statistic.spread), part(statistic.found))
}
