//! Options of `asperity study`.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

use std::path::PathBuf;

use clap::{Args as Group, Subcommand};

use super::figures::FigureOptions;

/// Run a study: a scenario over a design of its inputs, in chunks that are continued after any
/// interruption.
#[derive(Debug, Group)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Study {
    #[command(subcommand)]
    pub(crate) part: Option<StudyPart>,

    /// Study file (JSON); `asperity schema --study` prints what it may hold.
    #[arg(value_name = "STUDY.json", required = true)]
    pub(crate) file: Option<PathBuf>,

    /// Folder for the results, which is that of one study. Default: out/ and the name of the file.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Continue the study that the folder holds.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Compute part K of N of the chunks only; all parts share the folder. `asperity study merge` joins
    /// them.
    #[arg(long, value_name = "K/N")]
    pub(crate) shard: Option<String>,

    /// Number of threads. Default: all cores.
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<usize>,
}

/// Parts of a study over many machines.
#[derive(Debug, Subcommand)]
pub(crate) enum StudyPart {
    /// Join the chunks of all shards to study.csv, after a check that none is missing, damaged or
    /// foreign.
    Merge {
        /// Folder of the study.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Summarise a finished study: quantiles with intervals, exceedance probabilities, and for
    /// Saltelli's design Sobol indices. Writes answers.json, histograms.csv, exceedance.csv, frf.csv
    /// for a study that asks for receptances, and figures of each.
    Answers {
        /// Study file (JSON).
        #[arg(value_name = "STUDY.json")]
        file: PathBuf,
        /// Folder of the study. Default: out/ and the name of the file.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Also give the probability that an observable, by its column, exceeds a value; repeatable.
        #[arg(long, value_name = "NAME=VALUE")]
        exceed: Vec<String>,
        /// Confidence level of the intervals.
        #[arg(long, value_name = "P", default_value_t = 0.95)]
        level: f64,
        /// Print the answers as JSON on standard output, and nothing else there.
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        figures: FigureOptions,
    },
    /// Print the shards that have chunks missing, such as 3,7-9, as arrays of jobs take them; nothing if
    /// all are there.
    Unfinished {
        /// Folder of the study.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Number of shards.
        #[arg(long, value_name = "N")]
        shards: u64,
    },
    /// Print a script that sends the study to Slurm: an array with a task for each shard, and a job that
    /// joins them and sends those again that are not finished.
    Slurm {
        /// Study file (JSON).
        #[arg(value_name = "STUDY.json")]
        file: PathBuf,
        /// Number of shards.
        #[arg(long, value_name = "N")]
        shards: u64,
        /// Folder for the results, on a file system that all machines share. Default: out/ and the name
        /// of the file.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Cores of each task.
        #[arg(long, value_name = "N", default_value_t = 4,
              value_parser = clap::value_parser!(u32).range(1..=1024))]
        cores: u32,
        /// Memory of each task, as Slurm takes it.
        #[arg(long, value_name = "SIZE", default_value = "4G")]
        memory: String,
        /// Longest time of a task, as Slurm takes it.
        #[arg(long, value_name = "TIME", default_value = "04:00:00")]
        time: String,
        /// Number of times that shards which are not finished are sent again.
        #[arg(long, value_name = "N", default_value_t = 3,
              value_parser = clap::value_parser!(u32).range(0..=1000))]
        retries: u32,
    },
}
