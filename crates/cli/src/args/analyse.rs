//! Options of the commands that read measurements: `analyse`, `decay`, `watch`, `inspect`, `convert`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::PathBuf;

use asperity_experiment::{
    ChannelSelector, ChannelSensor, FrequencyBand, HitCount, WindowOptions, parse_estimator,
    parse_frf_form,
};
use asperity_measure::{Format, InvalidCells, ReadOptions, SampleAxis};
use asperity_signal::{FrfEstimator, FrfForm};
use clap::{Args as Group, ValueEnum};

use super::figures::{FigureOptions, MagnitudeAxis, figure_file};

/// Files to analyse, and the options of the analysis.
#[derive(Debug, Group)]
pub(crate) struct Analyse {
    /// The files, one test in this order; folders and patterns such as 'hits/*.npy' too.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) analysis: AnalysisArguments,
}

/// A folder to watch, and the options of the analysis of its files.
///
/// Lines on standard input reject hits by the numbers that are printed, and take them back: `reject 3,7`
/// and `keep 3`.
#[derive(Debug, Group)]
pub(crate) struct Watch {
    /// The folder to which the files of a test are added.
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,

    /// Force levels in N to be hit three times each, such as 5,10,20,40. Default: repeat each level,
    /// then fill gaps.
    #[arg(long, value_name = "N,...", value_delimiter = ',')]
    pub(crate) levels: Vec<f64>,

    /// Problem of `asperity identify` with a `design`: after each file it is identified in the
    /// background, and its best next hit is said.
    #[arg(long, value_name = "PROBLEM")]
    pub(crate) problem: Option<PathBuf>,

    /// End when all files of the folder are judged.
    #[arg(long)]
    pub(crate) once: bool,

    #[command(flatten)]
    pub(crate) analysis: AnalysisArguments,
}

/// Options of an analysis.
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
#[derive(Debug, Group)]
pub(crate) struct AnalysisArguments {
    #[command(flatten)]
    pub(crate) channels: HammerChannels,

    /// The force is negative when the hammer pushes.
    #[arg(long)]
    pub(crate) flip_force: bool,

    /// Number of hits: auto, or the N strongest.
    #[arg(long, value_name = "auto|N", default_value = "auto")]
    pub(crate) hits: HitCount,

    /// Trigger level: the force at which a hit begins, in N. Default: between noise and hits.
    #[arg(
        long = "level",
        visible_alias = "trigger-level",
        value_name = "NEWTONS",
        allow_negative_numbers = true
    )]
    pub(crate) trigger_level: Option<f64>,

    /// Longest hit, in s. Default: the median time from hit to hit.
    #[arg(
        long = "length",
        visible_alias = "hit-length",
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    pub(crate) hit_length: Option<f64>,

    /// Time kept before the trigger, in s. Default: 0.005.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) pre_trigger: Option<f64>,

    /// Time after a trigger in which a second impact makes a double hit, in s. Default: 0.2.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) hold_off: Option<f64>,

    /// FRF estimator: h1, h2 or hv. Default: h1.
    #[arg(long, value_parser = parse_estimator)]
    pub(crate) estimator: Option<FrfEstimator>,

    /// Window: auto, none, force, exponential or force+exponential, the latter two also with :TAU in s.
    ///
    /// auto, the default, sets force and response to zero where they are noise. The damping added by
    /// the exponential window is removed from the features of each hit.
    #[arg(long)]
    pub(crate) window: Option<WindowOptions>,

    /// Frequency band of the fundamental, in Hz. Default: about the strongest resonance of the first
    /// hit.
    #[arg(long, value_name = "LO:HI")]
    pub(crate) band: Option<FrequencyBand>,

    /// High-pass of second order with its corner at this frequency in Hz, for the responses: takes out
    /// drifts. The mean before each blow is always taken out.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub(crate) high_pass: Option<f64>,

    /// Numbers of hits to leave out of averages, such as 3,7.
    #[arg(long, value_name = "HIT,...", value_delimiter = ',')]
    pub(crate) reject: Vec<usize>,

    /// Form of the FRF in frf.csv: receptance, mobility or accelerance.
    #[arg(long, default_value = "receptance", value_parser = parse_frf_form)]
    pub(crate) form: FrfForm,

    /// Also write the FRFs of the hits and their average, in the form of --form, as frfs.uff (58b or
    /// 58), frfs.npz, or frfs.csv with real and imaginary parts.
    #[arg(long, value_name = "FORMAT")]
    pub(crate) frfs: Option<RecordFormat>,

    /// Also average double hits, overloads and dropouts.
    #[arg(long)]
    pub(crate) keep_all: bool,

    #[command(flatten)]
    pub(crate) output: AnalysisOutput,

    /// Axis of the magnitudes in the figure of the FRFs: linear, log or db.
    #[arg(long, value_name = "AXIS", default_value = "log", hide_possible_values = true)]
    pub(crate) magnitude: MagnitudeAxis,
}

/// Files to describe.
#[derive(Debug, Group)]
pub(crate) struct Inspect {
    /// The files; folders and patterns such as 'hits/*.npy' too.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) channels: HammerChannels,

    /// Also write the settings of a rig, as found in the first file, to complete and to give to
    /// --rig.
    #[arg(long, value_name = "FILE")]
    pub(crate) write_rig: Option<PathBuf>,

    /// Also draw the frequency response functions of the first file as receptances with their coherences, to a
    /// file .svg, .pdf or .png.
    #[arg(long, value_name = "FIGURE", value_parser = figure_file)]
    pub(crate) draw: Option<PathBuf>,

    /// Unit of these functions where the file gives none, such as m/s^2/N.
    #[arg(long, value_name = "UNIT", requires = "draw")]
    pub(crate) frf_unit: Option<String>,

    /// Replace these files if they exist.
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Print the description as JSON: one object, or an array for several files.
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
    /// Format to write, in place of the extension's: uff (58b), uff-ascii (58), csv or
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

/// Files with free decays, and the options of their analysis.
#[derive(Debug, Group)]
pub(crate) struct Decay {
    /// The files; folders and patterns such as 'decays/*.mat' too.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) measured: MeasuredOptions,

    /// Channel of a response: its name, '#' and its number, or a quantity; repeatable, or all.
    /// Default: all accelerations, velocities and displacements.
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) response: Vec<ChannelSelector>,

    /// Frequency band with one mode, in Hz; repeatable, one for each mode. Default: about the
    /// strongest resonance of the first decay.
    #[arg(long, value_name = "LO:HI")]
    pub(crate) band: Vec<FrequencyBand>,

    #[command(flatten)]
    pub(crate) output: AnalysisOutput,
}

/// Channels of a hammer test.
#[derive(Debug, Group)]
pub(crate) struct HammerChannels {
    #[command(flatten)]
    pub(crate) measured: MeasuredOptions,

    /// Channel of the force: its name, '#' and its number, or a quantity. Default: the only force.
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) force: Option<ChannelSelector>,

    /// Channel of a response, repeatable, or all. Default: the only acceleration, velocity or
    /// displacement.
    ///
    /// With several, files of the first have their usual names, those of the others end in their
    /// channel's, such as hits_acc2.csv.
    #[arg(long, value_name = "CHANNEL|all")]
    pub(crate) response: Vec<ChannelSelector>,
}

/// Properties that files of measurements lack, and the sensors of their channels.
#[derive(Debug, Group)]
pub(crate) struct MeasuredOptions {
    #[command(flatten)]
    pub(crate) source: SourceOptions,

    /// Sensor of a channel in volts, such as hammer=2.25mV/N or '#2=100mV/g'; repeatable.
    #[arg(long, value_name = "CHANNEL=SENSITIVITY")]
    pub(crate) sensitivity: Vec<ChannelSensor>,
}

/// Destination and form of the result of an analysis of measurements.
#[derive(Debug, Group)]
pub(crate) struct AnalysisOutput {
    /// Folder for the results. Default: out/ and the name of the first file or folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write into a folder that holds other files, which are kept, or the results of another file of
    /// the same name, which are replaced.
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Print the analysis as JSON on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) figures: FigureOptions,
}

/// Names, units and sample rate of files that lack them.
#[derive(Debug, Group)]
pub(crate) struct SourceOptions {
    /// Settings of the rig, a JSON file; `asperity schema --rig` prints what it may hold. Options of
    /// the command line win over it.
    #[arg(long, value_name = "FILE")]
    pub(crate) rig: Option<PathBuf>,

    /// Names of all channels in their order, such as force,acc; an empty one keeps the file's.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    names: Vec<String>,

    /// Units of all channels in their order, such as N,m/s^2; an empty one keeps the file's.
    #[arg(long, value_name = "UNIT,...", value_delimiter = ',')]
    units: Vec<String>,

    /// Samples per second, for a file without a time axis.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: Option<f64>,

    /// Axis of an array along which the samples run. Default: the longer one.
    #[arg(long, value_name = "AXIS")]
    sample_axis: Option<ArrayAxis>,

    /// Cells of a text that are no number, such as --- or OVL: refuse them with their row, the default,
    /// or take them as dropout or overload, which disqualifies their hit.
    #[arg(long, value_name = "AS", hide_possible_values = true)]
    invalid_cells: Option<CellsTaken>,
}

/// Treatment of cells that are no number.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum CellsTaken {
    /// An error that names the row.
    Refuse,
    /// Missing samples.
    Dropout,
    /// Samples beyond the range of the sensor.
    Overload,
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
        let axis = self.sample_axis.map(|axis| match axis {
            ArrayAxis::First => SampleAxis::First,
            ArrayAxis::Last => SampleAxis::Last,
        });
        // Those of a rig may be of the first channels only.
        let given = self.names.len().max(self.units.len());
        let or = |own: &[String], known: &[String]| {
            if !own.is_empty() {
                return own.to_vec();
            }
            let mut known = known.to_vec();
            known.resize(if known.is_empty() { 0 } else { given.max(known.len()) }, String::new());
            known
        };
        ReadOptions {
            sample_rate_hz: self.rate.or(options.sample_rate_hz),
            sample_axis: axis.or(options.sample_axis),
            names: or(&self.names, &options.names),
            units: or(&self.units, &options.units),
            complete: given > 0,
            invalid_cells: self.invalid_cells.map_or(options.invalid_cells, |taken| match taken {
                CellsTaken::Refuse => InvalidCells::Refuse,
                CellsTaken::Dropout => InvalidCells::Dropout,
                CellsTaken::Overload => InvalidCells::Overload,
            }),
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

    /// True for a format without complex samples.
    pub(crate) fn is_text(self) -> bool {
        self == Self::Csv
    }

    /// Name of a file with frequency response functions.
    pub(crate) fn frf_file_name(self) -> &'static str {
        match self {
            Self::Uff | Self::UffAscii => "frfs.uff",
            Self::Csv => "frfs.csv",
            Self::Npz => "frfs.npz",
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
