//! The identification problem with its scenario.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity_inference::{FitOptions, Loss};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::problem::{DataSpec, LossSpec, ProblemSpec, ScenarioRef, problem_schema};
use crate::records::record_files;
use crate::work::Work;
use asperity_scenario::{
    Document, ExcitationSpec, InvalidDocument, StructureScenario, has_matrices, validate_json,
};
use asperity_simulation::patches::ReducedStructures;
use asperity_simulation::provenance::InputFile;

/// Relative reduction of the cost at which a fit has converged.
const TOLERANCE: f64 = 1e-7;

/// Relative step of difference derivatives: large against the tables' errors of 1e-6, with an error
/// of 1e-4 from the curvature; shorter where the data are precise.
const DIFFERENCE: f64 = 1e-2;

/// An identification problem with its scenario, checked except for the data files.
#[derive(Debug, Clone)]
pub struct IdentificationProblem {
    /// The text.
    pub document: Document,
    /// Its content.
    pub spec: ProblemSpec,
    /// Its scenario, whose method is modal.
    pub(super) scenario: Value,
    /// The scenario's file, or the problem's if it is in place.
    pub(super) scenario_path: PathBuf,
    /// SHA-256 of the scenario as it was written.
    pub(super) scenario_sha256: String,
    /// Notices on replaced settings.
    pub(super) notices: Vec<String>,
    pub(super) work: Arc<Work>,
    /// Reductions of a structure of matrices, read or made once.
    pub(super) reductions: Arc<ReducedStructures>,
    /// True without profiles, comparison and explanations.
    pub(super) is_fast: bool,
}

impl IdentificationProblem {
    /// Reads the problem at `path`.
    ///
    /// # Errors
    /// [`IdentificationError`] for a file that cannot be read, a problem or scenario that is not valid.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, IdentificationError> {
        Self::of(Document::read(path)?)
    }

    /// The progress of an identification of this problem (and its clones), and the way to stop it.
    pub fn work(&self) -> &Arc<Work> {
        &self.work
    }

    /// The files that the problem and its scenario name, with their SHA-256.
    ///
    /// # Errors
    /// [`IdentificationError::Study`] for a file that cannot be read.
    pub fn input_files(&self) -> Result<Vec<InputFile>, IdentificationError> {
        let excitation = ExcitationSpec::deserialize(&self.scenario["excitation"]);
        let mut files = Vec::new();
        if let Some(samples) = excitation.ok().as_ref().and_then(ExcitationSpec::samples) {
            files.push(InputFile::read(self.scenario_folder(), samples.file.as_ref())?);
        }
        if has_matrices(&self.scenario)
            && let Ok(structure) = StructureScenario::deserialize(&self.scenario)
        {
            for file in structure.files() {
                files.push(InputFile::read(self.scenario_folder(), file.as_ref())?);
            }
        }
        let folder = self.document.folder();
        for data in &self.spec.data {
            if let DataSpec::Records { files: records, .. } = data {
                for file in record_files(folder, records)? {
                    let file = file.strip_prefix(folder).unwrap_or(&file);
                    files.push(InputFile::read(folder, file)?);
                }
            } else {
                for file in data.files() {
                    files.push(InputFile::read(folder, file.as_ref())?);
                }
            }
        }
        Ok(files)
    }

    /// The problem of a document.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn of(document: Document) -> Result<Self, IdentificationError> {
        let spec: ProblemSpec = document.checked(problem_schema(), Vec::new())?;
        let (mut scenario, scenario_path, scenario_sha256) = match &spec.scenario {
            ScenarioRef::File(file) => {
                let scenario = Document::read(document.folder().join(file))?;
                scenario.any_scenario()?;
                (scenario.value().clone(), scenario.path().to_owned(), scenario.sha256())
            }
            ScenarioRef::InPlace(scenario) => {
                let value = Value::Object(scenario.clone());
                let mut found = validate_json(&value, document.folder());
                if !found.is_empty() {
                    for diagnostic in &mut found {
                        diagnostic.pointer = format!("/scenario{}", diagnostic.pointer);
                    }
                    return Err(document.with_spans(found).into());
                }
                let sha256 = Document::parse(&value.to_string(), document.path())?.sha256();
                (value, document.path().to_owned(), sha256)
            }
        };
        let mut notices = Vec::new();
        let kind = |method: &Value| match method {
            Value::String(kind) => kind.clone(),
            other => other.get("kind").and_then(Value::as_str).unwrap_or_default().to_owned(),
        };
        let method = scenario.get("method").map(kind);
        if let Some(other) = method.filter(|method| method != "modal") {
            notices.push(format!("the scenario's method is {other}; identification runs modal"));
            scenario["method"] = json!("modal");
        }
        let work = Arc::default();
        let is_fast = false;
        Ok(Self {
            document,
            spec,
            scenario,
            scenario_path,
            scenario_sha256,
            notices,
            work,
            reductions: Arc::default(),
            is_fast,
        })
    }

    /// The problem without profiles, comparison with other laws and explanations of a misfit, which its
    /// judgement names.
    #[must_use]
    pub fn fast(self) -> Self {
        Self { is_fast: true, ..self }
    }

    /// Folder of the scenario.
    pub(super) fn scenario_folder(&self) -> &Path {
        self.scenario_path.parent().unwrap_or_else(|| Path::new("."))
    }

    /// Checks a scenario that stands in place of the problem's own.
    pub(super) fn check_scenario(&self, scenario: &Value) -> Result<(), IdentificationError> {
        let diagnostics = validate_json(scenario, self.scenario_folder());
        if diagnostics.is_empty() {
            return Ok(());
        }
        Err(InvalidDocument { path: self.scenario_path.clone(), diagnostics }.into())
    }

    /// Options of the fits of the problem.
    pub(super) fn fit_options(&self, starts: usize) -> FitOptions {
        let loss = match self.spec.loss {
            LossSpec::Squared => Loss::Squared,
            LossSpec::Huber { threshold } => Loss::Huber { threshold },
            LossSpec::Cauchy { scale } => Loss::Cauchy { scale },
        };
        let seed = self.spec.seed;
        FitOptions {
            loss,
            starts,
            seed,
            tolerance: TOLERANCE,
            difference_step: DIFFERENCE,
            ..FitOptions::default()
        }
    }
}
