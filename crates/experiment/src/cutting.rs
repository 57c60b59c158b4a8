//! Hits cut out of the blocks of files.

use asperity_measure::MeasurementSource;
use asperity_signal::{HitFinder, HitOptions, HitRecord, ResponseKind, SignalError};

use crate::error::AnalysisError;
use crate::options::AnalysisOptions;
use crate::stream::{SampleBlock, SampleStream};
use crate::trigger::{ForceEnvelope, TriggerSettings};

/// Calls `take` with every hit of some files or records in memory, cut as [`analyse`](crate::analyse) cuts them, and the
/// quantities of its responses.
///
/// # Errors
/// As [`analyse`](crate::analyse), except that a test without a good hit is accepted.
pub fn for_each_hit(
    sources: &[MeasurementSource],
    options: &AnalysisOptions,
    take: &mut dyn FnMut(HitRecord, &[ResponseKind]),
) -> Result<(), AnalysisError> {
    options.check()?;
    let mut stream = SampleStream::new(options);
    let (envelope, signals, _) = ForceEnvelope::of_sources(&mut stream, sources, &|_| {})?;
    let trigger = envelope.trigger_settings(options, signals.sample_rate_hz)?;
    let mut cutter = HitCutter::new(&trigger, options, signals.sample_rate_hz);
    for source in sources {
        stream.read(source, &mut |block, signals| {
            for hit in cutter.push(&block)? {
                take(hit.samples, &signals.responses);
            }
            Ok(())
        })?;
        if let (Some(hit), Some(signals)) = (cutter.end_file(), &stream.signals) {
            take(hit.samples, &signals.responses);
        }
    }
    Ok(())
}

/// Hit with its place in the file.
#[derive(Clone)]
pub(crate) struct CutHit {
    /// Record in the file, from 1.
    pub(crate) record: usize,
    /// Time of the first sample of the record \[s\].
    pub(crate) record_start_s: f64,
    pub(crate) samples: HitRecord,
}

impl CutHit {
    /// The hit with each of its responses alone.
    pub(crate) fn of_each_response(mut self) -> Vec<Self> {
        let responses = std::mem::take(&mut self.samples.responses);
        let of = |response| {
            let mut one = self.clone();
            one.samples.responses = vec![response];
            one
        };
        responses.into_iter().map(of).collect()
    }
}

/// Cuts hits out of the blocks of one file after the other.
///
/// A hit does not extend from one record into the next.
pub(crate) struct HitCutter {
    sample_rate_hz: f64,
    trigger_level_n: f64,
    options: HitOptions,
    finder: Option<HitFinder>,
    record: usize,
    record_start_s: f64,
}

impl HitCutter {
    pub(crate) fn new(
        trigger: &TriggerSettings,
        options: &AnalysisOptions,
        sample_rate_hz: f64,
    ) -> Self {
        Self {
            sample_rate_hz,
            trigger_level_n: trigger.level_n,
            options: trigger.hit_options(options, sample_rate_hz),
            finder: None,
            record: 0,
            record_start_s: 0.0,
        }
    }

    /// Takes the next block of a file, and returns the hits that end in it.
    pub(crate) fn push(&mut self, block: &SampleBlock) -> Result<Vec<CutHit>, SignalError> {
        let mut hits = Vec::new();
        if block.begins_record {
            hits.extend(self.end_record());
            self.record += 1;
            self.record_start_s = block.start_s;
        }
        let mut finder = if let Some(finder) = self.finder.take() {
            finder
        } else {
            let (rate, level) = (self.sample_rate_hz, self.trigger_level_n);
            HitFinder::new(block.responses.len(), rate, level, &self.options)?
        };
        let responses: Vec<&[f64]> = block.responses.iter().map(Vec::as_slice).collect();
        let found = finder.push(&block.force, &responses)?;
        self.finder = Some(finder);
        hits.extend(found.into_iter().map(|samples| self.placed(samples)));
        Ok(hits)
    }

    /// Ends the last record of a file, and returns the hit that ends with it.
    pub(crate) fn end_file(&mut self) -> Option<CutHit> {
        let last = self.end_record();
        self.record = 0;
        last
    }

    fn end_record(&mut self) -> Option<CutHit> {
        let last = self.finder.take().and_then(HitFinder::finish)?;
        Some(self.placed(last))
    }

    fn placed(&self, samples: HitRecord) -> CutHit {
        CutHit { record: self.record, record_start_s: self.record_start_s, samples }
    }
}
