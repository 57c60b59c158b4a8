//! The options of `asperity analyse`, and those it shares with `asperity convert`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::PathBuf;

use asperity_experiment::{
    ChannelSelector, ChannelSensor, FrequencyBand, HitCount, WindowOptions, parse_estimator,
    parse_frf_form,
};
use asperity_measure::{Format, ReadOptions, SampleAxis};
use asperity_signal::{FrfEstimator, FrfForm};
use clap::{Args as Group, ValueEnum};

/// Files to analyse, and the options of the analysis.
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
#[derive(Debug, Group)]
pub(crate) struct Analyse {
    /// The files, one test in this order.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) source: SourceOptions,

    /// Sensor of a channel in volts, such as hammer=2.25mV/N or '#2=100mV/g'; repeatable.
    #[arg(long, value_name = "CHANNEL=SENSITIVITY")]
    pub(crate) sensitivity: Vec<ChannelSensor>,

    /// Channel of the force: its name, '#' and its number, or a quantity. Default: the only force.
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) force: Option<ChannelSelector>,

    /// Channel of the response. Default: the only acceleration, velocity or displacement.
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) response: Option<ChannelSelector>,

    /// The force is negative when the hammer pushes.
    #[arg(long)]
    pub(crate) flip_force: bool,

    /// Number of hits: auto, or the N strongest.
    #[arg(long, value_name = "auto|N", default_value = "auto")]
    pub(crate) hits: HitCount,

    /// Trigger level: the force at which a hit begins, in N. Default: between noise and hits.
    #[arg(long = "level", visible_alias = "trigger-level", value_name = "NEWTONS")]
    pub(crate) trigger_level: Option<f64>,

    /// Longest hit, in s. Default: the median time from hit to hit.
    #[arg(long = "length", visible_alias = "hit-length", value_name = "SECONDS")]
    pub(crate) hit_length: Option<f64>,

    /// Time kept before the trigger, in s.
    #[arg(long, value_name = "SECONDS", default_value_t = 5e-3)]
    pub(crate) pre_trigger: f64,

    /// Time after a trigger in which a second impact makes a double hit, in s.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.2)]
    pub(crate) hold_off: f64,

    /// FRF estimator: h1, h2 or hv.
    #[arg(long, default_value = "h1", value_parser = parse_estimator)]
    pub(crate) estimator: FrfEstimator,

    /// Window: none, force, exponential or force+exponential, the latter two also with :TAU in s.
    ///
    /// The damping added by the exponential window is removed from the features of each hit.
    #[arg(long, default_value = "none")]
    pub(crate) window: WindowOptions,

    /// Frequency band of the fundamental, in Hz. Default: about the strongest resonance of the first
    /// hit.
    #[arg(long, value_name = "LO:HI")]
    pub(crate) band: Option<FrequencyBand>,

    /// Form of the FRF in frf.csv: receptance, mobility or accelerance.
    #[arg(long, default_value = "receptance", value_parser = parse_frf_form)]
    pub(crate) form: FrfForm,

    /// Also average double hits, overloads and dropouts.
    #[arg(long)]
    pub(crate) keep_all: bool,

    /// Folder for the results. Default: out/ and the name of the first file.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write into a folder that holds other files, which are kept, or the results of another file of
    /// the same name, which are replaced.
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Print the analysis as JSON on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Files to convert, and the form of the result.
#[derive(Debug, Group)]
pub(crate) struct Conversion {
    /// The file to read.
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// The file to write.
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) source: SourceOptions,
    /// Format to write, in place of that of the extension: uff (58b), uff-ascii (58), csv or
    /// npz.
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Option<RecordFormat>,
    /// Convert all channels to SI units.
    #[arg(long)]
    pub(crate) si: bool,
    /// Replace OUT if it exists.
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print the conversion as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Names, units and sample rate of files that lack them.
#[derive(Debug, Group)]
pub(crate) struct SourceOptions {
    /// Names of the channels in their order, such as force,acc; an empty one keeps the file's.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    names: Vec<String>,

    /// Units of the channels in their order, such as N,m/s^2; an empty one keeps the file's.
    #[arg(long, value_name = "UNIT,...", value_delimiter = ',')]
    units: Vec<String>,

    /// Samples per second, for a file without a time axis.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,

    /// Axis of an array along which the samples run. Default: the longer one.
    #[arg(long, value_name = "AXIS")]
    sample_axis: Option<ArrayAxis>,
}

/// An axis of an array.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ArrayAxis {
    /// Rows are instants.
    First,
    /// Columns are instants.
    Last,
}

/// A format of measurement files that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecordFormat {
    /// Universal file, dataset 58b.
    Uff,
    /// Universal file, dataset 58.
    UffAscii,
    /// Text.
    Csv,
    /// NumPy arrays.
    Npz,
}

impl SourceOptions {
    /// `options` of a reader with these names, units and rate.
    pub(crate) fn read_options(&self, options: &ReadOptions) -> ReadOptions {
        ReadOptions {
            sample_rate_hz: self.rate,
            sample_axis: self.sample_axis.map(|axis| match axis {
                ArrayAxis::First => SampleAxis::First,
                ArrayAxis::Last => SampleAxis::Last,
            }),
            names: self.names.clone(),
            units: self.units.clone(),
            ..options.clone()
        }
    }
}

impl RecordFormat {
    pub(crate) fn format(self) -> Format {
        match self {
            Self::Uff => Format::UniversalBinary,
            Self::UffAscii => Format::UniversalText,
            Self::Csv => Format::Text,
            Self::Npz => Format::Npz,
        }
    }

    /// Name of a run's record.
    pub(crate) fn file_name(self) -> &'static str {
        match self {
            Self::Uff | Self::UffAscii => "record.uff",
            Self::Csv => "record.csv",
            Self::Npz => "record.npz",
        }
    }
}
