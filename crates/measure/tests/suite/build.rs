//! Channels and records to write, and files to read.

use std::path::PathBuf;

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Measurement, Origin, ReadOptions, Record,
    Samples, read, read_bytes,
};

/// A channel at `rate` hertz.
pub(crate) fn channel(name: &str, unit: &str, rate: f64, samples: Vec<f64>) -> Channel {
    let unit = ChannelUnit::of_text(unit);
    let quantity = unit.known().map_or(ChannelQuantity::of_name(name), |unit| unit.quantity());
    Channel {
        name: name.to_owned(),
        quantity,
        unit,
        abscissa: Abscissa::even_time(0.0, rate),
        samples: Samples::Real(samples),
        origin: Origin::default(),
    }
}

pub(crate) fn record(channels: Vec<Channel>) -> Record {
    Record { channels, ..Record::default() }
}

/// Reads bytes with default options.
pub(crate) fn parsed(bytes: impl AsRef<[u8]>) -> Measurement {
    read_bytes(bytes.as_ref(), &ReadOptions::default()).unwrap()
}

/// The error message of reading.
pub(crate) fn error_of(bytes: impl AsRef<[u8]>) -> String {
    read_bytes(bytes.as_ref(), &ReadOptions::default()).unwrap_err().to_string()
}

/// The real samples of a channel.
pub(crate) fn samples<'a>(record: &'a Record, name: &str) -> &'a [f64] {
    let named = record.named(name).unwrap_or_else(|| panic!("no channel `{name}`"));
    named.samples.real().unwrap()
}

/// A reference file of another program.
pub(crate) fn reference(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/reference/measure"))
        .join(name)
}

/// Reads such a file with default options.
pub(crate) fn read_reference(name: &str) -> Measurement {
    read(&reference(name), &ReadOptions::default()).unwrap()
}
