//! The pressure of a contact over its closure, both counted from rest.

mod far_pressures;
mod near_rest;

use asperity_law::{CompiledLaw, Pressure, RelativeTable};
use asperity_structure::PreloadedContact;

use crate::{HarmonicError, LawEvaluation};
use far_pressures::FarPressures;
use near_rest::NearRest;

/// Static pressures that the table reaches up to.
const TABLE_TOP: f64 = 12.0;

/// Pressure increments and tangents of a contact: next to rest by polynomials, elsewhere by tables or the law.
#[derive(Debug, Clone)]
pub(crate) struct PressureIncrements {
    near_rest: Option<NearRest>,
    table: Option<LawTable>,
    /// Beyond the table.
    far: Option<FarPressures>,
}

impl PressureIncrements {
    /// The increments of `contact`.
    pub(crate) fn new(
        contact: &PreloadedContact,
        evaluation: LawEvaluation,
    ) -> Result<Self, HarmonicError> {
        let mut found = Self { near_rest: None, table: table(contact, evaluation)?, far: None };
        let (pressure, stiffness) = (contact.pressure(), contact.stiffness());
        if let (LawEvaluation::Tabulated(tolerance), Some(_)) = (evaluation, &found.table) {
            found.far = Some(FarPressures::new(contact, TABLE_TOP, tolerance));
        }
        if pressure > 0.0 && stiffness > 0.0 {
            let scale = pressure / stiffness;
            found.near_rest = NearRest::new(scale, stiffness, |x| found.at(contact, x));
        }
        Ok(found)
    }

    /// Pressure increment \[Pa\] and tangent \[Pa/m\] of `contact` at a closure increment \[m\] from rest.
    #[inline]
    pub(crate) fn at(&self, contact: &PreloadedContact, x: f64) -> Pressure {
        let Self { near_rest, table, far } = self;
        let found = near_rest.as_ref().and_then(|near| near.get(x));
        let found = found.or_else(|| table.as_ref().and_then(|table| table.get(x)));
        let found = found.or_else(|| far.as_ref().and_then(|far| far.get(contact, x)));
        found.unwrap_or_else(|| contact.pressure_increment(x))
    }
}

/// A contact's law in a table: pressure increments and tangents over closure increments from rest.
#[derive(Debug, Clone)]
enum LawTable {
    /// Of a law that separates, to a relative error: tangents of a table to an absolute one have no digits next to an
    /// opening.
    FromContact {
        table: RelativeTable,
        /// Closure increment of first contact \[m\].
        first: f64,
        /// Pressure at rest \[Pa\], of the table and of the law: the increment at rest is exactly zero.
        at_rest: [f64; 2],
    },
    /// Of another law.
    FromRest(CompiledLaw),
}

impl LawTable {
    /// Pressure increment and tangent; none outside the table.
    #[inline]
    fn get(&self, x: f64) -> Option<Pressure> {
        match self {
            Self::FromContact { table, first, at_rest } => {
                let closure = x - first;
                if closure < 0.0 {
                    return Some(Pressure::lost_from(at_rest[1]));
                }
                let found = table.get(closure)?;
                Some(Pressure { value: found.value - at_rest[0], ..found })
            }
            Self::FromRest(table) => {
                let (value, tangent) = table.get_with_tangent(x);
                (!value.is_nan()).then_some(Pressure { value, tangent })
            }
        }
    }
}

/// The table of a contact's law, if it is to be tabulated and has a static pressure to refer to.
fn table(
    contact: &PreloadedContact,
    evaluation: LawEvaluation,
) -> Result<Option<LawTable>, HarmonicError> {
    let (stiffness, pressure) = (contact.stiffness(), contact.pressure());
    let interface = || contact.name().to_owned();
    if stiffness <= 0.0 && contact.gap() == 0.0 {
        return Err(HarmonicError::NoStiffness {
            interface: interface(),
            pressure_pa: pressure,
            stiffness_pa_per_m: stiffness,
        });
    }
    let LawEvaluation::Tabulated(tolerance) = evaluation else { return Ok(None) };
    crate::error::positive("tolerance of tables of laws", tolerance)?;
    let (law, top) = (contact.law(), TABLE_TOP * pressure);
    if pressure <= 0.0 {
        return Ok(None);
    }
    if let Some(table) = RelativeTable::new(&**law, top) {
        let first = law.closure(0.0) - contact.closure();
        let own = table.get(0.0 - first).map_or(pressure, |found| found.value);
        return Ok(Some(LawTable::FromContact { table, first, at_rest: [own, pressure] }));
    }
    let table = CompiledLaw::new(law, pressure, top, tolerance);
    let named = |source| HarmonicError::Law { interface: interface(), source };
    Ok(Some(LawTable::FromRest(table.map_err(named)?)))
}
