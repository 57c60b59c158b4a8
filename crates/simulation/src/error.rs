//! Errors of studies.

use std::io;
use std::path::PathBuf;

use asperity_dynamics::DynamicsError;
use asperity_harmonic::HarmonicError;
use asperity_law::LawError;
use asperity_signal::SignalError;
use asperity_structure::StructureError;
use thiserror::Error;

use crate::gap_table::GapTableError;
use asperity_scenario::{DocumentError, InputError, SamplesError};

/// An error of a study of a valid scenario, or of writing its results.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A scenario without a sensor.
    #[error("the scenario has no sensor; expected at least one")]
    NoSensor,
    /// The laws, bodies or interfaces do not make a structure at rest.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// The structure cannot be integrated.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A response cannot be integrated with any step that was tried.
    #[error(
        "{source}; steps down to {step_s:.1e} s were tried; finite differences may resolve the response"
    )]
    NotResolved {
        /// Shortest step tried \[s\].
        step_s: f64,
        /// Error at that step.
        source: DynamicsError,
    },
    /// A steady response cannot be computed.
    #[error(transparent)]
    Harmonic(#[from] HarmonicError),
    /// No body can be condensed in steady responses.
    #[error(
        "no body can be condensed; accepted: bodies between two contacts of equal damping proportional to the stiffness, or of none, whose frequency on them is at least {least_hz:.1} Hz, ten times the highest of the range, and which have at most {} % of the kinetic energy of a mode up to three times the range, together with lighter ones; found: {found}",
        100.0 * most_share
    )]
    NothingToCondense {
        /// The bodies between contacts with their frequencies and shares of the kinetic energy, in words.
        found: String,
        /// Least frequency of a body that can be condensed \[Hz\].
        least_hz: f64,
        /// Largest share in the kinetic energy of a body that can be condensed.
        most_share: f64,
    },
    /// Matrices, meshes, cells or loads cannot be read.
    #[error(transparent)]
    Matrices(#[from] asperity_matrices::MatricesError),
    /// A part of a structure of matrices does not fit the others.
    #[error("{place}: {problem}; accepted: {accepted}")]
    Model {
        /// Pointer into the scenario.
        place: String,
        /// The problem.
        problem: String,
        /// The values accepted.
        accepted: String,
    },
    /// A contact law cannot be built for the pressure it has to carry.
    #[error("law \"{law}\"{} (pressure {pressure_pa} Pa): {source}", at(interface.as_deref()))]
    Law {
        /// The law's name, or "in place".
        law: String,
        /// The interface that uses it, if one does.
        interface: Option<String>,
        /// Static pressure there \[Pa\].
        pressure_pa: f64,
        /// The fault.
        source: LawError,
    },
    /// The damping of an interface is out of range.
    #[error("damping of interface \"{interface}\": {source}")]
    ContactDamping {
        /// The interface.
        interface: String,
        /// The fault.
        source: LawError,
    },
    /// The friction of an interface or a body is out of range.
    #[error("friction of \"{element}\": {source}")]
    Friction {
        /// The interface or the body.
        element: String,
        /// The fault.
        source: LawError,
    },
    /// A file that the result depends on cannot be read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The fault.
        source: InputError,
    },
    /// The force samples cannot be read.
    #[error("{}: {source}", path.display())]
    Samples {
        /// The file.
        path: PathBuf,
        /// The fault in it.
        source: SamplesError,
    },
    /// The response cannot be analysed.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A table of pressures and stiffnesses to fit cannot be read.
    #[error(transparent)]
    FitTable(#[from] FitTableError),
    /// A table of gaps and pressures is not a law.
    #[error(transparent)]
    GapTable(#[from] GapTableError),
    /// The output folder cannot take the results.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A value of a sweep cannot be set.
    #[error(transparent)]
    Set(#[from] asperity_scenario::SetError),
    /// A combination of values is not a valid scenario, though each value is.
    #[error("these values do not make a valid scenario: {0}")]
    Scenario(String),
    /// A run of a sweep has other interfaces than the first, and so other columns.
    #[error("this run has other interfaces than the first run of the sweep")]
    OtherColumns,
    /// A scenario cannot be read again for a run of a sweep.
    #[error(transparent)]
    Document(#[from] DocumentError),
}

impl SimulationError {
    /// A fault of a structure of matrices at a pointer into the scenario.
    pub(crate) fn model(
        place: &str,
        problem: impl Into<String>,
        accepted: impl Into<String>,
    ) -> Self {
        let (problem, accepted) = (problem.into(), accepted.into());
        Self::Model { place: place.to_owned(), problem, accepted }
    }

    /// True for a response that a shorter step or more modes may have.
    pub(crate) fn is_mended_by_refinement(&self) -> bool {
        let Self::Dynamics(error) = self else { return false };
        match error {
            DynamicsError::Unstable { .. } | DynamicsError::Coarse { .. } => true,
            DynamicsError::Law { source, .. } => matches!(source, LawError::Unresolved { .. }),
            _ => false,
        }
    }

    /// True if the scenario or the request is to be changed; false if the computation failed.
    pub fn is_wrong_request(&self) -> bool {
        match self {
            Self::Samples { .. }
            | Self::Input { .. }
            | Self::FitTable(_)
            | Self::GapTable(_)
            | Self::Document(_)
            | Self::Set(_)
            | Self::Scenario { .. }
            | Self::OtherColumns
            | Self::NoSensor
            | Self::NothingToCondense { .. }
            | Self::ContactDamping { .. }
            | Self::Matrices(_)
            | Self::Model { .. }
            | Self::Friction { .. }
            | Self::Law { .. } => true,
            Self::Output(error) => !matches!(error, OutputError::Io { .. }),
            Self::Structure(error) | Self::Dynamics(DynamicsError::Structure(error)) => {
                is_wrong_structure(error)
            }
            Self::Dynamics(error) => matches!(
                error,
                DynamicsError::Setting { .. }
                    | DynamicsError::TooLarge { .. }
                    | DynamicsError::Mesh(_)
                    | DynamicsError::LossFactor { .. }
                    | DynamicsError::ModalDamping { .. }
            ),
            Self::Harmonic(error) => !matches!(
                error,
                HarmonicError::NoStart { .. }
                    | HarmonicError::NoLinearResponse { .. }
                    | HarmonicError::BeyondLaw { .. }
            ),
            Self::Signal(_) | Self::NotResolved { .. } => false,
        }
    }
}

fn is_wrong_structure(error: &StructureError) -> bool {
    matches!(
        error,
        StructureError::Setting { .. }
            | StructureError::Samples { .. }
            | StructureError::UnknownBody { .. }
            | StructureError::BaseJump
            | StructureError::Mesh(_)
    )
}

/// The place of a law in a message.
fn at(interface: Option<&str>) -> String {
    interface.map_or_else(String::new, |name| format!(" at interface \"{name}\""))
}

/// The number of files that a message does not name.
fn more(count: usize, named: usize) -> String {
    if count > named { format!(" and {} more", count - named) } else { String::new() }
}

/// A table of pressures and stiffnesses that cannot be fitted.
#[derive(Debug, Error)]
#[error("{}: {fault}", path.display())]
pub struct FitTableError {
    /// The file.
    pub path: PathBuf,
    /// Its fault.
    pub fault: FitTableFault,
}

/// Fault of a table of pressures and stiffnesses.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FitTableFault {
    /// The file cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The first line is not the header.
    #[error("line 1 is \"{0}\"; the header pressure_pa,stiffness_pa_per_m is expected")]
    Header(String),
    /// A row is not two numbers.
    #[error("line {line} is \"{found}\"; two numbers are expected: pressure_pa,stiffness_pa_per_m")]
    Row {
        /// Line, from 1.
        line: usize,
        /// The line.
        found: String,
    },
    /// The points do not determine a power law.
    #[error(transparent)]
    Fit(#[from] LawError),
}

/// Results that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The folder holds files that are not results.
    #[error(
        "the output folder {} holds files that asperity did not write: {}{}",
        folder.display(),
        files.join(", "),
        more(*count, files.len())
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
        /// Names of files in it that no earlier run wrote.
        files: Vec<String>,
        /// Number of all such files.
        count: usize,
    },
    /// The folder holds results of another document.
    #[error(
        "the output folder {} holds the results of another file: {}",
        folder.display(),
        document.display()
    )]
    OtherDocument {
        /// The folder.
        folder: PathBuf,
        /// The other document.
        document: PathBuf,
    },
    /// The folder has the results of a command that new ones would replace.
    #[error(
        "the output folder {} holds the results of `{command}`, which would be replaced",
        folder.display()
    )]
    OtherKind {
        /// The folder.
        folder: PathBuf,
        /// The other command.
        command: String,
    },
    /// Another run writes to the folder.
    #[error("another run of asperity is writing to the output folder {}", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The path is a file, or a link to nothing.
    #[error("the output folder {} is not a folder", .0.display())]
    NotAFolder(PathBuf),
    /// The operating system refuses.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The error.
        source: io::Error,
    },
}
