//! Peak, impulse and widths of a force pulse.

use crate::fit::parabola_vertex;

/// Peak, impulse and widths of a force pulse.
///
/// The crossings of a fraction of the largest sample are those nearest
/// to it on either side, by linear interpolation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// The largest force sample, in newtons.
    pub peak_n: f64,
    /// Vertex of the parabola through the largest sample and its neighbours,
    /// in newtons; the largest sample itself at an end of the record.
    pub refined_peak_n: f64,
    /// Index of the largest sample.
    pub peak_index: usize,
    /// Time of the parabola's vertex after the first sample, in seconds.
    pub peak_time_s: f64,
    /// `integral F dt` over the pulse by the trapezoidal rule, in N s.
    ///
    /// Between the crossings of 1 % of the largest sample.
    pub impulse_n_s: f64,
    /// Times of the two crossings of 1 %, the range of the impulse, in seconds.
    pub base_s: (f64, f64),
    /// Full width at half of the largest sample, in seconds.
    pub width_s: f64,
    /// Duration above a tenth of the largest sample, in seconds.
    pub duration_s: f64,
}

/// Fraction of the peak at which the impulse begins and ends.
const BASE: f64 = 0.01;

impl Pulse {
    /// The pulse around the largest sample of a force without offset.
    ///
    /// - `force`: in newtons.
    /// - `sample_rate_hz`: positive, in hertz.
    ///
    /// `None` if no sample is positive, a sample is not finite, or the rate is not
    /// positive. A pulse cut by an end of the record is measured up to there.
    /// Limiting case: a half-sine of duration `T` has impulse
    /// `2 F T / pi`, width `2 T / 3` and duration `0.936 T`.
    ///
    /// ```
    /// use asperity_signal::Pulse;
    ///
    /// let force: Vec<f64> =
    ///     (0..=100).map(|n| 9.0 * (std::f64::consts::PI * f64::from(n) / 100.0).sin()).collect();
    /// let pulse = Pulse::of(&force, 1e5).ok_or("a positive force has a pulse")?;
    /// assert!((pulse.peak_n - 9.0).abs() < 1e-12);
    /// assert!((pulse.width_s - 2e-3 / 3.0).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(force: &[f64], sample_rate_hz: f64) -> Option<Self> {
        let rate = sample_rate_hz;
        if !(rate > 0.0 && rate.is_finite()) || force.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let largest = |best: usize, (index, x): (usize, &f64)| {
            if *x > force[best] { index } else { best }
        };
        let peak_index = force.iter().enumerate().fold(0, largest);
        let peak_n = *force.get(peak_index)?;
        if peak_n <= 0.0 {
            return None;
        }
        let (shift, refined_peak_n) = vertex(force, peak_index);
        let length = |fraction: f64| {
            let (first, last) = crossings(force, peak_index, fraction * peak_n);
            (last - first) / rate
        };
        let (first, last) = crossings(force, peak_index, BASE * peak_n);
        Some(Self {
            peak_n,
            refined_peak_n,
            peak_index,
            peak_time_s: (peak_index as f64 + shift) / rate,
            impulse_n_s: area(force, first, last) / rate,
            base_s: (first / rate, last / rate),
            width_s: length(0.5),
            duration_s: length(0.1),
        })
    }
}

/// Shift (samples) and height of the parabola about the largest sample.
fn vertex(force: &[f64], index: usize) -> (f64, f64) {
    let here = force[index];
    let neighbours = index.checked_sub(1).map(|before| (force[before], force.get(index + 1)));
    let Some((before, Some(&after))) = neighbours else {
        return (0.0, here);
    };
    parabola_vertex([before, here, after]).unwrap_or((0.0, here))
}

/// Crossings of `level` on either side of a peak, in samples.
fn crossings(force: &[f64], peak: usize, level: f64) -> (f64, f64) {
    let between = |inside: usize, outside: usize| {
        let (a, b) = (force[inside], force[outside]);
        let part = (a - level) / (a - b);
        inside as f64 + part * (outside as f64 - inside as f64)
    };
    let first = (0..peak).rev().find(|&n| force[n] < level).map_or(0.0, |n| between(n + 1, n));
    let last = (peak + 1..force.len()).find(|&n| force[n] < level);
    let last = last.map_or(force.len() as f64 - 1.0, |n| between(n - 1, n));
    (first, last)
}

/// Trapezoidal integral between two positions (samples) of a piecewise linear signal.
fn area(force: &[f64], first: f64, last: f64) -> f64 {
    let value = |position: f64| {
        let n = (position as usize).min(force.len() - 1);
        let next = (n + 1).min(force.len() - 1);
        force[n] + (position - n as f64) * (force[next] - force[n])
    };
    let (low, high) = (first.ceil() as usize, last.floor() as usize);
    if low > high {
        return 0.5 * (value(first) + value(last)) * (last - first);
    }
    let inside: f64 = force[low..=high].windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum();
    let head = 0.5 * (value(first) + force[low]) * (low as f64 - first);
    let tail = 0.5 * (force[high] + value(last)) * (last - high as f64);
    head + inside + tail
}
