//! One hit cut out of a record, and how records are cut.
//!
//! [`HitFinder`] cuts, [`quality_issues`] judges, [`Pulse`] describes the blow and
//! [`Offset`] takes the sensors' offset away.

mod double;
mod fault;
mod finder;
mod offset;
mod pulse;
mod quality;
mod trigger;

pub use double::{DoubleHit, double_hits};
pub use finder::HitFinder;
pub use offset::{Offset, OffsetSource};
pub use pulse::Pulse;
pub use quality::{HitChannel, QualityIssue, QualityOptions, quality_issues};
pub use trigger::{HitLength, HitOptions, Trigger, TriggerLevel, find_hits};

pub(crate) use quality::issues_with_force;

use crate::error::{Result, SignalError};
use crate::form::ResponseKind;
use crate::response::FrequencyResponse;

/// The samples of one hit: the force and every response measured with it.
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
    /// Samples the record ended too early for; zero where it did not.
    pub missing: usize,
}

impl HitRecord {
    /// Force and one response as a [`FrequencyResponse`].
    ///
    /// # Errors
    /// [`SignalError::Channels`] for a channel there is not, and those of
    /// [`FrequencyResponse::from_displacement`].
    pub fn response(&self, channel: usize, kind: ResponseKind) -> Result<FrequencyResponse> {
        let found = self.responses.len();
        let samples = self
            .responses
            .get(channel)
            .ok_or(SignalError::Channels { found, expected: channel + 1 })?;
        FrequencyResponse::new(&self.force, samples, self.sample_rate_hz, kind)
    }

    /// Time of a sample after the hit's first, in seconds.
    pub fn time(&self, index: usize) -> f64 {
        index as f64 / self.sample_rate_hz
    }
}
