//! The options of the command.
#![allow(clippy::doc_markdown, reason = "these comments are help texts, shown without markup")]

pub(crate) mod analyse;
pub(crate) mod figures;
pub(crate) mod law;
pub(crate) mod study;

use std::path::PathBuf;

use asperity_simulation::steady::{BodyModel, SweepDirection};
use clap::{ArgAction, Args as Group, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use analyse::{Analyse, Conversion, Decay, Inspect, RecordFormat, Watch};
use figures::{FigureOptions, MagnitudeAxis};
use law::DeckExport;
use study::Study;

use crate::progress::LogFormat;

/// Dynamics of structures with rough contact interfaces, whose stiffness depends on pressure.
#[derive(Debug, Parser)]
#[command(
    name = "asperity",
    version,
    after_help = "Exit status: 0 done; 1 the run failed; 2 the request is wrong.\n\
                  A scenario is a JSON file; `asperity schema` prints what it may hold."
)]
pub(crate) struct Args {
    /// The subcommand.
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Log the stages of a run with their times to standard error; twice for more details.
    #[arg(short, long, action = ArgAction::Count, global = true)]
    verbose: u8,

    /// Print no progress bar, no warnings and no answer in words.
    #[arg(long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,

    /// Format of the log on standard error: text, or json for one JSON object a line.
    #[arg(
        long,
        global = true,
        value_name = "FORMAT",
        default_value = "text",
        hide_possible_values = true
    )]
    pub(crate) log_format: LogFormat,
}

impl Args {
    /// Amount of logging: -1 errors only, 0 warnings, 1 information, 2 details.
    pub(crate) fn verbosity(&self) -> i8 {
        if self.quiet { -1 } else { i8::try_from(self.verbose).unwrap_or(i8::MAX) }
    }
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate one transient run: static equilibrium, time integration, observables.
    ///
    /// Writes summary.json, history.csv, frf.csv, history.svg, pressure-closure.svg and frf.svg.
    Simulate {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        output: Output,
        /// Also write force, acceleration and displacement as a record, for `asperity analyse`:
        /// uff (58b), uff-ascii (58), csv or npz.
        #[arg(long, value_name = "FORMAT")]
        record: Option<RecordFormat>,
        /// Axis of the magnitude in the figure of the receptance: linear, log or db.
        #[arg(long, value_name = "AXIS", default_value = "log", hide_possible_values = true)]
        magnitude: MagnitudeAxis,
    },
    /// Simulate the cartesian product of the variations, in parallel.
    ///
    /// Writes sweep.csv, a row per run, sweep.json and sweep.svg. The results do not depend on the
    /// number of threads.
    Sweep {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        output: Output,
        /// Vary a value: POINTER=start:stop:count (linear, ends included) or POINTER=v1,v2,...
        ///
        /// POINTER is a JSON Pointer into the scenario, e.g.
        /// /excitation/peak_n=9:32:24. Repeatable; the last varies fastest.
        #[arg(long, value_name = "POINTER=VALUES", required = true)]
        vary: Vec<String>,
        /// Number of threads. Default: all cores.
        #[arg(long, value_name = "N")]
        threads: Option<usize>,
    },
    /// Run a study file: a scenario over a design of its inputs, of any size.
    ///
    /// Writes study.csv, a row per run, with study.json. Runs are computed in chunks that are on disk
    /// whole or not at all; --resume continues after any interruption, with the same bytes. The design
    /// is a grid, random, a Latin hypercube, a Sobol sequence or Saltelli's.
    Study(Study),
    /// Follow the steady responses to a shaker by harmonic balance: a branch over frequency for each
    /// amplitude, with its folds and unstable parts.
    ///
    /// Of the scenario's excitation its place counts, or that it is a motion of the base. Writes
    /// summary.json, steady.csv, steady.svg and report.html, and with --backbone backbone.csv.
    Steady {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        output: Output,
        #[command(flatten)]
        range: SteadyRange,
        /// Number of threads. Default: all cores.
        #[arg(long, value_name = "N")]
        threads: Option<usize>,
    },
    /// Serve a live page of the scenario to the browser of this machine: move its numbers, and see laws,
    /// responses and steady branches drawn anew.
    ///
    /// Prints the address of the page, whose token keeps others out, and opens the browser where there is
    /// one. Nothing is fetched from elsewhere. Ctrl-C ends it.
    Explore {
        #[command(flatten)]
        input: Input,
        /// Port of the address 127.0.0.1. Default: a free one.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
        port: Option<u16>,
        /// Print the address alone, and open no browser.
        #[arg(long)]
        no_browser: bool,
        /// Folder for what the page saves, which is made then. Default: out/ and the name of the scenario's
        /// file with -explore.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Open the page in this state: the part of its address after #.
        #[arg(long, value_name = "TEXT")]
        state: Option<String>,
        /// Show the hits of this analysis beside the computed ones, with chi-square by feature.
        #[arg(long, value_name = "ANALYSIS.json")]
        data: Option<PathBuf>,
    },
    /// Tabulate every law of the scenario: pressure, stiffness, closure, energy.
    ///
    /// Writes law-NAME.csv for each law, law.json and law.svg, and with --export contacts-FORMAT.inp.
    Law {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        output: Output,
        #[command(flatten)]
        export: DeckExport,
        /// Fit C and m of K = C p^m to this CSV of pressure_pa,stiffness_pa_per_m rows.
        #[arg(long, value_name = "TABLE.csv")]
        fit: Option<PathBuf>,
        /// Turn this CSV of gaps and pressures, as a contact solver writes it, into a table law.
        ///
        /// The header is gap_m,pressure_pa; gap or closure in m, mm, um or nm, pressure in pa, kpa,
        /// mpa or gpa. Writes imported-law.json, and tabulates the law with the others.
        #[arg(long, value_name = "TABLE.csv")]
        import_gaps: Option<PathBuf>,
    },
    /// Compute static equilibrium, and the natural frequencies and mode shapes linearised about it.
    ///
    /// Writes modes.json, modes.csv and modes.svg.
    Modes {
        #[command(flatten)]
        input: Input,
        #[command(flatten)]
        output: Output,
        /// Number of modes.
        #[arg(long, value_name = "N", default_value_t = 4,
              value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
        count: usize,
    },
    /// Validate a scenario without running it, and print the size of its run.
    Check {
        #[command(flatten)]
        input: Input,
        /// Print the answer as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Print the JSON Schema of the scenario.
    Schema {
        /// Print the schema of a problem for `asperity identify` instead.
        #[arg(long)]
        identify: bool,
        /// Print the schema of the settings of a rig instead, which `analyse`, `inspect` and
        /// `convert` read.
        #[arg(long, conflicts_with = "identify")]
        rig: bool,
        /// Print the schema of a study file instead.
        #[arg(long, conflicts_with_all = ["identify", "rig"])]
        study: bool,
        /// Print the schema of a scenario whose bodies are given by matrices instead.
        #[arg(long, conflicts_with_all = ["identify", "rig", "study"])]
        matrices: bool,
    },
    /// Identify the contact law, or any numbers of a scenario, from measured responses, with their
    /// uncertainty.
    ///
    /// Writes law.json and scenario.json (inputs of other commands), identification.json, law.csv,
    /// data.csv, posterior.csv, figures and report.html. The answer begins with whether the law may be
    /// used, and why not.
    Identify {
        /// The problem, a JSON file; `asperity schema --identify` prints what it may hold.
        #[arg(value_name = "PROBLEM")]
        problem: PathBuf,
        /// Leave out profiles, the comparison with other laws and the explanations of a misfit.
        #[arg(long)]
        fast: bool,
        #[command(flatten)]
        output: Output,
        /// Number of threads. Default: all cores.
        #[arg(long, value_name = "N")]
        threads: Option<usize>,
    },
    /// Analyse measured hammer hits: FRFs, harmonics, damping and backbones of each and of the
    /// average.
    ///
    /// Reads universal files (58, 58b), CSV and LabVIEW text, NPY, NPZ, MATLAB 5 to 7, WAVE and TDMS,
    /// and HDF5 where built with it; several files are one test. Writes analysis.json, hits.csv,
    /// frf.csv, backbone.csv, figures and report.html.
    Analyse(Box<Analyse>),
    /// Judge the hits of a test while they are measured: each file that is added to a folder.
    ///
    /// Each hit is called good, weak, double hit, overload or dropout within a second after its file is
    /// complete. Then all files are analysed as by `analyse`, whose results are written anew, and the
    /// force of the next hit is proposed. Ctrl-C ends it.
    Watch(Box<Watch>),
    /// Analyse free decays whose force was not measured: frequency, damping and harmonics over
    /// amplitude.
    ///
    /// Finds the decays after blows, after a sustained excitation, or at the beginning of a record, in
    /// the files that `analyse` reads. Writes decay.json, decays.csv, backbone.csv (data of
    /// `identify`), figures and report.html.
    Decay(Box<Decay>),
    /// Describe measurement files: channels, units, rates, ranges, and the channels that `analyse`
    /// would take.
    Inspect(Inspect),
    /// Convert a file of measurements to another format.
    ///
    /// The extension of OUT gives the format: .uff (58b), .csv, .npz. Samples keep their units unless
    /// --si is given.
    Convert(Conversion),
    /// Print the completions of a shell: bash, elvish, fish, powershell or zsh.
    ///
    /// With bash: `asperity completions bash > ~/.local/share/bash-completion/completions/asperity`.
    Completions {
        /// The shell.
        #[arg(value_name = "SHELL", hide_possible_values = true)]
        shell: Shell,
    },
    /// Write the manual pages of the command and of every subcommand: asperity.1, asperity-simulate.1
    /// and so on.
    Man {
        /// Folder for the pages, which are replaced; read them with `man -M`, or below man1 of a folder
        /// of manual pages.
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

/// Force amplitudes and frequency range of steady responses.
#[derive(Debug, Group)]
pub(crate) struct SteadyRange {
    /// Force amplitudes in N; with a motion of the base amplitudes of its acceleration in m/s2.
    #[arg(
        long,
        value_name = "N[,N...]",
        required = true,
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub(crate) amplitude: Vec<f64>,

    /// Frequency in Hz at which each branch starts.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub(crate) from: f64,

    /// Frequency in Hz at which each branch ends; may be the lower one.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub(crate) to: f64,

    /// Number of harmonics. Default: chosen by their truncation, up to 30.
    #[arg(long, value_name = "H")]
    pub(crate) harmonics: Option<usize>,

    /// Also follow the phase resonance and the damped nonlinear mode.
    #[arg(long)]
    pub(crate) backbone: bool,

    /// Light bodies between contacts: elastic, or condensed into one contact in series.
    ///
    /// A body is light if its frequency on its contacts is at least ten times the highest of the range, and if it
    /// has at most 1 % of the kinetic energy of the modes up to three times the range, together with lighter ones.
    #[arg(long, value_name = "MODEL", value_enum, default_value_t = Bodies::Auto)]
    pub(crate) bodies: Bodies,

    /// Also integrate a stepped sine in time, with rising or falling frequency or both.
    ///
    /// One frequency after another without a pause, as on a shaker, so that the motion stays on its
    /// branch and jumps at folds. All bodies keep their inertia.
    #[arg(long, value_name = "DIRECTION", value_enum)]
    pub(crate) sweep: Option<Direction>,

    /// Number of frequencies of the stepped sine, both ends of the range included.
    #[arg(long, value_name = "N", requires = "sweep", default_value_t = 201)]
    pub(crate) sweep_points: usize,

    /// Also integrate one response of each branch in time, and report the difference: above 1 % as a warning.
    ///
    /// The response is the peak; if another response has its frequency, the highest response that is
    /// the only one at its frequency.
    #[arg(long)]
    pub(crate) verify: bool,
}

/// Directions of a stepped sine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Direction {
    /// Rising frequency.
    Up,
    /// Falling frequency.
    Down,
    /// One after the other.
    Both,
}

impl From<Direction> for SweepDirection {
    fn from(direction: Direction) -> Self {
        match direction {
            Direction::Up => Self::Up,
            Direction::Down => Self::Down,
            Direction::Both => Self::Both,
        }
    }
}

/// Treatment of light bodies between contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Bodies {
    /// Elastic; condensed where contact is lost on a branch.
    Auto,
    /// Elastic, with their inertia.
    Elastic,
    /// Condensed.
    Condensed,
}

impl From<Bodies> for BodyModel {
    fn from(bodies: Bodies) -> Self {
        match bodies {
            Bodies::Auto => Self::Auto,
            Bodies::Elastic => Self::Elastic,
            Bodies::Condensed => Self::Condensed,
        }
    }
}

/// The scenario and its changes.
#[derive(Debug, Group)]
pub(crate) struct Input {
    /// The scenario, a JSON file.
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenario: PathBuf,

    /// Change a value of the scenario; repeatable.
    ///
    /// POINTER is a JSON Pointer, e.g. /excitation/peak_n=20. VALUE is JSON, or else text.
    #[arg(long, value_name = "POINTER=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Destination of the results.
#[derive(Debug, Group)]
pub(crate) struct Output {
    /// Folder for the results. Default: out/ and the name of the scenario's file.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write into a folder that holds other files, which are kept, or the results of another file of
    /// the same name, which are replaced.
    #[arg(long, visible_alias = "force")]
    pub(crate) overwrite: bool,

    /// Print the summary as JSON on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) figures: FigureOptions,
}
