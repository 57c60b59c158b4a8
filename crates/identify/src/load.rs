//! From the data of a problem to strikes, rows and observations.

mod strikes;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use asperity_inference::Observation;
use serde_json::Value;

use crate::error::ProblemError;
use crate::files;
use crate::problem::{Changes, DataSpec, HitSpec, SpreadSpec, StrikeSpec};
use crate::records;
use crate::row::{Columns, Part, Row};
use crate::strike::{Rig, Strike};
use crate::unknowns::Unknowns;
use asperity_scenario::{InvalidDocument, four_digits, validate_json};
use asperity_study::quantity::Quantity;
use strikes::StrikeDrive;

/// Standard deviations that two values of one feature of one hit may be apart.
const MOST_APART: f64 = 10.0;

/// Everything that data ask of a model.
#[derive(Debug)]
pub(super) struct Loaded {
    pub(super) rigs: Vec<Rig>,
    pub(super) strikes: Vec<Strike>,
    pub(super) rows: Vec<Row>,
    pub(super) observations: Vec<Observation>,
    pub(super) stiffness: Vec<(String, f64)>,
    /// For each observation, the feature and the peak force \[N\], for tables and figures.
    pub(super) about: Vec<About>,
    /// What was taken or left out.
    pub(super) notices: Vec<String>,
    /// The blocks that are hits: they are left out one by one.
    blocks: usize,
}

/// What an observation is about.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct About {
    /// Name of the data.
    pub(super) data: String,
    /// The feature.
    pub(super) feature: String,
    /// Peak force as measured \[N\], frequency \[Hz\], amplitude \[m\] or pressure \[Pa\].
    pub(super) at: Option<f64>,
}

/// What data are loaded into.
pub(super) struct Loader<'a> {
    /// The scenario, with the modal method.
    pub(super) scenario: &'a Value,
    /// The scenario's file.
    pub(super) path: &'a Path,
    /// Folder of the problem.
    pub(super) folder: &'a Path,
    pub(super) unknowns: &'a Unknowns,
    pub(super) columns: &'a Columns,
    pub(super) found: Loaded,
}

impl<'a> Loader<'a> {
    pub(super) fn new(
        scenario: &'a Value,
        path: &'a Path,
        folder: &'a Path,
        unknowns: &'a Unknowns,
        columns: &'a Columns,
    ) -> Self {
        let found = Loaded {
            rigs: Vec::new(),
            strikes: Vec::new(),
            rows: Vec::new(),
            observations: Vec::new(),
            stiffness: Vec::new(),
            about: Vec::new(),
            notices: Vec::new(),
            blocks: 0,
        };
        Self { scenario, path, folder, unknowns, columns, found }
    }

    /// Loads the data at `index` of the problem.
    pub(super) fn load(&mut self, index: usize, data: &DataSpec) -> Result<(), ProblemError> {
        let name = name_of(index, data);
        let place = format!("/data/{index}");
        match data {
            DataSpec::Hits { set, floor, hits, .. } => {
                self.check_floor(&place, floor)?;
                for (number, hit) in hits.iter().enumerate() {
                    self.hit(&format!("{place}/hits/{number}"), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Analysis { file, set, features, floor, .. } => {
                self.check_floor(&place, floor)?;
                for feature in features {
                    self.column(&place, feature)?;
                }
                let path = self.folder.join(file);
                let (hits, left_out) = files::analysed_hits(&path, features)?;
                if left_out > 0 {
                    let text = format!(
                        "{}: {left_out} hits that were not averaged left out",
                        path.display()
                    );
                    self.found.notices.push(text);
                }
                for hit in &hits {
                    self.hit(&path.display().to_string(), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Frf { file, hit, band_hz, spread, points, .. } => {
                check_band(&place, *band_hz)?;
                let path = self.folder.join(file);
                let lines = files::frf(&path, *band_hz, *points)?;
                let drive = StrikeDrive::Spec(hit);
                let strike = self.strike(&place, &name, &[], drive)?;
                self.receptance(&place, &name, strike, &lines, |_| *spread)
            }
            DataSpec::Backbone { file, index, hit, spread, .. } => {
                let path = self.folder.join(file);
                let points = files::backbone(&path, *index)?;
                let strike = self.strike(&place, &name, &[], StrikeDrive::Spec(hit))?;
                self.found.strikes[strike].backbone = true;
                let block = self.next_block();
                for (amplitude, frequency) in points {
                    let row = Row::Backbone { strike, amplitude };
                    let deviation = spread.of(frequency);
                    let about = About {
                        data: name.clone(),
                        feature: "backbone.frequency_hz".to_owned(),
                        at: Some(amplitude),
                    };
                    self.push(&place, block, row, about, (frequency, deviation))?;
                }
                Ok(())
            }
            DataSpec::Records { files, force, response, set, band_hz, spread, .. } => {
                check_band(&place, *band_hz)?;
                let files: Vec<PathBuf> = files.iter().map(|file| self.folder.join(file)).collect();
                let channels = [force.as_deref(), response.as_deref()];
                for hit in records::hits(&files, channels, *band_hz)? {
                    let drive = StrikeDrive::Record(&hit);
                    let strike = self.strike(&place, &name, &[set], drive)?;
                    self.receptance(&place, &name, strike, &hit.lines, |noise| SpreadSpec {
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
                let above = self.strike(&place, &name, &[], StrikeDrive::Spec(numerator))?;
                let below = self.strike(&place, &name, &[], StrikeDrive::Spec(denominator))?;
                let row = Row::Ratio { strikes: [above, below], column };
                let block = self.next_block();
                let feature = format!("ratio of {feature}");
                let about = About { data: name, feature, at: numerator.force_peak_n };
                self.push(&place, block, row, about, (*value, *standard_deviation))
            }
        }
    }

    fn stiffness(
        &mut self,
        place: &str,
        data: &str,
        law: &str,
        points: &[[f64; 2]],
        spread: SpreadSpec,
    ) -> Result<(), ProblemError> {
        if self.scenario.pointer("/laws").and_then(|laws| laws.get(law)).is_none() {
            return Err(no_law(self.scenario, law));
        }
        for &[pressure, stiffness] in points {
            for (quantity, value) in [("pressure [Pa]", pressure), ("stiffness [Pa/m]", stiffness)]
            {
                if !(value.is_finite() && value >= 0.0) {
                    let (place, expected) = (place.to_owned(), "a finite number, not negative");
                    return Err(ProblemError::Value { place, quantity, value, expected });
                }
            }
            let row = Row::Stiffness { place: self.found.stiffness.len() };
            self.found.stiffness.push((law.to_owned(), pressure));
            let block = self.next_block();
            let feature = format!("stiffness of {law}");
            let about = About { data: data.to_owned(), feature, at: Some(pressure) };
            self.push(place, block, row, about, (stiffness, spread.of(stiffness)))?;
        }
        Ok(())
    }

    fn hit(
        &mut self,
        place: &str,
        data: &str,
        set: &Changes,
        floor: &BTreeMap<String, SpreadSpec>,
        hit: &HitSpec,
    ) -> Result<(), ProblemError> {
        let spec = StrikeSpec { force_peak_n: hit.force_peak_n, set: hit.set.clone() };
        let strike = self.strike(place, data, &[set], StrikeDrive::Spec(&spec))?;
        let block = self.next_block();
        for (feature, measured) in &hit.features {
            let column = self.column(place, feature)?;
            let (value, own) = measured.parts();
            let least = floor.get(feature).map_or(0.0, |floor| floor.of(value));
            let deviation = own.unwrap_or(0.0).hypot(least);
            if deviation == 0.0 {
                let (place, feature) = (place.to_owned(), feature.clone());
                return Err(ProblemError::NoDeviation { place, feature });
            }
            let about =
                About { data: data.to_owned(), feature: feature.clone(), at: hit.force_peak_n };
            let row = Row::Feature { strike, column };
            self.push(place, block, row, about, (value, deviation))?;
        }
        Ok(())
    }

    /// Rows for the receptance at some lines `(frequency, real, imaginary, noise)`.
    fn receptance(
        &mut self,
        place: &str,
        data: &str,
        strike: usize,
        lines: &[files::Line],
        spread: impl Fn(f64) -> SpreadSpec,
    ) -> Result<(), ProblemError> {
        let block = self.next_block();
        let largest = lines.iter().map(|line| line.value.norm()).fold(0.0, f64::max);
        for line in lines {
            let at = self.found.strikes[strike].frequencies.len();
            self.found.strikes[strike].frequencies.push(line.frequency_hz);
            for (part, word) in [(Part::Real, "real"), (Part::Imaginary, "imaginary")] {
                let row = Row::Receptance { strike, place: at, part };
                let about = About {
                    data: data.to_owned(),
                    feature: format!("receptance, {word} part"),
                    at: Some(line.frequency_hz),
                };
                let deviation = spread(line.deviation).of(largest);
                self.push(place, block, row, about, (part.of(line.value), deviation))?;
            }
        }
        Ok(())
    }

    fn next_block(&mut self) -> usize {
        self.found.blocks += 1;
        self.found.blocks - 1
    }

    fn push(
        &mut self,
        place: &str,
        block: usize,
        row: Row,
        about: About,
        (value, deviation): (f64, f64),
    ) -> Result<(), ProblemError> {
        for (known, earlier) in self.found.rows.iter().zip(&self.found.observations) {
            let apart = (earlier.value - value).abs() / earlier.standard_deviation.hypot(deviation);
            if *known == row && apart > MOST_APART {
                return Err(ProblemError::Contradictory {
                    place: place.to_owned(),
                    feature: about.feature,
                    first: earlier.value,
                    second: value,
                    apart,
                });
            }
        }
        let at = about.at.map_or_else(String::new, |at| format!(" at {}", four_digits(at)));
        self.found.rows.push(row);
        self.found.observations.push(Observation {
            label: format!("{}: {}{at}", about.data, about.feature),
            block,
            value,
            standard_deviation: deviation,
        });
        self.found.about.push(about);
        Ok(())
    }

    fn column(&self, place: &str, feature: &str) -> Result<usize, ProblemError> {
        // Data need exact derivatives.
        let known =
            Quantity::of_name(feature).is_some_and(|(quantity, _)| quantity.has_derivative());
        self.columns.find(feature).filter(|_| known).ok_or_else(|| {
            let all = Quantity::ALL.iter().copied().filter(|quantity| quantity.has_derivative());
            ProblemError::Feature {
                place: place.to_owned(),
                feature: feature.to_owned(),
                known: all.map(Quantity::key).collect::<Vec<_>>().join(", "),
            }
        })
    }

    fn check_floor(
        &self,
        place: &str,
        floor: &BTreeMap<String, SpreadSpec>,
    ) -> Result<(), ProblemError> {
        floor
            .keys()
            .try_for_each(|feature| self.column(&format!("{place}/floor"), feature).map(|_| ()))
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

/// Every problem of a scenario.
pub(super) fn check_scenario(scenario: &Value, path: &Path) -> Result<(), ProblemError> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let diagnostics = validate_json(scenario, folder);
    if diagnostics.is_empty() {
        return Ok(());
    }
    Err(InvalidDocument { path: path.to_owned(), diagnostics }.into())
}

/// The error of a law that is not there.
pub(super) fn no_law(scenario: &Value, law: &str) -> ProblemError {
    let laws = scenario.pointer("/laws").and_then(Value::as_object);
    let known: Vec<&str> =
        laws.into_iter().flat_map(|laws| laws.keys()).map(String::as_str).collect();
    ProblemError::NoLaw { law: law.to_owned(), known: known.join(", ") }
}

fn check_band(place: &str, [low, high]: [f64; 2]) -> Result<(), ProblemError> {
    if low > 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let (quantity, expected) = ("band_hz", "two positive frequencies, the lower first");
    let value = if low > 0.0 { high } else { low };
    Err(ProblemError::Value { place: place.to_owned(), quantity, value, expected })
}
