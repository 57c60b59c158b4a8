//! Records of hits: the force as load of the model, and the receptance to compare with.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, MeasurementSource, Origin, Record, Samples,
};
use asperity_signal::{
    Complex64, HitRecord, Offset, Pulse, QualityOptions, ResponseKind, quality_issues,
    transform_pair_at, white_density,
};

use crate::data_files::ReceptanceLine;
use crate::error::IdentificationError;
use crate::force_noise::ForceNoise;
use crate::problem::{RecordRef, RecordSpec};
use asperity_experiment::{AnalysisOptions, for_each_hit, input_files};

/// Largest number of lines of a receptance.
const MAX_LINES: f64 = 60.0;

/// Time kept on both sides of the pulse \[s\]; the force is zero elsewhere.
const MARGIN_S: f64 = 0.5e-3;

/// The last tenth of a hit gives the noise.
const TAIL: usize = 10;

/// A measured hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RecordedHit {
    /// Times \[s\] from the first sample, and the force there \[N\].
    pub(super) time_s: Vec<f64>,
    pub(super) force_n: Vec<f64>,
    /// Length of the record \[s\].
    pub(super) duration_s: f64,
    /// Its receptance, and the transform of the force \[N s\] there.
    pub(super) lines: Vec<(ReceptanceLine, Complex64)>,
    /// Noise of the force.
    pub(super) noise: ForceNoise,
}

/// Times \[s\] and forces \[N\].
pub(super) type Force = (Vec<f64>, Vec<f64>);

/// Name of records in place.
const IN_PLACE: &str = "records";

/// The files that paths, folders and patterns name, relative to `folder`.
pub(super) fn record_files(
    folder: &Path,
    files: &[RecordRef],
) -> Result<Vec<PathBuf>, IdentificationError> {
    let named = files.iter().filter_map(|file| match file {
        RecordRef::Files(file) => Some(folder.join(file)),
        RecordRef::InPlace(_) => None,
    });
    let files: Vec<PathBuf> = named.collect();
    Ok(if files.is_empty() { files } else { input_files(&files)? })
}

/// The files, as [`record_files`] names them, and after them the records in place.
pub(super) fn record_sources(
    folder: &Path,
    files: &[RecordRef],
) -> Result<Vec<MeasurementSource>, IdentificationError> {
    let in_place = files.iter().filter_map(|file| match file {
        RecordRef::Files(_) => None,
        RecordRef::InPlace(record) => Some(in_place(record)),
    });
    let records: Vec<Record> = in_place.collect();
    let mut sources: Vec<MeasurementSource> =
        record_files(folder, files)?.into_iter().map(Into::into).collect();
    if !records.is_empty() {
        sources.push(MeasurementSource::Records { name: IN_PLACE.into(), records });
    }
    Ok(sources)
}

fn in_place(record: &RecordSpec) -> Record {
    let channels = record.channels.iter().map(|channel| Channel {
        name: channel.name.clone(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(&channel.unit),
        abscissa: Abscissa::even_time(0.0, record.sample_rate_hz),
        samples: Samples::Real(channel.data.iter().map(|x| x.unwrap_or(f64::NAN)).collect()),
        origin: Origin::default(),
    });
    Record { channels: channels.collect(), ..Record::default() }
}

/// The valid hits of some records, with their receptances in a band \[Hz\], and words about each of the others.
pub(super) fn hits(
    files: &[MeasurementSource],
    options: &AnalysisOptions,
    band: [f64; 2],
) -> Result<(Vec<RecordedHit>, Vec<String>), IdentificationError> {
    let (mut found, mut left_out, mut number) = (Vec::new(), Vec::new(), 0);
    for_each_hit(files, options, &mut |hit, kinds| {
        number += 1;
        let Some(kind) = kinds.first() else { return };
        match recorded(hit, *kind, band) {
            Ok(hit) => found.push(hit),
            Err(why) => left_out.push(format!("hit {number} ({why})")),
        }
    })?;
    if found.is_empty() {
        return Err(IdentificationError::File {
            path: files.first().map(|file| file.name().to_owned()).unwrap_or_default(),
            problem: match &left_out[..] {
                [] => "no hit was found".to_owned(),
                all => format!("no valid hit was found: {}", all.join(", ")),
            },
            expected: "records with hits that are neither double nor overloaded",
        });
    }
    Ok((found, left_out))
}

/// The hit if it is valid, or why it is not.
fn recorded(
    mut hit: HitRecord,
    route: ResponseKind,
    band: [f64; 2],
) -> Result<RecordedHit, String> {
    let rate = hit.sample_rate_hz;
    let issues = quality_issues(&hit, &QualityOptions::default());
    if let Some(issue) = issues.iter().find(|issue| issue.is_disqualifying()) {
        return Err(issue.to_string());
    }
    let ((time_s, force_n), force_noise) = cut_force(&mut hit).ok_or("no pulse of the force")?;
    let response = hit.responses.first().ok_or("no response")?;
    let duration_s = hit.force.len() as f64 / rate;
    let spacing = (1.0 / duration_s).max((band[1] - band[0]) / MAX_LINES);
    let count = ((band[1] - band[0]) / spacing).floor() as usize + 1;
    let noise = white_density(&response[response.len() - response.len() / TAIL..], rate);
    // Each part of a transform over a time T of noise with one-sided density S has variance T S / 4.
    let part = (0.25 * duration_s * noise.unwrap_or(0.0)).sqrt();
    let lines = (0..count).map(|n| {
        let frequency_hz = band[0] + n as f64 * spacing;
        let (x, f) = transform_pair_at(response, &hit.force, rate, frequency_hz);
        let to_displacement = to_displacement(route, frequency_hz);
        let line = ReceptanceLine {
            frequency_hz,
            value: to_displacement * x / f,
            deviation: to_displacement.norm() * part / f.norm(),
        };
        (line, f)
    });
    let lines = lines.filter(|(line, _)| line.value.is_finite()).collect();
    Ok(RecordedHit { time_s, force_n, duration_s, lines, noise: force_noise })
}

/// Times \[s\] from the first sample of a hit to the end of its pulse, and the force there \[N\]; in the hit the
/// force loses its offset and is set to zero outside the pulse.
pub(super) fn force_of(hit: &mut HitRecord) -> Option<Force> {
    cut_force(hit).map(|(force, _)| force)
}

/// As [`force_of`], with the noise of the force.
fn cut_force(hit: &mut HitRecord) -> Option<(Force, ForceNoise)> {
    let rate = hit.sample_rate_hz;
    if let Some(offset) = Offset::at_rest(&hit.force) {
        offset.remove(&mut hit.force);
    }
    let pulse = Pulse::of(&hit.force, rate)?;
    let (begin, end) = (pulse.base_s.0 - MARGIN_S, pulse.base_s.1 + MARGIN_S);
    let count = hit.force.len();
    let first = ((begin * rate).ceil().max(0.0) as usize).min(count);
    let kept = first..((end * rate).floor() as usize + 1).clamp(first, count);
    let noise = ForceNoise::of(&hit.force, kept.clone(), TAIL, rate);
    hit.force[..kept.start].fill(0.0);
    hit.force[kept.end..].fill(0.0);
    let last = ((end * rate).ceil() as usize + 1).min(hit.force.len()).max(2);
    let time_s = (0..last).map(|n| n as f64 / rate).collect();
    Some(((time_s, hit.force[..last].to_vec()), noise))
}

/// Factor from the transform of the response to the transform of the displacement.
fn to_displacement(route: ResponseKind, frequency_hz: f64) -> Complex64 {
    Complex64::new(0.0, TAU * frequency_hz).powi(-route.derivatives())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    /// Three hits of a mode at 300 Hz a second apart, the second with two impacts: it is left out in words.
    #[test]
    fn a_hit_that_is_left_out_is_named() {
        let (rate, omega) = (10_000.0, TAU * 300.0);
        let (mut u, mut v) = (0.0, 0.0);
        let mut sample = |n: usize| {
            let time = n as f64 / rate;
            let pulse = |at: f64| {
                let since = (time - at) / 2e-3;
                if (0.0..1.0).contains(&since) { 20.0 * (since * TAU / 2.0).sin() } else { 0.0 }
            };
            let force: f64 = [0.1, 1.1, 1.12, 2.1].map(pulse).iter().sum();
            let acceleration = force - 0.04 * omega * v - omega * omega * u;
            v += acceleration / rate;
            u += v / rate;
            (force, acceleration)
        };
        let (force, response): (Vec<f64>, Vec<f64>) = (0..30_000).map(&mut sample).unzip();
        let channel = |name: &str, unit: &str, samples: Vec<f64>| Channel {
            name: name.to_owned(),
            quantity: ChannelQuantity::Unknown,
            unit: ChannelUnit::of_text(unit),
            abscissa: Abscissa::even_time(0.0, rate),
            samples: Samples::Real(samples),
            origin: Origin::default(),
        };
        let channels = vec![channel("force", "N", force), channel("top", "m/s^2", response)];
        let records = vec![Record { channels, ..Record::default() }];
        let source = MeasurementSource::Records { name: IN_PLACE.into(), records };
        let (found, left_out) =
            hits(&[source], &AnalysisOptions::default(), [200.0, 400.0]).unwrap();
        assert_eq!((found.len(), left_out.len()), (2, 1), "{left_out:?}");
        assert!(left_out[0].starts_with("hit 2 (double hit:"), "{left_out:?}");
    }
}
