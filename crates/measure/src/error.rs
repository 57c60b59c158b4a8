//! Errors of reading, converting and writing measurements.

use std::fmt;

use crate::tdms_file::TdmsError;
use crate::{ChannelQuantity, Format};

/// A position in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilePosition {
    /// Bytes from the start of the file, from zero.
    Offset(u64),
    /// Line of a text, from one.
    Line(u64),
}

impl fmt::Display for FilePosition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Offset(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
        }
    }
}

/// Errors of reading, converting and writing samples.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// An error of the operating system.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// The error.
        source: std::io::Error,
    },
    /// A file that exists, and is not to be replaced.
    #[error("{file} exists")]
    Exists {
        /// The file.
        file: String,
    },
    /// Content that violates the format.
    #[error("{file}, {place}: {quantity} is {found}; expected {expected}")]
    Malformed {
        /// The file.
        file: String,
        /// The position.
        place: FilePosition,
        /// The part of the file.
        quantity: &'static str,
        /// The content found, shortened.
        found: String,
        /// The content expected.
        expected: String,
    },
    /// A cell of a text that is no number.
    #[error(
        "{file}, {place}: `{found}` for `{channel}` is no number; option `invalid_cells` takes such \
         cells as dropouts or as overloads"
    )]
    InvalidCell {
        /// The file.
        file: String,
        /// The row.
        place: FilePosition,
        /// The content found, shortened.
        found: String,
        /// Name of the column.
        channel: String,
    },
    /// Time vectors of which none says to which channels they belong.
    #[error(
        "{file}: the times {times} differ, and neither names nor places say to which of the channels \
         {channels} each belongs; name each time after its channel, such as time_acc, or put it before it"
    )]
    AmbiguousTimes {
        /// The file.
        file: String,
        /// The time vectors, with starts and rates.
        times: String,
        /// Names of the channels.
        channels: String,
    },
    /// The file ends early, or announces more than it holds.
    #[error("{file}, {place}: {quantity} needs {needed} bytes; the file has {available}")]
    Truncated {
        /// The file.
        file: String,
        /// The position.
        place: FilePosition,
        /// The part of the file.
        quantity: &'static str,
        /// Bytes needed from that position.
        needed: u64,
        /// Bytes available from that position.
        available: u64,
    },
    /// Content that needs more memory than the size of the file allows.
    #[error(
        "{file}, {place}: {quantity} takes {announced} bytes; at most {limit} for a file of this \
         size (option `expansion`)"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// The position.
        place: FilePosition,
        /// The part of the file.
        quantity: &'static str,
        /// Bytes needed.
        announced: u64,
        /// Most bytes allowed.
        limit: u64,
    },
    /// Content of no known format.
    #[error("{file}: unknown format; expected one of {expected}")]
    UnknownFormat {
        /// The file.
        file: String,
        /// The formats that can be read.
        expected: &'static str,
    },
    /// A known format that cannot be read or written.
    #[error("{file}: {feature} cannot be read; {instead}")]
    Unsupported {
        /// The file.
        file: String,
        /// The format or feature.
        feature: &'static str,
        /// An alternative.
        instead: &'static str,
    },
    /// A file without time axis and sample rate.
    #[error("{file}: no time axis and no sample rate; give the rate (option `sample_rate_hz`)")]
    NoSampleRate {
        /// The file.
        file: String,
    },
    /// A file without samples.
    #[error("{file}: no samples; expected {expected}")]
    NoSamples {
        /// The file.
        file: String,
        /// The content expected.
        expected: &'static str,
    },
    /// An invalid option.
    #[error("{file}: option `{option}` is {found}; expected {expected}")]
    Option {
        /// The file.
        file: String,
        /// The option.
        option: &'static str,
        /// The value given.
        found: String,
        /// The values accepted.
        expected: String,
    },
    /// An array with equal dimensions, whose sample axis is ambiguous.
    #[error(
        "{file}: the sample axis of array `{array}` of shape {rows} x {columns} is ambiguous; give it \
         (option `sample_axis`)"
    )]
    SampleAxis {
        /// The file.
        file: String,
        /// The array.
        array: String,
        /// First dimension.
        rows: u64,
        /// Second dimension.
        columns: u64,
    },
    /// A missing or unknown unit of a channel.
    #[error("channel `{channel}`: unknown unit `{text}`; give one, for example m/s^2")]
    UnknownUnit {
        /// The channel.
        channel: String,
        /// The unit as written; empty if none was.
        text: String,
    },
    /// A text that is not a unit or a sensitivity.
    #[error("`{text}` is not a valid {quantity}; for example `{example}`")]
    NotUnderstood {
        /// `unit` or `sensitivity`.
        quantity: &'static str,
        /// The text.
        text: String,
        /// A valid text.
        example: &'static str,
    },
    /// A conversion of a channel of another quantity.
    #[error("channel `{channel}` is {found}; this conversion needs {expected}")]
    QuantityMismatch {
        /// The channel.
        channel: String,
        /// Quantity of the channel.
        found: ChannelQuantity,
        /// Quantity needed.
        expected: ChannelQuantity,
    },
    /// A channel that the format of the file cannot represent.
    #[error("channel `{channel}` cannot be written as {format}: {reason}")]
    NotExpressible {
        /// The format.
        format: Format,
        /// The channel.
        channel: String,
        /// The reason.
        reason: &'static str,
    },
}

impl MeasureError {
    /// The error of content that violates the format.
    pub(crate) fn malformed(
        file: &str,
        place: FilePosition,
        quantity: &'static str,
        found: String,
        expected: impl Into<String>,
    ) -> Self {
        Self::Malformed { file: file.to_owned(), place, quantity, found, expected: expected.into() }
    }

    /// The error of a TDMS file.
    pub(crate) fn of_tdms(file: &str, error: TdmsError) -> Self {
        let (file, at) = (file.to_owned(), FilePosition::Offset);
        match error {
            TdmsError::Io(source) => Self::Io { file, source },
            TdmsError::Malformed { offset, quantity, found, expected } => {
                Self::Malformed { file, place: at(offset), quantity, found, expected }
            }
            TdmsError::Truncated { offset, quantity, needed, available } => {
                Self::Truncated { file, place: at(offset), quantity, needed, available }
            }
            TdmsError::TooLarge { offset, quantity, needed: announced, limit } => {
                Self::TooLarge { file, place: at(offset), quantity, announced, limit }
            }
            TdmsError::RawDaqmx => Self::Unsupported {
                file,
                feature: "a TDMS file with raw data of NI-DAQmx",
                instead: "save it from LabVIEW or DIAdem as scaled TDMS, or as UFF or CSV",
            },
            other => Self::Io { file, source: std::io::Error::other(other) },
        }
    }
}

/// Text from a file, shortened for a message.
pub(crate) fn excerpt(text: &str) -> String {
    const MOST: usize = 40;
    let mut short: String = text.trim_end().chars().take(MOST).collect();
    if text.trim_end().chars().nth(MOST).is_some() {
        short.push_str("...");
    }
    format!("`{}`", short.escape_debug())
}

/// Errors of the writer of a format.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub(crate) enum WriteFault {
    Io(#[from] std::io::Error),
    Refused(MeasureError),
}

impl WriteFault {
    pub(crate) fn at(self, file: &str) -> MeasureError {
        match self {
            Self::Io(source) => MeasureError::Io { file: file.to_owned(), source },
            Self::Refused(error) => error,
        }
    }

    /// A channel that the format cannot represent.
    pub(crate) fn refused(format: Format, channel: &str, reason: &'static str) -> Self {
        let channel = channel.to_owned();
        Self::Refused(MeasureError::NotExpressible { format, channel, reason })
    }
}
