//! Cases that go on from a motion with the period of their load.

use std::sync::Arc;

use crate::support::AREA;
use asperity_dynamics::{Batch, DynamicsError, Modal, PeriodicMotion, Sampling, TransientCase};
use asperity_law::{Constant, ContactDamping, ContactLaw, Power};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// Steps in a period of the load, and periods until a motion from rest no longer changes.
const STEPS: usize = 2000;
const PERIODS: usize = 300;

fn bar(name: &str, length: f64, mass: f64) -> Body {
    Body::with_mass(name, length, mass, 71e9, 2710.0).unwrap()
}

/// A bar on a contact that opens, or on a bar and two contacts that hold.
fn structure(bodies: Vec<Body>, law: &Arc<dyn ContactLaw>) -> PreloadedStructure {
    let contact = |n: usize| Interface::new(&format!("contact {n}"), AREA, Arc::clone(law));
    let contacts = (0..bodies.len()).map(|n| contact(n).unwrap()).collect();
    let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
    PreloadedStructure::new(stack, Damping::Ratio(0.04)).unwrap()
}

/// A case under `share` of the weight of the upper body at `ratio` times the lowest natural frequency, over so many
/// periods.
fn case(
    structure: &PreloadedStructure,
    share: f64,
    ratio: f64,
    periods: usize,
) -> (TransientCase, f64) {
    let frequency = ratio * structure.natural_frequency().unwrap();
    let force = share * 9.81 * structure.stack().bodies()[0].mass();
    let load = LoadCase::force(TimeFunction::Harmonic { frequency }, force);
    let duration = periods as f64 / frequency;
    let sampling = Sampling::new(duration, STEPS as f64 * frequency).unwrap();
    let case = Modal::default().case(structure, &load, &[Port::TOP], &sampling).unwrap();
    let step = Some(1.0 / (frequency * STEPS as f64));
    (TransientCase { duration, step, ..case }, frequency)
}

/// A settled motion from rest and one that begins in it are the same from the first sample on, and the energy
/// balance of the second closes: contacts that hold and a contact that opens.
#[test]
fn a_settled_motion_goes_on() {
    let power: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let spring: Arc<dyn ContactLaw> = Arc::new(Constant::unilateral(1e12).unwrap());
    let block = || bar("block", 0.229, 1.61);
    for (structure, share, ratio, opens, close) in [
        (structure(vec![block(), bar("sample", 0.015, 0.3)], &power), 0.03, 0.95, false, 1e-6),
        (structure(vec![block()], &power), 0.25, 0.97, true, 1e-4),
        (structure(vec![block()], &spring), 0.6, 1.2, true, 1e-4),
    ] {
        let (whole, frequency) = case(&structure, share, ratio, PERIODS);
        let sampling = Sampling::new(whole.duration, STEPS as f64 * frequency).unwrap();
        let settled = Batch::default().transient(&whole, &sampling).unwrap().history;
        let period = (PERIODS - 2) * STEPS..(PERIODS - 1) * STEPS;
        let contacts = structure.contacts().iter().zip(&settled.interfaces);
        let (pressures, mean_closures) = contacts
            .map(|(contact, column)| {
                let pressures = column.pressure[period.clone()].iter();
                let closures = column.closure[period.clone()].iter();
                let mean = closures.sum::<f64>() / STEPS as f64 - contact.closure();
                (pressures.map(|p| p - contact.pressure()).collect(), mean)
            })
            .unzip();
        let lost = settled.interfaces[0].pressure[period.clone()].iter().any(|p| *p <= 0.0);
        assert_eq!(lost, opens, "{share} of the weight");
        let motion = PeriodicMotion { pressures, mean_closures };
        let (next, _) = case(&structure, share, ratio, 30);
        let found = Batch::default().run_from(&next, &motion).unwrap();
        let expected = &settled.sensors[0].displacement[period.clone()];
        let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        for (n, x) in found.displacement.iter().enumerate() {
            let off = (x - expected[n % STEPS]).abs() / largest;
            assert!(off < close, "{share} of the weight, sample {n}: {off:.1e}");
        }
        assert_eq!(found.displacement.len(), 30 * STEPS);
        assert_eq!(found.contacts[0].lost > 0.0, opens);
        let residual = found.energy.residual_relative();
        assert!(residual < 1e-5, "{residual:.1e}");
    }
}

/// Cases without such a state are refused by its quantity.
#[test]
fn other_motions_are_refused() {
    let power: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let structure = structure(vec![bar("block", 0.229, 1.61)], &power);
    let (good, _) = case(&structure, 0.03, 0.9, 5);
    let motion = PeriodicMotion { pressures: vec![vec![0.0; 64]], mean_closures: vec![0.0] };
    assert!(Batch::default().run_from(&good, &motion).is_ok());
    let refused = |case: &TransientCase, motion: &PeriodicMotion| match Batch::default()
        .run_from(case, motion)
    {
        Err(DynamicsError::Setting { quantity, .. }) => quantity,
        other => panic!("{other:?}"),
    };
    let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 1.0);
    let hit = TransientCase { load: pulse, ..good.clone() };
    assert!(refused(&hit, &motion).contains("frequency"));
    for step in [None, good.step.map(|step| 1.3 * step)] {
        let other = TransientCase { step, ..good.clone() };
        assert!(refused(&other, &motion).contains("steps in the period"));
    }
    let two = PeriodicMotion { pressures: vec![vec![0.0; 64]; 2], mean_closures: vec![0.0; 2] };
    assert!(refused(&good, &two).contains("contacts"));
    let few = PeriodicMotion { pressures: vec![vec![0.0; 15]], mean_closures: vec![0.0] };
    assert!(refused(&good, &few).contains("samples"));
    let short = TransientCase { duration: 5.0 * good.step.unwrap(), ..good.clone() };
    assert!(refused(&short, &motion).contains("duration"));
    let damping = ContactDamping::kelvin_voigt(1e-6).unwrap();
    let contact = Interface::new("contact", AREA, power).unwrap().with_damping(damping);
    let stack =
        Stack::new(vec![bar("block", 0.229, 1.61)], vec![contact], Support::Rigid, 9.81).unwrap();
    let damped = PreloadedStructure::new(stack, Damping::Ratio(0.04)).unwrap();
    assert!(refused(&case(&damped, 0.03, 0.9, 5).0, &motion).contains("damped contacts"));
}
