//! Errors of the command, their exit status, and the options that help.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use asperity_experiment::{AnalysisError, FUNCTION_ROLE};
use asperity_explore::ExploreError;
use asperity_figure::FigureError;
use asperity_identify::IdentificationError;
use asperity_measure::MeasureError;
use asperity_scenario::{Diagnostic, DocumentError, InvalidDocument, SetError};
use asperity_simulation::error::{OutputError, SimulationError};
use asperity_simulation::sweep::{SweepError, VariationError};
use asperity_structure::StructureError;
use asperity_study::StudyError;
use thiserror::Error;

use crate::excerpt::{Label, show_excerpts};
use crate::file_kind::WrongKind;
use crate::progress::show_line;

/// Exit status of a command that was stopped, as of shells after Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// Most problems of one scenario that are shown.
const MOST_SHOWN: usize = 20;

/// Errors of the command.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    #[error("{0}")]
    Usage(clap::Error),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("--set {argument}: {accepted}")]
    SetForm { argument: String, accepted: &'static str },
    #[error("--set {source}")]
    Set { source: SetError },
    #[error(transparent)]
    WrongKind(#[from] WrongKind),
    #[error("the {kind} is invalid")]
    Invalid { kind: &'static str, text: String, path: PathBuf, source: InvalidDocument },
    #[error("{} has no `design`", path.display())]
    NoDesign { path: PathBuf },
    #[error(transparent)]
    Study(#[from] SimulationError),
    #[error("--vary {0}")]
    Variation(#[from] VariationError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error("{failed} of {of} failed; the first, {first}: {reason}")]
    Parts { failed: usize, of: String, first: String, reason: String },
    #[error("{reason}; nothing was written: {} keeps its earlier result", folder.display())]
    Kept { folder: PathBuf, reason: String },
    #[error("{}: bodies of matrices are taken by check, modes, simulate, steady, study and sweep; accepted by this command: bars", path.display())]
    OfMatrices { path: PathBuf },
    #[error("cannot start {threads} threads; accepted: 1 to 1024")]
    Threads { threads: usize },
    #[error("{rows} rows; {code} takes {} to {}", accepted.start(), accepted.end())]
    Rows { rows: usize, code: &'static str, accepted: RangeInclusive<usize> },
    #[error(transparent)]
    Figure(#[from] FigureError),
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    #[error(transparent)]
    Problem(Box<IdentificationError>),
    #[error("the manual pages cannot be written to {}: {source}", folder.display())]
    Pages { folder: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Ensemble(Box<StudyError>),
    #[error("--exceed {argument}: accepted: NAME=VALUE, e.g. harmonic_ratio=0.1")]
    ExceedForm { argument: String },
    #[error("--shard {argument}: accepted: K/N, e.g. 3/8")]
    ShardForm { argument: String },
    #[error(
        "stopped; the chunks that were complete are kept, and `asperity study {} --out {}{shard} --resume` goes on",
        file.display(), folder.display()
    )]
    StoppedStudy { file: PathBuf, folder: PathBuf, shard: String },
    #[error("stopped; {} holds what was finished", .0.display())]
    Stopped(PathBuf),
    #[error(transparent)]
    Explore(#[from] ExploreError),
    #[error("the answer cannot be written to standard output: {0}")]
    Answer(std::io::Error),
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Study(error.into())
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        Self::Ensemble(Box::new(error))
    }
}

impl From<StructureError> for Failure {
    fn from(error: StructureError) -> Self {
        Self::Study(error.into())
    }
}

impl Failure {
    /// 2 for a wrong request, 1 for a run that failed, 130 for a stopped one.
    pub(crate) fn exit_status(&self) -> u8 {
        let request_is_wrong = match self {
            Self::Stopped(_) | Self::StoppedStudy { .. } => return INTERRUPTED,
            Self::Problem(error) if matches!(**error, IdentificationError::StoppedAtOnce) => {
                return INTERRUPTED;
            }
            Self::Study(error) => error.is_wrong_request(),
            Self::Parts { .. }
            | Self::Kept { .. }
            | Self::Figure(_)
            | Self::Pages { .. }
            | Self::Answer(_) => false,
            Self::Analysis(error) => error.is_wrong_request(),
            Self::Ensemble(error) => error.is_wrong_request(),
            Self::Problem(error) => error.is_wrong_request(),
            _ => true,
        };
        if request_is_wrong { 2 } else { 1 }
    }

    /// Shows the failure on standard error, with its place in the scenario where it has one.
    pub(crate) fn show(&self) {
        match self {
            Self::Usage(error) => crate::usage::show(error),
            _ if crate::progress::logs_json() => {
                if let Self::Invalid { source, .. } = self {
                    source.diagnostics.iter().for_each(|problem| tracing::error!("{problem}"));
                }
                tracing::error!(hint = self.hint(), "{self}");
            }
            Self::Invalid { kind, text, path, source } => show_invalid(kind, text, path, source),
            Self::Document(DocumentError::Syntax { path, text, source }) => {
                show_line(&format!("error: {self}"));
                let label = Label { span: source.span.clone(), text: "here".to_owned() };
                show_excerpts(path, text, &[label]);
            }
            _ => {
                show_line(&format!("error: {self}"));
                if let Some(hint) = self.hint() {
                    show_line(&format!("hint: {hint}"));
                }
            }
        }
    }

    /// Options of the command that help with the failure.
    fn hint(&self) -> Option<String> {
        match self {
            Self::Study(SimulationError::Output(OutputError::Occupied { .. })) => Some(
                "choose another folder with --out, or write beside these files with \
                     --overwrite, which replaces only those that have the name of a new file"
                    .into(),
            ),
            Self::Study(SimulationError::Output(
                OutputError::OtherDocument { .. } | OutputError::OtherKind { .. },
            )) => Some(
                "choose another folder with --out, or replace these results with --overwrite"
                    .into(),
            ),
            Self::Study(SimulationError::Output(OutputError::Busy { .. })) => {
                Some("wait until it has ended, or choose another folder with --out".into())
            }
            Self::Study(SimulationError::Output(OutputError::NotAFolder { .. })) => {
                Some("choose another folder with --out".into())
            }
            Self::Analysis(error) => analysis_hint(error),
            Self::Problem(error) if matches!(**error, IdentificationError::StoppedAtOnce) => {
                Some("nothing was written; an earlier result is kept".into())
            }
            Self::Ensemble(error) => match **error {
                StudyError::Begun { .. } => {
                    Some("go on with --resume, or choose another folder with --out".into())
                }
                StudyError::Foreign { .. } => Some("choose another folder with --out".into()),
                StudyError::Missing { .. } => Some(
                    "`asperity study` with --resume, or with the shards that failed, computes them"
                        .into(),
                ),
                _ => None,
            },
            Self::WrongKind(WrongKind { path, found, .. }) => {
                found.command(path).map(|command| format!("`{command}` reads it"))
            }
            _ => None,
        }
    }
}

/// Options of the command that help with an error of an analysis or a conversion.
fn analysis_hint(error: &AnalysisError) -> Option<String> {
    Some(match error {
        AnalysisError::Setting { name, .. } => match *name {
            "trigger_level_n" => "trigger_level_n is the option --level NEWTONS".into(),
            "hit_length_s" => "hit_length_s is the option --length SECONDS".into(),
            "pre_trigger_s" => "pre_trigger_s is the option --pre-trigger SECONDS".into(),
            "high_pass_hz" => "high_pass_hz is the option --high-pass HZ".into(),
            "hold_off_s" => "hold_off_s is the option --hold-off SECONDS".into(),
            "the output file" => "--to FORMAT gives the format".into(),
            _ => return None,
        },
        AnalysisError::Measure(MeasureError::Exists { .. }) => {
            "choose another name, or replace the file with --overwrite".into()
        }
        AnalysisError::Measure(MeasureError::InvalidCell { .. }) => {
            "--invalid-cells dropout takes such cells as missing samples, --invalid-cells overload as \
             samples beyond the sensor's range; their hits are then left out of averages"
                .into()
        }
        AnalysisError::NoChannel { channels, role, .. } if channels.contains("(voltage") => {
            // Listed as #1 `hammer` (voltage, V).
            let before = channels.split("` (voltage").next().unwrap_or_default();
            let name = before.rsplit('`').next().unwrap_or("hammer");
            let unit = if *role == "force" { "2.25mV/N" } else { "10.2mV/(m/s^2)" };
            let sensitivity = format!("--sensitivity \"{name}={unit}\"");
            format!("volts are converted with --sensitivity CHANNEL=SENSITIVITY, such as {sensitivity}")
        }
        AnalysisError::SameFile { .. } => "choose another name".into(),
        AnalysisError::NoChannel { role: "force", .. } => {
            "select one with --force, or describe the channels with --names and --units; decays \
             without a force are for `asperity decay`"
                .into()
        }
        AnalysisError::NoChannel { role: FUNCTION_ROLE, .. }
        | AnalysisError::Ambiguous { role: FUNCTION_ROLE, .. } => {
            "\"function\" of the data names one, as \"NAME\" or \"#NUMBER\"".into()
        }
        AnalysisError::NoChannel { role, .. } => {
            format!("select one with --{role}, or describe the channels with --names and --units")
        }
        AnalysisError::Ambiguous { role: "response", .. } => {
            "select one with --response NAME or --response '#NUMBER', several by repeating it, or \
             --response all"
                .into()
        }
        AnalysisError::Ambiguous { role, .. } => {
            format!("select one with --{role} NAME or --{role} '#NUMBER'")
        }
        AnalysisError::Unit { .. } => {
            "give the units of all channels in their order with --units, such as --units N,m/s^2"
                .into()
        }
        AnalysisError::NoRate { .. } => "give the sample rate with --rate HZ".into(),
        AnalysisError::Quantity { .. } => {
            "volts are converted with --sensitivity CHANNEL=SENSITIVITY".into()
        }
        AnalysisError::NoHit { .. } => {
            "--level NEWTONS sets the trigger level, and --flip-force reverses a force that is \
             negative while the hammer pushes"
                .into()
        }
        AnalysisError::NoDecay { .. } => {
            "a decay begins with a blow, or where a shaker stops, and needs some cycles until it is \
             noise; `asperity inspect` shows what the channels hold, --response selects one, and \
             records of hits with their force are for `asperity analyse`"
                .into()
        }
        AnalysisError::NoGoodHit { .. } => {
            "--keep-all averages them, --force CHANNEL selects another force".into()
        }
        _ => return None,
    })
}

/// Shows every problem, first in one line, then at its place in the text.
fn show_invalid(kind: &str, text: &str, path: &Path, invalid: &InvalidDocument) {
    let problems = &invalid.diagnostics;
    let shown = &problems[..problems.len().min(MOST_SHOWN)];
    show_line(&format!(
        "error: {} is not a valid {kind}: {} {}",
        path.display(),
        problems.len(),
        if problems.len() == 1 { "problem" } else { "problems" }
    ));
    for problem in shown {
        show_line(&problem.to_string());
    }
    if problems.len() > shown.len() {
        show_line(&format!("... and {} more", problems.len() - shown.len()));
    }
    let label = |problem: &Diagnostic| {
        Some(Label { span: problem.span.clone()?, text: problem.pointer.clone() })
    };
    let labels: Vec<Label> = shown.iter().filter_map(label).collect();
    show_excerpts(path, text, &labels);
}
