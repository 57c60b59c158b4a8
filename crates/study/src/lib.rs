//! Studies of one scenario over designs of any size.
//!
//! A study file names a scenario, inputs with their distributions, and a design. Run `k` of the study
//! is the scenario with the inputs
//!
//! ```text
//! x(k) = F^-1(u_k),    k = 0, ..., n - 1,
//! ```
//!
//! which follow from the seed and `k` alone. Runs are computed in chunks, each of which is on disk
//! whole or not at all, in constant memory; interrupted studies are continued, and shards are
//! computed on several machines with nothing in common but a folder. The results have the same bytes
//! in each case.
//!
//! | module | holds |
//! |---|---|
//! | [`spec`] | the study file and its schema |
//! | `plan` | [`StudyPlan`]: the inputs of each run, by a design, draws of a file, or rows of a table |
//! | `folder` | [`StudyFolder`]: manifest, chunks, the joined table as CSV and Parquet |
//! | `run` | [`run()`] over chunks and shards, for any [`RowModel`] |
//! | `answers` | [`answers()`]: quantiles, exceedance probabilities, Sobol indices of a finished study |
//! | `study_table` | the joined table, read column by column |
//! | `slurm` | [`slurm_script`]: a job array with one task a shard, and the job that joins them |

mod answers;
mod error;
mod folder;
mod plan;
mod run;
mod slurm;
pub mod spec;
mod study_table;

pub use answers::{AnswerOptions, FrfBand, ObservableAnswers, StudyAnswers, answers};
pub use asperity_sampling::{Histogram, IntervalEstimate};
pub use error::StudyError;
pub use folder::StudyFolder;
pub use plan::StudyPlan;
pub use run::{MOST_SHARDS, RowModel, RowResult, RunOptions, Shard, StudyOutcome, run};
pub use slurm::{SlurmJob, slurm_script};
pub use spec::study_schema;
