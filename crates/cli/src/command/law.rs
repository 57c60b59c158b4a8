//! `asperity law`.

use std::path::Path;

use asperity_law::{BeyondTable, OverclosureTable};
use asperity_plot as plot;
use asperity_scenario::{Document, Laws};
use asperity_simulation::contact_deck::{
    ContactTable, DeckFormat, DeckUnits, contact_tables, deck,
};
use asperity_simulation::error::SimulationError;
use asperity_simulation::gap_table::{ImportedLaw, import_gaps};
use asperity_simulation::laws::{ScenarioLaws, fit};
use asperity_simulation::output::file_name::distinct_file_names;
use asperity_simulation::patches::assemble_patches;
use asperity_simulation::provenance::{InputFile, Provenance};
use asperity_simulation::record::law_csv;
use serde_json::{Value, json};

use super::ResultFolder;
use crate::args::law::DeckExport;
use crate::args::{Input, Output};
use crate::failure::Failure;

/// Rows of a table of a contact, unless the user asks for others.
const ROWS: usize = 200;

/// Tabulates and draws every law, exports the contacts if asked to, and fits a law to `table` if given.
pub(crate) fn run(
    input: &Input,
    output: &Output,
    export: &DeckExport,
    table: Option<&Path>,
    gaps: Option<&Path>,
) -> Result<(), Failure> {
    let document = super::read(input)?;
    let Source { title, mut laws, mut provenance } = Source::of(&document)?;
    let imported = gaps.map(import_gaps).transpose().map_err(SimulationError::from)?;
    if let (Some(path), Some(law)) = (gaps, &imported) {
        add_law(&mut laws.laws, path, law);
    }
    let exported = Export::new(&laws, export)?;
    let fitted = table.map(fit).transpose().map_err(SimulationError::from)?;
    let tables = laws.tables()?;
    let folder = ResultFolder::claim("law", document.path(), output)?;
    let file_names = distinct_file_names(tables.iter().map(|law| law.name.as_str()));
    for (law, name) in tables.iter().zip(&file_names) {
        folder.write(&format!("law-{name}.csv"), law_csv(law))?;
    }
    if !tables.is_empty() {
        folder.draw("law", &plot::laws(&tables))?;
    }
    if let Some(law) = &imported {
        folder.write("imported-law.json", super::pretty(&json!(law.spec)))?;
    }
    if let Some(export) = &exported {
        let text = deck(title.as_deref(), &export.tables, export.format, export.units);
        folder.write(&export.file, text)?;
    }
    let fit_json = fitted.as_ref().map(|fit| {
        json!({
            "coefficient": fit.coefficient,
            "exponent": fit.exponent,
            "residual_log_rms": fit.residual_log_rms,
            "standard_error_log_coefficient": fit.errors.as_ref().map(|e| e.log_coefficient),
            "standard_error_exponent": fit.errors.as_ref().map(|e| e.exponent),
        })
    });
    let names: Vec<&str> = tables.iter().map(|law| law.name.as_str()).collect();
    for table in table.into_iter().chain(gaps) {
        provenance.files.push(InputFile::read(Path::new(""), table)?);
    }
    let answer = json!({
        "schema": "asperity/law/1",
        "laws": names,
        "fit": fit_json,
        "imported": imported.as_ref().map(|law| json!({
            "file": "imported-law.json",
            "rows": law.rows,
            "open_rows": law.open_rows,
            "pressure_min_pa": law.pressure_range.0,
            "pressure_max_pa": law.pressure_range.1,
            "closure_error": law.closure_error,
        })),
        "export": exported.as_ref().map(Export::json),
        "provenance": provenance,
    });
    let folder = folder.finish("law.json", &answer, output.json)?;
    if output.json {
        return Ok(());
    }
    if let Some(fit) = &fitted {
        let (c, m) = (fit.coefficient, fit.exponent);
        answer_line!("K = C p^m with C = {c:.4e} Pa^(1-m)/m, m = {m:.4}");
        answer_line!("scatter of ln K: {:.3} rms", fit.residual_log_rms);
        if let Some(errors) = &fit.errors {
            let (c, m) = (errors.log_coefficient, errors.exponent);
            answer_line!("standard errors: ln C {c:.3}, m {m:.3}");
        }
    }
    if let Some(law) = &imported {
        let (low, high) = law.pressure_range;
        answer_line!(
            "imported-law.json: a table law of {} points, {low:.4e} to {high:.4e} Pa",
            law.rows - law.open_rows
        );
        answer_line!("  closures of the table within {:.1e} of the whole", law.closure_error);
    }
    if let Some(export) = &exported {
        export.answer()?;
    }
    answer_line!("{} laws tabulated in {}", tables.len(), folder.display());
    Ok(())
}

/// A scenario of bars or of matrices, as far as its laws need it.
struct Source {
    title: Option<String>,
    laws: ScenarioLaws,
    provenance: Provenance,
}

impl Source {
    fn of(document: &Document) -> Result<Self, Failure> {
        if document.has_matrices() {
            let scenario = super::patches::checked(document)?;
            let assembly = assemble_patches(&scenario, document.folder())?;
            return Ok(Self {
                laws: ScenarioLaws::of_structure(&scenario, &assembly.structure.at_rest()),
                provenance: Provenance::of_structure(document, &scenario)?,
                title: scenario.title,
            });
        }
        let scenario = super::checked(document)?;
        Ok(Self {
            laws: ScenarioLaws::of_bars(&scenario)?,
            provenance: Provenance::of_scenario(document, &scenario)?,
            title: scenario.title,
        })
    }
}

/// Adds an imported law, named for its file.
fn add_law(laws: &mut Laws, path: &Path, law: &ImportedLaw) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut name = stem.clone();
    for number in 2.. {
        if laws.get(&name).is_none() {
            break;
        }
        name = format!("{stem}-{number}");
    }
    laws.insert(name, law.spec.clone());
}

/// The tables of the contacts for a finite-element code.
struct Export {
    format: DeckFormat,
    units: DeckUnits,
    file: String,
    tables: Vec<ContactTable>,
}

impl Export {
    /// The tables that the options ask for; `None` without a format.
    fn new(laws: &ScenarioLaws, asked: &DeckExport) -> Result<Option<Self>, Failure> {
        let (Some(format), Some(units)) = (asked.export, asked.deck_units) else {
            return Ok(None);
        };
        let (format, name) = format.format();
        let rows = asked.rows.unwrap_or(ROWS);
        let accepted = OverclosureTable::MIN_ROWS..=format.max_rows();
        if !accepted.contains(&rows) {
            return Err(Failure::Rows { rows, code: format.name(), accepted });
        }
        let tables = contact_tables(laws, rows, asked.top_pressure)?;
        let file = format!("contacts-{name}.inp");
        Ok(Some(Self { format, units: units.into(), file, tables }))
    }

    fn json(&self) -> Value {
        let tables = self.tables.iter().map(|contact| {
            let rows = contact.table.rows();
            let accuracy = &contact.accuracy;
            json!({
                "interface": contact.interface,
                "law": contact.law,
                "surface_interaction": contact.surface_interaction,
                "rows": rows.len(),
                "pressure_max_pa": rows.last().map(|row| row.pressure),
                "overclosure_max_m": rows.last().map(|row| row.overclosure),
                "closure_at_zero_overclosure_m": contact.table.first_closure(),
                "static_pressure_pa": contact.at_rest.map(|rest| rest.0),
                "static_stiffness_pa_per_m": contact.at_rest.map(|rest| rest.1),
                "accurate_from_pa": accuracy.pressure_min,
                "tangent_error": accuracy.tangent_error,
                "tangent_error_at_pa": accuracy.tangent_error_pressure,
                "overclosure_error": accuracy.closure_error,
            })
        });
        json!({
            "format": self.format.name(),
            "units": self.units.name(),
            "file": self.file,
            "beyond_last_row": self.beyond(),
            "contacts": tables.collect::<Vec<_>>(),
        })
    }

    fn beyond(&self) -> &'static str {
        match self.format.beyond() {
            BeyondTable::SlopeHeld => "last slope continues",
            _ => "last pressure is held",
        }
    }

    fn answer(&self) -> Result<(), Failure> {
        answer_line!(
            "{}: tables in {}; beyond the last row the {}",
            self.file,
            self.units.name(),
            self.beyond()
        );
        for contact in &self.tables {
            let rows = contact.table.rows();
            let accuracy = &contact.accuracy;
            let top = rows.last().map_or(0.0, |row| row.pressure);
            answer_line!(
                "{}: {} rows, 0 to {:.4} MPa",
                contact.surface_interaction,
                rows.len(),
                1e-6 * top
            );
            if let Some((pressure, stiffness)) = contact.at_rest {
                answer_line!("  exact at rest: {:.4} MPa, {stiffness:.4e} Pa/m", 1e-6 * pressure);
            }
            answer_line!(
                "  above {:.4} MPa: tangent error up to {:.2} % (at {:.4} MPa), overclosure error {:.1e}",
                1e-6 * accuracy.pressure_min,
                100.0 * accuracy.tangent_error,
                1e-6 * accuracy.tangent_error_pressure,
                accuracy.closure_error
            );
            if contact.carries_tension {
                answer_line!("  the law carries tension, the table does not");
            }
        }
        Ok(())
    }
}
