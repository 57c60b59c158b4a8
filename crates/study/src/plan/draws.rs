//! Weighted draws of inputs that belong together: numbers of a CSV file such as `posterior.csv` of an
//! identification, or changes of the scenario such as its `draws.json`.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use asperity_sampling::WeightedDraws;
use asperity_scenario::{file_sha256, open_input};
use asperity_simulation::error::SimulationError;
use serde::Deserialize;
use serde_json::{Map, Value};

use crate::error::StudyError;
use crate::spec::DrawsSpec;

/// Most bytes of a CSV file of draws.
const MOST_BYTES: u64 = 1 << 30;

/// Most bytes of a JSON file of draws, which takes about ten times as much memory.
const MOST_JSON_BYTES: u64 = 1 << 27;

/// Identifier of the format of changes.
const DRAWS_SCHEMA: &str = "asperity/draws/1";

/// Name of the input that numbers the draws of changes.
const DRAW: &str = "draw";

/// Draws of a file.
#[derive(Debug, Clone)]
pub(super) struct Draws {
    /// Numbers of each draw: its values, or its own number, from 1, among the changes.
    pub(super) numbers: WeightedDraws,
    /// Names of these numbers.
    pub(super) names: Vec<String>,
    /// Values of the scenario that a draw sets.
    pub(super) pointers: Vec<String>,
    /// Values that each draw sets them to, unless its numbers are the values.
    pub(super) changes: Option<Arc<[Vec<Value>]>>,
    /// The warning of an identification whose result is not to be used.
    pub(super) warning: Option<String>,
    /// SHA-256 of the file.
    pub(super) sha256: String,
}

/// Content of a file of changes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Changes {
    schema: String,
    pointers: Vec<String>,
    weights: Option<Vec<f64>>,
    draws: Vec<Vec<Value>>,
    judgement: Option<Judgement>,
}

/// The judgement of the identification that has written the draws.
#[derive(Debug, Deserialize)]
struct Judgement {
    r#use: String,
    #[serde(default)]
    reasons: Vec<Reason>,
}

/// A reason of a judgement.
#[derive(Debug, Deserialize)]
struct Reason {
    r#use: String,
    words: String,
}

impl Judgement {
    /// The warning about the draws of the file at `path`, if their law is not to be used.
    fn warning(&self, path: &Path) -> Option<String> {
        if self.r#use != VOID {
            return None;
        }
        let reasons = self.reasons.iter().filter(|reason| reason.r#use == VOID);
        let reasons: Vec<&str> = reasons.map(|reason| reason.words.as_str()).collect();
        let path = path.display();
        Some(format!(
            "{path}: the identification judges its own law as not to be used, and the answers of this study are void with it: {}",
            reasons.join(" ")
        ))
    }
}

/// Use of draws that are void.
const VOID: &str = "no";

impl Draws {
    /// The draws that `spec` asks for.
    pub(super) fn read(folder: &Path, spec: &DrawsSpec) -> Result<Self, StudyError> {
        let path = folder.join(&spec.file);
        let input =
            |source| StudyError::from(SimulationError::Input { path: path.clone(), source });
        let is_json = path.extension().is_some_and(|found| found.eq_ignore_ascii_case("json"));
        let most = if is_json { MOST_JSON_BYTES } else { MOST_BYTES };
        let file = open_input(&path, most).map_err(input)?;
        let sha256 = file_sha256(&path).map_err(input)?;
        match (&spec.columns, is_json) {
            (None, true) => Self::of_changes(&path, file, sha256),
            (Some(columns), false) => Self::of_columns(&path, file, columns, &spec.weight, sha256),
            (None, false) => {
                Err(fault("no `columns`; accepted: columns for a CSV file, or draws.json".into()))
            }
            (Some(_), true) => Err(fault(
                "`columns` beside a JSON file, which has pointers of its own; accepted: none"
                    .into(),
            )),
        }
    }

    fn of_changes(path: &Path, file: File, sha256: String) -> Result<Self, StudyError> {
        let here = |text: &str| fault(format!("{}: {text}", path.display()));
        let found: Changes = serde_json::from_reader(BufReader::new(file))
            .map_err(|error| here(&error.to_string()))?;
        if found.schema != DRAWS_SCHEMA {
            return Err(here(&format!(
                "schema \"{}\"; accepted: \"{DRAWS_SCHEMA}\"",
                found.schema
            )));
        }
        let expected = found.pointers.len();
        if expected == 0 {
            return Err(here("there are no pointers; accepted: at least one"));
        }
        if let Some(place) = found.draws.iter().position(|draw| draw.len() != expected) {
            let count = found.draws[place].len();
            let text = format!(
                "draw {} has {count} values; accepted: {expected}, one a pointer",
                place + 1
            );
            return Err(here(&text));
        }
        let numbers: Vec<Vec<f64>> =
            (1..=found.draws.len()).map(|number| vec![number as f64]).collect();
        let weights = found.weights.unwrap_or_else(|| vec![1.0; numbers.len()]);
        Ok(Self {
            numbers: weighted(&numbers, &weights)?,
            names: vec![DRAW.to_owned()],
            pointers: found.pointers,
            changes: Some(found.draws.into()),
            warning: found.judgement.and_then(|judgement| judgement.warning(path)),
            sha256,
        })
    }

    fn of_columns(
        path: &Path,
        file: File,
        columns: &Map<String, Value>,
        weight: &str,
        sha256: String,
    ) -> Result<Self, StudyError> {
        let text = |error: csv::Error| fault(format!("{}: {error}", path.display()));
        let mut reader = csv::Reader::from_reader(file);
        let header = reader.headers().map_err(text)?.clone();
        let place = |name: &str| header.iter().position(|column| column == name);
        let names: Vec<&str> = header.iter().collect();
        let mut wanted = Vec::new();
        for (pointer, name) in columns {
            let Some(at) = name.as_str().and_then(place) else {
                let accepted = names.join(", ");
                let found = format!("{pointer} has the column {name}; accepted: {accepted}");
                return Err(fault(found));
            };
            wanted.push(at);
        }
        let weight = place(weight);
        let (mut draws, mut weights) = (Vec::new(), Vec::new());
        for (number, row) in reader.records().enumerate() {
            let row = row.map_err(text)?;
            let number_at = |at: usize| {
                let field = row.get(at).unwrap_or_default();
                field
                    .trim()
                    .parse::<f64>()
                    .map_err(|_| fault(format!("`{field}` in row {} is not a number", number + 1)))
            };
            draws.push(wanted.iter().map(|&at| number_at(at)).collect::<Result<Vec<_>, _>>()?);
            weights.push(weight.map_or(Ok(1.0), number_at)?);
        }
        let pointers: Vec<String> = columns.keys().cloned().collect();
        let numbers = weighted(&draws, &weights)?;
        Ok(Self {
            numbers,
            names: pointers.clone(),
            pointers,
            changes: None,
            warning: None,
            sha256,
        })
    }

    /// Replaces the number of a draw at the end of a row by what the draw sets.
    pub(super) fn expand(changes: &[Vec<Value>], row: &[Value]) -> Vec<Value> {
        let (inputs, number) = row.split_at(row.len().saturating_sub(1));
        let number = number.first().and_then(Value::as_f64).unwrap_or_default() as usize;
        let draw = &changes[number.clamp(1, changes.len()) - 1];
        inputs.iter().chain(draw).cloned().collect()
    }
}

fn weighted(draws: &[Vec<f64>], weights: &[f64]) -> Result<WeightedDraws, StudyError> {
    WeightedDraws::new(draws, weights)
        .map_err(|source| StudyError::Design { place: "/draws".into(), source })
}

fn fault(fault: String) -> StudyError {
    StudyError::Part { place: "/draws".into(), fault }
}
