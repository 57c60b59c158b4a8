//! Friction across contacts and in guides: exact motions, limits, both integrators, energy.

use std::sync::Arc;

use crate::support::{
    AREA, Law, constant, difference, modified, power, pulse, rig, run_at, single_body, slope,
};
use asperity_dynamics::{
    Batch, Decimation, FiniteDifference, InstructionSet, Modal, ModalModel, Sampling, Transient,
    TransientCase,
};
use asperity_law::{Constant, Friction};
use asperity_mesh::{
    Body, ComponentModes, Interface, NormalMode, Port, PortPair, ResidualFlexibility, Stack,
};
use asperity_mesh::{ModeCount, Support};
use asperity_structure::{
    Damping, Guide, LoadCase, PreloadedContact, PreloadedStructure, TimeFunction,
};

/// The stack with these elements at its contacts, and in guides of its bodies.
fn with_friction(
    stack: &Stack,
    contacts: &[Option<Friction>],
    guides: &[Option<Friction>],
) -> Stack {
    let interfaces = stack.interfaces().iter().zip(contacts);
    let interfaces = interfaces.map(|(one, friction)| match friction {
        Some(friction) => one.clone().with_friction(*friction),
        None => one.clone(),
    });
    let bodies = stack.bodies().iter().zip(guides);
    let bodies = bodies.map(|(body, friction)| match friction {
        Some(friction) => body.clone().with_friction(*friction),
        None => body.clone(),
    });
    Stack::new(bodies.collect(), interfaces.collect(), *stack.support(), stack.gravity()).unwrap()
}

/// A mass of 1.61 kg on a spring, and its element.
const MASS: f64 = 1.61;
const SPRING: f64 = AREA * 8.5e11;

/// A rigid mass on a spring, with an element in a guide or across the contact.
fn rigid_mass(friction: Friction, in_guide: bool) -> PreloadedStructure<ComponentModes> {
    let shape = (1.0 / MASS).sqrt();
    let guides = if in_guide { vec![0] } else { Vec::new() };
    let contacts = vec![PortPair::on_ground(0)];
    let none = ResidualFlexibility::zero(1);
    let mode = NormalMode::rigid(vec![shape]);
    let modes = ComponentModes::new(vec![mode], none, contacts, guides).unwrap();
    let pressure = MASS * 9.81 / AREA;
    let contact = PreloadedContact::new("contact", AREA, constant(), pressure).unwrap();
    let contact = contact.with_friction((!in_guide).then_some(friction));
    let structure =
        PreloadedStructure::of_components(modes, vec![contact], Damping::Rate(0.0)).unwrap();
    let guides = in_guide.then(|| Guide::new("mass", friction, 0));
    structure.with_guides(guides.into_iter().collect()).unwrap()
}

/// Displacements at the steps of the mass by another method: steps 200 times shorter, the force of the
/// element known at their beginning.
fn by_short_steps(friction: Friction, force: &LoadCase, step: f64, count: usize) -> Vec<f64> {
    const PARTS: usize = 200;
    let h = step / PARTS as f64;
    let (mut x, mut before, mut element) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut at_before = 0.0;
    let mut found = vec![0.0];
    for n in 0..count * PARTS {
        let limit = friction.limit(MASS * 9.81 + SPRING * x);
        element = friction.force(element, x - at_before, limit);
        at_before = x;
        let push = force.value(n as f64 * h) * if n == 0 { 0.5 } else { 1.0 };
        let next = 2.0 * x - before + h * h / MASS * (push - SPRING * x - element);
        (before, x) = (x, next);
        if (n + 1) % PARTS == 0 {
            found.push(x);
        }
    }
    found
}

/// A hammer blow on the mass by modal steps of ever shorter length, with a slip force of its own and
/// one that is a share of the contact's, in a guide and across the contact.
#[test]
fn a_mass_on_a_spring_moves_as_by_steps_200_times_shorter() {
    let force = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 6.0);
    for (friction, contact) in [
        (Friction::slip_force(4e7, 0.4).unwrap(), "own"),
        (Friction::coefficient(4e7, 0.04).unwrap(), "share"),
    ] {
        for in_guide in [true, false] {
            let steps = [32e-6, 16e-6, 8e-6_f64];
            let errors = steps.map(|step| {
                let count = (6e-3 / step).round() as usize;
                let structure = rigid_mass(friction, in_guide);
                let model = Arc::new(ModalModel::new(structure, 0, &[0]).unwrap());
                let hit = TransientCase {
                    model,
                    sensor: 0,
                    load: force.clone(),
                    duration: count as f64 * step,
                    step: Some(step),
                    tolerance: None,
                };
                let sampling = Sampling::new(count as f64 * step, 1.0 / step).unwrap();
                let found = Batch::default().transient(&hit, &sampling).unwrap();
                let exact = by_short_steps(friction, &force, step, count - 1);
                let energy = found.energy;
                assert!(energy.friction_dissipated > 0.3 * energy.input, "{energy:?}");
                assert!(energy.residual_relative() < 1e-2 * (step / 16e-6), "{energy:?}");
                difference(&found.history.sensors[0].displacement, &exact)
            });
            let order = slope(&steps, &errors);
            let name = format!("{contact}, in guide: {in_guide}: {errors:?}, order {order}");
            // Kinks within steps: second order.
            assert!(order > 1.4 && errors[2] < 2e-3, "{name}");
        }
    }
}

/// Under friction alone the maxima of a free vibration fall by `4 R / K` a cycle, the classical
/// result for dry friction, until the mass sticks.
#[test]
fn maxima_fall_by_equal_amounts() {
    let (slip, stiff) = (0.1, 5e9);
    let structure = rigid_mass(Friction::slip_force(stiff, slip).unwrap(), true);
    let hit = TransientCase {
        model: Arc::new(ModalModel::new(structure, 0, &[0]).unwrap()),
        sensor: 0,
        load: LoadCase::force(TimeFunction::Haversine { duration: 0.6e-3 }, 8.0),
        duration: 0.012,
        step: Some(2e-6),
        tolerance: None,
    };
    let found = Batch::default().transient(&hit, &Sampling::new(0.012, 5e5).unwrap()).unwrap();
    let x = &found.history.sensors[0].displacement;
    let maxima: Vec<f64> =
        (600..x.len() - 1).filter(|&n| x[n] > x[n - 1] && x[n] >= x[n + 1]).map(|n| x[n]).collect();
    let fall = 4.0 * slip / SPRING;
    let moving = maxima.windows(2).take_while(|pair| pair[1] > 2.0 * fall);
    let falls: Vec<f64> = moving.map(|pair| (pair[0] - pair[1]) / fall).collect();
    assert!(falls.len() > 5, "{falls:?}");
    assert!(falls.iter().all(|fall| (fall - 1.0).abs() < 0.03), "{falls:?}");
}

/// An element that never slips across a contact is a spring beside it; one without slip force is
/// nothing.
#[test]
fn elements_that_never_or_always_slip_are_springs_or_nothing() {
    let force = pulse(12.0);
    let grid = FiniteDifference { cell: 3e-3, ..FiniteDifference::default() };
    let spring = 3e7;
    let stiffer: Law = Arc::new(Constant::new(8.5e11 + spring / AREA).unwrap());
    let plain = rig(&constant());
    let stuck = Some(Friction::slip_force(spring, 1e6).unwrap());
    let loose = Some(Friction::slip_force(spring, 0.0).unwrap());
    let window = (0.004, 2e5);
    for (name, stack, expected) in [
        ("stuck", with_friction(&plain, &[stuck; 2], &[None; 2]), rig(&stiffer)),
        ("loose", with_friction(&plain, &[loose; 2], &[loose; 2]), rig(&constant())),
    ] {
        // Modes are counted about the frequency without friction.
        let modal = Modal { step: Some(8e-6), modes_per_body: Some(4), ..Modal::default() };
        let found = run_at(&stack, &modal, 100.0, &force, window);
        let exact = run_at(&expected, &modal, 100.0, &force, window);
        let off = difference(
            &found.history.sensors[0].displacement,
            &exact.history.sensors[0].displacement,
        );
        assert!(off < 1e-9, "{name}, modal: {off}");
        let found = run_at(&stack, &grid, 100.0, &force, window);
        let exact = run_at(&expected, &grid, 100.0, &force, window);
        let off = difference(
            &found.history.sensors[0].displacement,
            &exact.history.sensors[0].displacement,
        );
        assert!(off < 1e-6, "{name}, finite differences: {off}");
    }
}

/// A guided body whose element never slips is a body on a spring at its mean displacement: a mass on
/// two springs, where the bar is rigid against them.
#[test]
fn a_stuck_guide_is_a_spring_on_the_body() {
    let spring = 4e7;
    let body = Body::with_mass("block", 0.01, MASS, 71e12, 2710.0).unwrap();
    let stack = |guide: Option<Friction>, law: Law| {
        let contact = Interface::new("contact", AREA, law).unwrap();
        let body = guide.map_or(body.clone(), |friction| body.clone().with_friction(friction));
        Stack::new(vec![body], vec![contact], Support::Rigid, 9.81).unwrap()
    };
    let stuck = stack(Some(Friction::slip_force(spring, 1e6).unwrap()), constant());
    let expected = stack(None, Arc::new(Constant::new(8.5e11 + spring / AREA).unwrap()));
    let force = pulse(5.0);
    for step in [None, Some(10e-6)] {
        let modal = Modal { step, ..Modal::default() };
        let found = run_at(&stuck, &modal, 50.0, &force, (0.004, 2e5));
        let exact = run_at(&expected, &modal, 50.0, &force, (0.004, 2e5));
        let off = difference(
            &found.history.sensors[0].displacement,
            &exact.history.sensors[0].displacement,
        );
        // The bar is 1e5 times as stiff as the springs.
        assert!(off < 2e-4, "{step:?}: {off}");
    }
}

fn residual(run: &Transient) -> f64 {
    run.energy.residual_relative()
}

/// Both integrators on the rig, with every place and kind of element: displacement, closures and
/// the loss by friction.
#[test]
fn both_integrators_agree_with_friction() {
    let own = |force: f64| Some(Friction::slip_force(3e7, force).unwrap());
    let share = |mu: f64| Some(Friction::coefficient(3e7, mu).unwrap());
    for (name, law, contacts, guides) in [
        ("guide bar", modified(), [None; 2], [own(0.3), None]),
        ("guide bar, share", modified(), [None; 2], [share(0.02), None]),
        ("both bodies", power(), [None; 2], [share(0.03), own(0.1)]),
        ("contacts", power(), [own(0.3), share(0.03)], [None; 2]),
        ("everything", modified(), [share(0.02), own(0.2)], [own(0.2), share(0.01)]),
    ] {
        let stack = with_friction(&rig(&law), &contacts, &guides);
        let modal = run_at(&stack, &Modal::default(), 200.0, &pulse(9.0), (0.015, 2e5));
        let grid = FiniteDifference { cell: 1.5e-3, ..FiniteDifference::default() };
        let grid = run_at(&stack, &grid, 200.0, &pulse(9.0), (0.015, 2e5));
        let off = difference(
            &modal.history.sensors[0].displacement,
            &grid.history.sensors[0].displacement,
        );
        let losses = [modal.energy.friction_dissipated, grid.energy.friction_dissipated];
        let apart = losses[0] / losses[1] - 1.0;
        assert!(off < 5e-3, "{name}: {off}");
        assert!(apart.abs() < 1e-2, "{name}: {losses:?}");
        assert!(losses[0] > 0.02 * modal.energy.input, "{name}: {losses:?}");
        assert!(residual(&modal) < 5e-3 && residual(&grid) < 5e-3, "{name}");
    }
}

/// Hits side by side, with and without friction and each with its own, are those hits alone, on
/// every set of instructions.
#[test]
fn hits_with_friction_do_not_depend_on_their_neighbours() {
    let model = |friction: Option<Friction>| {
        let stack = with_friction(&rig(&modified()), &[None, friction], &[friction, None]);
        let structure = PreloadedStructure::new(stack, Damping::Rate(200.0)).unwrap();
        Arc::new(
            ModalModel::of_stack(
                &structure,
                &ModeCount::PerBody(3).counts(structure.stack()).unwrap(),
                Port::TOP,
                &[Port::TOP],
            )
            .unwrap(),
        )
    };
    let models = [
        model(None),
        model(Some(Friction::slip_force(2e7, 0.2).unwrap())),
        model(Some(Friction::coefficient(4e7, 0.03).unwrap())),
    ];
    let hits: Vec<TransientCase> = (0..7)
        .map(|n| TransientCase {
            model: Arc::clone(&models[n % 3]),
            sensor: 0,
            load: pulse(4.0 + 3.0 * n as f64),
            duration: 0.01,
            step: None,
            tolerance: None,
        })
        .collect();
    let all = Decimation::every_step();
    let decimation = |_: usize, _: f64| Arc::clone(&all);
    for instructions in InstructionSet::available() {
        let batch = Batch { instructions };
        let together = batch.run(&hits, &decimation);
        for (hit, together) in hits.iter().zip(&together) {
            let alone = batch.run(std::slice::from_ref(hit), &decimation);
            let (alone, together) = (alone[0].as_ref().unwrap(), together.as_ref().unwrap());
            assert_eq!(alone.displacement, together.displacement, "{instructions:?}");
            assert_eq!(alone.energy, together.energy, "{instructions:?}");
        }
    }
}

/// A guide that is too stiff for the grid is refused with the reason.
#[test]
fn a_stiff_guide_is_refused_in_words() {
    let stiff = Some(Friction::slip_force(1e16, 0.2).unwrap());
    let stack = with_friction(&single_body(&constant(), 9.81), &[None], &[stiff]);
    let structure = PreloadedStructure::new(stack, Damping::Rate(0.0)).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    let error =
        FiniteDifference::default().integrate(&structure, &pulse(5.0), &[Port::TOP], &sampling);
    let text = error.unwrap_err().to_string();
    assert!(text.contains("friction in a guide") && text.contains("modal"), "{text}");
    assert!(Modal::default().integrate(&structure, &pulse(5.0), &[Port::TOP], &sampling).is_ok());
}
