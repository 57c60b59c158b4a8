//! Internal damping of bodies by both integrators: closed forms of Rayleigh damping, random rigs, orders.

use std::f64::consts::TAU;

use crate::damped_engines::{Draw, off};
use crate::damping::ratio_of_decay;
use crate::support::{AREA, constant, damped, difference, every_law, modified, power, pulse};
use crate::support::{rig, run_at, single_body, slope, three_bodies};
use asperity_dynamics::{
    ContactForm, DynamicsError, FiniteDifference, Integrator, Modal, Sampling,
};
use asperity_law::ContactDamping;
use asperity_mesh::{Body, BodyDamping, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// The stack with the retardation time b \[s\] in its bodies and contacts.
fn rayleigh(stack: &Stack, b: f64) -> Stack {
    damped(stack, ContactDamping::kelvin_voigt(b).unwrap())
        .with_body_damping(BodyDamping::kelvin_voigt(b).unwrap())
}

/// `zeta = a / (2 w) + b w / 2` of the lowest mode, in the free decay of both integrators.
#[test]
fn free_decay_under_rayleigh_damping_has_its_closed_form() {
    let pulse = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 9.0);
    let (a, b) = (60.0, 6e-6);
    let stack = rayleigh(&rig(&constant()), b);
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(a)).unwrap();
    let w = TAU * structure.natural_frequency().unwrap();
    let expected = 0.5 * a / w + 0.5 * b * w;
    let decay = |method: Integrator| {
        let run = run_at(&stack, &method, a, &pulse, (0.03, 1e6));
        assert!(run.energy.residual_relative() < 5e-4);
        ratio_of_decay(&run.history.sensors[0].displacement, run.history.time[1], 2e-3)
    };
    let grid = FiniteDifference { cell: 4e-3, ..FiniteDifference::default() };
    for method in [Modal::default().into(), grid.into()] {
        let (ratio, maxima) = decay(method);
        let off = ratio / expected - 1.0;
        assert!(maxima > 12 && off.abs() < 1e-3, "{method:?}: {ratio} {expected}");
    }
}

/// With one mode a body the loss is that of many: the massless modes carry it. Most of the strain is in
/// the polymer.
#[test]
fn flexibility_of_modes_left_out_is_damped() {
    let soft = three_bodies(Support::Rigid);
    let stack = soft.with_body_damping(BodyDamping::kelvin_voigt(4e-6).unwrap());
    let force = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 9.0);
    let loss = |modes: usize| {
        let method = Modal { step: Some(4e-7), modes_per_body: Some(modes), ..Modal::default() };
        let run = run_at(&stack, &method, 0.0, &force, (4e-3, 2e5));
        assert!(run.energy.residual_relative() < 1e-4);
        run.energy.dissipated / run.energy.input
    };
    let [one, two, many] = [1, 2, 20].map(loss);
    assert!(many > 0.05, "{many}");
    assert!(
        (two / many - 1.0).abs() < 1e-2 && (one / many - 1.0).abs() < 3e-2,
        "{one} {two} {many}"
    );
}

/// A rig of one or two bodies with retardation times, on laws and contact dampings of their own.
fn random_rig(seed: u64) -> (Stack, LoadCase, f64) {
    let mut draw = Draw(seed);
    let count = 1 + usize::from(draw.number() < 0.7);
    let bodies = [
        Body::with_mass("guide bar", draw.between(0.1, 0.3), draw.between(0.8, 2.5), 71e9, 2710.0),
        Body::new("sample", draw.between(0.01, 0.03), AREA, 71e9, 2710.0),
    ];
    let bodies: Vec<Body> = bodies
        .into_iter()
        .take(count)
        .map(|body| {
            let time = draw.between(2e-7, 4e-6);
            body.unwrap().with_damping(BodyDamping::kelvin_voigt(time).unwrap())
        })
        .collect();
    let laws = every_law();
    let interfaces = (0..count).map(|at| {
        let contact = Interface::new(&format!("{at}"), AREA, draw.of(&laws).1).unwrap();
        if draw.number() < 0.5 {
            return contact;
        }
        contact.with_damping(ContactDamping::kelvin_voigt(draw.between(1e-6, 1e-5)).unwrap())
    });
    let interfaces = interfaces.collect();
    let disc = Support::SpringMass { stiffness: 2e8, mass: 3.0, damping_ratio: 0.05 };
    let support = draw.of(&[Support::Rigid, disc]);
    let peak = draw.between(4.0, 25.0);
    let force =
        draw.of(&[pulse(peak), LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, peak)]);
    let rate = draw.of(&[0.0, 300.0]);
    (Stack::new(bodies, interfaces, support, 9.81).unwrap(), force, rate)
}

/// Finite differences tend to modal steps, losses included, and both balances close.
#[test]
fn both_integrators_agree_on_random_rigs_with_damped_bodies() {
    let mut failures = Vec::new();
    for seed in 1..=16 {
        let (stack, force, rate) = random_rig(seed);
        let run = |method: Integrator| run_at(&stack, &method, rate, &force, (4e-3, 2e5));
        let fine =
            run(Modal { step: Some(4e-7), modes_per_body: Some(16), ..Modal::default() }.into());
        let grid = |cell| FiniteDifference { cell, ..FiniteDifference::default() };
        let [coarse, finest] = [4e-3, 1.5e-3].map(|cell| run(grid(cell).into()));
        let default = run(Modal::default().into());
        let offs = [&coarse, &finest, &default].map(|run| off(run, &fine));
        let losses = [&finest, &default, &fine].map(|run| run.energy.dissipated / run.energy.input);
        let residuals = [&finest, &default, &fine].map(|run| run.energy.residual_relative());
        let opens = fine.contacts.iter().any(|contact| contact.lost > 0.0);
        let same = if opens { 2e-3 } else { 3e-4 };
        let agrees = offs[1] < (0.7 * offs[0]).max(same) && offs[1] < 1e-2 && offs[2] < 5e-2;
        let balanced = residuals.iter().all(|residual| *residual < 1e-3);
        let lost = losses.iter().all(|loss| (loss - losses[2]).abs() < 4e-3);
        if !(agrees && balanced && lost) {
            failures.push(format!("{seed}: {offs:?} {losses:?} {residuals:?}"));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Rigid modes with the damped flexibility of all others, against a hundredth of the step: second order.
#[test]
fn modal_steps_with_damped_bodies_converge() {
    for (stack, b) in [(single_body(&constant(), 9.81), 4e-6), (rig(&power()), 2e-6)] {
        let stack = stack.with_body_damping(BodyDamping::kelvin_voigt(b).unwrap());
        let at = |step: f64| {
            let method = Modal { step: Some(step), modes_per_body: Some(1), ..Modal::default() };
            run_at(&stack, &method, 0.0, &pulse(9.0), (4e-3, 1e5))
        };
        let exact = at(1e-7);
        let steps = [5e-6, 2.5e-6, 1.25e-6];
        let errors = steps.map(|step| {
            difference(
                &at(step).history.sensors[0].displacement,
                &exact.history.sensors[0].displacement,
            )
        });
        let order = slope(&steps, &errors);
        assert!(order > 1.85 && errors[0] < 1e-4, "{order} {errors:?}");
    }
}

/// The finite differences converge in the cell, their steps at the limit of stability.
#[test]
fn finite_differences_with_damped_bodies_converge() {
    let b = 1e-6;
    let stack = rig(&modified()).with_body_damping(BodyDamping::kelvin_voigt(b).unwrap());
    let fine = Modal { step: Some(4e-7), modes_per_body: Some(20), ..Modal::default() };
    let exact = run_at(&stack, &fine, 300.0, &pulse(20.0), (4e-3, 2e5));
    let run = |cells: f64, courant: f64, contact: ContactForm| {
        let cell = 0.015 / cells;
        let method = FiniteDifference { cell, courant, contact };
        run_at(&stack, &method, 300.0, &pulse(20.0), (4e-3, 2e5))
    };
    let error = |run: &asperity_dynamics::Transient| {
        difference(&run.history.sensors[0].displacement, &exact.history.sensors[0].displacement)
    };
    let sizes = [7.0, 15.0, 31.0];
    let errors = sizes.map(|cells| error(&run(cells, 0.95, ContactForm::Centred)));
    let order = slope(&sizes.map(|cells| 1.0 / cells), &errors);
    assert!(order > 1.5 && errors[0] < 1e-3, "{order} {errors:?}");
    // Right up to the limit.
    assert!(error(&run(7.0, 0.999, ContactForm::Centred)) < 1e-3);
    assert!(error(&run(7.0, 0.999, ContactForm::NewLevel)) < 2e-2);
}

/// A loss factor has no motion in time.
#[test]
fn a_loss_factor_is_refused_by_name() {
    let stack = rig(&modified()).with_body_damping(BodyDamping::loss_factor(0.01).unwrap());
    let structure = PreloadedStructure::new(stack, Damping::Rate(0.0)).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    let methods: [Integrator; 2] = [Modal::default().into(), FiniteDifference::default().into()];
    for method in methods {
        let error = method.integrate(&structure, &pulse(9.0), &[Port::TOP], &sampling).unwrap_err();
        assert_eq!(error, DynamicsError::LossFactor { body: "guide bar".to_owned() });
    }
}
