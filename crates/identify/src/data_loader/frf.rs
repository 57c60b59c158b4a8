//! Receptances of one hit or an average, from tables and from files of other programs: their parts, or their
//! features.

use std::collections::BTreeMap;
use std::path::Path;

use asperity_experiment::{ChannelSelector, FrfOptions, read_frf};
use asperity_signal::{Frf, FrfForm, SECOND_HARMONIC_WINDOW, SampledPeak};
use asperity_simulation::quantity::Quantity;

use super::check_band;
use super::observations::deviations;
use crate::built_model::Loader;
use crate::data_files::{self, ReceptanceLine, TableSource};
use crate::error::IdentificationError;
use crate::problem::{DataSpec, HitSpec, Measured, SpreadSpec, TableRef, Uncertain};

/// Endings of tables; other files are measurements.
const TABLES: [&str; 3] = ["csv", "txt", "tsv"];

/// Features of a receptance.
const FEATURES: [Quantity; 5] = [
    Quantity::FundamentalFrequency,
    Quantity::FundamentalReceptance,
    Quantity::SecondHarmonicFrequency,
    Quantity::SecondHarmonicReceptance,
    Quantity::HarmonicRatio,
];

impl Loader<'_> {
    /// Loads the parts of a receptance in a band, or its features where they are asked for.
    pub(super) fn frf(
        &mut self,
        place: &str,
        name: &str,
        data: &DataSpec,
    ) -> Result<(), IdentificationError> {
        let DataSpec::Frf { file, hit, band_hz, spread, points, features, floor, .. } = data else {
            return Ok(());
        };
        check_band(place, *band_hz)?;
        self.check_floor(place, floor)?;
        let folder = self.problem.document.folder();
        let band = if features.is_empty() { *band_hz } else { [0.0, f64::INFINITY] };
        let most = if features.is_empty() { *points } else { usize::MAX };
        let lines = match file {
            TableRef::File(file) if !is_table(Path::new(file)) => {
                let path = folder.join(file);
                let lines = self.measured_lines(&path, data)?;
                data_files::some_lines(&path, lines.into_iter(), band, most)?
            }
            table => data_files::frf(&TableSource::new(place, folder, table), band, most)?,
        };
        let with_noise = |noise: f64| SpreadSpec {
            absolute: spread.absolute.hypot(noise),
            relative: spread.relative,
        };
        if features.is_empty() {
            let simulated = self.add_hit(place, name, &[&hit.set], hit.force_peak_n)?;
            let own = deviations(&lines, with_noise);
            return self.receptance(place, name, simulated, &lines, &own);
        }
        let mut found = self.frf_features(place, &lines, (*band_hz, features), with_noise)?;
        // The distance of the lines alone is no standard deviation.
        if spread == &SpreadSpec::default() && lines.iter().all(|line| line.deviation == 0.0) {
            for (feature, measured) in &mut found {
                if !floor.contains_key(feature) {
                    *measured = Measured::Alone(measured.parts().0);
                }
            }
        }
        let hit = HitSpec { force_peak_n: hit.force_peak_n, set: hit.set.clone(), features: found };
        self.hit_features(place, name, &serde_json::Map::new(), floor, &hit)
    }

    /// The lines of a function in a file of another program.
    fn measured_lines(
        &mut self,
        path: &Path,
        data: &DataSpec,
    ) -> Result<Vec<ReceptanceLine>, IdentificationError> {
        let DataSpec::Frf { function, unit, averages, .. } = data else { return Ok(Vec::new()) };
        let options = FrfOptions {
            function: function.as_deref().map(ChannelSelector::from),
            unit: unit.clone(),
            averages: *averages,
        };
        let found = read_frf(path, &options)?;
        if found.coherence.is_some() && averages.is_none() {
            self.built.notices.push(format!(
                "{}: the coherence of `{}` is not used; \"averages\", the number of averages, makes \
                 standard deviations of it",
                path.display(),
                found.name.trim()
            ));
        }
        let receptance = found.receptance;
        let deviation = found.deviation.unwrap_or_default();
        let all = receptance.frequency_hz.iter().zip(&receptance.values).enumerate();
        let lines = all.map(|(at, (&frequency_hz, &value))| ReceptanceLine {
            frequency_hz,
            value,
            deviation: deviation.get(at).copied().unwrap_or(0.0),
        });
        Ok(lines.filter(|line| line.value.is_finite() && line.deviation.is_finite()).collect())
    }

    /// The features of a receptance with their standard deviations from those of its lines; a second harmonic
    /// that does not stand out is left out with a notice.
    fn frf_features(
        &mut self,
        place: &str,
        lines: &[ReceptanceLine],
        (band, wanted): ([f64; 2], &[String]),
        spread: impl Fn(f64) -> SpreadSpec,
    ) -> Result<BTreeMap<String, Measured>, IdentificationError> {
        for feature in wanted {
            let quantity = Quantity::of_name(feature).map(|found| found.0);
            if !quantity.is_some_and(|quantity| FEATURES.contains(&quantity)) {
                return Err(IdentificationError::Feature {
                    place: place.to_owned(),
                    feature: feature.clone(),
                    known: FEATURES.map(Quantity::key).join(", "),
                });
            }
        }
        let inside = lines.iter().filter(|line| (band[0]..=band[1]).contains(&line.frequency_hz));
        let largest = inside.map(|line| line.value.norm()).fold(0.0, f64::max);
        let deviation: Vec<f64> =
            lines.iter().map(|line| spread(line.deviation).of(largest)).collect();
        let receptance = Frf {
            frequency_hz: lines.iter().map(|line| line.frequency_hz).collect(),
            values: lines.iter().map(|line| line.value).collect(),
            form: FrfForm::Receptance,
        };
        let peak = |low: f64, high: f64| SampledPeak::of(&receptance, &deviation, (low, high));
        let first = peak(band[0], band[1]).ok_or_else(|| IdentificationError::NoPeakInBand {
            place: place.to_owned(),
            low_hz: band[0],
            high_hz: band[1],
        })?;
        let window = SECOND_HARMONIC_WINDOW;
        let (low, high) = (window.0 * first.frequency_hz, window.1 * first.frequency_hz);
        let second = peak(low, high);
        let relative = |peak: &SampledPeak| peak.magnitude_deviation / peak.magnitude;
        let value = |quantity: Quantity| {
            Some(match quantity {
                Quantity::FundamentalFrequency => {
                    (first.frequency_hz, first.frequency_deviation_hz)
                }
                Quantity::FundamentalReceptance => (first.magnitude, first.magnitude_deviation),
                Quantity::SecondHarmonicFrequency => {
                    (second?.frequency_hz, second?.frequency_deviation_hz)
                }
                Quantity::SecondHarmonicReceptance => {
                    (second?.magnitude, second?.magnitude_deviation)
                }
                _ => {
                    let ratio = second?.magnitude / first.magnitude;
                    (ratio, ratio * relative(&first).hypot(relative(&second?)))
                }
            })
        };
        let mut found = BTreeMap::new();
        for feature in wanted {
            let quantity = Quantity::of_name(feature).map(|found| found.0);
            match quantity.and_then(value) {
                Some((value, standard_deviation)) if standard_deviation > 0.0 => {
                    let measured = Uncertain { value, standard_deviation };
                    found.insert(feature.clone(), Measured::Uncertain(measured));
                }
                Some((value, _)) => {
                    found.insert(feature.clone(), Measured::Alone(value));
                }
                None => self.built.notices.push(format!(
                    "{place}: {feature} is left out: no peak stands out between {low:.1} and {high:.1} Hz"
                )),
            }
        }
        Ok(found)
    }
}

/// True for a file with a table.
fn is_table(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_none_or(|ending| TABLES.contains(&ending.as_str()))
}
