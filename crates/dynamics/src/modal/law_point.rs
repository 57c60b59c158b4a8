//! Laws at successive closures.

use asperity_law::Pressure;
use asperity_structure::PreloadedContact;

/// Pressure, over that of before, down to which a law is inverted by a step, and over the pressure at rest, down to which
/// it is the sum of the two: a difference near zero would leave round-off.
const LEAST_KEPT: f64 = 0.01;

/// A point of the law of a contact, from which the point at a near closure is found at the price of few formulas.
#[derive(Debug, Clone, Copy)]
pub(super) struct LawPoint {
    /// Closure increment from rest \[m\].
    closure: f64,
    /// Pressure \[Pa\], with digits of its own near zero.
    pub(super) pressure: f64,
    /// Pressure increment from rest \[Pa\] and stiffness \[Pa/m\].
    pub(super) increment: Pressure,
}

impl LawPoint {
    /// The point at rest.
    pub(super) fn at_rest(contact: &PreloadedContact) -> Self {
        let increment = Pressure { value: 0.0, tangent: contact.stiffness() };
        Self { closure: 0.0, pressure: contact.pressure(), increment }
    }

    /// The point of the law of the same `contact` at a closure increment from rest \[m\].
    pub(super) fn moved(self, contact: &PreloadedContact, closure: f64) -> Self {
        if closure == self.closure {
            return self;
        }
        let law = contact.law();
        let step = law.pressure_step(self.pressure, closure - self.closure);
        let step = step.filter(|step| step.value > (LEAST_KEPT - 1.0) * self.pressure);
        if let Some(step) = step {
            let value = self.increment.value + step.value;
            let increment = Pressure { value, tangent: step.tangent };
            return Self { closure, pressure: self.pressure + step.value, increment };
        }
        let increment = law.pressure_increment(contact.pressure(), closure);
        let mut pressure = contact.pressure() + increment.value;
        if pressure < LEAST_KEPT * contact.pressure() {
            pressure = law.pressure(contact.closure() + closure).value;
        }
        Self { closure, pressure, increment }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_law::{ContactLaw, Exponential, GreenwoodWilliamson, InSeries, Persson, Power};
    use asperity_mesh::{Body, Interface, Stack, Support};
    use asperity_structure::{Damping, PreloadedStructure};
    use std::sync::Arc;

    /// To and fro between a hundred thousandth of the pressure at rest and five times it, in steps short and long.
    #[test]
    fn points_stay_on_their_law() {
        let pressure = 1.4e5;
        let summits = GreenwoodWilliamson::new(1e10, 50e-6, 0.5e-6, 39.8e9, pressure).unwrap();
        let laws: [Arc<dyn ContactLaw>; 5] = [
            Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap()),
            Arc::new(Exponential::new(1e-6, pressure).unwrap()),
            Arc::new(summits),
            Arc::new(Persson::new(1e-6, 0.8, [1e4, 1e7], 39.8e9, pressure).unwrap()),
            Arc::new(InSeries::new(summits, 1e12).unwrap()),
        ];
        for law in laws {
            let area = 1.15e-4;
            let body = Body::with_mass("body", 0.229, pressure * area / 9.81, 71e9, 2710.0);
            let interface = Interface::new("contact", area, Arc::clone(&law)).unwrap();
            let stack = Stack::new(vec![body.unwrap()], vec![interface], Support::Rigid, 9.81);
            let structure = PreloadedStructure::new(stack.unwrap(), Damping::Ratio(0.0)).unwrap();
            let contact = &structure.contacts()[0];
            let from = contact.pressure();
            let (mut at, mut place) = (LawPoint::at_rest(contact), 0.0_f64);
            for n in 0..400_i32 {
                // Logarithms of pressure ratios between -11.5 and 1.6, with jumps.
                place += if n % 37 == 0 { 3.0 } else { 0.11 };
                let log = -4.95 + 6.55 * place.sin();
                let closure = law.closure_increment(from, from * log.exp_m1());
                at = at.moved(contact, closure);
                let exact = law.pressure_increment(from, closure);
                assert!(
                    (at.increment.value - exact.value).abs() < 1e-11 * (from + exact.value.abs()),
                    "{law:?} at {log}: {at:?} {exact:?}"
                );
                let expected = from * log.exp();
                assert!(
                    (at.pressure / expected - 1.0).abs() < 1e-8,
                    "{law:?} at {log}: {at:?} {expected:e}"
                );
                let stiffness = law.stiffness(expected);
                assert!(
                    (at.increment.tangent / stiffness - 1.0).abs() < 1e-7,
                    "{law:?} at {log}: {at:?} {stiffness:e}"
                );
            }
        }
    }
}
