//! Analysis of files in two passes.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread::ScopedJoinHandle;

use sha2::{Digest, Sha256};

use crate::analysis::Analysis;
use crate::error::AnalysisError;
use crate::hit_analysis::HitAccumulator;
use crate::input_size::{MAX_ANALYSED_BYTES, check_size};
use crate::options::{AnalysisOptions, HitCount};
use crate::report::{AnalysedFile, AnalysisProvenance};
use crate::stream::{SampleBlock, SampleStream};
use crate::trigger::{ForceEnvelope, TriggerSettings};

/// Blocks that are read ahead of the analysis.
const BLOCKS_AHEAD: usize = 4;

/// Analyses the hits of some files, which are one test.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read, a channel or a unit that is not clear, and a
/// test without a hit that can be averaged.
pub fn analyse(files: &[PathBuf], options: &AnalysisOptions) -> Result<Analysis, AnalysisError> {
    analyse_with_progress(files, options, &|_| {})
}

/// Analyses as [`analyse`] does, and reports the number of passes over files that are done.
///
/// Each file is read twice, so `progress` ends at twice the number of files.
///
/// # Errors
/// As [`analyse`].
pub fn analyse_with_progress(
    files: &[PathBuf],
    options: &AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Analysis, AnalysisError> {
    options.check()?;
    check_size(files, MAX_ANALYSED_BYTES)?;
    // The hashes are a third pass over the files, in parallel with the two others.
    let cancelled = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let hashes = scope.spawn(|| files.iter().map(|file| sha256(file, &cancelled)).collect());
        let found = two_passes(files, options, progress);
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
    files: &[PathBuf],
    options: &'a AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Passes<'a>, AnalysisError> {
    let mut stream = SampleStream::new(options);
    let (envelope, signals, read) = ForceEnvelope::of_files(&mut stream, files, progress)?;
    let trigger = envelope.trigger_settings(options, signals.sample_rate_hz)?;
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
            for (number, file) in files.iter().enumerate() {
                // A receiver that is gone has stopped at an error of its own.
                stream.read(file, &mut |block, _| {
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
                progress(files.len() + number + 1);
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

/// A sentence for each file with the bytes of an earlier one.
pub(crate) fn files_given_twice(files: &[AnalysedFile]) -> Vec<String> {
    let mut sentences = Vec::new();
    for (number, file) in files.iter().enumerate() {
        let same = files[..number].iter().find(|earlier| earlier.sha256 == file.sha256);
        if let Some(earlier) = same {
            sentences.push(format!(
                "{} and {} hold the same bytes: their hits are counted twice, and coherence and \
                 scatter mean nothing",
                earlier.file, file.file
            ));
        }
    }
    sentences
}

/// Result of a thread; its panic continues here.
fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// SHA-256 of a file in hexadecimal; of its beginning once the analysis is cancelled.
pub(crate) fn sha256(path: &Path, cancelled: &AtomicBool) -> Result<String, AnalysisError> {
    let io = |source| AnalysisError::Io { path: path.to_owned(), source };
    let mut file = std::fs::File::open(path).map_err(io)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    while !cancelled.load(Ordering::Relaxed) {
        match file.read(&mut buffer).map_err(io)? {
            0 => break,
            length => hash.update(&buffer[..length]),
        }
    }
    let digest = hash.finalize();
    let nibbles = digest.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    Ok(nibbles.filter_map(|nibble| char::from_digit(nibble.into(), 16)).collect())
}
