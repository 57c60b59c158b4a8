//! Simulated hits and observations of the data of a problem.

mod hits;
mod observations;

use std::path::{Path, PathBuf};

use asperity_inference::Observation;
use serde_json::Value;

use crate::data_files;
use crate::error::IdentificationError;
use crate::hit::{RigScenario, SimulatedHit};
use crate::observed_quantity::{ObservedQuantity, SummaryColumns};
use crate::problem::{DataSpec, SpreadSpec};
use crate::problem_parameters::ProblemParameters;
use crate::records;
use asperity_scenario::{InvalidDocument, validate_json};
use hits::ForceSource;

/// Contents of the model of some data.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) rigs: Vec<RigScenario>,
    pub(super) hits: Vec<SimulatedHit>,
    pub(super) quantities: Vec<ObservedQuantity>,
    pub(super) observations: Vec<Observation>,
    pub(super) stiffness: Vec<(String, f64)>,
    /// Labels of the observations, for tables and figures.
    pub(super) about: Vec<ObservationLabel>,
    /// Notices on omitted data.
    pub(super) notices: Vec<String>,
    /// Number of blocks for cross-validation, one per hit.
    blocks: usize,
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

/// Loads data into [`Loaded`].
pub(super) struct Loader<'a> {
    /// The scenario, with the modal method.
    pub(super) scenario: &'a Value,
    /// The scenario's file.
    pub(super) path: &'a Path,
    /// Folder of the problem.
    pub(super) folder: &'a Path,
    pub(super) parameters: &'a ProblemParameters,
    pub(super) columns: &'a SummaryColumns,
    pub(super) found: Loaded,
}

impl<'a> Loader<'a> {
    pub(super) fn new(
        scenario: &'a Value,
        path: &'a Path,
        folder: &'a Path,
        parameters: &'a ProblemParameters,
        columns: &'a SummaryColumns,
    ) -> Self {
        let found = Loaded {
            rigs: Vec::new(),
            hits: Vec::new(),
            quantities: Vec::new(),
            observations: Vec::new(),
            stiffness: Vec::new(),
            about: Vec::new(),
            notices: Vec::new(),
            blocks: 0,
        };
        Self { scenario, path, folder, parameters, columns, found }
    }

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
            DataSpec::Analysis { file, set, features, floor, .. } => {
                self.check_floor(&place, floor)?;
                for feature in features {
                    self.column(&place, feature)?;
                }
                let path = self.folder.join(file);
                let (hits, left_out) = data_files::analysed_hits(&path, features)?;
                if left_out > 0 {
                    let text = format!(
                        "{}: {left_out} hits that were not averaged left out",
                        path.display()
                    );
                    self.found.notices.push(text);
                }
                for hit in &hits {
                    self.hit_features(&path.display().to_string(), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Frf { file, hit, band_hz, spread, points, .. } => {
                check_band(&place, *band_hz)?;
                let path = self.folder.join(file);
                let lines = data_files::frf(&path, *band_hz, *points)?;
                let force_source = ForceSource::Spec(hit);
                let simulated = self.add_hit(&place, &name, &[], force_source)?;
                self.receptance(&place, &name, simulated, &lines, |_| *spread)
            }
            DataSpec::Backbone { file, index, hit, spread, .. } => {
                let path = self.folder.join(file);
                let points = data_files::backbone(&path, *index)?;
                let simulated = self.add_hit(&place, &name, &[], ForceSource::Spec(hit))?;
                self.found.hits[simulated].backbone = true;
                let block = self.next_block();
                for (amplitude, frequency) in points {
                    let quantity = ObservedQuantity::Backbone { hit: simulated, amplitude };
                    let deviation = spread.of(frequency);
                    let about = ObservationLabel {
                        data: name.clone(),
                        feature: "backbone.frequency_hz".to_owned(),
                        at: Some(amplitude),
                    };
                    self.push(&place, block, quantity, about, (frequency, deviation))?;
                }
                Ok(())
            }
            DataSpec::Records { files, force, response, set, band_hz, spread, .. } => {
                check_band(&place, *band_hz)?;
                let files: Vec<PathBuf> = files.iter().map(|file| self.folder.join(file)).collect();
                let channels = [force.as_deref(), response.as_deref()];
                for hit in records::hits(&files, channels, *band_hz)? {
                    let force_source = ForceSource::Record(&hit);
                    let simulated = self.add_hit(&place, &name, &[set], force_source)?;
                    self.receptance(&place, &name, simulated, &hit.lines, |noise| SpreadSpec {
                        absolute: spread.absolute.hypot(noise),
                        ..*spread
                    })?;
                }
                Ok(())
            }
            DataSpec::Stiffness { law, points, spread } => {
                self.stiffness(&place, &name, law, points, *spread)
            }
            DataSpec::Ratio { feature, numerator, denominator, value, standard_deviation } => {
                let column = self.column(&place, feature)?;
                let above = self.add_hit(&place, &name, &[], ForceSource::Spec(numerator))?;
                let below = self.add_hit(&place, &name, &[], ForceSource::Spec(denominator))?;
                let quantity = ObservedQuantity::Ratio { hits: [above, below], column };
                let block = self.next_block();
                let feature = format!("ratio of {feature}");
                let about = ObservationLabel { data: name, feature, at: numerator.force_peak_n };
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
        DataSpec::Stiffness { .. } => (None, "stiffness"),
        DataSpec::Ratio { .. } => (None, "ratio"),
    };
    name.cloned().unwrap_or_else(|| format!("{kind} {}", index + 1))
}

/// Checks a scenario.
pub(super) fn check_scenario(scenario: &Value, path: &Path) -> Result<(), IdentificationError> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let diagnostics = validate_json(scenario, folder);
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
    IdentificationError::UnnamedLaw { known: law_names(scenario) }
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
