//! Files that the runs of a sweep read.

use std::collections::BTreeSet;

use asperity_scenario::{Document, set_value};
use serde_json::{Value, json};

use super::variation::{Variation, digits};
use crate::error::SimulationError;
use crate::provenance::InputFile;

/// Values that choose the samples file of a run.
const CHOOSING: [&str; 3] = ["/excitation", "/excitation/kind", "/excitation/file"];

/// The files that the runs of a sweep read, with their SHA-256, sorted.
///
/// # Errors
/// [`SimulationError`] for a file that cannot be read, or a value that cannot be set.
pub fn input_files(
    document: &Document,
    variations: &[Variation],
) -> Result<Vec<InputFile>, SimulationError> {
    let choosing: Vec<&Variation> =
        variations.iter().filter(|one| CHOOSING.contains(&one.pointer.as_str())).collect();
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
        let text = |key: &str| part["excitation"].get(key).and_then(Value::as_str);
        if let (Some("samples"), Some(file)) = (text("kind"), text("file")) {
            files.insert(file.to_owned());
        }
    }
    files.iter().map(|file| InputFile::read(document.folder(), file.as_ref())).collect()
}
