//! A hammer that touches twice.

use crate::noise::robust_level;

/// Two blows in one hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleHit {
    /// Time of the first maximum after the hit's first sample, in seconds.
    pub first_s: f64,
    /// Time of the further maximum, in seconds.
    pub second_s: f64,
    /// Its height over the first.
    pub ratio: f64,
    /// The lowest force between the two over the first.
    pub valley: f64,
    /// The ratio from which a maximum counts.
    pub threshold: f64,
}

/// A valley is at least this fraction of the threshold deep.
const DEPTH: f64 = 0.5;
/// And this many robust deviations of the noise.
const NOISE_FACTOR: f64 = 6.0;

/// Further force maxima that are blows of their own.
///
/// Maxima and the valleys between them are told by hysteresis: a maximum
/// counts once the force has fallen by `h`, a valley once it has risen by `h`,
///
/// ```text
/// h = max(fraction / 2 * largest, 6 s)
/// ```
///
/// with `s` the robust deviation of the force. The first maximum of at least
/// `fraction` of the largest is the first blow; each later one of at least
/// `fraction` of the first, and above the undershoot before it, is another.
/// A shoulder has no valley and is none; the ringing of a sensor overshoots
/// less than it undershot and is none either.
///
/// - `force`: in newtons, without offset; samples that are not finite are skipped.
/// - `fraction`: 0.1 is usual; one that is not between 0 and 1 finds nothing.
pub fn double_hits(force: &[f64], sample_rate_hz: f64, fraction: f64) -> Vec<DoubleHit> {
    let largest = force.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
    if !(fraction > 0.0 && fraction < 1.0) || largest <= 0.0 {
        return Vec::new();
    }
    let noise = robust_level(force).map_or(0.0, |level| level.deviation);
    let hysteresis = (DEPTH * fraction * largest).max(NOISE_FACTOR * noise);
    let extrema = extrema(force, hysteresis);
    let Some(begin) = extrema.iter().position(|extremum| extremum.top >= fraction * largest) else {
        return Vec::new();
    };
    let first = extrema[begin];
    let time = |index: usize| index as f64 / sample_rate_hz;
    let mut valley = f64::INFINITY;
    let mut found = Vec::new();
    for extremum in &extrema[begin + 1..] {
        valley = valley.min(extremum.valley);
        if extremum.top >= fraction * first.top && extremum.top > -extremum.valley {
            found.push(DoubleHit {
                first_s: time(first.index),
                second_s: time(extremum.index),
                ratio: extremum.top / first.top,
                valley: valley / first.top,
                threshold: fraction,
            });
            valley = f64::INFINITY;
        }
    }
    found
}

/// A maximum and the valley before it.
#[derive(Debug, Clone, Copy)]
struct Extremum {
    index: usize,
    top: f64,
    valley: f64,
}

/// Maxima that rise above the valley before and fall after by the hysteresis.
fn extrema(force: &[f64], hysteresis: f64) -> Vec<Extremum> {
    let mut found = Vec::new();
    let mut valley = f64::INFINITY;
    let mut rising: Option<(usize, f64)> = None;
    let finite = force.iter().copied().enumerate().filter(|(_, x)| x.is_finite());
    for (index, x) in finite {
        match rising {
            Some((_, top)) if x > top => rising = Some((index, x)),
            Some((at, top)) if x < top - hysteresis => {
                found.push(Extremum { index: at, top, valley });
                (rising, valley) = (None, x);
            }
            None if x < valley => valley = x,
            None if x > valley + hysteresis => rising = Some((index, x)),
            _ => {}
        }
    }
    // A blow that the record ends in has no fall after it.
    found.extend(rising.map(|(index, top)| Extremum { index, top, valley }));
    found
}
