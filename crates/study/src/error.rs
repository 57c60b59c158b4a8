//! Why a study cannot be done.

use std::io;
use std::path::PathBuf;

use asperity_dynamics::DynamicsError;
use asperity_harmonic::HarmonicError;
use asperity_law::LawError;
use asperity_signal::SignalError;
use asperity_structure::StructureError;
use thiserror::Error;

use asperity_scenario::{DocumentError, SamplesError};

/// Why a valid scenario has no result, or its result no place to go.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The laws, bodies or interfaces do not make a structure at rest.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// The structure does not move as asked.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A steady response cannot be computed.
    #[error(transparent)]
    Harmonic(#[from] HarmonicError),
    /// A contact law cannot be built for the pressure it has to carry.
    #[error(
        "law \"{law}\" at interface \"{interface}\" (static pressure {pressure_pa} Pa): {source}"
    )]
    Law {
        /// The law's name, or "in place".
        law: String,
        /// The interface that uses it.
        interface: String,
        /// Static pressure there \[Pa\].
        pressure_pa: f64,
        /// What the law says.
        source: LawError,
    },
    /// The force samples cannot be read.
    #[error("{}: {source}", path.display())]
    Samples {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        source: SamplesError,
    },
    /// The response cannot be analysed.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A table of pressures and stiffnesses to fit cannot be read.
    #[error(transparent)]
    FitTable(#[from] crate::laws::FitTableError),
    /// The output folder cannot take the results.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A value of a sweep cannot be set.
    #[error(transparent)]
    Set(#[from] asperity_scenario::SetError),
    /// A combination of values of a sweep is no scenario, though each is valid.
    #[error("these values make no scenario: {reason}")]
    Scenario {
        /// Why.
        reason: String,
    },
    /// A run of a sweep has other interfaces than the first, and so no place in its table.
    #[error("this run has other interfaces than the first run of the sweep")]
    OtherColumns,
    /// A scenario cannot be read again for a run of a sweep.
    #[error(transparent)]
    Document(#[from] DocumentError),
}

/// Why results cannot be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The folder holds files that are not results of this command.
    #[error(
        "the output folder {} holds other files, such as \"{example}\"",
        folder.display()
    )]
    Occupied {
        /// The folder.
        folder: PathBuf,
        /// A file in it that no earlier run of this command wrote.
        example: String,
    },
    /// The path is a file.
    #[error("the output folder {} is a file", folder.display())]
    NotAFolder {
        /// The path.
        folder: PathBuf,
    },
    /// The operating system refuses.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}
