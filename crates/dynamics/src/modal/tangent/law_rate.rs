//! How a law answers a parameter at a given closure.

use std::sync::Arc;

use asperity_law::ContactLaw;

use crate::difference::central_difference;
use asperity_structure::PreloadedContact;

/// The derivative of one interface's law and static pressure with respect to one parameter.
///
/// At a given pressure p the closure gained since rest is `x = integral of dp / K` from the static
/// pressure p0. Differentiated at fixed x,
///
/// ```text
/// dp/dtheta = -K(p) d/dtheta integral of dp / K  +  dp0/dtheta (K(p) / K(p0) - 1)
/// ```
///
/// p counting from p0. The integral, at fixed pressures, is smooth in the parameters of a law even
/// where contact is lost, and is zero with the increment; closures at fixed pressure are neither.
#[derive(Debug)]
pub(super) struct LawRate {
    base: Arc<dyn ContactLaw>,
    /// The law at the places of the stencil, if it is varied.
    varied: Option<[Arc<dyn ContactLaw>; 4]>,
    step: f64,
    pressure: f64,
    pub(super) pressure_rate: f64,
    /// `1 / K(p0)` of the base law \[m/Pa\], if the static pressure is varied.
    yielding: f64,
}

/// Derivatives of one interface in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Rates {
    /// Of the pressure gained, at fixed closure gained.
    pub(super) pressure: f64,
    /// Of the stiffness, at fixed pressure.
    pub(super) stiffness: f64,
}

impl LawRate {
    /// The rate of `base` from the laws at four `places`; none when rest has no stiffness but a
    /// pressure that varies.
    pub(super) fn new(
        base: &PreloadedContact,
        places: [&PreloadedContact; 4],
        step: f64,
        pressure_rate: f64,
    ) -> Option<Self> {
        let same = places.iter().all(|place| Arc::ptr_eq(place.law(), base.law()));
        let varied = (!same).then(|| places.map(|place| Arc::clone(place.law())));
        let stiffness = base.law().stiffness(base.pressure());
        let yielding = if pressure_rate == 0.0 { 0.0 } else { 1.0 / stiffness };
        yielding.is_finite().then(|| Self {
            base: Arc::clone(base.law()),
            varied,
            step,
            pressure: base.pressure(),
            pressure_rate,
            yielding,
        })
    }

    /// The rates where `gained` \[Pa\] is the pressure gained, `tangent` \[Pa/m\] its tangent; faces
    /// that are `open` keep a pressure of zero.
    pub(super) fn at(&self, gained: f64, tangent: f64, open: bool) -> Rates {
        if open {
            return Rates { pressure: -self.pressure_rate, stiffness: 0.0 };
        }
        let mut rates = Rates::default();
        if let Some(laws) = &self.varied {
            let closures = laws.each_ref().map(|law| law.closure_increment(self.pressure, gained));
            rates.pressure -= tangent * central_difference(closures, self.step);
            rates.stiffness += self.stiffness(self.pressure + gained);
        }
        if self.pressure_rate != 0.0 {
            rates.pressure += self.pressure_rate * (tangent * self.yielding - 1.0);
        }
        rates
    }

    /// Derivative of the stiffness at a fixed `pressure` \[Pa\].
    pub(super) fn stiffness(&self, pressure: f64) -> f64 {
        let Some(laws) = &self.varied else { return 0.0 };
        central_difference(laws.each_ref().map(|law| law.stiffness(pressure)), self.step)
    }

    /// Share of the stiffness's derivative that a `pressure` \[Pa\] varying by `rate` brings.
    pub(super) fn slope(&self, pressure: f64, rate: f64) -> f64 {
        if rate == 0.0 { 0.0 } else { self.base.stiffness_slope(pressure) * rate }
    }
}
