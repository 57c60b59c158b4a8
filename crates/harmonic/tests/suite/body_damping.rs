//! Internal damping of bodies: closed forms, component modes against exact bars, integration in time,
//! multipliers.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_dynamics::{Modal, Sampling};
use asperity_harmonic::{
    Compliance, ContactSystem, Continuation, Drive, Floquet, FourierResolution, HarmonicSettings,
    LawEvaluation, LinearSystem, SteppedSineSolver, linear_receptance, trace,
};
use asperity_law::{Constant, ContactDamping};
use asperity_mesh::{Body, BodyDamping, Interface, ModeCount, Port, Stack, Support};
use asperity_structure::{LoadCase, TimeFunction};
use num_complex::Complex64;

use crate::integration::harmonic;
use crate::rigs::{AREA, Law, MASS, modified, preloaded, rig};

const STIFFNESS: f64 = 8.5e11;

/// The guide bar on one linear contact, with these dampings.
fn bar_on_spring(body: BodyDamping, contact: Option<ContactDamping>) -> Stack {
    let guide = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    let law: Law = Arc::new(Constant::new(STIFFNESS).unwrap());
    let interface = Interface::new("contact", AREA, law).unwrap();
    let interface = contact.map_or(interface.clone(), |damping| interface.with_damping(damping));
    let stack = Stack::new(vec![guide.with_damping(body)], vec![interface], Support::Rigid, 9.81);
    stack.unwrap()
}

/// A bar on a spring, with `R = E A m kappa`, `kappa = sqrt((w^2 - i w h) / m) / c`:
/// `u / F = (R cos(th) + k sin(th)) / (R (k cos(th) - R sin(th)))`, from the solution of the wave
/// equation, for Rayleigh damping and for loss factors.
#[test]
fn the_receptance_of_a_damped_bar_on_a_damped_contact_has_its_closed_form() {
    let (h, b, eta) = (90.0, 3e-6, 0.03);
    let contact = ContactDamping::kelvin_voigt(b).unwrap();
    for (damping, contact) in [
        (BodyDamping::kelvin_voigt(b).unwrap(), Some(contact)),
        (BodyDamping::kelvin_voigt(b).unwrap(), None),
        (BodyDamping::loss_factor(eta).unwrap(), None),
        (BodyDamping::loss_factor(2.0).unwrap(), Some(contact)),
    ] {
        let stack = bar_on_spring(damping, contact);
        let body = stack.bodies()[0].clone();
        let structure = preloaded(stack, h);
        let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        for frequency in [20.0, 1100.0, 11_000.0, 52_000.0] {
            let w = TAU * frequency;
            let m = Complex64::new(1.0, damping.loss(w));
            let kappa = (Complex64::new(w * w, -w * h) / m).sqrt() / body.wave_speed();
            let (r, th) = (m * kappa * body.axial_rigidity(), kappa * body.length());
            let beta = if contact.is_some() { b } else { 0.0 };
            let k = AREA * STIFFNESS * Complex64::new(1.0, beta * w);
            let exact = (r * th.cos() + k * th.sin()) / (r * (k * th.cos() - r * th.sin()));
            let found = linear_receptance(&system, frequency);
            assert!(
                (found / exact - 1.0).norm() < 1e-9,
                "{frequency} {damping:?}: {found} {exact}"
            );
        }
    }
}

/// Derivatives of the compliance, free and on springs, against differences.
#[test]
fn derivatives_of_damped_compliances_match_differences() {
    let springs = [Complex64::new(9e7, 4e7); 2];
    for damping in [BodyDamping::kelvin_voigt(2e-6), BodyDamping::loss_factor(0.05)] {
        let stack = rig(&modified(), Support::Rigid).with_body_damping(damping.unwrap());
        let structure = preloaded(stack, 200.0);
        for on_springs in [false, true] {
            let at = |w: f64, anti_damping: f64| {
                let mut into = Compliance::zero(2, 1);
                let springs = if on_springs { &springs[..] } else { &[] };
                let ports = [Port::TOP.into()];
                structure.compliance((w, anti_damping), &ports, springs, &mut into);
                into
            };
            for w in [900.0, 6e3, 9e4] {
                let (found, dw, dh) = (at(w, 30.0), 1e-5 * w, 0.1);
                let [up, down] = [at(w + dw, 30.0), at(w - dw, 30.0)];
                let [more, less] = [at(w, 30.0 + dh), at(w, 30.0 - dh)];
                let all =
                    |of: &Compliance| [(0, 0), (0, 1), (0, 2), (2, 2)].map(|(i, j)| *of.get(i, j));
                for (i, exact) in all(&found).into_iter().enumerate() {
                    let slope = (all(&up)[i].value - all(&down)[i].value) / (2.0 * dw);
                    assert!((slope / exact.d_frequency - 1.0).norm() < 1e-6, "{i} {w}");
                    let slope = (all(&more)[i].value - all(&less)[i].value) / (2.0 * dh);
                    assert!((slope / exact.d_anti_damping - 1.0).norm() < 1e-5, "{i} {w}");
                }
            }
        }
    }
}

/// Component modes with the damped flexibility of those left out tend to the exact bars.
#[test]
fn damped_component_modes_tend_to_the_exact_bars() {
    let damping = BodyDamping::kelvin_voigt(4e-6).unwrap();
    let stack = rig(&modified(), Support::Rigid).with_body_damping(damping);
    let structure = preloaded(stack, 100.0);
    let w = TAU * 4000.0;
    let mut exact = Compliance::zero(2, 1);
    structure.compliance((w, 0.0), &[Port::TOP.into()], &[], &mut exact);
    let error = |modes: usize| {
        let reduced = structure.reduced(ModeCount::PerBody(modes), &[Port::TOP]).unwrap();
        let mut found = Compliance::zero(2, 1);
        reduced.compliance((w, 0.0), &[0.into()], &[], &mut found);
        let all = |of: &Compliance| [(0, 0), (0, 1), (0, 2), (2, 2)].map(|(i, j)| *of.get(i, j));
        let pairs = all(&found).into_iter().zip(all(&exact));
        pairs.map(|(a, b)| (a.value / b.value - 1.0).norm()).fold(0.0, f64::max)
    };
    let errors = [2, 4, 8, 16, 32].map(error);
    // Inertia left out: the third power of the number of modes.
    for pair in errors.windows(2) {
        assert!(pair[1] < 0.2 * pair[0], "{errors:?}");
    }
    assert!(errors[4] < 1e-6, "{errors:?}");
}

/// A nonlinear steady response with damped bodies against the end of a transient.
#[test]
fn steady_responses_with_damped_bodies_meet_the_integration_in_time() {
    let damping = BodyDamping::kelvin_voigt(2e-5).unwrap();
    let stack = rig(&modified(), Support::Rigid).with_body_damping(damping);
    let (rate, force, frequency_hz) = (400.0, 0.6, 800.0);
    let structure = preloaded(stack, rate);
    let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let drive = Drive { frequency_hz, force };
    let found = SteppedSineSolver::new(&system, 12).sweep(&[drive]).remove(0).unwrap();
    let (samples, periods) = (64, 100);
    let sampling =
        Sampling::new(f64::from(periods) / frequency_hz, f64::from(samples) * frequency_hz)
            .unwrap();
    let shaker = LoadCase::force(TimeFunction::Harmonic { frequency: frequency_hz }, force);
    let method = Modal { step: Some(1e-6), modes_per_body: Some(6), ..Modal::default() };
    let run = method.integrate(&structure, &shaker, &[Port::TOP], &sampling).unwrap();
    let all = &run.history.sensors[0].displacement;
    let expected = harmonic(&all[all.len() - samples as usize..], 1);
    let off = found.displacement.norm() / expected - 1.0;
    assert!(off.abs() < 2e-5, "{off}");
    // The internal damping matters.
    let bare = preloaded(rig(&modified(), Support::Rigid), rate);
    let system = ContactSystem::of_structure(&bare, LawEvaluation::Exact).unwrap();
    let bare = SteppedSineSolver::new(&system, 12).sweep(&[drive]).remove(0).unwrap();
    assert!((bare.displacement.norm() / expected - 1.0).abs() > 2e-3);
}

/// The slowest multipliers of a small motion are `exp(-zeta w T)` in magnitude, with the damping ratio
/// of the lowest mode: the damping of static and overdamped modes is in the others.
#[test]
fn multipliers_have_the_damping_of_the_lowest_mode() {
    for time in [1e-6, 4e-6, 1.5e-5] {
        let damping = BodyDamping::kelvin_voigt(time).unwrap();
        let stack = rig(&modified(), Support::Rigid).with_body_damping(damping);
        let structure = preloaded(stack, 0.0);
        let mode = structure.modes(1).unwrap().swap_remove(0);
        let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
        let resolution = FourierResolution::Fixed { harmonics: 3, samples: 64 };
        let stability = Some(Floquet::default());
        let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
        let sweep = Continuation::Frequency { force: 1e-4, from: 500.0, to: 510.0 };
        let response = trace(&system, &sweep, &settings).unwrap().points.remove(0);
        let largest = response.multipliers.unwrap()[0].norm();
        let periods = mode.frequency_hz * TAU / response.angular_frequency;
        let expected = (-mode.damping_ratio * TAU * periods).exp();
        let off = largest.ln() / expected.ln() - 1.0;
        assert!(off.abs() < 2e-2, "{time}: {off} {}", mode.damping_ratio);
    }
}
