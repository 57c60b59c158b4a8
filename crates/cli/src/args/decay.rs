//! The options of `asperity decay`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::PathBuf;

use asperity_experiment::{ChannelSelector, ChannelSensor, FrequencyBand};
use clap::Args as Group;

use super::analyse::SourceOptions;
use super::figures::FigureOptions;

/// Files with free decays, and the options of their analysis.
#[derive(Debug, Group)]
pub(crate) struct Decay {
    /// The files; folders and patterns such as 'decays/*.mat' too.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    #[command(flatten)]
    pub(crate) source: SourceOptions,

    /// Sensor of a channel in volts, such as top=100mV/g or '#2=100mV/g'; repeatable.
    #[arg(long, value_name = "CHANNEL=SENSITIVITY")]
    pub(crate) sensitivity: Vec<ChannelSensor>,

    /// Channel of a response: its name, '#' and its number, or a quantity; repeatable, or all.
    /// Default: all accelerations, velocities and displacements.
    #[arg(long, value_name = "CHANNEL")]
    pub(crate) response: Vec<ChannelSelector>,

    /// Frequency band with one mode, in Hz; repeatable, one for each mode. Default: about the
    /// strongest resonance of the first decay.
    #[arg(long, value_name = "LO:HI")]
    pub(crate) band: Vec<FrequencyBand>,

    /// Folder for the results. Default: out/ and the name of the first file.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write into a folder that holds other files, which are kept, or the results of another file of
    /// the same name, which are replaced.
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Print decay.json on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) figures: FigureOptions,
}
