//! Detection of hits in records and streams.

use super::HitRecord;
use super::trigger::{HitLength, HitOptions, Trigger};
use crate::error::{Result, SignalError, check_positive, check_rate};

/// Fewest samples dropped at a time.
const SLACK: usize = 4096;

/// Detects hits in a stream of blocks of any size.
///
/// A hit begins where the force reaches the trigger level from below after the hold-off
/// of the hit before. The result does not depend on the division into blocks. Memory is bounded by
/// one hit and one block.
///
/// [`HitOptions::trigger_level`] is not used, since the largest force of a stream is not known; the
/// level is given in newtons.
///
/// ```
/// use asperity_signal::{HitFinder, HitLength, HitOptions, TriggerLevel};
///
/// let options = HitOptions {
///     trigger_level: TriggerLevel::Absolute(1.0),
///     pre_trigger: 2,
///     length: HitLength::Samples(6),
///     hold_off: 4,
/// };
/// let mut finder = HitFinder::new(1, 1e3, 1.0, &options)?;
/// assert!(finder.push(&[0.0, 0.0, 0.0, 0.5], &[&[0.0; 4]])?.is_empty());
/// let hits = finder.push(&[5.0, 0.0, 0.0, 0.0], &[&[0.0; 4]])?;
/// assert_eq!((hits[0].start, hits[0].trigger, hits[0].force.len()), (2, 2, 6));
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone)]
pub struct HitFinder {
    options: HitOptions,
    level: f64,
    sample_rate_hz: f64,
    force: Vec<f64>,
    responses: Vec<Vec<f64>>,
    /// Index in the record of the first sample kept.
    base: u64,
    /// True if the last sample was below the level.
    below: bool,
    last_trigger: Option<u64>,
    open: Option<OpenHit>,
}

/// A hit that has begun.
#[derive(Debug, Clone, Copy)]
struct OpenHit {
    start: u64,
    trigger: u64,
}

impl HitFinder {
    /// Detection in a force with `channels` responses.
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

    /// Adds the next block and returns the hits that end in it.
    ///
    /// - `force`: in newtons; an empty block is allowed.
    /// - `responses`: one slice for each channel, as long as the force.
    ///
    /// # Errors
    /// [`SignalError::Channels`], [`SignalError::LengthMismatch`]; the block is then not added.
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
        self.discard();
        Ok(hits)
    }

    /// Ends the record and returns the hit that has not ended, if there is one, with its number of
    /// missing samples.
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
            self.open = Some(OpenHit { start, trigger: index });
            self.last_trigger = Some(index);
        }
        if let Some(open) = self.open
            && index + 1 - open.start >= self.options.length.most() as u64
        {
            hits.push(self.cut(open, index + 1));
            self.open = None;
        }
    }

    fn cut(&self, open: OpenHit, end: u64) -> HitRecord {
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

    /// Drops samples that no further hit needs, many at a time.
    fn discard(&mut self) {
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

/// Divides a record into hits.
///
/// - `force`: in newtons, positive when the hammer pushes.
/// - `responses`: any number of channels, each as long as the force.
/// - `sample_rate_hz`: positive, in hertz.
///
/// Samples that are not finite do not trigger and are kept in the hit; see
/// [`quality_issues`](super::quality_issues). With an absolute level a record may have no hit.
///
/// # Errors
/// Those of [`Trigger::of`] and of [`HitFinder::push`].
///
/// ```
/// use asperity_signal::{HitLength, HitOptions, TriggerLevel, find_hits};
///
/// let mut force = vec![0.0; 3000];
/// (force[500], force[2000]) = (10.0, 20.0);
/// let options = HitOptions {
///     trigger_level: TriggerLevel::Fraction(0.1),
///     pre_trigger: 50,
///     length: HitLength::UntilNext { limit: 2000 },
///     hold_off: 100,
/// };
/// let (hits, trigger) = find_hits(&force, &[], 1e3, &options)?;
/// assert_eq!((hits.len(), hits[1].start, trigger.level_n), (2, 1950, 2.0));
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
pub fn find_hits(
    force: &[f64],
    responses: &[&[f64]],
    sample_rate_hz: f64,
    options: &HitOptions,
) -> Result<(Vec<HitRecord>, Trigger)> {
    let trigger = Trigger::of(force, options)?;
    let mut finder = HitFinder::new(responses.len(), sample_rate_hz, trigger.level_n, options)?;
    let mut hits = finder.push(force, responses)?;
    hits.extend(finder.finish());
    Ok((hits, trigger))
}
