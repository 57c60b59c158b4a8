//! With a constant stiffness harmonic balance is the linear frequency response.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{ContactSystem, Evaluation, LinearSystem, Path, linear_receptance};
use asperity_law::Constant;
use asperity_mesh::{Stack, Support};
use faer::c64;

use crate::rigs::{Law, branch, mass_on, preloaded, rate_on, rig};

fn constant() -> Law {
    Arc::new(Constant::new(8.5e11).unwrap())
}

/// Receptance of the top by the stiffness that each bar feels from below, built up from the
/// support: another path to the same closed form.
fn chain(stack: &Stack, rate: f64, frequency: f64) -> c64 {
    let w = TAU * frequency;
    let squared = c64::new(w * w, -w * rate);
    let mut below = match *stack.support() {
        Support::Rigid => None,
        Support::SpringMass { stiffness, mass, .. } => {
            Some(c64::new(stiffness - w * w * mass, w * stack.support().damping()))
        }
    };
    for (body, interface) in stack.bodies().iter().zip(stack.interfaces()).rev() {
        let contact = c64::new(8.5e11 * interface.area(), 0.0);
        let carried = below.map_or(contact, |below| contact * below / (contact + below));
        let number = squared.sqrt() / body.wave_speed();
        let (th, a) = (number * body.length(), number * body.axial_rigidity());
        let (direct, cross) = (a * th.cos() / th.sin(), -a / th.sin());
        below = Some(direct - cross * cross / (direct + carried));
    }
    below.unwrap().inv()
}

/// Every point, complex. Newton's method stops at residuals of 1e-13, which resonance enlarges by
/// `1 / (2 xi)`.
#[test]
fn the_single_mass_is_the_textbook_oscillator() {
    let law = constant();
    let (mass, force) = (crate::rigs::MASS, 0.7);
    let stiffness = 8.5e11 * crate::rigs::AREA;
    for evaluation in [Evaluation::Exact, Evaluation::default()] {
        let system = mass_on(&law, evaluation);
        let path = Path::Frequency { force, from: 400.0, to: 3000.0 };
        for point in &branch(&system, path, (3, 32)).points {
            let w = point.angular_frequency;
            let exact = c64::new(stiffness - w * w * mass, w * rate_on(&law) * mass).inv() * force;
            let off = (point.displacement[0] - exact).norm() / exact.norm();
            assert!(off < 3e-12, "{off:.1e} at {w}");
            assert!(point.amplitude(2) < 1e-12 * exact.norm());
        }
    }
}

/// Elastic bars, rigid and compliant supports, over the first two modes.
#[test]
fn the_rig_is_the_closed_form_chain() {
    let disc = Support::SpringMass { stiffness: 4e8, mass: 12.0, damping_ratio: 0.02 };
    for support in [Support::Rigid, disc] {
        let stack = rig(&constant(), support);
        let system =
            ContactSystem::of_stack(&preloaded(stack.clone(), 370.0), Evaluation::Exact).unwrap();
        let path = Path::Frequency { force: 2.0, from: 500.0, to: 14_000.0 };
        let found = branch(&system, path, (2, 16));
        assert!(found.points.len() > 30);
        for point in &found.points {
            let exact = chain(&stack, 370.0, point.frequency_hz()) * 2.0;
            let off = (point.displacement[0] - exact).norm() / exact.norm();
            // Both forms lose digits in a light sample between stiff springs.
            assert!(off < 1e-11, "{off:.1e} at {} Hz", point.frequency_hz());
            let linear = linear_receptance(&system, point.frequency_hz()) * 2.0;
            assert!((linear - exact).norm() < 1e-11 * exact.norm());
        }
    }
}

/// The modal system with residual flexibility approaches the closed form like the square of the
/// frequency over that of the first mode left out, to the power two.
#[test]
fn modes_with_residual_flexibility_approach_the_bars() {
    let disc = Support::SpringMass { stiffness: 4e8, mass: 12.0, damping_ratio: 0.02 };
    for support in [Support::Rigid, disc] {
        let stack = rig(&constant(), support);
        let exact =
            ContactSystem::of_stack(&preloaded(stack.clone(), 370.0), Evaluation::Exact).unwrap();
        let off = |count: usize, frequency: f64| {
            let modal = exact.linear().modal(count);
            modal.check().unwrap();
            let truncated = ContactSystem::new(Arc::new(modal), exact.contacts().to_vec()).unwrap();
            let reference = linear_receptance(&exact, frequency);
            ((linear_receptance(&truncated, frequency) - reference) / reference).norm()
        };
        // Halving the frequency: residual modes enter as their frequency ratio squared, beside the
        // static part that is kept.
        for count in [3, 6] {
            let (coarse, fine) = (off(count, 4000.0), off(count, 2000.0));
            let slope = (coarse / fine).log2();
            assert!(coarse < 0.1, "{count} modes: {coarse:.1e}");
            assert!(slope > 1.5, "{count} modes: {slope}");
        }
        assert!(off(40, 900.0) < 1e-6, "{:.1e}", off(40, 900.0));
        // Means: a chain carries its weight whatever it is made of.
        let balance = exact.linear().modal(6).mean_balance();
        for value in &balance.closure {
            assert!(value.abs() < 1e-12);
        }
        for value in &balance.output_closure {
            if support == Support::Rigid {
                assert!((value - 1.0).abs() < 1e-12, "{value}");
            }
        }
    }
}
