//! JSON document of a scenario: read from a file, changed value by value, checked as a whole.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde_json::Value;
use thiserror::Error;

use crate::diagnostic::{Diagnostic, InvalidDocument};
use crate::fault::Fault;
use crate::input_file::{InputError, open_input};
use crate::locate::{self, SyntaxError};
use crate::pointer::JsonPointer;
use crate::scenario::{Scenario, scenario_schema};
use crate::schema_check::check_schema;
use crate::set_value::{SetError, set_value};
use crate::sha256::text_sha256;
use crate::structure_scenario::{AnyScenario, StructureScenario, structure_schema};
use crate::validate;

/// Largest size of a document in bytes.
pub const MAX_DOCUMENT_BYTES: u64 = 16 << 20;

/// JSON document as text and as value, with the file it comes from.
///
/// ```
/// use asperity_scenario::Document;
///
/// let mut document = Document::parse(r#"{"title": "a", "duration_s": 1}"#, "a.json")?;
/// document.set("/title", "b")?;
/// assert_eq!(document.value()["title"], "b");
/// assert!(document.scenario().is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Document {
    path: PathBuf,
    text: String,
    value: Value,
    /// Pointers to the values changed since the text was read.
    changed: Vec<JsonPointer>,
    repeated: Vec<Diagnostic>,
}

/// Error of a text that is not a JSON document.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// File that cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Input {
        /// File.
        path: PathBuf,
        /// Cause.
        source: InputError,
    },
    /// Text that is not UTF-8.
    #[error("{}: line {line} contains a byte that is not UTF-8; expected a JSON text saved as UTF-8", path.display())]
    NotUtf8 {
        /// File.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// First byte that is not part of a character, from 0.
        offset: usize,
    },
    /// Text in UTF-16, as some editors save it.
    #[error("{}: the text is saved as UTF-16; expected a JSON text saved as UTF-8", .0.display())]
    Utf16(PathBuf),
    /// Empty text.
    #[error("{}: the file is empty; expected a JSON object with a \"schema\"", .0.display())]
    Empty(PathBuf),
    /// Text that is not JSON.
    #[error("{}: {source}", path.display())]
    Syntax {
        /// File.
        path: PathBuf,
        /// Text that the spans of the error refer to.
        text: String,
        /// Cause, with its place.
        source: SyntaxError,
    },
    /// Text that passes the syntax check but not the JSON parser: a defect of this program.
    #[error("{}: line {line}, column {column} is not JSON", path.display())]
    Unparsed {
        /// File.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
    },
}

impl Document {
    /// Reads a file of at most [`MAX_DOCUMENT_BYTES`].
    ///
    /// # Errors
    /// [`DocumentError`] for a file that cannot be read or is not JSON.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        let fail = |source| DocumentError::Input { path: path.to_owned(), source };
        let file = open_input(path, MAX_DOCUMENT_BYTES).map_err(fail)?;
        let mut bytes = Vec::new();
        file.take(MAX_DOCUMENT_BYTES)
            .read_to_end(&mut bytes)
            .map_err(|error| fail(error.into()))?;
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            return Err(DocumentError::Utf16(path.to_owned()));
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let offset = error.utf8_error().valid_up_to();
            let valid = error.as_bytes().iter().take(offset);
            DocumentError::NotUtf8 {
                path: path.to_owned(),
                line: valid.filter(|byte| **byte == b'\n').count() + 1,
                offset,
            }
        })?;
        Self::parse(&text, path)
    }

    /// Parses a text.
    ///
    /// `name` stands for the file in messages, and relative file names in the document start from
    /// its folder. A byte order mark is ignored.
    ///
    /// # Errors
    /// [`DocumentError`] for a text that is not JSON.
    pub fn parse(text: &str, name: impl Into<PathBuf>) -> Result<Self, DocumentError> {
        let path = name.into();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            return Err(DocumentError::Empty(path));
        }
        let places = locate::locate(text, &BTreeSet::new()).map_err(|source| {
            DocumentError::Syntax { path: path.clone(), text: text.to_owned(), source }
        })?;
        let value = serde_json::from_str(text).map_err(|error| {
            let (path, line, column) = (path.clone(), error.line(), error.column());
            DocumentError::Unparsed { path, line, column }
        })?;
        let repeated = places.repeated.into_iter().map(|(pointer, span)| Diagnostic {
            pointer,
            fault: Fault::RepeatedKey,
            accepted: "each key once".to_owned(),
            suggestion: None,
            span: Some(span),
        });
        Ok(Self {
            path,
            text: text.to_owned(),
            value,
            changed: Vec::new(),
            repeated: repeated.collect(),
        })
    }

    /// Sets the value at a JSON Pointer; see [`set_value`].
    ///
    /// # Errors
    /// [`SetError`] names the deepest part of the pointer that exists, and its keys or indices.
    pub fn set(&mut self, pointer: &str, value_text: &str) -> Result<(), SetError> {
        self.changed.push(set_value(&mut self.value, pointer, value_text)?);
        Ok(())
    }

    /// Returns the scenario after all checks: schema, conditions between values, samples file.
    ///
    /// # Errors
    /// [`InvalidDocument`] with all faults, in the order of the text.
    pub fn scenario(&self) -> Result<Scenario, InvalidDocument> {
        let conditions = validate::check(&self.value, self.folder());
        self.checked(scenario_schema(), conditions)
    }

    /// True if a body is given by matrices: the document is a [`StructureScenario`].
    pub fn has_matrices(&self) -> bool {
        validate::has_matrices(&self.value)
    }

    /// Returns the scenario of a structure of matrices after all checks.
    ///
    /// # Errors
    /// [`InvalidDocument`] with all faults, in the order of the text.
    pub fn structure_scenario(&self) -> Result<StructureScenario, InvalidDocument> {
        let conditions = validate::check_structure(&self.value, self.folder());
        self.checked(structure_schema(), conditions)
    }

    /// Returns the scenario, of bars or of a structure of matrices, after all checks.
    ///
    /// # Errors
    /// [`InvalidDocument`] with all faults, in the order of the text.
    pub fn any_scenario(&self) -> Result<AnyScenario, InvalidDocument> {
        Ok(if self.has_matrices() {
            AnyScenario::Structure(self.structure_scenario()?.into())
        } else {
            AnyScenario::Bars(self.scenario()?.into())
        })
    }

    /// Deserialises the document after a check against `schema`, which is generated from `T`.
    ///
    /// `others` are faults found by other means; those at a place where the schema reports a fault
    /// are dropped.
    ///
    /// # Errors
    /// [`InvalidDocument`] with all faults, in the order of the text.
    pub fn checked<T: DeserializeOwned>(
        &self,
        schema: &Value,
        others: Vec<Diagnostic>,
    ) -> Result<T, InvalidDocument> {
        let mut diagnostics = self.repeated.clone();
        let of_schema = check_schema(schema, &self.value);
        let reported: HashSet<&str> = of_schema.iter().map(|d| d.pointer.as_str()).collect();
        diagnostics.extend(others.into_iter().filter(|d| !reported.contains(d.pointer.as_str())));
        diagnostics.extend(of_schema);
        if diagnostics.is_empty() {
            // The schema is generated from the type, so a value that passes it deserialises.
            match serde_json::from_value(self.value.clone()) {
                Ok(value) => return Ok(value),
                Err(error) => diagnostics.push(Diagnostic::new(
                    &JsonPointer::root(),
                    Fault::SchemaGap(error.to_string()),
                    "a document that fits its JSON Schema",
                )),
            }
        }
        Err(self.with_spans(diagnostics))
    }

    /// Collects faults of this document, with their spans and in the order of the text.
    pub fn with_spans(&self, mut diagnostics: Vec<Diagnostic>) -> InvalidDocument {
        let wanted: BTreeSet<&str> = diagnostics.iter().map(|d| d.pointer.as_str()).collect();
        let places = locate::locate(&self.text, &wanted).unwrap_or_default();
        for diagnostic in diagnostics.iter_mut().filter(|d| d.span.is_none()) {
            let Some(place) = places.found.get(&diagnostic.pointer) else { continue };
            let pointer: JsonPointer = diagnostic.pointer.parse().unwrap_or_default();
            let contains = |changed: &JsonPointer| pointer.parts().starts_with(changed.parts());
            if !self.changed.iter().any(contains) {
                diagnostic.span = match (&diagnostic.fault, &place.key) {
                    (Fault::UnknownKey, Some(key)) => Some(key.clone()),
                    _ => Some(place.value.clone()),
                };
            }
        }
        diagnostics.sort_by_key(|d| d.span.as_ref().map_or(usize::MAX, |span| span.start));
        InvalidDocument { path: self.path.clone(), diagnostics }
    }

    /// JSON value, with all changes applied.
    pub fn value(&self) -> &Value {
        &self.value
    }

    /// Text as it was read, which the spans of diagnostics refer to.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// File, or the name given to the text.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The document for any folder: names of its files, of samples, matrices, meshes and cells, are absolute.
    pub fn with_absolute_files(&self) -> Value {
        with_absolute_files(self.value().clone(), self.folder())
    }

    /// Folder that relative file names in the document start from.
    pub fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// SHA-256, in hexadecimal, of the value: its JSON without white space and with sorted keys.
    pub fn sha256(&self) -> String {
        text_sha256(&sorted(&self.value).to_string())
    }
}

/// The JSON value of a scenario whose files are in `folder`, for any folder: names of files, of samples, matrices, meshes
/// and cells, are absolute.
pub fn with_absolute_files(mut scenario: Value, folder: &Path) -> Value {
    let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    make_absolute(&mut scenario, &folder);
    scenario
}

/// The same value with the keys of every object in order.
fn sorted(value: &Value) -> Value {
    match value {
        Value::Object(object) => {
            let ordered: BTreeMap<&String, &Value> = object.iter().collect();
            let pairs = ordered.into_iter().map(|(key, inner)| (key.clone(), sorted(inner)));
            Value::Object(pairs.collect())
        }
        Value::Array(items) => items.iter().map(sorted).collect(),
        other => other.clone(),
    }
}

/// Keys whose texts are names of files.
const FILE_KEYS: [&str; 6] = ["file", "stiffness", "mass", "rows", "mesh", "cells"];

fn make_absolute(value: &mut Value, folder: &Path) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| make_absolute(item, folder)),
        Value::Object(object) => {
            for (key, inner) in object {
                match inner {
                    Value::String(name) if FILE_KEYS.contains(&key.as_str()) => {
                        *name = folder.join(&*name).display().to_string();
                    }
                    inner => make_absolute(inner, folder),
                }
            }
        }
        _ => {}
    }
}
