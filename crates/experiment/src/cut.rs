//! Files to hits, without analysing them.

use std::path::PathBuf;

use asperity_signal::{HitFinder, HitRecord, ResponseKind};

use crate::error::AnalysisError;
use crate::options::AnalysisOptions;
use crate::scan::Scan;
use crate::stream::Stream;

/// Hands every hit of some files to `take`, cut as [`analyse`](crate::analyse) cuts them.
///
/// # Errors
/// As [`analyse`](crate::analyse), but that no hit is none.
pub fn cut(
    files: &[PathBuf],
    options: &AnalysisOptions,
    take: &mut dyn FnMut(HitRecord, ResponseKind),
) -> Result<(), AnalysisError> {
    options.check()?;
    let mut stream = Stream::new(options);
    let mut scan: Option<Scan> = None;
    for file in files {
        stream.read(file, &mut |block, sampling| {
            let scan = scan.get_or_insert_with(|| Scan::new(sampling.rate_hz));
            scan.push(block.begins, &block.force);
            Ok(())
        })?;
    }
    let (Some(scan), Some(sampling)) = (scan, stream.sampling) else {
        return Err(AnalysisError::NoFile);
    };
    let rate = sampling.rate_hz;
    let plan = scan.plan(options, rate)?;
    let cut = plan.cut(options, rate);
    for file in files {
        let mut finder: Option<HitFinder> = None;
        stream.read(file, &mut |block, sampling| {
            if block.begins
                && let Some(hit) = finder.take().and_then(HitFinder::finish)
            {
                take(hit, sampling.route);
            }
            if finder.is_none() {
                finder = Some(HitFinder::new(1, rate, plan.level_n, &cut)?);
            }
            if let Some(finder) = &mut finder {
                for hit in finder.push(&block.force, &[&block.response])? {
                    take(hit, sampling.route);
                }
            }
            Ok(())
        })?;
        if let Some(hit) = finder.take().and_then(HitFinder::finish) {
            take(hit, sampling.route);
        }
    }
    Ok(())
}
