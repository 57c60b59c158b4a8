//! The systems that the tests share.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{
    Branch, ContactSystem, Continuation, FourierResolution, HarmonicSettings, LawEvaluation,
    RigidMass, trace,
};
use asperity_law::{ContactLaw, Domain, Exponential, InSeries, ModifiedPower, Power, Pressure};
use asperity_mesh::{Body, Interface, Stack, Support};
use asperity_structure::{Damping, PreloadedContact, PreloadedStructure};

pub(crate) type Law = Arc<dyn ContactLaw>;

/// Contact area of the paper's rig [m2].
pub(crate) const AREA: f64 = 1.15e-4;

/// Mass of the guide bar [kg].
pub(crate) const MASS: f64 = 1.61;

/// Static pressure under the guide bar [Pa].
pub(crate) const PRESSURE: f64 = MASS * 9.81 / AREA;

/// Two power-law contacts and the sample's spring in series: `x(p) = 2 d(p) + p L / E`.
pub(crate) fn reference_law() -> Law {
    let contacts = Power::new(0.5 * 1.81e10, 0.35, 0.0).unwrap();
    Arc::new(InSeries::new(contacts, 71e9 / 0.015).unwrap())
}

/// Damping rate [1/s] of the single mass on `law`, for the ratio 0.035.
pub(crate) fn rate_on(law: &Law) -> f64 {
    2.0 * 0.035 * (AREA * law.stiffness(PRESSURE) / MASS).sqrt()
}

/// The guide bar as a rigid mass on one law, with the damping ratio 0.035.
pub(crate) fn mass_on(law: &Law, evaluation: LawEvaluation) -> ContactSystem {
    let contact = PreloadedContact::new("contacts", AREA, Arc::clone(law), PRESSURE).unwrap();
    let mass = RigidMass::new(MASS, rate_on(law)).unwrap();
    ContactSystem::new(Arc::new(mass), vec![contact], evaluation).unwrap()
}

/// Linearised natural frequency [Hz] of [`mass_on`].
pub(crate) fn natural_frequency(law: &Law) -> f64 {
    (AREA * law.stiffness(PRESSURE) / MASS).sqrt() / TAU
}

/// `stack` at rest with the damping `rate` [1/s].
pub(crate) fn preloaded(stack: Stack, rate: f64) -> PreloadedStructure {
    PreloadedStructure::new(stack, Damping::Rate(rate)).unwrap()
}

/// The paper's laws.
pub(crate) fn power() -> Law {
    Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap())
}

pub(crate) fn modified() -> Law {
    let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
    Arc::new(ModifiedPower::new(1.81e10, 0.35, 2e5, &knots).unwrap())
}

/// An exponential law of stiffness 1e12 Pa/m at 1.4e5 Pa.
pub(crate) fn exponential() -> Law {
    Arc::new(Exponential::new(1.4e-7, 1.4e5).unwrap())
}

/// The paper's rig: guide bar, sample, two interfaces.
pub(crate) fn rig(law: &Law, support: Support) -> Stack {
    let guide = Body::with_mass("guide bar", 0.229, MASS, 71e9, 2710.0).unwrap();
    let sample = Body::new("sample", 0.015, AREA, 71e9, 2710.0).unwrap();
    let contact = |name| Interface::new(name, AREA, Arc::clone(law)).unwrap();
    let interfaces = vec![contact("guide-sample"), contact("sample-disc")];
    Stack::new(vec![guide, sample], interfaces, support, 9.81).unwrap()
}

/// A branch at fixed resolution.
pub(crate) fn branch(
    system: &ContactSystem,
    continuation: Continuation,
    (harmonics, samples): (usize, usize),
) -> Branch {
    let resolution = FourierResolution::Fixed { harmonics, samples };
    trace(system, &continuation, &HarmonicSettings { resolution, ..HarmonicSettings::default() })
        .unwrap()
}

/// A bilateral law without static pressure, `p = k (d + q d^2 + c d^3)`.
#[derive(Debug)]
pub(crate) struct Cubic {
    pub(crate) stiffness: f64,
    pub(crate) square: f64,
    pub(crate) cube: f64,
}

impl ContactLaw for Cubic {
    /// At rest only.
    fn stiffness(&self, _pressure: f64) -> f64 {
        self.stiffness
    }
    fn stiffness_slope(&self, _pressure: f64) -> f64 {
        2.0 * self.square
    }
    fn domain(&self) -> Domain {
        Domain::BILATERAL
    }
    fn reference_pressure(&self) -> f64 {
        0.0
    }
    fn pressure(&self, closure: f64) -> Pressure {
        self.pressure_increment(0.0, closure)
    }
    fn pressure_increment(&self, _from: f64, d: f64) -> Pressure {
        Pressure {
            value: self.stiffness * d * (1.0 + d * (self.square + d * self.cube)),
            tangent: self.stiffness * (1.0 + d * (2.0 * self.square + d * 3.0 * self.cube)),
        }
    }
}
