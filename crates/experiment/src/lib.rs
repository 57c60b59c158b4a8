//! Measured hits: from files to features, averages and backbones.
//!
//! Files are read block by block, twice. The first pass sees how strong the
//! blows are and how far apart; the second cuts the hits, judges and analyses
//! each ([`analyse_hit`](asperity_signal::analyse_hit)), some at a time on all
//! cores while a thread of its own reads ahead, and forgets it. Hits are added up
//! in their order, so that the answer does not depend on the number of threads. What
//! stays is a row of numbers for each hit, the sums of the average, and some
//! curves to draw: memory does not grow with the files but by these.
//!
//! Records that do not continue each other are measured apart: hits do not
//! reach across, and their numbers go on.
//!
//! | module | holds |
//! |---|---|
//! | `options`, `select` | what is asked for, which channel is meant |
//! | `stream`, `scan` | files as blocks in SI; level and length of the hits |
//! | `hits` | one hit after the other |
//! | `cut` | the hits alone |
//! | `average`, `curve` | the averaged function, what is drawn |
//! | `report`, `verdict`, `tables` | `analysis.json`, its words, CSV |
//! | `convert` | files to files |
//! | `error` | why not |

mod average;
pub mod convert;
mod curve;
mod cut;
mod error;
mod hits;
mod options;
mod report;
mod scan;
mod select;
mod stream;
mod tables;
mod verdict;

pub use average::AveragedFrf;
pub use curve::HitCurve;
pub use cut::cut;
pub use error::AnalysisError;
pub use options::{
    AnalysisOptions, Band, HitCount, SensorOf, TimeConstant, WindowChoice, estimator, form,
};
pub use report::{
    ANALYSIS_SCHEMA, AnalysedFile, AnalysisProvenance, AnalysisReport, AverageFundamental,
    AverageReport, HitFundamental, HitReport, HitSecondHarmonic, Settings, Spread,
};
pub use select::Selector;
pub use stream::UsedChannel;
pub use tables::{averaged_frf_csv, backbone_csv, hits_csv};

use std::fmt::Write as _;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread::ScopedJoinHandle;

use asperity_signal::{BackbonePoint, ResponseKind};
use sha2::{Digest, Sha256};

use hits::HitByHit;
use scan::{Plan, Scan};
use stream::{Block, FileRead, Stream};

/// Blocks that may be read before those before them are analysed.
const BLOCKS_AHEAD: usize = 4;

/// A finished analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// The answers.
    pub report: AnalysisReport,
    /// The averaged function.
    pub average: AveragedFrf,
    /// Frequency and damping along the decay of each averaged hit.
    pub backbones: Vec<HitBackbone>,
    /// Some hits, to be drawn.
    pub curves: Vec<HitCurve>,
    /// Whether the response is a displacement, a velocity or an acceleration.
    pub route: ResponseKind,
}

/// The backbone of one hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitBackbone {
    /// Number of the hit.
    pub index: usize,
    /// Largest force \[N\].
    pub force_peak_n: f64,
    /// In the order of time; amplitudes are displacements \[m\].
    pub points: Vec<BackbonePoint>,
}

/// Analyses the hits of some files. `progress` hears the passes over files that are done.
///
/// Each file is read twice, so `progress` ends at twice their number.
///
/// # Errors
/// [`AnalysisError`] where a file cannot be read, a channel or a unit is not
/// clear, no hit is found or none can be averaged.
pub fn analyse(
    files: &[PathBuf],
    options: &AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Analysis, AnalysisError> {
    options.check()?;
    if files.is_empty() {
        return Err(AnalysisError::NoFile);
    }
    // The hashes are a third pass over the files, beside the two others.
    let unwanted = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let hashes = scope.spawn(|| files.iter().map(|file| sha256(file, &unwanted)).collect());
        let found = two_passes(files, options, progress);
        unwanted.store(found.is_err(), Ordering::Relaxed);
        let hashes: Result<Vec<String>, AnalysisError> = joined(hashes);
        let (found, plan, stream, read) = found?;
        let provenance = provenance(files, &read, hashes?);
        found.finish(&plan, stream, provenance)
    })
}

type Passes<'a> = (HitByHit<'a>, Plan, Stream<'a>, Vec<FileRead>);

/// Sees what hits there are, then cuts and analyses them.
fn two_passes<'a>(
    files: &[PathBuf],
    options: &'a AnalysisOptions,
    progress: &dyn Fn(usize),
) -> Result<Passes<'a>, AnalysisError> {
    let mut stream = Stream::new(options);
    let mut scan: Option<Scan> = None;
    let mut read: Vec<FileRead> = Vec::with_capacity(files.len());
    for (number, file) in files.iter().enumerate() {
        read.push(stream.read(file, &mut |block, sampling| {
            let scan = scan.get_or_insert_with(|| Scan::new(sampling.rate_hz));
            scan.push(block.begins, &block.force);
            Ok(())
        })?);
        progress(number + 1);
    }
    let (Some(scan), Some(sampling)) = (scan, stream.sampling) else {
        return Err(AnalysisError::NoFile);
    };
    let plan = scan.plan(options, sampling.rate_hz)?;
    drop(scan);
    if plan.points_away {
        stream.notices.insert(
            "the force is far larger below zero than above; --flip-force turns it".to_owned(),
        );
    }

    let mut found = HitByHit::new(options, &plan, sampling)?;
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    std::thread::scope(|scope| {
        let (give, taken) = sync_channel::<(usize, Option<Block>)>(BLOCKS_AHEAD);
        let stream = &mut stream;
        let reader = scope.spawn(move || {
            for (number, file) in files.iter().enumerate() {
                // Where nobody takes any more, the other side has an error of its own.
                stream.read(file, &mut |block, _| {
                    let _ = give.send((number, Some(block)));
                    Ok(())
                })?;
                let _ = give.send((number, None));
            }
            Ok(())
        });
        for (number, block) in taken {
            let name = &names[number];
            if let Some(block) = block {
                found.push(name, &block)?;
            } else {
                found.end_record(name)?;
                progress(files.len() + number + 1);
            }
        }
        joined::<Result<(), AnalysisError>>(reader)
    })?;
    found.analyse_waiting()?;
    if let HitCount::Strongest(asked) = options.hits
        && asked != found.hits.len()
    {
        let text = format!("{asked} hits asked for, {} found at this level", found.hits.len());
        stream.notices.insert(text);
    }
    Ok((found, plan, stream, read))
}

/// What a thread returns; its panic goes on here.
fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

fn provenance(files: &[PathBuf], read: &[FileRead], hashes: Vec<String>) -> AnalysisProvenance {
    let of_file = |((file, read), sha256): ((&PathBuf, &FileRead), String)| AnalysedFile {
        file: file.display().to_string(),
        format: read.format.clone(),
        records: read.records,
        samples: read.samples,
        sha256,
    };
    let files = files.iter().zip(read).zip(hashes).map(of_file).collect();
    AnalysisProvenance { version: env!("CARGO_PKG_VERSION"), files }
}

/// SHA-256 of a file, in hexadecimal; of its beginning once it is not wanted any more.
fn sha256(path: &Path, unwanted: &AtomicBool) -> Result<String, AnalysisError> {
    let io = |source| AnalysisError::Io { path: path.to_owned(), source };
    let mut file = std::fs::File::open(path).map_err(io)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    while !unwanted.load(Ordering::Relaxed) {
        match file.read(&mut buffer).map_err(io)? {
            0 => break,
            length => hash.update(&buffer[..length]),
        }
    }
    Ok(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}
