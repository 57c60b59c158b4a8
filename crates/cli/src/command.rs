//! One file per subcommand, and what they share: reading the scenario, claiming the folder.

pub(crate) mod analyse;
pub(crate) mod check;
pub(crate) mod convert;
pub(crate) mod identify;
pub(crate) mod law;
pub(crate) mod modes;
pub(crate) mod schema;
pub(crate) mod simulate;
pub(crate) mod steady;
pub(crate) mod sweep;

use std::path::{Path, PathBuf};

use asperity_figure::Figure;
use asperity_scenario::{Document, Scenario};
use asperity_study::output::OutputFolder;

use crate::args::{Input, Output};
use crate::failure::Failure;

/// Reads the scenario, with its changes, without checking it.
fn read(input: &Input) -> Result<Document, Failure> {
    let mut document = Document::read(&input.scenario)?;
    for argument in &input.set {
        let (pointer, value) = argument.split_once('=').ok_or_else(|| Failure::SetForm {
            argument: argument.clone(),
            accepted: "accepted: POINTER=VALUE, e.g. /excitation/peak_n=20",
        })?;
        document.set(pointer, value).map_err(|source| Failure::Set { source })?;
    }
    Ok(document)
}

/// Checks a scenario and gives it types.
fn checked(document: &Document) -> Result<Scenario, Failure> {
    document.scenario().map_err(|source| Failure::Invalid {
        text: document.text().to_owned(),
        path: document.path().to_owned(),
        source,
    })
}

/// Claims the folder for the results of `scenario`.
fn claim(scenario: &Path, output: &Output) -> Result<OutputFolder, Failure> {
    let folder = output.out.clone().unwrap_or_else(|| {
        let name = scenario.file_stem().unwrap_or(scenario.as_os_str());
        PathBuf::from("out").join(name)
    });
    Ok(OutputFolder::claim(folder, output.force)?)
}

/// Draws a figure into the folder, unless it cannot be drawn.
fn draw(folder: &OutputFolder, name: &str, figure: &Figure) -> Result<(), Failure> {
    figure.check()?;
    folder.write(name, figure.to_svg())?;
    Ok(())
}

/// JSON as it is printed and written: indented, with a line break at its end.
fn pretty(value: &serde_json::Value) -> String {
    format!("{value:#}\n")
}
