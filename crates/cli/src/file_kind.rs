//! Kinds of input files: a file given to the wrong command is named with the command that reads it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use asperity_measure::Format;
use serde_json::Value;
use thiserror::Error;

/// Kind of a file that a command reads or writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileKind {
    Scenario,
    Problem,
    /// A study file.
    Study,
    /// Settings of a rig.
    Rig,
    /// Measured samples.
    Measurements,
    /// JSON that the command wrote, with its name.
    Result(&'static str),
}

/// A file was given to a command that reads files of another kind.
#[derive(Debug, Error)]
#[error("{} is {}; accepted: {}", path.display(), found.noun(), wanted.noun())]
pub(crate) struct WrongKind {
    pub(crate) path: PathBuf,
    pub(crate) found: FileKind,
    wanted: FileKind,
}

/// Schemas of the JSON files that the commands write.
const RESULTS: [(&str, &str); 11] = [
    ("asperity/summary/", "a summary of `asperity simulate`"),
    ("asperity/steady/", "a result of `asperity steady`"),
    ("asperity/sweep/", "a result of `asperity sweep`"),
    ("asperity/study-run/", "a result of `asperity study`"),
    ("asperity/study-answers/", "answers of `asperity study`"),
    ("asperity/law/", "a result of `asperity law`"),
    ("asperity/modes/", "a result of `asperity modes`"),
    ("asperity/analysis/", "a result of `asperity analyse`"),
    ("asperity/decay/", "a result of `asperity decay`"),
    ("asperity/identification/", "a result of `asperity identify`"),
    ("asperity/check/", "an answer of `asperity check`"),
];

impl FileKind {
    /// The kind as a noun.
    pub(crate) fn noun(self) -> &'static str {
        match self {
            Self::Scenario => "a scenario",
            Self::Problem => "a problem of `asperity identify`",
            Self::Study => "a study file",
            Self::Rig => "settings of a rig",
            Self::Measurements => "measurements",
            Self::Result(name) => name,
        }
    }

    /// The command that reads such a file.
    pub(crate) fn command(self, path: &Path) -> Option<String> {
        let command = match self {
            Self::Scenario => "simulate",
            Self::Problem => "identify",
            Self::Study => "study",
            Self::Measurements => "analyse",
            Self::Rig => return Some(format!("asperity analyse --rig {}", path.display())),
            Self::Result(_) => return None,
        };
        Some(format!("asperity {command} {}", path.display()))
    }

    /// The kind that a JSON document names in `schema`.
    fn of_schema(value: &Value) -> Option<Self> {
        let schema = value.get("schema")?.as_str()?;
        if schema.starts_with("asperity/scenario/") {
            Some(Self::Scenario)
        } else if schema.starts_with("asperity/identify/") {
            Some(Self::Problem)
        } else if schema.starts_with("asperity/study/") {
            Some(Self::Study)
        } else if schema.starts_with("asperity/rig/") {
            Some(Self::Rig)
        } else {
            let result = RESULTS.iter().find(|(prefix, _)| schema.starts_with(prefix))?;
            Some(Self::Result(result.1))
        }
    }
}

/// Checks that a JSON document which names its kind is of the kind `wanted`.
pub(crate) fn check_document(
    path: &Path,
    value: &Value,
    wanted: FileKind,
) -> Result<(), WrongKind> {
    match FileKind::of_schema(value) {
        Some(found) if found != wanted => wrong(path, found, wanted),
        _ => Ok(()),
    }
}

/// Checks that a file for a scenario or a problem has no name of measurements.
pub(crate) fn check_name(path: &Path, wanted: FileKind) -> Result<(), WrongKind> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    if extension.and_then(Format::of_extension).is_some() && path.is_file() {
        return wrong(path, FileKind::Measurements, wanted);
    }
    Ok(())
}

/// Checks that a file of measurements is no scenario or other JSON document of ours.
pub(crate) fn check_measurements(path: &Path) -> Result<(), WrongKind> {
    /// Longest document looked at.
    const MOST: u64 = 1 << 24;
    let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let Some(file) = is_json.then(|| File::open(path).ok()).flatten() else { return Ok(()) };
    let mut text = String::new();
    let value = match file.take(MOST).read_to_string(&mut text) {
        Ok(_) => serde_json::from_str(&text).unwrap_or_default(),
        Err(_) => Value::Null,
    };
    check_document(path, &value, FileKind::Measurements)
}

fn wrong(path: &Path, found: FileKind, wanted: FileKind) -> Result<(), WrongKind> {
    Err(WrongKind { path: path.to_owned(), found, wanted })
}
