//! Simulated hits and observations of the data of a problem.

mod hits;
mod observations;

use std::borrow::Cow;
use std::path::PathBuf;

use crate::analysed_hits::{AnalysedHits, analysed_hits, read_analysis};
use crate::built_model::{Loader, ObservationLabel};
use crate::data_files::{self, TableSource};
use crate::error::IdentificationError;
use crate::observed_quantity::ObservedQuantity;
use crate::problem::{AnalysisRef, DataSpec, SpreadSpec};
use crate::records;
use crate::stepped_sine::read_table;
use asperity_scenario::four_digits;

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
            DataSpec::Analysis { file, set, features, repeatability, floor, .. } => {
                self.check_floor(&place, floor)?;
                for feature in features {
                    self.column(&place, feature)?;
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
                let lines = data_files::frf(&table(file), *band_hz, *points)?;
                let simulated = self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n)?;
                self.receptance(&place, &name, simulated, &lines, |_| *spread)
            }
            DataSpec::Backbone { file, index, hit, spread, damping_spread, .. } => {
                let points = data_files::backbone(&table(file), *index, damping_spread.is_some())?;
                let simulated = self.add_hit(&place, &name, &[&hit.set], hit.force_peak_n)?;
                self.backbone(&place, &name, simulated, &points, (*spread, *damping_spread))
            }
            DataSpec::Records { files, force, response, set, band_hz, spread, .. } => {
                check_band(&place, *band_hz)?;
                let files: Vec<PathBuf> = files.iter().map(|file| folder.join(file)).collect();
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

fn check_band(place: &str, [low, high]: [f64; 2]) -> Result<(), IdentificationError> {
    if low > 0.0 && high > low && high.is_finite() {
        return Ok(());
    }
    let (quantity, expected) = ("band_hz", "two positive frequencies, the lower first");
    let value = if low > 0.0 { high } else { low };
    Err(IdentificationError::Value { place: place.to_owned(), quantity, value, expected })
}
