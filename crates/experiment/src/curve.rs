//! Curves of some hits, to be drawn.

use asperity_signal::{Frf, FrfForm, HitRecord, decay_length};

/// Decimated curves of one hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitCurve {
    /// Number of the hit, from 1.
    pub index: usize,
    /// Largest force \[N\].
    pub force_peak_n: f64,
    /// Time from the trigger \[s\] and force \[N\] during the pulse.
    pub force: (Vec<f64>, Vec<f64>),
    /// Time from the trigger \[s\] and response \[m, m/s or m/s^2\] until it has decayed: the extremes
    /// of each interval.
    pub response: (Vec<f64>, Vec<f64>),
    /// Frequency \[Hz\] and magnitude of the receptance \[m/N\], without zero frequency.
    pub receptance: (Vec<f64>, Vec<f64>),
}

/// Curves of a limited number of hits, spread over the test.
#[derive(Debug, Default)]
pub(crate) struct Curves {
    pub(crate) kept: Vec<HitCurve>,
    stride: usize,
    seen: usize,
}

/// Most curves.
const MAX_CURVES: usize = 48;
/// Most points of a drawn response, two for each interval.
const POINTS: usize = 2400;
/// Time drawn before and after the trigger \[s\].
const PULSE_S: (f64, f64) = (2e-3, 6e-3);
/// Time of the response drawn after the trigger over that before it.
const BEFORE: usize = 20;
/// Most points of a drawn receptance.
const LINES: usize = 4000;

impl Curves {
    /// Counts a hit, and returns true if its curves are to be kept.
    pub(crate) fn keeps_next(&mut self) -> bool {
        if self.kept.len() == MAX_CURVES {
            let mut odd = false;
            self.kept.retain(|_| {
                odd = !odd;
                odd
            });
            self.stride *= 2;
        }
        self.stride = self.stride.max(1);
        self.seen += 1;
        (self.seen - 1).is_multiple_of(self.stride)
    }
}

impl HitCurve {
    /// Signals of a hit; the receptance is added by [`HitCurve::set_receptance`].
    pub(crate) fn of_signals(hit: &HitRecord) -> Self {
        let rate = hit.sample_rate_hz;
        let time = |sample: usize| (sample as f64 - hit.trigger as f64) / rate;
        let first = hit.trigger.saturating_sub((PULSE_S.0 * rate).ceil() as usize);
        let last = (hit.trigger + (PULSE_S.1 * rate).ceil() as usize).min(hit.force.len());
        let response = hit.responses.first().map_or(&[][..], |samples| samples);
        let start = hit.trigger.min(response.len());
        let length = decay_length(&response[start..]);
        let before = start - start.min(length / BEFORE);
        let response = &response[before..start + length];
        let part = response.len().div_ceil(POINTS / 2).max(1);
        let mut drawn = (Vec::new(), Vec::new());
        for (number, samples) in response.chunks(part).enumerate() {
            let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
            let most = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let first = before + number * part;
            drawn.0.extend([time(first), time(first + samples.len() / 2)]);
            drawn.1.extend([least, most]);
        }
        Self {
            index: 0,
            force_peak_n: f64::NAN,
            force: ((first..last).map(time).collect(), hit.force[first..last].to_vec()),
            response: drawn,
            receptance: (Vec::new(), Vec::new()),
        }
    }

    /// Sets the receptance up to `high_hz`: the largest magnitude of each interval.
    pub(crate) fn set_receptance(&mut self, frf: &Frf, high_hz: f64) {
        let frf = frf.to(FrfForm::Receptance);
        let last = frf.frequency_hz.partition_point(|f| *f <= high_hz).max(1);
        let magnitude = frf.magnitude();
        let (frequency, magnitude) =
            (&frf.frequency_hz[1.min(last)..last], &magnitude[1.min(last)..last]);
        let part = frequency.len().div_ceil(LINES).max(1);
        for (f, m) in frequency.chunks(part).zip(magnitude.chunks(part)) {
            let largest = (0..m.len()).max_by(|&a, &b| m[a].total_cmp(&m[b])).unwrap_or(0);
            self.receptance.0.push(f[largest]);
            self.receptance.1.push(m[largest]);
        }
    }
}
