//! Damping from the envelope of one oscillation in a decay that has others.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Half the length of the window, in cycles.
const HALF_WINDOW: f64 = 1.0;
/// Envelopes a cycle.
const A_CYCLE: f64 = 4.0;
/// Smallest envelope used, over the first.
const FLOOR: f64 = 1e-3;
/// Fewest cycles between the first and the last envelope.
const FEWEST: f64 = 1.0;
/// Standard deviation of the logarithm of an envelope that neither decays nor grows, at most.
const STEADY: f64 = 0.05;
/// Distance of the local frequency from the one given, over it, up to which the window's gain is taken out.
const FARTHEST: f64 = 0.5;

/// Damping ratio of the oscillation near a frequency in a free decay, where other motions may be larger.
///
/// ```text
/// S(t) = sum w(t_n - t) u(t_n) exp(-i 2 pi f t_n),   w(s) = (1 + cos(pi f s)) / 2,   |s| < 1/f
/// c(t) = f t + arg S(t) / (2 pi),   A(t) = |S(t)| / G(2 (c' - f) / f),   G(x) = sin(pi x) / (pi x (1 - x^2))
/// ln A = const - delta c,   zeta = delta / sqrt(4 pi^2 + delta^2)
/// ```
///
/// The window is two cycles long: its transform is zero at an offset, at twice `f` and at all its higher harmonics, and falls as
/// the cube of the distance beyond. The line of the logarithm of the envelope over the cycles `c` is fitted by least
/// squares to four envelopes a cycle or a few more, up to the last whole window, or to where the envelope falls below 1e-3 of
/// the first. Each counts by the product of its distances from both ends, so that it hardly matters where a record that
/// beats begins and ends. `G` takes out the window's gain along a decay whose frequency changes.
///
/// - `samples`: at `sample_rate_hz`; free decay in `range`, in samples from the first one, between two where its ends are.
/// - `frequency_hz`: of the oscillation, at most an eighth of the rate.
///
/// `None` for a decay of fewer than three cycles, an envelope that grows or scatters about the line by more than the line falls
/// (standard deviations, above 5 %), as where a body that was thrown up hits again and again, and samples or arguments that are
/// not finite. Limiting case: a decay of one viscously damped mode has its ratio, and zero without damping. With another
/// oscillation within half of `frequency_hz` the envelope beats, and the ratio is a mean.
///
/// ```
/// use asperity_signal::envelope_decrement;
///
/// // A mode of 1 % at 100 Hz, an offset, and twice as large a mode at 430 Hz.
/// let mode = |f: f64, zeta: f64, t: f64| {
///     let omega = std::f64::consts::TAU * f;
///     (-zeta * omega * t).exp() * (omega * (1.0 - zeta * zeta).sqrt() * t).cos()
/// };
/// let rate = 1e4;
/// let decay: Vec<f64> = (0..2000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| 0.5 + mode(100.0, 0.01, t) + 2.0 * mode(430.0, 0.01, t))
///     .collect();
/// let ratio = envelope_decrement(&decay, 0.0..1999.0, rate, 100.0).ok_or("a decay has a decrement")?;
/// assert!((ratio - 0.01).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn envelope_decrement(
    samples: &[f64],
    range: Range<f64>,
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Option<f64> {
    let per_cycle = sample_rate_hz / frequency_hz;
    let valid = per_cycle.is_finite() && per_cycle >= 8.0 && range.start >= 0.0;
    if !valid || !samples.iter().fold(true, |all, sample| all & sample.is_finite()) {
        return None;
    }
    let end = range.end.min(samples.len().saturating_sub(1) as f64);
    let first = range.start / per_cycle + HALF_WINDOW;
    let last = end / per_cycle - HALF_WINDOW;
    if last - first < FEWEST || !last.is_finite() {
        return None;
    }
    let sums = DemodulatedSums::of(samples, per_cycle);
    let count = ((last - first) * A_CYCLE).ceil() as usize;
    let times = (0..=count).map(|k| first + (last - first) * k as f64 / count as f64);
    let envelopes = above_floor(envelopes(times, &sums));
    fitted_decrement(&envelopes).map(|delta| delta / TAU.hypot(delta))
}

/// Sums of the samples before each, turned back by a half, one and one and a half of the frequency.
struct DemodulatedSums {
    per_cycle: f64,
    sums: Vec<[Complex64; 3]>,
}

impl DemodulatedSums {
    fn of(samples: &[f64], per_cycle: f64) -> Self {
        let turn = Complex64::cis(-PI / per_cycle);
        // Of few samples a cycle the window leaves a trace of an offset.
        let offset = last_offset(samples, per_cycle);
        let (mut half, mut sum) = (Complex64::ONE, [Complex64::ZERO; 3]);
        let mut sums = Vec::with_capacity(samples.len() + 1);
        sums.push(sum);
        for sample in samples {
            let scaled = half * (sample - offset);
            let whole = scaled * half;
            for (sum, term) in sum.iter_mut().zip([scaled, whole, whole * half]) {
                *sum += term;
            }
            sums.push(sum);
            half *= turn;
        }
        Self { per_cycle, sums }
    }

    /// `S` of the window about a time in cycles.
    fn windowed(&self, time: f64) -> Complex64 {
        let from = ((time - HALF_WINDOW) * self.per_cycle).ceil().max(0.0) as usize;
        let to = ((time + HALF_WINDOW) * self.per_cycle) as usize;
        let last = self.sums.len() - 1;
        let [from, to] = [from.min(last), (to + 1).min(last)].map(|place| self.sums[place]);
        let turn = Complex64::cis(PI * time);
        let [half, whole, more] = [0, 1, 2].map(|k| to[k] - from[k]);
        0.5 * whole + 0.25 * (turn.conj() * half + turn * more)
    }
}

/// Mean in the last window of the samples.
fn last_offset(samples: &[f64], per_cycle: f64) -> f64 {
    let length = 2.0 * HALF_WINDOW * per_cycle;
    let last = samples.iter().rev().take(length as usize + 1).enumerate();
    let weighted = last.map(|(k, sample)| (1.0 - (TAU * k as f64 / length).cos(), sample));
    let (sum, weights) =
        weighted.fold((0.0, 0.0), |(s, w), (weight, x)| (s + weight * x, w + weight));
    sum / weights
}

/// An oscillation at a time: its cycles since the first, and the logarithm of its amplitude.
#[derive(Debug, Clone, Copy)]
struct Envelope {
    time: f64,
    cycles: f64,
    log: f64,
}

/// The envelopes at times in cycles of the frequency.
fn envelopes(times: impl Iterator<Item = f64>, sums: &DemodulatedSums) -> Vec<Envelope> {
    let mut cycles = 0.0;
    let mut before: Option<(f64, Complex64)> = None;
    let mut found = Vec::new();
    for time in times {
        let value = sums.windowed(time);
        if let Some((earlier, other)) = before {
            cycles += time - earlier + (value * other.conj()).arg() / TAU;
        }
        before = Some((time, value));
        found.push(Envelope { time, cycles, log: value.norm().ln() });
    }
    let gains: Vec<f64> = (0..found.len())
        .map(|k| {
            let (a, b) = (&found[k.saturating_sub(1)], &found[(k + 1).min(found.len() - 1)]);
            gain((b.cycles - a.cycles) / (b.time - a.time) - 1.0)
        })
        .collect();
    for (envelope, gain) in found.iter_mut().zip(gains) {
        envelope.log -= gain.ln();
    }
    found
}

/// Gain of the window at a relative distance from the frequency, over that at it.
fn gain(distance: f64) -> f64 {
    let x = 2.0 * distance.clamp(-FARTHEST, FARTHEST);
    if x.abs() < 1e-6 {
        return 1.0;
    }
    // At the limits of the clamp, of which both terms are zero, it is a half.
    let rest = 1.0 - x * x;
    if rest < 1e-9 { 0.5 } else { (PI * x).sin() / (PI * x * rest) }
}

/// The envelopes down to the floor, with one on it in place of the first below it.
fn above_floor(mut envelopes: Vec<Envelope>) -> Vec<Envelope> {
    let Some(floor) = envelopes.first().map(|first| first.log + FLOOR.ln()) else {
        return envelopes;
    };
    let Some(below) = envelopes.iter().position(|envelope| envelope.log < floor) else {
        return envelopes;
    };
    let (a, b) = (envelopes[below - 1], envelopes[below]);
    let part = (a.log - floor) / (a.log - b.log);
    let between = |a: f64, b: f64| a + part * (b - a);
    envelopes.truncate(below);
    envelopes.push(Envelope {
        time: between(a.time, b.time),
        cycles: between(a.cycles, b.cycles),
        log: floor,
    });
    envelopes
}

/// Decrease a cycle of the line through the envelopes, which count by the product of their distances from both ends.
fn fitted_decrement(envelopes: &[Envelope]) -> Option<f64> {
    let [first, .., last] = envelopes else { return None };
    let known = last.time - first.time >= FEWEST;
    let weight = |one: &Envelope| (one.time - first.time) * (last.time - one.time);
    let weights: f64 = envelopes.iter().map(weight).sum();
    let mean = |of: &dyn Fn(&Envelope) -> f64| {
        envelopes.iter().map(|one| weight(one) * of(one)).sum::<f64>() / weights
    };
    let (cycles, log) = (mean(&|one| one.cycles), mean(&|one| one.log));
    let cross = mean(&|one| (one.cycles - cycles) * (one.log - log));
    let square = mean(&|one| (one.cycles - cycles).powi(2));
    let decrement = -cross / square;
    // Standard deviations of the envelope by the line, negative if it grows, and about it.
    let fall = decrement * square.sqrt();
    let scatter = (mean(&|one| (one.log - log).powi(2)) - fall * fall).max(0.0).sqrt();
    let decays = if scatter > STEADY { fall >= scatter } else { fall >= -STEADY };
    (known && decays && decrement.is_finite()).then_some(decrement)
}
