//! The rigs, the second methods and the measures that the tests share.

pub mod absolute_scheme;
pub mod agreement;
pub mod bar_chain;
pub mod half_spaces;
pub mod hit_response;
pub mod receptance;
pub mod statics;

use std::sync::Arc;

use asperity_dynamics::{Integrator, Sampling, Transient};
use asperity_law::{
    Constant, ContactDamping, ContactLaw, Exponential, Hyperbolic, InSeries, ModifiedPower, Power,
    Tabulated,
};
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

pub type Law = Arc<dyn ContactLaw>;

/// Contact area of the paper's rig [m2].
pub const AREA: f64 = 1.15e-4;

/// The paper's modified law, as reconstructed.
pub fn modified() -> Law {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap())
}

/// The paper's power law.
pub fn power() -> Law {
    Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap())
}

/// The paper's constant stiffness.
pub fn constant() -> Law {
    Arc::new(Constant::new(8.5e11).unwrap())
}

/// One of every law, and of a power law one of every kind, of about 1e12 Pa/m at
/// the rig's static pressure.
pub fn every_law() -> Vec<(&'static str, Law)> {
    let points = [(0.02e6, 2e11), (0.08e6, 5e11), (0.15e6, 1e12), (0.4e6, 1.8e12), (1e6, 3e12)];
    let series = InSeries::new(Power::new(1.81e10, 0.35, 0.0).unwrap(), 5e12).unwrap();
    vec![
        ("constant", constant()),
        ("unilateral constant", Arc::new(Constant::unilateral(8.5e11).unwrap())),
        ("power, m = 0.35", power()),
        ("power, m = 1", Arc::new(Power::new(7e6, 1.0, 1.4e5).unwrap())),
        ("power, m = 1.5", Arc::new(Power::new(1.9e4, 1.5, 1.4e5).unwrap())),
        ("modified", modified()),
        ("exponential", exponential()),
        ("hyperbolic", Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap())),
        ("table", Arc::new(Tabulated::new(&points).unwrap())),
        ("in series", Arc::new(series)),
    ]
}

/// An exponential law of stiffness 1e12 Pa/m at 1.4e5 Pa.
pub fn exponential() -> Law {
    Arc::new(Exponential::new(1.4e-7, 1.4e5).unwrap())
}

/// The paper's rig with the same law at both contacts.
pub fn rig(law: &Law) -> Stack {
    rig_on(law, Support::Rigid)
}

pub fn rig_on(law: &Law, support: Support) -> Stack {
    Stack::new(
        vec![
            Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap(),
            Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap(),
        ],
        vec![
            Interface::new("guide-sample", AREA, Arc::clone(law)).unwrap(),
            Interface::new("sample-disc", AREA, Arc::clone(law)).unwrap(),
        ],
        support,
        9.81,
    )
    .unwrap()
}

/// The stack with this damping at all of its contacts.
pub fn damped(stack: &Stack, damping: ContactDamping) -> Stack {
    let interfaces = stack.interfaces().iter().map(|one| one.clone().with_damping(damping));
    let bodies = stack.bodies().to_vec();
    Stack::new(bodies, interfaces.collect(), *stack.support(), stack.gravity()).unwrap()
}

/// The pulse that stands in for the paper's unpublished one.
pub fn pulse(peak: f64) -> LoadCase {
    LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, peak)
}

/// Three bodies of different materials and sections on the modified law.
pub fn three_bodies(support: Support) -> Stack {
    let law = modified();
    let contact = |name| Interface::new(name, AREA, Arc::clone(&law)).unwrap();
    Stack::new(
        vec![
            Body::new("steel", 0.08, 6e-4, 210e9, 7800.0).unwrap(),
            Body::new("aluminium", 0.03, 2e-4, 71e9, 2710.0).unwrap(),
            Body::new("polymer", 0.02, 3e-4, 3e9, 1200.0).unwrap(),
        ],
        vec![contact("upper"), contact("middle"), contact("lower")],
        support,
        9.81,
    )
    .unwrap()
}

/// A compliant disc: 3 kg on a spring and damper, near 1.3 kHz.
pub const DISC: Support = Support::SpringMass { stiffness: 2e8, mass: 3.0, damping_ratio: 0.05 };

/// The rest of `stack`, without damping.
pub fn at_rest(stack: &Stack) -> PreloadedStructure {
    PreloadedStructure::new(stack.clone(), Damping::Rate(0.0)).unwrap()
}

/// A run of `stack` with the damping `rate` [1/s], sampled at `sampling_rate` [Hz].
pub fn run_at(
    stack: &Stack,
    method: &(impl Into<Integrator> + Copy),
    rate: f64,
    excitation: &LoadCase,
    (duration, sampling_rate): (f64, f64),
) -> Transient {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(rate)).unwrap();
    let sampling = Sampling::new(duration, sampling_rate).unwrap();
    let method: Integrator = (*method).into();
    method.integrate(&structure, excitation, &[Port::TOP], &sampling).unwrap()
}

/// Largest difference of two columns over the largest magnitude of the second.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let worst = a.iter().zip(b).fold(0.0_f64, |m, (x, y)| {
        let off = (x - y).abs();
        if off.is_nan() { f64::NAN } else { m.max(off) }
    });
    worst / largest
}

/// A run of `stack` at 200 kHz with the paper's damping ratio.
pub fn run(
    stack: &Stack,
    method: &(impl Into<Integrator> + Copy),
    excitation: &LoadCase,
    duration: f64,
) -> Transient {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Ratio(0.035)).unwrap();
    let sampling = Sampling::new(duration, 2e5).unwrap();
    let method: Integrator = (*method).into();
    method.integrate(&structure, excitation, &[Port::TOP], &sampling).unwrap()
}

/// Slope of `ln error` over `ln size` by least squares.
pub fn slope(sizes: &[f64], errors: &[f64]) -> f64 {
    let x: Vec<f64> = sizes.iter().map(|s| s.ln()).collect();
    let y: Vec<f64> = errors.iter().map(|e| e.ln()).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(&x), mean(&y));
    let top: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    top / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>()
}

/// The guide bar alone on one contact.
pub fn single_body(law: &Law, gravity: f64) -> Stack {
    Stack::new(
        vec![Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap()],
        vec![Interface::new("guide-disc", AREA, Arc::clone(law)).unwrap()],
        Support::Rigid,
        gravity,
    )
    .unwrap()
}
