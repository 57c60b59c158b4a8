//! The tables of the book's page on estimators, as Markdown.

use std::fmt::Write as _;

use crate::simulation::{AVERAGE_NOISE, AVERAGE_ROWS, CASES, ROWS, Statistic};
use crate::simulation::{averages, statistics};

/// Hits of a column.
const RUNS: usize = 200;
/// Hits of an average.
const HITS: usize = 8;

/// All three tables: one hit, stated uncertainties, averages.
pub(crate) fn tables() -> String {
    let columns = CASES.map(|case| statistics(&case, RUNS, 1));
    let names = CASES.map(|case| case.name);
    let mut text = String::new();
    header(&mut text, "bias ± spread, %", &names);
    for (row, name) in ROWS.iter().enumerate() {
        line(&mut text, name, &columns.map(|column| cell(&column[row])));
    }
    text.push('\n');
    header(&mut text, "spread over what was stated", &names[1..]);
    for (row, name) in ROWS.iter().enumerate().take(8) {
        let over = |column: &[Statistic; 9]| {
            let Some(over) = column[row].over_stated else {
                return "not stated".to_owned();
            };
            format!("{over:.2}{}", part(column[row].stated))
        };
        let cells: Vec<String> = columns[1..].iter().map(over).collect();
        line(&mut text, name, &cells);
    }
    text.push('\n');
    let columns =
        AVERAGE_NOISE.map(|(_, force, response)| averages((force, response), HITS, RUNS, 2));
    let names = AVERAGE_NOISE.map(|(name, ..)| name);
    header(&mut text, &format!("{HITS} hits: bias ± spread, %"), &names);
    for (row, name) in AVERAGE_ROWS.iter().enumerate() {
        line(&mut text, name, &columns.map(|column| cell(&column[row])));
    }
    text
}

fn header(text: &mut String, first: &str, names: &[&str]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| {first} | {} |", names.join(" | "));
    let _ = writeln!(text, "|---|{}", "---|".repeat(names.len()));
}

fn line(text: &mut String, name: &str, cells: &[String]) {
    let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
}

/// Number of hits, if not all of them.
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
    // One hit has no spread.
    let spread = if statistic.found > 1 {
        format!(" ± {}", digits(statistic.spread))
    } else {
        String::new()
    };
    format!("{}{spread}{}", digits(statistic.bias), part(statistic.found))
}
