//! Why measured hits cannot be analysed.

use std::io;
use std::path::PathBuf;

use asperity_measure::{ChannelQuantity, MeasureError};
use asperity_signal::SignalError;
use thiserror::Error;

/// Why files have no analysis.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// A file cannot be read.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// A file cannot be read to its end for its checksum.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// No file was named.
    #[error("no file to analyse")]
    NoFile,
    /// An option is not understood, or outside what makes sense.
    #[error("{option} is `{found}`; accepted: {expected}")]
    Option {
        /// The option.
        option: &'static str,
        /// What was given.
        found: String,
        /// What is accepted.
        expected: &'static str,
    },
    /// No channel is what was asked for.
    #[error(
        "{}: no channel for the {role}{}; there are {channels}; name one with --{role}, or say \
         what the channels are with --names and --units",
        file.display(), asked(wanted)
    )]
    NoChannel {
        /// The file.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// What was asked for; empty where any would do.
        wanted: String,
        /// The channels there are.
        channels: String,
    },
    /// Several channels are what was asked for.
    #[error(
        "{}: several channels may be the {role}{}: {channels}; choose one with --{role} NAME or \
         --{role} '#NUMBER'",
        file.display(), asked(wanted)
    )]
    Ambiguous {
        /// The file.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// What was asked for; empty where any would do.
        wanted: String,
        /// The channels that fit.
        channels: String,
    },
    /// The unit of a chosen channel is not known.
    #[error(
        "{}: channel `{channel}` has {}; give the units of all channels in their order with \
         --units, such as --units N,m/s^2",
        file.display(), unit(text)
    )]
    Unit {
        /// The file.
        file: PathBuf,
        /// The channel.
        channel: String,
        /// The unit as written; empty if none was.
        text: String,
    },
    /// A file gives neither a time axis nor a sample rate.
    #[error("{}: no time axis and no sample rate; give the rate with --rate HZ", file.display())]
    NoRate {
        /// The file.
        file: PathBuf,
    },
    /// A chosen channel holds something else.
    #[error("{}: channel `{channel}` holds {found}; the {role} must be {expected}", file.display())]
    Quantity {
        /// The file.
        file: PathBuf,
        /// `force` or `response`.
        role: &'static str,
        /// The channel.
        channel: String,
        /// What it holds.
        found: ChannelQuantity,
        /// What is accepted.
        expected: &'static str,
    },
    /// A record is not sampled evenly in time, or its channels differ.
    #[error("{}, record {record}: {problem}", file.display())]
    Record {
        /// The file.
        file: PathBuf,
        /// The record, from 1.
        record: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The files were not sampled alike.
    #[error(
        "{}: {quantity} {found}, the files before have {expected}; analyse them apart",
        file.display()
    )]
    Differs {
        /// The file.
        file: PathBuf,
        /// What differs.
        quantity: &'static str,
        /// What this file has.
        found: String,
        /// What those before have.
        expected: String,
    },
    /// Nothing was found that could be a blow.
    #[error(
        "no hit found: the largest force is {largest_n} N over noise of {noise_n} N; a level can \
         be given with --level, and --flip-force turns a force that is negative when it pushes"
    )]
    NoHit {
        /// The largest force \[N\].
        largest_n: f64,
        /// Robust deviation of the force \[N\].
        noise_n: f64,
    },
    /// Fewer blows stand out than were asked for.
    #[error("{asked} hits asked for; only {found} stand out from noise of {noise_n} N")]
    FewerHits {
        /// Hits asked for.
        asked: usize,
        /// Hits there are.
        found: usize,
        /// Robust deviation of the force \[N\].
        noise_n: f64,
    },
    /// Every hit was excluded.
    #[error("none of {hits} hits can be averaged; the first: {reason}; --keep-all averages them")]
    NoGoodHit {
        /// Hits found.
        hits: usize,
        /// What is wrong with the first.
        reason: String,
    },
    /// The samples cannot be analysed.
    #[error(transparent)]
    Signal(#[from] SignalError),
}

impl AnalysisError {
    /// Whether the request is wrong, and not what was measured.
    pub fn is_wrong_request(&self) -> bool {
        !matches!(
            self,
            Self::NoHit { .. }
                | Self::FewerHits { .. }
                | Self::NoGoodHit { .. }
                | Self::Signal(_)
                | Self::Io { .. }
        )
    }
}

fn asked(wanted: &str) -> String {
    if wanted.is_empty() { String::new() } else { format!(" `{wanted}`") }
}

fn unit(text: &str) -> String {
    if text.is_empty() { "no unit".to_owned() } else { format!("the unknown unit `{text}`") }
}
