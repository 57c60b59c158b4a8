//! Damping ratios of linearised modes: finite elements with a damping matrix, decay by mode, means of
//! stability with and without contact damping.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    Compliance, ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings,
    LawEvaluation, LinearSystem, trace,
};
use asperity_law::{Constant, ContactDamping};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, PreloadedStructure};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use num_complex::Complex64;

use crate::rigs::{AREA, Law, MASS};

const RATIOS: [f64; 2] = [0.04, 0.01];
const OTHER: f64 = 0.02;

/// Two bars on two linear contacts and a sprung disc.
fn stack(support: Support, damping: Option<ContactDamping>) -> Stack {
    let law: Law = Arc::new(Constant::new(8.5e11).unwrap());
    let contact = |name| {
        let contact = Interface::new(name, AREA, Arc::clone(&law)).unwrap();
        damping.map_or(contact.clone(), |damping| contact.with_damping(damping))
    };
    let bars = vec![
        Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap(),
        Body::with_mass("middle", 0.1, 0.6, 71e9, 2710.0).unwrap(),
    ];
    Stack::new(bars, vec![contact("a"), contact("b")], support, 9.81).unwrap()
}

fn disc() -> Support {
    Support::SpringMass { stiffness: 4e8, mass: 0.7, damping_ratio: 0.0 }
}

fn damped(stack: Stack) -> PreloadedStructure {
    let structure = PreloadedStructure::new(stack, Damping::Rate(0.0)).unwrap();
    structure.with_modal_damping(&RATIOS, OTHER).unwrap()
}

/// Receptance at the top of linear elements with lumped masses on the same springs, with the damping
/// matrix `M Phi diag(c) Phi^T M` of all their modes.
fn finite_elements(stack: &Stack, elements: usize, frequency: f64) -> Complex64 {
    let Support::SpringMass { stiffness: below, mass, .. } = *stack.support() else { panic!() };
    let spring = 8.5e11 * AREA;
    let size = 2 * (elements + 1) + 1;
    let (mut k, mut m) = (Mat::<f64>::zeros(size, size), vec![0.0; size]);
    let add_spring = |k: &mut Mat<f64>, i: usize, j: usize, stiffness: f64| {
        k[(i, i)] += stiffness;
        k[(j, j)] += stiffness;
        k[(i, j)] -= stiffness;
        k[(j, i)] -= stiffness;
    };
    for (b, body) in stack.bodies().iter().enumerate() {
        let share = elements as f64;
        let (stiff, heavy) = (body.axial_rigidity() / body.length() * share, body.mass() / share);
        for e in 0..elements {
            let at = b * (elements + 1) + e;
            add_spring(&mut k, at, at + 1, stiff);
            m[at] += 0.5 * heavy;
            m[at + 1] += 0.5 * heavy;
        }
        add_spring(&mut k, b * (elements + 1) + elements, (b + 1) * (elements + 1), spring);
    }
    k[(size - 1, size - 1)] += below;
    m[size - 1] += mass;
    let scaled = Mat::from_fn(size, size, |i, j| k[(i, j)] / (m[i] * m[j]).sqrt());
    let modes = scaled.self_adjoint_eigen(Side::Lower).unwrap();
    let natural: Vec<f64> = (0..size).map(|r| modes.S().column_vector()[r].sqrt()).collect();
    let rest = 2.0 * OTHER * natural[RATIOS.len()];
    let rate = |r: usize| RATIOS.get(r).map_or(rest, |ratio| 2.0 * ratio * natural[r]);
    let w = TAU * frequency;
    let damper = |i: usize, j: usize| -> f64 {
        let (q, root) = (modes.U(), (m[i] * m[j]).sqrt());
        (0..size).map(|r| root * q[(i, r)] * rate(r) * q[(j, r)]).sum()
    };
    let dynamic = Mat::from_fn(size, size, |i, j| {
        let mass = if i == j { m[i] } else { 0.0 };
        Complex64::new(k[(i, j)] - w * w * mass, w * damper(i, j))
    });
    let mut force = Mat::<Complex64>::zeros(size, 1);
    force[(0, 0)] = Complex64::ONE;
    dynamic.partial_piv_lu().solve(&force)[(0, 0)]
}

/// The receptance of exact bars against finite elements with the full damping matrix, at the modes and
/// between them, to the second order in the elements.
#[test]
fn receptances_are_those_of_the_damping_matrix_of_all_modes() {
    let structure = damped(stack(disc(), None));
    let modes = structure.modes(4).unwrap();
    for (mode, ratio) in modes.iter().zip([RATIOS[0], RATIOS[1], OTHER]) {
        assert!((mode.damping_ratio - ratio).abs() < 1e-9, "{}", mode.damping_ratio);
    }
    let springs = vec![Complex64::new(8.5e11 * AREA, 0.0); 2];
    let places: Vec<f64> = modes.iter().map(|mode| mode.frequency_hz).collect();
    for frequency in [0.6 * places[0], places[0], 0.5 * (places[0] + places[1]), places[1]] {
        let mut found = Compliance::zero(2, 1);
        structure.compliance((TAU * frequency, 0.0), &[Port::TOP.into()], &springs, &mut found);
        let errors = [20, 40].map(|elements| {
            let expected = finite_elements(structure.stack(), elements, frequency);
            (found.get(2, 2).value - expected).norm() / expected.norm()
        });
        assert!(errors[1] < 2e-3, "{frequency} Hz: {errors:?}");
        let order = (errors[0] / errors[1]).log2();
        assert!((1.8..2.2).contains(&order), "{frequency} Hz: order {order} of {errors:?}");
    }
    // Derivatives, and the same without springs and with others.
    let at = |w: f64, anti: f64| {
        let mut found = Compliance::zero(2, 1);
        structure.compliance((w, anti), &[Port::TOP.into()], &[], &mut found);
        found
    };
    let (w, step) = (TAU * 700.0, 1e-2);
    let found = at(w, 3.0);
    let by_frequency =
        (at(w + step, 3.0).get(2, 2).value - at(w - step, 3.0).get(2, 2).value) / (2.0 * step);
    let by_rate =
        (at(w, 3.0 + step).get(2, 2).value - at(w, 3.0 - step).get(2, 2).value) / (2.0 * step);
    assert!((found.get(2, 2).d_frequency / by_frequency - 1.0).norm() < 1e-5);
    assert!((found.get(2, 2).d_anti_damping / by_rate - 1.0).norm() < 1e-5);
}

/// Multipliers of a linear rig lie at `exp(-zeta w T)` of their modes: by the splitting, and by the
/// Runge-Kutta method where contacts are damped, to which their share is added.
#[test]
fn disturbances_decay_by_the_ratio_of_their_mode() {
    let beta = 2e-7;
    let damping = ContactDamping::kelvin_voigt(beta).unwrap();
    for of_contacts in [None, Some(damping)] {
        let structure = damped(stack(Support::Rigid, of_contacts));
        let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
        let settings = HarmonicSettings {
            resolution: FourierResolution::Fixed { harmonics: 1, samples: 32 },
            stability: Some(Floquet { modes: 12 }),
            ..HarmonicSettings::default()
        };
        let sweep = Continuation::Frequency { force: 0.1, from: 500.0, to: 520.0 };
        let branch = trace(&system, &sweep, &settings).unwrap();
        let point = &branch.points[0];
        let multipliers = point.multipliers.as_ref().unwrap();
        for mode in &structure.modes(3).unwrap()[..3] {
            let w = TAU * mode.frequency_hz;
            let decay = mode.damping_ratio * w * TAU / point.angular_frequency;
            let nearest = multipliers.iter().map(|found| (found.norm().ln() + decay).abs());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-2 * decay, "{} Hz: {nearest:.1e} of {decay}", mode.frequency_hz);
        }
    }
}

/// A body or a support with damping of its own would be counted twice.
#[test]
fn ratios_beside_other_damping_are_refused() {
    let support = Support::SpringMass { stiffness: 4e8, mass: 0.7, damping_ratio: 0.02 };
    let structure = PreloadedStructure::new(stack(support, None), Damping::Rate(0.0)).unwrap();
    let error = structure.with_modal_damping(&RATIOS, OTHER).unwrap_err();
    assert!(error.to_string().contains("support"), "{error}");
    let structure = PreloadedStructure::new(stack(disc(), None), Damping::Rate(0.0)).unwrap();
    assert!(structure.clone().with_modal_damping(&[], 0.1).is_err());
    assert!(structure.with_modal_damping(&[-0.1], 0.1).is_err());
}
