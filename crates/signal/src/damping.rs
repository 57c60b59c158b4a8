//! Damping of a resonance: half-power width, circle fit, comparison of methods.

mod circle;
mod comparison;

pub(crate) use circle::CircleSensitivity;
pub use circle::{CircleFit, circle_fit, circle_fit_of};
pub use comparison::DampingComparison;

use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::root::bracketed_root;
use std::f64::consts::SQRT_2;

/// The frequencies on either side of a peak at which `|H|^2` is half of its maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPower {
    /// Crossing below the peak, in hertz.
    pub lower_hz: f64,
    /// The peak, in hertz.
    pub peak_hz: f64,
    /// Crossing above the peak, in hertz.
    pub upper_hz: f64,
}

impl HalfPower {
    /// Damping ratio, exact for the receptance of one viscously damped mode.
    ///
    /// ```text
    /// zeta = sin(atan(q) / 2),   q = (f_b^2 - f_a^2) / (f_b^2 + f_a^2)
    /// ```
    ///
    /// Derivation: with `s = (f/f_n)^2`, `1/|H|^2` is proportional to
    /// `s^2 - 2 (1 - 2 zeta^2) s + 1`, with the minimum `4 zeta^2 (1 - zeta^2)` at
    /// `s = 1 - 2 zeta^2` and twice that at
    /// `s = 1 - 2 zeta^2 -+ 2 zeta sqrt(1 - zeta^2)`. With `zeta = sin a` these
    /// are `cos 2a -+ sin 2a`, so that `q = tan 2a`, independent of the natural
    /// frequency. Valid below `sin(pi/8) = 0.383`, where the lower crossing
    /// is at zero frequency. As damping vanishes it tends to
    /// [`HalfPower::small_damping_ratio`].
    pub fn ratio(&self) -> f64 {
        let (a, b) = (self.lower_hz, self.upper_hz);
        let q = (b - a) * (b + a) / (b * b + a * a);
        (0.5 * q.atan()).sin()
    }

    /// Damping ratio by the usual formula `(f_b - f_a) / (2 f_p)`, too large by about `2 zeta^3`.
    pub fn small_damping_ratio(&self) -> f64 {
        (self.upper_hz - self.lower_hz) / (2.0 * self.peak_hz)
    }
}

/// Damping ratio of a peak from its half-power crossings, [`HalfPower::ratio`].
///
/// The crossings are found on the exact transform of the record to 1e-13, where rounding allows it.
/// `None` if `|H|^2` does not fall to half on each side before `|H|` rises again, by 2 % of the
/// peak or more, as with overlapping modes.
///
/// A record that ends before the response has decayed widens the peak and
/// increases the ratio.
///
/// ```
/// use asperity_signal::{FrequencyResponse, HarmonicOptions, find_harmonics, half_power};
///
/// // Impulse response of a 1 kg oscillator at 200 Hz with 2 % of critical damping.
/// let (rate, omega, zeta) = (2e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - zeta * zeta).sqrt();
/// let displacement: Vec<f64> = (0..20_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| (-zeta * omega * t).exp() * (damped * t).sin() / damped)
///     .collect();
/// let mut force = vec![0.0; displacement.len()];
/// force[0] = rate;
/// let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
/// let found = find_harmonics(&hit, 190.0, &HarmonicOptions::default());
/// let ratio = found.fundamental.and_then(|peak| half_power(&hit, &peak));
/// assert!((ratio.ok_or("a peak of one mode has a width")? - zeta).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn half_power(response: &FrequencyResponse, peak: &Peak) -> Option<f64> {
    half_power_crossings(response, peak).map(|crossings| crossings.ratio())
}

/// Half-power crossings of a peak; `None` as for [`half_power`].
pub fn half_power_crossings(response: &FrequencyResponse, peak: &Peak) -> Option<HalfPower> {
    let power = |frequency| response.receptance_at(frequency).norm_sqr();
    let step = STEP / response.duration();
    half_power_of(power, peak.frequency_hz, step, 0.5 * response.sample_rate_hz())
}

/// Half-power crossings of any `|H(f)|^2` around its maximum.
///
/// - `power`: `|H|^2`, any unit, of a frequency in hertz.
/// - `peak_hz`: its local maximum, in hertz.
/// - `step_hz`: step away from the peak, a quarter of the resolution `1/T` of a record of length
///   `T`; beyond 32 of them a step is 1/32 of the distance from the peak. Two extrema between
///   neighbouring steps are missed; a single minimum is not.
/// - `upper_limit_hz`: upper limit of the search; the lower limit is zero.
///
/// `None` if `|H|` rises on a side by 2 % of the peak or more before it has fallen to half power, or if an
/// argument is not positive and finite.
///
/// ```
/// // 1/|H|^2 of a damping ratio sin(a) about 100 Hz.
/// let zeta = 0.05_f64;
/// let power = |f: f64| {
///     let s = (f / 100.0).powi(2);
///     1.0 / ((1.0 - s).powi(2) + 4.0 * zeta * zeta * s)
/// };
/// let peak = 100.0 * (1.0 - 2.0 * zeta * zeta).sqrt();
/// let crossings = asperity_signal::half_power_of(power, peak, 0.1, 200.0).ok_or("no width")?;
/// assert!((crossings.ratio() - zeta).abs() < 1e-9);
/// # Ok::<(), &str>(())
/// ```
pub fn half_power_of(
    mut power: impl FnMut(f64) -> f64,
    peak_hz: f64,
    step_hz: f64,
    upper_limit_hz: f64,
) -> Option<HalfPower> {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let top = power(peak_hz);
    if ![peak_hz, step_hz, upper_limit_hz, top].into_iter().all(positive) {
        return None;
    }
    let mut level = |frequency: f64| (power(frequency) / top).sqrt() * SQRT_2 - 1.0;
    let limits = (0.0, upper_limit_hz);
    let lower_hz = crossing(&mut level, peak_hz, -step_hz, limits)?;
    let upper_hz = crossing(&mut level, peak_hz, step_hz, limits)?;
    Some(HalfPower { lower_hz, peak_hz, upper_hz })
}

/// Step away from a peak over the resolution `1/T` of a record: its spectrum hardly has a
/// minimum and a maximum closer than that.
pub(crate) const STEP: f64 = 0.25;
/// Least step over the distance from the peak.
const GROWTH: f64 = 1.0 / 32.0;
/// Least rise over the lowest point on the way, over the height of the peak, that is another peak and not a
/// ripple of noise or of the end of a record.
const RISE: f64 = 0.02;
/// Relative tolerance of a crossing.
const TOLERANCE: f64 = 1e-13;

/// The first root of `level` on one side of the peak, which `step` points to; `None` if `level` rises by [`RISE`] first.
fn crossing(
    mut level: impl FnMut(f64) -> f64,
    peak_hz: f64,
    step: f64,
    (low, high): (f64, f64),
) -> Option<f64> {
    let mut points = vec![(peak_hz, SQRT_2 - 1.0)];
    let mut lowest = 0;
    loop {
        let near = points[points.len() - 1];
        let grown = GROWTH * (near.0 - peak_hz);
        let beyond = near.0 + if grown.abs() > step.abs() { grown } else { step };
        // The last step ends on a limit, which may be zero frequency itself.
        let far_hz = beyond.clamp(low, high);
        let far = (far_hz, level(far_hz));
        if far.1 <= 0.0 {
            return Some(bracketed_root(level, near, far, TOLERANCE));
        }
        if far.1 > points[lowest].1 + RISE * SQRT_2 {
            // The minimum between the neighbours of the lowest point may be lower.
            let from = points[lowest.saturating_sub(1)];
            let to = points.get(lowest + 1).unwrap_or(&far);
            let least = below_zero(&mut level, from.0, to.0)?;
            return Some(bracketed_root(level, from, least, TOLERANCE));
        }
        // On a limit, or with a step that is rounded away.
        if far_hz != beyond || far_hz == near.0 || far.1.is_nan() {
            return None;
        }
        if far.1 < points[lowest].1 {
            lowest = points.len();
        }
        points.push(far);
    }
}

/// A point at which `level` is not positive, in an interval in which it has a single minimum; `None` without one.
///
/// Golden section, to 4e-9 of the interval.
fn below_zero(mut level: impl FnMut(f64) -> f64, mut from: f64, mut to: f64) -> Option<(f64, f64)> {
    const PART: f64 = 0.381_966_011_250_105;
    let mut at = |part: f64, (from, to): (f64, f64)| {
        let frequency = from + part * (to - from);
        (frequency, level(frequency))
    };
    let (mut first, mut second) = (at(PART, (from, to)), at(1.0 - PART, (from, to)));
    for _ in 0..40 {
        if let Some(found) = [first, second].into_iter().find(|point| point.1 <= 0.0) {
            return Some(found);
        }
        if first.1 < second.1 {
            to = second.0;
            (first, second) = (at(PART, (from, to)), first);
        } else {
            from = first.0;
            (first, second) = (second, at(1.0 - PART, (from, to)));
        }
    }
    None
}
