//! Derivative of a law with respect to a parameter, at a given closure.

use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw};

use super::derivative_table::{DerivativeTable, Sloped};
use crate::difference::central_difference;
use asperity_structure::PreloadedContact;

/// Pressure over the static pressure below which derivatives are not tabulated.
const NEAR_LOSS: f64 = 1e-3;

/// The derivative of one interface's law and static pressure with respect to one parameter.
///
/// At a given pressure p the closure increment since rest is `x = integral of dp / K` from the static
/// pressure p0. Differentiated at fixed x,
///
/// ```text
/// dp/dtheta = -K(p) d/dtheta integral of dp / K  +  dp0/dtheta (K(p) / K(p0) - 1)
/// ```
///
/// p counting from p0. The integral, at fixed pressures, is smooth in the parameters of a law even
/// where contact is lost, and is zero with the increment; closures at fixed pressure are neither.
#[derive(Debug)]
pub(super) struct LawDerivative {
    base: Arc<dyn ContactLaw>,
    /// The law at the places of the stencil, if it is varied.
    varied: Option<[Arc<dyn ContactLaw>; 4]>,
    /// The derivatives of closure from rest and stiffness over the pressure \[Pa\].
    table: Option<DerivativeTable>,
    /// None without damping.
    damping: Option<VariedDamping>,
    step: f64,
    pressure: f64,
    pub(super) pressure_derivative: f64,
    /// `1 / K(p0)` of the base law \[m/Pa\], if the static pressure is varied.
    yielding: f64,
}

/// The damping of a contact, and at the places of the stencil with their laws.
#[derive(Debug)]
struct VariedDamping {
    base: ContactDamping,
    places: [(ContactDamping, Arc<dyn ContactLaw>); 4],
}

/// Derivatives of one interface in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct LawDerivatives {
    /// Of the pressure increment, at fixed closure increment.
    pub(super) pressure: f64,
    /// Of the stiffness, at fixed pressure.
    pub(super) stiffness: f64,
    /// Of the viscous impulse since rest, at fixed closure increment.
    pub(super) impulse: f64,
}

impl LawDerivative {
    /// The derivative of `base` from the laws at four `places`; none when rest has no stiffness but a
    /// pressure that varies.
    pub(super) fn new(
        base: &PreloadedContact,
        places: [&PreloadedContact; 4],
        step: f64,
        pressure_derivative: f64,
    ) -> Option<Self> {
        let same = places.iter().all(|place| Arc::ptr_eq(place.law(), base.law()));
        let varied = (!same).then(|| places.map(|place| Arc::clone(place.law())));
        let stiffness = base.law().stiffness(base.pressure());
        let yielding = if pressure_derivative == 0.0 { 0.0 } else { 1.0 / stiffness };
        let damping = base.damping().map(|damping| {
            let of = |place: &PreloadedContact| place.damping().unwrap_or(damping);
            let places = places.map(|place| (of(place), Arc::clone(place.law())));
            VariedDamping { base: damping, places }
        });
        yielding.is_finite().then(|| Self {
            base: Arc::clone(base.law()),
            varied,
            table: None,
            damping,
            step,
            pressure: base.pressure(),
            pressure_derivative,
            yielding,
        })
    }

    /// Tabulates the derivatives over the pressures \[Pa\] of a run, where their slopes are smooth enough: the law at the
    /// four places is then not evaluated at each step.
    pub(super) fn tabulate(&mut self, [low, high]: [f64; 2]) {
        let Some(laws) = &self.varied else { return };
        // Next to a loss of contact slopes may have no bound.
        let least = NEAR_LOSS * self.pressure;
        let low = if self.base.domain().separates() { low.max(least) } else { low };
        let difference = |of: &dyn Fn(&dyn ContactLaw) -> f64| {
            central_difference(laws.each_ref().map(|law| of(&**law)), self.step)
        };
        let of = |pressure: f64| {
            let increment = pressure - self.pressure;
            let closure = Sloped {
                value: difference(&|law| law.closure_increment(self.pressure, increment)),
                slope: difference(&|law| law.stiffness(pressure).recip()),
            };
            let stiffness = Sloped {
                value: difference(&|law| law.stiffness(pressure)),
                slope: difference(&|law| law.stiffness_slope(pressure)),
            };
            [closure, stiffness]
        };
        self.table = DerivativeTable::new(&of, [low, high]);
    }

    /// Derivatives of the closure from rest, and of the stiffness, where `increment` \[Pa\] is the pressure increment.
    fn of_varied(&mut self, increment: f64) -> Option<[f64; 2]> {
        let laws = self.varied.as_ref()?;
        let pressure = self.pressure + increment;
        let tabulated = self.table.as_mut().and_then(|table| table.at(pressure));
        Some(tabulated.unwrap_or_else(|| {
            let closures =
                laws.each_ref().map(|law| law.closure_increment(self.pressure, increment));
            [central_difference(closures, self.step), self.stiffness(pressure)]
        }))
    }

    /// True if the contact is damped.
    pub(super) fn is_damped(&self) -> bool {
        self.damping.is_some()
    }

    /// The derivatives where `increment` \[Pa\] is the pressure increment, `tangent` \[Pa/m\] its tangent; faces
    /// that are `open` keep a pressure of zero.
    pub(super) fn at(&mut self, increment: f64, tangent: f64, open: bool) -> LawDerivatives {
        let mut derivatives = LawDerivatives::default();
        if open {
            derivatives.pressure = -self.pressure_derivative;
            derivatives.impulse = self.impulse(increment, tangent, derivatives.pressure);
            return derivatives;
        }
        if let Some([closure, stiffness]) = self.of_varied(increment) {
            derivatives.pressure -= tangent * closure;
            derivatives.stiffness += stiffness;
        }
        if self.pressure_derivative != 0.0 {
            derivatives.pressure += self.pressure_derivative * (tangent * self.yielding - 1.0);
        }
        derivatives.impulse = self.impulse(increment, tangent, derivatives.pressure);
        derivatives
    }

    /// Derivative of the viscous impulse `integral of c / K dp` from rest at fixed closure, where the
    /// pressure increment has the derivative `pressure`: the derivative of the integral between fixed
    /// pressures, and `c / K` times the derivatives of both pressures.
    fn impulse(&self, increment: f64, tangent: f64, pressure: f64) -> f64 {
        let Some(VariedDamping { base: damping, places }) = &self.damping else { return 0.0 };
        let (from, to) = (self.pressure, self.pressure + increment);
        let impulses = places.each_ref().map(|(damping, law)| damping.impulse(&**law, from, to));
        let ratio = |pressure: f64, stiffness: f64| {
            let coefficient = damping.coefficient(pressure, stiffness);
            if stiffness > 0.0 { coefficient / stiffness } else { 0.0 }
        };
        let moved = self.pressure_derivative;
        central_difference(impulses, self.step) + ratio(to, tangent) * (pressure + moved)
            - if moved == 0.0 { 0.0 } else { ratio(from, self.base.stiffness(from)) * moved }
    }

    /// Derivative of the stiffness at a fixed `pressure` \[Pa\].
    pub(super) fn stiffness(&self, pressure: f64) -> f64 {
        let Some(laws) = &self.varied else { return 0.0 };
        central_difference(laws.each_ref().map(|law| law.stiffness(pressure)), self.step)
    }

    /// Share of the stiffness's derivative that a `pressure` \[Pa\] varying by `derivative` contributes.
    pub(super) fn slope(&self, pressure: f64, derivative: f64) -> f64 {
        if derivative == 0.0 { 0.0 } else { self.base.stiffness_slope(pressure) * derivative }
    }
}
