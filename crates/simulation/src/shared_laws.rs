//! Laws of scenarios, built once for all scenarios in use that have the same.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use asperity_law::{ContactLaw, LawError};
use asperity_scenario::{LawRef, Laws};

/// Laws kept at a time.
const MOST_LAWS: usize = 64;

/// The laws that are in use.
static KNOWN: Mutex<Vec<KnownLaw>> = Mutex::new(Vec::new());

/// A built law, and what it was built from.
#[derive(Debug)]
struct KnownLaw {
    laws: Laws,
    reference: LawRef,
    /// Static pressure \[Pa\], in bits.
    pressure: u64,
    built: Weak<dyn ContactLaw>,
}

/// The law that `reference` stands for among `laws`, as [`Laws::build`] builds it. Scenarios that
/// differ in other numbers only share the law, and its tables.
///
/// # Errors
/// As [`Laws::build`].
pub(crate) fn shared_law(
    laws: &Laws,
    reference: &LawRef,
    static_pressure: f64,
) -> Result<Arc<dyn ContactLaw>, LawError> {
    let pressure = static_pressure.to_bits();
    let lock = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let is_same = |one: &&KnownLaw| {
        one.pressure == pressure && one.reference == *reference && one.laws == *laws
    };
    if let Some(law) = lock().iter().find(is_same).and_then(|one| one.built.upgrade()) {
        return Ok(law);
    }
    let law = laws.build(reference, static_pressure)?;
    let mut known = lock();
    known.retain(|one| one.built.strong_count() > 0);
    if known.len() >= MOST_LAWS {
        known.clear();
    }
    let (laws, reference, built) = (laws.clone(), reference.clone(), Arc::downgrade(&law));
    known.push(KnownLaw { laws, reference, pressure, built });
    Ok(law)
}
