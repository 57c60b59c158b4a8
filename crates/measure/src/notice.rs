//! What a reader took upon itself, and what it found odd.

use std::fmt;

use crate::{ChannelQuantity, FilePosition};

/// Something that a reader snapped, assumed or found odd; the samples stand.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// A step printed in few digits was taken as that of a whole rate.
    RateSnapped {
        /// Rate of the step as written \[Hz\].
        written_hz: f64,
        /// Rate taken \[Hz\].
        taken_hz: f64,
    },
    /// A channel has no unit.
    UnitMissing {
        /// The channel.
        channel: String,
    },
    /// The unit of a channel is not understood.
    UnitUnrecognised {
        /// The channel.
        channel: String,
        /// The unit as written.
        text: String,
    },
    /// A channel has no unit of its own; the file's system of units was taken.
    UnitOfFile {
        /// The channel.
        channel: String,
        /// What it measures.
        quantity: ChannelQuantity,
        /// SI value of one unit.
        factor: f64,
    },
    /// A channel's unit and the file's system of units differ; the channel's was taken.
    UnitsDisagree {
        /// The channel.
        channel: String,
        /// SI value of the channel's unit.
        channel_factor: f64,
        /// SI value of the file's unit.
        file_factor: f64,
    },
    /// What a channel is said to measure is not what its unit measures; the unit was believed.
    QuantityContradictsUnit {
        /// The channel.
        channel: String,
        /// What the file says.
        stated: ChannelQuantity,
        /// What the unit measures.
        by_unit: ChannelQuantity,
    },
    /// A binary dataset announces another length than its points have; the points were believed.
    ByteCount {
        /// Where the data start.
        place: FilePosition,
        /// Bytes announced.
        announced: u64,
        /// Bytes that the points take.
        taken: u64,
    },
    /// Text between datasets was passed over.
    TextBetweenDatasets {
        /// Where the first such line is.
        place: FilePosition,
    },
    /// Text is not UTF-8 and was read as Latin-1.
    Latin1 {
        /// Where the first such line is.
        place: FilePosition,
    },
    /// No axis was said to be time; this one rises evenly and was taken.
    TimeByValues {
        /// Its name or place.
        column: String,
    },
    /// The file gives no sample rate; that of the options was taken.
    RateOfOptions {
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// Samples were taken to run along this axis of an array, its longer one.
    SampleAxisByLength {
        /// The array.
        array: String,
        /// The axis, 0 or 1.
        axis: usize,
    },
    /// A later block does not carry on the even time axis of the first.
    UnevenBlock {
        /// First sample of the block, from zero.
        sample: u64,
    },
    /// An array was left out.
    ArrayLeftOut {
        /// The array.
        array: String,
        /// Why.
        reason: &'static str,
    },
    /// A segment of a TDMS file was never closed, as after a crash of its
    /// writer; what it holds in full was read.
    SegmentCutOff {
        /// Where it starts.
        place: FilePosition,
    },
    /// A text file ends within a row, which was left out.
    RowCutOff {
        /// Where.
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
                write!(f, "channel `{channel}`: unit `{text}` is not known")
            }
            Self::UnitOfFile { channel, quantity, factor } => write!(
                f,
                "channel `{channel}`: unit of {quantity} taken from the file's system, {factor} in SI"
            ),
            Self::UnitsDisagree { channel, channel_factor, file_factor } => write!(
                f,
                "channel `{channel}`: its unit is {channel_factor} in SI, the file's system says \
                 {file_factor}; taken by the channel"
            ),
            Self::QuantityContradictsUnit { channel, stated, by_unit } => {
                write!(
                    f,
                    "channel `{channel}` is said to be {stated}; its unit is one of {by_unit}"
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
                write!(f, "from sample {sample} on, time does not carry on evenly")
            }
            Self::ArrayLeftOut { array, reason } => write!(f, "`{array}` left out: {reason}"),
            Self::SegmentCutOff { place } => {
                write!(f, "{place}: segment never closed by its writer; read as far as it is whole")
            }
            Self::RowCutOff { place } => write!(f, "{place}: the file ends within this row"),
        }
    }
}

/// The notices of one reader: each once, and never more than a file can be read for.
#[derive(Debug, Default)]
pub(crate) struct Notices(Vec<Notice>);

impl Notices {
    const MOST: usize = 200;

    pub(crate) fn add(&mut self, notice: Notice) {
        if self.0.len() < Self::MOST && !self.0.contains(&notice) {
            self.0.push(notice);
        }
    }

    pub(crate) fn all(&self) -> &[Notice] {
        &self.0
    }

    pub(crate) fn into_all(self) -> Vec<Notice> {
        self.0
    }
}
