//! Counts of decided kinds of loss, by repeated simulated measurements.
//!
//! `cargo run --release -p asperity-identify --example damping_kinds -- [paper] [KIND] REPETITIONS [FIRST]`
//! simulates
//! hits of 9, 20 and 32 N on a lightly damped rig, or the paper's, by finite differences with damped bodies,
//! damped contacts or friction in the guide, each of a random size, gives them the noise (40 dB) of sensors, and compares
//! the three kinds with the modal engine: by backbones, by features of the hits, and by both. KIND is the
//! loss that hits have; each in turn when left out.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "its problems are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its answer")]
#![allow(missing_docs, unreachable_pub, dead_code, reason = "the twin is shared with the tests")]

#[path = "../tests/support/losses.rs"]
mod losses;
#[path = "../tests/support/twin.rs"]
mod twin;

use asperity_identify::identify;
use losses::{KINDS, LIGHT, Losses, Observed, PAPER};

/// Outcomes of the comparisons of one kind of truth and data.
#[derive(Debug, Default)]
struct Counts {
    /// The right kind is the best and all others are rejected; the best, and not all are; not the best,
    /// and not rejected; rejected.
    right: u32,
    leading: u32,
    undecided: u32,
    wrong: u32,
    /// No hit has a decay.
    without: u32,
}

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_paper = arguments.first().is_some_and(|word| word == "paper");
    let losses: Losses = if is_paper { PAPER } else { LIGHT };
    arguments.drain(..usize::from(is_paper));
    let kind = arguments.first().filter(|word| KINDS.contains(&word.as_str())).cloned();
    let mut words =
        arguments.iter().skip(usize::from(kind.is_some())).map(|word| word.parse::<u64>().unwrap());
    let repetitions = words.next().unwrap_or(2);
    let first = words.next().unwrap_or(0);
    println!(
        "| loss | data | right, others rejected | right, undecided | another leads, undecided | right one rejected | no decay |"
    );
    println!("|---|---|---|---|---|---|---|");
    for kind in KINDS.into_iter().filter(|one| kind.as_deref().is_none_or(|only| only == *one)) {
        let truths: Vec<_> =
            (first..first + repetitions).map(|seed| (seed, losses.truth(kind, seed).0)).collect();
        for observed in [Observed::Backbones, Observed::Features, Observed::All] {
            let mut counts = Counts::default();
            for (seed, truth) in &truths {
                let Some(measured) = losses.comparison(truth, observed, *seed) else {
                    counts.without += 1;
                    continue;
                };
                let found = identify(&measured.problem).unwrap();
                let comparison = found.comparison.as_ref().unwrap();
                let own = KINDS.iter().position(|known| *known == kind).unwrap();
                let mut others =
                    comparison.candidates.iter().enumerate().filter(|(place, _)| *place != own);
                if comparison.candidates[own].assessment.is_rejected() {
                    counts.wrong += 1;
                } else if comparison.best != own {
                    counts.undecided += 1;
                } else if others.all(|(_, other)| other.assessment.is_rejected()) {
                    counts.right += 1;
                } else {
                    counts.leading += 1;
                }
            }
            let Counts { right, leading, undecided, wrong, without } = counts;
            println!(
                "| {kind} | {observed:?} | {right} | {leading} | {undecided} | {wrong} | {without} |"
            );
        }
    }
}
