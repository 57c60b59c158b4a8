//! Errors of reading.

/// An error of reading a TDMS file. Offsets are bytes from the start of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TdmsError {
    /// An error of the stream.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// Content that violates the format.
    #[error("byte {offset}: {quantity} is {found}; expected {expected}")]
    Malformed {
        /// The position.
        offset: u64,
        /// The part of the file.
        quantity: &'static str,
        /// The content found, quoted and shortened.
        found: String,
        /// The content expected.
        expected: String,
    },
    /// The file ends early, or announces more than it holds.
    #[error("byte {offset}: {quantity} needs {needed} bytes; the file has {available}")]
    Truncated {
        /// The position.
        offset: u64,
        /// The part of the file.
        quantity: &'static str,
        /// Bytes needed from that position.
        needed: u64,
        /// Bytes available from that position.
        available: u64,
    },
    /// Content that needs more memory than allowed.
    #[error(
        "byte {offset}: {quantity} takes {needed} bytes of memory; at most {limit} are allowed"
    )]
    TooLarge {
        /// The position.
        offset: u64,
        /// The part of the file.
        quantity: &'static str,
        /// Bytes needed, with all before.
        needed: u64,
        /// Most bytes allowed, see [`TdmsOptions::expansion`](crate::tdms_file::TdmsOptions::expansion).
        limit: u64,
    },
    /// Raw data of the driver NI-DAQmx, whose format depends on the device.
    #[error(
        "raw data of NI-DAQmx cannot be read; save the file from LabVIEW or DIAdem as scaled TDMS"
    )]
    RawDaqmx,
    /// A selected object that is not a channel of numbers.
    #[error("object {object} is not a channel of numbers; the file has {objects} objects")]
    NotNumeric {
        /// Index of the object.
        object: usize,
        /// Number of objects of the file.
        objects: usize,
    },
}

impl TdmsError {
    pub(crate) fn malformed(
        offset: u64,
        quantity: &'static str,
        found: &str,
        expected: impl Into<String>,
    ) -> Self {
        const MOST: usize = 40;
        let mut short: String = found.trim_end().chars().take(MOST).collect();
        if found.trim_end().chars().nth(MOST).is_some() {
            short.push_str("...");
        }
        let found = format!("`{}`", short.escape_debug());
        Self::Malformed { offset, quantity, found, expected: expected.into() }
    }
}
