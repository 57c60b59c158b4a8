//! Analysis of files, or of records in memory, in two passes.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread::ScopedJoinHandle;

use asperity_measure::MeasurementSource;

use crate::analysis::Analysis;
use crate::error::AnalysisError;
use crate::hit_analysis::HitAccumulator;
use crate::input_size::{MAX_ANALYSED_BYTES, check_size};
use crate::options::{AnalysisOptions, HitCount};
use crate::report::AnalysisProvenance;
use crate::source_hash::sha256;
use crate::stream::{AnalysedFile, SampleBlock, SampleStream, as_sources, files_given_twice};
use crate::trigger::{ForceEnvelope, TriggerSettings};

/// Blocks that are read ahead of the analysis.
const BLOCKS_AHEAD: usize = 4;

/// Analyses the hits of some files, which are one test.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read, a channel or a unit that is not clear, and a
/// test without a hit that can be averaged.
pub fn analyse(files: &[PathBuf], options: &AnalysisOptions) -> Result<Analysis, AnalysisError> {
    analyse_sources(&as_sources(files), options, &|_| {})
}

/// Analyses files or records in memory as [`analyse`] does, and reports the number of passes over
/// them that are done.
///
/// Each source is read twice, so `progress` ends at twice the number of sources. The same samples
/// give the same numbers from a file and from memory.
///
/// # Errors
/// As [`analyse`].
pub fn analyse_sources(
    sources: &[MeasurementSource],
    options: &AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Analysis, AnalysisError> {
    options.check()?;
    check_size(sources, MAX_ANALYSED_BYTES)?;
    // The hashes are a third pass over the sources, in parallel with the two others.
    let cancelled = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let hashes = scope.spawn(|| sources.iter().map(|one| sha256(one, &cancelled)).collect());
        let found = two_passes(sources, options, progress);
        cancelled.store(found.is_err(), Ordering::Relaxed);
        let hashes: Result<Vec<String>, AnalysisError> = joined(hashes);
        let (hits, trigger, mut stream, mut files) = found?;
        files.iter_mut().zip(hashes?).for_each(|(file, sha256)| file.sha256 = sha256);
        stream.notices.extend(files_given_twice(&files));
        let provenance = AnalysisProvenance {
            version: env!("CARGO_PKG_VERSION"),
            rig: options.rig.clone(),
            files,
        };
        hits.finish(&trigger, stream, &provenance)
    })
}

type Passes<'a> = (HitAccumulator<'a>, TriggerSettings, SampleStream<'a>, Vec<AnalysedFile>);

/// Finds the trigger settings, then cuts and analyses the hits.
fn two_passes<'a>(
    sources: &[MeasurementSource],
    options: &'a AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Passes<'a>, AnalysisError> {
    let mut stream = SampleStream::new(options);
    let (envelope, signals, read) = ForceEnvelope::of_sources(&mut stream, sources, progress)?;
    let trigger = envelope.trigger_settings(options, signals.sample_rate_hz);
    let trigger = trigger.map_err(|error| stream.with_remarks(error))?;
    drop(envelope);
    if trigger.is_inverted {
        let text = "the force is far larger below zero than above; `flip_force` reverses its sign";
        stream.notices.insert(text.to_owned());
    }

    let mut found = HitAccumulator::new(options, &trigger, &signals)?;
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel::<(usize, Option<SampleBlock>)>(BLOCKS_AHEAD);
        let stream = &mut stream;
        let reader = scope.spawn(move || {
            for (number, source) in sources.iter().enumerate() {
                // A receiver that is gone has stopped at an error of its own.
                stream.read(source, &mut |block, _| {
                    let _ = sender.send((number, Some(block)));
                    Ok(())
                })?;
                let _ = sender.send((number, None));
            }
            Ok(())
        });
        for (number, block) in receiver {
            let name = &read[number].file;
            if let Some(block) = block {
                found.push(name, &block)?;
            } else {
                found.end_file(name)?;
                progress(sources.len() + number + 1);
            }
        }
        joined::<Result<(), AnalysisError>>(reader)
    })?;
    found.analyse_pending()?;
    if let HitCount::Strongest(requested) = options.hits
        && requested != found.hits()
    {
        let found = found.hits();
        stream.notices.insert(format!("{requested} hits requested, {found} above this level"));
    }
    Ok((found, trigger, stream, read))
}

/// Result of a thread; its panic continues here.
fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}
