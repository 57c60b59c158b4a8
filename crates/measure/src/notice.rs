//! Assumptions and observations of readers.

use crate::{ChannelQuantity, FilePosition};

/// An assumption or observation of a reader that does not prevent reading; an error for callers that
/// accept none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Notice {
    /// A step printed with few digits was replaced by the step of a whole sample rate.
    #[error("sample rate taken as {taken_hz} Hz; as written, {written_hz} Hz")]
    RateSnapped {
        /// Sample rate of the step as written \[Hz\].
        written_hz: f64,
        /// Sample rate used \[Hz\].
        taken_hz: f64,
    },
    /// A channel has no unit.
    #[error("channel `{channel}` has no unit")]
    UnitMissing {
        /// The channel.
        channel: String,
    },
    /// The unit of a channel is unknown.
    #[error("channel `{channel}`: unknown unit `{text}`")]
    UnitUnrecognised {
        /// The channel.
        channel: String,
        /// The unit as written.
        text: String,
    },
    /// A channel has no unit; the unit of the file's system was used.
    #[error("channel `{channel}`: unit of {quantity} taken from the file's system, {factor} in SI")]
    UnitOfFile {
        /// The channel.
        channel: String,
        /// Its quantity.
        quantity: ChannelQuantity,
        /// SI value of one unit.
        factor: f64,
    },
    /// A channel's unit and the file's system of units differ; the channel's was used.
    #[error(
        "channel `{channel}`: its unit is {channel_factor} in SI, that of the file's system \
         {file_factor}; taken by the channel"
    )]
    UnitsDisagree {
        /// The channel.
        channel: String,
        /// SI value of the channel's unit.
        channel_factor: f64,
        /// SI value of the file's unit.
        file_factor: f64,
    },
    /// The stated quantity of a channel contradicts its unit; the unit was used.
    #[error("channel `{channel}` is stated to be {stated}; its unit is one of {by_unit}")]
    QuantityContradictsUnit {
        /// The channel.
        channel: String,
        /// The quantity stated in the file.
        stated: ChannelQuantity,
        /// The quantity of the unit.
        by_unit: ChannelQuantity,
    },
    /// The announced length of a binary dataset contradicts its points; their length was used.
    #[error("{place}: {announced} bytes announced, the points take {taken}")]
    ByteCount {
        /// Start of the data.
        place: FilePosition,
        /// Bytes announced.
        announced: u64,
        /// Bytes of the points.
        taken: u64,
    },
    /// Text between datasets was skipped.
    #[error("{place}: text between datasets passed over")]
    TextBetweenDatasets {
        /// Position of the first such line.
        place: FilePosition,
    },
    /// Text is not UTF-8 and was read as Latin-1.
    #[error("{place}: not UTF-8, read as Latin-1")]
    Latin1 {
        /// Position of the first such line.
        place: FilePosition,
    },
    /// More names or units were given than there are channels.
    #[error("{given} {of} given for {channels} channels; the last {} not used", unused(*given, *channels))]
    NotUsed {
        /// `names` or `units`.
        of: &'static str,
        /// Number of them.
        given: usize,
        /// Number of channels.
        channels: usize,
    },
    /// No axis is named time; this evenly spaced one was used.
    #[error("`{column}` rises evenly and was taken as the time in seconds")]
    TimeByValues {
        /// Its name or number.
        column: String,
    },
    /// No axis is named frequency; this array beside complex samples was used.
    #[error("`{column}` was taken as the frequencies in hertz of the complex samples")]
    FrequencyByValues {
        /// Its name.
        column: String,
    },
    /// The file gives no sample rate; the rate of the options was used.
    #[error("no sample rate in the file; taken as {rate_hz} Hz, as given")]
    RateOfOptions {
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// The longer axis of an array was used as its sample axis.
    #[error("array `{array}`: samples taken along axis {axis}, the longer one")]
    SampleAxisByLength {
        /// The array.
        array: String,
        /// The axis, 0 or 1.
        axis: usize,
    },
    /// A later block does not continue the even time axis of the first.
    #[error("from sample {sample} on, time is not even")]
    UnevenBlock {
        /// First sample of the block, from zero.
        sample: u64,
    },
    /// An array was left out.
    #[error("`{array}` left out: {reason}")]
    ArrayLeftOut {
        /// The array.
        array: String,
        /// The reason.
        reason: &'static str,
    },
    /// A segment of a TDMS file was not closed by its writer; its complete samples were read.
    #[error("{place}: segment never closed by its writer; read as far as it is whole")]
    SegmentCutOff {
        /// Its start.
        place: FilePosition,
    },
    /// Cells of a text that are no numbers were taken as missing or as infinite.
    #[error(
        "{count} cells are no numbers and were taken as {taken}; the first: {place}, `{channel}`"
    )]
    InvalidCells {
        /// Number of them.
        count: u64,
        /// `dropouts` or `overloads`.
        taken: &'static str,
        /// Position of the first.
        place: FilePosition,
        /// Column of the first.
        channel: String,
    },
    /// Rows of numbers above the headings of a text were passed over.
    #[error(
        "{rows} rows of numbers from line {line} on were passed over; they are above the headings"
    )]
    RowsAboveHeadings {
        /// Number of them.
        rows: usize,
        /// Line of the first, from one.
        line: usize,
    },
    /// A text file ends inside a row, which was left out.
    #[error("{place}: the file ends within this row")]
    RowCutOff {
        /// The position.
        place: FilePosition,
    },
}

fn unused(given: usize, channels: usize) -> String {
    match given - channels {
        1 => "is".to_owned(),
        count => format!("{count} are"),
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
