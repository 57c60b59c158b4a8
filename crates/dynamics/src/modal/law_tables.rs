//! Tables of laws, shared by all models whose contacts have the same law at the same static pressure.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use asperity_law::{CompiledLaw, ContactLaw, LawError};
use asperity_structure::PreloadedContact;

use crate::DynamicsError;

/// Largest error of a tabulated pressure at the longest equal steps that are chosen for a case, as a
/// share of the static pressure: a hundredth of the error of the step. With half the step it is a
/// sixteenth, by twice the cells: the difference of two responses of different steps shows what they
/// make of the error of tables.
const AT_LONGEST_STEPS: f64 = 1e-5;

/// The same at steps of a case's own, over the error of a traction within a step.
const OVER_STEP_ERROR: f64 = 40.0;

/// Smallest and largest error that a table is asked for.
const TOLERANCES: [f64; 2] = [1e-9, 1e-3];

/// Factor on the error that is tried next for a law that cannot be tabulated so well, up to the limit.
const COARSER: f64 = 10.0;

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
    /// Static pressure and top of the table \[Pa\], and its tolerance, in bits.
    numbers: [u64; 3],
    least_cells: usize,
    table: Arc<CompiledLaw>,
}

impl KnownTable {
    fn is_of(&self, law: &Arc<dyn ContactLaw>, numbers: [u64; 3], least_cells: usize) -> bool {
        std::ptr::addr_eq(self.law.as_ptr(), Arc::as_ptr(law))
            && (self.numbers, self.least_cells) == (numbers, least_cells)
    }
}

/// Pressure \[Pa\] at which the table of a contact ends, `2^exponent` \[Pa\] above rest.
pub(super) fn top(contact: &PreloadedContact, exponent: i32) -> f64 {
    contact.pressure() + f64::from(exponent).exp2()
}

/// The error of tables, as a share of the static pressure, at equal steps of which the longest that is
/// chosen for the case takes so many; like steps share tables.
pub(super) fn tolerance_at_equal_steps(parts: f64) -> f64 {
    (AT_LONGEST_STEPS * (1.0_f64 / 16.0).powf((parts.log2() + 1e-6).floor().max(0.0)))
        .max(TOLERANCES[0])
}

/// The same at steps of a case's own of this error.
pub(super) fn tolerance_at_own_steps(step_error: f64) -> f64 {
    let [least, most] = TOLERANCES;
    (OVER_STEP_ERROR * step_error).clamp(least, most)
}

/// The table of a contact's law up to `2^exponent` \[Pa\] above rest, whose error is this share of the
/// static pressure, or more for a law that is too steep.
///
/// # Errors
/// [`DynamicsError::Law`] when the law cannot be tabulated that far.
pub(super) fn table(
    contact: &PreloadedContact,
    exponent: i32,
    tolerance: f64,
) -> Result<Arc<CompiledLaw>, DynamicsError> {
    let (law, ends) = (contact.law(), [contact.pressure(), top(contact, exponent)]);
    let numbers = [ends[0], ends[1], tolerance].map(f64::to_bits);
    let least_cells = if contact.damping().is_some() { DAMPED_CELLS } else { 0 };
    let lock = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lock().iter().find(|one| one.is_of(law, numbers, least_cells)) {
        return Ok(Arc::clone(&known.table));
    }
    let table = compile(law, ends, tolerance, least_cells)
        .map_err(|source| DynamicsError::Law { interface: contact.name().to_owned(), source })?;
    let table = Arc::new(table);
    let mut known = lock();
    known.retain(|one| one.law.strong_count() > 0);
    if known.len() >= MOST_TABLES {
        known.clear();
    }
    let (law, kept) = (Arc::downgrade(law), Arc::clone(&table));
    known.push(KnownTable { law, numbers, least_cells, table: kept });
    Ok(table)
}

/// A table of `law`; coarser than asked for where the law is too steep.
fn compile(
    law: &Arc<dyn ContactLaw>,
    [pressure, top]: [f64; 2],
    mut tolerance: f64,
    least_cells: usize,
) -> Result<CompiledLaw, LawError> {
    loop {
        match CompiledLaw::uniform_of(law, (pressure, top), tolerance, least_cells) {
            Err(LawError::Unresolved { .. }) if tolerance < TOLERANCES[1] => {
                tolerance = (COARSER * tolerance).min(TOLERANCES[1]);
            }
            found => return found,
        }
    }
}
