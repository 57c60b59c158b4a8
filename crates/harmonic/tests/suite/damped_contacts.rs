//! Damped contacts: closed forms of linear ones, integration in time of others, derivatives,
//! multipliers.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Drive, Floquet, FourierResolution, HarmonicSettings, LawEvaluation, RigidMass,
    SteppedSineSolver, trace,
};
use asperity_harmonic::{Continuation, PeriodicResponse, linear_receptance};
use asperity_law::{Constant, ContactDamping, Hyperbolic, Power};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::PreloadedContact;
use num_complex::Complex64;

use crate::integration::harmonic;
use crate::rigs::{AREA, Law, MASS, PRESSURE, modified, preloaded};

const RATE: f64 = 120.0;

/// The rigid mass on a damped law.
fn mass_on(law: &Law, damping: ContactDamping) -> ContactSystem {
    let contact = PreloadedContact::new("contact", AREA, Arc::clone(law), PRESSURE).unwrap();
    let mass = RigidMass::new(MASS, RATE).unwrap();
    let contacts = vec![contact.with_damping(Some(damping))];
    ContactSystem::new(Arc::new(mass), contacts, LawEvaluation::Exact).unwrap()
}

/// `1 / (k (1 + i beta w) - w^2 m + i w m h)`, by the linearised response, and by the balance at any
/// force.
#[test]
fn a_linear_contact_has_a_complex_stiffness() {
    let (stiffness, beta) = (8.5e11, 5e-6);
    let law: Law = Arc::new(Constant::new(stiffness).unwrap());
    let system = mass_on(&law, ContactDamping::kelvin_voigt(beta).unwrap());
    for frequency_hz in [300.0, 1230.0, 5000.0] {
        let w = TAU * frequency_hz;
        let spring = AREA * stiffness * Complex64::new(1.0, beta * w);
        let exact = (spring - w * w * MASS + Complex64::new(0.0, w * MASS * RATE)).inv();
        let linear = linear_receptance(&system, frequency_hz);
        assert!((linear / exact - 1.0).norm() < 1e-10, "{linear} {exact}");
        let drive = Drive { frequency_hz, force: 40.0 };
        let found = SteppedSineSolver::new(&system, 3).sweep(&[drive]).remove(0).unwrap();
        assert!((found.displacement / 40.0 / exact - 1.0).norm() < 1e-9);
    }
}

/// The mass by the classical method, `m u'' + m h u' + S t(u, u') = F cos(w t)`, 2000 steps a period,
/// after as many periods as disturbances need to vanish: amplitudes of the first harmonics.
fn integrated(law: &Law, damping: ContactDamping, force: f64, frequency: f64) -> Vec<f64> {
    const STEPS: usize = 2000;
    let separates = law.domain().separates();
    let slope = |t: f64, [u, v]: [f64; 2]| {
        let at = law.pressure_increment(PRESSURE, u);
        let traction = at.value + v * damping.coefficient(PRESSURE + at.value, at.tangent);
        let traction = if separates { traction.max(-PRESSURE) } else { traction };
        [v, (force * (TAU * frequency * t).cos() - AREA * traction) / MASS - RATE * v]
    };
    let dt = 1.0 / (frequency * STEPS as f64);
    let ahead = |x: [f64; 2], k: [f64; 2], t: f64| [x[0] + t * k[0], x[1] + t * k[1]];
    let mut state = [0.0; 2];
    let mut samples = vec![0.0; STEPS];
    for _ in 0..300 {
        for (n, sample) in samples.iter_mut().enumerate() {
            *sample = state[0];
            let t = n as f64 * dt;
            let a = slope(t, state);
            let b = slope(t + 0.5 * dt, ahead(state, a, 0.5 * dt));
            let c = slope(t + 0.5 * dt, ahead(state, b, 0.5 * dt));
            let d = slope(t + dt, ahead(state, c, dt));
            for i in 0..2 {
                state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
    }
    (1..=3).map(|k| harmonic(&samples, k)).collect()
}

/// Contacts that hold, that carry nothing for a part of the period though they touch, and that open.
#[test]
fn nonlinear_damped_contacts_meet_the_integration_in_time() {
    let power: Law = Arc::new(Power::new(0.9e10, 0.35, 0.0).unwrap());
    let hyperbolic: Law = Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap());
    let weak = ContactDamping::kelvin_voigt(6e-6).unwrap();
    let strong = ContactDamping::kelvin_voigt(3e-4).unwrap();
    let own = |exponent| ContactDamping::power(4e6, PRESSURE, exponent).unwrap();
    let cases: [(&str, &Law, ContactDamping, f64, f64, f64); 6] = [
        ("held", &power, weak, 1.0, 880.0, 1e-9),
        ("held, power", &power, own(1.5), 1.0, 880.0, 1e-9),
        ("held, falling", &power, own(-0.5), 1.0, 880.0, 1e-9),
        ("no traction", &power, strong, 18.0, 400.0, 1e-3),
        ("no traction, stiff", &hyperbolic, strong, 18.0, 400.0, 1e-3),
        ("open", &power, strong, 22.0, 300.0, 2e-3),
    ];
    for (name, law, damping, force, frequency_hz, bound) in cases {
        let system = mass_on(law, damping);
        let drive = Drive { frequency_hz, force };
        let found = SteppedSineSolver::new(&system, 40).sweep(&[drive]).remove(0).unwrap();
        let exact = integrated(law, damping, force, frequency_hz);
        let amplitude = |k: usize| found.closures[2 * k - 1].hypot(found.closures[2 * k]);
        for k in 1..=3 {
            let off = (amplitude(k) - exact[k - 1]).abs() / exact[0];
            assert!(off < bound, "{name}, harmonic {k}: {off:.1e}");
        }
        let still =
            integrated(law, ContactDamping::kelvin_voigt(0.0).unwrap(), force, frequency_hz);
        assert!((still[0] / exact[0] - 1.0).abs() > 20.0 * bound, "{name}: damping hardly matters");
    }
}

/// The peak of the paper's rig on damped contacts, traced with elastic bars and stability.
fn peak(damping: ContactDamping) -> PeriodicResponse {
    let guide = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, modified()).unwrap().with_damping(damping);
    let contacts = vec![contact("upper"), contact("lower")];
    let stack = Stack::new(vec![guide, sample], contacts, Support::Rigid, 9.81).unwrap();
    let structure = preloaded(stack, RATE);
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let resolution = FourierResolution::Fixed { harmonics: 7, samples: 128 };
    let stability = Some(Floquet::default());
    let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
    let sweep = Continuation::Frequency { force: 0.02, from: 800.0, to: 920.0 };
    let branch = trace(&system, &sweep, &settings).unwrap();
    assert!(branch.is_complete());
    branch.highest().unwrap().clone()
}

/// Small motions lose what the damping ratio of the mode says; all responses are stable.
#[test]
fn branches_over_damped_contacts_are_complete_and_damped() {
    let none = peak(ContactDamping::kelvin_voigt(0.0).unwrap());
    let damped = peak(ContactDamping::kelvin_voigt(1e-5).unwrap());
    // Of the linearised mode: h / (2 w) and beta w / 2 times the contacts' share.
    let w = damped.angular_frequency;
    let expected = 1.0 + 1e-5 * w * w / RATE * 0.97;
    let ratio = none.amplitude(1) / damped.amplitude(1);
    assert!((ratio / expected - 1.0).abs() < 0.06, "{ratio} {expected}");
    for response in [&none, &damped] {
        assert_eq!(response.stable(), Some(true));
    }
    let largest = |response: &PeriodicResponse| response.multipliers.as_ref().unwrap()[0].norm();
    assert!(largest(&damped) < largest(&none));
}

/// The multipliers of a mass are those of the map over a period, differenced; their product is
/// exp(-integral of h + c / m).
#[test]
fn multipliers_are_those_of_the_map_over_a_period() {
    let power: Law = Arc::new(Power::new(0.9e10, 0.35, 0.0).unwrap());
    for damping in [
        ContactDamping::kelvin_voigt(8e-6).unwrap(),
        ContactDamping::power(8e6, PRESSURE, 1.5).unwrap(),
    ] {
        let system = mass_on(&power, damping);
        let resolution = FourierResolution::Fixed { harmonics: 16, samples: 256 };
        let stability = Some(Floquet { modes: 1 });
        let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
        let sweep = Continuation::Frequency { force: 1.2, from: 860.0, to: 862.0 };
        let response = trace(&system, &sweep, &settings).unwrap().points.remove(0);
        let multipliers = response.multipliers.clone().unwrap();
        // The trace of the damping along the motion.
        let period = TAU / response.angular_frequency;
        let samples = 4000;
        let trace_of = |n: usize| {
            let [closure, _, _] = response.closure_at(0, TAU * n as f64 / samples as f64);
            let at = power.pressure_increment(PRESSURE, closure);
            AREA * damping.coefficient(PRESSURE + at.value, at.tangent) / MASS
        };
        let mean = (0..samples).map(trace_of).sum::<f64>() / samples as f64;
        let product: Complex64 = multipliers.iter().product();
        let exact = (-(RATE + mean) * period).exp();
        assert!((product / exact - 1.0).norm() < 1e-7, "{product} {exact}");
        // The map over one period about the state of the response.
        let slope = |t: f64, [u, v]: [f64; 2]| {
            let at = power.pressure_increment(PRESSURE, u);
            let traction = at.value + v * damping.coefficient(PRESSURE + at.value, at.tangent);
            let force = 1.2 * (response.angular_frequency * t).cos();
            [v, (force - AREA * traction) / MASS - RATE * v]
        };
        let map = |mut state: [f64; 2]| {
            let dt = period / 2000.0;
            let ahead = |x: [f64; 2], k: [f64; 2], t: f64| [x[0] + t * k[0], x[1] + t * k[1]];
            for n in 0..2000 {
                let t = f64::from(n) * dt;
                let a = slope(t, state);
                let b = slope(t + 0.5 * dt, ahead(state, a, 0.5 * dt));
                let c = slope(t + 0.5 * dt, ahead(state, b, 0.5 * dt));
                let d = slope(t + dt, ahead(state, c, dt));
                for i in 0..2 {
                    state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
                }
            }
            state
        };
        let [u, du, _] = response.closure_at(0, 0.0);
        let start = [u, du * response.angular_frequency];
        let column = |i: usize, size: f64| {
            let [up, down] = [1.0, -1.0].map(|sign| {
                let mut state = start;
                state[i] += sign * size;
                map(state)
            });
            [0, 1].map(|k| (up[k] - down[k]) / (2.0 * size))
        };
        let (first, second) = (column(0, 1e-12), column(1, 1e-12 * response.angular_frequency));
        let trace = first[0] + second[1];
        let determinant = first[0] * second[1] - first[1] * second[0];
        let sum: Complex64 = multipliers.iter().sum();
        assert!((sum.re - trace).abs() < 2e-5, "{sum} {trace}");
        assert!((product.re - determinant).abs() < 2e-5, "{product} {determinant}");
    }
}
