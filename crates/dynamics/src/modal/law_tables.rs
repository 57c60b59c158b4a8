//! Tables of laws, shared by all models whose contacts have the same law at the same static pressure.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use asperity_law::{CompiledLaw, ContactLaw, LawError};
use asperity_structure::PreloadedContact;

use crate::DynamicsError;

/// Largest error of a tabulated pressure, as a share of the static pressure: a hundredth of
/// the error of the step at its default length.
pub(super) const TABLE_TOLERANCE: f64 = 1e-5;

/// Factors on that error, tried in turn for laws that stiffen without bound.
const TOLERANCES: [f64; 3] = [1.0, 10.0, 100.0];

/// Fewest cells of the table of a damped contact: its coefficient may bend where the law is straight.
const DAMPED_CELLS: usize = 1024;

/// Tables kept at a time.
const MOST_TABLES: usize = 128;

/// The tables of laws that are in use.
static KNOWN: Mutex<Vec<KnownTable>> = Mutex::new(Vec::new());

/// A table, and what it depends on.
#[derive(Debug)]
struct KnownTable {
    /// Keeps the address of the law from being used again.
    law: Weak<dyn ContactLaw>,
    /// Static pressure and top of the table \[Pa\], in bits.
    pressures: [u64; 2],
    least_cells: usize,
    table: Arc<CompiledLaw>,
}

impl KnownTable {
    fn is_of(&self, law: &Arc<dyn ContactLaw>, pressures: [u64; 2], least_cells: usize) -> bool {
        std::ptr::addr_eq(self.law.as_ptr(), Arc::as_ptr(law))
            && (self.pressures, self.least_cells) == (pressures, least_cells)
    }
}

/// Pressure \[Pa\] at which the table of a contact ends, `2^exponent` \[Pa\] above rest.
pub(super) fn top(contact: &PreloadedContact, exponent: i32) -> f64 {
    contact.pressure() + f64::from(exponent).exp2()
}

/// The table of a contact's law up to `2^exponent` \[Pa\] above rest.
///
/// # Errors
/// [`DynamicsError::Law`] when the law cannot be tabulated that far.
pub(super) fn table(
    contact: &PreloadedContact,
    exponent: i32,
) -> Result<Arc<CompiledLaw>, DynamicsError> {
    let (law, ends) = (contact.law(), [contact.pressure(), top(contact, exponent)]);
    let pressures = ends.map(f64::to_bits);
    let least_cells = if contact.damping().is_some() { DAMPED_CELLS } else { 0 };
    let lock = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lock().iter().find(|one| one.is_of(law, pressures, least_cells)) {
        return Ok(Arc::clone(&known.table));
    }
    let table = compile(law, ends, least_cells)
        .map_err(|source| DynamicsError::Law { interface: contact.name().to_owned(), source })?;
    let table = Arc::new(table);
    let mut known = lock();
    known.retain(|one| one.law.strong_count() > 0);
    if known.len() >= MOST_TABLES {
        known.clear();
    }
    let (law, kept) = (Arc::downgrade(law), Arc::clone(&table));
    known.push(KnownTable { law, pressures, least_cells, table: kept });
    Ok(table)
}

/// A table of `law`; coarser than usual for a law that is too steep.
fn compile(
    law: &Arc<dyn ContactLaw>,
    [pressure, top]: [f64; 2],
    least_cells: usize,
) -> Result<CompiledLaw, LawError> {
    let compile = |times: f64| {
        CompiledLaw::uniform_of(law, (pressure, top), times * TABLE_TOLERANCE, least_cells)
    };
    TOLERANCES[1..].iter().fold(compile(TOLERANCES[0]), |table, times| match table {
        Err(LawError::Unresolved { .. }) => compile(*times),
        found => found,
    })
}
