//! Structures with contacts that are open at rest, and structures that nothing holds.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    PeriodicResponse, SystemPort, trace,
};
use asperity_law::{Constant, ContactLaw, Power};
use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};
use num_complex::Complex64;

use crate::integration::harmonic;

const AREA: f64 = 1e-4;
const MASS: f64 = 2.0;
const STIFFNESS: f64 = 2e11;
const RATE: f64 = 60.0;

fn response(
    structure: &PreloadedStructure<ComponentModes>,
    (load, sensor): (usize, usize),
    force: f64,
    frequency: f64,
) -> PeriodicResponse {
    let system = ContactSystem::of_structure(structure, LawEvaluation::Exact).unwrap();
    let port = SystemPort::Number;
    let system = system.with_ports(port(load), &[port(sensor)]).unwrap();
    let resolution = FourierResolution::Fixed { harmonics: 40, samples: 1280 };
    let stability = Some(Floquet::default());
    let settings = HarmonicSettings { resolution, stability, ..HarmonicSettings::default() };
    let sweep = Continuation::Frequency { force, from: frequency, to: 1.0001 * frequency };
    trace(&system, &sweep, &settings).unwrap().points.remove(0)
}

/// A mass on a spring that meets a rough stop behind a gap, against the classical Runge-Kutta method.
#[test]
fn a_contact_behind_a_gap() {
    let spring: Arc<dyn ContactLaw> = Arc::new(Constant::new(STIFFNESS).unwrap());
    let rough: Arc<dyn ContactLaw> = Arc::new(Power::new(2e10, 0.4, 0.0).unwrap());
    let gap = 0.4e-6;
    let contacts = vec![
        PreloadedContact::new("spring", AREA, spring, 1e5).unwrap(),
        PreloadedContact::open("stop", AREA, Arc::clone(&rough), gap).unwrap(),
    ];
    let mass = NormalMode::rigid(vec![MASS.sqrt().recip()]);
    let pairs = vec![PortPair::on_ground(0), PortPair::on_ground(0)];
    let modes = ComponentModes::new(vec![mass], ResidualFlexibility::zero(1), pairs, vec![]);
    let structure =
        PreloadedStructure::of_components(modes.unwrap(), contacts, Damping::Rate(RATE)).unwrap();
    // Below the frequency of the spring alone, 503 Hz, where the motion reaches the stop.
    let (force, frequency) = (4.0, 480.0);
    let found = response(&structure, (0, 0), force, frequency);
    assert!(found.stable().unwrap() && !found.contact_lost());
    assert!(found.pressures[1].lowest == 0.0 && found.pressures[1].highest > 1e4);

    let slope = |phase: f64, [u, v]: [f64; 2]| {
        let stop = rough.pressure((u - gap).max(0.0)).value;
        let pressure = STIFFNESS * u + stop;
        [v, (force * phase.cos() - AREA * pressure) / MASS - RATE * v]
    };
    let steps = 2000;
    let dt = 1.0 / (frequency * f64::from(steps));
    let ahead = |x: [f64; 2], k: [f64; 2], t: f64| [x[0] + t * k[0], x[1] + t * k[1]];
    let mut state = [found.displacement_at(0.0), 0.0];
    let mut samples = Vec::new();
    for _ in 0..400 {
        samples.clear();
        for n in 0..steps {
            samples.push(state[0]);
            let phase = |half: f64| TAU * (f64::from(n) + half) / f64::from(steps);
            let a = slope(phase(0.0), state);
            let b = slope(phase(0.5), ahead(state, a, 0.5 * dt));
            let c = slope(phase(0.5), ahead(state, b, 0.5 * dt));
            let d = slope(phase(1.0), ahead(state, c, dt));
            for i in 0..2 {
                state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
    }
    for k in 1..=5 {
        let expected = harmonic(&samples, k);
        let off = (found.amplitude(k) - expected).abs() / found.amplitude(1);
        assert!(off < 1e-6, "{k}: {} {expected}", found.amplitude(k));
    }
    assert!(found.amplitude(2) > 1e-2 * found.amplitude(1));
}

/// Two free masses on one contact, in closed form: the common motion has no multiplier.
#[test]
fn a_structure_that_nothing_holds() {
    let [upper, lower] = [MASS, 3.0];
    // Rigid motions in an arbitrary basis: each moves both masses.
    let shape = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        NormalMode::rigid(vec![cos / upper.sqrt(), sin / lower.sqrt()])
    };
    let rigid = vec![shape(0.3), shape(0.3 + 0.25 * TAU)];
    let zero = ResidualFlexibility::zero(2);
    let modes = ComponentModes::new(rigid, zero, vec![PortPair::between(0, 1)], vec![]).unwrap();
    let law = Arc::new(Constant::new(STIFFNESS).unwrap());
    let contact = PreloadedContact::new("joint", AREA, law, 1e5).unwrap();
    let damping = Damping::Rate(RATE);
    let structure = PreloadedStructure::of_components(modes, vec![contact], damping).unwrap();
    let (force, frequency) = (3.0, 700.0);
    let found = response(&structure, (0, 1), force, frequency);
    let w = TAU * frequency;
    let spring = AREA * STIFFNESS;
    let inertia = |mass: f64| mass * Complex64::new(-w * w, RATE * w);
    let product = inertia(upper) * inertia(lower);
    let sum = inertia(upper) + inertia(lower);
    let expected = force * spring / (product + spring * sum);
    let own = found.at_sensor(0, 1);
    assert!((own - expected).norm() < 1e-10 * expected.norm(), "{own} {expected}");
    let multipliers = found.multipliers.as_ref().unwrap();
    let decay = (-0.5 * RATE / frequency).exp();
    assert_eq!(multipliers.len(), 2);
    for multiplier in multipliers {
        assert!((multiplier.norm() - decay).abs() < 1e-5, "{multiplier} {decay}");
    }
}
