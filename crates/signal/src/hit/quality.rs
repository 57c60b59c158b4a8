//! Whether a hit can be believed.

use super::HitRecord;
use super::double::{DoubleHit, double_hits};
use super::fault::{Run, force_dropouts, not_finite, overloads, response_dropouts};
use super::offset::Offset;

/// A signal of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HitChannel {
    /// The force.
    Force,
    /// A response, by its index.
    Response(usize),
}

/// What is wrong with a hit, with its evidence. Times count from the hit's first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum QualityIssue {
    /// The hammer touched again.
    DoubleHit(DoubleHit),
    /// A converter or amplifier was at its limit.
    Overload {
        /// Which signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Samples in a row.
        samples: usize,
        /// The value they stand at, in the signal's unit.
        value: f64,
        /// The full scale given, if one was, in the signal's unit.
        full_scale: Option<f64>,
    },
    /// The signal stands still while it should move.
    Dropout {
        /// Which signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Equal samples in a row.
        samples: usize,
        /// The value they stand at, in the signal's unit.
        value: f64,
    },
    /// Samples that are infinite or not a number.
    NotFinite {
        /// Which signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Such samples in a row.
        samples: usize,
    },
    /// The record ended inside the hit.
    Truncated {
        /// Samples there are.
        samples: usize,
        /// Samples missing.
        missing: usize,
    },
    /// The response still moves where the hit ends: the spectrum leaks.
    NotDecayed {
        /// Which signal.
        channel: HitChannel,
        /// Root mean square of the last twentieth over the largest value.
        ratio: f64,
        /// The ratio accepted.
        threshold: f64,
    },
}

impl QualityIssue {
    /// Whether a spectrum of the hit would be wrong.
    ///
    /// A truncated or undecayed hit leaks but is a hit; the other issues
    /// say that force and response do not belong together.
    pub fn is_disqualifying(&self) -> bool {
        !matches!(self, Self::Truncated { .. } | Self::NotDecayed { .. })
    }
}

/// What [`quality_issues`] accepts.
#[derive(Debug, Clone, PartialEq)]
pub struct QualityOptions {
    /// Height of a further force maximum over the first, from which it is a double hit.
    pub second_fraction: f64,
    /// Equal samples in a row at the largest or smallest value that are an overload.
    pub flat_samples: usize,
    /// Full scale of the force, in newtons, if known.
    pub full_scale_n: Option<f64>,
    /// Full scale of the responses, in their unit, if known.
    pub full_scale_response: Option<f64>,
    /// Equal samples in a row of an active response that are a dropout.
    pub constant_samples: usize,
    /// Root mean square of the last twentieth of a response over its largest value.
    pub undecayed_ratio: f64,
}

impl Default for QualityOptions {
    fn default() -> Self {
        Self {
            second_fraction: 0.1,
            flat_samples: 3,
            full_scale_n: None,
            full_scale_response: None,
            constant_samples: 8,
            undecayed_ratio: 0.01,
        }
    }
}

/// Everything that is wrong with a hit; nothing for a good one.
///
/// - Double hits by [`double_hits`], on the force without its offset at rest.
/// - Overloads: flat tops of [`QualityOptions::flat_samples`] whose edge is
///   steeper than two converter steps, and samples at or beyond a full scale.
/// - Dropouts: [`QualityOptions::constant_samples`] equal samples in a response
///   above 2 % of its largest value before and after; three in a force that is
///   above a quarter of its largest value before and after.
pub fn quality_issues(hit: &HitRecord, options: &QualityOptions) -> Vec<QualityIssue> {
    let mut force = hit.force.clone();
    if let Some(offset) = Offset::at_rest(&force) {
        offset.remove(&mut force);
    }
    issues_with_force(hit, &force, options)
}

/// [`quality_issues`] where the force without its offset is known.
pub(crate) fn issues_with_force(
    hit: &HitRecord,
    force: &[f64],
    options: &QualityOptions,
) -> Vec<QualityIssue> {
    let mut issues = Vec::new();
    let doubles = double_hits(force, hit.sample_rate_hz, options.second_fraction);
    issues.extend(doubles.into_iter().map(QualityIssue::DoubleHit));

    let responses = hit.responses.iter().enumerate().map(|(n, x)| (HitChannel::Response(n), x));
    for (channel, samples) in std::iter::once((HitChannel::Force, &hit.force)).chain(responses) {
        let (full_scale, dropouts) = match channel {
            HitChannel::Force => (options.full_scale_n, force_dropouts(samples)),
            HitChannel::Response(_) => {
                let dropouts = response_dropouts(samples, options.constant_samples);
                (options.full_scale_response, dropouts)
            }
        };
        let overload = |run: Run| QualityIssue::Overload {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
            value: run.value,
            full_scale,
        };
        let dropout = |run: Run| QualityIssue::Dropout {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
            value: run.value,
        };
        let lost = |run: Run| QualityIssue::NotFinite {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
        };
        issues
            .extend(overloads(samples, options.flat_samples, full_scale).into_iter().map(overload));
        issues.extend(dropouts.into_iter().map(dropout));
        issues.extend(not_finite(samples).into_iter().map(lost));
        if let HitChannel::Response(_) = channel {
            issues.extend(undecayed(channel, samples, options.undecayed_ratio));
        }
    }
    if hit.missing > 0 {
        issues.push(QualityIssue::Truncated { samples: hit.force.len(), missing: hit.missing });
    }
    issues
}

fn undecayed(channel: HitChannel, samples: &[f64], threshold: f64) -> Option<QualityIssue> {
    let largest = samples.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let tail = &samples[samples.len() - samples.len() / 20..];
    let square = tail.iter().map(|x| x * x).sum::<f64>() / tail.len() as f64;
    let ratio = square.sqrt() / largest;
    (ratio > threshold).then_some(QualityIssue::NotDecayed { channel, ratio, threshold })
}
