//! Time of one hit by finite differences.
//!
//! `cargo bench -p asperity-dynamics` prints one table; each row is the least of several runs. A run is
//! one hit on the paper's rig at 1 mm cells, 0.12 s at 200 kHz, contact solve, output and energy ledger
//! included.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its rig is valid")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use asperity_dynamics::{FiniteDifference, Sampling};
use asperity_law::{Constant, ContactLaw, ModifiedPower, Power};
use asperity_mesh::{Body, Grid, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

const AREA: f64 = 1.15e-4;
const ROUNDS: usize = 5;

fn main() {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    let laws: [(&str, Arc<dyn ContactLaw>); 3] = [
        ("modified", Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap())),
        ("power", Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap())),
        ("constant", Arc::new(Constant::new(8.5e11).unwrap())),
    ];
    println!("law          ms a hit   ns a step   updates/s");
    for (name, law) in &laws {
        measure(name, law);
    }
}

fn measure(name: &str, law: &Arc<dyn ContactLaw>) {
    let stack = rig(law);
    let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035)).unwrap();
    let sampling = Sampling::new(0.12, 2e5).unwrap();
    let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 32.0);
    let nodes = Grid::new(structure.stack(), 1e-3).unwrap().nodes();

    let mut seconds = f64::INFINITY;
    let mut steps = 0;
    for _ in 0..ROUNDS {
        let started = Instant::now();
        let done = FiniteDifference::default()
            .integrate(&structure, &pulse, &[Port::TOP], &sampling)
            .unwrap();
        seconds = seconds.min(started.elapsed().as_secs_f64());
        steps = black_box(done).steps;
    }
    println!(
        "{name:<10} {:>10.2} {:>11.1} {:>11.2e}",
        1e3 * seconds,
        1e9 * seconds / steps as f64,
        (nodes * steps) as f64 / seconds,
    );
}

fn rig(law: &Arc<dyn ContactLaw>) -> Stack {
    let guide = Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, Arc::clone(law)).unwrap();
    let interfaces = vec![contact("guide-sample"), contact("sample-disc")];
    Stack::new(vec![guide, sample], interfaces, Support::Rigid, 9.81).unwrap()
}
