//! Origin of results: version, scenario, and the files that the scenario names.

use std::path::Path;

use asperity_scenario::{Document, Scenario, StructureScenario, file_sha256};
use serde::Serialize;

use crate::error::SimulationError;

/// Origin of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// Version of asperity.
    pub version: &'static str,
    /// SHA-256 of the scenario, with its changes, in canonical form.
    pub scenario_sha256: String,
    /// Other files that the result depends on.
    pub files: Vec<InputFile>,
}

/// File that a result depends on.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct InputFile {
    /// Name, as given.
    pub file: String,
    /// SHA-256 of its contents.
    pub sha256: String,
}

impl Provenance {
    /// The provenance of a result that depends on these files beside the document.
    pub fn new(document: &Document, files: Vec<InputFile>) -> Self {
        Self { version: env!("CARGO_PKG_VERSION"), scenario_sha256: document.sha256(), files }
    }

    /// The provenance of a result of one scenario.
    ///
    /// # Errors
    /// [`SimulationError::Input`] for a file that cannot be read.
    pub fn of_scenario(document: &Document, scenario: &Scenario) -> Result<Self, SimulationError> {
        let file = scenario.excitation.samples().map(|samples| samples.file);
        let files = file.map(|file| InputFile::read(document.folder(), file.as_ref()));
        Ok(Self::new(document, files.into_iter().collect::<Result<_, _>>()?))
    }

    /// The provenance of a result of one structure of matrices.
    ///
    /// # Errors
    /// [`SimulationError::Input`] for a file that cannot be read.
    pub fn of_structure(
        document: &Document,
        scenario: &StructureScenario,
    ) -> Result<Self, SimulationError> {
        let samples = scenario.excitation.samples().map(|samples| samples.file);
        let files = scenario.files().chain(samples);
        let files = files.map(|file| InputFile::read(document.folder(), file.as_ref()));
        Ok(Self::new(document, files.collect::<Result<_, _>>()?))
    }
}

impl InputFile {
    /// The file `file`, relative to `folder`.
    ///
    /// # Errors
    /// [`SimulationError::Input`] if it cannot be read.
    pub fn read(folder: &Path, file: &Path) -> Result<Self, SimulationError> {
        let path = folder.join(file);
        let sha256 =
            file_sha256(&path).map_err(|source| SimulationError::Input { path, source })?;
        Ok(Self { file: file.display().to_string(), sha256 })
    }
}
