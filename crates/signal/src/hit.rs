//! Hits in a record: detection, samples, quality.

mod double;
mod fault;
mod finder;
mod quality;
mod trigger;

pub use double::{DoubleHit, double_hits};
pub use finder::{HitFinder, find_hits};
pub use quality::{HitChannel, QualityIssue, QualityOptions, UNDECAYED_RATIO, quality_issues};
pub use trigger::{HitLength, HitOptions, Trigger, TriggerLevel};

pub(crate) use quality::issues_with_force;

use crate::error::{Result, SignalError};
use crate::form::ResponseKind;
use crate::response::FrequencyResponse;

/// The samples of one hit: the force and the responses measured with it.
#[derive(Debug, Clone, PartialEq)]
pub struct HitRecord {
    /// Index in the record of the first sample.
    pub start: u64,
    /// Index in the hit of the first sample at or above the trigger level.
    pub trigger: usize,
    /// Force, in newtons.
    pub force: Vec<f64>,
    /// Responses, each as long as the force, in their own units.
    pub responses: Vec<Vec<f64>>,
    /// Sample rate, in hertz.
    pub sample_rate_hz: f64,
    /// Number of samples missing because the record ended inside the hit.
    pub missing: usize,
}

impl HitRecord {
    /// The [`FrequencyResponse`] of one response channel.
    ///
    /// # Errors
    /// [`SignalError::Channels`] for a channel that does not exist, and those of
    /// [`FrequencyResponse::from_displacement`].
    pub fn response(&self, channel: usize, kind: ResponseKind) -> Result<FrequencyResponse> {
        let found = self.responses.len();
        let samples = self
            .responses
            .get(channel)
            .ok_or(SignalError::Channels { found, expected: channel + 1 })?;
        FrequencyResponse::new(&self.force, samples, self.sample_rate_hz, kind)
    }

    /// Time of a sample after the first sample of the hit, in seconds.
    pub fn time(&self, index: usize) -> f64 {
        index as f64 / self.sample_rate_hz
    }
}
