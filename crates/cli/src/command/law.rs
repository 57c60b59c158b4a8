//! `asperity law`.

use std::path::Path;

use asperity_study::laws::{fit, tabulate};
use asperity_study::output::file_name::distinct_file_names;
use asperity_study::provenance::{InputFile, Provenance};
use asperity_study::record::law_csv;
use serde_json::json;

use super::ResultFolder;
use crate::args::{Input, Output};
use crate::failure::Failure;
use crate::plot;

/// Tabulates and draws every law, and fits one to `table` if given.
pub(crate) fn run(input: &Input, output: &Output, table: Option<&Path>) -> Result<(), Failure> {
    let document = super::read(input)?;
    let scenario = super::checked(&document)?;
    let fitted = table.map(fit).transpose().map_err(asperity_study::error::StudyError::from)?;
    let tables = tabulate(&scenario)?;
    let folder = ResultFolder::claim("law", document.path(), output)?;
    let file_names = distinct_file_names(tables.iter().map(|law| law.name.as_str()));
    for (law, name) in tables.iter().zip(&file_names) {
        folder.write(&format!("law-{name}.csv"), law_csv(law))?;
    }
    if !tables.is_empty() {
        folder.draw("law.svg", &plot::laws(&tables))?;
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
    let mut provenance = Provenance::of_scenario(&document, &scenario)?;
    if let Some(table) = table {
        provenance.files.push(InputFile::read(Path::new(""), table)?);
    }
    let answer = json!({
        "schema": "asperity/law/1",
        "laws": names,
        "fit": fit_json,
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
    answer_line!("{} laws tabulated in {}", tables.len(), folder.display());
    Ok(())
}
