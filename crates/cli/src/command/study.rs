//! `asperity study`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use asperity_ensemble::{
    EnsembleError, RunOptions, Shard, StudyFolder, StudyOutcome, StudyPlan, slurm_script,
};
use asperity_study::output::file_name::file_name;
use tracing::info_span;

use crate::args::study::{Study, StudyPart};
use crate::failure::Failure;
use crate::file_kind::FileKind;

/// Runs a study, joins its shards, or prints a job script for them.
pub(crate) fn run(asked: &Study, quiet: bool) -> Result<(), Failure> {
    match (&asked.part, &asked.file) {
        (Some(StudyPart::Merge { folder }), _) => {
            let table = StudyFolder::open(folder)?.merge()?;
            if !quiet {
                answer_line!("joined in {}", table.display());
            }
            Ok(())
        }
        (Some(StudyPart::Slurm { file, shards, out, cores, time }), _) => {
            read(file)?;
            Shard::new(1, *shards)?;
            let out = folder_of(file, out.as_deref());
            answer!("{}", slurm_script(file, &out, *shards, *cores, time)?);
            Ok(())
        }
        (None, Some(file)) => run_study(file, asked, quiet),
        // The options require a file or a part.
        (None, None) => Ok(()),
    }
}

fn run_study(file: &Path, asked: &Study, quiet: bool) -> Result<(), Failure> {
    let plan = info_span!("read").in_scope(|| read(file))?;
    let shard = asked.shard.as_deref().map_or(Ok(Shard::WHOLE), read_shard)?;
    let folder = folder_of(file, asked.out.as_deref());
    let stop = Arc::new(AtomicBool::new(false));
    super::stop_on_signals(&stop);
    let simulator = plan.simulator()?;
    let bar = crate::progress::bar(plan.rows(), "runs", quiet);
    let started = Instant::now();
    let outcome = super::on_threads(asked.threads, || {
        let options = RunOptions { folder: &folder, resume: asked.resume, shard };
        asperity_ensemble::run(&plan, &simulator, &options, &stop, &|done, all| {
            bar.set_length(all);
            bar.set_position(done);
        })
    });
    bar.finish_and_clear();
    let wall_s = started.elapsed().as_secs_f64();
    match outcome?? {
        StudyOutcome::Complete(table) if !quiet => {
            answer_line!("{} runs in {wall_s:.2} s, written to {}", plan.rows(), table.display());
        }
        StudyOutcome::ShardDone if !quiet => {
            let folder = folder.display();
            answer_line!("shard done in {wall_s:.2} s; `asperity study merge {folder}` joins all");
        }
        StudyOutcome::Stopped => {
            let shard = asked.shard.as_ref().map(|shard| format!(" --shard {shard}"));
            return Err(Failure::StoppedStudy {
                file: file.to_owned(),
                folder,
                shard: shard.unwrap_or_default(),
            });
        }
        _ => {}
    }
    Ok(())
}

/// The checked plan of a study file.
fn read(file: &Path) -> Result<StudyPlan, Failure> {
    let document = super::read_document(file, FileKind::Study)?;
    let text = document.text().to_owned();
    StudyPlan::of(document).map_err(|error| match error {
        EnsembleError::Invalid(source) if source.path == file => {
            Failure::Invalid { kind: "study", text, path: file.to_owned(), source }
        }
        other => other.into(),
    })
}

/// The folder asked for, by default out/ and the name of the file.
fn folder_of(file: &Path, out: Option<&Path>) -> PathBuf {
    let stem = file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy();
    out.map_or_else(|| PathBuf::from("out").join(file_name(&stem)), Path::to_owned)
}

fn read_shard(text: &str) -> Result<Shard, Failure> {
    let numbers = text.split_once('/').map(|(k, n)| (k.parse(), n.parse()));
    match numbers {
        Some((Ok(number), Ok(count))) => Ok(Shard::new(number, count)?),
        _ => Err(Failure::ShardForm { argument: text.to_owned() }),
    }
}
