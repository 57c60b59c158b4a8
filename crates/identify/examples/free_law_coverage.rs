//! Coverage of the bands of a free law on twins whose true laws are of other families than its prior.
//!
//! `cargo run --release -p asperity-identify --example free_law_coverage -- TWINS [HITS [FIRST]]`
//! simulates hits of the paper's rig by finite differences, 9 to 32 N, with laws of six families in
//! turn (modified power laws with random knots, shoulders, bumps, exponential, hyperbolic, kinks),
//! gives them the noise (40 dB) and the gain errors (5 %) of sensors, identifies a free law about a
//! power law, with damping and gains unknown, by the modal engine, and counts.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "its problems are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its answer")]
#![allow(missing_docs, unreachable_pub, reason = "the twin is shared with the tests")]

#[path = "../tests/support/laws.rs"]
mod laws;
#[path = "../tests/support/twin.rs"]
mod twin;

use std::time::Instant;

use asperity_identify::{Identification, identify};
use asperity_law::{ContactLaw, Tabulated};
use asperity_scenario::Document;
use serde_json::json;
use twin::{Noise, Sensors, Truth};

const SCENARIO: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");

/// Informed pressures, those inside the 95 % band and inside the 50 % band.
fn counts(found: &Identification, truth: &Tabulated) -> [usize; 3] {
    let band = &found.law;
    let mut counts = [0; 3];
    for (i, &pressure) in band.pressure.iter().enumerate().filter(|(i, _)| band.informed[*i]) {
        let exact = truth.stiffness(pressure);
        let [first, third] = &band.quartiles;
        counts[0] += 1;
        counts[1] += usize::from((band.lower[i]..=band.upper[i]).contains(&exact));
        counts[2] += usize::from((first[i]..=third[i]).contains(&exact));
    }
    counts
}

fn main() {
    let mut words = std::env::args().skip(1).map(|word| word.parse::<usize>().unwrap());
    let twins = words.next().unwrap_or(6);
    let count = words.next().unwrap_or(24);
    let first = words.next().unwrap_or(0);
    let peaks: Vec<f64> =
        (0..count).map(|i| 9.0 + 23.0 * i as f64 / (count - 1).max(1) as f64).collect();
    let unknowns = json!([
        {"kind": "free_law", "law": "modified"},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.005, 0.2], "start": 0.03},
        {"kind": "gain", "channel": "force", "prior": {"value": 1, "relative": 0.05}},
        {"kind": "gain", "channel": "response", "prior": {"value": 1, "relative": 0.05}},
    ]);
    let mut document = Document::read(SCENARIO).unwrap();
    document.set("/method", r#"{"kind": "modal", "step_s": 2e-5}"#).unwrap();
    document.set("/output_rate_hz", "50000").unwrap();
    let power = r#"{"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}"#;
    document.set("/laws/modified", power).unwrap();
    let more = json!({"pressures_pa": [0.02e6, 0.3e6], "scenario": document.value()});
    let mut all = [0; 3];
    let mut per_twin = Vec::new();
    for number in first..twins {
        let mut noise = Noise::new(100 + number as u64);
        let family = laws::FAMILIES[number % laws::FAMILIES.len()];
        let points = laws::law(family, &mut noise);
        let truth = Tabulated::new(&points).unwrap();
        let written = laws::written(&points).to_string();
        let sensors = Sensors {
            signal_to_noise_db: 40.0,
            force_gain: (0.05 * noise.normal()).exp(),
            response_gain: (0.05 * noise.normal()).exp(),
            seed: 1000 + number as u64,
        };
        let started = Instant::now();
        let changes = [("/output_rate_hz", "50000"), ("/laws/modified", written.as_str())];
        let twin = Truth::new(SCENARIO, &peaks, &changes);
        let simulated = started.elapsed().as_secs_f64();
        let problem = twin.problem(&twin.measured(&sensors), &unknowns, &more);
        let found = identify(&problem).unwrap();
        let own = counts(&found, &truth);
        let diagnostics = &found.posterior.diagnostics;
        let free = found.free_law.as_ref().unwrap();
        println!(
            "{number:>3} {family:>14}: {} informed, {:.0} % in 95 %, {:.0} % in 50 %; informed {:?} kPa, chi2 {:.0}/{} p {:.2}; {} combinations, roughness {:.2}, length {:.2}; {:.0} of {} draws, pareto {:.2}, R-hat {:.3}, {} rounds; {:.1} s + {:.1} s, fit {}",
            own[0],
            100.0 * own[1] as f64 / own[0].max(1) as f64,
            100.0 * own[2] as f64 / own[0].max(1) as f64,
            found.law.informed_range().map(|range| range.map(|p| (1e-3 * p).round())),
            found.goodness.chi_square,
            found.goodness.degrees_of_freedom,
            found.goodness.p_value.unwrap_or(f64::NAN),
            free.informed_combinations,
            free.roughness[1],
            free.length[1],
            diagnostics.effective_draws,
            found.posterior.draws.len(),
            diagnostics.pareto_shape.unwrap_or(f64::NAN),
            diagnostics.r_hat.iter().copied().fold(1.0, f64::max),
            diagnostics.rounds,
            simulated,
            found.wall_s,
            found.fit.evaluations,
        );
        if number == first {
            for sentence in found.conclusions() {
                println!("      {sentence}");
            }
            for (i, pressure) in found.law.pressure.iter().enumerate().step_by(4) {
                println!(
                    "      {:>7.0} kPa: true {:.4}, fit {:.4}, {:.4} [{:.4}, {:.4}] left {:.3}",
                    1e-3 * pressure,
                    1e-12 * truth.stiffness(*pressure),
                    1e-12 * found.law.stiffness[i],
                    1e-12 * found.law.median[i],
                    1e-12 * found.law.lower[i],
                    1e-12 * found.law.upper[i],
                    found.law.remaining[i],
                );
            }
        }
        all.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        if own[0] > 0 {
            per_twin.push(own[1] as f64 / own[0] as f64);
        }
    }
    println!(
        "K(p) inside its 95 % band at {:.1} %, inside its 50 % band at {:.1} % of {} informed pressures of {} twins; twins with all informed pressures inside the 95 % band: {}",
        100.0 * all[1] as f64 / all[0].max(1) as f64,
        100.0 * all[2] as f64 / all[0].max(1) as f64,
        all[0],
        per_twin.len(),
        per_twin.iter().filter(|share| **share >= 1.0).count(),
    );
}
