//! Forces and viscous impulses of many contacts, most of which share a law.

use std::collections::HashMap;
use std::sync::Arc;

use asperity_law::{CompiledLaw, ContactDamping, ContactLaw};
use asperity_structure::PreloadedContact;

/// Largest static pressures that a table reaches up to; beyond it the law itself is evaluated.
const TOP: f64 = 8.0;

/// Error of a table over a thousandth of its top.
const TOLERANCE: f64 = 1e-6;

/// Cells of a table of impulses.
const IMPULSE_CELLS: usize = 1024;

/// The laws of contacts: one table for all that follow the same separating law.
#[derive(Debug, Clone)]
pub(super) struct ContactForces {
    contacts: Vec<OneContact>,
    tables: Vec<Option<Arc<CompiledLaw>>>,
    /// Impulses of each law with its damping.
    impulses: Vec<Impulse>,
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
    /// Number of its impulse, if it is damped.
    impulse: Option<usize>,
}

/// The viscous impulse `integral of c dd` of a law with its damping.
#[derive(Debug, Clone)]
enum Impulse {
    /// A time \[s\] over the pressure.
    Proportional(f64),
    /// Of a damping with its own power of pressure, from zero pressure.
    Table(Arc<ImpulseTable>),
    /// The same of a law that never separates, from the state at rest.
    Exact(ContactDamping),
}

/// Impulses \[Pa s\] from zero pressure, as cubics over the fourth root of the pressure.
#[derive(Debug)]
struct ImpulseTable {
    damping: ContactDamping,
    law: Arc<dyn ContactLaw>,
    /// Fourth root of the highest pressure.
    top: f64,
    /// Values at the ends of cells, and slopes per cell.
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl ImpulseTable {
    fn new(damping: ContactDamping, law: &Arc<dyn ContactLaw>, highest: f64) -> Self {
        let top = highest.sqrt().sqrt();
        let width = top / IMPULSE_CELLS as f64;
        let pressure = |cell: usize| (cell as f64 * width).powi(4);
        let rises: Vec<f64> = (0..IMPULSE_CELLS)
            .map(|cell| damping.impulse(&**law, pressure(cell), pressure(cell + 1)))
            .collect();
        let mut values = vec![0.0];
        for rise in &rises {
            values.push(values[values.len() - 1] + rise);
        }
        let slope = |cell: usize| {
            let (root, at) = (cell as f64 * width, pressure(cell));
            let stiffness = law.stiffness(at);
            let slope = damping.coefficient(at, stiffness) / stiffness * 4.0 * root.powi(3) * width;
            // At zero pressure the quotient may be none.
            if slope.is_finite() { slope } else { rises[cell.min(IMPULSE_CELLS - 1)] }
        };
        let slopes = (0..=IMPULSE_CELLS).map(slope).collect();
        Self { damping, law: Arc::clone(law), top, values, slopes }
    }

    /// Impulse \[Pa s\] from zero pressure to `pressure` \[Pa\].
    fn get(&self, pressure: f64) -> f64 {
        let place = pressure.max(0.0).sqrt().sqrt() / self.top * IMPULSE_CELLS as f64;
        if place >= IMPULSE_CELLS as f64 {
            let highest = self.top.powi(4);
            return self.values[IMPULSE_CELLS]
                + self.damping.impulse(&*self.law, highest, pressure.max(highest));
        }
        let cell = place as usize;
        let t = place - cell as f64;
        let [low, high] = [self.values[cell], self.values[cell + 1]];
        let [start, end] = [self.slopes[cell], self.slopes[cell + 1]];
        let rise = high - low;
        low + t * (start + t * (3.0 * rise - 2.0 * start - end + t * (start + end - 2.0 * rise)))
    }
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
        let mut impulses: Vec<Impulse> = Vec::new();
        let mut known: Vec<(usize, ContactDamping)> = Vec::new();
        let mut impulse_of = |law: usize, damping: ContactDamping| {
            known.iter().position(|one| *one == (law, damping)).unwrap_or_else(|| {
                known.push((law, damping));
                impulses.push(if damping.is_proportional_to_stiffness() {
                    Impulse::Proportional(damping.coefficient(0.0, 1.0))
                } else if laws[law].domain().separates() {
                    let highest = Some(top(law)).filter(|top| *top > 0.0).unwrap_or(TOP_UNLOADED);
                    Impulse::Table(Arc::new(ImpulseTable::new(damping, &laws[law], highest)))
                } else {
                    Impulse::Exact(damping)
                });
                known.len() - 1
            })
        };
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
                impulse: contact.damping().map(|damping| impulse_of(law, damping)),
            }
        };
        let contacts = contacts.iter().zip(&numbers).map(one).collect();
        Self { contacts, tables, impulses }
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

    /// Size of the numbers whose difference is the viscous impulse of contact `i` \[N s\].
    pub(super) fn impulse_size(&self, i: usize, contact: &PreloadedContact) -> f64 {
        let (area, pressure) = (contact.area(), contact.pressure().abs());
        match self.contacts[i].impulse.map(|number| &self.impulses[number]) {
            Some(Impulse::Proportional(time)) => area * time * pressure,
            Some(Impulse::Table(table)) => area * table.get(pressure),
            Some(Impulse::Exact(_)) | None => 0.0,
        }
    }

    /// True for a contact with damping.
    pub(super) fn is_damped(&self, contact: usize) -> bool {
        self.contacts[contact].impulse.is_some()
    }

    /// Viscous impulse \[N s\] of contact `i` from a state of its own, and coefficient \[N s/m\], where its force increment
    /// is `force` \[N\] and its stiffness `stiffness` \[N/m\]; zeros without damping.
    pub(super) fn impulse(
        &self,
        (i, contact): (usize, &PreloadedContact),
        force: f64,
        stiffness: f64,
    ) -> (f64, f64) {
        let Some(number) = self.contacts[i].impulse else { return (0.0, 0.0) };
        match &self.impulses[number] {
            Impulse::Proportional(time) => (time * force, time * stiffness),
            Impulse::Table(table) => {
                let area = contact.area();
                let pressure = contact.pressure() + force / area;
                let coefficient = table.damping.coefficient(pressure, stiffness / area);
                (area * table.get(pressure), area * coefficient)
            }
            Impulse::Exact(damping) => {
                let (area, state) = (contact.area(), contact.pressure());
                let pressure = state + force / area;
                let impulse = damping.impulse(&**contact.law(), state, pressure);
                (area * impulse, area * damping.coefficient(pressure, stiffness / area))
            }
        }
    }
}

/// Highest pressure of a table of impulses of contacts that are open at rest \[Pa\].
const TOP_UNLOADED: f64 = 1e6;

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
