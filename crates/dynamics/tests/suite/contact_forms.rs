//! The two contact forms as one limit in the step.

use crate::support::{difference, modified, pulse, rig, run, slope};
use asperity_dynamics::{ContactForm, FiniteDifference};

/// On a fixed grid the new-level contact tends to the centred one with the step, slope 1.
#[test]
fn the_new_level_contact_tends_to_the_centred_with_the_step() {
    let stack = rig(&modified());
    let of = |contact, courant| {
        let method = FiniteDifference { contact, courant, ..FiniteDifference::default() };
        run(&stack, &method, &pulse(32.0), 0.01)
    };
    let mut steps = Vec::new();
    let mut gaps = Vec::new();
    for courant in [0.9, 0.45, 0.225, 0.1125] {
        let centred = of(ContactForm::Centred, courant);
        let new = of(ContactForm::NewLevel, courant);
        steps.push(centred.step);
        gaps.push(difference(
            &new.history.sensors[0].displacement,
            &centred.history.sensors[0].displacement,
        ));
    }
    let order = slope(&steps, &gaps);
    assert!((0.95..1.05).contains(&order), "{gaps:?}");
}

/// The centred form is of second order in the step on a fixed grid, but for the
/// one-sided damping of Eq. (2), which is left out here.
#[test]
fn the_centred_contact_is_of_second_order_in_the_step() {
    let stack = rig(&modified());
    let of = |courant| {
        let method = FiniteDifference { cell: 4e-3, courant, ..FiniteDifference::default() };
        crate::support::run_at(&stack, &method, 0.0, &pulse(32.0), (0.005, 2e5))
    };
    // Finer steps lose more to round-off, eps / (w dt)^2, than they gain.
    let finest = of(0.1);
    let mut steps = Vec::new();
    let mut gaps = Vec::new();
    for courant in [0.9, 0.45, 0.225] {
        let run = of(courant);
        // The finest has an error of its own: h^2 - h0^2 in place of h^2.
        steps.push((run.step.powi(2) - finest.step.powi(2)).sqrt());
        gaps.push(difference(
            &run.history.sensors[0].displacement,
            &finest.history.sensors[0].displacement,
        ));
    }
    let order = slope(&steps, &gaps);
    assert!((1.9..2.1).contains(&order), "{gaps:?}");
}
