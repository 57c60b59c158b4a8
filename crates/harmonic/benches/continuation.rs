//! Microseconds per continuation point, against harmonics, interfaces and stability.
//!
//! `cargo bench -p asperity-harmonic` prints two tables. A row is the least of several branches
//! over a resonance, everything included: start, steps, Newton iterations, observables and located
//! peaks. The single mass is the reference case of the tests; the rig has elastic bars.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its systems are valid")]

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    RigidMass, trace,
};
use asperity_law::{ContactLaw, InSeries, Power};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};

const AREA: f64 = 1.15e-4;
const ROUNDS: usize = 20;

fn main() {
    println!("single mass, one contact, 0.55279 N, 767 to 1054 Hz");
    println!("law        harmonics  samples  stability      points   us a point");
    let continuation = Continuation::Frequency { force: 0.55279, from: 767.0, to: 1054.0 };
    for (name, evaluation) in
        [("tabulated", LawEvaluation::default()), ("exact", LawEvaluation::Exact)]
    {
        let system = single_mass(evaluation);
        for (harmonics, samples) in [(3, 64), (7, 128), (15, 256), (31, 512)] {
            measure(name, &system, &continuation, (harmonics, samples), None);
        }
        measure(name, &system, &continuation, (7, 128), Some(Floquet::default()));
    }
    println!();
    println!("elastic bars, tabulated power law, 0.55279 N");
    println!("interfaces harmonics  samples  stability      points   us a point");
    for interfaces in 1..=4 {
        let system = bars(interfaces);
        // Softer with every interface; the window follows the resonance.
        let centre = 1180.0 / (0.7 * interfaces as f64).sqrt();
        let continuation =
            Continuation::Frequency { force: 0.55279, from: 0.7 * centre, to: 1.3 * centre };
        for harmonics in [7, 15] {
            let name = interfaces.to_string();
            measure(&name, &system, &continuation, (harmonics, 128), None);
        }
        let name = interfaces.to_string();
        measure(&name, &system, &continuation, (7, 128), Some(Floquet::default()));
    }
}

fn measure(
    name: &str,
    system: &ContactSystem,
    continuation: &Continuation,
    (harmonics, samples): (usize, usize),
    stability: Option<Floquet>,
) {
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics, samples },
        stability,
        ..HarmonicSettings::default()
    };
    let (mut least, mut points) = (f64::INFINITY, 0);
    for _ in 0..ROUNDS {
        let started = Instant::now();
        let branch = black_box(trace(system, continuation, &settings).unwrap());
        least = least.min(started.elapsed().as_secs_f64());
        points = branch.points.len();
    }
    let label = stability.map_or("-".to_owned(), |floquet| format!("{} modes", floquet.modes));
    println!(
        "{name:<10} {harmonics:>9}  {samples:>7}  {label:<12} {points:>8}   {:>10.1}",
        1e6 * least / points as f64
    );
}

fn single_mass(evaluation: LawEvaluation) -> ContactSystem {
    let contacts = Power::new(0.5 * 1.81e10, 0.35, 0.0).unwrap();
    let law = InSeries::new(contacts, 71e9 / 0.015).unwrap();
    let pressure = 1.61 * 9.81 / AREA;
    let rate = 2.0 * 0.035 * (AREA * law.stiffness(pressure) / 1.61).sqrt();
    let contact = PreloadedContact::new("contacts", AREA, Arc::new(law), pressure).unwrap();
    ContactSystem::new(Arc::new(RigidMass::new(1.61, rate).unwrap()), vec![contact], evaluation)
        .unwrap()
}

fn bars(interfaces: usize) -> ContactSystem {
    let law = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let mut bodies = vec![Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap()];
    for _ in 1..interfaces {
        bodies.push(Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap());
    }
    let contact = |_: &Body| Interface::new("contact", AREA, law.clone()).unwrap();
    let contacts = bodies.iter().map(contact).collect();
    let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
    let structure = PreloadedStructure::new(stack, Damping::Rate(420.0)).unwrap();
    ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap()
}
