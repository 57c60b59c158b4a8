//! The text of a deck's surface interactions.

use std::fmt::Write;

use super::{ContactTable, DeckFormat, DeckUnits};

/// Facts about `CalculiX` that a user of the tables needs.
const CALCULIX: &str = "\
** CalculiX holds the last pressure beyond the table, without any tangent.
** Contact pairs: TYPE=NODE TO SURFACE. In ccx 2.20 a table with TYPE=SURFACE TO
** SURFACE is read beyond the bounds of an array (springforc_f2f.f).
** Each step needs *CONTROLS,PARAMETERS=FIELD with the line 1.E-6,1.E-6: by default
** closures are wrong by 2e-4 and tangents by up to 4 per cent.
** A *FREQUENCY step after the preload needs *STEP,PERTURBATION, else contacts are open.
";

/// Facts about Abaqus that a user of the tables needs.
const ABAQUS: &str = "\
** Abaqus continues the last slope beyond the table.
** A *FREQUENCY step uses the tangents at the end of the step before, the preload.
";

/// The surface interactions of `tables`, to be included in the model part of a deck.
///
/// Comments state units, range, rows and errors of each table and what the code does with it.
pub fn deck(
    title: Option<&str>,
    tables: &[ContactTable],
    format: DeckFormat,
    units: DeckUnits,
) -> String {
    let (pressures, lengths) = units.factors();
    let mut text = format!("** {} pressure-overclosure tables by asperity\n", format.name());
    // Writing to a string cannot fail.
    if let Some(title) = title {
        let _ = writeln!(text, "** scenario: {}", one_line(title));
    }
    let _ = writeln!(text, "** units: {}; rows: pressure, overclosure", units.name());
    text.push_str(match format {
        DeckFormat::CalculiX => CALCULIX,
        DeckFormat::Abaqus => ABAQUS,
    });
    for contact in tables {
        let rows = contact.table.rows();
        let accuracy = &contact.accuracy;
        let top = rows.last().map_or(0.0, |row| row.pressure);
        let name = &contact.surface_interaction;
        let _ = writeln!(text, "**");
        if let Some(interface) = &contact.interface {
            let _ = writeln!(text, "** interface {}", one_line(interface));
        }
        let _ = writeln!(text, "** law {}", one_line(&contact.law));
        let _ = writeln!(text, "** {} rows from 0 to {top:.6e} Pa", rows.len());
        if let Some((pressure, stiffness)) = contact.at_rest {
            let _ = writeln!(text, "** exact at rest: {pressure:.6e} Pa, {stiffness:.6e} Pa/m");
        }
        let _ = writeln!(
            text,
            "** above {:.3e} Pa: tangent error up to {:.1e}, overclosure error {:.1e}",
            accuracy.pressure_min, accuracy.tangent_error, accuracy.closure_error
        );
        if contact.table.first_closure() != 0.0 {
            let first = contact.table.first_closure();
            let _ = writeln!(text, "** overclosure 0 is closure {first:.6e} m of the law");
        }
        if contact.carries_tension {
            let _ = writeln!(text, "** the law carries tension; this table does not");
        }
        if format == DeckFormat::CalculiX {
            let _ = writeln!(text, "** *CONTACT PAIR,INTERACTION={name},TYPE=NODE TO SURFACE");
        }
        let _ = writeln!(text, "*SURFACE INTERACTION,NAME={name}");
        let _ = writeln!(text, "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR");
        for row in rows {
            let (pressure, overclosure) = (pressures * row.pressure, lengths * row.overclosure);
            let _ = writeln!(text, "{pressure:.12E},{overclosure:.12E}");
        }
    }
    text
}

/// Longest text of a scenario in a comment; longer lines may be too long for a code.
const MAX_CHARACTERS: usize = 60;

/// `text` on one line of ASCII characters.
fn one_line(text: &str) -> String {
    let plain = |c: char| if c.is_ascii() && !c.is_ascii_control() { c } else { '?' };
    text.chars().take(MAX_CHARACTERS).map(plain).collect()
}
