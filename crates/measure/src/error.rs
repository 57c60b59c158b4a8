//! Why a file of measurements was refused, and where in it.

use std::fmt;

use crate::{ChannelQuantity, Format};

/// Where in a file something was found.
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

/// Why samples could not be read, converted or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// The operating system refused.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// What it answered.
        source: std::io::Error,
    },
    /// Something in the file is not what its format asks for.
    #[error("{file}, {place}: {quantity} is {found}; expected {expected}")]
    Malformed {
        /// The file.
        file: String,
        /// Where.
        place: FilePosition,
        /// What was read.
        quantity: &'static str,
        /// What was found, shortened.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// The file ends early, or announces more than it holds.
    #[error("{file}, {place}: {quantity} needs {needed} bytes; the file has {available}")]
    Truncated {
        /// The file.
        file: String,
        /// Where.
        place: FilePosition,
        /// What was read.
        quantity: &'static str,
        /// Bytes needed from that place on.
        needed: u64,
        /// Bytes there are from that place on.
        available: u64,
    },
    /// Something would take more memory than the file's size allows.
    #[error(
        "{file}, {place}: {quantity} takes {announced} bytes; at most {limit} for a file of this \
         size (option `expansion`)"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// Where.
        place: FilePosition,
        /// What was read.
        quantity: &'static str,
        /// Bytes it would take.
        announced: u64,
        /// Most bytes allowed.
        limit: u64,
    },
    /// The content is of none of the formats.
    #[error("{file}: none of the formats {expected} fits its content")]
    UnknownFormat {
        /// The file.
        file: String,
        /// The formats that can be read.
        expected: &'static str,
    },
    /// The format is known, and not read here.
    #[error("{file}: {feature} cannot be read; {instead}")]
    Unsupported {
        /// The file.
        file: String,
        /// What cannot be read.
        feature: &'static str,
        /// What to do about it.
        instead: &'static str,
    },
    /// The file gives neither a time axis nor a sample rate.
    #[error("{file}: no time axis and no sample rate; give the rate (option `sample_rate_hz`)")]
    NoSampleRate {
        /// The file.
        file: String,
    },
    /// The file holds no samples.
    #[error("{file}: holds no samples; expected {expected}")]
    NoSamples {
        /// The file.
        file: String,
        /// What would have been read.
        expected: &'static str,
    },
    /// An option does not suit the file.
    #[error("{file}: option `{option}` is {found}; expected {expected}")]
    Option {
        /// The file.
        file: String,
        /// The option.
        option: &'static str,
        /// What was given.
        found: String,
        /// What suits the file.
        expected: String,
    },
    /// An array could hold its samples along either axis.
    #[error(
        "{file}: array `{array}` has shape {rows} x {columns}, samples may run along either axis; \
         give it (option `sample_axis`)"
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
    /// The unit of a channel is missing or not understood.
    #[error("channel `{channel}`: unit `{text}` is not known; give one")]
    UnknownUnit {
        /// The channel.
        channel: String,
        /// The unit as written; empty if none was.
        text: String,
    },
    /// A text is no unit, or no sensitivity.
    #[error("`{text}` is no {quantity}; expected such as `{example}`")]
    NotUnderstood {
        /// What was asked for: unit or sensitivity.
        quantity: &'static str,
        /// The text.
        text: String,
        /// One that is understood.
        example: &'static str,
    },
    /// A conversion starts from another quantity.
    #[error("channel `{channel}` holds {found}; this conversion starts from {expected}")]
    QuantityMismatch {
        /// The channel.
        channel: String,
        /// What the channel holds.
        found: ChannelQuantity,
        /// What was expected.
        expected: ChannelQuantity,
    },
    /// The format of a file to write cannot hold this.
    #[error("{format} cannot hold channel `{channel}`: {reason}")]
    NotExpressible {
        /// The format.
        format: Format,
        /// The channel.
        channel: String,
        /// What stands against it.
        reason: &'static str,
    },
}

/// Text from a file, short enough for a message.
pub(crate) fn excerpt(text: &str) -> String {
    const MOST: usize = 40;
    let mut short: String = text.trim_end().chars().take(MOST).collect();
    if text.trim_end().chars().nth(MOST).is_some() {
        short.push_str("...");
    }
    format!("`{}`", short.escape_debug())
}
