//! Hard structures, supports and durations for modal steps, against finite differences.

use crate::support::agreement::{RATE, agrees, attempt, off};
use crate::support::{
    AREA, constant, difference, every_law, modified, power, pulse, rig, rig_on, run_at,
};
use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator, Modal};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{LoadCase, TimeFunction};

#[test]
fn supports_from_very_soft_to_very_stiff() {
    for stiffness in [1e3, 1e6, 1e10, 1e13] {
        let support = Support::SpringMass { stiffness, mass: 3.0, damping_ratio: 0.05 };
        let stack = rig_on(&modified(), support);
        agrees(&format!("{stiffness:e}"), &stack, &pulse(20.0), (5e-3, 1e-3), (1e-3, 5e-3));
    }
}

fn guide_on(sample: f64) -> Stack {
    let contact = |name| Interface::new(name, AREA, modified()).unwrap();
    let bodies = vec![
        Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap(),
        Body::with_mass("sample", 0.015, sample, 71e9, 2710.0).unwrap(),
    ];
    Stack::new(bodies, vec![contact("upper"), contact("lower")], Support::Rigid, 9.81).unwrap()
}

#[test]
fn samples_from_a_milligram_to_a_tonne() {
    for mass in [1e-6, 1e-4, 1.0, 1e3] {
        agrees(&format!("{mass} kg"), &guide_on(mass), &pulse(20.0), (3e-3, 1e-3), (2e-3, 5e-3));
    }
}

/// A tenth of a kilogram hit hard: it lands and leaves again and again, apart most of the time.
#[test]
fn a_light_body_bounces_again_and_again() {
    for law in [every_law()[1].1.clone(), power()] {
        let body = Body::with_mass("light", 0.015, 0.1, 71e9, 2710.0).unwrap();
        let contact = Interface::new("contact", AREA, law).unwrap();
        let stack = Stack::new(vec![body], vec![contact], Support::Rigid, 50.0).unwrap();
        let strike = LoadCase::force(TimeFunction::Haversine { duration: 2e-4 }, 40.0);
        let run = attempt(&stack, Modal::default(), &strike, 10e-3).unwrap();
        let pressures = &run.history.interfaces[0].pressure;
        let landings = pressures.windows(2).filter(|p| p[0] == 0.0 && p[1] > 0.0).count();
        assert!(landings >= 3 && run.contacts[0].lost > 0.6 * 10e-3);
        agrees("light", &stack, &strike, (10e-3, 0.5e-3), (1e-2, 1e-2));
    }
}

fn chain(count: usize) -> Stack {
    let body = |i: usize| Body::new("body", 0.03 + 0.004 * i as f64, 3e-4, 71e9, 2710.0).unwrap();
    let contact = |_| Interface::new("contact", AREA, modified()).unwrap();
    let bodies = (0..count).map(body).collect();
    Stack::new(bodies, (0..count).map(contact).collect(), Support::Rigid, 200.0).unwrap()
}

/// With a step for the light bodies' own motions; the default is for the lowest of the chain.
#[test]
fn chains_of_up_to_sixteen_interfaces() {
    for count in [3, 5, 9, 16] {
        let stack = chain(count);
        let modal = Modal { step: Some(1e-6), modes_per_body: Some(4), ..Modal::default() };
        let modal = attempt(&stack, modal, &pulse(15.0), 3e-3).unwrap();
        let grid = FiniteDifference { cell: 0.5e-3, ..FiniteDifference::default() };
        let grid = attempt(&stack, grid, &pulse(15.0), 3e-3).unwrap();
        let default = attempt(&stack, Modal::default(), &pulse(15.0), 3e-3).unwrap();
        let (found, at_default) = (off(&modal, &grid), off(&default, &grid));
        assert!(found.0 < 2e-3 && found.1 < 2e-2, "{count}: {found:?}");
        assert!(at_default.0 < 5e-2, "{count}: {at_default:?}");
    }
    let error = attempt(&chain(17), Modal::default(), &pulse(15.0), 3e-3).unwrap_err();
    assert!(matches!(error, DynamicsError::Setting { value: 17.0, .. }), "{error:?}");
}

/// Until before the far end of the bar can have heard of it, with modes for that; and shorter
/// than any mode, where only the force and the account need be right.
#[test]
fn durations_shorter_than_anything_natural() {
    let stack = rig(&modified());
    let modal = Modal { modes_per_body: Some(150), ..Modal::default() };
    for duration in [4e-5, 1e-4, 3e-4] {
        let rate = 100.0 / duration;
        let grid = FiniteDifference { cell: 0.25e-3, ..FiniteDifference::default() };
        let run = run_at(&stack, &modal, RATE, &pulse(20.0), (duration, rate));
        let grid = run_at(&stack, &grid, RATE, &pulse(20.0), (duration, rate));
        let found =
            difference(&run.history.sensors[0].displacement, &grid.history.sensors[0].displacement);
        assert!(found < 1e-2, "{duration:e}: {found}");
    }
    for duration in [1e-12, 1e-9, 1e-6] {
        let run =
            run_at(&stack, &Modal::default(), RATE, &pulse(20.0), (duration, 10.0 / duration));
        assert_eq!(run.history.time.len(), 10);
        assert!(
            run.history.sensors[0].displacement.iter().all(|u| u.is_finite())
                && run.energy.input >= 0.0
        );
    }
}

/// Two hundred periods at resonance, where pressures grow far beyond what the force suggests: of
/// the bilateral spring below zero too.
#[test]
fn many_periods_at_resonance() {
    let sine =
        |amplitude, frequency| LoadCase::force(TimeFunction::Harmonic { frequency }, amplitude);
    let cell = 4e-3;
    for (amplitude, rate) in [(0.5, 0.0), (5.0, 20.0), (5.0, RATE)] {
        let run = |method: Integrator| {
            run_at(&rig(&constant()), &method, rate, &sine(amplitude, 831.98), (0.24, 2e4))
        };
        let grid = FiniteDifference { cell, ..FiniteDifference::default() };
        let found = off(&run(Modal::default().into()), &run(grid.into()));
        assert!(found.0 < 1e-2 && found.1 < 1e-2, "{found:?}");
    }
    agrees("modified", &rig(&modified()), &sine(5.0, 860.0), (0.24, cell), (2e-3, 1e-2));
}
