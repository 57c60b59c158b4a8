//! Simulated noisy hits: the scatter of every feature over its stated standard deviation.

use crate::noise::Noise;
use crate::oscillator::{hammer_pulse, integrated};
use asperity_signal::{
    Complex64, FrfAverage, FundamentalSearch, HammerOptions, HitFeatures, HitLength, HitOptions,
    HitRecord, HitWindows, PeakUncertainty, ResponseKind, TriggerLevel, analyse_hit,
};
use std::f64::consts::TAU;

/// Sample rate, in hertz.
const RATE: f64 = 25_600.0;
/// Mass in kg and natural frequency in hertz.
const MASS: f64 = 1.6;
const NATURAL_HZ: f64 = 830.0;
/// Force peak in newtons and rise in seconds.
const PULSE: (f64, f64) = (20.0, 0.34e-3);
/// Samples before the pulse.
const BEFORE: usize = 128;

/// A structure and its measurement.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Case {
    /// Damping ratio.
    pub(crate) damping: f64,
    /// Quadratic part of the restoring force: its ratio to the linear one at 1 um.
    pub(crate) quadratic: f64,
    /// Length of the hit in s.
    pub(crate) length_s: f64,
    /// Largest value over the standard deviation of the noise, of both signals, in dB.
    pub(crate) signal_to_noise_db: f64,
}

/// The quantities in the order of [`scatter`].
pub(crate) const QUANTITIES: [&str; 10] = [
    "f1",
    "A1",
    "f2",
    "A2",
    "A2/A1",
    "damping, half power",
    "damping, circle",
    "damping, decrement",
    "natural frequency",
    "modal constant",
];

/// Estimates of one quantity over many hits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Scatter {
    /// Hits with an estimate and a standard deviation.
    pub(crate) hits: usize,
    /// Standard deviation of the estimates over the root mean square of those stated.
    pub(crate) over_stated: f64,
    /// Mean of the estimates less the value without noise, over the root mean square stated.
    pub(crate) bias: f64,
    /// Largest stated deviation over the smallest.
    pub(crate) range: f64,
    /// Root mean square of the stated deviations over the value.
    pub(crate) relative: f64,
}

/// Features and their stated standard deviations.
fn read(features: &HitFeatures) -> [Option<(f64, f64)>; 10] {
    // A peak that may be noise has no standard deviation.
    let first = features.fundamental_uncertainty.filter(PeakUncertainty::is_first_order);
    let (mode, sigma) = match first {
        Some(_) => (&features.mode, &features.mode_uncertainty),
        None => return [None; 10],
    };
    let second = features.harmonics.second.zip(features.second_uncertainty);
    [
        mode.frequency_hz.zip(first.map(|sigma| sigma.frequency_hz)),
        mode.magnitude.zip(sigma.magnitude),
        second.map(|(peak, sigma)| (peak.frequency_hz, sigma.frequency_hz)),
        second.map(|(peak, sigma)| (peak.magnitude, sigma.magnitude)),
        features.harmonics.ratio().zip(features.ratio_uncertainty),
        mode.damping.half_power.zip(sigma.half_power),
        mode.damping.circle.zip(sigma.circle),
        mode.damping.decrement.zip(sigma.decrement),
        mode.natural_hz.zip(sigma.natural_hz),
        mode.modal_constant.map(Complex64::norm).zip(sigma.modal_constant),
    ]
}

fn options(samples: usize) -> HammerOptions {
    let hits = HitOptions {
        trigger_level: TriggerLevel::Fraction(0.1),
        pre_trigger: BEFORE,
        length: HitLength::Samples(samples),
        hold_off: samples,
    };
    let mut options = HammerOptions::new(
        hits,
        ResponseKind::Acceleration,
        FundamentalSearch::Frequency(NATURAL_HZ),
    );
    options.windows = HitWindows { until_noise: true, ..HitWindows::default() };
    options
}

/// The scatter of each quantity over `runs` hits.
pub(crate) fn scatter(case: &Case, runs: usize, seed: u64) -> [Scatter; 10] {
    let (omega, samples) = (TAU * NATURAL_HZ, (case.length_s * RATE) as usize);
    let stiffness = MASS * omega * omega;
    let restoring = |u: f64, v: f64| {
        stiffness * u * (1.0 + case.quadratic * 1e6 * u) + 2.0 * case.damping * omega * MASS * v
    };
    let start = BEFORE as f64 / RATE;
    let pulse = hammer_pulse(PULSE.0, PULSE.1);
    let force = |t: f64| if t > start { pulse(t - start) } else { 0.0 };
    let (_, response) = integrated(MASS, restoring, force, RATE, samples, 4);
    let force: Vec<f64> = (0..samples).map(|n| force(n as f64 / RATE)).collect();
    let largest = response.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let level = 10.0_f64.powf(-case.signal_to_noise_db / 20.0);
    let options = options(samples);
    let analysed = |force: Vec<f64>, response: Vec<f64>| {
        let hit = HitRecord {
            start: 0,
            trigger: BEFORE,
            force,
            responses: vec![response],
            sample_rate_hz: RATE,
            missing: 0,
        };
        let mut average = FrfAverage::new(samples, RATE, ResponseKind::Acceleration, 1).unwrap();
        analyse_hit(hit, &options, &mut average).features
    };
    let exact = analysed(force.clone(), response.clone()).map(|features| read(&features));
    let exact = exact.unwrap_or_default();
    let mut noise = Noise::new(seed);
    let mut found: [Vec<(f64, f64)>; 10] = Default::default();
    for _ in 0..runs {
        let force = noise.added_to(&force, level * PULSE.0);
        let response = noise.added_to(&response, level * largest);
        let Some(features) = analysed(force, response) else {
            continue;
        };
        for (all, one) in found.iter_mut().zip(read(&features)) {
            all.extend(one);
        }
    }
    std::array::from_fn(|n| statistics(&found[n], exact[n].map_or(f64::NAN, |exact| exact.0)))
}

fn statistics(found: &[(f64, f64)], exact: f64) -> Scatter {
    let count = found.len() as f64;
    let mean = found.iter().map(|(value, _)| value).sum::<f64>() / count;
    let square = found.iter().map(|(value, _)| (value - mean).powi(2)).sum::<f64>();
    let stated = (found.iter().map(|(_, sigma)| sigma * sigma).sum::<f64>() / count).sqrt();
    let range = found.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), (_, sigma)| {
        (low.min(*sigma), high.max(*sigma))
    });
    Scatter {
        hits: found.len(),
        over_stated: (square / (count - 1.0)).sqrt() / stated,
        bias: (mean - exact) / stated,
        range: range.1 / range.0,
        relative: stated / mean,
    }
}
