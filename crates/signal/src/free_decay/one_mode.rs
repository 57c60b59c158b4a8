//! Points of a decay, and the part in which its band holds one mode.

use std::ops::RangeInclusive;

use num_complex::Complex64;

use crate::noise::median_of;

use super::beating::{BeatSearch, Beating, FEWEST_BEATS};
use super::harmonics::DecayHarmonic;
use crate::ring_down::{BackbonePoint, BackboneUncertainty};

/// Growth of the amplitude, in standard deviations, that noise does not explain.
const GROWTH: f64 = 6.0;
/// Largest amplitude of other vibration that ends a decay, over the first amplitude, for one that
/// decays and one that lasts; the largest decay rate of a lasting one over that of the decay; and the
/// least amplitude of the decay over the other vibration.
const BACKGROUND: (f64, f64) = (0.02, 0.1);
const LASTING: f64 = 0.3;
const ABOVE_BACKGROUND: f64 = 5.0;
/// Decay rate of vibration that remains, over the median of as many points before.
const STALL: f64 = 0.25;
const BEFORE: usize = 12;
/// Part of the points that is left out at a time, and the least that remains.
const STEP: f64 = 0.1;
const LEAST: f64 = 0.2;
/// Fewest points.
const FEWEST: usize = 8;

/// One point of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayPoint {
    /// Time, amplitude, frequency and damping.
    pub point: BackbonePoint,
    /// Their standard deviations due to noise.
    pub uncertainty: BackboneUncertainty,
    /// Amplitudes of the second and the third harmonic over the fundamental's; `None` where
    /// they are noise.
    pub harmonics: [Option<DecayHarmonic>; 2],
}

/// The first points of a backbone, in which the band holds one mode; all where it holds several.
pub(super) struct OneModePart {
    pub(super) points: usize,
    /// Strongest beat in this part.
    pub(super) beating: Option<Beating>,
    /// True if the amplitude grows or hardly falls somewhere in this part.
    pub(super) stalls: bool,
}

impl OneModePart {
    pub(super) fn of(
        points: &[DecayPoint],
        signal: &[Complex64],
        half: usize,
        search: &BeatSearch,
    ) -> Self {
        let all = above_background(points);
        let examine = |count: usize| Self {
            points: count,
            beating: strongest(&points[..count], signal, half, search),
            stalls: (0..count).any(|at| stalls(points, at)),
        };
        let whole = examine(all);
        let Some(beat) = whole.beating.filter(|beat| !beat.is_small() || whole.stalls) else {
            return whole;
        };
        let mut count = all;
        let least = FEWEST.max((LEAST * all as f64) as usize);
        loop {
            count -= ((STEP * all as f64) as usize).max(1).min(count);
            if count < least {
                return whole;
            }
            // A shorter part shows fewer beats, and none is not one mode.
            let span = points[count - 1].point.time_s - points[0].point.time_s;
            if span * beat.offset_hz.abs() < FEWEST_BEATS {
                return whole;
            }
            let part = examine(count);
            if !part.stalls && part.beating.is_none_or(|beating| beating.is_small()) {
                return part;
            }
        }
    }
}

/// Number of points well above the vibration that remains when the mode has decayed: it begins where
/// the amplitude grows, or hardly falls within three lines.
fn above_background(points: &[DecayPoint]) -> usize {
    let (Some(first), Some(stall)) =
        (points.first(), (0..points.len()).find(|at| stalls(points, *at)))
    else {
        return points.len();
    };
    let rest = points[stall..].iter().map(|one| one.point.amplitude).fold(0.0, f64::max);
    // Hum does not decay, a second mode that beats does.
    let rate = |from: &DecayPoint, to: &DecayPoint| {
        (from.point.amplitude / to.point.amplitude).ln() / (to.point.time_s - from.point.time_s)
    };
    let (at, last) = (&points[stall], &points[points.len() - 1]);
    let is_lasting = rate(at, last) < LASTING * rate(first, at);
    let limit = if is_lasting { BACKGROUND.1 } else { BACKGROUND.0 };
    if rest > limit * first.point.amplitude {
        return points.len();
    }
    points.iter().take_while(|one| one.point.amplitude > ABOVE_BACKGROUND * rest).count()
}

/// True if the amplitude grows at a point, or hardly falls compared with three lines before.
fn stalls(points: &[DecayPoint], at: usize) -> bool {
    let one = &points[at];
    let noise = GROWTH * one.uncertainty.decay_rate;
    let before = &points[at.saturating_sub(BEFORE)..at];
    let mut rates: Vec<f64> = before.iter().map(|one| one.point.decay_rate).collect();
    let usual = if before.len() == BEFORE { median_of(&mut rates) } else { None };
    // Rounding makes an undamped mode grow.
    let least = -1e-6 * one.point.frequency_hz;
    one.point.decay_rate < (STALL * usual.unwrap_or(0.0)).max(least) - noise
}

/// The beat of the largest effect in a part of a decay and in its second half.
fn strongest(
    points: &[DecayPoint],
    signal: &[Complex64],
    half: usize,
    search: &BeatSearch,
) -> Option<Beating> {
    let of = |points: &[DecayPoint]| {
        let (first, last) = (points.first()?, points.last()?);
        let span = span_of(points, half, search.sample_rate_hz)?;
        let fall = (first.point.amplitude / last.point.amplitude).ln();
        let decay_rate = fall / (last.point.time_s - first.point.time_s);
        search.strongest(signal.get(span)?, decay_rate)
    };
    let found = [of(points), of(&points[points.len() / 2..])];
    found.into_iter().flatten().max_by(|a, b| a.decay_rate_error.total_cmp(&b.decay_rate_error))
}

/// Samples of the lines of some points.
pub(super) fn span_of(
    points: &[DecayPoint],
    half: usize,
    rate: f64,
) -> Option<RangeInclusive<usize>> {
    let place = |one: &DecayPoint| (one.point.time_s * rate).round() as usize;
    Some(place(points.first()?) - half..=place(points.last()?) + half)
}
