//! Errors of an analysis.

use std::io;
use std::path::{Path, PathBuf};

use asperity_measure::{Channel, ChannelQuantity, MeasureError};
use asperity_signal::SignalError;
use thiserror::Error;

/// Error of an analysis or a conversion.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// File that cannot be read or written.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// File that cannot be read to its end for its checksum.
    #[error("{}: {source}", path.display())]
    Io {
        /// File.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// File that cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// File.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// The input of a conversion as its output.
    #[error("{} is the input and the output", path.display())]
    SameFile {
        /// File.
        path: PathBuf,
    },
    /// Empty list of files.
    #[error("no file to analyse")]
    NoFile,
    /// Files that are too large.
    #[error("{}{}: {bytes} bytes; at most {limit} are accepted", path.display(), others(*files))]
    TooLarge {
        /// First file.
        path: PathBuf,
        /// Number of files.
        files: usize,
        /// Size of all in bytes.
        bytes: u64,
        /// Largest size accepted.
        limit: u64,
    },
    /// Setting that is not valid.
    #[error("{name} is `{found}`; accepted: {expected}")]
    Setting {
        /// Setting.
        name: &'static str,
        /// Value given.
        found: String,
        /// Accepted values.
        expected: &'static str,
    },
    /// No channel for the force or the response.
    #[error(
        "{}: no channel for the {role}{}{}; available: {channels}",
        file.display(), quoted(wanted), did_you_mean(near.as_deref())
    )]
    NoChannel {
        /// File.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// Requested channel; empty for any.
        wanted: String,
        /// The nearest name of a channel.
        near: Option<String>,
        /// Available channels.
        channels: String,
    },
    /// Several channels that may be the force or the response.
    #[error("{}: several channels may be the {role}{}: {channels}", file.display(), quoted(wanted))]
    Ambiguous {
        /// File.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// Requested channel; empty for any.
        wanted: String,
        /// Channels that fit.
        channels: String,
    },
    /// Channel that is selected twice.
    #[error("{}: channel `{channel}` is selected twice", file.display())]
    ChannelTwice {
        /// File.
        file: PathBuf,
        /// Channel.
        channel: String,
    },
    /// Selected channel without a known unit.
    #[error("{}: channel `{channel}` has {}; a known unit is required", file.display(), unit(text))]
    Unit {
        /// File.
        file: PathBuf,
        /// Channel.
        channel: String,
        /// Unit in the file; empty without one.
        text: String,
    },
    /// File without a time axis and without a sample rate.
    #[error("{}: no time axis and no sample rate; a sample rate is required", .0.display())]
    NoRate(PathBuf),
    /// Selected channel of another quantity.
    #[error("{}: channel `{channel}` holds {found}; the {role} must be {expected}", file.display())]
    Quantity {
        /// File.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// Channel.
        channel: String,
        /// Quantity of the channel.
        found: ChannelQuantity,
        /// Accepted quantities.
        expected: &'static str,
    },
    /// Folder or pattern without measurement files.
    #[error("{}: no measurement file there", path.display())]
    NoFiles {
        /// Folder or pattern.
        path: PathBuf,
    },
    /// More functions of hits than are kept in memory.
    #[error(
        "the functions of {hits} hits of {lines} lines exceed the limit of {limit} values; analyse \
         fewer hits, or shorter ones"
    )]
    TooManyFunctions {
        /// Hits so far.
        hits: usize,
        /// Lines of a function.
        lines: usize,
        /// Most values.
        limit: usize,
    },
    /// Force and response that were not sampled together.
    #[error(
        "{}, record {record}: force and response are not sampled together: {channels}; resample them \
         to one rate and one start, or give a record in which they are",
        file.display()
    )]
    NotTogether {
        /// The file.
        file: PathBuf,
        /// The record, from 1.
        record: usize,
        /// The channels with rates and starts.
        channels: String,
    },
    /// A channel that is in another record of the file.
    #[error(
        "{}: the {role} `{channel}` is in record {record}, and the others are in record {other}: {reason}",
        file.display()
    )]
    OtherRecord {
        /// The file.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// Name of the channel.
        channel: String,
        /// Its record, from 1.
        record: usize,
        /// Record of the other channels.
        other: usize,
        /// Reason that they are not in one record.
        reason: String,
    },
    /// An option for a channel that no file has.
    #[error(
        "{}: option `{option}` names `{wanted}`, and there is no such channel{}; available: {channels}",
        file.display(), did_you_mean(near.as_deref())
    )]
    UnknownChannel {
        /// The file.
        file: PathBuf,
        /// The option.
        option: &'static str,
        /// The name.
        wanted: String,
        /// The nearest name of a channel.
        near: Option<String>,
        /// The channels.
        channels: String,
    },
    /// A rejected hit that does not exist.
    #[error("hit {number} cannot be rejected: there are {hits} hits")]
    NoSuchHit {
        /// The number.
        number: usize,
        /// Number of hits.
        hits: usize,
    },
    /// Record that is not sampled evenly in time, or whose channels differ.
    #[error("{}, record {record}: {problem}", file.display())]
    Record {
        /// File.
        file: PathBuf,
        /// Record, from 1.
        record: usize,
        /// Cause.
        problem: &'static str,
    },
    /// Files with different sample rates or responses.
    #[error(
        "{}: {quantity} {found}, in the files before {expected}; analyse them separately",
        file.display()
    )]
    Differs {
        /// File.
        file: PathBuf,
        /// Quantity that differs.
        quantity: &'static str,
        /// Value in this file.
        found: String,
        /// Value in the files before.
        expected: String,
    },
    /// Test without a hit.
    #[error(
        "no hit found: the largest force is {largest_n} N, the noise {noise_n} N{}",
        remarks.iter().flat_map(|remark| ["; ", remark.as_str()]).collect::<String>()
    )]
    NoHit {
        /// Largest force \[N\].
        largest_n: f64,
        /// Robust standard deviation of the force \[N\].
        noise_n: f64,
        /// Parts left out of the records, in words.
        remarks: Vec<String>,
    },
    /// Records without a free decay.
    #[error(
        "no free decay found in {records} {}: the largest level of a cycle is {above_noise:.1} times \
         the quiet level, and falls by {fall:.1} after it; a decay rises above 4 and falls by 3{}",
        if *records == 1 { "record" } else { "records" },
        left_out.iter().flat_map(|sentence| ["; ", sentence.as_str()]).collect::<String>()
    )]
    NoDecay {
        /// Number of records.
        records: usize,
        /// Largest level of a cycle over the quiet level.
        above_noise: f64,
        /// Largest level over the smallest after it.
        fall: f64,
        /// Responses that cannot be analysed, in words.
        left_out: Vec<String>,
    },
    /// Fewer hits above the noise than requested.
    #[error("{requested} hits requested; only {found} are above the noise of {noise_n} N")]
    FewerHits {
        /// Number of hits requested.
        requested: usize,
        /// Number of hits found.
        found: usize,
        /// Robust standard deviation of the force \[N\].
        noise_n: f64,
    },
    /// Test whose hits are all excluded from the average.
    #[error("none of {hits} hits can be averaged; the first: {reason}")]
    NoGoodHit {
        /// Number of hits found.
        hits: usize,
        /// Quality issues of the first hit.
        reason: String,
    },
    /// Samples that cannot be analysed.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

impl AnalysisError {
    /// The error of a channel without a known unit.
    pub(crate) fn unit(file: &Path, channel: &Channel) -> Self {
        let (channel, text) = (channel.name.clone(), channel.unit.text().to_owned());
        Self::Unit { file: file.to_owned(), channel, text }
    }

    /// True for a wrong request, false for measurements that cannot be analysed.
    pub fn is_wrong_request(&self) -> bool {
        !matches!(
            self,
            Self::NoHit { .. }
                | Self::NoDecay { .. }
                | Self::FewerHits { .. }
                | Self::NoGoodHit { .. }
                | Self::Signal(_)
                | Self::Io { .. }
                | Self::Write { .. }
        )
    }
}

fn others(files: usize) -> String {
    if files > 1 { format!(" and {} more", files - 1) } else { String::new() }
}

fn did_you_mean(near: Option<&str>) -> String {
    near.map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"))
}

fn quoted(wanted: &str) -> String {
    if wanted.is_empty() { String::new() } else { format!(" `{wanted}`") }
}

fn unit(text: &str) -> String {
    if text.is_empty() { "no unit".to_owned() } else { format!("the unknown unit `{text}`") }
}
