//! Tables of the law of a contact.

use std::cell::OnceCell;

use asperity_law::{CompiledLaw, ContactLaw, CubicCell, LawError, Pressure};

/// Largest error of a tabulated pressure, as a share of the static pressure. A
/// thousandth of the discretisation error at 1 mm cells; ten times finer tables
/// cost more to build than a short run takes.
const TABLE_TOLERANCE: f64 = 1e-6;

/// Top of the table far below the static pressure, over this.
const LOW_TOP: f64 = 1.5;

/// A law about its static pressure, in tables.
///
/// Of a law that never separates the table ends at some pressure; once the contact falls below it there is another one down
/// to a ten-millionth of the static pressure and from there to zero: formulas would take most of the time while bodies fly.
pub(super) struct ContactTable<L> {
    law: L,
    pressure: f64,
    top: f64,
    /// None for a law that no table resolves.
    table: Option<CompiledLaw>,
    /// None within for a law that has no use for it.
    low: OnceCell<Option<CompiledLaw>>,
}

impl<L: ContactLaw> ContactTable<L> {
    /// The tables of a `law` from its static `pressure` up to `top` \[Pa\].
    ///
    /// # Errors
    /// [`LawError`] for pressures outside the domain of the law.
    pub(super) fn new(law: L, pressure: f64, top: f64) -> Result<Self, LawError> {
        let table = match CompiledLaw::new(&law, pressure, top, TABLE_TOLERANCE) {
            Ok(table) => Some(table),
            Err(LawError::Unresolved { .. }) => None,
            Err(error) => return Err(error),
        };
        Ok(Self { law, pressure, top, table, low: OnceCell::new() })
    }

    /// The cell that holds a closure increment \[m\]; none outside the tables.
    pub(super) fn cell(&self, closure: f64) -> Option<CubicCell> {
        self.table_at(closure)?.cell(closure)
    }

    /// Pressure increment \[Pa\] and tangent \[Pa/m\] at a closure increment \[m\], outside the tables of the law itself.
    pub(super) fn get(&self, closure: f64) -> Pressure {
        let found = self.table_at(closure).map(|table| table.get_with_tangent(closure));
        match found {
            Some((value, tangent)) if !value.is_nan() => Pressure { value, tangent },
            _ => self.law.pressure_increment(self.pressure, closure),
        }
    }

    /// The pressure increment \[Pa\] of the law itself; if the pressure is the highest yet, tabulates further.
    pub(super) fn get_beyond(&mut self, closure: f64) -> f64 {
        let increment = self.law.pressure_increment(self.pressure, closure).value;
        let reached = self.pressure + increment;
        if self.table.is_some() && increment.is_finite() && reached > self.top {
            self.top = self.pressure + 2.0 * increment;
            self.table = CompiledLaw::new(&self.law, self.pressure, self.top, TABLE_TOLERANCE).ok();
        }
        increment
    }

    fn table_at(&self, closure: f64) -> Option<&CompiledLaw> {
        let table = self.table.as_ref()?;
        if closure >= table.x_lo() {
            return Some(table);
        }
        let low = self.low.get_or_init(|| {
            let domain = self.law.domain();
            if domain.separates() || domain.is_bilateral() {
                return None;
            }
            let top = LOW_TOP * self.pressure;
            CompiledLaw::uniform(&self.law, self.pressure, top, TABLE_TOLERANCE).ok()
        });
        Some(low.as_ref().unwrap_or(table))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_law::{Exponential, Power};

    #[test]
    fn laws_that_never_separate_are_tabulated_until_no_pressure_is_left() {
        let (law, pressure) = (Exponential::new(1e-6, 1e5).unwrap(), 1e5);
        let table = ContactTable::new(&law, pressure, 2e5).unwrap();
        for closure in [-30e-6, -13e-6, -8e-6, -4.2e-6, -4.1e-6, -1e-6, 0.0, 0.5e-6] {
            let exact = law.pressure_increment(pressure, closure);
            let found = table.get(closure);
            assert!((found.value - exact.value).abs() < 1e-6 * pressure, "{closure}: {found:?}");
            assert!(table.cell(closure).is_some(), "{closure}");
        }
        assert_eq!(table.get(-1.0), Pressure { value: -pressure, tangent: 0.0 });
        // Above the table it is the law.
        assert!(table.cell(1e-6).is_none());
        assert_eq!(table.get(1e-6), law.pressure_increment(pressure, 1e-6));
    }

    #[test]
    fn laws_that_separate_are_open_below_and_tabulated_further_above() {
        let law = Power::new(1e10, 0.4, 0.0).unwrap();
        let mut table = ContactTable::new(&law, 1e5, 2e5).unwrap();
        assert_eq!(table.get(-1.0), Pressure { value: -1e5, tangent: 0.0 });
        let closure = law.closure_increment(1e5, 4e5);
        assert!(table.cell(closure).is_none());
        assert!((table.get_beyond(closure) - 4e5).abs() < 1e-6);
        assert!((table.get(closure).value - 4e5).abs() < 1.0 && table.cell(closure).is_some());
    }
}
