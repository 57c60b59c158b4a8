//! Contact damping: the interface's own equation, loss per cycle, energy balance, decay.

use std::f64::consts::{PI, TAU};

use crate::support::half_spaces::{LENGTH, impedance, pulse, relative_norm, run, window};
use crate::support::{
    AREA, DISC, Law, constant, damped, every_law, exponential, half_spaces, modified, power,
    pulse as hammer, rig, rig_on, run_at, single_body, slope, three_bodies,
};
use asperity_dynamics::{ContactForm, FiniteDifference};
use asperity_law::{Constant, ContactDamping};
use asperity_mesh::Stack;
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};
use std::sync::Arc;

/// Static pressure of the half-spaces \[Pa\].
const P0: f64 = 1.4e5;

/// Cells a bar of the convergence studies.
const CELLS: [usize; 4] = [127, 255, 511, 1023];

/// Kelvin-Voigt damping, and coefficients of two powers of the pressure of the same size at rest.
fn kinds(time: f64) -> [(&'static str, ContactDamping); 3] {
    let coefficient = time * 8.5e11;
    [
        ("kelvin-voigt", ContactDamping::kelvin_voigt(time).unwrap()),
        ("power 0", ContactDamping::power(coefficient, P0, 0.0).unwrap()),
        ("power 1.5", ContactDamping::power(coefficient, P0, 1.5).unwrap()),
    ]
}

/// Closures at `times` \[s\] of the interface's own equation, `d' = (2/Z) (q_in - t)` with the traction
/// `t = max(-p0, q(d) + c(p) d')`, by the classical method of fourth order in steps of 2 ns.
pub(crate) fn closures(law: &Law, damping: ContactDamping, peak: f64, times: &[f64]) -> Vec<f64> {
    const STEP: f64 = 2e-9;
    let admittance = 2.0 / impedance();
    let separates = law.domain().separates();
    let incident = |t: f64| {
        let inside = (0.0..half_spaces::PULSE).contains(&t);
        if inside { peak * (PI * t / half_spaces::PULSE).sin().powi(2) } else { 0.0 }
    };
    let rate = |t: f64, d: f64| {
        let at = law.pressure_increment(P0, d);
        let c = damping.coefficient(P0 + at.value, at.tangent);
        let held = admittance * (incident(t) - at.value) / (1.0 + admittance * c);
        let open = separates && at.value + c * held < -P0;
        if open { admittance * (incident(t) + P0) } else { held }
    };
    let (mut d, mut t) = (0.0, 0.0);
    let mut found = Vec::with_capacity(times.len());
    for &time in times {
        let steps = ((time - t) / STEP).ceil().max(1.0);
        let h = (time - t) / steps;
        for _ in 0..steps as usize {
            let k1 = rate(t, d);
            let k2 = rate(t + 0.5 * h, d + 0.5 * h * k1);
            let k3 = rate(t + 0.5 * h, d + 0.5 * h * k2);
            let k4 = rate(t + h, d + h * k3);
            d += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            t += h;
        }
        found.push(d);
    }
    found
}

/// Errors of the closure for each grid, and the effect of the damping on it.
fn against_the_interface_equation(
    law: &Law,
    damping: ContactDamping,
    peak: f64,
) -> (Vec<f64>, f64) {
    let stack = damped(&half_spaces::stack(law, P0), damping);
    let d0 = law.closure(P0);
    let mut effect = 0.0;
    let errors = CELLS.map(|cells| {
        let (times, samples) = window(&run(&stack, cells, &pulse(peak), 3.0));
        let exact = closures(law, damping, peak, &times);
        if cells == CELLS[0] {
            let none = ContactDamping::kelvin_voigt(0.0).unwrap();
            effect = relative_norm(&closures(law, none, peak, &times), &exact);
        }
        let found: Vec<f64> = samples.closure.iter().map(|c| c - d0).collect();
        relative_norm(&found, &exact)
    });
    (errors.to_vec(), effect)
}

fn sizes() -> Vec<f64> {
    CELLS.iter().map(|&cells| LENGTH / cells as f64).collect()
}

/// While contact holds, whether or not the traction would pull: slope 2.
#[test]
fn a_damped_interface_follows_its_own_equation() {
    for (name, law) in
        [("power", power()), ("modified", modified()), ("exponential", exponential())]
    {
        for (kind, damping) in kinds(4e-6) {
            for peak in [1.5 * P0, -0.6 * P0] {
                let (errors, effect) = against_the_interface_equation(&law, damping, peak);
                let order = slope(&sizes(), &errors);
                assert!((1.85..2.15).contains(&order), "{name} {kind} {peak}: {order} {errors:?}");
                assert!(errors[3] < 1e-3 && effect > 20.0 * errors[3], "{name} {kind}: {effect}");
            }
        }
    }
}

/// With contact lost and regained: no traction before the faces part. Where the stiffness jumps as
/// they meet, so does the traction, and the order falls to that of the time of the jump.
#[test]
fn a_damped_interface_that_opens_follows_its_own_equation() {
    let unilateral: Law = Arc::new(Constant::unilateral(8.5e11).unwrap());
    for (name, law) in [("power", power()), ("modified", modified()), ("unilateral", unilateral)] {
        for (kind, damping) in kinds(4e-6) {
            let (errors, effect) = against_the_interface_equation(&law, damping, -3.0 * P0);
            let order = slope(&sizes(), &errors);
            let least = if name == "unilateral" { 1.0 } else { 1.6 };
            assert!(order > least, "{name} {kind}: {order} {errors:?}");
            assert!(errors[3] < 1e-3 && effect > 20.0 * errors[3], "{name} {kind}: {effect}");
        }
    }
}

/// A linear contact that vibrates with the closure amplitude X at w loses `pi beta w S K X^2` per
/// cycle: the ledger over one more cycle of steady vibration, second order in the step.
#[test]
fn the_loss_per_cycle_of_a_linear_contact_is_exact() {
    let (beta, frequency) = (6e-6, 700.0);
    let stack =
        damped(&single_body(&constant(), 9.81), ContactDamping::kelvin_voigt(beta).unwrap());
    let force = LoadCase::force(TimeFunction::Harmonic { frequency }, 5.0);
    let errors = [8e-3, 4e-3, 2e-3].map(|cell| {
        let grid = FiniteDifference { cell, ..FiniteDifference::default() };
        let after = |cycles: f64| {
            run_at(&stack, &grid, 900.0, &force, (cycles / frequency, 512.0 * frequency))
        };
        let (shorter, longer) = (after(60.0), after(61.0));
        let closure = &longer.history.interfaces[0].closure;
        let last = &closure[60 * 512..61 * 512];
        let part = |quarter: usize| {
            let turned = |n: usize| (TAU * (n + 128 * quarter) as f64 / 512.0).cos();
            last.iter().enumerate().map(|(n, x)| x * turned(n)).sum::<f64>() / 256.0
        };
        let amplitude = part(0).hypot(part(1));
        let lost = longer.energy.contact_dissipated - shorter.energy.contact_dissipated;
        let expected = PI * beta * TAU * frequency * AREA * 8.5e11 * amplitude * amplitude;
        (longer.step, (lost / expected - 1.0).abs())
    });
    let order = slope(&errors.map(|(step, _)| step), &errors.map(|(_, error)| error));
    assert!((1.8..2.2).contains(&order), "{errors:?}");
    assert!(errors[2].1 < 2e-5, "{errors:?}");
}

/// Every law, kind and form, with contact held or lost: nothing but rounding and the ledger's own
/// error of half steps is missing, and the contacts' loss is not negative.
#[test]
fn the_balance_of_damped_contacts_closes() {
    for (name, law) in every_law() {
        for (kind, damping) in kinds(5e-6) {
            for contact in [ContactForm::Centred, ContactForm::NewLevel] {
                let stack = damped(&rig(&law), damping);
                let grid = FiniteDifference { contact, ..FiniteDifference::default() };
                for duration in [2.3e-3, 0.02] {
                    let force = hammer(32.0);
                    let energy = run_at(&stack, &grid, 200.0, &force, (duration, 2e5)).energy;
                    assert!(energy.residual_relative() < 2e-4, "{name} {kind}: {energy:?}");
                    let share = energy.contact_dissipated / energy.input;
                    assert!(share > 0.01 && energy.dissipated > energy.contact_dissipated);
                }
            }
        }
    }
}

/// Without any other loss the ledger of a linear rig is an identity of the discrete scheme.
#[test]
fn the_balance_of_damped_linear_contacts_is_an_identity() {
    let damping = ContactDamping::kelvin_voigt(5e-6).unwrap();
    for stack in [rig(&constant()), rig_on(&constant(), DISC), single_body(&constant(), 9.81)] {
        let stack = damped(&stack, damping);
        let short = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 32.0);
        let grid = FiniteDifference::default();
        let energy = run_at(&stack, &grid, 0.0, &short, (0.05, 2e5)).energy;
        assert!(energy.contact_dissipated > 0.3 * energy.input);
        assert!(energy.residual_relative() < 1e-9, "{energy:?}");
    }
}

/// The scheme never gains energy by damping, however strong: a heavily damped contact of a thrown
/// rig loses in every part of the run.
#[test]
fn the_loss_of_damped_contacts_never_shrinks() {
    for time in [1e-7, 1e-5, 1e-3] {
        let damping = ContactDamping::kelvin_voigt(time).unwrap();
        for stack in [rig(&modified()), three_bodies(DISC)] {
            let stack = damped(&stack, damping);
            let force = hammer(120.0);
            let losses: Vec<f64> = (1..=20)
                .map(|n| {
                    let duration = 2.5e-4 * f64::from(n);
                    let grid = FiniteDifference::default();
                    run_at(&stack, &grid, 0.0, &force, (duration, 2e5)).energy.contact_dissipated
                })
                .collect();
            assert!(losses.is_sorted() && losses[0] >= 0.0, "{time}: {losses:?}");
        }
    }
}

/// The logarithmic decrement of the linear rig is the damping ratio of its first mode.
#[test]
fn free_decay_has_the_damping_ratio_of_the_first_mode() {
    let damping = ContactDamping::kelvin_voigt(8e-6).unwrap();
    let stack: Stack = damped(&rig(&constant()), damping);
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(0.0)).unwrap();
    let mode = structure.modes(1).unwrap().swap_remove(0);
    let smooth = LoadCase::force(TimeFunction::Haversine { duration: 1e-3 }, 9.0);
    let run = run_at(&stack, &FiniteDifference::default(), 0.0, &smooth, (0.03, 1e6));
    let u = &run.history.sensors[0].displacement;
    let mut heights = Vec::new();
    for i in 2000..u.len() - 1 {
        let [a, b, c] = [u[i - 1], u[i], u[i + 1]];
        if b > a && b >= c && b > 0.0 {
            heights.push(b + (a - c) * (a - c) / (8.0 * (2.0 * b - a - c)));
        }
    }
    let cycles = (heights.len() - 1) as f64;
    let decrement = (heights[0] / heights[heights.len() - 1]).ln() / cycles;
    let ratio = decrement / decrement.hypot(TAU);
    // zeta^2 = 4e-4.
    assert!((ratio / mode.damping_ratio - 1.0).abs() < 1e-3, "{ratio} {mode:?}");
    assert!((0.015..0.03).contains(&ratio));
}
