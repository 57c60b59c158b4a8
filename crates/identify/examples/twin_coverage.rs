//! Coverage of the bands of an identification, by repeated simulated measurements.
//!
//! `cargo run --release -p asperity-identify --example twin_coverage -- write FILE` writes the problem of
//! `fixtures/problems/twin.json`, and `... -- REPETITIONS [HITS [FIRST]]`
//! simulates hits of the paper's rig by finite differences, 9 to 32 N, gives them the noise (40 dB)
//! and the gain errors (5 %) of sensors, identifies the law with the modal engine, and counts.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "its problems are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its answer")]
#![allow(missing_docs, unreachable_pub, reason = "the twin is shared with the tests")]

#[path = "../tests/support/twin.rs"]
mod twin;

use std::time::Instant;

use asperity_identify::identify;
use asperity_law::{ContactLaw, ModifiedPower};
use serde_json::json;
use twin::{FINE_CELL, Noise, Sensors, Truth};

const SCENARIO: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [word, file] = arguments.as_slice()
        && word == "write"
    {
        return write_problem(file);
    }
    let mut words = arguments.iter().map(|word| word.parse::<usize>().unwrap());
    let repetitions = words.next().unwrap_or(10);
    let count = words.next().unwrap_or(24);
    let first = words.next().unwrap_or(0);
    let peaks: Vec<f64> =
        (0..count).map(|i| 9.0 + 23.0 * i as f64 / (count - 1).max(1) as f64).collect();
    let truth = Truth::new(SCENARIO, &peaks, &[("/output_rate_hz", "50000"), FINE_CELL]);
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let law = ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots).unwrap();
    let unknowns = json!([
        {"kind": "monotone_law", "law": "modified"},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.005, 0.2], "start": 0.03},
        {"kind": "gain", "channel": "force", "prior": {"value": 1, "relative": 0.05}},
        {"kind": "gain", "channel": "response", "prior": {"value": 1, "relative": 0.05}},
    ]);
    let more = json!({"pressures_pa": [0.02e6, 0.25e6]});
    let mut noise = Noise::new(7);
    let (mut inside, mut asked, mut worst) = (0_u32, 0_u32, Vec::new());
    for repetition in 0..repetitions {
        let sensors = Sensors {
            signal_to_noise_db: 40.0,
            force_gain: (0.05 * noise.normal()).exp(),
            response_gain: (0.05 * noise.normal()).exp(),
            seed: 1000 + repetition as u64,
        };
        if repetition < first {
            continue;
        }
        let problem = truth.problem(&truth.measured(&sensors), &unknowns, &more);
        let started = Instant::now();
        let found = identify(&problem).unwrap();
        let band = &found.law;
        let mut off = 0.0_f64;
        let (mut here, mut of) = (0, 0);
        for (i, &pressure) in band.pressure.iter().enumerate() {
            let exact = law.stiffness(pressure);
            if band.informed[i] {
                off = off.max((band.median[i] / exact - 1.0).abs());
                of += 1;
                here += u32::from((band.lower[i]..=band.upper[i]).contains(&exact));
            }
        }
        inside += here;
        asked += of;
        worst.push(off);
        let diagnostics = &found.posterior.diagnostics;
        println!(
            "{repetition:>4}: gains {:.3} {:.3}, K off by at most {:.2} %, {here} of {of} inside, informed {:?} MPa, chi2 {:.0}/{}, {:?}, {:.0} of {} draws, {} rounds, {:.1} s",
            sensors.force_gain,
            sensors.response_gain,
            100.0 * off,
            band.informed_range().map(|range| range.map(|p| (1e-3 * p).round() / 1e3)),
            found.covariance.goodness.chi_square,
            found.covariance.goodness.degrees_of_freedom,
            found.pressure_dependence(),
            diagnostics.effective_draws,
            found.posterior.draws.len(),
            diagnostics.rounds,
            started.elapsed().as_secs_f64(),
        );
        if repetition == first {
            for sentence in found.conclusions() {
                println!("      {sentence}");
            }
            for estimate in found.estimates() {
                println!("      {estimate:?}");
            }
        }
    }
    assert!(!worst.is_empty(), "FIRST must be less than REPETITIONS");
    worst.sort_by(f64::total_cmp);
    println!(
        "K(p) inside its 95 % band at {:.1} % of {asked} informed pressures in {} repetitions; largest error, median {:.2} %, worst {:.2} %",
        100.0 * f64::from(inside) / f64::from(asked.max(1)),
        worst.len(),
        100.0 * worst[worst.len() / 2],
        100.0 * worst[worst.len() - 1],
    );
}

/// Twelve hits with sensors 4 % and -3 % off, as a problem to try.
fn write_problem(file: &str) {
    let peaks: Vec<f64> = (0..12).map(|i| 9.0 + 23.0 * f64::from(i) / 11.0).collect();
    let truth = Truth::new(SCENARIO, &peaks, &[("/output_rate_hz", "50000"), FINE_CELL]);
    let sensors =
        Sensors { signal_to_noise_db: 40.0, force_gain: 1.04, response_gain: 0.97, seed: 1 };
    let problem = json!({
        "schema": "asperity/identify/1",
        "title": "Twelve hits simulated by finite differences, 40 dB, sensors 4 % and -3 % off",
        "scenario": "../scenarios/nouira2020-modified.json",
        "unknowns": [
            {"kind": "monotone_law", "law": "modified"},
            {"kind": "gain", "channel": "force", "prior": {"value": 1, "relative": 0.05}},
            {"kind": "gain", "channel": "response", "prior": {"value": 1, "relative": 0.05}},
        ],
        "pressures_pa": [0, 0.25e6],
        "compare": [
            {"name": "power law",
             "set": {"/laws/modified": {"kind": "power", "coefficient": 1.8e10, "exponent": 0.35}},
             "unknowns": [
                {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e8, 1e12]},
                {"kind": "scalar", "pointer": "/laws/modified/exponent", "bounds": [0.05, 1.5]}]},
            {"name": "exponential law",
             "set": {"/laws/modified": {"kind": "exponential", "length_m": 1.4e-7}},
             "unknowns": [
                {"kind": "scalar", "pointer": "/laws/modified/length_m", "bounds": [1e-8, 1e-6]}]},
        ],
        "design": {"force_peak_n": [5, 10, 20, 40], "set": [{}, {"/bodies/0/mass_kg": 0.8}]},
        "data": twin::data(&truth.measured(&sensors)),
    });
    std::fs::write(file, format!("{problem:#}\n")).unwrap();
}
