//! From the files of measured hammer tests to samples with units, and back.
//!
//! A hammer test is recorded by somebody else's program. What arrives is a
//! file, and three questions: which samples belong together, at what rate were
//! they taken, and in which unit. Every reader here answers them the same way,
//! with [`Record`]s of [`Channel`]s:
//!
//! ```text
//! x_n = factor * sample_n   [SI],   at   t_n = start + n * step   [s]
//! ```
//!
//! Nothing is guessed in silence. What a file does not say is an explicit
//! state ([`ChannelUnit::Missing`]) or an error that names the option to give;
//! what a reader took upon itself is a [`Notice`]. What is wrong is a
//! [`MeasureError`] with the file, the place and what was expected there.
//!
//! Readers hold one block of samples at a time and never take memory on the
//! word of a header: what a file announces is held against its length first.
//!
//! | module | holds |
//! |---|---|
//! | `channel`, `record`, `quantity`, `unit`, `sensitivity` | samples with axis and unit |
//! | `reader`, `options`, `format`, `source` | opening, what the caller knows, which format |
//! | `notice`, `error`, `rate` | what was assumed, what is wrong, whole sample rates |
//! | `uff` | universal files: datasets 58, 58b, 151, 164 |
//! | `text` | columns of numbers: CSV, TXT, LVM |
//! | `npy`, `npz`, `mat`, `arrays`, `number` | arrays of NumPy and MATLAB |
//! | `wav` | RIFF WAVE |
//! | `hdf5` | HDF5 and MATLAB 7.3, with the feature `hdf5` |
//! | `tdms` | TDMS of LabVIEW, with the feature `tdms` |
//! | `write` | files that appear whole or not at all |
//!
//! The crate knows files, rates and units. It knows no mechanics and no signal
//! processing.
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
mod error;
mod format;
#[cfg(feature = "hdf5")]
mod hdf5;
mod mat;
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
mod text;
mod uff;
mod unit;
mod wav;
mod write;

pub use channel::{Abscissa, Channel, ChannelUnit, DegreeOfFreedom, Origin, Samples};
pub use error::{FilePosition, MeasureError};
pub use format::Format;
pub use notice::Notice;
pub use num_complex::Complex64;
pub use options::{ReadOptions, SampleAxis};
pub use quantity::ChannelQuantity;
pub use reader::{Reader, open, read, read_bytes};
pub use record::{Measurement, Record};
pub use sensitivity::SensorSensitivity;
pub use source::ByteStream;
pub use unit::{STANDARD_GRAVITY, Unit};
pub use write::{WriteOptions, write};
