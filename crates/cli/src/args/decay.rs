//! The options of `asperity decay`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::PathBuf;

use asperity_experiment::{ChannelSelector, FrequencyBand};
use clap::Args as Group;

use super::analyse::{AnalysisOutput, MeasuredOptions};

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
