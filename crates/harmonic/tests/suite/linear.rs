//! With a constant stiffness harmonic balance is the linear frequency response.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, LawEvaluation, LinearSystem, linear_receptance,
};
use asperity_law::Constant;
use asperity_mesh::{
    ComponentModes, ModeCount, NormalMode, Port, PortPair, ResidualFlexibility, Stack, Support,
};
use asperity_structure::{Damping, PreloadedStructure};
use num_complex::Complex64;

use crate::rigs::{
    AREA, Law, branch, exponential, mass_on, modified, power, preloaded, rate_on, rig,
};

fn constant() -> Law {
    Arc::new(Constant::new(8.5e11).unwrap())
}

/// Receptance of the top by the stiffness below each bar, built up from the support: a second
/// method for the same closed form.
fn chain(stack: &Stack, rate: f64, frequency: f64) -> Complex64 {
    let w = TAU * frequency;
    let squared = Complex64::new(w * w, -w * rate);
    let mut below = match *stack.support() {
        Support::Rigid => None,
        Support::SpringMass { stiffness, mass, .. } => {
            Some(Complex64::new(stiffness - w * w * mass, w * stack.support().damping()))
        }
    };
    for (body, interface) in stack.bodies().iter().zip(stack.interfaces()).rev() {
        let contact = Complex64::new(8.5e11 * interface.area(), 0.0);
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
    for evaluation in [LawEvaluation::Exact, LawEvaluation::default()] {
        let system = mass_on(&law, evaluation);
        let continuation = Continuation::Frequency { force, from: 400.0, to: 3000.0 };
        for point in &branch(&system, continuation, (3, 32)).points {
            let w = point.angular_frequency;
            let exact =
                Complex64::new(stiffness - w * w * mass, w * rate_on(&law) * mass).inv() * force;
            let off = (point.displacement[0] - exact).norm() / exact.norm();
            assert!(off < 3e-12, "{off:.1e} at {w}");
            assert!(point.amplitude(2) < 1e-12 * exact.norm());
        }
    }
}

/// Forces that move contacts by 1e-5 to 1e-14 of their pressure: the linear response in as many points, by laws in tables
/// and by the laws themselves.
#[test]
fn responses_to_forces_of_any_smallness_are_linear() {
    for law in [power(), modified(), exponential()] {
        let structure = preloaded(rig(&law, Support::Rigid), 370.0);
        for evaluation in [LawEvaluation::Exact, LawEvaluation::default()] {
            let system = ContactSystem::of_structure(&structure, evaluation).unwrap();
            let points = [1e-5, 1e-8, 1e-11, 1e-14].map(|force| {
                let sweep = Continuation::Frequency { force, from: 500.0, to: 3000.0 };
                let found = branch(&system, sweep, (3, 32));
                assert!(found.is_complete(), "{force} N: {:?}", found.termination);
                for point in &found.points {
                    let exact = force * linear_receptance(&system, point.frequency_hz());
                    let off = (point.displacement[0] - exact).norm() / exact.norm();
                    assert!(off < 1e-8, "{off:.1e} at {force} N, {} Hz", point.frequency_hz());
                }
                found.points.len()
            });
            assert!(points.iter().all(|&count| count == points[0] && count < 200), "{points:?}");
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
            ContactSystem::of_structure(&preloaded(stack.clone(), 370.0), LawEvaluation::Exact)
                .unwrap();
        let continuation = Continuation::Frequency { force: 2.0, from: 500.0, to: 14_000.0 };
        let found = branch(&system, continuation, (2, 16));
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

/// Component modes with residual flexibility approach the closed form like the square of the
/// frequency over that of the first mode left out, to the power two.
#[test]
fn modes_with_residual_flexibility_approach_the_bars() {
    let disc = Support::SpringMass { stiffness: 4e8, mass: 12.0, damping_ratio: 0.02 };
    for support in [Support::Rigid, disc] {
        let stack = rig(&constant(), support);
        let structure = preloaded(stack.clone(), 370.0);
        let exact = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        let reduced = |count| structure.reduced(ModeCount::Lowest(count), &[Port::TOP]).unwrap();
        let off = |count: usize, frequency: f64| {
            let truncated = reduced(count);
            let truncated = ContactSystem::of_structure(&truncated, LawEvaluation::Exact).unwrap();
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
        // Means: the mean pressures of a chain are those of its weight.
        let balance = reduced(6).mean_balance(&[0.into()]);
        for value in &balance.closure {
            assert!(value.abs() < 1e-12);
        }
        for value in &balance.port_closure {
            if support == Support::Rigid {
                assert!((value - 1.0).abs() < 1e-12, "{value}");
            }
        }
    }
}

/// The rig's component modes given as numbers give the branch of the rig.
#[test]
fn component_modes_given_by_hand_are_the_rig() {
    let structure = preloaded(rig(&crate::rigs::power(), Support::Rigid), 370.0);
    let reduced = structure.reduced(ModeCount::PerBody(1), &[Port::TOP]).unwrap();
    let (guide, sample) = ((1.0 / 1.61_f64).sqrt(), (1.0 / (2710.0 * 0.015 * AREA)).sqrt());
    // The top, the lower face of the guide bar, and both faces of the sample.
    let modes = vec![
        NormalMode::rigid(vec![guide, guide, 0.0, 0.0]),
        NormalMode::rigid(vec![0.0, 0.0, sample, sample]),
    ];
    // L / (3 E A) of each bar at its faces, -L / (6 E A) across it.
    let [long, short] = [0.229 / (71e9 * 1.61 / (2710.0 * 0.229)), 0.015 / (71e9 * AREA)];
    let residual = ResidualFlexibility::from_rows(&[
        vec![long / 3.0, -long / 6.0, 0.0, 0.0],
        vec![-long / 6.0, long / 3.0, 0.0, 0.0],
        vec![0.0, 0.0, short / 3.0, -short / 6.0],
        vec![0.0, 0.0, -short / 6.0, short / 3.0],
    ])
    .unwrap();
    let contacts = vec![PortPair::between(1, 2), PortPair::on_ground(3)];
    let by_hand = PreloadedStructure::of_components(
        ComponentModes::new(modes, residual, contacts, vec![]).unwrap(),
        structure.contacts().to_vec(),
        Damping::Rate(370.0),
    )
    .unwrap();
    let sweep = Continuation::Frequency { force: 0.4, from: 900.0, to: 980.0 };
    let peak = |structure: &PreloadedStructure<ComponentModes>| {
        let system = ContactSystem::of_structure(structure, LawEvaluation::Exact).unwrap();
        let found = branch(&system, sweep, (5, 64));
        found.highest().map(|peak| (peak.frequency_hz(), peak.amplitude(1))).unwrap()
    };
    let (expected, found) = (peak(&reduced), peak(&by_hand));
    assert!((found.0 / expected.0 - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
    assert!((found.1 / expected.1 - 1.0).abs() < 1e-9, "{found:?} {expected:?}");
}
