//! Period doublings and Neimark-Sacker bifurcations, located and named.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings, LawEvaluation,
    RigidMass, SpecialPointKind, trace,
};
use asperity_mesh::{ComponentModes, NormalMode, PortPair, ResidualFlexibility};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};

use crate::rigs::{Cubic, Law};
use crate::stability::{both, with_stability};

/// `u'' + 2 z u' + u + q u^2 + c u^3 = F cos(W t)` near W = 2: the response modulates its own
/// stiffness at twice the natural frequency; where the modulation exceeds the damping, the period
/// doubles.
#[test]
fn period_doublings_are_located() {
    let law: Law = Arc::new(Cubic { stiffness: 1.0, square: 1.0, cube: 0.5 });
    let contact = PreloadedContact::new("spring", 1.0, Arc::clone(&law), 0.0).unwrap();
    let mass = RigidMass::new(1.0, 0.02).unwrap();
    let system = ContactSystem::new(Arc::new(mass), vec![contact], LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Frequency { force: 0.2, from: 1.7 / TAU, to: 2.2 / TAU };
    let found = with_stability(&system, continuation, 1);
    let doublings: Vec<_> = found.of_kind(SpecialPointKind::PeriodDoubling).collect();
    assert_eq!(doublings.len(), 2, "{:?}", found.special.len());
    for doubling in &doublings {
        let [hill, time] = both(&system, doubling, 1).map(|multipliers| multipliers[0]);
        assert!((time + 1.0).norm() < 1e-8, "{time}");
        assert!((hill + 1.0).norm() < 1e-7, "{hill}");
    }
    // Mathieu: with the modulation d = 2 q U of the stiffness the edges are
    // W = 2 w0 +- sqrt(d^2 / 4 - 4 z^2) w0 to first order, w0 the shifted natural frequency.
    let modulation = 2.0 * doublings[0].amplitude(1);
    let width = TAU * (doublings[1].frequency_hz() - doublings[0].frequency_hz());
    let expected = 2.0 * (0.25 * modulation * modulation - 4.0 * 1e-4).sqrt();
    assert!((width / expected - 1.0).abs() < 0.1, "{width} {expected}");
    for (number, point) in found.points.iter().enumerate() {
        let inside = found
            .special
            .iter()
            .filter(|s| s.kind == SpecialPointKind::PeriodDoubling && s.after < number);
        let stable = inside.count() != 1;
        assert_eq!(point.stable(), Some(stable), "{number}");
        let [hill, _] = both(&system, point, 1);
        assert_eq!(hill[0].norm() <= 1.0, stable, "{number}");
    }
}

/// The symmetric Duffing oscillator loses its symmetry at a high force: a branch with even harmonics
/// crosses where a multiplier is +1 and nothing folds. The branch followed stays symmetric.
#[test]
fn loss_of_symmetry_is_a_branch_point() {
    let law: Law = Arc::new(Cubic { stiffness: 1.0, square: 0.0, cube: 1.0 });
    let contact = PreloadedContact::new("spring", 1.0, law, 0.0).unwrap();
    let mass = RigidMass::new(1.0, 0.2).unwrap();
    let system = ContactSystem::new(Arc::new(mass), vec![contact], LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Frequency { force: 25.0, from: 3.0 / TAU, to: 2.0 / TAU };
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 25, samples: 256 },
        stability: Some(Floquet::default()),
        ..HarmonicSettings::default()
    };
    let found = trace(&system, &continuation, &settings).unwrap();
    let crossings: Vec<_> = found.of_kind(SpecialPointKind::BranchPoint).collect();
    assert_eq!(crossings.len(), 1);
    let multipliers = crossings[0].multipliers.as_ref().unwrap();
    // The disturbance's integration in 512 steps.
    assert!((multipliers[0] - 1.0).norm() < 3e-6, "{multipliers:?}");
    assert_eq!(found.points[0].stable(), Some(true));
    assert_eq!(found.points.last().unwrap().stable(), Some(false));
    for point in &found.points {
        assert!(point.amplitude(2) < 1e-8 * point.amplitude(1));
    }
}

/// Two modes whose linearised frequencies are 1 and 2, and a quadratic contact that couples them.
const COUPLING: [f64; 2] = [1.0, 0.5];
const UPPER_SQUARED: f64 = 3.618;
const RATE: f64 = 0.04;
const FORCE: f64 = 0.03;

fn two_modes() -> (ContactSystem, Law) {
    let law: Law = Arc::new(Cubic { stiffness: 1.1056, square: 1.0, cube: 1.0 });
    let modes = vec![
        NormalMode::rigid(vec![1.0, COUPLING[0]]),
        NormalMode::elastic(UPPER_SQUARED.sqrt(), vec![0.0, COUPLING[1]]),
    ];
    let contacts = vec![PortPair::on_ground(1)];
    let modes = ComponentModes::new(modes, ResidualFlexibility::zero(2), contacts, vec![]).unwrap();
    let contact = PreloadedContact::new("spring", 1.0, Arc::clone(&law), 0.0).unwrap();
    let damping = Damping::Rate(RATE);
    let structure = PreloadedStructure::of_components(modes, vec![contact], damping).unwrap();
    (ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap(), law)
}

/// Variation of the displacement once a period, 400 periods after rest, relative to itself, by the
/// classical Runge-Kutta method.
fn variation(law: &Law, frequency: f64) -> f64 {
    let slope = |t: f64, x: [f64; 4]| {
        let contact = law.pressure_increment(0.0, COUPLING[0] * x[0] + COUPLING[1] * x[1]).value;
        let drive = FORCE * (frequency * t).cos();
        [
            x[2],
            x[3],
            drive - RATE * x[2] - COUPLING[0] * contact,
            -RATE * x[3] - UPPER_SQUARED * x[1] - COUPLING[1] * contact,
        ]
    };
    let ahead = |x: [f64; 4], k: [f64; 4], t: f64| std::array::from_fn(|i| x[i] + t * k[i]);
    let dt = TAU / (frequency * 100.0);
    let (mut x, mut range) = ([0.0; 4], (f64::INFINITY, f64::NEG_INFINITY));
    for period in 0..600 {
        for n in 0..100 {
            let t = f64::from(n) * dt;
            let a = slope(t, x);
            let b = slope(t + 0.5 * dt, ahead(x, a, 0.5 * dt));
            let c = slope(t + 0.5 * dt, ahead(x, b, 0.5 * dt));
            let d = slope(t + dt, ahead(x, c, dt));
            x = std::array::from_fn(|i| x[i] + dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        if period >= 400 {
            range = (range.0.min(x[0]), range.1.max(x[0]));
        }
    }
    (range.1 - range.0) / range.1.abs().max(range.0.abs())
}

/// Driven at the lower mode, with the upper one at twice the frequency: between two Neimark-Sacker
/// bifurcations the motion is quasi-periodic, by integration in time as well.
#[test]
fn neimark_sacker_bifurcations_are_located() {
    let (system, law) = two_modes();
    let continuation = Continuation::Frequency { force: FORCE, from: 0.9 / TAU, to: 1.1 / TAU };
    let found = with_stability(&system, continuation, 2);
    let located: Vec<_> = found.of_kind(SpecialPointKind::NeimarkSacker).collect();
    assert_eq!(located.len(), 2);
    for point in &located {
        let [hill, time] = both(&system, point, 2).map(|multipliers| multipliers[0]);
        assert!((time.norm() - 1.0).abs() < 1e-9);
        assert!((hill.norm() - 1.0).abs() < 1e-7, "{hill}");
        assert!(time.im.abs() > 1e-3 && hill.im.abs() > 1e-3);
    }
    let edges = [located[0].angular_frequency, located[1].angular_frequency];
    let middle = 0.5 * (edges[0] + edges[1]);
    assert!(variation(&law, middle) > 1e-2, "{}", variation(&law, middle));
    for outside in [2.0 * edges[0] - middle, 2.0 * edges[1] - middle] {
        assert!(variation(&law, outside) < 1e-3, "{}", variation(&law, outside));
    }
}
