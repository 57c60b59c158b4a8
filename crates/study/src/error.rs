//! Errors of studies over designs.

use std::io;
use std::path::PathBuf;

use asperity_sampling::DesignError;
use asperity_scenario::{DocumentError, InvalidDocument};
use asperity_simulation::error::SimulationError;
use thiserror::Error;

/// Errors of studies over designs.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A text that is not JSON.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A study file or scenario with faults.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// A part of the study file that makes no distribution, correlation, or design.
    #[error("{place}: {source}")]
    Design {
        /// Place in the study file.
        place: String,
        /// The fault.
        source: DesignError,
    },
    /// A part of the study file that does not fit the rest.
    #[error("{place}: {fault}")]
    Part {
        /// Place in the study file.
        place: String,
        /// The fault, and what is accepted.
        fault: String,
    },
    /// A table of rows that cannot be used.
    #[error("{} {fault}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// The fault, and what is accepted.
        fault: String,
    },
    /// The scenario cannot be set up, or a file it names cannot be read.
    #[error(transparent)]
    Study(#[from] SimulationError),
    /// A folder that holds other things than this study.
    #[error("{} holds {found}; accepted: a new or empty folder, or that of the same study", folder.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// Its content, in words.
        found: String,
    },
    /// A study that has begun before.
    #[error("{} holds {done} of {chunks} chunks of this study; it is continued on request only", folder.display())]
    Begun {
        /// The folder.
        folder: PathBuf,
        /// Chunks present.
        done: u64,
        /// All chunks.
        chunks: u64,
    },
    /// Chunks that have not been computed.
    #[error("{} lacks {missing} of {chunks} chunks, the first is number {first}", folder.display())]
    Missing {
        /// The folder.
        folder: PathBuf,
        /// Chunks missing.
        missing: u64,
        /// All chunks.
        chunks: u64,
        /// The first missing one, from 0.
        first: u64,
    },
    /// A chunk that is damaged, or part of another study.
    #[error("{}: {fault}; delete the file and continue the study", file.display())]
    Chunk {
        /// The file.
        file: PathBuf,
        /// The fault.
        fault: String,
    },
    /// A shard that does not exist.
    #[error("shard {number} of {count}; accepted: K of N with 1 <= K <= N <= {most}")]
    Shard {
        /// Number of the shard.
        number: u64,
        /// Number of shards.
        count: u64,
        /// Most shards.
        most: u64,
    },
    /// The operating system refuses.
    #[error("{}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
}

impl StudyError {
    /// True if the request must be changed, not the machine.
    pub fn is_wrong_request(&self) -> bool {
        match self {
            Self::Io { .. } | Self::Chunk { .. } | Self::Missing { .. } => false,
            Self::Study(error) => error.is_wrong_request(),
            _ => true,
        }
    }
}
