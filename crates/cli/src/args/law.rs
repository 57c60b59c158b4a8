//! The options of `asperity law`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use asperity_simulation::contact_deck::{DeckFormat, DeckUnits};
use clap::{Args as Group, ValueEnum};

/// Tables of the contacts for a finite-element code.
#[derive(Debug, Group)]
pub(crate) struct DeckExport {
    /// Also write the pressure-overclosure table of each contact, to be included in a deck of this
    /// code.
    #[arg(long, value_name = "FORMAT", requires = "deck_units")]
    pub(crate) export: Option<ExportFormat>,

    /// Units of the deck: si (m, kg, s, N, Pa) or mm-t-s (mm, t, s, N, MPa).
    #[arg(long, value_name = "UNITS", requires = "export", hide_possible_values = true)]
    pub(crate) deck_units: Option<ExportUnits>,

    /// Rows of a table at most. Default: 200, the most that CalculiX takes.
    #[arg(long, value_name = "N", requires = "export")]
    pub(crate) rows: Option<usize>,

    /// Pressure in Pa at which the tables end. Default: that of law-NAME.csv.
    #[arg(long, value_name = "PA", requires = "export")]
    pub(crate) top_pressure: Option<f64>,
}

/// A finite-element code.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ExportFormat {
    Calculix,
    Abaqus,
}

impl ExportFormat {
    /// The format, and its name in file names.
    pub(crate) fn format(self) -> (DeckFormat, &'static str) {
        match self {
            Self::Calculix => (DeckFormat::CalculiX, "calculix"),
            Self::Abaqus => (DeckFormat::Abaqus, "abaqus"),
        }
    }
}

/// Consistent units of a deck.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ExportUnits {
    Si,
    #[value(name = "mm-t-s")]
    MmTonneSecond,
}

impl From<ExportUnits> for DeckUnits {
    fn from(units: ExportUnits) -> Self {
        match units {
            ExportUnits::Si => Self::Si,
            ExportUnits::MmTonneSecond => Self::MmTonneSecond,
        }
    }
}
