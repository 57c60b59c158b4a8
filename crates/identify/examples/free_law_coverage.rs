//! Coverage of the bands of a free law on twins whose true laws are of other families than its prior.
//!
//! `cargo run --release -p asperity-identify --example free_law_coverage -- TABLE FIRST END [HITS [SMOOTHNESS]]`
//! simulates hits of the paper's rig by finite differences, 9 to 32 N, with laws of six families in
//! turn (modified power laws with random knots, shoulders, bumps, exponential, hyperbolic, kinks),
//! gives them the noise (40 dB) and the gain errors (5 %) of sensors, identifies a free law about a
//! power law, with damping and gains unknown, by the modal engine, and counts. Every twin from FIRST to
//! before END is appended to the file TABLE as soon as it is finished; those that are in it already are
//! not run again. The measured hits of a twin are kept beside the table (`twin-N-HITS.json`) and read from
//! there, so that another prior is tried on the same hits. SMOOTHNESS is that of the slope in the prior,
//! `differentiable` or `continuous`; both when left out.
//!
//! `... -- count TABLE...` prints the counts of tables without running a twin.
//!
//! `... -- width TWINS [HITS]` identifies the paper's modified law from each twin three times, with its own
//! knots and power law of unknown numbers, free about a power law, and free about that form with
//! unknown knots, and compares the widths of the bands.
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

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::path::Path;
use std::time::Instant;

use asperity_identify::problem::SlopeSmoothness;
use asperity_identify::{Identification, StiffnessOrigin, identify};
use asperity_law::{ContactLaw, ModifiedPower, Tabulated};
use asperity_scenario::Document;
use serde::{Deserialize, Serialize};
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
    match arguments.first().map(String::as_str) {
        Some("width") => widths(number(1, 4), number(2, 12)),
        Some("residuals") => residuals(number(1, 6), number(2, 12), number(3, 0)),
        Some("count") => {
            count(
                &arguments[1..].iter().flat_map(|path| rows(Path::new(path))).collect::<Vec<_>>(),
            );
        }
        Some(table) => {
            let twins = number(1, 0)..number(2, 6);
            let smoothness = arguments.get(4).map(String::as_str);
            coverage(Path::new(table), twins, number(3, 12), smoothness);
        }
        None => println!("expected TABLE FIRST END [HITS [SMOOTHNESS]], count, width or residuals"),
    }
}

/// The findings of a twin, a row of the table.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct TwinRow {
    twin: usize,
    hits: usize,
    informed: usize,
    informed_inside_95: usize,
    informed_inside_50: usize,
    /// Pressures that the data inform, or that the smoothness carries from them.
    reached: usize,
    reached_inside_95: usize,
    reached_inside_50: usize,
    /// Mean over the informed pressures of the band of 95 % in ln K.
    mean_width: f64,
    informed_from_kpa: Option<f64>,
    informed_to_kpa: Option<f64>,
    chi_square: f64,
    degrees_of_freedom: usize,
    noise_factor: f64,
    combinations: usize,
    roughness: f64,
    length: f64,
    /// Probability of a slope without a derivative.
    continuous: f64,
    effective_draws: f64,
    draws: usize,
    pareto_shape: Option<f64>,
    r_hat: f64,
    rounds: usize,
    wall_s: f64,
}

impl TwinRow {
    fn new(twin: usize, hits: usize, found: &Identification, truth: &dyn ContactLaw) -> Self {
        const REACHED: [StiffnessOrigin; 2] = [StiffnessOrigin::Data, StiffnessOrigin::Smoothness];
        let [informed, reached] =
            [&REACHED[..1], &REACHED].map(|kinds| Count::of(found, truth, kinds));
        let band = &found.law;
        let own = (0..band.pressure.len()).filter(|&i| band.informed[i]);
        let width: f64 = own.map(|i| (band.upper[i] / band.lower[i]).ln()).sum();
        let range = band.informed_range();
        let diagnostics = &found.posterior.diagnostics;
        let free = found.free_law.as_ref().unwrap();
        let rough = free.smoothness.iter().find(|one| one.kind == SlopeSmoothness::Continuous);
        Self {
            twin,
            hits,
            informed: informed.pressures,
            informed_inside_95: informed.wide,
            informed_inside_50: informed.half,
            reached: reached.pressures,
            reached_inside_95: reached.wide,
            reached_inside_50: reached.half,
            mean_width: width / informed.pressures as f64,
            informed_from_kpa: range.map(|range| 1e-3 * range[0]),
            informed_to_kpa: range.map(|range| 1e-3 * range[1]),
            chi_square: found.goodness.chi_square,
            degrees_of_freedom: found.goodness.degrees_of_freedom,
            noise_factor: found.noise_factor,
            combinations: free.informed_combinations,
            roughness: free.roughness[1],
            length: free.length[1],
            continuous: rough.map_or(0.0, |one| one.probability),
            effective_draws: diagnostics.effective_draws,
            draws: found.posterior.draws.len(),
            pareto_shape: diagnostics.pareto_shape,
            r_hat: diagnostics.r_hat.iter().copied().fold(1.0, f64::max),
            rounds: diagnostics.rounds,
            wall_s: found.wall_s,
        }
    }

    fn family(&self) -> &'static str {
        laws::FAMILIES[self.twin % laws::FAMILIES.len()]
    }

    fn informed(&self) -> Count {
        Count {
            pressures: self.informed,
            wide: self.informed_inside_95,
            half: self.informed_inside_50,
        }
    }

    fn reached(&self) -> Count {
        Count {
            pressures: self.reached,
            wide: self.reached_inside_95,
            half: self.reached_inside_50,
        }
    }
}

/// The rows of a table; none where there is no file.
fn rows(table: &Path) -> Vec<TwinRow> {
    let Ok(mut reader) = csv::Reader::from_path(table) else { return Vec::new() };
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

/// Appends a row to a table.
fn append(table: &Path, row: &TwinRow) {
    let is_new = !table.exists();
    let file = OpenOptions::new().create(true).append(true).open(table).unwrap();
    let mut writer = csv::WriterBuilder::new().has_headers(is_new).from_writer(file);
    writer.serialize(row).unwrap();
    writer.flush().unwrap();
}

fn coverage(table: &Path, twins: std::ops::Range<usize>, hits: usize, smoothness: Option<&str>) {
    let more = about_a_power_law();
    let mut unknowns = unknowns("free_law");
    if let Some(smoothness) = smoothness {
        unknowns[0]["smoothness"] = json!([smoothness]);
    }
    let known: Vec<usize> = rows(table).iter().map(|row| row.twin).collect();
    for number in twins.filter(|number| !known.contains(number)) {
        let family = laws::FAMILIES[number % laws::FAMILIES.len()];
        let mut noise = Noise::new(100 + number as u64);
        let points = laws::law(family, &mut noise);
        let truth = Tabulated::new(&points).unwrap();
        let written = laws::written(&points).to_string();
        let sensors = sensors(number, &mut noise);
        let started = Instant::now();
        let kept = table.with_file_name(format!("twin-{number}-{hits}.json"));
        let twin = |peaks: &[f64]| {
            let changes =
                [("/output_rate_hz", "50000"), ("/laws/modified", written.as_str()), FINE_CELL];
            Truth::new(SCENARIO, peaks, &changes)
        };
        let measured: Vec<Value> = match std::fs::read(&kept) {
            Ok(text) => serde_json::from_slice(&text).unwrap(),
            Err(_) => twin(&peaks(hits)).measured(&sensors),
        };
        std::fs::write(&kept, serde_json::to_vec(&measured).unwrap()).unwrap();
        let problem = twin(&[]).problem(&measured, &unknowns, &more);
        let simulated_s = started.elapsed().as_secs_f64();
        match identify(&problem) {
            Ok(found) => {
                let row = TwinRow::new(number, hits, &found, &truth);
                println!(
                    "{number:>3} {family:>14}: informed {}, width {:.3}, chi2 {:.0}/{}, {:.0} of {} draws; {simulated_s:.0} + {:.0} s",
                    row.informed().words(),
                    row.mean_width,
                    row.chi_square,
                    row.degrees_of_freedom,
                    row.effective_draws,
                    row.draws,
                    row.wall_s,
                );
                append(table, &row);
            }
            Err(error) => println!("{number:>3} {family:>14}: failed: {error}"),
        }
    }
    count(&rows(table));
}

/// Prints the counts of the families.
fn count(rows: &[TwinRow]) {
    println!(
        "family: twins, informed pressures, inside 95 %, inside 50 %; the same of all reached pressures"
    );
    let mut families: BTreeMap<&str, Vec<&TwinRow>> = BTreeMap::new();
    for row in rows {
        families.entry(row.family()).or_default().push(row);
    }
    let all = ("all", rows.iter().collect());
    for (family, own) in families.into_iter().chain([all]) {
        let mut sums = [Count::default(); 2];
        for row in &own {
            sums[0].add(row.informed());
            sums[1].add(row.reached());
        }
        println!("{family:>14}: {:>3}, {}; {}", own.len(), sums[0].words(), sums[1].words());
    }
}

/// Widths of the band of the paper's modified law, free over with its own knots.
fn widths(twins: usize, hits: usize) {
    let truth = Truth::new(SCENARIO, &peaks(hits), &[("/output_rate_hz", "50000"), FINE_CELL]);
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let exact = ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots).unwrap();
    let mut noise = Noise::new(7);
    let mut all = [Vec::new(), Vec::new()];
    let range = json!({"pressures_pa": [0.02e6, 0.3e6]});
    let form = with_power_law(unknowns("monotone_law"));
    let mut deviating = unknowns("monotone_law");
    deviating.as_array_mut().unwrap().push(json!({"kind": "free_law", "law": "modified"}));
    for number in 0..twins {
        let measured = truth.measured(&sensors(number, &mut noise));
        let found = |unknowns: &Value, more: &Value| {
            identify(&truth.problem(&measured, unknowns, more)).unwrap()
        };
        let fixed = found(&form, &range);
        let words = Count::of(&fixed, &exact, &[StiffnessOrigin::Data]).words();
        println!("{number:>3}: form with unknown numbers: informed, inside 95 %, 50 %: {words}");
        let free = [
            ("free about a power law", found(&unknowns("free_law"), &about_a_power_law())),
            ("free about that form", found(&deviating, &range)),
        ];
        for ((name, free), all) in free.iter().zip(&mut all) {
            let both = fixed.law.informed.iter().zip(&free.law.informed).enumerate();
            let both = both.filter(|(_, (fixed, free))| **fixed && **free);
            let width = |found: &Identification, i: usize| found.law.upper[i] - found.law.lower[i];
            let mut ratios: Vec<f64> =
                both.map(|(i, _)| width(free, i) / width(&fixed, i)).collect();
            ratios.sort_by(f64::total_cmp);
            let at = |share: f64| ratios[(share * (ratios.len() - 1) as f64) as usize];
            println!(
                "     {name}: {}; over the form's width at {} pressures informed of both {:.2} to {:.2}, median {:.2}",
                Count::of(free, &exact, &[StiffnessOrigin::Data]).words(),
                ratios.len(),
                at(0.0),
                at(1.0),
                at(0.5),
            );
            all.extend(ratios);
        }
    }
    for (name, all) in ["a power law", "that form"].iter().zip(&mut all) {
        all.sort_by(f64::total_cmp);
        let share = all.partition_point(|ratio| *ratio <= 2.5) as f64 / all.len() as f64;
        println!(
            "free about {name}: median of all {:.2}, at most 2.5 at {:.0} %, largest {:.2}",
            all[all.len() / 2],
            100.0 * share,
            all[all.len() - 1]
        );
    }
}

/// These unknowns, and the coefficient and the exponent of the power law above the knots.
fn with_power_law(unknowns: Value) -> Value {
    let Value::Array(mut all) = unknowns else { return unknowns };
    for (key, bounds) in [("coefficient", [1e8, 1e12]), ("exponent", [0.05, 1.0])] {
        let pointer = format!("/laws/modified/{key}");
        all.push(json!({"kind": "scalar", "pointer": pointer, "bounds": bounds}));
    }
    Value::Array(all)
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
