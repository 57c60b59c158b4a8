//! Damped contacts by both integrators: random rigs, the modal engine's order, its batches.

use std::sync::Arc;

use crate::support::{AREA, Law, damped, difference, every_law, pulse, rig, run_at, slope};
use crate::support::{constant, modified, power, single_body};
use asperity_dynamics::{
    Batch, Decimation, FiniteDifference, Integrator, Modal, ModalModel, Transient, TransientCase,
};
use asperity_law::ContactDamping;
use asperity_mesh::{Body, Interface, ModeCount, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

/// Numbers between 0 and 1 from a seed.
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    pub(crate) fn number(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.number())
    }

    pub(crate) fn of<T: Clone>(&mut self, all: &[T]) -> T {
        all[(self.number() * all.len() as f64) as usize].clone()
    }
}

pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) stack: Stack,
    pub(crate) force: LoadCase,
    pub(crate) rate: f64,
}

/// A rig of one or two bodies whose contacts have laws and dampings of their own.
pub(crate) fn case(seed: u64) -> Case {
    let mut draw = Draw(seed);
    let mut names = Vec::new();
    let count = 1 + usize::from(draw.number() < 0.7);
    let bodies = [
        Body::with_mass("guide bar", draw.between(0.1, 0.3), draw.between(0.8, 2.5), 71e9, 2710.0),
        Body::new("sample", draw.between(0.01, 0.03), AREA, 71e9, 2710.0),
    ];
    let bodies: Vec<Body> = bodies.into_iter().take(count).map(Result::unwrap).collect();
    let laws = every_law();
    let interfaces = (0..count).map(|at| {
        let (name, law): (&str, Law) = draw.of(&laws);
        let contact = Interface::new(&format!("{at}"), AREA, law).unwrap();
        let damping = match (draw.number() * 4.0) as u32 {
            0 => None,
            1 => Some(ContactDamping::kelvin_voigt(draw.between(1e-6, 2e-5)).unwrap()),
            2 => Some(ContactDamping::loss_ratio(draw.between(0.01, 0.1), 800.0).unwrap()),
            _ => {
                let (coefficient, exponent) = (draw.between(1e6, 1e7), 2.0 * draw.number());
                Some(ContactDamping::power(coefficient, 1.4e5, exponent).unwrap())
            }
        };
        names.push(format!("{name}, {damping:?}"));
        damping.map_or(contact.clone(), |damping| contact.with_damping(damping))
    });
    let interfaces = interfaces.collect();
    let disc = Support::SpringMass { stiffness: 2e8, mass: 3.0, damping_ratio: 0.05 };
    let support = draw.of(&[Support::Rigid, disc]);
    let peak = draw.between(4.0, 30.0);
    let force = draw.of(&[
        pulse(peak),
        LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, peak),
        LoadCase::force(TimeFunction::HalfSine { duration: 0.8e-3 }, -0.4 * peak),
        LoadCase::force(TimeFunction::Harmonic { frequency: 600.0 }, 0.2 * peak),
    ]);
    let stack = Stack::new(bodies, interfaces, support, 9.81).unwrap();
    let rate = draw.of(&[0.0, 300.0]);
    Case { name: format!("{seed}: {names:?} {force:?}"), stack, force, rate }
}

impl Case {
    pub(crate) fn run(&self, method: impl Into<Integrator>) -> Transient {
        run_at(&self.stack, &method.into(), self.rate, &self.force, (4e-3, 2e5))
    }
}

/// Differences of displacement and of pressures over their largest changes.
pub(crate) fn off(found: &Transient, expected: &Transient) -> f64 {
    let changes = |column: &[f64]| column.iter().map(|x| x - column[0]).collect::<Vec<_>>();
    let pairs = found.history.interfaces.iter().zip(&expected.history.interfaces);
    let pressures = pairs.map(|(a, b)| difference(&changes(&a.pressure), &changes(&b.pressure)));
    let moved = difference(
        &found.history.sensors[0].displacement,
        &expected.history.sensors[0].displacement,
    );
    pressures.fold(moved, f64::max)
}

/// Finite differences tend to modal steps, the losses of the contacts included, and both balances close.
#[test]
fn finite_differences_tend_to_modal_steps_on_random_damped_rigs() {
    let mut failures = Vec::new();
    let mut damping_counts = 0;
    for seed in 1..=40 {
        let case = case(seed);
        let fine =
            case.run(Modal { step: Some(4e-7), modes_per_body: Some(24), ..Modal::default() });
        let [coarse, finest] = [4e-3, 0.5e-3]
            .map(|cell| case.run(FiniteDifference { cell, ..FiniteDifference::default() }));
        let default = case.run(Modal::default());
        let offs = [&coarse, &finest, &default].map(|run| off(run, &fine));
        let loss = |run: &Transient| run.energy.contact_dissipated / run.energy.input;
        let losses = [loss(&finest), loss(&default), loss(&fine)];
        damping_counts += usize::from(losses[2] > 0.02);
        let residuals = [&finest, &default, &fine].map(|run| run.energy.residual_relative());
        // Where faces meet the traction jumps, and modal steps are of first order.
        let opens = fine.contacts.iter().any(|contact| contact.lost > 0.0);
        let same = if opens { 2e-3 } else { 1e-4 };
        let agrees = offs[1] < (0.7 * offs[0]).max(same) && offs[1] < 1e-2 && offs[2] < 5e-2;
        let balanced = residuals.iter().all(|residual| *residual < 6e-4);
        let lost = losses.iter().all(|loss| (loss - losses[2]).abs() < 4e-3);
        if !(agrees && balanced && lost) {
            failures.push(format!("{} {offs:?} {losses:?} {residuals:?}", case.name));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(damping_counts > 20, "{damping_counts}");
}

/// Against a hundredth of the step: third order, from the jump in the curvature of the pulse as it
/// begins, and second order with a sample, whose forces are means of a step. Tables of the laws are coarser at longer steps;
/// at these their error does not count.
#[test]
fn damped_modal_steps_converge() {
    let damping = ContactDamping::kelvin_voigt(6e-6).unwrap();
    for (stack, least) in
        [(single_body(&constant(), 9.81), 2.6), (rig(&power()), 1.9), (rig(&modified()), 1.9)]
    {
        let stack = damped(&stack, damping);
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
        assert!(order > least && errors[0] < 1e-4, "{order} {errors:?}");
    }
}

/// Contacts damped so strongly that their faces creep: stable at the default step, and near the
/// finite differences.
#[test]
fn overdamped_contacts_are_stable() {
    for time in [1e-4, 1e-3, 1e-2] {
        let damping = ContactDamping::kelvin_voigt(time).unwrap();
        for law in [constant(), power(), modified()] {
            let stack = damped(&rig(&law), damping);
            let case = Case { name: String::new(), stack, force: pulse(20.0), rate: 100.0 };
            let modal = case.run(Modal::default());
            let grid = case.run(FiniteDifference::default());
            let moved = difference(
                &modal.history.sensors[0].displacement,
                &grid.history.sensors[0].displacement,
            );
            assert!(moved < 5e-3, "{time}: {moved}");
            assert!(modal.energy.residual_relative() < 1e-3);
        }
    }
}

/// A hit does not depend on the hits beside it, damped or not.
#[test]
fn damped_hits_do_not_depend_on_their_batch() {
    let model = |damping: Option<f64>| {
        let stack = rig(&modified());
        let stack = damping.map_or(stack.clone(), |time| {
            damped(&stack, ContactDamping::kelvin_voigt(time).unwrap())
        });
        let structure = PreloadedStructure::new(stack, Damping::Ratio(0.02)).unwrap();
        Arc::new(
            ModalModel::of_stack(
                &structure,
                &ModeCount::PerBody(2).counts(structure.stack()).unwrap(),
                Port::TOP,
                &[Port::TOP],
            )
            .unwrap(),
        )
    };
    let models = [model(None), model(Some(2e-6)), model(Some(1e-5))];
    let hits: Vec<TransientCase> = (0..40)
        .map(|n| TransientCase {
            model: Arc::clone(&models[n % 3]),
            sensor: 0,
            load: pulse(8.0 + n as f64),
            duration: 5e-3,
            step: None,
            tolerance: None,
        })
        .collect();
    let all = Decimation::every_step();
    let filter = |_: usize, _: f64| Arc::clone(&all);
    let together = Batch::default().run(&hits, &filter);
    for (hit, found) in hits.iter().zip(together) {
        let alone = Batch::default().run(std::slice::from_ref(hit), &filter).remove(0).unwrap();
        assert_eq!(found.unwrap(), alone);
    }
}
