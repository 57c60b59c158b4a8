//! The first pass: where the hits are, before any is cut.
//!
//! A level needs the whole record, a stream has only blocks. So the first pass
//! keeps the largest force of each millisecond, and every so many samples for
//! the noise: some thousandths of the samples, whatever the record's length.

use asperity_signal::{HitLength, HitOptions, TriggerLevel, robust_level};

use crate::error::AnalysisError;
use crate::options::{AnalysisOptions, HitCount};

/// Length over which one maximum is kept \[s\].
const CHUNK_S: f64 = 1e-3;
/// Samples kept for the noise, and twice that at most.
const KEPT: usize = 1 << 18;
/// Peaks stand this many robust deviations above the median.
const NOISE_FACTOR: f64 = 10.0;
/// And above this fraction of the largest.
const LEAST_FRACTION: f64 = 1e-3;
/// Longest hit that is chosen without being asked for, in samples.
const LONGEST: u64 = 1 << 20;

/// The force of all files, thinned out.
pub(super) struct Scan {
    chunk: usize,
    records: Vec<RecordScan>,
    sparse: Vec<f64>,
    stride: usize,
    until_next: usize,
    lowest: f64,
}

#[derive(Default)]
struct RecordScan {
    maxima: Vec<f64>,
    samples: u64,
}

/// Level and length of the hits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plan {
    pub(super) level_n: f64,
    pub(super) noise_n: f64,
    pub(super) largest_n: f64,
    /// Most samples of a hit.
    pub(super) length: usize,
    /// Whether the force is stronger the other way.
    pub(super) points_away: bool,
}

impl Plan {
    /// How records of this rate are cut.
    pub(super) fn cut(&self, options: &AnalysisOptions, rate_hz: f64) -> HitOptions {
        let samples = |seconds: f64| (seconds * rate_hz).round() as usize;
        HitOptions {
            trigger_level: TriggerLevel::Absolute(self.level_n),
            pre_trigger: samples(options.pre_trigger_s),
            length: HitLength::UntilNext { limit: self.length },
            hold_off: samples(options.hold_off_s).max(samples(options.pre_trigger_s) + 1),
        }
    }
}

impl Scan {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            chunk: ((CHUNK_S * rate_hz) as usize).max(1),
            records: Vec::new(),
            sparse: Vec::new(),
            stride: 1,
            until_next: 0,
            lowest: 0.0,
        }
    }

    /// Takes the next block of the force.
    pub(super) fn push(&mut self, begins: bool, force: &[f64]) {
        if begins || self.records.is_empty() {
            self.records.push(RecordScan::default());
        }
        let Some(record) = self.records.last_mut() else { return };
        for &x in force {
            if record.samples.is_multiple_of(self.chunk as u64) {
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
                self.sparse.push(x);
                self.until_next = self.stride;
            }
            self.until_next -= 1;
        }
        while self.sparse.len() > 2 * KEPT {
            let mut odd = false;
            self.sparse.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
    }

    /// Level and length of the hits, given or found.
    pub(super) fn plan(
        &self,
        options: &AnalysisOptions,
        rate_hz: f64,
    ) -> Result<Plan, AnalysisError> {
        let rest = robust_level(&self.sparse);
        let (median, noise_n) = rest.map_or((0.0, 0.0), |level| (level.median, level.deviation));
        let maxima = self.records.iter().flat_map(|record| &record.maxima);
        let largest_n = maxima.copied().fold(f64::NEG_INFINITY, f64::max);
        let no_hit = AnalysisError::NoHit { largest_n, noise_n };
        let hold_off = (options.hold_off_s * rate_hz / self.chunk as f64).ceil() as usize;
        let level_n = if let Some(level) = options.level_n {
            level
        } else {
            let above = largest_n - median;
            let bound = (NOISE_FACTOR * noise_n).max(LEAST_FRACTION * above);
            if !(above > 2.0 * bound && above > 0.0) {
                return Err(no_hit);
            }
            let peaks = self.peaks(median, bound, hold_off);
            median + chosen(&peaks, bound, options.hits, noise_n)?
        };
        let pre_trigger = (options.pre_trigger_s * rate_hz).round() as u64;
        let length = match options.length_s {
            Some(seconds) => (seconds * rate_hz).round() as u64,
            None => self.length(level_n, hold_off, pre_trigger).ok_or(no_hit)?,
        };
        let points_away = -self.lowest > 2.0 * largest_n.max(0.0);
        let length = length.clamp(pre_trigger + 2, u64::MAX) as usize;
        Ok(Plan { level_n, noise_n, largest_n, length, points_away })
    }

    /// Heights above the median of all that rises above `bound`, one for each hold-off, sorted.
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

    /// The median time from one trigger to the next or, where a record holds
    /// one hit, to its end.
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
            let chunk = self.chunk as u64;
            match triggers[..] {
                [] => {}
                [only] => {
                    let start = (only as u64 * chunk).saturating_sub(pre_trigger);
                    lengths.push(record.samples - start);
                }
                _ => lengths
                    .extend(triggers.windows(2).map(|pair| (pair[1] - pair[0]) as u64 * chunk)),
            }
        }
        lengths.sort_unstable();
        lengths.get(lengths.len() / 2).map(|length| (*length).min(LONGEST))
    }
}

/// The level between the peaks that are hits and those that are not.
fn chosen(peaks: &[f64], bound: f64, hits: HitCount, noise_n: f64) -> Result<f64, AnalysisError> {
    let with_bound: Vec<f64> = std::iter::once(bound).chain(peaks.iter().copied()).collect();
    let below = match hits {
        HitCount::Auto => {
            let gap = |at: usize| with_bound[at + 1] / with_bound[at];
            (0..peaks.len()).max_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
        }
        HitCount::Strongest(asked) => peaks
            .len()
            .checked_sub(asked)
            .ok_or(AnalysisError::FewerHits { asked, found: peaks.len(), noise_n })?,
    };
    match with_bound.get(below..=below + 1) {
        Some([low, high]) => Ok((low * high).sqrt()),
        _ => Ok(bound),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blows of the given heights, one a second at 1 kHz, over noise of 0.01.
    fn scan(heights: &[f64]) -> Scan {
        let mut scan = Scan::new(1000.0);
        let noise = |n: usize| if n.is_multiple_of(2) { 0.01 } else { -0.01 };
        let mut force: Vec<f64> = (0..1000 * heights.len()).map(noise).collect();
        for (number, height) in heights.iter().enumerate() {
            force[1000 * number + 300] = *height;
        }
        // Blocks of any size give the same.
        for (number, block) in force.chunks(177).enumerate() {
            scan.push(number == 0, block);
        }
        scan
    }

    /// Verified by hand: the widest gap of the logarithms lies between 1 and 20.
    #[test]
    fn the_level_lies_in_the_widest_gap() {
        let plan =
            scan(&[20.0, 1.0, 40.0, 60.0]).plan(&AnalysisOptions::default(), 1000.0).unwrap();
        assert!((plan.level_n / 20.0_f64.sqrt() - 1.0).abs() < 0.01, "{plan:?}");
        // From 300 to 2300 and to 3300: the upper median of 2000 and 1000.
        assert_eq!(plan.length, 2000);
    }

    #[test]
    fn the_strongest_hits_are_those_asked_for() {
        let ask = |asked| {
            let hits = HitCount::Strongest(asked);
            scan(&[20.0, 1.0, 40.0, 60.0])
                .plan(&AnalysisOptions { hits, ..AnalysisOptions::default() }, 1000.0)
        };
        assert!((ask(1).unwrap().level_n / 2400.0_f64.sqrt() - 1.0).abs() < 0.01);
        assert!(ask(4).unwrap().level_n < 1.0);
        let refused = ask(5).unwrap_err();
        assert!(matches!(refused, AnalysisError::FewerHits { asked: 5, found: 4, .. }));
    }

    #[test]
    fn noise_alone_is_no_hit_and_a_pulling_force_is_noticed() {
        let quiet = scan(&[0.01, 0.01]).plan(&AnalysisOptions::default(), 1000.0);
        assert!(matches!(quiet, Err(AnalysisError::NoHit { .. })), "{quiet:?}");
        let level_n = Some(5.0);
        let options =
            AnalysisOptions { level_n, length_s: Some(0.5), ..AnalysisOptions::default() };
        assert!(scan(&[-50.0]).plan(&options, 1000.0).unwrap().points_away);
    }

    /// A long record is thinned, not kept.
    #[test]
    fn memory_is_bounded() {
        let mut scan = Scan::new(50_000.0);
        let quiet = vec![0.0; 50_000];
        for number in 0..100 {
            scan.push(number == 0, &quiet);
        }
        assert!(scan.sparse.len() <= 2 * KEPT && scan.stride > 1);
        assert_eq!(scan.records[0].maxima.len(), 100_000);
    }
}
