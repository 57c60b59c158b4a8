//! The rigs that the tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::sync::Arc;

use asperity_dynamics::{
    Damping, Equilibrium, Excitation, FiniteDifference, Sampling, Transient,
};
use asperity_law::{Constant, ContactLaw, ModifiedPower, Power};
use asperity_mesh::{Body, Interface, Stack, Support};

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

/// The pulse that stands in for the paper's unpublished one.
pub fn pulse(peak: f64) -> Excitation {
    Excitation::GammaPulse { peak, rise: 0.34e-3 }
}

/// A run of `stack` at 200 kHz with the paper's damping ratio.
pub fn run(
    stack: &Stack,
    method: &FiniteDifference,
    excitation: &Excitation,
    duration: f64,
) -> Transient {
    let equilibrium = Equilibrium::of(stack).unwrap();
    let rate = Damping::Ratio(0.035).rate(stack, &equilibrium).unwrap();
    let sampling = Sampling::new(duration, 2e5).unwrap();
    method.integrate(stack, &equilibrium, rate, excitation, &sampling, &|_| ()).unwrap()
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
