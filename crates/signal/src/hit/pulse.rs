//! The blow itself: its height, impulse and widths.

/// What a force pulse is.
///
/// Read around the largest sample. The threshold crossings are those nearest
/// to the peak on either side, by linear interpolation.
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
    /// From the last to the next crossing of 1 % of the largest sample.
    pub impulse_n_s: f64,
    /// Time from the first to the last crossing of 1 %: the range of the impulse, in seconds.
    pub base_s: (f64, f64),
    /// Full width at half of the largest sample, in seconds.
    pub width_s: f64,
    /// Duration above a tenth of the largest sample, in seconds.
    pub duration_s: f64,
}

/// The fraction of the peak at which the impulse begins and ends.
const BASE: f64 = 0.01;

impl Pulse {
    /// The pulse around the largest sample of a force without offset.
    ///
    /// - `force`: in newtons.
    /// - `sample_rate_hz`: positive, in hertz.
    ///
    /// `None` if no sample is positive, one is not finite, or the rate is not
    /// positive. A record that begins or ends inside the pulse gives what is
    /// in it. Limiting case: a half-sine of duration `T` has impulse
    /// `2 F T / pi`, width `2 T / 3` and duration `0.936 T`.
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

/// Shift (samples) and height of the parabola through three samples.
fn vertex(force: &[f64], index: usize) -> (f64, f64) {
    let here = force[index];
    let neighbours = index.checked_sub(1).map(|before| (force[before], force.get(index + 1)));
    let Some((before, Some(&after))) = neighbours else {
        return (0.0, here);
    };
    let (slope, curvature) = (0.5 * (after - before), (after - here) - (here - before));
    if curvature >= 0.0 {
        return (0.0, here);
    }
    let shift = (-slope / curvature).clamp(-0.5, 0.5);
    (shift, here + 0.5 * slope * shift)
}

/// Where the force falls to `level` on either side of a peak, in samples.
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
