//! Simulated hits and observations of the data of a problem.

mod hits;
mod observations;

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::analysed_hits::{AnalysedHits, analysed_hits, read_analysis};
use crate::data_files::{self, TableSource};
use crate::error::IdentificationError;
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{AnalysisRef, DataSpec, SpreadSpec};
use crate::records;
use crate::scenario_model::ScenarioModel;
use crate::stepped_sine::read_table;
use asperity_scenario::{InvalidDocument, four_digits, validate_json};

/// A forward model with the labels of its observations.
#[derive(Debug)]
pub(super) struct BuiltModel {
    pub(super) forward: ScenarioModel,
    pub(super) about: Vec<ObservationLabel>,
    /// Notices on omitted data.
    pub(super) notices: Vec<String>,
}

/// Data, feature and abscissa of an observation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ObservationLabel {
    /// Name of the data.
    pub(super) data: String,
    /// The feature.
    pub(super) feature: String,
    /// Peak force as measured \[N\], frequency \[Hz\], amplitude \[m\] or pressure \[Pa\].
    pub(super) at: Option<f64>,
}

impl ObservationLabel {
    fn new(data: &str, feature: impl Into<String>, at: Option<f64>) -> Self {
        Self { data: data.to_owned(), feature: feature.into(), at }
    }
}

/// Adds data to a model.
pub(super) struct Loader<'a> {
    /// The scenario's file.
    pub(super) path: &'a Path,
    /// Folder of the problem.
    pub(super) folder: &'a Path,
    pub(super) built: BuiltModel,
    /// Number of blocks for cross-validation, one per hit.
    pub(super) blocks: usize,
}

impl Loader<'_> {
    /// Loads the data at `index` of the problem.
    pub(super) fn load(
        &mut self,
        index: usize,
        data: &DataSpec,
    ) -> Result<(), IdentificationError> {
        let name = name_of(index, data);
        let place = format!("/data/{index}");
        match data {
            DataSpec::Hits { set, floor, hits, .. } => {
                self.check_floor(&place, floor)?;
                for (number, hit) in hits.iter().enumerate() {
                    self.hit_features(&format!("{place}/hits/{number}"), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Analysis { file, set, features, repeatability, floor, .. } => {
                self.check_floor(&place, floor)?;
                for feature in features {
                    self.column(&place, feature)?;
                }
                let (path, analysis) = match file {
                    AnalysisRef::File(file) => {
                        let path = self.folder.join(file);
                        let analysis = Cow::Owned(read_analysis(&path)?);
                        (path, analysis)
                    }
                    AnalysisRef::InPlace(analysis) => {
                        (PathBuf::from(format!("{place}/file")), Cow::Borrowed(analysis))
                    }
                };
                let AnalysedHits { hits, left_out, scatter } =
                    analysed_hits(&path, &analysis, features, *repeatability)?;
                if !scatter.is_empty() {
                    let part = |(feature, relative): (&String, &f64)| {
                        format!("{} % of {feature}", four_digits(100.0 * relative))
                    };
                    let parts: Vec<String> = scatter.iter().map(part).collect();
                    self.built.notices.push(format!(
                        "{}: repeated hits scatter by {}; standard deviations are at least that",
                        path.display(),
                        parts.join(", ")
                    ));
                }
                if left_out > 0 {
                    self.built.notices.push(format!(
                        "{}: {left_out} hits that were not averaged left out",
                        path.display()
                    ));
                }
                for hit in &hits {
                    self.hit_features(&path.display().to_string(), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Frf { file, hit, band_hz, spread, points, .. } => {
                check_band(&place, *band_hz)?;
                let table = TableSource::new(&place, self.folder, file);
                let lines = data_files::frf(&table, *band_hz, *points)?;
                let simulated = self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n)?;
                self.receptance(&place, &name, simulated, &lines, |_| *spread)
            }
            DataSpec::Backbone { file, index, hit, spread, damping_spread, .. } => {
                let table = TableSource::new(&place, self.folder, file);
                let points = data_files::backbone(&table, *index, damping_spread.is_some())?;
                let simulated = self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n)?;
                self.backbone(&place, &name, simulated, &points, (*spread, *damping_spread))
            }
            DataSpec::Records { files, force, response, set, band_hz, spread, .. } => {
                check_band(&place, *band_hz)?;
                let files: Vec<PathBuf> = files.iter().map(|file| self.folder.join(file)).collect();
                let channels = [force.as_deref(), response.as_deref()];
                for hit in records::hits(&files, channels, *band_hz)? {
                    let simulated = self.add_recorded_hit(&place, &name, set, &hit)?;
                    self.receptance(&place, &name, simulated, &hit.lines, |noise| SpreadSpec {
                        absolute: spread.absolute.hypot(noise),
                        ..*spread
                    })?;
                }
                Ok(())
            }
            DataSpec::SteppedSine { file, set, spread, phase_spread_rad, harmonics, .. } => {
                let rows = read_table(&TableSource::new(&place, self.folder, file))?;
                self.stepped_sine(
                    &place,
                    &name,
                    set,
                    &rows,
                    (*spread, *phase_spread_rad),
                    *harmonics,
                )
            }
            DataSpec::Stiffness { law, points, spread } => {
                self.stiffness(&place, &name, law, points, *spread)
            }
            DataSpec::Ratio { feature, numerator, denominator, value, standard_deviation } => {
                let column = self.column(&place, feature)?;
                let [above, below] = [numerator, denominator]
                    .map(|hit| self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n));
                let quantity = ObservedQuantity::Ratio { hits: [above?, below?], column };
                let block = self.next_block();
                let feature = format!("ratio of {feature}");
                let about = ObservationLabel::new(&name, feature, numerator.force_peak_n);
                self.push(&place, block, quantity, about, (*value, *standard_deviation))
            }
        }
    }
}

/// The name of data, or the kind and number if they have none.
pub(super) fn name_of(index: usize, data: &DataSpec) -> String {
    let (name, kind) = match data {
        DataSpec::Hits { name, .. } => (name.as_ref(), "hits"),
        DataSpec::Analysis { name, .. } => (name.as_ref(), "analysis"),
        DataSpec::Frf { name, .. } => (name.as_ref(), "frf"),
        DataSpec::Backbone { name, .. } => (name.as_ref(), "backbone"),
        DataSpec::Records { name, .. } => (name.as_ref(), "records"),
        DataSpec::SteppedSine { name, .. } => (name.as_ref(), "stepped_sine"),
        DataSpec::Stiffness { .. } => (None, "stiffness"),
        DataSpec::Ratio { .. } => (None, "ratio"),
    };
    name.cloned().unwrap_or_else(|| format!("{kind} {}", index + 1))
}

/// Folder of a scenario's file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or_else(|| Path::new("."))
}

/// Checks a scenario.
pub(super) fn check_scenario(scenario: &Value, path: &Path) -> Result<(), IdentificationError> {
    let diagnostics = validate_json(scenario, folder_of(path));
    if diagnostics.is_empty() {
        return Ok(());
    }
    Err(InvalidDocument { path: path.to_owned(), diagnostics }.into())
}

/// The error of a missing law.
pub(super) fn no_law(scenario: &Value, law: &str) -> IdentificationError {
    IdentificationError::NoLaw { law: law.to_owned(), known: law_names(scenario) }
}

/// The error of a law without a name.
pub(super) fn unnamed_law(scenario: &Value) -> IdentificationError {
    IdentificationError::UnnamedLaw(law_names(scenario))
}

fn law_names(scenario: &Value) -> String {
    let laws = scenario.pointer("/laws").and_then(Value::as_object);
    let names: Vec<&str> =
        laws.into_iter().flat_map(|laws| laws.keys()).map(String::as_str).collect();
    names.join(", ")
}

fn check_band(place: &str, [low, high]: [f64; 2]) -> Result<(), IdentificationError> {
    if low > 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let (quantity, expected) = ("band_hz", "two positive frequencies, the lower first");
    let value = if low > 0.0 { high } else { low };
    Err(IdentificationError::Value { place: place.to_owned(), quantity, value, expected })
}
