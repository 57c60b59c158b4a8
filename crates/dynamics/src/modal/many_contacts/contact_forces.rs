//! Forces of many contacts, most of which share a law.

use std::collections::HashMap;
use std::sync::Arc;

use asperity_law::{CompiledLaw, ContactLaw};
use asperity_structure::PreloadedContact;

/// Largest static pressures that a table reaches up to; beyond it the law itself is evaluated.
const TOP: f64 = 8.0;

/// Error of a table over a thousandth of its top.
const TOLERANCE: f64 = 1e-6;

/// The laws of contacts: one table for all that follow the same separating law.
#[derive(Debug, Clone)]
pub(super) struct ContactForces {
    contacts: Vec<OneContact>,
    tables: Vec<Option<Arc<CompiledLaw>>>,
}

/// A contact in the tables.
#[derive(Debug, Clone, Copy)]
struct OneContact {
    law: usize,
    /// Closure at rest from first contact \[m\], and the table's pressure there \[Pa\].
    at_rest: f64,
    pressure: f64,
    lowest: f64,
    lost_at: Option<f64>,
}

impl ContactForces {
    pub(super) fn new(contacts: &[PreloadedContact]) -> Self {
        let (numbers, laws) = distinct(contacts.iter().map(|contact| Arc::clone(contact.law())));
        let top = |number: usize| {
            let own = contacts.iter().zip(&numbers).filter(|(_, other)| **other == number);
            TOP * own.map(|(contact, _)| contact.pressure()).fold(0.0, f64::max)
        };
        // A law that cannot be tabulated is evaluated itself.
        let mut tables = Vec::with_capacity(laws.len());
        for (number, law) in laws.iter().enumerate() {
            let top = top(number);
            let separates = law.domain().separates() && top > 0.0;
            let table = separates.then(|| CompiledLaw::new(law, 0.0, top, TOLERANCE).ok());
            tables.push(table.flatten().map(Arc::new));
        }
        let one = |(contact, &law): (&PreloadedContact, &usize)| {
            let domain = contact.law().domain();
            let at_rest = domain.closure_lost.map_or(0.0, |lost| contact.closure() - lost);
            let pressure = match &tables[law] {
                Some(table) if at_rest > 0.0 => table.get(at_rest),
                _ => 0.0,
            };
            OneContact {
                law,
                at_rest,
                pressure,
                lowest: domain.pressure_min,
                lost_at: domain.separates().then_some(-at_rest),
            }
        };
        let contacts = contacts.iter().zip(&numbers).map(one).collect();
        Self { contacts, tables }
    }

    /// Lowest pressure of a contact \[Pa\].
    pub(super) fn lowest(&self, contact: usize) -> f64 {
        self.contacts[contact].lowest
    }

    /// Closure from rest at which a contact is lost \[m\].
    pub(super) fn lost_at(&self, contact: usize) -> Option<f64> {
        self.contacts[contact].lost_at
    }

    /// Force increments \[N\] and stiffnesses \[N/m\] at closure increments from rest \[m\].
    pub(super) fn evaluate(
        &self,
        contacts: &[PreloadedContact],
        closures: &[f64],
        forces: &mut [f64],
        stiffness: &mut [f64],
    ) {
        for (i, (one, contact)) in self.contacts.iter().zip(contacts).enumerate() {
            let (area, x) = (contact.area(), closures[i]);
            let tabulated = self.tables[one.law].as_ref().map(|table| {
                let at = one.at_rest + x;
                if at <= 0.0 { (0.0, 0.0) } else { table.get_with_tangent(at) }
            });
            (forces[i], stiffness[i]) = match tabulated {
                Some((pressure, tangent)) if !pressure.is_nan() => {
                    (area * (pressure - one.pressure), area * tangent.max(0.0))
                }
                _ => exact(contact, x, area),
            };
        }
    }
}

/// Force increment and stiffness by the law itself.
fn exact(contact: &PreloadedContact, x: f64, area: f64) -> (f64, f64) {
    let found = contact.pressure_increment(x);
    (area * found.value, area * found.tangent)
}

/// The number of each distinct law among some, and the laws.
fn distinct(
    laws: impl Iterator<Item = Arc<dyn ContactLaw>>,
) -> (Vec<usize>, Vec<Arc<dyn ContactLaw>>) {
    let mut numbers: HashMap<*const (), usize> = HashMap::new();
    let mut kept: Vec<Arc<dyn ContactLaw>> = Vec::new();
    let numbered = laws.map(|law| {
        let next = kept.len();
        let number = *numbers.entry(Arc::as_ptr(&law).cast::<()>()).or_insert(next);
        if number == next {
            kept.push(law);
        }
        number
    });
    let numbered = numbered.collect();
    (numbered, kept)
}
