//! The energy that a contact holds more than at rest.

use asperity_structure::PreloadedContact;

/// Share of the static pressure below which an increment counts as small.
const SMALL: f64 = 1e-2;

/// Energy per area that a contact holds more than at rest, less the work of its static pressure
/// \[J/m2\]: `E(d0 + x) - E(d0) - p0 x = integral from 0 to x of (p(d0 + x') - p0) dx'`.
///
/// Of a small increment the difference would leave round-off only, so the integral is taken, by three
/// Gauss points; its own error is of sixth order in the increment.
pub(crate) fn excess(contact: &PreloadedContact, increment: f64) -> f64 {
    let (law, pressure, closure) = (contact.law(), contact.pressure(), contact.closure());
    let is_large = (contact.stiffness() * increment).abs() > SMALL * pressure.abs();
    if is_large || contact.gap() > 0.0 {
        return law.energy(closure + increment) - law.energy(closure) - pressure * increment;
    }
    let more = |s: f64| law.pressure_increment(pressure, s * increment).value;
    let apart = 0.5 * 0.6_f64.sqrt();
    increment * (5.0 * more(0.5 - apart) + 8.0 * more(0.5) + 5.0 * more(0.5 + apart)) / 18.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use asperity_law::{ContactLaw, Power};

    /// Against the difference where both are good, and the tangent's `K x^2 / 2` where it is not.
    #[test]
    fn small_gains_keep_their_energy() {
        let law = Power::new(1.81e10, 0.35, 0.0).unwrap();
        let (p, k) = (1.4e5, law.stiffness(1.4e5));
        let rest = PreloadedContact::new("contact", 1e-4, Arc::new(law), p).unwrap();
        let x = 0.9 * SMALL * p / k;
        let exact = law.energy(rest.closure() + x) - law.energy(rest.closure()) - p * x;
        // The difference is of 1e-4 of the energies.
        assert!((excess(&rest, x) / exact - 1.0).abs() < 1e-9);
        for x in [1e-8, -1e-8, 1e-20].map(|share| share * p / k) {
            assert!((excess(&rest, x) / (0.5 * k * x * x) - 1.0).abs() < 1e-7);
        }
    }
}
