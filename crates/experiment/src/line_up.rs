//! Channels with starts and rates of their own at common times, block by block.
//!
//! A channel of the lowest rate whose start is whole samples from the latest one is copied. Others are resampled:
//! with the ratio `k` of a channel's rate to the lowest,
//!
//! ```text
//! y(t_n) = sum_j x_j h(p_n - j),    p_n = (t_n - start) rate,
//! h(u) = c/k sinc(c u / k) kaiser(u / (32 k)),    c = 1 for k = 1, else 0.9
//! ```
//!
//! with the Kaiser window of beta 10 (J. F. Kaiser, in *System Analysis by Digital Computer*, Wiley 1966): signals
//! that end below 0.9 of half the lowest rate (0.8 where a rate is lowered) are exact to 1e-5 of their
//! amplitude, and of those above half of it less than 1e-4 is left.

use std::f64::consts::PI;

/// Samples of the lowest rate on either side of a resampled one.
const HALF: usize = 32;
/// Parameter of the Kaiser window.
const BETA: f64 = 10.0;
/// End of the pass band of a lowered rate, over half the rate.
const CUT_OFF: f64 = 0.9;
/// Largest ratio of two rates.
const MOST_RATIO: f64 = 64.0;
/// Relative difference of rates that are the same, as printed rates are rounded.
const SAME_RATE: f64 = 1e-9;
/// Distance of starts from whole samples that is none.
const EXACT_FRACTION: f64 = 0.01;

/// Channels of a record, of which the first samples of those that start early are left out.
pub(crate) struct LineUp {
    channels: Vec<Waiting>,
    /// Rate of the common times \[Hz\]: the lowest of the channels.
    pub(crate) rate_hz: f64,
    /// First common time \[s\].
    pub(crate) start_s: f64,
    /// True before the first samples.
    pub(crate) is_new: bool,
}

/// Samples of a channel that wait for the others.
#[derive(Default)]
struct Waiting {
    samples: Vec<f64>,
    /// Samples still to be left out.
    early: u64,
    kernel: Option<Kernel>,
}

/// Weights of a resampled channel.
struct Kernel {
    /// Samples of the channel from one common time to the next.
    ratio: usize,
    /// Weight of each sample around a common time.
    weights: Vec<f64>,
}

impl LineUp {
    /// Channels with their rates \[Hz\] and starts \[s\]; `None` for rates that are not whole multiples of the
    /// lowest, and for starts that are not finite.
    pub(crate) fn new(rates: &[f64], starts: &[f64]) -> Option<Self> {
        if !starts.iter().all(|start| start.is_finite()) {
            return None;
        }
        let latest = starts.iter().copied().reduce(f64::max)?;
        let rate_hz = rates.iter().copied().reduce(f64::min).filter(|rate| *rate > 0.0)?;
        let ratio = |rate: f64| {
            let ratio = rate / rate_hz;
            let whole = ratio.round();
            let fits = (ratio / whole - 1.0).abs() <= SAME_RATE && whole <= MOST_RATIO;
            fits.then_some(whole as usize)
        };
        let ratios = rates.iter().map(|rate| ratio(*rate)).collect::<Option<Vec<usize>>>()?;
        let apart = |at: usize| (latest - starts[at]) * rates[at];
        let is_copied =
            |at: usize| ratios[at] == 1 && (apart(at) - apart(at).round()).abs() <= EXACT_FRACTION;
        let all = 0..rates.len();
        let lead = if all.clone().all(is_copied) { 0 } else { HALF };
        let waiting = |at: usize| {
            let first = apart(at) + (lead * ratios[at]) as f64;
            if is_copied(at) {
                return Waiting { early: first.round() as u64, ..Waiting::default() };
            }
            let kernel = Kernel::new(ratios[at], first.fract());
            // The weights begin HALF common times before the first one.
            let early = first.floor() as u64 + 1 - (HALF * ratios[at]) as u64;
            Waiting { early, kernel: Some(kernel), ..Waiting::default() }
        };
        let channels = all.map(waiting).collect();
        let start_s = latest + lead as f64 / rate_hz;
        Some(Self { channels, rate_hz, start_s, is_new: true })
    }

    /// True if a channel starts a sample or more after another.
    pub(crate) fn is_apart(&self) -> bool {
        self.channels.iter().any(|channel| channel.kernel.is_none() && channel.early > 0)
    }

    /// True if a channel is resampled.
    pub(crate) fn is_resampled(&self) -> bool {
        self.channels.iter().any(|channel| channel.kernel.is_some())
    }

    /// Frequency \[Hz\] up to which resampled channels are exact.
    pub(crate) fn exact_to_hz(&self) -> f64 {
        let lowered =
            |channel: &Waiting| channel.kernel.as_ref().is_some_and(|kernel| kernel.ratio > 1);
        let share = if self.channels.iter().any(lowered) { 0.8 } else { 0.9 };
        0.5 * share * self.rate_hz
    }

    /// Adds a block of each channel, and returns the samples that all channels have.
    pub(crate) fn push(&mut self, blocks: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (channel, block) in self.channels.iter_mut().zip(blocks) {
            let early = channel.early.min(block.len() as u64);
            channel.early -= early;
            if channel.samples.is_empty() && early == 0 {
                channel.samples = block;
            } else {
                channel.samples.extend_from_slice(&block[early as usize..]);
            }
        }
        let common = self.channels.iter().map(Waiting::available).min().unwrap_or(0);
        self.channels.iter_mut().map(|channel| channel.take(common)).collect()
    }
}

impl Waiting {
    /// Number of common times that the samples reach.
    fn available(&self) -> usize {
        match &self.kernel {
            None => self.samples.len(),
            Some(kernel) => match self.samples.len().checked_sub(kernel.weights.len()) {
                Some(beyond) => beyond / kernel.ratio + 1,
                None => 0,
            },
        }
    }

    /// The values at the next `count` common times.
    fn take(&mut self, count: usize) -> Vec<f64> {
        let Some(kernel) = &self.kernel else {
            let rest = self.samples.split_off(count);
            return std::mem::replace(&mut self.samples, rest);
        };
        let value = |n: usize| {
            let samples = &self.samples[n * kernel.ratio..];
            kernel.weights.iter().zip(samples).map(|(weight, sample)| weight * sample).sum()
        };
        let values = (0..count).map(value).collect();
        self.samples.drain(..count * kernel.ratio);
        values
    }
}

impl Kernel {
    /// The weights of samples at `1 - HALF ratio` to `HALF ratio` from the sample before a common time, which
    /// is `fraction` of a sample after it.
    fn new(ratio: usize, fraction: f64) -> Self {
        let half = HALF * ratio;
        let cut_off = if ratio == 1 { 1.0 } else { CUT_OFF / ratio as f64 };
        let weight = |n: usize| {
            let u = fraction + (half as f64 - 1.0) - n as f64;
            let inside = (1.0 - (u / half as f64).powi(2)).max(0.0);
            cut_off * sinc(cut_off * u) * bessel_i0(BETA * inside.sqrt()) / bessel_i0(BETA)
        };
        let mut weights: Vec<f64> = (0..2 * half).map(weight).collect();
        // Constants are exact.
        let sum: f64 = weights.iter().sum();
        for weight in &mut weights {
            *weight /= sum;
        }
        Self { ratio, weights }
    }
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Modified Bessel function of the first kind of order 0, by its series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines channels up that arrive in blocks of so many common times.
    fn lined_up(line_up: &mut LineUp, channels: &[(&[f64], usize)], block: usize) -> Vec<Vec<f64>> {
        let mut found = vec![Vec::new(); channels.len()];
        let most = channels.iter().map(|(samples, k)| samples.len().div_ceil(k * block)).max();
        for n in 0..most.unwrap_or(0) {
            let next = |(samples, k): &(&[f64], usize)| {
                let at = |n: usize| (n * k * block).min(samples.len());
                samples[at(n)..at(n + 1)].to_vec()
            };
            for (found, common) in
                found.iter_mut().zip(line_up.push(channels.iter().map(next).collect()))
            {
                found.extend(common);
            }
        }
        found
    }

    #[test]
    fn channels_meet_at_the_latest_start() {
        let early: Vec<f64> = (0..20).map(f64::from).collect();
        let late: Vec<f64> = (7..25).map(f64::from).collect();
        for block in [1, 3, 8, 100] {
            let mut line_up = LineUp::new(&[10.0, 10.0], &[0.0, 0.7]).unwrap();
            assert!(line_up.is_apart() && !line_up.is_resampled());
            let found = lined_up(&mut line_up, &[(&early, 1), (&late, 1)], block);
            let expected: Vec<f64> = (7..20).map(f64::from).collect();
            assert_eq!(found, [expected.clone(), expected], "{block}");
        }
    }

    /// Tones are exact at the common times, whatever the fraction of a sample and the ratio of the rates.
    #[test]
    fn tones_are_resampled_exactly() {
        for (ratio, start, tone_hz) in
            [(1, 0.0003, 420.0), (1, -0.00041, 35.0), (2, 0.0, 390.0), (5, 0.00017, 300.0)]
        {
            let rate = 1000.0;
            let tone = |t: f64| (2.0 * PI * tone_hz * t + 0.4).sin();
            let at = |rate: f64, start: f64, count: i32| -> Vec<f64> {
                (0..count).map(|n| tone(start + f64::from(n) / rate)).collect()
            };
            let own = rate * f64::from(ratio);
            let (low, high) = (at(rate, 0.0, 300), at(own, start, 300 * ratio));
            let mut line_up = LineUp::new(&[rate, own], &[0.0, start]).unwrap();
            assert!(line_up.is_resampled() && tone_hz < line_up.exact_to_hz());
            let channels = [(&low[..], 1), (&high[..], ratio as usize)];
            let start_s = line_up.start_s;
            let found = lined_up(&mut line_up, &channels, 37);
            assert!(found[0].len() > 200 && found[0].len() == found[1].len());
            for values in &found {
                for (n, value) in values.iter().enumerate() {
                    let expected = tone(start_s + n as f64 / rate);
                    assert!((value - expected).abs() < 2e-5, "{ratio} {n}: {value} {expected}");
                }
            }
        }
    }

    #[test]
    fn rates_without_a_whole_ratio_do_not_meet() {
        assert!(LineUp::new(&[1000.0, 1500.0], &[0.0, 0.0]).is_none());
        assert!(LineUp::new(&[1000.0, 1000.001], &[0.0, 0.0]).is_none());
        assert!(LineUp::new(&[1000.0, 1000.0], &[0.0, f64::NAN]).is_none());
    }
}
