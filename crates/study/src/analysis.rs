//! Measured hits: from files to features, averages and backbones.
//!
//! Files are read block by block, twice. The first pass sees how strong the
//! blows are and how far apart; the second cuts the hits, judges and analyses
//! each ([`analyse_hit`](asperity_signal::analyse_hit)), some at a time on all
//! cores, and forgets it. What
//! stays is a row of numbers for each hit, the sums of the average, and some
//! curves to draw: memory does not grow with the files but by these.
//!
//! Records that do not continue each other are measured apart: hits do not
//! reach across, and their numbers go on. Simulated runs written as files
//! ([`simulated`](mod@simulated)) take the same way.
//!
//! | module | holds |
//! |---|---|
//! | `options`, `select` | what is asked for, which channel is meant |
//! | `stream`, `scan` | files as blocks in SI; level and length of the hits |
//! | `hits` | one hit after the other |
//! | `average`, `curve` | the averaged function, what is drawn |
//! | `report`, `verdict`, `tables` | `analysis.json`, its words, CSV |
//! | `convert`, `simulated` | files to files, runs to files |
//! | `error` | why not |

mod average;
pub mod convert;
mod curve;
mod error;
mod hits;
mod options;
mod report;
mod scan;
mod select;
pub mod simulated;
mod stream;
mod tables;
mod verdict;

pub use average::AveragedFrf;
pub use curve::HitCurve;
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

use asperity_signal::{BackbonePoint, Route};
use sha2::{Digest, Sha256};

use hits::HitByHit;
use scan::Scan;
use stream::{FileRead, Stream};

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
    /// Whether the response is a displacement or an acceleration.
    pub route: Route,
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
    for (number, file) in files.iter().enumerate() {
        let name = file.display().to_string();
        stream.read(file, &mut |block, _| found.push(&name, &block))?;
        found.end_record(&name)?;
        progress(files.len() + number + 1);
    }
    found.analyse_waiting()?;
    if let HitCount::Strongest(asked) = options.hits
        && asked != found.hits.len()
    {
        let text = format!("{asked} hits asked for, {} found at this level", found.hits.len());
        stream.notices.insert(text);
    }
    let provenance = provenance(files, &read)?;
    found.finish(&plan, stream, provenance)
}

fn provenance(files: &[PathBuf], read: &[FileRead]) -> Result<AnalysisProvenance, AnalysisError> {
    let of_file = |(file, read): (&PathBuf, &FileRead)| {
        Ok(AnalysedFile {
            file: file.display().to_string(),
            format: read.format.clone(),
            records: read.records,
            samples: read.samples,
            sha256: sha256(file)?,
        })
    };
    let files: Result<_, AnalysisError> = files.iter().zip(read).map(of_file).collect();
    Ok(AnalysisProvenance { version: env!("CARGO_PKG_VERSION"), files: files? })
}

/// SHA-256 of a file, in hexadecimal.
fn sha256(path: &Path) -> Result<String, AnalysisError> {
    let io = |source| AnalysisError::Io { path: path.to_owned(), source };
    let mut file = std::fs::File::open(path).map_err(io)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
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
