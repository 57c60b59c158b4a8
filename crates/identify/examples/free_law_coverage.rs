//! Coverage of the bands of a free law on twins whose true laws are of other families than its prior.
//!
//! `cargo run --release -p asperity-identify --example free_law_coverage -- TWINS [HITS [FIRST]]`
//! simulates hits of the paper's rig by finite differences, 9 to 32 N, with laws of six families in
//! turn (modified power laws with random knots, shoulders, bumps, exponential, hyperbolic, kinks),
//! gives them the noise (40 dB) and the gain errors (5 %) of sensors, identifies a free law about a
//! power law, with damping and gains unknown, by the modal engine, and counts.
//!
//! `... -- width TWINS [HITS]` identifies the paper's modified law from each twin twice, free and with
//! its own knots, and compares the widths of the bands.
//!
//! `... -- residuals TWINS [HITS [FIRST]]` prints the residuals of the features with the true law, damping
//! and gains: an error that the hits share shows as a mean unlike zero.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "its problems are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its answer")]
#![allow(missing_docs, unreachable_pub, reason = "the twin is shared with the tests")]

#[path = "../tests/support/laws.rs"]
mod laws;
#[path = "../tests/support/twin.rs"]
mod twin;

use std::time::Instant;

use asperity_identify::{Identification, StiffnessOrigin, identify};
use asperity_law::{ContactLaw, ModifiedPower, Tabulated};
use asperity_scenario::Document;
use serde_json::{Value, json};
use twin::{FINE_CELL, Noise, Sensors, Truth};

const SCENARIO: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");

/// The engine of the identification, with frequencies right to 2e-6.
const METHOD: &str = r#"{"kind": "modal", "step_s": 1e-5}"#;

/// Pressures of bands, by their origin.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    pressures: usize,
    /// True stiffness inside the band of 95 %.
    wide: usize,
    /// True stiffness inside the band of 50 %.
    half: usize,
}

impl Count {
    /// The pressures of the origins, with the true law.
    fn of(found: &Identification, truth: &dyn ContactLaw, origins: &[StiffnessOrigin]) -> Self {
        let band = &found.law;
        let mut count = Self::default();
        for (i, &pressure) in band.pressure.iter().enumerate() {
            if !origins.contains(&band.origin[i]) {
                continue;
            }
            let exact = truth.stiffness(pressure);
            let [first, third] = &band.quartiles;
            count.pressures += 1;
            count.wide += usize::from((band.lower[i]..=band.upper[i]).contains(&exact));
            count.half += usize::from((first[i]..=third[i]).contains(&exact));
        }
        count
    }

    fn add(&mut self, other: Self) {
        self.pressures += other.pressures;
        self.wide += other.wide;
        self.half += other.half;
    }

    fn words(self) -> String {
        let share = |part: usize| 100.0 * part as f64 / self.pressures.max(1) as f64;
        format!("{:>5} {:>5.1} % {:>5.1} %", self.pressures, share(self.wide), share(self.half))
    }
}

fn peaks(count: usize) -> Vec<f64> {
    (0..count).map(|i| 9.0 + 23.0 * i as f64 / (count - 1).max(1) as f64).collect()
}

/// Damping, gains and a law of this kind.
fn unknowns(law: &str) -> Value {
    json!([
        {"kind": law, "law": "modified"},
        {"kind": "scalar", "pointer": "/damping/ratio", "bounds": [0.005, 0.2], "start": 0.03},
        {"kind": "gain", "channel": "force", "prior": {"value": 1, "relative": 0.05}},
        {"kind": "gain", "channel": "response", "prior": {"value": 1, "relative": 0.05}},
    ])
}

fn sensors(number: usize, noise: &mut Noise) -> Sensors {
    Sensors {
        signal_to_noise_db: 40.0,
        force_gain: (0.05 * noise.normal()).exp(),
        response_gain: (0.05 * noise.normal()).exp(),
        seed: 1000 + number as u64,
    }
}

/// The rig with a power law, about which a free law is sought.
fn about_a_power_law() -> Value {
    let mut document = Document::read(SCENARIO).unwrap();
    document.set("/method", METHOD).unwrap();
    document.set("/output_rate_hz", "50000").unwrap();
    let power = r#"{"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}"#;
    document.set("/laws/modified", power).unwrap();
    json!({"pressures_pa": [0.02e6, 0.3e6], "scenario": document.value()})
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |place: usize, default: usize| {
        arguments.get(place).map_or(default, |word| word.parse().unwrap())
    };
    if arguments.first().is_some_and(|word| word == "width") {
        widths(number(1, 4), number(2, 12));
    } else if arguments.first().is_some_and(|word| word == "residuals") {
        residuals(number(1, 6), number(2, 12), number(3, 0));
    } else {
        coverage(number(0, 6), number(1, 24), number(2, 0));
    }
}

fn coverage(twins: usize, hits: usize, first: usize) {
    const REACHED: [StiffnessOrigin; 2] = [StiffnessOrigin::Data, StiffnessOrigin::Smoothness];
    let peaks = peaks(hits);
    let more = about_a_power_law();
    let mut families = vec![[Count::default(); 2]; laws::FAMILIES.len()];
    for number in first..twins {
        let mut noise = Noise::new(100 + number as u64);
        let place = number % laws::FAMILIES.len();
        let points = laws::law(laws::FAMILIES[place], &mut noise);
        let truth = Tabulated::new(&points).unwrap();
        let written = laws::written(&points).to_string();
        let sensors = sensors(number, &mut noise);
        let changes =
            [("/output_rate_hz", "50000"), ("/laws/modified", written.as_str()), FINE_CELL];
        let twin = Truth::new(SCENARIO, &peaks, &changes);
        let problem = twin.problem(&twin.measured(&sensors), &unknowns("free_law"), &more);
        let started = Instant::now();
        let found = match identify(&problem) {
            Ok(found) => found,
            Err(error) => {
                println!("{number:>3} {:>14}: failed: {error}", laws::FAMILIES[place]);
                continue;
            }
        };
        let counts = [&REACHED[..1], &REACHED].map(|kinds| Count::of(&found, &truth, kinds));
        let diagnostics = &found.posterior.diagnostics;
        let free = found.free_law.as_ref().unwrap();
        println!(
            "{number:>3} {:>14}: informed {}, reached {}; {:?} kPa; chi2 {:.0}/{} p {:.2}; {} combinations, roughness {:.2}, length {:.2}; {:.0} of {} draws, pareto {:.2}, R-hat {:.3}, {} rounds; {:.0} s",
            laws::FAMILIES[place],
            counts[0].words(),
            counts[1].words(),
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
            started.elapsed().as_secs_f64(),
        );
        families[place].iter_mut().zip(counts).for_each(|(sum, own)| sum.add(own));
    }
    println!(
        "family: informed pressures, inside 95 %, inside 50 %; the same of all reached pressures"
    );
    let mut all = [Count::default(); 2];
    for (family, counts) in laws::FAMILIES.iter().zip(&families) {
        println!("{family:>14}: {}; {}", counts[0].words(), counts[1].words());
        all.iter_mut().zip(counts).for_each(|(sum, own)| sum.add(*own));
    }
    println!("{:>14}: {}; {}", "all", all[0].words(), all[1].words());
}

/// Widths of the band of the paper's modified law, free over with its own knots.
fn widths(twins: usize, hits: usize) {
    let truth = Truth::new(SCENARIO, &peaks(hits), &[("/output_rate_hz", "50000"), FINE_CELL]);
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let exact = ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots).unwrap();
    let mut noise = Noise::new(7);
    let mut all = Vec::new();
    for number in 0..twins {
        let measured = truth.measured(&sensors(number, &mut noise));
        let fixed = json!({"pressures_pa": [0.02e6, 0.3e6]});
        let fixed = identify(&truth.problem(&measured, &unknowns("monotone_law"), &fixed)).unwrap();
        let free = truth.problem(&measured, &unknowns("free_law"), &about_a_power_law());
        let free = identify(&free).unwrap();
        let both = fixed.law.informed.iter().zip(&free.law.informed).enumerate();
        let both = both.filter(|(_, (fixed, free))| **fixed && **free);
        let width = |found: &Identification, i: usize| found.law.upper[i] - found.law.lower[i];
        let mut ratios: Vec<f64> = both.map(|(i, _)| width(&free, i) / width(&fixed, i)).collect();
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
        println!(
            "{number:>3}: {} pressures informed of both, free over fixed width {:.2} to {:.2}, median {:.2}; fixed {}, free {}",
            ratios.len(),
            at(0.0),
            at(1.0),
            at(0.5),
            Count::of(&fixed, &exact, &[StiffnessOrigin::Data]).words(),
            Count::of(&free, &exact, &[StiffnessOrigin::Data]).words(),
        );
        all.extend(ratios);
    }
    all.sort_by(f64::total_cmp);
    println!("median of all {:.2}, largest {:.2}", all[all.len() / 2], all[all.len() - 1]);
}

/// Residuals of the features with the true law, damping and gains, in their standard deviations.
fn residuals(twins: usize, hits: usize, first: usize) {
    println!("feature: mean and spread over the hits, mean relative standard deviation");
    for number in first..twins {
        let mut noise = Noise::new(100 + number as u64);
        let family = laws::FAMILIES[number % laws::FAMILIES.len()];
        let written = laws::written(&laws::law(family, &mut noise)).to_string();
        let sensors = sensors(number, &mut noise);
        let changes =
            [("/output_rate_hz", "50000"), ("/laws/modified", written.as_str()), FINE_CELL];
        let twin = Truth::new(SCENARIO, &peaks(hits), &changes);
        let known = |channel: &str, value: f64| {
            let prior = json!({"value": value, "relative": 1e-7});
            json!({"kind": "gain", "channel": channel, "prior": prior})
        };
        let unknowns =
            json!([known("force", sensors.force_gain), known("response", sensors.response_gain)]);
        let mut scenario = Document::parse(&twin.scenario.to_string(), SCENARIO).unwrap();
        scenario.set("/method", METHOD).unwrap();
        let more = json!({"pressures_pa": [0.02e6, 0.3e6], "scenario": scenario.value()});
        let found = identify(&twin.problem(&twin.measured(&sensors), &unknowns, &more)).unwrap();
        let all: Vec<_> = found.observations().collect();
        let mut features: Vec<&str> = all.iter().map(|one| one.feature).collect();
        features.sort_unstable();
        features.dedup();
        println!("{number:>3} {family}");
        for feature in features {
            let own = || all.iter().filter(|one| one.feature == feature);
            let count = own().count() as f64;
            let mean = own().map(|one| one.residual).sum::<f64>() / count;
            let square = own().map(|one| (one.residual - mean).powi(2)).sum::<f64>();
            let relative = own().map(|one| one.standard_deviation / one.value).sum::<f64>();
            println!(
                "    {feature}: {mean:+.2}, {:.2}, {:.1e}",
                (square / (count - 1.0)).sqrt(),
                relative / count
            );
        }
    }
}
