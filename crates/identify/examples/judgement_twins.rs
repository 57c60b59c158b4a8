//! Judgements of identifications with the right model and with wrong ones, on random rigs.
//!
//! `cargo run --release -p asperity-identify --example judgement_twins -- TABLE SEED FIRST END` simulates
//! twelve hits and three measured receptances of each rig by finite differences, with noise (40 dB) and gains
//! (3 %), identifies the law with the right model and with a wrong one of six kinds (damping of bodies alone
//! where contacts dissipate; a half sine of the same width in place of the pulse; a mass off by 5 % with known
//! gains; a rigid support in place of an elastic one; friction left out; a receptance of reversed sign), and
//! appends both to TABLE, JSON objects of a line each. Rows that TABLE has are not run again.
//!
//! `... -- explain SEED TWIN` prints what would explain the data of a rig better than its wrong model.
//!
//! `... -- truth SEED TWIN` prints the residuals with the right model, fitted from the true law and losses.
//!
//! `... -- count TABLE...` prints the counts. Profiles, comparison and explanations are left out, and so is
//! the reason that the judgement names for it.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "its problems are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its answer")]
#![allow(missing_docs, unreachable_pub, dead_code, reason = "the rigs are shared with the tests")]

#[path = "../tests/support/laws.rs"]
mod laws;
#[path = "../tests/support/twin.rs"]
mod twin;
#[path = "../tests/support/wrong_models.rs"]
mod wrong_models;

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use asperity_identify::{
    Identification, IdentificationError, IdentificationProblem, Judgement, ReasonKind, Usability,
    identify,
};
use asperity_law::{ContactLaw, Tabulated};
use serde::{Deserialize, Serialize};
use wrong_models::{KINDS, Rig};

/// The judgement of an identification of a rig.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Row {
    seed: u64,
    twin: usize,
    kind: String,
    law: String,
    right: bool,
    /// `yes`, `with_care` or `no`; `failed` where the identification ended with an error.
    #[serde(rename = "use")]
    usability: String,
    reasons: Vec<String>,
    informed: usize,
    inside: usize,
    /// Largest error of ln K, and half of the largest width of the band, at informed pressures.
    largest_error: f64,
    half_width: f64,
    chi_square: f64,
    degrees_of_freedom: usize,
    /// Root mean square residual of each feature, in standard deviations.
    residuals: BTreeMap<String, f64>,
    wall_s: f64,
    /// Estimated time left, and the most, over the true one after a tenth and after a half of the time; none where
    /// nothing was estimated.
    #[serde(default)]
    time_left: [Option<[f64; 2]>; 2],
}

/// Shares of the time at which the time left is judged.
const JUDGED: [f64; 2] = [0.1, 0.5];

/// The identification of a problem, its seconds, and its estimates of the time left over the true one.
fn watched(
    problem: &IdentificationProblem,
) -> (Result<Identification, IdentificationError>, f64, [Option<[f64; 2]>; 2]) {
    let (started, is_done) = (Instant::now(), AtomicBool::new(false));
    let seconds = || started.elapsed().as_secs_f64();
    let (found, whole, estimates) = std::thread::scope(|scope| {
        let watch = scope.spawn(|| {
            let mut estimates = Vec::new();
            while !is_done.load(Ordering::Relaxed) {
                let progress = problem.work().progress();
                let told = progress.and_then(|told| Some([told.left?, told.most?]));
                estimates.push((seconds(), told.map(|told| told.map(|one| one.as_secs_f64()))));
                std::thread::sleep(Duration::from_millis(50));
            }
            estimates
        });
        let found = identify(problem);
        let whole = seconds();
        is_done.store(true, Ordering::Relaxed);
        (found, whole, watch.join().unwrap())
    });
    let ratios = JUDGED.map(|share| {
        let (at, told) = *estimates.iter().find(|(at, _)| *at >= share * whole)?;
        Some(told?.map(|left| left / (whole - at)))
    });
    (found, whole, ratios)
}

fn word(usability: Usability) -> String {
    serde_json::to_value(usability).unwrap().as_str().unwrap().to_owned()
}

impl Row {
    fn judged(&mut self, found: &Identification, truth: &dyn ContactLaw) {
        let reasons = found.judgement().reasons;
        let judgement = Judgement::of(
            reasons.into_iter().filter(|reason| reason.kind != ReasonKind::Incomplete).collect(),
        );
        self.usability = word(judgement.usability);
        let reason =
            |one: &asperity_identify::Reason| format!("{}: {}", word(one.usability), one.words);
        self.reasons = judgement.reasons.iter().map(reason).collect();
        let band = &found.law;
        for i in (0..band.pressure.len()).filter(|&i| band.informed[i]) {
            let exact = truth.stiffness(band.pressure[i]);
            self.informed += 1;
            self.inside += usize::from((band.lower[i]..=band.upper[i]).contains(&exact));
            self.largest_error = self.largest_error.max((band.median[i] / exact).ln().abs());
            self.half_width = self.half_width.max(0.5 * (band.upper[i] / band.lower[i]).ln());
        }
        self.chi_square = found.goodness.chi_square;
        self.degrees_of_freedom = found.goodness.degrees_of_freedom;
        let mut sums: BTreeMap<String, (f64, f64)> = BTreeMap::new();
        for one in found.observations() {
            let sum = sums.entry(one.feature.to_owned()).or_default();
            // With the standard deviations as given.
            *sum = (sum.0 + (one.residual * found.noise_factor).powi(2), sum.1 + 1.0);
        }
        self.residuals = sums.into_iter().map(|(key, sum)| (key, (sum.0 / sum.1).sqrt())).collect();
    }
}

fn rows(table: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(table).unwrap_or_default();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [word, tables @ ..] if word == "count" => {
            count(&tables.iter().flat_map(|table| rows(Path::new(table))).collect::<Vec<_>>());
        }
        [word, seed, twin] if word == "explain" => {
            let mut rig = Rig::new(seed.parse().unwrap(), twin.parse().unwrap());
            let found = identify(&rig.problem(false)).unwrap();
            let chi_square = found.goodness.chi_square;
            println!("{} of {}: chi-square {chi_square:.0}", rig.kind, rig.law);
            for one in &found.explanations {
                println!(
                    "  {}: expected {:.0?}, found {:.0?}",
                    one.cause, one.expected_chi_square, one.chi_square
                );
            }
        }
        [word, seed, twin] if word == "truth" => {
            truth(seed.parse().unwrap(), twin.parse().unwrap());
        }
        [table, seed, first, end] => {
            let number = |word: &String| word.parse::<usize>().unwrap();
            run(Path::new(table), number(seed) as u64, number(first)..number(end));
        }
        _ => println!("expected TABLE SEED FIRST END, or count TABLE..."),
    }
}

fn run(table: &Path, seed: u64, twins: std::ops::Range<usize>) {
    for twin in twins {
        let known = rows(table);
        let is_known = |right: bool| {
            known.iter().any(|row| (row.seed, row.twin, row.right) == (seed, twin, right))
        };
        if is_known(true) && is_known(false) {
            continue;
        }
        let mut rig = Rig::new(seed, twin);
        let truth = Tabulated::new(&rig.points).unwrap();
        for right in [true, false] {
            if is_known(right) {
                continue;
            }
            let mut row = Row {
                seed,
                twin,
                kind: rig.kind.to_owned(),
                law: rig.law.to_owned(),
                right,
                usability: "failed".to_owned(),
                reasons: Vec::new(),
                informed: 0,
                inside: 0,
                largest_error: 0.0,
                half_width: 0.0,
                chi_square: 0.0,
                degrees_of_freedom: 0,
                residuals: BTreeMap::new(),
                wall_s: 0.0,
                time_left: [None; 2],
            };
            let (found, wall_s, time_left) = watched(&rig.problem(right).fast());
            (row.wall_s, row.time_left) = (wall_s, time_left);
            match found {
                Ok(found) => row.judged(&found, &truth),
                Err(error) => row.reasons.push(error.to_string()),
            }
            let mut file = OpenOptions::new().create(true).append(true).open(table).unwrap();
            writeln!(file, "{}", serde_json::to_string(&row).unwrap()).unwrap();
        }
    }
    count(&rows(table));
}

/// Prints the law beside the true one, and the residuals of each feature in standard deviations, with the right
/// model from the true damping.
fn truth(seed: u64, twin: usize) {
    let rig = Rig::new(seed, twin);
    let found = identify(&rig.at_truth().fast()).unwrap();
    println!("{} of {}: chi-square {:.0}", rig.kind, rig.law, found.goodness.chi_square);
    for estimate in found.estimates() {
        println!("  {}: {}", estimate.name, estimate.value);
    }
    let (band, exact) = (&found.law, Tabulated::new(&rig.points).unwrap());
    for i in (0..band.pressure.len()).filter(|&i| band.informed[i]) {
        let off = |found: f64| 100.0 * (found / exact.stiffness(band.pressure[i]) - 1.0);
        println!(
            "  K at {:.4e} Pa: off by {:+.3} %, from {:+.3} to {:+.3} %",
            band.pressure[i],
            off(band.stiffness[i]),
            off(band.lower[i]),
            off(band.upper[i])
        );
    }
    for one in found.observations() {
        let residual = one.residual * found.noise_factor;
        println!("  {} at {:.4?}: {:+.2}", one.feature, one.at, residual);
    }
}

/// Prints the counts by kind, for right and wrong models.
fn count(rows: &[Row]) {
    println!(
        "| model | kind | yes | with care | of these for the rigid support alone | no | failed | yes, and fewer than 80 % of the informed pressures inside | inside where yes or with care |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for right in [true, false] {
        for kind in KINDS.into_iter().map(Some).chain([None]) {
            let own: Vec<&Row> = rows
                .iter()
                .filter(|row| row.right == right && kind.is_none_or(|kind| row.kind == kind))
                .collect();
            let of = |word: &str| own.iter().filter(|row| row.usability == word).count();
            let is_of_support = |row: &&&Row| {
                let mut care = row.reasons.iter().filter(|words| words.starts_with("with_care"));
                row.usability == "with_care" && care.all(|words| words.contains("taken as rigid"))
            };
            let is_calm = |row: &&&Row| {
                row.usability == "yes" && (row.inside as f64) < 0.8 * row.informed as f64
            };
            let used =
                || own.iter().filter(|row| ["yes", "with_care"].contains(&row.usability.as_str()));
            let (inside, informed) =
                used().fold((0, 0), |sum, row| (sum.0 + row.inside, sum.1 + row.informed));
            println!(
                "| {} | {} | {} | {} | {} | {} | {} | {} | {inside} of {informed} |",
                if right { "right" } else { "wrong" },
                kind.unwrap_or("all"),
                of("yes"),
                of("with_care"),
                own.iter().filter(is_of_support).count(),
                of("no"),
                of("failed"),
                own.iter().filter(is_calm).count(),
            );
        }
    }
    for (place, share) in JUDGED.iter().enumerate() {
        let known: Vec<[f64; 2]> = rows.iter().filter_map(|row| row.time_left[place]).collect();
        let count = |is: fn(&&[f64; 2]) -> bool| known.iter().filter(is).count();
        println!(
            "Time left after {share} of the time: within a factor of two in {}, at most the most in {} of {}",
            count(|[left, _]| (0.5..=2.0).contains(left)),
            count(|[_, most]| *most >= 1.0),
            known.len()
        );
    }
}
