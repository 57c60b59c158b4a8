//! Floquet multipliers: two methods against each other, exact results, and time integration.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    Branch, ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings,
    LawEvaluation, PeriodicResponse, trace,
};
use asperity_law::Constant;
use asperity_mesh::Support;
use num_complex::Complex64;

use crate::integration::{Motion, state_of};
use crate::koopman_hill;
use crate::rigs::{Law, mass_on, power, preloaded, rate_on, reference_law, rig};

pub(crate) fn with_stability(
    system: &ContactSystem,
    continuation: Continuation,
    modes: usize,
) -> Branch {
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 9, samples: 128 },
        stability: Some(Floquet { modes }),
        ..HarmonicSettings::default()
    };
    trace(system, &continuation, &settings).unwrap()
}

/// The multipliers by the Koopman-Hill projection, and by integration in time.
pub(crate) fn both(
    system: &ContactSystem,
    response: &PeriodicResponse,
    modes: usize,
) -> [Vec<Complex64>; 2] {
    let hill = koopman_hill::multipliers(system, response, modes);
    [hill, response.multipliers.clone().unwrap()]
}

/// With constant stiffness every multiplier has the modulus `exp(-h T / 2)`, and the slowest pair
/// turns by the first mode's damped frequency.
#[test]
fn a_linear_rig_has_the_multipliers_of_its_modes() {
    let law: Law = Arc::new(Constant::new(8.5e11).unwrap());
    let (stack, rate) = (rig(&law, Support::Rigid), 370.0);
    let structure = preloaded(stack, rate);
    let natural = structure.natural_frequency().unwrap();
    let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Frequency { force: 1.0, from: 900.0, to: 901.0 };
    let found = with_stability(&system, continuation, 8);
    for multipliers in both(&system, &found.points[0], 8) {
        assert_eq!(multipliers.len(), 16);
        let period = 1.0 / 900.0;
        for multiplier in &multipliers {
            let ratio = multiplier.norm() / (-0.5 * rate * period).exp();
            assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
        }
        let damped = ((TAU * natural).powi(2) - 0.25 * rate * rate).sqrt();
        let expected = Complex64::from_polar((-0.5 * rate * period).exp(), damped * period);
        let nearest = multipliers.iter().map(|m| (m - expected).norm()).fold(1.0, f64::min);
        // Eight modes with residual flexibility have the first frequency to 1e-6.
        assert!(nearest < 1e-4, "{nearest:.1e}");
    }
}

/// The monodromy matrix by differences of the nonlinear motion itself, by stable and unstable
/// responses. Differences of 1e-4 of the amplitude are good to about 1e-8 when central.
#[test]
fn the_single_mass_has_the_multipliers_of_its_own_motion() {
    let law = reference_law();
    let system = mass_on(&law, LawEvaluation::Exact);
    // Contact is about to be lost at the end; the response folds before.
    let continuation = Continuation::Frequency { force: 1.1, from: 1000.0, to: 880.0 };
    let found = with_stability(&system, continuation, 1);
    for point in found.points.iter().step_by(5).filter(|point| !point.contact_lost()) {
        let motion =
            Motion { law: &law, rate: rate_on(&law), force: 1.1, frequency: point.frequency_hz() };
        let [u, v] = state_of(point);
        let (du, dv) = (1e-4 * point.amplitude(1), 0.6 * point.amplitude(1));
        let after = |du: f64, dv: f64| motion.period([u + du, v + dv], |_| ());
        let column = |a: [f64; 2], b: [f64; 2], d: f64| {
            [(a[0] - b[0]) / (2.0 * d), (a[1] - b[1]) / (2.0 * d)]
        };
        let first = column(after(du, 0.0), after(-du, 0.0), du);
        let second = column(after(0.0, dv), after(0.0, -dv), dv);
        let sum = first[0] + second[1];
        let product = first[0] * second[1] - first[1] * second[0];
        for multipliers in both(&system, point, 1) {
            let off = (multipliers[0] + multipliers[1] - sum).norm();
            assert!(off < 1e-6, "{off:.1e}");
            let off = (multipliers[0] * multipliers[1] - product).norm();
            assert!(off < 1e-6, "{off:.1e}");
        }
        // Liouville: volumes shrink by the damping alone.
        let exact = (-rate_on(&law) / point.frequency_hz()).exp();
        assert!((product - exact).abs() < 1e-6);
    }
}

/// On the full rig both methods agree: the slow pair closely, the fast modes that the contacts
/// couple to what kicks 0.4 rad apart allow.
#[test]
fn both_methods_agree_on_the_rig() {
    let stack = rig(&power(), Support::Rigid);
    let structure = preloaded(stack, 416.0);
    let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Force { frequency: 930.0, from: 0.5, to: 0.8 };
    let found = with_stability(&system, continuation, 5);
    let [hill, time] = both(&system, found.points.last().unwrap(), 5);
    let off: Vec<f64> = hill
        .iter()
        .map(|m| time.iter().map(|other| (m - other).norm()).fold(f64::INFINITY, f64::min))
        .collect();
    assert!(off.iter().all(|off| *off < 1e-2), "{off:?}");
    // The slow pair, and all but the sample's own motion.
    assert_eq!(off.iter().filter(|off| **off < 1e-7).count(), 2, "{off:?}");
    assert_eq!(off.iter().filter(|off| **off < 1e-4).count(), 6, "{off:?}");
    // Liouville's product: ten states, damped at one rate.
    let product: Complex64 = hill.iter().product();
    let exact = (-5.0 * 416.0 / 930.0_f64).exp();
    assert!((product - exact).norm() < 1e-8 * exact, "{product}");
}
