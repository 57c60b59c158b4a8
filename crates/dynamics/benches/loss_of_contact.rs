//! Milliseconds of a hit that loses contact: equal steps in full lanes against steps of its own, alone and in full lanes, in one run.
//!
//! `cargo bench -p asperity-dynamics --bench loss_of_contact` prints one table. The hits are of 32 N on the paper's
//! rig with the power law, 0.12 s, 20 modes a body. Each row is the least of several runs, taken in turn.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its rig is valid")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use asperity_dynamics::{Batch, CaseResponse, Decimation, ModalModel, TransientCase};
use asperity_law::{ContactLaw, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const AREA: f64 = 1.15e-4;
const ROUNDS: usize = 3;
const LONGEST: f64 = 12.5e-6;

/// Parts of the longest step of equal steps, and tolerances of steps of their own.
const PARTS: [u32; 3] = [1, 8, 32];
const TOLERANCES: [f64; 3] = [4e-6, 2.5e-7, 1.6e-8];

fn main() {
    let structure = PreloadedStructure::new(rig(), Damping::Ratio(0.035)).unwrap();
    let model = ModalModel::of_stack(&structure, &[20, 20], Port::TOP, &[Port::TOP]).unwrap();
    let hit = TransientCase {
        model: Arc::new(model),
        load: LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 32.0),
        sensor: 0,
        duration: 0.12,
        step: Some(LONGEST),
        tolerance: None,
    };
    let batch = Batch::default();
    let equal = PARTS.map(|parts| {
        let step = Some(LONGEST / f64::from(parts));
        (vec![TransientCase { step, ..hit.clone() }; batch.room()], f64::INFINITY, 0)
    });
    let own = |count: usize| {
        TOLERANCES.map(|tolerance| {
            let tolerance = Some(tolerance);
            (vec![TransientCase { tolerance, ..hit.clone() }; count], f64::INFINITY, 0)
        })
    };
    let own = own(1).into_iter().chain(own(batch.room()));
    let mut all: Vec<(Vec<TransientCase>, f64, usize)> = equal.into_iter().chain(own).collect();
    for _ in 0..ROUNDS {
        for (hits, least, steps) in &mut all {
            let started = Instant::now();
            let found = run(batch, hits);
            *least = least.min(started.elapsed().as_secs_f64() / hits.len() as f64);
            *steps = found[0].integrated_steps;
        }
    }
    println!("| hit of 32 N | steps | ms a hit | against the shortest equal steps |");
    println!("|---|---|---|---|");
    let shortest = all[PARTS.len() - 1].1;
    for (hits, seconds, steps) in &all {
        let name = match hits[0].tolerance {
            None => format!("equal steps of {:.2} us", 1e6 * hits[0].step.unwrap()),
            Some(tolerance) if hits.len() == 1 => format!("steps of its own, {tolerance:e}"),
            Some(tolerance) => format!("steps of their own, {tolerance:e}, full lanes"),
        };
        println!("| {name} | {steps} | {:.2} | {:.1} |", 1e3 * seconds, shortest / seconds);
    }
}

fn run(batch: Batch, hits: &[TransientCase]) -> Vec<CaseResponse> {
    // As many taps as keep the band of the harmonics at a decimation by eight.
    let decimation =
        Arc::new(Decimation { factor: 8, taps: vec![1.0 / 96.0; 96].into(), ending: 0 });
    let found = batch.run(hits, &|_, _| Arc::clone(&decimation));
    black_box(found.into_iter().map(Result::unwrap).collect())
}

fn rig() -> Stack {
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let guide = Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, Arc::clone(&law)).unwrap();
    let interfaces = vec![contact("guide-sample"), contact("sample-disc")];
    Stack::new(vec![guide, sample], interfaces, Support::Rigid, 9.81).unwrap()
}
