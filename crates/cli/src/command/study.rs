//! `asperity study`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use asperity_plot as plot;
use asperity_scenario::{digits_apart, with_digits};
use asperity_simulation::output::file_name::file_name;
use asperity_study::{
    AnswerOptions, RunOptions, Shard, SlurmJob, StudyAnswers, StudyError, StudyFolder,
    StudyOutcome, StudyPlan, answers, slurm_script,
};
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
        (Some(StudyPart::Answers { file, out, exceed, level, json, figures }), _) => {
            let plan = read(file)?;
            crate::progress::show_notices(plan.warning());
            let thresholds =
                exceed.iter().map(|text| read_threshold(text)).collect::<Result<_, _>>()?;
            let options = AnswerOptions { level: *level, thresholds, ..AnswerOptions::default() };
            let folder = StudyFolder::open(&folder_of(file, out.as_deref()))?;
            let found = answers(&plan, &folder, &options)?;
            let text = super::pretty(&found.to_json(&plan.coordinates()));
            folder.write("histograms.csv", found.histograms().to_csv())?;
            folder.write("exceedance.csv", found.exceedance().to_csv())?;
            if let Some(frf) = &found.frf {
                folder.write("frf.csv", frf.table().to_csv())?;
            }
            for (stem, figure) in plot::answers(&found, &plan.coordinates()) {
                for (name, data) in super::drawn(stem, &figure, &figures.figures) {
                    folder.write(&name, data)?;
                }
            }
            folder.write("answers.json", &text)?;
            if *json {
                answer!("{text}");
            } else if !quiet {
                print_answers(&found, &plan.coordinates())?;
                answer_line!("written to {}", folder.path().display());
            }
            Ok(())
        }
        (Some(StudyPart::Unfinished { folder, shards }), _) => {
            let left = StudyFolder::open(folder)?.unfinished_shards(*shards)?;
            if !left.is_empty() {
                answer_line!("{}", ranges(&left));
            }
            Ok(())
        }
        (Some(StudyPart::Slurm { file, shards, out, cores, memory, time, retries }), _) => {
            note_idle_shards(&read(file)?, *shards);
            Shard::new(1, *shards)?;
            let out = folder_of(file, out.as_deref());
            let (memory, time) = (memory.clone(), time.clone());
            let job = SlurmJob { shards: *shards, cores: *cores, memory, time, retries: *retries };
            answer!("{}", slurm_script(file, &out, &job)?);
            Ok(())
        }
        (None, Some(file)) => run_study(file, asked, quiet),
        // The options require a file or a part.
        (None, None) => Ok(()),
    }
}

fn run_study(file: &Path, asked: &Study, quiet: bool) -> Result<(), Failure> {
    let plan = info_span!("read").in_scope(|| read(file))?;
    crate::progress::show_notices(plan.warning());
    let shard = asked.shard.as_deref().map_or(Ok(Shard::WHOLE), read_shard)?;
    if !quiet {
        note_idle_shards(&plan, shard.count());
    }
    let folder = folder_of(file, asked.out.as_deref());
    let stop = Arc::new(AtomicBool::new(false));
    super::stop_on_signals(&stop);
    let simulator = plan.simulator()?;
    let bar = crate::progress::bar(plan.rows(), "runs", quiet);
    let started = Instant::now();
    let outcome = super::on_threads(asked.threads, || {
        let options = RunOptions { folder: &folder, resume: asked.resume, shard };
        asperity_study::run(&plan, &simulator, &options, &stop, &|done, all| {
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

/// Tells that there are more shards than chunks, of which some compute nothing.
fn note_idle_shards(plan: &StudyPlan, shards: u64) {
    let (rows, chunk_rows) = (plan.rows(), plan.spec().chunk_rows);
    let chunks = rows.div_ceil(chunk_rows);
    if shards > chunks {
        let fewer = (rows / shards).max(1);
        crate::progress::show_notices([format!(
            "{shards} shards for {chunks} chunks of {chunk_rows} rows: {} shards compute nothing; give \
             at most {chunks} shards, or `chunk_rows` of at most {fewer}",
            shards - chunks
        )]);
    }
}

/// The checked plan of a study file.
fn read(file: &Path) -> Result<StudyPlan, Failure> {
    let document = super::read_document(file, FileKind::Study)?;
    let text = document.text().to_owned();
    StudyPlan::of(document).map_err(|error| match error {
        StudyError::Invalid(source) if source.path == file => {
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

/// Ascending numbers as a list of ranges, such as 3,7-9.
fn ranges(numbers: &[u64]) -> String {
    let range = |run: &[u64]| match run {
        [first, .., last] => format!("{first}-{last}"),
        _ => run.iter().map(u64::to_string).collect(),
    };
    numbers.chunk_by(|a, b| a + 1 == *b).map(range).collect::<Vec<_>>().join(",")
}

fn read_shard(text: &str) -> Result<Shard, Failure> {
    let numbers = text.split_once('/').map(|(k, n)| (k.parse(), n.parse()));
    match numbers {
        Some((Ok(number), Ok(count))) => Ok(Shard::new(number, count)?),
        _ => Err(Failure::ShardForm { argument: text.to_owned() }),
    }
}

/// Prints failures, quantiles, exceedance probabilities and Sobol indices.
fn print_answers(found: &StudyAnswers, inputs: &[String]) -> Result<(), Failure> {
    answer_line!("{} runs, {} failed", found.runs, found.failed);
    for (reason, count) in &found.reasons {
        answer_line!("  {count}: {reason}");
    }
    for one in &found.observables {
        let Some(mean) = one.mean else { continue };
        let values: Vec<f64> = one.quantiles.iter().map(|(_, found)| found.value).collect();
        let digits = digits_apart(&values, 4);
        let quantiles = one
            .quantiles
            .iter()
            .map(|(p, found)| format!("{p}: {}", with_digits(found.value, digits)));
        let quantiles = quantiles.collect::<Vec<_>>().join(", ");
        answer_line!("{}: mean {}; quantiles {quantiles}", one.name, with_digits(mean, digits));
        for (threshold, chance) in &one.exceedances {
            let interval = format!("{:.4} to {:.4}", chance.low, chance.high);
            answer_line!("  above {threshold}: probability {:.4} ({interval})", chance.value);
        }
        let Some(indices) = &one.indices else { continue };
        for ((first, total), input) in indices.first.iter().zip(&indices.total).zip(inputs) {
            answer_line!(
                "  {input}: first {:.3} ({:.3} to {:.3}), total {:.3} ({:.3} to {:.3})",
                first.value,
                first.low,
                first.high,
                total.value,
                total.low,
                total.high
            );
        }
    }
    Ok(())
}

fn read_threshold(text: &str) -> Result<(String, f64), Failure> {
    let pair = text.split_once('=').and_then(|(name, value)| Some((name, value.parse().ok()?)));
    match pair {
        Some((name, value)) => Ok((name.to_owned(), value)),
        None => Err(Failure::ExceedForm { argument: text.to_owned() }),
    }
}
