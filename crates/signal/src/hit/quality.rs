//! Quality of a hit.

use std::fmt;

use super::HitRecord;
use super::double::{DoubleHit, double_hits};
use super::fault::{SampleRun, clipped, force_dropouts, not_finite, overloads, response_dropouts};
use crate::offset::Offset;
use crate::sums::largest_magnitude;

/// A signal of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum HitChannel {
    /// The force.
    Force,
    /// A response, by its index.
    Response(usize),
}

/// A defect of a hit. Times are counted from the first sample of the hit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum QualityIssue {
    /// A double hit.
    DoubleHit(DoubleHit),
    /// Saturation of a converter or amplifier.
    Overload {
        /// The signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Samples in a row.
        samples: usize,
        /// Their value, in the unit of the signal.
        value: f64,
        /// The full scale, if given, in the unit of the signal.
        full_scale: Option<f64>,
    },
    /// An oscillation that is at exactly its largest or smallest value again and again.
    Clipped {
        /// The signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Separate times at the value.
        times: usize,
        /// The value, in the unit of the signal.
        value: f64,
    },
    /// A constant signal where it should vary.
    Dropout {
        /// The signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Equal samples in a row.
        samples: usize,
        /// Their value, in the unit of the signal.
        value: f64,
    },
    /// Samples that are infinite or not a number.
    NotFinite {
        /// The signal.
        channel: HitChannel,
        /// Time of the first such sample, in seconds.
        time_s: f64,
        /// Number of such samples in a row.
        samples: usize,
        /// True if the first is infinite, which stands for an overload; else it is missing.
        infinite: bool,
    },
    /// The record ended inside the hit.
    Truncated {
        /// Number of samples.
        samples: usize,
        /// Number of missing samples.
        missing: usize,
    },
    /// A response that has not decayed at the end of the hit, which causes leakage.
    NotDecayed {
        /// The signal.
        channel: HitChannel,
        /// Root mean square of the last twentieth over the largest value.
        ratio: f64,
        /// Largest ratio accepted.
        threshold: f64,
    },
}

impl QualityIssue {
    /// True if the frequency response of the hit is invalid: for every issue but a truncated hit and
    /// one that has not decayed, which have leakage only.
    pub fn is_disqualifying(&self) -> bool {
        !matches!(self, Self::Truncated { .. } | Self::NotDecayed { .. })
    }
}

impl fmt::Display for QualityIssue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DoubleHit(double) => write!(
                f,
                "double hit: {:.0} % of the first impact after {:.3} ms",
                100.0 * double.ratio,
                1e3 * (double.second_s - double.first_s)
            ),
            Self::Overload { channel, samples, value, .. } => {
                write!(f, "overload: the {channel} stays at {value} for {samples} samples")
            }
            Self::Clipped { channel, times, value, .. } => {
                write!(f, "overload: the {channel} is at {value}, a limit, {times} times")
            }
            Self::Dropout { channel, samples, value, .. } => {
                write!(f, "dropout: the {channel} stays at {value} for {samples} samples")
            }
            Self::NotFinite { channel, samples, infinite: true, .. } => {
                write!(f, "overload: {samples} samples of the {channel} are infinite")
            }
            Self::NotFinite { channel, samples, .. } => {
                write!(f, "dropout: {samples} samples of the {channel} are not finite")
            }
            Self::Truncated { samples, missing } => {
                write!(f, "truncated: {missing} of {} samples are missing", samples + missing)
            }
            Self::NotDecayed { ratio, threshold, .. } if !ratio.is_finite() => write!(
                f,
                "not decayed: the response does not fall below {:.1} % of its largest",
                100.0 * threshold
            ),
            Self::NotDecayed { ratio, threshold, .. } => write!(
                f,
                "not decayed: {:.1} % of the largest response remain at the end, above the limit \
                 of {:.1} %",
                100.0 * ratio,
                100.0 * threshold
            ),
        }
    }
}

impl fmt::Display for HitChannel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Response(_) => "response",
        })
    }
}

/// Part of a response that may remain where its record ends, over its largest value: of measured hits, and of simulated ones.
pub const UNDECAYED_RATIO: f64 = 0.01;

/// Limits of [`quality_issues`].
#[derive(Debug, Clone, PartialEq)]
pub struct QualityOptions {
    /// Smallest height of a further force maximum of a double hit, over the first.
    pub second_fraction: f64,
    /// Fewest equal samples in a row of an overload, at the largest or smallest value.
    pub flat_samples: usize,
    /// Full scale of the force, in newtons, if known.
    pub full_scale_n: Option<f64>,
    /// Full scale of the responses, in their unit, if known.
    pub full_scale_response: Option<f64>,
    /// Fewest equal samples in a row of a dropout, in an active response.
    pub constant_samples: usize,
    /// Largest root mean square of the last twentieth of a response, over its largest value.
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
            undecayed_ratio: UNDECAYED_RATIO,
        }
    }
}

/// The quality issues of a hit; none for a good one.
///
/// - Double hits by [`double_hits`], of the force without its offset at rest.
/// - Overloads: flat tops of [`QualityOptions::flat_samples`] whose edge is
///   steeper than two converter steps, and samples at or beyond a full scale.
/// - Clipped responses: five and more separate times at exactly the largest or the smallest value.
/// - Dropouts: [`QualityOptions::constant_samples`] equal samples in a response
///   above 2 % of its largest value before and after, or a response that is constant throughout;
///   three in a force that is above a quarter of its largest value before and after. They begin or end
///   in more than two converter steps, as the maxima of a coarsely digitised oscillation do not.
///
/// ```
/// use asperity_signal::{HitRecord, QualityIssue, QualityOptions, quality_issues};
///
/// let mut force = vec![0.0; 100];
/// force[10..17].copy_from_slice(&[4.0, 9.0, 10.0, 10.0, 10.0, 9.0, 4.0]);
/// let hit = HitRecord {
///     start: 0,
///     trigger: 10,
///     force,
///     responses: Vec::new(),
///     sample_rate_hz: 1e4,
///     missing: 0,
/// };
/// let options = QualityOptions { full_scale_n: Some(10.0), ..QualityOptions::default() };
/// let issues = quality_issues(&hit, &options);
/// assert!(matches!(issues[..], [QualityIssue::Overload { samples: 3, .. }]));
/// ```
pub fn quality_issues(hit: &HitRecord, options: &QualityOptions) -> Vec<QualityIssue> {
    let mut force = hit.force.clone();
    if let Some(offset) = Offset::at_rest(&force) {
        offset.remove(&mut force);
    }
    issues_with_force(hit, &force, options)
}

/// [`quality_issues`] with a known force without offset.
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
        let overload = |run: SampleRun| QualityIssue::Overload {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
            value: run.value,
            full_scale,
        };
        let dropout = |run: SampleRun| QualityIssue::Dropout {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
            value: run.value,
        };
        let not_finite_run = |run: SampleRun| QualityIssue::NotFinite {
            channel,
            time_s: hit.time(run.first),
            samples: run.samples,
            infinite: run.value.is_infinite(),
        };
        let flat = overloads(samples, options.flat_samples, full_scale);
        let is_clipped = |found: SampleRun| QualityIssue::Clipped {
            channel,
            time_s: hit.time(found.first),
            times: found.samples,
            value: found.value,
        };
        if let (true, HitChannel::Response(_)) = (flat.is_empty(), channel) {
            issues.extend(clipped(samples).map(is_clipped));
        }
        issues.extend(flat.into_iter().map(overload));
        issues.extend(dropouts.into_iter().map(dropout));
        issues.extend(not_finite(samples).into_iter().map(not_finite_run));
        if let HitChannel::Response(_) = channel {
            let mut about_rest = samples.clone();
            if let Some(offset) = Offset::of_response(samples, hit.trigger) {
                offset.remove(&mut about_rest);
            }
            issues.extend(undecayed(channel, &about_rest, options.undecayed_ratio));
        }
    }
    if hit.missing > 0 {
        issues.push(QualityIssue::Truncated { samples: hit.force.len(), missing: hit.missing });
    }
    issues
}

fn undecayed(channel: HitChannel, samples: &[f64], threshold: f64) -> Option<QualityIssue> {
    let largest = largest_magnitude(samples);
    let tail = &samples[samples.len() - samples.len() / 20..];
    let square = tail.iter().map(|x| x * x).sum::<f64>() / tail.len() as f64;
    let ratio = square.sqrt() / largest;
    (ratio > threshold).then_some(QualityIssue::NotDecayed { channel, ratio, threshold })
}
