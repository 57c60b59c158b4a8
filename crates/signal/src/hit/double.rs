//! Double hits.

use crate::noise::robust_level;

/// A second force maximum in one hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleHit {
    /// Time of the first maximum after the hit's first sample, in seconds.
    pub first_s: f64,
    /// Time of the further maximum, in seconds.
    pub second_s: f64,
    /// Height of the further maximum over the first.
    pub ratio: f64,
    /// Lowest force between the two over the first maximum.
    pub valley: f64,
    /// Smallest ratio of a double hit.
    pub threshold: f64,
}

/// Depth of a minimum over the threshold, at least.
const DEPTH: f64 = 0.5;
/// Depth of a minimum and height of a maximum over the robust deviation of the noise, at least.
const NOISE_FACTOR: f64 = 6.0;

/// Further force maxima of a hit.
///
/// Maxima and the minima between them are detected with hysteresis: a maximum
/// counts once the force has fallen by `h`, a minimum once it has risen by `h`,
///
/// ```text
/// h = max(fraction / 2 * largest, 6 s)
/// ```
///
/// with `s` the robust deviation of the force. Every maximum is at least `6 s` high. The first maximum of at least
/// `fraction` of the largest is the first hit; each later one of at least
/// `fraction` of the first, and above the undershoot before it, is a further hit.
/// A shoulder has no minimum before it and is none; the ringing of a sensor overshoots
/// less than it undershoots and is none.
///
/// - `force`: in newtons, without offset; samples that are not finite are skipped.
/// - `fraction`: between 0 and 1, otherwise nothing is found; 0.1 is usual.
///
/// ```
/// let mut force = [0.0; 40];
/// force[1..4].copy_from_slice(&[5.0, 10.0, 5.0]);
/// force[6..9].copy_from_slice(&[2.0, 4.0, 2.0]);
/// let found = asperity_signal::double_hits(&force, 1e3, 0.1);
/// assert_eq!((found[0].second_s, found[0].ratio), (7e-3, 0.4));
/// ```
pub fn double_hits(force: &[f64], sample_rate_hz: f64, fraction: f64) -> Vec<DoubleHit> {
    let largest = force.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
    if !(fraction > 0.0 && fraction < 1.0) || largest <= 0.0 {
        return Vec::new();
    }
    let noise = robust_level(force).map_or(0.0, |level| level.deviation);
    let hysteresis = (DEPTH * fraction * largest).max(NOISE_FACTOR * noise);
    let maxima = maxima(force, hysteresis);
    let Some(begin) = maxima.iter().position(|maximum| maximum.top >= fraction * largest) else {
        return Vec::new();
    };
    let first = maxima[begin];
    let time = |index: usize| index as f64 / sample_rate_hz;
    let mut valley = f64::INFINITY;
    let mut found = Vec::new();
    for maximum in &maxima[begin + 1..] {
        valley = valley.min(maximum.valley);
        let is_high = maximum.top >= (fraction * first.top).max(NOISE_FACTOR * noise);
        if is_high && maximum.top > -maximum.valley {
            found.push(DoubleHit {
                first_s: time(first.index),
                second_s: time(maximum.index),
                ratio: maximum.top / first.top,
                valley: valley / first.top,
                threshold: fraction,
            });
            valley = f64::INFINITY;
        }
    }
    found
}

/// A maximum and the minimum before it.
#[derive(Debug, Clone, Copy)]
struct ForceMaximum {
    index: usize,
    top: f64,
    valley: f64,
}

/// Maxima above the minimum before and the force after by the hysteresis.
fn maxima(force: &[f64], hysteresis: f64) -> Vec<ForceMaximum> {
    let mut found = Vec::new();
    let mut valley = f64::INFINITY;
    let mut rising: Option<(usize, f64)> = None;
    let finite = force.iter().copied().enumerate().filter(|(_, x)| x.is_finite());
    for (index, x) in finite {
        match rising {
            Some((_, top)) if x > top => rising = Some((index, x)),
            Some((at, top)) if x < top - hysteresis => {
                found.push(ForceMaximum { index: at, top, valley });
                (rising, valley) = (None, x);
            }
            None if x < valley => valley = x,
            None if x > valley + hysteresis => rising = Some((index, x)),
            _ => {}
        }
    }
    // The record may end before the force falls.
    found.extend(rising.map(|(index, top)| ForceMaximum { index, top, valley }));
    found
}
