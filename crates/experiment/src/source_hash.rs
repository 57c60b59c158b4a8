//! SHA-256 of sources.

use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_measure::{Abscissa, Channel, MeasurementSource, Record, Samples};
use sha2::{Digest, Sha256};

use crate::error::AnalysisError;

/// SHA-256 of a source in hexadecimal: of the bytes of a file, or of names, units, axes and samples
/// (in their binary form, little endian) of records in memory; of its beginning once the analysis is
/// cancelled.
pub(crate) fn sha256(
    source: &MeasurementSource,
    cancelled: &AtomicBool,
) -> Result<String, AnalysisError> {
    let mut hash = Sha256::new();
    match source {
        MeasurementSource::File(path) => add_file(&mut hash, path, cancelled)
            .map_err(|source| AnalysisError::Io { path: path.clone(), source })?,
        MeasurementSource::Records { records, .. } => {
            for record in records {
                add_record(&mut hash, record);
            }
        }
    }
    let digest = hash.finalize();
    let nibbles = digest.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    Ok(nibbles.filter_map(|nibble| char::from_digit(nibble.into(), 16)).collect())
}

fn add_file(hash: &mut Sha256, path: &Path, cancelled: &AtomicBool) -> io::Result<()> {
    let mut file = std::fs::File::open(path)?;
    let mut buffer = vec![0; 1 << 16];
    while !cancelled.load(Ordering::Relaxed) {
        match file.read(&mut buffer)? {
            0 => break,
            length => hash.update(&buffer[..length]),
        }
    }
    Ok(())
}

fn add_record(hash: &mut Sha256, record: &Record) {
    hash.update((record.channels.len() as u64).to_le_bytes());
    for channel in &record.channels {
        add_channel(hash, channel);
    }
}

fn add_channel(hash: &mut Sha256, channel: &Channel) {
    // Lengths keep apart what follows each other.
    for text in [channel.name.as_str(), channel.unit.text()] {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    }
    match &channel.abscissa {
        Abscissa::Even { start, step, .. } => add_numbers(hash, [*start, *step].iter()),
        Abscissa::Uneven { values, .. } => add_numbers(hash, values.iter()),
    }
    match &channel.samples {
        Samples::Real(values) => add_numbers(hash, values.iter()),
        Samples::Complex(values) => {
            add_numbers(hash, values.iter().map(|value| &value.re));
            add_numbers(hash, values.iter().map(|value| &value.im));
        }
    }
}

fn add_numbers<'a>(hash: &mut Sha256, values: impl ExactSizeIterator<Item = &'a f64>) {
    hash.update((values.len() as u64).to_le_bytes());
    for value in values {
        hash.update(value.to_le_bytes());
    }
}
