//! Assumptions and observations of readers.

use std::fmt;

use crate::{ChannelQuantity, FilePosition};

/// An assumption or observation of a reader that does not prevent reading.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// A step printed with few digits was replaced by that of a whole sample rate.
    RateSnapped {
        /// Sample rate of the step as written \[Hz\].
        written_hz: f64,
        /// Sample rate used \[Hz\].
        taken_hz: f64,
    },
    /// A channel has no unit.
    UnitMissing {
        /// The channel.
        channel: String,
    },
    /// The unit of a channel is unknown.
    UnitUnrecognised {
        /// The channel.
        channel: String,
        /// The unit as written.
        text: String,
    },
    /// A channel has no unit; that of the file's system of units was used.
    UnitOfFile {
        /// The channel.
        channel: String,
        /// Its quantity.
        quantity: ChannelQuantity,
        /// SI value of one unit.
        factor: f64,
    },
    /// A channel's unit and the file's system of units differ; the channel's was used.
    UnitsDisagree {
        /// The channel.
        channel: String,
        /// SI value of the channel's unit.
        channel_factor: f64,
        /// SI value of the file's unit.
        file_factor: f64,
    },
    /// The stated quantity of a channel is not that of its unit, which was used.
    QuantityContradictsUnit {
        /// The channel.
        channel: String,
        /// The quantity stated in the file.
        stated: ChannelQuantity,
        /// The quantity of the unit.
        by_unit: ChannelQuantity,
    },
    /// The announced length of a binary dataset is not that of its points, which was used.
    ByteCount {
        /// Start of the data.
        place: FilePosition,
        /// Bytes announced.
        announced: u64,
        /// Bytes of the points.
        taken: u64,
    },
    /// Text between datasets was skipped.
    TextBetweenDatasets {
        /// Position of the first such line.
        place: FilePosition,
    },
    /// Text is not UTF-8 and was read as Latin-1.
    Latin1 {
        /// Position of the first such line.
        place: FilePosition,
    },
    /// No axis is named time; this evenly spaced one was used.
    TimeByValues {
        /// Its name or number.
        column: String,
    },
    /// The file gives no sample rate; that of the options was used.
    RateOfOptions {
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// The longer axis of an array was used as its sample axis.
    SampleAxisByLength {
        /// The array.
        array: String,
        /// The axis, 0 or 1.
        axis: usize,
    },
    /// A later block does not continue the even time axis of the first.
    UnevenBlock {
        /// First sample of the block, from zero.
        sample: u64,
    },
    /// An array was left out.
    ArrayLeftOut {
        /// The array.
        array: String,
        /// The reason.
        reason: &'static str,
    },
    /// A segment of a TDMS file was not closed by its writer; its complete samples were read.
    SegmentCutOff {
        /// Its start.
        place: FilePosition,
    },
    /// A text file ends inside a row, which was left out.
    RowCutOff {
        /// The position.
        place: FilePosition,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RateSnapped { written_hz, taken_hz } => {
                write!(f, "sample rate taken as {taken_hz} Hz; as written, {written_hz} Hz")
            }
            Self::UnitMissing { channel } => write!(f, "channel `{channel}` has no unit"),
            Self::UnitUnrecognised { channel, text } => {
                write!(f, "channel `{channel}`: unknown unit `{text}`")
            }
            Self::UnitOfFile { channel, quantity, factor } => write!(
                f,
                "channel `{channel}`: unit of {quantity} taken from the file's system, {factor} in SI"
            ),
            Self::UnitsDisagree { channel, channel_factor, file_factor } => write!(
                f,
                "channel `{channel}`: its unit is {channel_factor} in SI, that of the file's system \
                 {file_factor}; taken by the channel"
            ),
            Self::QuantityContradictsUnit { channel, stated, by_unit } => {
                write!(
                    f,
                    "channel `{channel}` is stated to be {stated}; its unit is one of {by_unit}"
                )
            }
            Self::ByteCount { place, announced, taken } => {
                write!(f, "{place}: {announced} bytes announced, the points take {taken}")
            }
            Self::TextBetweenDatasets { place } => {
                write!(f, "{place}: text between datasets passed over")
            }
            Self::Latin1 { place } => write!(f, "{place}: not UTF-8, read as Latin-1"),
            Self::TimeByValues { column } => {
                write!(f, "`{column}` rises evenly and was taken as the time in seconds")
            }
            Self::RateOfOptions { rate_hz } => {
                write!(f, "no sample rate in the file; taken as {rate_hz} Hz, as given")
            }
            Self::SampleAxisByLength { array, axis } => {
                write!(f, "array `{array}`: samples taken along axis {axis}, the longer one")
            }
            Self::UnevenBlock { sample } => {
                write!(f, "from sample {sample} on, time is not even")
            }
            Self::ArrayLeftOut { array, reason } => write!(f, "`{array}` left out: {reason}"),
            Self::SegmentCutOff { place } => {
                write!(f, "{place}: segment never closed by its writer; read as far as it is whole")
            }
            Self::RowCutOff { place } => write!(f, "{place}: the file ends within this row"),
        }
    }
}

/// The notices of one reader, without repetition and limited in number.
#[derive(Debug, Default)]
pub(crate) struct Notices(Vec<Notice>);

impl Notices {
    const MOST: usize = 200;

    pub(crate) fn add(&mut self, notice: Notice) {
        if self.0.len() < Self::MOST && !self.0.contains(&notice) {
            self.0.push(notice);
        }
    }

    /// Adds the notice of an array that is left out.
    pub(crate) fn left_out(&mut self, array: impl Into<String>, reason: &'static str) {
        self.add(Notice::ArrayLeftOut { array: array.into(), reason });
    }

    pub(crate) fn all(&self) -> &[Notice] {
        &self.0
    }

    pub(crate) fn into_all(self) -> Vec<Notice> {
        self.0
    }
}
