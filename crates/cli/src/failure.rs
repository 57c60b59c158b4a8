//! Errors of the command, their exit status, and the options that help.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use asperity_dynamics::DynamicsError;
use asperity_experiment::AnalysisError;
use asperity_figure::FigureError;
use asperity_harmonic::HarmonicError;
use asperity_identify::IdentificationError;
use asperity_measure::MeasureError;
use asperity_scenario::{Diagnostic, DocumentError, InvalidDocument, SetError};
use asperity_structure::StructureError;
use asperity_study::error::{OutputError, StudyError};
use asperity_study::sweep::{SweepError, VariationError};
use thiserror::Error;

use crate::excerpt::{Label, show_excerpts};
use crate::progress::show_line;

/// Most problems of one scenario that are shown.
const MOST_SHOWN: usize = 20;

/// Errors of the command.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("--set {argument}: {accepted}")]
    SetForm { argument: String, accepted: &'static str },
    #[error("--set {source}")]
    Set { source: SetError },
    #[error("the scenario is invalid")]
    Invalid { text: String, path: PathBuf, source: InvalidDocument },
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error("--vary {0}")]
    Variation(#[from] VariationError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error("{failed} of {of} failed; the first, {first}: {reason}")]
    Parts { failed: usize, of: String, first: String, reason: String },
    #[error("cannot start {threads} threads; accepted: 1 to 1024")]
    Threads { threads: usize },
    #[error(transparent)]
    Figure(#[from] FigureError),
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    #[error(transparent)]
    Problem(Box<IdentificationError>),
    #[error("the answer cannot be written to standard output: {0}")]
    Answer(std::io::Error),
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Study(error.into())
    }
}

impl From<StructureError> for Failure {
    fn from(error: StructureError) -> Self {
        Self::Study(error.into())
    }
}

impl Failure {
    /// 2 for a wrong request, 1 for a run that failed.
    pub(crate) fn exit_code(&self) -> ExitCode {
        let request_is_wrong = match self {
            Self::Study(error) => is_wrong_request(error),
            Self::Parts { .. } | Self::Figure(_) | Self::Answer(_) => false,
            Self::Analysis(error) => error.is_wrong_request(),
            Self::Problem(error) => error.is_wrong_request(),
            _ => true,
        };
        ExitCode::from(if request_is_wrong { 2 } else { 1 })
    }

    /// Shows the failure on standard error, with its place in the scenario where it has one.
    pub(crate) fn show(&self) {
        match self {
            _ if crate::progress::logs_json() => {
                if let Self::Invalid { source, .. } = self {
                    source.diagnostics.iter().for_each(|problem| tracing::error!("{problem}"));
                }
                tracing::error!(hint = self.hint(), "{self}");
            }
            Self::Invalid { text, path, source } => show_invalid(text, path, source),
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
            Self::Study(StudyError::Output(OutputError::Occupied { .. })) => Some(
                "choose another folder with --out, or write beside these files with \
                     --overwrite, which replaces only those that have the name of a new file"
                    .into(),
            ),
            Self::Study(StudyError::Output(
                OutputError::OtherDocument { .. } | OutputError::OtherKind { .. },
            )) => Some(
                "choose another folder with --out, or replace these results with --overwrite"
                    .into(),
            ),
            Self::Study(StudyError::Output(OutputError::Busy { .. })) => {
                Some("wait until it has ended, or choose another folder with --out".into())
            }
            Self::Study(StudyError::Output(OutputError::NotAFolder { .. })) => {
                Some("choose another folder with --out".into())
            }
            Self::Analysis(error) => analysis_hint(error),
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
            "hold_off_s" => "hold_off_s is the option --hold-off SECONDS".into(),
            "the output file" => "--to FORMAT gives the format".into(),
            _ => return None,
        },
        AnalysisError::Measure(MeasureError::Exists { .. }) => {
            "choose another name, or replace the file with --overwrite".into()
        }
        AnalysisError::SameFile { .. } => "choose another name".into(),
        AnalysisError::NoChannel { role, .. } => {
            format!("select one with --{role}, or describe the channels with --names and --units")
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
        AnalysisError::NoGoodHit { .. } => "--keep-all averages them".into(),
        _ => return None,
    })
}

fn is_wrong_request(error: &StudyError) -> bool {
    match error {
        StudyError::Samples { .. }
        | StudyError::Input { .. }
        | StudyError::FitTable(_)
        | StudyError::Document(_)
        | StudyError::Set(_)
        | StudyError::Scenario { .. }
        | StudyError::OtherColumns
        | StudyError::Law { .. } => true,
        StudyError::Output(error) => !matches!(error, OutputError::Io { .. }),
        StudyError::Structure(error) | StudyError::Dynamics(DynamicsError::Structure(error)) => {
            is_wrong_structure(error)
        }
        StudyError::Dynamics(error) => matches!(
            error,
            DynamicsError::Setting { .. }
                | DynamicsError::TooLarge { .. }
                | DynamicsError::Mesh(_)
                | DynamicsError::ForceRecord { .. }
        ),
        StudyError::Harmonic(error) => !matches!(
            error,
            HarmonicError::NoStart { .. }
                | HarmonicError::NoLinearResponse { .. }
                | HarmonicError::BeyondLaw { .. }
        ),
        // Signals that cannot be analysed, and errors to come.
        _ => false,
    }
}

fn is_wrong_structure(error: &StructureError) -> bool {
    matches!(error, StructureError::Setting { .. } | StructureError::Mesh(_))
}

/// Shows every problem, first in one line, then at its place in the text.
fn show_invalid(text: &str, path: &Path, invalid: &InvalidDocument) {
    let problems = &invalid.diagnostics;
    let shown = &problems[..problems.len().min(MOST_SHOWN)];
    show_line(&format!(
        "error: {} is not a valid scenario: {} {}",
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
