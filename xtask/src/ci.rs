//! `cargo xtask ci`: the checks that a change must pass before it is merged.
//!
//! Each step runs to its end with its output untouched, followed by a line with its outcome and
//! time. The first failure ends the run.

use std::cell::Cell;
use std::io::Write;
use std::thread::{self, JoinHandle};
use std::time::Instant;

use anyhow::{Context, Result, bail};

use crate::workspace::cargo;
use crate::{package, python, tidy};

/// Steps of the inner loop, as arguments of cargo.
const QUICK: [(&str, &str); 4] = [
    ("fmt", "fmt --all --check"),
    // With the features of the whole run, which then compiles nothing again.
    ("clippy", "clippy --workspace --all-targets --all-features -- -D warnings"),
    ("unit tests", "test --workspace --all-features --lib --bins --quiet"),
    ("tidy", "xtask tidy"),
];

/// Steps of the whole run, as arguments of cargo.
const ALL: [(&str, &str); 12] = [
    ("fmt", "fmt --all --check"),
    ("clippy", "clippy --workspace --all-targets --all-features -- -D warnings"),
    ("clippy, no features", "clippy --workspace --no-default-features -- -D warnings"),
    // Without target selection this includes the doc tests.
    ("test", "test --workspace --all-features"),
    // With the features of all other packages as above, so that these are not compiled again.
    ("test, no features", "test --package asperity-measure --package workspace-features"),
    ("doc", "doc --workspace --no-deps --all-features"),
    ("package", "xtask package"),
    ("python", "xtask python"),
    ("tidy", "xtask tidy"),
    ("reproduce --check", "xtask reproduce --check"),
    ("cases", "xtask campaign --cases fixtures/cases"),
    ("campaign", "xtask campaign --count 20 --seed 1"),
];

/// Seed of the random cases of tests.
const RANDOM_SEED: &str = "PROPTEST_RNG_SEED";

/// Runs every step up to the first failure; true if all passed. `tasks` is the command line of
/// xtask. With `quick` only the steps of the inner loop run: format, lints, unit tests, tidy.
pub(crate) fn run(quick: bool, tasks: &clap::Command) -> Result<bool> {
    let steps: &[(&str, &str)] = if quick { &QUICK } else { &ALL };
    // Registries are asked while compilers work.
    let environment = Cell::new((!quick).then(|| thread::spawn(python::prepare)));
    let archives = Cell::new((!quick).then(|| thread::spawn(package::pack)));
    let check = |name: &str, arguments: &str| match name {
        "tidy" => tidy::run(tasks),
        "package" => Ok(finished(&archives)? && package::check()?),
        "python" => python::run(finished(&environment)?.as_ref()),
        _ => run_cargo(name, arguments),
    };
    run_steps(steps, check, &mut std::io::stdout())
}

/// The outcome of a thread that one step alone takes.
fn finished<T>(thread: &Cell<Option<JoinHandle<Result<T>>>>) -> Result<T> {
    let thread = thread.take().context("its thread was not begun")?;
    thread.join().unwrap_or_else(|_| bail!("its thread panicked"))
}

/// Runs cargo with `arguments`, separated by spaces; true if it succeeds.
fn run_cargo(step: &str, arguments: &str) -> Result<bool> {
    let mut command = cargo(&arguments.split(' ').collect::<Vec<_>>());
    if step == "doc" {
        command.env("RUSTDOCFLAGS", "-D warnings");
    }
    // The same random cases in each run: a change is judged, not the day. New ones come at night.
    if step.starts_with("test") && std::env::var_os(RANDOM_SEED).is_none() {
        command.env(RANDOM_SEED, "1");
    }
    let status = command.status().with_context(|| format!("cannot run cargo {arguments}"))?;
    Ok(status.success())
}

fn run_steps(
    steps: &[(&str, &str)],
    check: impl Fn(&str, &str) -> Result<bool>,
    out: &mut impl Write,
) -> Result<bool> {
    let started = Instant::now();
    for (number, (name, arguments)) in steps.iter().enumerate() {
        let step_started = Instant::now();
        writeln!(out, "ci: {name} ...")?;
        out.flush()?;
        let passed = check(name, arguments).unwrap_or_else(|error| {
            eprintln!("error: {error:#}");
            false
        });
        let outcome = if passed { "ok" } else { "FAILED" };
        let seconds = step_started.elapsed().as_secs_f64();
        writeln!(out, "ci: {name} {outcome} ({seconds:.1} s)")?;
        if !passed {
            let left = steps.len() - number - 1;
            writeln!(out, "ci: FAILED at {name}, {left} steps not run")?;
            return Ok(false);
        }
    }
    let seconds = started.elapsed().as_secs_f64();
    writeln!(out, "ci: all {} steps ok ({seconds:.1} s)", steps.len())?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    fn outcome(outcomes: &[(&'static str, bool)]) -> (bool, Vec<String>, String) {
        let steps: Vec<(&str, &str)> = outcomes.iter().map(|&(name, _)| (name, "")).collect();
        let ran = RefCell::new(Vec::new());
        let check = |name: &str, _: &str| {
            ran.borrow_mut().push(name.to_owned());
            Ok(outcomes.contains(&(name, true)))
        };
        let mut out = Vec::new();
        let passed = run_steps(&steps, check, &mut out).unwrap();
        (passed, ran.into_inner(), String::from_utf8(out).unwrap())
    }

    #[test]
    fn the_first_failure_ends_the_run() {
        let (passed, ran, out) = outcome(&[("one", true), ("two", false), ("three", true)]);
        assert!(!passed);
        assert_eq!(ran, ["one", "two"]);
        assert!(out.contains("ci: one ok ("), "{out}");
        assert!(out.contains("ci: two FAILED ("), "{out}");
        assert!(out.ends_with("ci: FAILED at two, 1 steps not run\n"), "{out}");
    }

    #[test]
    fn every_step_runs_when_all_pass() {
        let (passed, ran, out) = outcome(&[("one", true), ("two", true)]);
        assert!(passed);
        assert_eq!(ran, ["one", "two"]);
        assert!(out.contains("ci: all 2 steps ok ("), "{out}");
    }
}
