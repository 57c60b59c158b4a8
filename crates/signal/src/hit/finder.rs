//! Hits out of a stream of blocks.

use super::HitRecord;
use super::trigger::{HitLength, HitOptions};
use crate::error::{Result, SignalError, check_positive, check_rate};

/// Samples beyond the pre-trigger that may wait before they are dropped together.
const SLACK: usize = 4096;

/// Cuts hits out of blocks of any size, as they arrive.
///
/// A hit begins where the force reaches the level from below and the hold-off
/// of the hit before is over. The answer does not depend on how the record is
/// cut into blocks. Memory is bounded by one hit and one block.
///
/// [`HitOptions::trigger_level`] is not looked at: a stream has no largest value yet,
/// so the level is given in newtons.
#[derive(Debug, Clone)]
pub struct HitFinder {
    options: HitOptions,
    level: f64,
    sample_rate_hz: f64,
    force: Vec<f64>,
    responses: Vec<Vec<f64>>,
    /// Index in the record of the first sample kept.
    base: u64,
    /// Whether the last sample looked at was below the level.
    below: bool,
    last_trigger: Option<u64>,
    open: Option<Open>,
}

/// A hit that has begun.
#[derive(Debug, Clone, Copy)]
struct Open {
    start: u64,
    trigger: u64,
}

impl HitFinder {
    /// A finder for a force and `channels` responses.
    ///
    /// - `level_n`: the trigger level, positive, in newtons.
    ///
    /// # Errors
    /// [`SignalError::SampleRate`], [`SignalError::Option`].
    pub fn new(
        channels: usize,
        sample_rate_hz: f64,
        level_n: f64,
        options: &HitOptions,
    ) -> Result<Self> {
        check_rate(sample_rate_hz)?;
        check_positive("the trigger level", level_n)?;
        options.check()?;
        Ok(Self {
            options: options.clone(),
            level: level_n,
            sample_rate_hz,
            force: Vec::new(),
            responses: vec![Vec::new(); channels],
            base: 0,
            below: true,
            last_trigger: None,
            open: None,
        })
    }

    /// Takes the next block and returns the hits that ended in it.
    ///
    /// - `force`: in newtons; an empty block is allowed.
    /// - `responses`: one slice for each channel, as long as the force.
    ///
    /// # Errors
    /// [`SignalError::Channels`], [`SignalError::LengthMismatch`]; the block is then not taken.
    pub fn push(&mut self, force: &[f64], responses: &[&[f64]]) -> Result<Vec<HitRecord>> {
        if responses.len() != self.responses.len() {
            let (found, expected) = (responses.len(), self.responses.len());
            return Err(SignalError::Channels { found, expected });
        }
        if let Some(channel) = responses.iter().find(|channel| channel.len() != force.len()) {
            let response = channel.len();
            return Err(SignalError::LengthMismatch { force: force.len(), response });
        }
        let first = self.base + self.force.len() as u64;
        self.force.extend_from_slice(force);
        for (kept, block) in self.responses.iter_mut().zip(responses) {
            kept.extend_from_slice(block);
        }
        let mut hits = Vec::new();
        for (index, &x) in (first..).zip(force) {
            let at_level = x >= self.level;
            let crossing = at_level && self.below;
            self.below = !at_level;
            self.advance(index, crossing, &mut hits);
        }
        self.forget();
        Ok(hits)
    }

    /// Ends the record: the hit still open, if there is one.
    ///
    /// Its `missing` says how many samples of a fixed length it lacks.
    pub fn finish(mut self) -> Option<HitRecord> {
        let open = self.open.take()?;
        let end = self.base + self.force.len() as u64;
        let missing = match self.options.length {
            HitLength::Samples(samples) => samples - (end - open.start) as usize,
            HitLength::UntilNext { .. } => 0,
        };
        Some(HitRecord { missing, ..self.cut(open, end) })
    }

    fn advance(&mut self, index: u64, crossing: bool, hits: &mut Vec<HitRecord>) {
        let rested =
            self.last_trigger.is_none_or(|last| index - last >= self.options.hold_off as u64);
        let begins = crossing && rested;
        let start = index.saturating_sub(self.options.pre_trigger as u64);
        let until_next = matches!(self.options.length, HitLength::UntilNext { .. });
        if let (true, true, Some(open)) = (begins, until_next, self.open) {
            hits.push(self.cut(open, start));
            self.open = None;
        }
        if begins && self.open.is_none() {
            self.open = Some(Open { start, trigger: index });
            self.last_trigger = Some(index);
        }
        if let Some(open) = self.open
            && index + 1 - open.start >= self.options.length.most() as u64
        {
            hits.push(self.cut(open, index + 1));
            self.open = None;
        }
    }

    fn cut(&self, open: Open, end: u64) -> HitRecord {
        let range = (open.start - self.base) as usize..(end - self.base) as usize;
        HitRecord {
            start: open.start,
            trigger: (open.trigger - open.start) as usize,
            force: self.force[range.clone()].to_vec(),
            responses: self.responses.iter().map(|kept| kept[range.clone()].to_vec()).collect(),
            sample_rate_hz: self.sample_rate_hz,
            missing: 0,
        }
    }

    /// Drops what no hit can need any more, many samples at a time.
    fn forget(&mut self) {
        let end = self.base + self.force.len() as u64;
        let needed = end.saturating_sub(self.options.pre_trigger as u64);
        let needed = self.open.map_or(needed, |open| open.start.min(needed));
        let excess = needed.saturating_sub(self.base) as usize;
        if excess < SLACK.max(self.options.pre_trigger) {
            return;
        }
        self.force.drain(..excess);
        for kept in &mut self.responses {
            kept.drain(..excess);
        }
        self.base += excess as u64;
    }
}
