//! Friction: closed forms of the Masing loop, component modes against exact bars, integration in time.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_dynamics::{FiniteDifference, Modal, Sampling};
use asperity_harmonic::{
    ContactSystem, Continuation, Drive, FourierResolution, HarmonicSettings, LawEvaluation,
    LinearSystem, RigidMass, SteppedSineSolver, trace,
};
use asperity_law::{Constant, ContactDamping, Friction};
use asperity_mesh::{
    Body, ComponentModes, Interface, ModeCount, NormalMode, Port, PortPair, ResidualFlexibility,
    Stack, Support,
};
use asperity_structure::{Damping, LoadCase, PreloadedContact, PreloadedStructure, TimeFunction};
use num_complex::Complex64;

use crate::integration::harmonic;
use crate::rigs::{AREA, Law, MASS, modified, power, preloaded};

const RATE: f64 = 200.0;

/// Samples of a period of integration in time.
const SAMPLES: usize = 256;

/// A rigid bar on a linear contact with `friction` across it.
fn mass_on_spring(friction: Friction) -> ContactSystem {
    let law: Law = Arc::new(Constant::new(7e11).unwrap());
    let contact = PreloadedContact::new("contact", AREA, law, 1.37e5).unwrap();
    let mass = RigidMass::new(MASS, RATE).unwrap();
    let contacts = vec![contact.with_friction(Some(friction))];
    ContactSystem::new(Arc::new(mass), contacts, LawEvaluation::Exact).unwrap()
}

/// A single harmonic of a mass on a spring under friction has the storage and loss coefficients of the
/// Masing loop, in a branch from a stuck element through partial to full slip, to the second order in
/// the samples.
#[test]
fn a_single_harmonic_follows_the_masing_loop() {
    let (stiffness, limit) = (2e7, 0.4);
    let friction = Friction::slip_force(stiffness, limit).unwrap();
    let system = mass_on_spring(friction);
    let spring = 7e11 * AREA;
    let errors = [512, 1024, 2048].map(|samples| {
        let resolution = FourierResolution::Fixed { harmonics: 1, samples };
        let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
        let rising = Continuation::Force { frequency: 1100.0, from: 0.02, to: 8.0 };
        let branch = trace(&system, &rising, &settings).unwrap();
        assert!(branch.is_complete());
        let mut largest = 0.0_f64;
        let (mut stuck, mut slipping) = (0, 0);
        for point in &branch.points {
            let (x, w) = (point.amplitude(1), point.angular_frequency);
            let [storage, loss] = friction.harmonic_coefficients(x, limit);
            let real = spring + storage - MASS * w * w;
            let exact = point.force / real.hypot(MASS * RATE * w + loss);
            let off = (x / exact - 1.0).abs();
            if x < limit / stiffness {
                assert!(off < 1e-9, "stuck: {off:.1e}");
                stuck += 1;
            } else {
                largest = largest.max(off);
                slipping += 1;
            }
        }
        assert!(stuck > 2 && slipping > 10, "{stuck} {slipping}");
        largest
    });
    assert!(errors[2] < 2e-5, "{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.7, "order {order} of {errors:?}");
    }
}

/// The work of the force over a period is what damping and friction lose, with all harmonics.
#[test]
fn the_work_of_a_period_is_lost_to_damping_and_friction() {
    let friction = Friction::slip_force(3e7, 0.5).unwrap();
    let system = mass_on_spring(friction);
    let (force, frequency_hz) = (4.0, 1150.0);
    let found =
        SteppedSineSolver::new(&system, 25).sweep(&[Drive { frequency_hz, force }]).remove(0);
    let found = found.unwrap();
    let w = TAU * frequency_hz;
    let work = -std::f64::consts::PI * force * found.displacement.im;
    let harmonics = (1..).map(f64::from).zip(found.closures[1..].chunks_exact(2));
    let viscous: f64 = harmonics
        .map(|(k, pair)| {
            std::f64::consts::PI * MASS * RATE * w * k * k * (pair[0].powi(2) + pair[1].powi(2))
        })
        .sum();
    let [lowest, highest] = found.closure_range[0];
    let rubbed = friction.loss_per_cycle(0.5 * (highest - lowest), 0.5);
    assert!(rubbed > 0.2 * work, "{rubbed} of {work}");
    assert!(((viscous + rubbed) / work - 1.0).abs() < 1e-4, "{viscous} {rubbed} {work}");
}

/// The guide bar on one contact, with friction in the guide, across the contact, or both.
fn rig(law: &Law, guide: Option<Friction>, contact: Option<Friction>) -> PreloadedStructure {
    let bar = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    let bar = guide.map_or(bar.clone(), |friction| bar.with_friction(friction));
    let interface = Interface::new("contact", AREA, Arc::clone(law)).unwrap();
    let interface = contact.map_or(interface.clone(), |friction| interface.with_friction(friction));
    preloaded(Stack::new(vec![bar], vec![interface], Support::Rigid, 9.81).unwrap(), RATE)
}

/// Amplitudes of two harmonics of the top, integrated from rest until they are steady.
fn integrated(structure: &PreloadedStructure, drive: Drive, finite: bool) -> [f64; 2] {
    let Drive { frequency_hz, force } = drive;
    let periods = 200.0;
    let sampling = Sampling::new(periods / frequency_hz, SAMPLES as f64 * frequency_hz).unwrap();
    let excitation = LoadCase::force(TimeFunction::Harmonic { frequency: frequency_hz }, force);
    let history = if finite {
        let cells = FiniteDifference { cell: 5e-4, ..FiniteDifference::default() };
        cells.integrate(structure, &excitation, &[Port::TOP], &sampling).unwrap().history
    } else {
        let modes = Modal { modes_per_body: Some(8), step: Some(5e-7), ..Modal::default() };
        modes.integrate(structure, &excitation, &[Port::TOP], &sampling).unwrap().history
    };
    let all = &history.sensors[0].displacement;
    let last = &all[all.len() - SAMPLES..];
    [harmonic(last, 1), harmonic(last, 2)]
}

/// Amplitudes of two harmonics of the top by harmonic balance.
fn balanced(structure: &PreloadedStructure, drive: Drive) -> [f64; 2] {
    let system = ContactSystem::of_structure(structure, LawEvaluation::Exact).unwrap();
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 24, samples: 1024 },
        ..HarmonicSettings::default()
    };
    let rising = Continuation::Force {
        frequency: drive.frequency_hz,
        from: 1e-2 * drive.force,
        to: drive.force,
    };
    let branch = trace(&system, &rising, &settings).unwrap();
    assert!(branch.is_complete(), "{:?}", branch.termination);
    let last = branch.points.last().unwrap();
    [last.amplitude(1), last.amplitude(2)]
}

/// Both integrators meet harmonic balance: slip force and coefficient, in the guide and across a
/// contact, below resonance and next to it.
#[test]
fn responses_with_friction_meet_the_integration_in_time() {
    let fixed = Friction::slip_force(1e7, 0.2).unwrap();
    let coulomb = Friction::coefficient(1e7, 0.02).unwrap();
    let across = Friction::slip_force(5e7, 1.0).unwrap();
    let across_coulomb = Friction::coefficient(5e7, 0.08).unwrap();
    let cases = [
        ("guide, slip force", modified(), Some(fixed), None, 3.0, 960.0),
        ("guide, coefficient", modified(), Some(coulomb), None, 3.0, 960.0),
        ("contact, slip force", power(), None, Some(across), 5.0, 1150.0),
        ("contact, coefficient", power(), None, Some(across_coulomb), 5.0, 1150.0),
        ("both", power(), Some(coulomb), Some(fixed), 4.0, 1130.0),
    ];
    for (name, law, guide, contact, force, frequency_hz) in cases {
        let structure = rig(&law, guide, contact);
        let drive = Drive { frequency_hz, force };
        let found = balanced(&structure, drive);
        let modal = integrated(&structure, drive, false);
        let finite = integrated(&structure, drive, true);
        let without = balanced(&rig(&law, None, None), drive);
        for k in 0..2 {
            let off = (found[k] - modal[k]).abs() / modal[0];
            assert!(off < 1e-4, "{name}, harmonic {}: {off:.1e} from modes", k + 1);
            let off = (found[k] - finite[k]).abs() / finite[0];
            assert!(off < 1e-4, "{name}, harmonic {}: {off:.1e} from cells", k + 1);
        }
        assert!((found[0] / without[0] - 1.0).abs() > 0.05, "{name}: friction hardly matters");
    }
}

/// Random bars on one contact with viscous damping of the contact and friction in a guide or across it,
/// near resonance: both integrators meet harmonic balance.
#[test]
fn random_damped_structures_meet_the_integration_in_time() {
    let mut state = 7_u64;
    let mut random = |low: f64, high: f64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for seed in 0..4 {
        let mass = random(0.8, 2.5);
        let bar = Body::with_mass("bar", random(0.1, 0.25), mass, 71e9, 2710.0).unwrap();
        let law = if seed % 2 == 0 { power() } else { modified() };
        let time = random(1e-6, 6e-6);
        let contact = Interface::new("contact", AREA, law).unwrap();
        let contact = contact.with_damping(ContactDamping::kelvin_voigt(time).unwrap());
        let friction = Friction::coefficient(random(5e6, 2e7), random(0.01, 0.03)).unwrap();
        let (bar, contact) = if seed < 2 {
            (bar.with_friction(friction), contact)
        } else {
            (bar, contact.with_friction(friction))
        };
        let structure =
            preloaded(Stack::new(vec![bar], vec![contact], Support::Rigid, 9.81).unwrap(), RATE);
        let frequency_hz = random(0.95, 1.05) * structure.natural_frequency().unwrap();
        let drive = Drive { frequency_hz, force: random(0.1, 0.25) * mass * 9.81 };
        let found = balanced(&structure, drive);
        // Finite differences take most of the time.
        let engines = if seed % 3 == 0 { &[false, true][..] } else { &[false] };
        for &finite in engines {
            let other = integrated(&structure, drive, finite);
            for k in 0..2 {
                let off = (found[k] - other[k]).abs() / other[0];
                assert!(off < 3e-4, "seed {seed}, cells {finite}, harmonic {}: {off:.1e}", k + 1);
            }
        }
    }
}

/// The same structure in component modes, guides on bars that are not at the top included, and on a
/// support that moves: means, amplitudes and backbones.
#[test]
fn component_modes_with_guides_are_the_exact_bars() {
    let friction = Friction::coefficient(2e7, 0.05).unwrap();
    let bar = |name, length, mass| Body::with_mass(name, length, mass, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, power()).unwrap();
    let bodies = vec![
        bar("top", 0.2, 1.6),
        bar("middle", 0.1, 0.9).with_friction(friction),
        bar("foot", 0.1, 0.5).with_friction(Friction::slip_force(1e7, 0.1).unwrap()),
    ];
    let contacts = vec![contact("a"), contact("b"), contact("c")];
    let disc = Support::SpringMass { stiffness: 3e8, mass: 0.7, damping_ratio: 0.02 };
    let stack = Stack::new(bodies, contacts, disc, 9.81).unwrap();
    let exact = preloaded(stack, 300.0);
    let reduced = exact.reduced(ModeCount::Lowest(60), &[Port::TOP]).unwrap();
    assert_eq!(LinearSystem::guides(&reduced).len(), 2);
    let systems = [
        ContactSystem::of_structure(&exact, LawEvaluation::Exact).unwrap(),
        ContactSystem::of_structure(&reduced, LawEvaluation::Exact).unwrap(),
    ];
    let resolution = FourierResolution::Fixed { harmonics: 9, samples: 512 };
    let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
    let rising = Continuation::Force { frequency: 330.0, from: 0.1, to: 6.0 };
    let [bars, modes] = systems.map(|system| {
        let branch = trace(&system, &rising, &settings).unwrap();
        assert!(branch.is_complete());
        branch.points.last().unwrap().clone()
    });
    assert!((bars.amplitude(1) / modes.amplitude(1) - 1.0).abs() < 1e-4);
    assert!((bars.mean_displacement / modes.mean_displacement - 1.0).abs() < 1e-3);
    let largest = bars.closures.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in bars.closures.iter().zip(&modes.closures) {
        assert!((a - b).abs() < 1e-3 * largest, "{a} {b}");
    }
}

/// A rigid bar on two contacts side by side is one on a contact of their areas: forces balance
/// as they are, whatever the stiffness of each contact.
#[test]
fn contacts_side_by_side_are_one_contact() {
    let shape = MASS.sqrt().recip();
    let structure = |areas: &[f64]| {
        let mode = NormalMode::rigid(vec![shape]);
        let contacts = vec![PortPair::on_ground(0); areas.len()];
        let residual = ResidualFlexibility::zero(1);
        let modes = ComponentModes::new(vec![mode], residual, contacts, vec![]);
        let contact = |&area: &f64| PreloadedContact::new("contact", area, modified(), 1.37e5);
        let contacts = areas.iter().map(contact).collect::<Result<Vec<_>, _>>().unwrap();
        PreloadedStructure::of_components(modes.unwrap(), contacts, Damping::Rate(RATE)).unwrap()
    };
    let found = [vec![0.2 * AREA, 0.8 * AREA], vec![AREA]].map(|areas| {
        let system = ContactSystem::of_structure(&structure(&areas), LawEvaluation::Exact);
        let system = system.unwrap();
        let drive = Drive { frequency_hz: 1000.0, force: 3.0 };
        SteppedSineSolver::new(&system, 8).sweep(&[drive]).remove(0).unwrap()
    });
    let mean = found[1].closures[0];
    assert!(mean.abs() > 0.05 * found[1].displacement.norm(), "{mean}");
    assert!((found[0].closures[0] / mean - 1.0).abs() < 1e-9);
    assert!((found[0].displacement / found[1].displacement - Complex64::ONE).norm() < 1e-9);
}
