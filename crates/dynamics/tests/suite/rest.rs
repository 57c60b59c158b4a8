//! Without a force nothing moves; with a tiny one everything does, in proportion.

use crate::support::{
    DISC, difference, every_law, modified, pulse, rig, rig_on, run, three_bodies,
};
use asperity_dynamics::{
    ContactForm, FiniteDifference, InstructionSet, Integrator, Modal, Sampling,
};
use asperity_mesh::{Grid, Port};
use asperity_structure::{Damping, LoadCase, PreloadedStructure};

/// Coarse cells: the million steps are what counts.
fn coarse(contact: ContactForm) -> FiniteDifference {
    FiniteDifference { cell: 8e-3, contact, ..FiniteDifference::default() }
}

/// Exact: the perturbation form holds rest to the last bit, however many steps.
#[test]
fn a_rig_without_a_force_stays_at_rest_to_the_last_bit() {
    let mut rigs: Vec<_> = every_law().into_iter().map(|(name, law)| (name, rig(&law))).collect();
    rigs.push(("rig on a disc", rig_on(&modified(), DISC)));
    rigs.push(("three bodies", three_bodies(DISC)));
    for (name, stack) in rigs {
        let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(352.0)).unwrap();
        let critical =
            Grid::new(&stack, coarse(ContactForm::Centred).cell).unwrap().critical_step();
        let million = Sampling::new(1e6 * critical, 1e3).unwrap();
        // The steps of light bodies on stiff contacts, and some that are chosen.
        let modal = Modal { step: Some(1e-6), ..Modal::default() };
        let methods: [(Integrator, Sampling, usize); 4] = [
            (coarse(ContactForm::Centred).into(), million, 1_000_000),
            (coarse(ContactForm::NewLevel).into(), million, 1_000_000),
            (modal.into(), Sampling::new(0.12, 1e3).unwrap(), 100_000),
            (Modal::default().into(), Sampling::new(0.5, 12_345.6).unwrap(), 64),
        ];
        for (method, sampling, steps) in methods {
            let run =
                method.integrate(&structure, &LoadCase::none(), &[Port::TOP], &sampling).unwrap();
            assert!(run.steps >= steps, "{name}: only {} steps", run.steps);
            assert!(run.history.sensors[0].displacement.iter().all(|&u| u == 0.0), "{name}");
            assert!(run.history.sensors[0].acceleration.iter().all(|&a| a == 0.0), "{name}");
            for ((record, state), samples) in
                run.contacts.iter().zip(structure.contacts()).zip(&run.history.interfaces)
            {
                assert_eq!(record.pressure_min, state.pressure(), "{name}");
                assert_eq!(record.pressure_max, state.pressure(), "{name}");
                assert_eq!(record.lost, 0.0, "{name}");
                assert!(samples.closure.iter().all(|&d| d == state.closure()), "{name}");
                assert!(samples.stiffness.iter().all(|&k| k == state.stiffness()), "{name}");
            }
            assert_eq!(run.energy.input, 0.0, "{name}");
            assert_eq!(run.energy.stored(), 0.0, "{name}");
            assert_eq!(run.energy.dissipated, 0.0, "{name}");
        }
    }
}

/// The test above can fail: a pulse of 1e-9 N, 6e-11 of the weight, moves every
/// rig, and twice the pulse moves it twice as far.
#[test]
fn a_pulse_of_a_nanonewton_moves_the_rig_in_proportion() {
    for (name, law) in every_law() {
        let stack = rig(&law);
        let methods: [Integrator; 3] = [
            coarse(ContactForm::Centred).into(),
            coarse(ContactForm::NewLevel).into(),
            Modal::default().into(),
        ];
        for method in methods {
            let response = |peak: f64| {
                let samples = run(&stack, &method, &pulse(peak), 0.01).history.sensors[0]
                    .displacement
                    .clone();
                samples.into_iter().map(|u| u / peak).collect::<Vec<_>>()
            };
            let one = response(1e-9);
            let largest = one.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
            // The rig's stiffness is some 40 N/um.
            assert!((1e-8..1e-7).contains(&largest), "{name}: {largest} m/N");
            let off = difference(&response(2e-9), &one);
            // The pressure of 1e-5 Pa is 1e-10 of the static one; the law's table
            // places its argument to 1e-16 of its own length, some 1e-6 of that.
            // The uniform tables of modal steps are as long as the closures down to a millionth
            // of the pressure and half as far again, for m = 1.5 some thousand times the closure at rest.
            let tolerance = if name == "power, m = 1.5" { 2e-3 } else { 1e-5 };
            assert!(off < tolerance, "{name} {}: {off}", method.name());
        }
    }
}

/// A rig at rest is at rest on every instruction set.
#[test]
fn rest_holds_on_every_instruction_set() {
    let stack = rig(&modified());
    for instructions in InstructionSet::available() {
        let modal = Modal { instructions, ..Modal::default() };
        let run = run(&stack, &modal, &LoadCase::none(), 0.01);
        assert!(run.history.sensors[0].displacement.iter().all(|&u| u == 0.0), "{instructions:?}");
    }
}
