//! Contact laws as pressure-overclosure tables in the input language of finite-element codes.

mod text;

use asperity_law::{BeyondTable, OverclosureTable, TableAccuracy};
use asperity_scenario::LawRef;

use crate::error::SimulationError;
use crate::laws::{ScenarioLaws, usual_top};

pub use text::deck;

/// A finite-element code whose input lists pressure-overclosure tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeckFormat {
    /// `CalculiX`: at most 200 rows; beyond the last one the pressure is held.
    CalculiX,
    /// Abaqus: beyond the last row the last slope continues.
    Abaqus,
}

impl DeckFormat {
    /// Name of the code.
    pub fn name(self) -> &'static str {
        match self {
            Self::CalculiX => "CalculiX",
            Self::Abaqus => "Abaqus",
        }
    }

    /// Most rows of a table.
    pub fn max_rows(self) -> usize {
        match self {
            Self::CalculiX => 200,
            Self::Abaqus => 10_000,
        }
    }

    /// Pressure beyond the last row.
    pub fn beyond(self) -> BeyondTable {
        match self {
            Self::CalculiX => BeyondTable::PressureHeld,
            Self::Abaqus => BeyondTable::SlopeHeld,
        }
    }
}

/// Units of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeckUnits {
    /// m, kg, s, N, Pa.
    Si,
    /// mm, t, s, N, MPa.
    MmTonneSecond,
}

impl DeckUnits {
    /// The units in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Si => "m, kg, s, N, Pa",
            Self::MmTonneSecond => "mm, t, s, N, MPa",
        }
    }

    /// Pressure in the unit of the deck per Pa, and length per m.
    fn factors(self) -> (f64, f64) {
        match self {
            Self::Si => (1.0, 1.0),
            Self::MmTonneSecond => (1e-6, 1e3),
        }
    }
}

/// The table of one contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTable {
    /// Interface of the scenario; `None` for a law that no interface uses.
    pub interface: Option<String>,
    /// Name of the law, or "in place".
    pub law: String,
    /// Name of the surface interaction in the deck: capitals, digits, hyphens and underscores,
    /// beginning with a letter.
    pub surface_interaction: String,
    /// Static pressure \[Pa\] and the stiffness of the law there \[Pa/m\], which the table has too.
    pub at_rest: Option<(f64, f64)>,
    /// The table.
    pub table: OverclosureTable,
    /// Its errors.
    pub accuracy: TableAccuracy,
    /// True if the law carries tension, which a table does not.
    pub carries_tension: bool,
}

/// The tables of all contacts of a scenario, and of the laws that no interface uses.
///
/// Each contact has a table of its own, of at most `rows` rows, exact at its static pressure. The
/// tables end at the pressure `top` \[Pa\]; without one, at 1 MPa, or at twice the static pressure or
/// the last point of the law if that is higher.
///
/// # Errors
/// [`SimulationError`] when a law cannot be built, or a static pressure is not below `top`.
pub fn contact_tables(
    scenario: &ScenarioLaws,
    rows: usize,
    top: Option<f64>,
) -> Result<Vec<ContactTable>, SimulationError> {
    let contacts = scenario.contacts.iter().map(|contact| {
        (Some(contact.interface.as_str()), contact.law.clone(), contact.static_pressure_pa)
    });
    let is_used = |name: &str| {
        let used = |law: &LawRef| matches!(law, LawRef::Named(used) if used == name);
        scenario.contacts.iter().any(|contact| used(&contact.law))
    };
    let first = scenario.contacts.first().map_or(0.0, |contact| contact.static_pressure_pa);
    let unused = scenario.laws.names().filter(|name| !is_used(name));
    let unused = unused.map(|name| (None, LawRef::Named(name.to_owned()), first));
    let mut tables: Vec<ContactTable> = Vec::new();
    for (interface, reference, pressure) in contacts.chain(unused) {
        let failed = |source| SimulationError::Law {
            law: reference.name().to_owned(),
            interface: interface.map(str::to_owned),
            pressure_pa: pressure,
            source,
        };
        let law = scenario.laws.build(&reference, pressure).map_err(failed)?;
        let rest = (interface.is_some() && pressure > 0.0).then_some(pressure);
        let top = top.unwrap_or_else(|| usual_top(&scenario.laws, &reference, pressure));
        let table = OverclosureTable::new(&law, rest, top, rows).map_err(failed)?;
        let name = reference.name();
        tables.push(ContactTable {
            interface: interface.map(str::to_owned),
            law: name.to_owned(),
            surface_interaction: deck_name(interface.unwrap_or(name), &tables),
            at_rest: rest.map(|pressure| (pressure, law.stiffness(pressure))),
            accuracy: table.accuracy(&law),
            table,
            carries_tension: law.domain().is_bilateral(),
        });
    }
    Ok(tables)
}

/// Longest name of a surface interaction, without its number.
const MAX_NAME: usize = 60;

/// `name` as the name of a surface interaction that no other table has.
fn deck_name(name: &str, taken: &[ContactTable]) -> String {
    let plain = |c: char| {
        let c = c.to_ascii_uppercase();
        if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }
    };
    let mut plain: String = name.chars().take(MAX_NAME).map(plain).collect();
    if !plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
        plain.insert_str(0, "C_");
    }
    let is_free = |name: &String| taken.iter().all(|table| table.surface_interaction != *name);
    let numbered = (2..=taken.len() + 1).map(|number| format!("{plain}_{number}"));
    std::iter::once(plain.clone()).chain(numbered).find(is_free).unwrap_or(plain)
}
