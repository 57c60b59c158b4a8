//! Modal steps against exact results: natural frequencies, the energy balance, and samples that
//! do not fall on steps.

use crate::support::{
    DISC, constant, difference, modified, power, pulse, rig, rig_on, run, run_at, slope,
};
use crate::support::{at_rest, three_bodies};
use asperity_dynamics::{Modal, Transient};
use asperity_mesh::{ModeCount, Support};
use asperity_structure::{LoadCase, TimeFunction};

/// The exact transcendental root (that of `modes` solves the closed form, see tests there) as
/// modes are added: the inertia left out falls with their third power.
#[test]
fn the_natural_frequency_tends_to_the_exact_root() {
    let stacks = [
        ("rig", rig(&constant())),
        ("disc", rig_on(&power(), DISC)),
        ("three", three_bodies(DISC)),
    ];
    for (name, stack) in stacks {
        let structure = at_rest(&stack);
        let exact = structure.natural_frequency().unwrap();
        let counts = [1, 2, 4, 8, 16, 32];
        let errors = counts.map(|count| {
            let reduced = structure.reduced(ModeCount::PerBody(count), &[]).unwrap();
            reduced.natural_frequency().unwrap() / exact - 1.0
        });
        // A structure without some of its inertia is too fast, never too slow.
        assert!(errors[..4].iter().all(|&error| error > 0.0), "{name}: {errors:?}");
        assert!(errors[0] < 1e-2 && errors[5].abs() < 1e-9, "{name}: {errors:?}");
        let order = slope(
            &counts[1..5].iter().map(|&n| f64::from(n as u32)).collect::<Vec<_>>(),
            &errors[1..5],
        );
        assert!(order < -2.7, "{name}: {order}");
    }
}

fn fixed(step: f64) -> Modal {
    Modal { step: Some(step), modes_per_body: Some(6), ..Modal::default() }
}

/// Closes at the end and halfway, while all kinds of energy count; and better with the step.
#[test]
fn the_balance_closes_and_shrinks_with_the_step() {
    let stacks = [
        ("modified", rig(&modified()), 0.5),
        ("constant", rig(&constant()), 0.5),
        ("disc", rig_on(&modified(), DISC), 0.5),
        ("three", three_bodies(DISC), 0.1),
    ];
    for (name, stack, share) in stacks {
        for duration in [1e-3, 2.3e-3, 0.12] {
            let steps = [1e-5, 5e-6, 2.5e-6];
            let runs = steps.map(|step| run(&stack, &fixed(step), &pulse(10.0), duration));
            let residuals = runs.each_ref().map(|run| run.energy.residual_relative());
            for run in &runs {
                let energy = &run.energy;
                assert_eq!(energy.numerical_loss, 0.0);
                assert!(energy.input > 0.0 && energy.dissipated > 0.0);
                if duration < 0.1 {
                    assert!(energy.kinetic > 0.0 && energy.elastic > 0.0 && energy.contact > 0.0);
                    assert!(energy.stored() > 0.1 * share * energy.input, "{name} {energy:?}");
                }
            }
            // Found 4e-5 at most, with slope 3 but for the three bodies, one of which is light.
            assert!(
                residuals[2] < 1e-4 && residuals[2] < 0.6 * residuals[0],
                "{name} {residuals:?}"
            );
        }
    }
}

/// The balance counts the loss in the damper of a support, and undamped energy stays.
#[test]
fn undamped_energy_stays_and_the_support_takes_its_share() {
    let free = Support::SpringMass { stiffness: 2e8, mass: 3.0, damping_ratio: 0.0 };
    let strike = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 32.0);
    for stack in [rig(&constant()), rig_on(&constant(), free)] {
        for duration in [2e-3, 0.1] {
            let run = run_at(&stack, &fixed(2e-6), 0.0, &strike, (duration, 2e5));
            let off = run.energy.stored() / run.energy.input - 1.0;
            assert_eq!(run.energy.dissipated, 0.0);
            assert!(off.abs() < 1e-4, "{off}");
        }
    }
    let damped = run_at(&rig_on(&power(), DISC), &fixed(5e-7), 0.0, &strike, (0.01, 2e5)).energy;
    assert!(damped.dissipated > 0.05 * damped.input && damped.residual_relative() < 1e-3);
}

/// The same motion at any output rate: every tenth sample of ten times the rate, on steps, between
/// them, many to a step or many steps apart, and never in step with them.
#[test]
fn the_motion_does_not_depend_on_the_output_rate() {
    for (name, stack) in [("power", rig(&power())), ("disc", rig_on(&modified(), DISC))] {
        let at = |rate: f64| run_at(&stack, &fixed(1e-5), 352.0, &pulse(32.0), (5e-3, rate));
        for rate in [1e5, 2e4, 1e3, 173_205.08, 31_415.9, 7e6 / 9.0] {
            let (once, tenfold) = (at(rate), at(10.0 * rate));
            let tenth = |column: &[f64]| column.iter().step_by(10).copied().collect::<Vec<_>>();
            let columns = |run: &Transient| {
                let history = &run.history;
                let interface = history.interfaces[0].clone();
                let all = [
                    history.sensors[0].displacement.clone(),
                    history.sensors[0].acceleration.clone(),
                ];
                all.into_iter().chain([interface.pressure, interface.closure]).collect::<Vec<_>>()
            };
            for (k, (a, b)) in columns(&once).iter().zip(columns(&tenfold)).enumerate() {
                let off = difference(&a[..], &tenth(&b)[..a.len()]);
                // A place in a step is known to the round-off of the time.
                assert!(off < 1e-8, "{name}, {rate} Hz, column {k}: {off}");
            }
            // A sample more or less at the end may take a step more.
            if once.steps == tenfold.steps {
                assert_eq!(once.contacts, tenfold.contacts);
                assert_eq!(once.energy, tenfold.energy);
            }
        }
    }
}

/// Between steps of 10 us the motion is that of a step a hundredth as long.
#[test]
fn samples_between_steps_are_on_the_motion() {
    let stack = rig_on(&modified(), DISC);
    let at = |step: f64| run_at(&stack, &fixed(step), 352.0, &pulse(20.0), (5e-3, 1.37e6)).history;
    let (coarse, fine) = (at(1e-5), at(1e-7));
    let displacement = difference(&coarse.sensors[0].displacement, &fine.sensors[0].displacement);
    let pressure = difference(&coarse.interfaces[0].pressure, &fine.interfaces[0].pressure);
    let acceleration = difference(&coarse.sensors[0].acceleration, &fine.sensors[0].acceleration);
    assert!(displacement < 2e-4 && pressure < 5e-3 && acceleration < 0.1);
}
