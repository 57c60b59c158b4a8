//! The vectorised scheme in perturbation form with tabulated laws, against the
//! plain scheme: absolute coordinates under gravity, exact laws, one loop.

use crate::support::absolute_scheme::integrate;
use crate::support::{
    DISC, constant, difference, exponential, modified, power, pulse, rig, rig_on,
};
use crate::support::{run_at, three_bodies};
use asperity_dynamics::{ContactForm, FiniteDifference};
use asperity_mesh::{Stack, Support};
use asperity_structure::LoadCase;

const RATE: f64 = 352.0;

/// Largest differences of displacement and, per interface, pressure and closure
/// gain, each over its own largest value.
fn differences(stack: &Stack, contact: ContactForm, excitation: &LoadCase) -> (f64, f64, f64) {
    let method = FiniteDifference { cell: 2e-3, contact, ..FiniteDifference::default() };
    let fast = run_at(stack, &method, RATE, excitation, (5e-3, 2e5));
    let samples = fast.history.time.len();
    let marching = (fast.step, fast.steps / samples, samples);
    let plain = integrate(stack, (2e-3, contact), RATE, excitation, marching);
    let (mut pressure, mut closure) = (0.0_f64, 0.0_f64);
    for (i, columns) in fast.history.interfaces.iter().enumerate() {
        // The new-level form reports the pressure of the closure at the sample itself.
        let found = match contact {
            ContactForm::Centred => plain.pressure[i].clone(),
            ContactForm::NewLevel => plain.closure[i]
                .iter()
                .map(|&d| stack.interfaces()[i].law().pressure(d).value)
                .collect(),
        };
        pressure = pressure.max(difference(&columns.pressure, &found));
        closure = closure.max(difference(&columns.closure, &plain.closure[i]));
    }
    (difference(&fast.history.sensors[0].displacement, &plain.displacement), pressure, closure)
}

/// Without loss of contact. What is left is the error of the law's table, 1e-6
/// of the static pressure at most, and, for the constant law, whose table is
/// exact, the cancellation of absolute coordinates: elastic forces of 1e5 weights.
#[test]
fn smooth_responses_agree_to_the_error_of_the_table() {
    let stacks = [
        ("modified", rig(&modified())),
        ("power", rig(&power())),
        ("exponential", rig(&exponential())),
        ("constant", rig(&constant())),
        ("on a disc", rig_on(&modified(), DISC)),
        ("three bodies", three_bodies(Support::Rigid)),
        ("three bodies on a disc", three_bodies(DISC)),
    ];
    for (name, stack) in stacks {
        for contact in [ContactForm::Centred, ContactForm::NewLevel] {
            let off = differences(&stack, contact, &pulse(4.0));
            let bound = if name == "constant" { 1e-8 } else { 1e-6 };
            let worst = off.0.max(off.1).max(off.2);
            assert!(worst < bound, "{name} {contact:?}: {off:?}");
        }
    }
}

/// At 60 N contact is lost and hit again. Next to loss of contact the table's
/// error is largest, and each return of contact enlarges what went before.
#[test]
fn responses_with_loss_of_contact_agree_to_the_error_of_the_table() {
    for (name, stack) in [("power", rig(&power())), ("modified", rig(&modified()))] {
        for contact in [ContactForm::Centred, ContactForm::NewLevel] {
            let off = differences(&stack, contact, &pulse(60.0));
            assert!(off.0.max(off.1).max(off.2) < 2e-6, "{name} {contact:?}: {off:?}");
        }
    }
}
