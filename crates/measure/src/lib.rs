//! Files of measured hammer tests to samples with units, and back.
//!
//! Every reader returns [`Record`]s of [`Channel`]s that were sampled together, with their sample
//! rate and unit:
//!
//! ```text
//! x_n = factor * sample_n   [SI],   at   t_n = start + n * step   [s]
//! ```
//!
//! Information missing in a file is an explicit
//! state ([`ChannelUnit::Missing`]) or an error that names the field of [`ReadOptions`] to give; an
//! assumption of a reader is a [`Notice`]. Errors are [`MeasureError`]s with the file, the position
//! and the content expected there.
//!
//! Readers hold one block of samples at a time. Sizes announced in a header are checked against the
//! length of the file before memory is allocated.
//!
//! | module | contents |
//! |---|---|
//! | `channel`, `record`, `quantity`, `unit`, `sensitivity` | samples with axis and unit |
//! | `reader`, `options`, `source` | opening, options |
//! | `format`, `detection` | formats, and the format of a file by its content |
//! | `notice`, `error`, `rate` | assumptions, errors, whole sample rates |
//! | `uff` | universal files: datasets 58, 58b, 151, 164 |
//! | `text` | columns of numbers: CSV, TXT, LVM |
//! | `npy`, `npz`, `mat`, `arrays`, `number` | arrays of NumPy and MATLAB |
//! | `time_match` | time vectors and their channels |
//! | `wav` | RIFF WAVE |
//! | `hdf5` | HDF5 and MATLAB 7.3, with the feature `hdf5` |
//! | `tdms` | TDMS of LabVIEW to channels with axis and unit |
//! | [`tdms_file`] | TDMS to objects, properties and numbers, without units |
//! | `memory`, `measurement_source` | records in memory, and sources of either kind |
//! | `write`, `whole_file` | writing of complete files |
//!
//! The crate contains no mechanics and no signal processing.
//!
//! ```
//! use asperity_measure::{ChannelQuantity, ReadOptions, read_bytes};
//!
//! let file = "time_s,hammer (N),acc (g)\n0,0,0\n0.001,10,0.5\n0.002,0,0.25\n";
//! let measured = read_bytes(file.as_bytes(), &ReadOptions::default())?;
//! let hit = &measured.records[0];
//! assert_eq!(hit.sample_rate_hz(), Some(1000.0));
//! assert_eq!(hit.of_quantity(ChannelQuantity::Force).map(|force| force.name.as_str()), Some("hammer"));
//! let mut response = hit.of_quantity(ChannelQuantity::Acceleration).cloned().ok_or("no response")?;
//! response.to_si()?;
//! assert_eq!(response.samples.real(), Some(&[0.0, 0.5 * 9.80665, 0.25 * 9.80665][..]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrays;
mod channel;
mod decoding;
mod detection;
mod error;
mod format;
#[cfg(feature = "hdf5")]
mod hdf5;
mod heading;
mod mat;
mod measurement_source;
mod memory;
mod notice;
mod npy;
mod npz;
mod number;
mod options;
mod quantity;
mod rate;
mod reader;
mod record;
mod sensitivity;
mod source;
mod tdms;
pub mod tdms_file;
mod text;
mod time_match;
mod uff;
mod unit;
mod wav;
mod whole_file;
mod write;

pub use channel::{Abscissa, Channel, ChannelUnit, DegreeOfFreedom, FrfUnits, Origin, Samples};
pub use error::{FilePosition, MeasureError};
pub use format::Format;
pub use measurement_source::MeasurementSource;
pub use notice::Notice;
pub use num_complex::Complex64;
pub use options::{InvalidCells, ReadOptions, SampleAxis, WriteOptions};
pub use quantity::ChannelQuantity;
pub use reader::{Reader, open, read, read_bytes};
pub use record::{Measurement, Record};
pub use sensitivity::SensorSensitivity;
pub use source::ByteStream;
pub use unit::{STANDARD_GRAVITY, Unit};
pub use whole_file::write_whole;
pub use write::write;
