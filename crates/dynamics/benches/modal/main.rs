//! Hits per second of the modal kernel, beside the finite-difference kernel and a plain scalar
//! loop over the same modal steps in the same run.
//!
//! `cargo bench -p asperity-dynamics --bench modal` prints one table. A hit is one of 0.12 s on
//! the paper's rig with the modified law, 9 to 32 N, two interfaces, with extremes, mean
//! stiffness, energy ledger and the thinned output. Each row is the least of several runs, taken
//! in turn so that a machine that slows down slows them all; the ratio to the plain loop is what
//! carries over to other machines.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its rig is valid")]

mod plain;

use std::hint::black_box;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use asperity_dynamics::{
    Batch, Decimation, FiniteDifference, InstructionSet, Modal, ModalModel, Sampling, TransientCase,
};
use asperity_law::{ContactLaw, ModifiedPower};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const AREA: f64 = 1.15e-4;
const DURATION: f64 = 0.12;
const ROUNDS: usize = 5;
const STEPS: [f64; 3] = [10e-6, 16e-6, 20e-6];

fn main() {
    let structure = PreloadedStructure::new(rig(), Damping::Ratio(0.035)).unwrap();
    let pulse = |peak| LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, peak);
    let count = Modal::default().mode_count(structure.natural_frequency(), &pulse(1.0));
    let counts = count.counts(structure.stack()).unwrap();
    let reduced = structure.reduced_to(&counts, &[Port::TOP]).unwrap();
    let plain_rig = plain::Rig::new(reduced);
    let rig = Arc::new(ModalModel::of_stack(&structure, &counts, Port::TOP, &[Port::TOP]).unwrap());
    let hits = |step: f64, count: usize| -> Vec<TransientCase> {
        let hit = |i: usize| TransientCase {
            model: Arc::clone(&rig),
            sensor: 0,
            load: pulse(9.0 + 23.0 * i as f64 / count as f64),
            duration: DURATION,
            step: Some(step),
            tolerance: None,
        };
        (0..count).map(hit).collect()
    };
    let threads = thread::available_parallelism().map_or(1, std::num::NonZero::get);
    println!("| kernel | cores | step [us] | hits/s | ns a lane and step | against plain |");
    println!("|---|---|---|---|---|---|");

    let mut plain_seconds = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        for (least, step) in plain_seconds.iter_mut().zip(STEPS) {
            *least = least.min(timed(|| plain_rig.march(&pulse(32.0), step, DURATION)));
        }
    }
    for (seconds, step) in plain_seconds.iter().zip(STEPS) {
        row("plain loop", 1, step, 1.0 / seconds, 1.0);
    }
    for set in InstructionSet::available() {
        for (plain, step) in plain_seconds.iter().zip(STEPS) {
            let hits = hits(step, set.lanes() * 32);
            let mut least = f64::INFINITY;
            for _ in 0..ROUNDS {
                least = least.min(timed(|| run(set, &hits)));
            }
            let rate = hits.len() as f64 / least;
            row(&format!("{set:?}").to_lowercase(), 1, step, rate, rate * plain);
        }
    }
    let set = InstructionSet::detected();
    for (plain, step) in plain_seconds.iter().zip(STEPS) {
        let hits = hits(step, set.lanes() * 32);
        let mut least = f64::INFINITY;
        for _ in 0..ROUNDS {
            least = least.min(timed(|| {
                thread::scope(|scope| {
                    for _ in 0..threads {
                        scope.spawn(|| run(set, &hits));
                    }
                });
            }));
        }
        let rate = (threads * hits.len()) as f64 / least;
        row(&format!("{set:?}").to_lowercase(), threads, step, rate, rate * plain);
    }
    let sampling = Sampling::new(DURATION, 2e5).unwrap();
    let method = FiniteDifference::default();
    let mut least = f64::INFINITY;
    let mut step = 0.0;
    for _ in 0..ROUNDS {
        least = least.min(timed(|| {
            let done = method.integrate(&structure, &pulse(32.0), &[Port::TOP], &sampling);
            step = done.unwrap().step;
        }));
    }
    row("finite differences, 1 mm", 1, step, 1.0 / least, plain_seconds[1] / least);
}

fn run(set: InstructionSet, hits: &[TransientCase]) {
    // As many taps as keep the band of the harmonics at a decimation by eight.
    let taps: Arc<[f64]> = vec![1.0 / 96.0; 96].into();
    let decimation = Arc::new(Decimation { factor: 8, taps, ending: 0 });
    for record in (Batch { instructions: set }).run(hits, &|_, _| Arc::clone(&decimation)) {
        black_box(record.unwrap());
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> f64 {
    let started = Instant::now();
    black_box(work());
    started.elapsed().as_secs_f64()
}

fn row(kernel: &str, cores: usize, step: f64, rate: f64, ratio: f64) {
    let lane_step = 1e9 * step * cores as f64 / (rate * DURATION);
    println!(
        "| {kernel} | {cores} | {:.3} | {rate:.0} | {lane_step:.2} | {ratio:.1} |",
        1e6 * step
    );
}

fn rig() -> Stack {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let law: Arc<dyn ContactLaw> =
        Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap());
    let guide = Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, Arc::clone(&law)).unwrap();
    let interfaces = vec![contact("guide-sample"), contact("sample-disc")];
    Stack::new(vec![guide, sample], interfaces, Support::Rigid, 9.81).unwrap()
}
