//! From a study file to the inputs of each run.

mod draws;
mod inputs;
mod table;

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use asperity_scenario::{Document, validate_json};
use asperity_simulation::row_simulator::{Places, RowSimulator};
use asperity_simulation::sweep::{Variation, input_files};
use serde_json::{Value, json};

use crate::error::StudyError;
use crate::spec::{StudiedScenario, StudySpec, study_schema};
use draws::Draws;
use inputs::{InputRows, options};

/// Version of the numbers that a study writes: it changes when the same study file gives other bytes.
const RESULTS_VERSION: u32 = 2;

/// A study file that has been checked, with its scenario.
///
/// ```
/// # use asperity_scenario::Document;
/// use asperity_study::StudyPlan;
///
/// let text = r#"{
///   "schema": "asperity/study/1",
///   "scenario": "block.json",
///   "inputs": [{"pointer": "/excitation/peak_n",
///               "distribution": {"kind": "uniform", "lower": 2, "upper": 14}}],
///   "design": {"kind": "sobol", "rows": 8}
/// }"#;
/// let plan = StudyPlan::of(Document::parse(text, "../simulation/examples/study.json")?)?;
/// assert_eq!((plan.rows(), plan.names().len()), (8, 1));
/// assert!((2.0..14.0).contains(&plan.values(3..4)?[0][0].as_f64().unwrap()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct StudyPlan {
    document: Document,
    spec: StudySpec,
    scenario: Document,
    names: Vec<String>,
    places: Vec<Places>,
    rows: InputRows,
    draws: Option<Draws>,
}

impl StudyPlan {
    /// Reads the study at `path`.
    ///
    /// # Errors
    /// Those of [`of`](Self::of), and [`StudyError::Document`] for a file that cannot be read.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        Self::of(Document::read(path)?)
    }

    /// The study of a document.
    ///
    /// # Errors
    /// [`StudyError`] for a study or a scenario with faults, a file of draws or rows that cannot be used, a
    /// pointer that is given twice or does not exist, and more rows or inputs than a design takes.
    pub fn of(document: Document) -> Result<Self, StudyError> {
        let spec: StudySpec = document.checked(study_schema(), Vec::new())?;
        if let Some(frf) = spec.frf.filter(|frf| frf.stop_hz <= frf.start_hz) {
            let fault = format!("is {}; accepted: above start_hz, {}", frf.stop_hz, frf.start_hz);
            return Err(StudyError::Part { place: "/frf/stop_hz".into(), fault });
        }
        let scenario = scenario_of(&document, &spec.scenario)?;
        let mut places: Vec<Places> = spec
            .inputs
            .iter()
            .map(|one| std::iter::once(&one.pointer).chain(&one.also).cloned().collect())
            .collect();
        let mut names: Vec<String> = spec
            .inputs
            .iter()
            .map(|one| one.name.as_ref().unwrap_or(&one.pointer).clone())
            .collect();
        let draws =
            spec.draws.as_ref().map(|asked| Draws::read(document.folder(), asked)).transpose()?;
        if let Some(draws) = &draws {
            places.extend(draws.pointers.iter().map(|pointer| vec![pointer.clone()]));
            names.extend_from_slice(&draws.names);
        }
        check_places(&scenario, &places, &names)?;
        let numbers = draws.as_ref().map(|draws| draws.numbers.clone());
        let rows = InputRows::new(document.folder(), &spec, numbers)?;
        Ok(Self { document, spec, scenario, names, places, rows, draws })
    }

    /// The study file's document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The study file's content.
    pub fn spec(&self) -> &StudySpec {
        &self.spec
    }

    /// The scenario's document.
    pub fn scenario(&self) -> &Document {
        &self.scenario
    }

    /// The warning that the draws belong to an identification whose result is not to be used, with its
    /// reasons.
    pub fn warning(&self) -> Option<&str> {
        self.draws.as_ref()?.warning.as_deref()
    }

    /// Number of runs.
    pub fn rows(&self) -> u64 {
        self.rows.count()
    }

    /// Number of coordinates of the design: one for each input with a distribution or a column of a
    /// table, and one for all inputs that are drawn together.
    pub fn dimensions(&self) -> usize {
        self.spec.inputs.len() + usize::from(self.spec.draws.is_some())
    }

    /// Names of the coordinates of the design.
    pub fn coordinates(&self) -> Vec<String> {
        let mut names = self.names[..self.spec.inputs.len()].to_vec();
        if self.spec.draws.is_some() {
            names.push("draws".into());
        }
        names
    }

    /// Names of the inputs.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Marks inputs that are texts, or any other values than numbers.
    pub(crate) fn texts(&self) -> Vec<bool> {
        let is_text =
            |input| options(input).is_some_and(|options| !options.iter().all(Value::is_number));
        let mut texts: Vec<bool> = self.spec.inputs.iter().map(is_text).collect();
        texts.resize(self.names.len(), false);
        texts
    }

    /// The inputs of the runs with these numbers, from 0. Of a draw that changes the scenario this is its
    /// number, from 1.
    ///
    /// # Errors
    /// [`StudyError::Table`] for a table that has changed meanwhile, [`StudyError::Io`] for one
    /// that cannot be read; none for other designs.
    pub fn values(&self, rows: Range<u64>) -> Result<Vec<Vec<Value>>, StudyError> {
        self.rows.values(rows)
    }

    /// Values that a model is run with for these inputs: a draw by its changes of the scenario, all others as
    /// they are.
    pub fn model_rows<'a>(&self, rows: &'a [Vec<Value>]) -> Cow<'a, [Vec<Value>]> {
        match self.draws.as_ref().and_then(|draws| draws.changes.as_ref()) {
            Some(changes) => rows.iter().map(|row| Draws::expand(changes, row)).collect(),
            None => rows.into(),
        }
    }

    /// The simulator of the scenario, for [`model_rows`](Self::model_rows).
    ///
    /// # Errors
    /// [`StudyError::Study`] when the scenario cannot be set up.
    pub fn simulator(&self) -> Result<RowSimulator, StudyError> {
        let simulator = RowSimulator::new(self.scenario.clone(), self.places.clone())?;
        let simulator = simulator.with_near_structures();
        Ok(match self.spec.frf {
            Some(frf) => simulator.with_frf(frf.frequencies()),
            None => simulator,
        })
    }

    /// The identity of the study, from which the bytes of its results follow: hashes of the scenario,
    /// the study file and the files they name, and the version of asperity.
    ///
    /// # Errors
    /// [`StudyError::Study`] for a file that cannot be read.
    pub fn identity(&self) -> Result<Value, StudyError> {
        let mut study = self.document.value().clone();
        if let Some(study) = study.as_object_mut() {
            for free in ["title", "scenario"] {
                study.shift_remove(free);
            }
        }
        let study = Document::parse(&study.to_string(), self.document.path())?;
        Ok(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "results": RESULTS_VERSION,
            "scenario_sha256": self.scenario.sha256(),
            "study_sha256": study.sha256(),
            "draws_sha256": self.draws.as_ref().map(|draws| &draws.sha256),
            "table_sha256": self.rows.sha256(),
            "files": input_files(&self.scenario, &self.choices())?,
        }))
    }

    /// Inputs that are choices, which may select files.
    fn choices(&self) -> Vec<Variation> {
        let choices = self.spec.inputs.iter().zip(&self.places).filter_map(|(input, places)| {
            let values: Vec<String> = options(input)?.iter().map(Value::to_string).collect();
            Some(
                places
                    .iter()
                    .map(move |place| Variation { pointer: place.clone(), values: values.clone() }),
            )
        });
        choices.flatten().collect()
    }
}

fn scenario_of(document: &Document, given: &StudiedScenario) -> Result<Document, StudyError> {
    match given {
        StudiedScenario::File(file) => {
            let scenario = Document::read(document.folder().join(file))?;
            scenario.any_scenario()?;
            Ok(scenario)
        }
        StudiedScenario::InPlace(scenario) => {
            let value = Value::Object(scenario.clone());
            let mut found = validate_json(&value, document.folder());
            if found.is_empty() {
                return Ok(Document::parse(&value.to_string(), document.path())?);
            }
            for diagnostic in &mut found {
                diagnostic.pointer = format!("/scenario{}", diagnostic.pointer);
            }
            Err(document.with_spans(found).into())
        }
    }
}

/// Checks that pointers lead to values of the scenario, and that none is given twice.
fn check_places(
    scenario: &Document,
    places: &[Places],
    names: &[String],
) -> Result<(), StudyError> {
    let all: Vec<&String> = places.iter().flatten().collect();
    for (number, place) in all.iter().enumerate() {
        let fault =
            |fault: &str| StudyError::Part { place: (*place).clone(), fault: fault.to_owned() };
        if all[..number].iter().any(|other| inside(place, other) || inside(other, place)) {
            return Err(fault("two inputs set this value; accepted: each value once"));
        }
        if scenario.value().pointer(place).is_none() {
            return Err(fault(
                "the scenario has no such value; accepted: JSON Pointers to values that it states",
            ));
        }
    }
    for (number, name) in names.iter().enumerate() {
        if names[..number].contains(name) {
            let fault = "two inputs have this name; accepted: names that differ".to_owned();
            return Err(StudyError::Part { place: name.clone(), fault });
        }
    }
    Ok(())
}

/// True if `place` is `other` or a part of it.
fn inside(place: &str, other: &str) -> bool {
    place.strip_prefix(other).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}
