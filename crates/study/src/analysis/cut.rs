//! Files to hits, without analysing them.

use std::path::PathBuf;

use asperity_signal::{Hit, HitFinder, HitLength, HitOptions, TriggerLevel};

use super::error::AnalysisError;
use super::options::AnalysisOptions;
use super::scan::Scan;
use super::stream::{Sampling, Stream};

/// Hands every hit of some files to `take`, cut as [`analyse`](super::analyse) cuts them.
///
/// # Errors
/// As [`analyse`](super::analyse), but that no hit is none.
pub(crate) fn cut(
    files: &[PathBuf],
    options: &AnalysisOptions,
    take: &mut dyn FnMut(Hit, Sampling),
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
    let samples = |seconds: f64| (seconds * rate).round() as usize;
    let cut = HitOptions {
        level: TriggerLevel::Absolute(plan.level_n),
        pre_trigger: samples(options.pre_trigger_s),
        length: HitLength::UntilNext { limit: plan.length },
        hold_off: samples(options.hold_off_s).max(samples(options.pre_trigger_s) + 1),
    };
    for file in files {
        let mut finder: Option<HitFinder> = None;
        stream.read(file, &mut |block, sampling| {
            if block.begins
                && let Some(hit) = finder.take().and_then(HitFinder::finish)
            {
                take(hit, sampling);
            }
            if finder.is_none() {
                finder = Some(HitFinder::new(1, rate, plan.level_n, &cut)?);
            }
            if let Some(finder) = &mut finder {
                for hit in finder.push(&block.force, &[&block.response])? {
                    take(hit, sampling);
                }
            }
            Ok(())
        })?;
        if let Some(hit) = finder.take().and_then(HitFinder::finish) {
            take(hit, sampling);
        }
    }
    Ok(())
}
