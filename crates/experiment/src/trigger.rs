//! Trigger level and hit length, found from the force of all files.
//!
//! The first pass keeps the largest force of each millisecond and, for the noise, a limited number
//! of samples, so the memory is a small part of the record.

use asperity_measure::MeasurementSource;
use asperity_signal::{HitLength, HitOptions, TriggerLevel, robust_level};

use crate::error::AnalysisError;
use crate::options::{AnalysisOptions, HitCount};
use crate::stream::{AnalysedFile, SampleStream, SignalParameters};

/// Interval of which the maximum is kept \[s\].
const INTERVAL_S: f64 = 1e-3;
/// Half of the most samples kept for the noise.
const NOISE_SAMPLES: usize = 1 << 18;
/// Least height of a peak above the median, in robust standard deviations.
const NOISE_FACTOR: f64 = 10.0;
/// Least height of a peak over the largest.
const MIN_FRACTION: f64 = 1e-3;
/// Longest hit that is found, in samples.
const MAX_HIT_SAMPLES: u64 = 1 << 20;

/// Sample rates \[Hz\] that are accepted.
const RATES_HZ: std::ops::RangeInclusive<f64> = 1e-6..=1e12;

/// Envelope of the force of all files, and samples of its noise.
pub(crate) struct ForceEnvelope {
    /// Samples of an interval.
    interval: usize,
    records: Vec<RecordEnvelope>,
    noise: Vec<f64>,
    stride: usize,
    until_next: usize,
    lowest: f64,
}

#[derive(Default)]
struct RecordEnvelope {
    maxima: Vec<f64>,
    samples: u64,
}

/// Trigger level and hit length, given or found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TriggerSettings {
    /// Trigger level \[N\].
    pub(super) level_n: f64,
    /// Robust standard deviation of the force \[N\].
    pub(super) noise_n: f64,
    /// Largest force \[N\].
    pub(super) largest_n: f64,
    /// Most samples of a hit.
    pub(super) hit_samples: usize,
    /// True for a force that is far larger below zero than above.
    pub(super) is_inverted: bool,
}

impl TriggerSettings {
    /// Options for cutting records of this sample rate.
    pub(super) fn hit_options(&self, options: &AnalysisOptions, rate_hz: f64) -> HitOptions {
        let samples = |seconds: f64| (seconds * rate_hz).round() as usize;
        HitOptions {
            trigger_level: TriggerLevel::Absolute(self.level_n),
            pre_trigger: samples(options.pre_trigger_s),
            length: HitLength::UntilNext { limit: self.hit_samples },
            hold_off: samples(options.hold_off_s).max(samples(options.pre_trigger_s) + 1),
        }
    }
}

impl ForceEnvelope {
    /// Reads some sources; `progress` is called with the number of sources that are read.
    pub(super) fn of_sources(
        stream: &mut SampleStream<'_>,
        sources: &[MeasurementSource],
        progress: &dyn Fn(usize),
    ) -> Result<(Self, SignalParameters, Vec<AnalysedFile>), AnalysisError> {
        let mut envelope: Option<Self> = None;
        let mut read = Vec::with_capacity(sources.len());
        for (number, source) in sources.iter().enumerate() {
            read.push(stream.read(source, &mut |block, signals| {
                let envelope = envelope.get_or_insert_with(|| Self::new(signals.sample_rate_hz));
                envelope.push(block.begins_record, &block.force);
                Ok(())
            })?);
            progress(number + 1);
        }
        let found = envelope.zip(stream.signals.clone()).ok_or(AnalysisError::NoFile)?;
        Ok((found.0, found.1, read))
    }

    fn new(rate_hz: f64) -> Self {
        Self {
            interval: ((INTERVAL_S * rate_hz) as usize).max(1),
            records: Vec::new(),
            noise: Vec::new(),
            stride: 1,
            until_next: 0,
            lowest: 0.0,
        }
    }

    /// Takes the next block of the force.
    fn push(&mut self, begins_record: bool, force: &[f64]) {
        if begins_record || self.records.is_empty() {
            self.records.push(RecordEnvelope::default());
        }
        let Some(record) = self.records.last_mut() else { return };
        for &x in force {
            if record.samples.is_multiple_of(self.interval as u64) {
                record.maxima.push(f64::NEG_INFINITY);
            }
            record.samples += 1;
            if let Some(most) = record.maxima.last_mut()
                && x > *most
                && x.is_finite()
            {
                *most = x;
            }
            if x < self.lowest && x.is_finite() {
                self.lowest = x;
            }
            if self.until_next == 0 {
                self.noise.push(x);
                self.until_next = self.stride;
            }
            self.until_next -= 1;
        }
        while self.noise.len() > 2 * NOISE_SAMPLES {
            let mut odd = false;
            self.noise.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
    }

    /// Trigger level and hit length, given or found.
    pub(super) fn trigger_settings(
        &self,
        options: &AnalysisOptions,
        rate_hz: f64,
    ) -> Result<TriggerSettings, AnalysisError> {
        if !RATES_HZ.contains(&rate_hz) {
            let (name, expected) = ("the sample rate in Hz", "1e-6 to 1e12");
            return Err(AnalysisError::Setting { name, found: format!("{rate_hz:e}"), expected });
        }
        let rest = robust_level(&self.noise);
        let (median, noise_n) = rest.map_or((0.0, 0.0), |level| (level.median, level.deviation));
        let maxima = self.records.iter().flat_map(|record| &record.maxima);
        let largest_n = maxima.copied().fold(f64::NEG_INFINITY, f64::max);
        let no_hit = AnalysisError::NoHit { largest_n, noise_n, remarks: Vec::new() };
        let hold_off = (options.hold_off_s * rate_hz / self.interval as f64).ceil() as usize;
        let level_n = if let Some(level) = options.trigger_level_n {
            level
        } else {
            let above = largest_n - median;
            let bound = (NOISE_FACTOR * noise_n).max(MIN_FRACTION * above);
            if !(above > 2.0 * bound && above > 0.0) {
                return Err(no_hit);
            }
            let peaks = self.peaks(median, bound, hold_off);
            median + separating_level(&peaks, bound, options.hits, noise_n)?
        };
        let pre_trigger = (options.pre_trigger_s * rate_hz).round() as u64;
        let length = match options.hit_length_s {
            Some(seconds) => (seconds * rate_hz).round() as u64,
            None => self.length(level_n, hold_off, pre_trigger).ok_or(no_hit)?,
        };
        let is_inverted = -self.lowest > 2.0 * largest_n.max(0.0);
        let hit_samples = length.max(pre_trigger.saturating_add(2)) as usize;
        Ok(TriggerSettings { level_n, noise_n, largest_n, hit_samples, is_inverted })
    }

    /// Heights above the median of the peaks above `bound`, one for each hold-off, sorted.
    fn peaks(&self, median: f64, bound: f64, hold_off: usize) -> Vec<f64> {
        let mut peaks = Vec::new();
        for record in &self.records {
            let mut begun: Option<usize> = None;
            for (index, most) in record.maxima.iter().map(|most| most - median).enumerate() {
                let inside = begun.is_some_and(|begin| index - begin <= hold_off);
                if let (true, Some(peak)) = (inside, peaks.last_mut()) {
                    *peak = most.max(*peak);
                } else if most > bound {
                    begun = Some(index);
                    peaks.push(most);
                }
            }
        }
        peaks.sort_by(f64::total_cmp);
        peaks
    }

    /// Median time from one trigger to the next or, in a record of one hit, to its end, in samples.
    fn length(&self, level: f64, hold_off: usize, pre_trigger: u64) -> Option<u64> {
        let mut lengths = Vec::new();
        for record in &self.records {
            let mut triggers: Vec<usize> = Vec::new();
            for (index, most) in record.maxima.iter().enumerate() {
                let rested = triggers.last().is_none_or(|last| index - last > hold_off);
                if *most >= level && rested {
                    triggers.push(index);
                }
            }
            let interval = self.interval as u64;
            match triggers[..] {
                [] => {}
                [only] => {
                    let start = (only as u64 * interval).saturating_sub(pre_trigger);
                    lengths.push(record.samples - start);
                }
                _ => lengths
                    .extend(triggers.windows(2).map(|pair| (pair[1] - pair[0]) as u64 * interval)),
            }
        }
        lengths.sort_unstable();
        lengths.get(lengths.len() / 2).map(|length| (*length).min(MAX_HIT_SAMPLES))
    }
}

/// Level between the peaks that are hits and those that are not.
fn separating_level(
    peaks: &[f64],
    bound: f64,
    hits: HitCount,
    noise_n: f64,
) -> Result<f64, AnalysisError> {
    let with_bound: Vec<f64> = std::iter::once(bound).chain(peaks.iter().copied()).collect();
    let below = match hits {
        HitCount::Auto => {
            let gap = |at: usize| with_bound[at + 1] / with_bound[at];
            (0..peaks.len()).max_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
        }
        HitCount::Strongest(requested) => peaks
            .len()
            .checked_sub(requested)
            .ok_or(AnalysisError::FewerHits { requested, found: peaks.len(), noise_n })?,
    };
    match with_bound.get(below..=below + 1) {
        Some([low, high]) => Ok((low * high).sqrt()),
        _ => Ok(bound),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Envelope of hits of the given heights, one a second at 1 kHz, over noise of 0.01.
    fn envelope(heights: &[f64]) -> ForceEnvelope {
        let mut envelope = ForceEnvelope::new(1000.0);
        let noise = |n: usize| if n.is_multiple_of(2) { 0.01 } else { -0.01 };
        let mut force: Vec<f64> = (0..1000 * heights.len()).map(noise).collect();
        for (number, height) in heights.iter().enumerate() {
            force[1000 * number + 300] = *height;
        }
        // Blocks of any size give the same.
        for (number, block) in force.chunks(177).enumerate() {
            envelope.push(number == 0, block);
        }
        envelope
    }

    /// Verified by hand: the widest gap of the logarithms lies between 1 and 20.
    #[test]
    fn the_level_lies_in_the_widest_gap() {
        let trigger = envelope(&[20.0, 1.0, 40.0, 60.0])
            .trigger_settings(&AnalysisOptions::default(), 1000.0)
            .unwrap();
        assert!((trigger.level_n / 20.0_f64.sqrt() - 1.0).abs() < 0.01, "{trigger:?}");
        // From 300 to 2300 and to 3300: the upper median of 2000 and 1000.
        assert_eq!(trigger.hit_samples, 2000);
    }

    #[test]
    fn the_requested_number_of_strongest_hits_is_found() {
        let of = |requested| {
            let hits = HitCount::Strongest(requested);
            envelope(&[20.0, 1.0, 40.0, 60.0])
                .trigger_settings(&AnalysisOptions { hits, ..AnalysisOptions::default() }, 1000.0)
        };
        assert!((of(1).unwrap().level_n / 2400.0_f64.sqrt() - 1.0).abs() < 0.01);
        assert!(of(4).unwrap().level_n < 1.0);
        let error = of(5).unwrap_err();
        assert!(matches!(error, AnalysisError::FewerHits { requested: 5, found: 4, .. }));
    }

    #[test]
    fn noise_alone_is_not_a_hit_and_an_inverted_force_is_detected() {
        let quiet = envelope(&[0.01, 0.01]).trigger_settings(&AnalysisOptions::default(), 1000.0);
        assert!(matches!(quiet, Err(AnalysisError::NoHit { .. })), "{quiet:?}");
        let trigger_level_n = Some(5.0);
        let options = AnalysisOptions {
            trigger_level_n,
            hit_length_s: Some(0.5),
            ..AnalysisOptions::default()
        };
        assert!(envelope(&[-50.0]).trigger_settings(&options, 1000.0).unwrap().is_inverted);
    }

    /// A long record is decimated.
    #[test]
    fn memory_is_bounded() {
        let mut envelope = ForceEnvelope::new(50_000.0);
        let quiet = vec![0.0; 50_000];
        for number in 0..100 {
            envelope.push(number == 0, &quiet);
        }
        assert!(envelope.noise.len() <= 2 * NOISE_SAMPLES && envelope.stride > 1);
        assert_eq!(envelope.records[0].maxima.len(), 100_000);
    }
}
