//! Files that the runs of a sweep read.

use std::collections::BTreeSet;

use asperity_scenario::{Document, ExcitationSpec, set_value};
use serde::Deserialize;
use serde_json::json;

use super::variation::{Variation, digits};
use crate::error::SimulationError;
use crate::provenance::InputFile;

/// Keys in the excitation whose values choose the samples file of a run.
const CHOOSING: [&str; 6] =
    ["excitation", "kind", "file", "acceleration", "velocity", "displacement"];

/// The files that the runs of a sweep read, with their SHA-256, sorted.
///
/// # Errors
/// [`SimulationError`] for a file that cannot be read, or a value that cannot be set.
pub fn input_files(
    document: &Document,
    variations: &[Variation],
) -> Result<Vec<InputFile>, SimulationError> {
    let chooses = |one: &&Variation| {
        let key = one.pointer.rsplit('/').next();
        one.pointer.starts_with("/excitation") && key.is_some_and(|key| CHOOSING.contains(&key))
    };
    let choosing: Vec<&Variation> = variations.iter().filter(chooses).collect();
    let lengths = || choosing.iter().map(|one| one.values.len());
    let mut files = BTreeSet::new();
    for combination in 0..lengths().product() {
        let mut part = json!({});
        if let Some(excitation) = document.value().get("excitation") {
            part["excitation"] = excitation.clone();
        }
        for (one, value) in choosing.iter().zip(digits(combination, lengths())) {
            set_value(&mut part, &one.pointer, &one.values[value])?;
        }
        let excitation = ExcitationSpec::deserialize(&part["excitation"]);
        if let Some(samples) = excitation.ok().as_ref().and_then(ExcitationSpec::samples) {
            files.insert(samples.file.to_owned());
        }
    }
    if let Some(scenario) =
        document.has_matrices().then(|| document.structure_scenario().ok()).flatten()
    {
        files.extend(scenario.files().map(str::to_owned));
    }
    files.iter().map(|file| InputFile::read(document.folder(), file.as_ref())).collect()
}
