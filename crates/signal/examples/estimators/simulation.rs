//! Simulated hits of a structure with two known modes.

use crate::noise::Noise;
use asperity_signal::{
    Complex64, ExponentialWindow, FrfAverage, FrfEstimator, FundamentalSearch, HammerOptions,
    HitFeatures, HitLength, HitOptions, HitWindows, HvScaling, Peak, PeakUncertainty, ResponseKind,
    SpectralDensity, TriggerLevel, hammer_test,
};
use std::f64::consts::TAU;

/// Sample rate, in hertz.
const RATE: f64 = 25_600.0;
/// Samples of a record, and of one cut short.
const WHOLE: usize = 6400;
const SHORT: usize = 1600;
/// Samples before the pulse.
const BEFORE: usize = 32;
/// The pulse: its peak in newtons and its rise in seconds.
const PULSE: (f64, f64) = (20.0, 0.34e-3);
/// Natural frequency in hertz, damping ratio and mass in kg of each mode.
const MODES: [(f64, f64, f64); 2] = [(830.0, 0.02, 1.6), (1640.0, 0.02, 16.0)];

/// Noise and windows of simulated hits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NoiseCase {
    pub(crate) name: &'static str,
    /// Noise on the force over the peak of the pulse.
    force_noise: f64,
    /// Noise on the response over its largest value.
    response_noise: f64,
    force_window: bool,
    /// Value of an exponential window at the end of the record.
    exponential: Option<f64>,
    /// Windows that end where the signals are noise.
    until_noise: bool,
    samples: usize,
}

/// The columns of the table.
pub(crate) const CASES: [NoiseCase; 8] = [
    NoiseCase::new("no noise", 0.0, 0.0),
    NoiseCase::new("response 0.1 %", 0.0, 1e-3),
    NoiseCase::new("response 1 %", 0.0, 1e-2),
    NoiseCase::new("force 0.1 %", 1e-3, 0.0),
    NoiseCase { force_window: true, ..NoiseCase::new("the same, force window", 1e-3, 0.0) },
    NoiseCase {
        exponential: Some(1e-2),
        ..NoiseCase::new("response 0.1 %, exponential window", 0.0, 1e-3)
    },
    NoiseCase {
        exponential: Some(1e-2),
        samples: SHORT,
        ..NoiseCase::new("the same, record cut short", 0.0, 1e-3)
    },
    NoiseCase { until_noise: true, ..NoiseCase::new("both 1 %, windows until noise", 1e-2, 1e-2) },
];

impl NoiseCase {
    const fn new(name: &'static str, force_noise: f64, response_noise: f64) -> Self {
        Self {
            name,
            force_noise,
            response_noise,
            force_window: false,
            exponential: None,
            until_noise: false,
            samples: WHOLE,
        }
    }
}

/// Mean error and standard deviation of an estimate over its true value.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Statistic {
    pub(crate) bias: f64,
    pub(crate) spread: f64,
    /// Spread over the root mean square of the stated standard deviation, where one is stated.
    pub(crate) over_stated: Option<f64>,
    /// Hits in which a standard deviation is stated.
    pub(crate) stated: usize,
    /// Hits in which the estimate exists.
    pub(crate) found: usize,
}

/// The rows of the table.
pub(crate) const ROWS: [&str; 9] = [
    "f1",
    "A1",
    "f2",
    "A2",
    "A2/A1",
    "damping, half power",
    "damping, circle",
    "damping, decrement",
    "damping, backbone",
];

/// The statistics of every row over `runs` hits of a case.
pub(crate) fn statistics(case: &NoiseCase, runs: usize, seed: u64) -> [Statistic; 9] {
    let (force, response) = clean(case.samples);
    let largest = response.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let options = options(case, force.len());
    let truth = truth();
    let mut noise = Noise::new(seed);
    let mut estimates: [Vec<f64>; 9] = Default::default();
    let mut stated: [Vec<(f64, f64)>; 9] = Default::default();
    for _ in 0..runs {
        let force = noise.added_to(&force, case.force_noise * PULSE.0);
        let response = noise.added_to(&response, case.response_noise * largest);
        let features = hammer_test(&force, &response, RATE, &options)
            .ok()
            .and_then(|test| test.hits.into_iter().next())
            .and_then(|hit| hit.features);
        let Some(features) = features else {
            continue;
        };
        for (row, (estimate, sigma)) in read(&features).into_iter().enumerate() {
            estimates[row].extend(estimate.map(|x| x / truth[row]));
            stated[row].extend(sigma);
        }
    }
    std::array::from_fn(|row| statistic(&estimates[row], &stated[row]))
}

fn statistic(estimates: &[f64], stated: &[(f64, f64)]) -> Statistic {
    let (mean, spread) = moments(estimates);
    let squares = stated.iter().map(|(_, sigma)| sigma * sigma).sum::<f64>();
    let stated_square = squares / stated.len() as f64;
    let (_, their_spread) = moments(&stated.iter().map(|(x, _)| *x).collect::<Vec<_>>());
    Statistic {
        bias: mean - 1.0,
        spread,
        over_stated: (stated.len() > 9).then(|| their_spread / stated_square.sqrt()),
        stated: stated.len(),
        found: estimates.len(),
    }
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (mean, (square / (count - 1.0)).sqrt())
}

/// An estimate, and a quantity with its stated deviation.
type Reading = (Option<f64>, Option<(f64, f64)>);

/// Estimates in the order of the rows, and the quantities whose deviation is stated with it:
/// for the fundamental those of the windowed peak.
fn read(features: &HitFeatures) -> [Reading; 9] {
    let second = features.harmonics.second;
    // First-order deviations are stated where the first order holds.
    let a = features.fundamental_uncertainty.filter(PeakUncertainty::is_first_order);
    let b = features.second_uncertainty.filter(PeakUncertainty::is_first_order);
    let (damping, sigma) = (features.mode.damping, features.mode_uncertainty);
    let backbone = features.backbone.as_ref().and_then(|backbone| {
        // The points down to a tenth of the first, of equal weight.
        let floor = 0.1 * backbone.points.first()?.amplitude;
        let kept = backbone.points.iter().filter(|point| point.amplitude > floor);
        let ratios: Vec<f64> = kept.map(|point| point.damping_ratio).collect();
        Some(ratios.iter().sum::<f64>() / ratios.len() as f64)
    });
    let ratio = features.harmonics.ratio();
    let first = features.harmonics.fundamental;
    let frequency = |peak: Option<Peak>, sigma: Option<PeakUncertainty>| {
        Some((peak?.frequency_hz, sigma?.frequency_hz))
    };
    let height = |peak: Option<Peak>, sigma: Option<PeakUncertainty>| {
        Some((peak?.magnitude, sigma?.magnitude))
    };
    let of_ratio = features.ratio_uncertainty.filter(|_| a.is_some() && b.is_some());
    [
        (features.mode.frequency_hz, frequency(first, a)),
        (features.mode.magnitude, height(first, a)),
        (second.map(|peak| peak.frequency_hz), frequency(second, b)),
        (second.map(|peak| peak.magnitude), height(second, b)),
        (ratio, ratio.zip(of_ratio)),
        (damping.half_power, damping.half_power.zip(sigma.half_power)),
        (damping.circle, damping.circle.zip(sigma.circle)),
        (damping.decrement, damping.decrement.zip(sigma.decrement)),
        (backbone, None),
    ]
}

/// The true values in the order of the rows.
fn truth() -> [f64; 9] {
    let (f1, a1) = maximum(0.9 * MODES[0].0, 1.1 * MODES[0].0);
    let (f2, a2) = maximum(0.95 * MODES[1].0, 1.05 * MODES[1].0);
    let damping = MODES[0].1;
    [f1, a1, f2, a2, a2 / a1, damping, damping, damping, damping]
}

/// Transform of the sampled impulse response, from its geometric series.
fn receptance(frequency: f64) -> Complex64 {
    let mode = |&(natural, damping, mass): &(f64, f64, f64)| {
        let (w0, root) = (TAU * natural, (1.0_f64 - damping * damping).sqrt());
        let sum = |damped: f64| {
            let pole = Complex64::new(-damping * w0, damped - TAU * frequency);
            (1.0 - (pole / RATE).exp()).inv()
        };
        // sin = (e^+ - e^-) / 2i
        let difference = sum(w0 * root) - sum(-w0 * root);
        difference * Complex64::new(0.0, -0.5) / (mass * w0 * root * RATE)
    };
    MODES.iter().map(mode).sum()
}

/// Frequency and height of the only maximum in an interval, by its thirds.
fn maximum(mut low: f64, mut high: f64) -> (f64, f64) {
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        if receptance(low + third).norm() < receptance(high - third).norm() {
            low += third;
        } else {
            high -= third;
        }
    }
    (low, receptance(low).norm())
}

/// Force and displacement without noise: the sampled pulse and its convolution.
fn clean(count: usize) -> (Vec<f64>, Vec<f64>) {
    let pulse = |t: f64| PULSE.0 * (t / PULSE.1).powi(2) * (2.0 * (1.0 - t / PULSE.1)).exp();
    let time = |n: usize| n as f64 / RATE;
    let mut force = vec![0.0; count];
    for (n, x) in force[BEFORE..].iter_mut().take(200).enumerate() {
        *x = pulse(time(n));
    }
    let impulse_response = |t: f64| -> f64 {
        let mode = |&(natural, damping, mass): &(f64, f64, f64)| {
            let (w0, root) = (TAU * natural, (1.0_f64 - damping * damping).sqrt());
            (-damping * w0 * t).exp() * (w0 * root * t).sin() / (mass * w0 * root)
        };
        MODES.iter().map(mode).sum()
    };
    let kernel: Vec<f64> = (0..count).map(|n| impulse_response(time(n)) / RATE).collect();
    let mut response = vec![0.0; count];
    for (n, f) in force.iter().enumerate().filter(|(_, f)| **f != 0.0) {
        for (x, h) in response[n..].iter_mut().zip(&kernel) {
            *x += f * h;
        }
    }
    (force, response)
}

fn options(case: &NoiseCase, samples: usize) -> HammerOptions {
    let hits = HitOptions {
        trigger_level: TriggerLevel::Fraction(0.05),
        pre_trigger: BEFORE - 4,
        length: HitLength::Samples(samples - 16),
        hold_off: samples,
    };
    let after = samples as f64 / RATE;
    let falling = |fraction| ExponentialWindow::falling_to(fraction, after).ok();
    let windows = HitWindows {
        force_s: case.force_window.then_some((0.3e-3, 0.3e-3)),
        exponential: case.exponential.and_then(falling),
        until_noise: case.until_noise,
    };
    let reference = FundamentalSearch::Frequency(MODES[0].0);
    // The last tenth of a whole record is noise; a short one has not decayed there.
    let noise_band_hz = (case.samples == SHORT).then_some((10_000.0, 12_500.0));
    HammerOptions {
        windows,
        noise_band_hz,
        ..HammerOptions::new(hits, ResponseKind::Displacement, reference)
    }
}

/// Noise of an average, over the root mean square spectrum at the first resonance.
pub(crate) const AVERAGE_NOISE: [(&str, f64, f64); 3] =
    [("force 30 %", 0.3, 0.0), ("response 30 %", 0.0, 0.3), ("both 30 %", 0.3, 0.3)];

/// The estimators of an average.
pub(crate) const AVERAGE_ROWS: [&str; 4] = ["H1", "H2", "Hv, equal ratios", "Hv, true ratio"];

/// Bias and spread of `|H|` at the first resonance from `hits` averaged hits, `runs` times.
pub(crate) fn averages(
    noise_of: (f64, f64),
    hits: usize,
    runs: usize,
    seed: u64,
) -> [Statistic; 4] {
    let (force, response) = clean(WHOLE);
    let mut noise = Noise::new(seed);
    let mut estimates: [Vec<f64>; 4] = Default::default();
    let estimator = || FrfAverage::new(WHOLE, RATE, ResponseKind::Displacement, 1).ok();
    let bin = (MODES[0].0 * WHOLE as f64 / RATE).round() as usize;
    // A hit without noise gives the size of the spectra and the exact value in this bin.
    let reference = estimator().and_then(|mut reference| {
        let own = reference.push(&force, &response).ok()?;
        let force = reference.force_auto(SpectralDensity::Energy).ok()?;
        let response = reference.response_auto(SpectralDensity::Energy).ok()?;
        Some((own.values[bin].norm(), force[bin], response[bin]))
    });
    let Some((exact, force_energy, response_energy)) = reference else {
        return Default::default();
    };
    // White noise of deviation s has the energy density 2 s^2 N / rate^2.
    let deviation = |energy: f64| (0.5 * energy * RATE * RATE / WHOLE as f64).sqrt();
    let force_noise = noise_of.0 * deviation(force_energy);
    let response_noise = noise_of.1 * deviation(response_energy);
    let ratio = deviation(response_energy) / deviation(force_energy);
    // With one noisy signal only the true ratio is zero or infinite.
    let true_ratio = ratio * (noise_of.1 + 1e-6) / (noise_of.0 + 1e-6);
    let kinds = [
        FrfEstimator::H1,
        FrfEstimator::H2,
        FrfEstimator::Hv(HvScaling::EqualRatios),
        FrfEstimator::Hv(HvScaling::NoiseRatio(true_ratio)),
    ];
    for _ in 0..runs {
        let Some(mut average) = estimator() else {
            continue;
        };
        for _ in 0..hits {
            let force = noise.added_to(&force, force_noise);
            let response = noise.added_to(&response, response_noise);
            // Cannot fail: the samples are finite and as many as announced.
            let _ = average.push(&force, &response);
        }
        for (found, kind) in estimates.iter_mut().zip(kinds) {
            found.extend(average.frf(kind).map(|frf| frf.values[bin].norm() / exact).ok());
        }
    }
    std::array::from_fn(|row| statistic(&estimates[row], &[]))
}
