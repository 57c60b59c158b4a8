//! TDMS files of LabVIEW to objects, properties and channels.
//!
//! Source: National Instruments, "TDMS File Format Internal Structure" (versions 4712 and 4713).
//! A file is a sequence of segments, each a lead-in, metadata and raw data:
//!
//! ```text
//! lead-in     "TDSm", contents, version, length of the segment, length of the metadata
//! metadata    objects changed since the segment before: path, raw data index, properties
//! raw data    chunks of the samples of each listed channel, in turn or interleaved
//! ```
//!
//! The objects are the file `/`, its groups `/'group'` and their channels `/'group'/'channel'`. A
//! first pass reads lead-ins and metadata; samples are then read in blocks, together for the
//! channels of a [`TdmsSelection`].
//!
//! Samples are numbers of one to eight bytes as `f64`, after the linear and polynomial scales of
//! the channel, its group or the file:
//!
//! ```text
//! x_n = c_0 + c_1 r_n + c_2 r_n^2 + ...     of the raw sample r_n
//! ```
//!
//! A channel with another scale is rejected, and so is raw data of the driver NI-DAQmx, whose
//! format depends on the device. Texts, truth values, times and complex numbers of channels are not
//! read; see [`TdmsObject::other_content`]. Paths and kept properties have at most 65536 bytes.
//!
//! Lengths announced in a header are checked against the file's length before memory is allocated,
//! and memory is limited by [`TdmsOptions::expansion`]. Every other file is a [`TdmsError`] with its
//! position.
//!
//! | module | contents |
//! |---|---|
//! | `file` | the open file, selections of channels |
//! | `segment`, `index` | lead-ins, and the first pass |
//! | `object`, `property`, `time`, `data_type` | the content of the metadata |
//! | `extent`, `chunk_group`, `scale` | positions of samples, reading and scaling them |
//! | `byte_reader`, `error` | the stream, errors |
//!
//! ```
//! use asperity_measure::tdms_file::{TdmsFile, TdmsOptions};
//!
//! // One segment: the channel `force` of the group `hit`, with a property and three doubles.
//! let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
//! let metadata = [
//!     1_u32.to_le_bytes().to_vec(),
//!     text("/'hit'/'force'"),
//!     [20_u32, 10, 1].map(u32::to_le_bytes).concat(),
//!     3_u64.to_le_bytes().to_vec(),
//!     1_u32.to_le_bytes().to_vec(),
//!     text("unit_string"),
//!     0x20_u32.to_le_bytes().to_vec(),
//!     text("N"),
//! ]
//! .concat();
//! let raw = [0.0, 10.0, 2.0_f64].map(f64::to_le_bytes).concat();
//! let lengths = [metadata.len() + raw.len(), metadata.len()].map(|n| (n as u64).to_le_bytes());
//! let lead_in = [b"TDSm".to_vec(), [14_u32, 4713].map(u32::to_le_bytes).concat(), lengths.concat()];
//! let bytes = [lead_in.concat(), metadata, raw].concat();
//!
//! let mut file = TdmsFile::open(std::io::Cursor::new(bytes), &TdmsOptions::default())?;
//! let force = file.find("/'hit'/'force'").ok_or("no such channel")?;
//! let unit = file.objects()[force].property("unit_string").and_then(|unit| unit.text());
//! assert_eq!(unit, Some("N"));
//! assert_eq!(file.samples(force)?, [0.0, 10.0, 2.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod byte_reader;
mod chunk_group;
mod data_type;
mod error;
mod extent;
mod file;
mod index;
mod object;
mod property;
mod scale;
mod segment;
mod time;

pub use error::TdmsError;
pub use file::{TdmsFile, TdmsOptions, TdmsSelection};
pub use object::{TdmsObject, TdmsPath};
pub use property::{TdmsProperty, TdmsValue};
pub use time::TdmsTime;
