//! Simulated hits and observations of the data of a problem.

mod frf;
mod hits;
mod observations;

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use asperity_experiment::{
    AnalysisOptions, ChannelSelector, ResponseChoice, RigFault, RigSettings,
};
use serde_json::{Map, Value, json};

use crate::analysed_hits::{AnalysedHits, analysed_hits, read_analysis};
use crate::built_model::{Loader, ObservationLabel};
use crate::data_files::{self, TableSource};
use crate::error::IdentificationError;
use crate::measured_forces::{HitSource, forces_of};
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{AnalysisRef, DataSpec, PulseSpec, RigRef};
use crate::problem_parameters::is_within;
use crate::records::{self, Force};
use crate::stepped_sine::read_table;
use asperity_scenario::{Document, four_digits, schema_of};

impl Loader<'_> {
    /// Loads the data at `index` of the problem.
    pub(super) fn load(
        &mut self,
        index: usize,
        data: &DataSpec,
    ) -> Result<(), IdentificationError> {
        let name = data.name_or_kind(index);
        let place = format!("/data/{index}");
        let folder = self.problem.document.folder();
        let table = |file| TableSource::new(&place, folder, file);
        match data {
            DataSpec::Hits { set, floor, hits, .. } => {
                self.check_floor(&place, floor)?;
                for (number, hit) in hits.iter().enumerate() {
                    self.hit_features(&format!("{place}/hits/{number}"), &name, set, floor, hit)?;
                }
                Ok(())
            }
            DataSpec::Analysis { .. } => self.analysis(&place, &name, data),
            DataSpec::Frf { .. } => self.frf(&place, &name, data),
            DataSpec::Backbone { file, index, hit, spread, damping_spread, .. } => {
                let points = data_files::backbone(&table(file), *index, damping_spread.is_some())?;
                let simulated = self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n)?;
                self.backbone(&place, &name, simulated, &points, (*spread, *damping_spread))
            }
            DataSpec::Records { files, rig, force, response, set, band_hz, spread, .. } => {
                check_band(&place, *band_hz)?;
                let files = records::record_sources(folder, files)?;
                let mut options = match rig {
                    Some(rig) => rig_options(&place, folder, rig)?,
                    None => AnalysisOptions::default(),
                };
                if let Some(force) = force {
                    options.force = Some(ChannelSelector::from(force.as_str()));
                }
                if let Some(response) = response {
                    let response = ChannelSelector::from(response.as_str());
                    options.responses = ResponseChoice::of(&[response]);
                }
                let (hits, left_out) = records::hits(&files, &options, *band_hz)?;
                if !left_out.is_empty() {
                    let words = format!("{name}: left out {}", left_out.join(", "));
                    self.built.notices.push(words);
                }
                for hit in hits {
                    self.recorded_receptance(&place, &name, set, *spread, &hit)?;
                }
                Ok(())
            }
            DataSpec::SteppedSine { file, set, spread, phase_spread_rad, harmonics, .. } => {
                let rows = read_table(&table(file))?;
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

impl Loader<'_> {
    /// Loads the hits of an analysis.
    fn analysis(
        &mut self,
        place: &str,
        name: &str,
        data: &DataSpec,
    ) -> Result<(), IdentificationError> {
        let DataSpec::Analysis {
            file, records, pulse, set, features, repeatability, floor, ..
        } = data
        else {
            return Ok(());
        };
        let folder = self.problem.document.folder();

        self.check_floor(place, floor)?;
        for feature in features {
            self.column(place, feature)?;
        }
        let (path, analysis) = match file {
            AnalysisRef::File(file) => {
                let path = folder.join(file);
                let analysis = Cow::Owned(read_analysis(&path)?);
                (path, analysis)
            }
            AnalysisRef::InPlace(analysis) => {
                (PathBuf::from(format!("{place}/file")), Cow::Borrowed(analysis))
            }
        };
        let AnalysedHits { hits, sources, left_out, scatter } =
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
        let forces = match pulse {
            PulseSpec::Measured => {
                let own = records.as_ref().map(|records| folder.join(records));
                let beside = path.parent().map(Path::to_owned);
                let folders = [own, beside, Some(folder.to_owned())];
                let folders: Vec<PathBuf> = folders.into_iter().flatten().collect();
                self.measured_forces(&path, &sources, &analysis, &folders)
            }
            PulseSpec::Scenario => vec![None; hits.len()],
        };
        for (hit, force) in hits.iter().zip(forces) {
            let place = path.display().to_string();
            self.analysed_features(&place, name, set, floor, (hit, force))?;
        }
        Ok(())
    }

    /// The measured forces of hits of an analysis, with notices about those that have none.
    fn measured_forces(
        &mut self,
        path: &Path,
        sources: &[Option<HitSource>],
        analysis: &Map<String, Value>,
        folders: &[PathBuf],
    ) -> Vec<Option<Force>> {
        let shape = self.built.forward.scenario.pointer("/excitation/kind");
        let shape = shape.and_then(Value::as_str).unwrap_or("none").to_owned();
        let mut pointers = self.built.forward.parameters.pointers();
        let none = vec![None; sources.len()];
        if let Some(unknown) = pointers.find(|pointer| is_within(pointer, "/excitation")) {
            let notice = format!(
                "{}: {unknown} is an unknown, so that the pulse of each hit is the scenario's ({shape}) with the measured peak; without it each hit has its measured force",
                path.display()
            );
            self.built.notices.push(notice);
            return none;
        }
        drop(pointers);
        let (forces, reasons) = forces_of(sources, analysis, folders);
        let without = forces.iter().filter(|force| force.is_none()).count();
        if without > 0 {
            let reason = match reasons.as_slice() {
                [] => "the analysis names no record".to_owned(),
                [only] => only.clone(),
                [first, rest @ ..] => format!("{first}, and {} others", rest.len()),
            };
            self.built.notices.push(format!(
                "{}: {without} of {} hits have no measured force ({reason}), and the scenario's pulse ({shape}) with the measured peak in its place; \"records\" names the folder of the records",
                path.display(),
                sources.len()
            ));
        }
        forces
    }
}

/// The options that the settings of a rig give.
fn rig_options(
    place: &str,
    folder: &Path,
    rig: &RigRef,
) -> Result<AnalysisOptions, IdentificationError> {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<RigSettings>);
    let document = match rig {
        RigRef::File(file) => Document::read(folder.join(file))?,
        RigRef::InPlace(settings) => {
            Document::parse(&json!(settings).to_string(), format!("{place}/rig"))?
        }
    };
    let settings: RigSettings = document.checked(&SCHEMA, Vec::new())?;
    settings.options().map_err(|faults| {
        let words = |fault: &RigFault| {
            format!("{}: {}, accepted: {}", fault.pointer, fault.found, fault.accepted)
        };
        IdentificationError::File {
            path: document.path().to_owned(),
            problem: faults.iter().map(words).collect::<Vec<_>>().join("; "),
            expected: "the settings of a rig, as asperity inspect writes them",
        }
    })
}

fn check_band(place: &str, [low, high]: [f64; 2]) -> Result<(), IdentificationError> {
    if low > 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let (quantity, expected) = ("band_hz", "two positive frequencies, the lower first");
    let value = if low > 0.0 { high } else { low };
    Err(IdentificationError::Value { place: place.to_owned(), quantity, value, expected })
}
