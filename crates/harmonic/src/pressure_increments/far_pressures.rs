//! The pressure far from that at rest.

use std::sync::OnceLock;

use asperity_law::{CompiledLaw, Pressure};
use asperity_structure::PreloadedContact;

/// Pressures over that at rest in whose neighbourhood the tables are, and how far up each reaches over its own. Downwards
/// the table of a law that never separates reaches to a 64th: they meet, and the first ones meet the table about rest.
const LOWER: [(f64, f64); 2] = [(1.0 / 4096.0, 66.0), (1.0 / 16_777_216.0, 66.0)];
const HIGHER: [(f64, f64); 2] = [(100.0, 8.0), (5000.0, 8.0)];

/// Pressure over that at rest below which it falls exponentially with the closure: less than any tolerance of a table.
const TAIL: f64 = 1e-9;

/// Tables beyond that of a contact about rest, each made when a motion first comes there: up to 40,000 times the pressure at
/// rest, and where the law never separates down to 1e-9 of it, and an exponential function below.
///
/// A light body over a heavy one has pressures of any size above its own, and a contact that opens on such a law
/// has all pressures down to none. Laws that find a gap by iteration take a hundred times as long as a table.
#[derive(Debug, Clone)]
pub(super) struct FarPressures {
    tolerance: f64,
    /// Closure from rest \[m\] up to which the table about rest reaches.
    top: f64,
    tail: Option<Tail>,
    lower: [OnceLock<Option<Part>>; LOWER.len()],
    higher: [OnceLock<Option<Part>>; HIGHER.len()],
}

/// A closure from rest \[m\] with the pressure \[Pa\] and the stiffness \[Pa/m\] there.
#[derive(Debug, Clone)]
struct Tail {
    closure: f64,
    pressure: f64,
    stiffness: f64,
}

/// A table with the closure \[m\] and the pressure \[Pa\] of its state, both from rest.
#[derive(Debug, Clone)]
struct Part {
    table: CompiledLaw,
    closure: f64,
    pressure: f64,
}

impl FarPressures {
    /// Tables to a relative `tolerance`, beyond one that reaches up to `top` times the pressure at rest.
    pub(super) fn new(contact: &PreloadedContact, top: f64, tolerance: f64) -> Self {
        let (law, at_rest) = (contact.law(), contact.pressure());
        let never_separates = !law.domain().separates() && !law.domain().is_bilateral();
        Self {
            tolerance,
            top: law.closure(top * at_rest) - contact.closure(),
            tail: never_separates.then(|| Tail::new(contact, TAIL * at_rest)).flatten(),
            lower: Default::default(),
            higher: Default::default(),
        }
    }

    /// Pressure increment and tangent of the same `contact`; none where these tables do not reach.
    pub(super) fn get(&self, contact: &PreloadedContact, x: f64) -> Option<Pressure> {
        let (parts, states) = if x >= self.top {
            (&self.higher, &HIGHER)
        } else {
            let tail = self.tail.as_ref().filter(|_| x < 0.0)?;
            if x <= tail.closure {
                return Some(tail.increment(contact.pressure(), x));
            }
            (&self.lower, &LOWER)
        };
        let tolerance = self.tolerance;
        parts.iter().zip(states).find_map(|(part, state)| {
            let part = part.get_or_init(|| Part::new(contact, tolerance, *state)).as_ref()?;
            let (value, tangent) = part.table.get_with_tangent(x - part.closure);
            (!value.is_nan()).then_some(Pressure { value: part.pressure + value, tangent })
        })
    }
}

impl Tail {
    /// The tail of a law from this pressure \[Pa\] on; none if that has no closure.
    fn new(contact: &PreloadedContact, pressure: f64) -> Option<Self> {
        let law = contact.law();
        let closure = law.closure(pressure) - contact.closure();
        let stiffness = law.stiffness(pressure);
        let exists = closure.is_finite() && stiffness.is_finite() && stiffness > 0.0;
        exists.then_some(Self { closure, pressure, stiffness })
    }

    /// The increment from `at_rest` \[Pa\]. However far the faces are apart, they carry something: the law never separates.
    fn increment(&self, at_rest: f64, x: f64) -> Pressure {
        let Self { closure, pressure, stiffness } = self;
        let part = ((x - closure) * stiffness / pressure).exp();
        let tangent = (part * stiffness).max(f64::MIN_POSITIVE);
        Pressure { value: part * pressure - at_rest, tangent }
    }
}

impl Part {
    fn new(contact: &PreloadedContact, tolerance: f64, (over, top): (f64, f64)) -> Option<Self> {
        let (law, at_rest) = (contact.law(), contact.pressure());
        let state = over * at_rest;
        let table = CompiledLaw::new(&**law, state, top * state, tolerance).ok()?;
        let closure = law.closure(state) - contact.closure();
        closure.is_finite().then_some(Self { table, closure, pressure: state - at_rest })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity_law::{Exponential, Power};

    use super::*;

    /// Tangents of an exponential law are pressures over its length down to 1e-9 of the pressure at rest and up to 40,000 times
    /// it, and the tables go over into each other.
    #[test]
    fn tables_are_exact_from_a_billionth_to_ten_thousands_of_the_pressure_at_rest() {
        let (length, at_rest) = (1e-7, 2e5);
        let law = Arc::new(Exponential::new(length, at_rest).unwrap());
        let contact = PreloadedContact::new("contact", 1e-4, law, at_rest).unwrap();
        let far = FarPressures::new(&contact, 12.0, 1e-8);
        let lower = (0..1600).map(|n| 64_f64.recip() * 0.99_f64.powi(n));
        let higher = (0..800).map(|n| 12.0 * 1.01_f64.powi(n));
        for part in lower.filter(|part| *part > TAIL).chain(higher) {
            let found = far.get(&contact, length * part.ln()).unwrap();
            let tangent = part * at_rest / length;
            assert!((found.tangent / tangent - 1.0).abs() < 1e-4, "{part:.2e}: {found:?}");
            let value = (part - 1.0) * at_rest;
            let off = (found.value - value).abs();
            assert!(off < 2e-8 * value.abs().max(at_rest), "{part:.2e}: {found:?}");
        }
        assert_eq!(far.get(&contact, length * 4.1e4_f64.ln()), None);
        let tail = far.get(&contact, length * 1e-20_f64.ln()).unwrap();
        assert!((tail.tangent / (1e-20 * at_rest / length) - 1.0).abs() < 1e-9, "{tail:?}");
        let apart = far.get(&contact, -1.0).unwrap();
        assert!(apart.value == -at_rest && apart.tangent > 0.0, "{apart:?}");
    }

    /// A power law has an end below, and none of these tables there.
    #[test]
    fn a_law_that_separates_has_higher_tables_only() {
        let law = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
        let contact = PreloadedContact::new("contact", 1e-4, law, 2e5).unwrap();
        let far = FarPressures::new(&contact, 12.0, 1e-8);
        assert_eq!(far.get(&contact, -contact.closure()), None);
        for part in [12.0, 300.0, 3e4] {
            let x = contact.law().closure(part * 2e5) - contact.closure();
            let found = far.get(&contact, x).unwrap();
            let exact = contact.pressure_increment(x);
            assert!((found.value / exact.value - 1.0).abs() < 1e-7, "{found:?} {exact:?}");
            assert!((found.tangent / exact.tangent - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
        }
    }
}
