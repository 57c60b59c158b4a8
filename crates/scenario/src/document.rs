//! A scenario's text: read from a file, changed by `--set`, checked as a whole.

mod set;

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt::Write as _;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde_json::Value;
use sha2::{Digest, Sha256};
use thiserror::Error;

use crate::Scenario;
use crate::diagnostic::{Diagnostic, Invalid, Problem};
use crate::input::{self, InputError};
use crate::locate::{self, SyntaxError};
use crate::pointer::Pointer;
use crate::schema::schema;
use crate::{schema_check, validate};

pub use set::SetError;
pub use set::set as set_value;

/// Most bytes of a scenario's text.
pub const MOST_SCENARIO_BYTES: u64 = 16 << 20;

/// A scenario as text and as JSON, with the place it came from.
#[derive(Debug, Clone)]
pub struct Document {
    path: PathBuf,
    text: String,
    value: Value,
    /// Pointers changed since the text was read.
    changed: Vec<Pointer>,
    repeated: Vec<Diagnostic>,
}

/// A text that cannot be read as a JSON document.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DocumentError {
    /// The file cannot be opened or read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// Why.
        source: InputError,
    },
    /// The text is not UTF-8.
    #[error("{}: line {line} holds a byte that is not UTF-8; expected a JSON text saved as UTF-8", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The first byte that does not belong to a character, from 0.
        offset: usize,
    },
    /// The text is UTF-16, as some editors save it.
    #[error("{}: the text is saved as UTF-16; expected a JSON text saved as UTF-8", path.display())]
    Utf16 {
        /// The file.
        path: PathBuf,
    },
    /// There is no text.
    #[error("{}: the file is empty; expected a JSON object with a \"schema\"", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The text is not JSON.
    #[error("{}: {source}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The text, to show the place in.
        text: String,
        /// What is wrong, and where.
        source: SyntaxError,
    },
    /// The text is refused by the JSON parser although the scan has passed it.
    #[error("{}: line {line}, column {column} is not JSON", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
    },
}

impl Document {
    /// Reads a scenario's file, of at most [`MOST_SCENARIO_BYTES`].
    ///
    /// # Errors
    /// [`DocumentError`] when it cannot be read, or is not a JSON text.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DocumentError> {
        let path = path.as_ref();
        let fail = |source| DocumentError::Input { path: path.to_owned(), source };
        let file = input::open(path, MOST_SCENARIO_BYTES).map_err(fail)?;
        let mut bytes = Vec::new();
        file.take(MOST_SCENARIO_BYTES)
            .read_to_end(&mut bytes)
            .map_err(|error| fail(error.into()))?;
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            let path = path.to_owned();
            return Err(DocumentError::Utf16 { path });
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

    /// Takes a scenario's text; `name` stands for its file in messages, and its
    /// folder is where samples are looked for. A byte order mark is passed over.
    ///
    /// # Errors
    /// [`DocumentError`] when it is not a JSON text.
    pub fn parse(text: &str, name: impl Into<PathBuf>) -> Result<Self, DocumentError> {
        let path = name.into();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            return Err(DocumentError::Empty { path });
        }
        let places = match locate::locate(text, &BTreeSet::new()) {
            Ok(places) => places,
            Err(source) => {
                let text = text.to_owned();
                return Err(DocumentError::Syntax { path, text, source });
            }
        };
        let value = match serde_json::from_str(text) {
            Ok(value) => value,
            Err(error) => {
                let (line, column) = (error.line(), error.column());
                return Err(DocumentError::Refused { path, line, column });
            }
        };
        let repeated = places.repeated.into_iter().map(|(pointer, span)| Diagnostic {
            pointer,
            problem: Problem::RepeatedKey,
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

    /// Sets the value at a JSON Pointer, as `--set POINTER=VALUE` does. The
    /// value is taken as JSON where it is JSON, else as a text; the pointer
    /// leads to something that exists, to a new key of an object, or to `-`
    /// after the last item of an array.
    ///
    /// An object that the scenario leaves to its default is filled in when
    /// something inside it is set, e.g. `/method/cell_m`.
    ///
    /// # Errors
    /// [`SetError`] names the deepest part that exists and what is there.
    pub fn set(&mut self, pointer: &str, value_text: &str) -> Result<(), SetError> {
        let changed = set::set(&mut self.value, pointer, value_text)?;
        self.changed.push(changed);
        Ok(())
    }

    /// The scenario, after every check: schema, cross conditions, samples file.
    ///
    /// # Errors
    /// [`Invalid`] holds every problem found, in the order of the text.
    pub fn scenario(&self) -> Result<Scenario, Invalid> {
        let whole = validate::check(&self.value, self.folder());
        self.typed(schema(), whole, "a scenario as `asperity schema` describes it")
    }

    /// What the document holds, after every check: a `schema`, from which the type is generated,
    /// and the problems of the `whole` found by other means.
    pub fn typed<T: DeserializeOwned>(
        &self,
        schema: &Value,
        whole: Vec<Diagnostic>,
        accepted: &'static str,
    ) -> Result<T, Invalid> {
        let mut diagnostics = self.repeated.clone();
        let of_schema = schema_check::check(schema, &self.value);
        let told: HashSet<&str> = of_schema.iter().map(|found| found.pointer.as_str()).collect();
        diagnostics
            .extend(whole.into_iter().filter(|found| !told.contains(found.pointer.as_str())));
        diagnostics.extend(of_schema);
        if diagnostics.is_empty() {
            // The schema is generated from the types, so what passes it fits them.
            match serde_json::from_value(self.value.clone()) {
                Ok(found) => return Ok(found),
                Err(error) => diagnostics.push(Diagnostic::new(
                    &Pointer::root(),
                    Problem::SchemaGap { reason: error.to_string() },
                    accepted,
                )),
            }
        }
        Err(self.invalid(diagnostics))
    }

    /// The document as an invalid one, its problems at their places in the text.
    pub fn invalid(&self, mut diagnostics: Vec<Diagnostic>) -> Invalid {
        self.place(&mut diagnostics);
        Invalid { path: self.path.clone(), diagnostics }
    }

    /// The JSON value, with every `set` applied.
    pub fn value(&self) -> &Value {
        &self.value
    }

    /// The text as it was read, for showing the spans of diagnostics.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The file, or the name that the text was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder that relative file names of the scenario start from.
    pub fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// SHA-256, in hexadecimal, of the scenario with every `set` applied: its
    /// JSON without white space and with the keys of every object sorted.
    pub fn sha256(&self) -> String {
        let canonical = sorted(&self.value).to_string();
        let mut hexadecimal = String::with_capacity(64);
        for byte in Sha256::digest(canonical.as_bytes()) {
            // Writing to a String cannot fail.
            let _ = write!(hexadecimal, "{byte:02x}");
        }
        hexadecimal
    }

    /// Gives the diagnostics their spans, and the order of the text.
    fn place(&self, diagnostics: &mut [Diagnostic]) {
        let wanted: BTreeSet<&str> =
            diagnostics.iter().map(|found| found.pointer.as_str()).collect();
        let places = locate::locate(&self.text, &wanted).unwrap_or_default();
        for diagnostic in diagnostics.iter_mut().filter(|found| found.span.is_none()) {
            let Some(place) = places.found.get(&diagnostic.pointer) else {
                continue;
            };
            let pointer: Pointer = diagnostic.pointer.parse().unwrap_or_default();
            let changed = |changed: &Pointer| pointer.parts().starts_with(changed.parts());
            if !self.changed.iter().any(changed) {
                diagnostic.span = match (&diagnostic.problem, &place.key) {
                    (Problem::UnknownKey, Some(key)) => Some(key.clone()),
                    _ => Some(place.value.clone()),
                };
            }
        }
        diagnostics.sort_by_key(|found| found.span.as_ref().map_or(usize::MAX, |span| span.start));
    }
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
