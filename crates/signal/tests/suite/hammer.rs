//! Whole hammer tests, from records to features and averages.

use crate::measured;
use crate::noise::Noise;
use crate::oscillator::{Mode, hammer_pulse, integrated};
use asperity_signal::{
    ExponentialWindow, ForceWindow, FrfEstimator, FrfForm, FundamentalSearch, HammerOptions,
    HammerTest, HarmonicOptions, HitLength, HitOptions, HitWindows, Offset, QualityIssue,
    ResponseKind, TriggerLevel, circle_fit, find_harmonics, find_hits, half_power, hammer_test,
    peak_uncertainty,
};

const RATE: f64 = 25_600.0;
const MODE: Mode = Mode { natural_hz: 831.0, damping: 0.01, mass: 1.6 };

fn options(samples: usize) -> HammerOptions {
    let length = HitLength::Samples(samples);
    let hits = HitOptions {
        trigger_level: TriggerLevel::Automatic,
        pre_trigger: 15,
        length,
        hold_off: 4000,
    };
    HammerOptions::new(hits, ResponseKind::Acceleration, FundamentalSearch::Frequency(840.0))
}

/// four hits on one mode, the third a double hit, with noise and an offset of the force.
fn record() -> (Vec<f64>, Vec<f64>) {
    let spacing = 10_000;
    let pulse = hammer_pulse(20.0, 3.4e-4);
    let pulse = move |t: f64| {
        let begin = |k: f64| 0.01 + k * f64::from(spacing) / RATE;
        let one = |at: f64, size: f64| if t > at { size * pulse(t - at) } else { 0.0 };
        one(begin(0.0), 0.5)
            + one(begin(1.0), 1.0)
            + one(begin(2.0), 1.0)
            + one(begin(2.0) + 4e-3, 0.4)
            + one(begin(3.0), 1.5)
    };
    let stiffness = MODE.mass * MODE.omega().powi(2);
    let viscosity = 2.0 * MODE.damping * MODE.omega() * MODE.mass;
    let restoring = move |u: f64, v: f64| stiffness * u + viscosity * v;
    let count = 4 * spacing as usize;
    let (_, a) = integrated(MODE.mass, restoring, &pulse, RATE, count, 4);
    let force: Vec<f64> = (0..count).map(|n| pulse(n as f64 / RATE) + 0.3).collect();
    let mut noise = Noise::new(1);
    (noise.added_to(&force, 0.005), noise.added_to(&a, 0.01))
}

/// Verified against the mode of the record: three hits are averaged and the double hit is
/// not; every hit has the mode's frequency within four of its stated deviations and 1e-4, its
/// damping within 2 % by all three methods, and the average has its height within 1 %.
#[test]
fn a_test_finds_the_mode() {
    let (force, response) = record();
    let mut options = options(9_500);
    options.windows.force_s = Some((0.5e-3, 0.5e-3));
    options.noise_band_hz = Some((8000.0, 12_000.0));
    let test = hammer_test(&force, &response, RATE, &options).unwrap();
    assert_eq!((test.hits.len(), test.average.averages()), (4, 3));
    let averaged: Vec<bool> =
        test.hits.iter().map(asperity_signal::AnalysedHit::is_averaged).collect();
    assert_eq!(averaged, [true, true, false, true]);
    assert!(matches!(test.hits[2].issues[..], [QualityIssue::DoubleHit(_)]), "{:?}", test.hits[2]);
    let top = MODE.natural_hz * (1.0 - 2.0 * MODE.damping * MODE.damping).sqrt();
    for (hit, peak) in test.hits.iter().zip([10.0, 20.0, 20.0, 30.0]) {
        assert!((hit.pulse.unwrap().refined_peak_n / peak - 1.0).abs() < 5e-3);
        let offset = hit.force_offset.unwrap();
        assert!((offset.value - 0.3).abs() < 1e-3, "{offset:?}");
        let Some(features) = &hit.features else {
            continue;
        };
        let found = features.harmonics.fundamental.unwrap();
        let sigma = features.fundamental_uncertainty.unwrap();
        assert!((found.frequency_hz - top).abs() < 4.0 * sigma.frequency_hz + 1e-4 * top);
        assert!(sigma.relative < 1e-3, "{sigma:?}");
        assert_eq!(features.mode.damping.ratios().count(), 3);
        assert!(
            features.mode.damping.ratios().all(|z| (z / 0.01 - 1.0).abs() < 0.02),
            "{:?}",
            features.mode.damping
        );
        assert!(features.mode.damping.spread().unwrap() < 0.02);
        let backbone = features.backbone.as_ref().unwrap();
        assert!(backbone.points.len() > 5);
        for point in &backbone.points {
            // Four deviations of a line's frequency, 1.3 % where the noise is all there is.
            let tolerance = 4.0 * 0.013 * backbone.floor / point.amplitude + 1e-4;
            assert!((point.frequency_hz / 831.0 - 1.0).abs() < tolerance, "{point:?}");
        }
        assert_eq!(features.mode.magnitude, Some(found.magnitude));
    }
    let average = test.average.frf(FrfEstimator::H1).unwrap().to(FrfForm::Receptance);
    let k = (831.0 * 2.0 * (average.len() - 1) as f64 / RATE).round() as usize;
    let exact = MODE.receptance(average.frequency_hz[k]);
    assert!((average.values[k] / exact - 1.0).norm() < 0.02, "{} {exact}", average.values[k]);
    assert!(test.average.coherence().unwrap().values[k] > 0.999);
}

/// Verified against the same mode, with short records under an exponential window: damping
/// and height are corrected.
#[test]
fn a_windowed_test_is_corrected() {
    let (force, response) = record();
    let mut options = options(2_500);
    let exponential = Some(ExponentialWindow::falling_to(2e-3, 2_500.0 / RATE).unwrap());
    options.windows =
        HitWindows { force_s: Some((0.5e-3, 0.5e-3)), exponential, ..HitWindows::default() };
    let test = hammer_test(&force, &response, RATE, &options).unwrap();
    let height = MODE.receptance(MODE.natural_hz).norm();
    for hit in test.hits.iter().filter(|hit| hit.is_averaged()) {
        let features = hit.features.as_ref().unwrap();
        let circle = features.mode.damping.circle.unwrap();
        assert!((circle / 0.01 - 1.0).abs() < 0.02, "{:?}", features.mode.damping);
        let found = features.mode.magnitude.unwrap();
        assert!((found / height - 1.0).abs() < 0.02, "{found} {height}");
        assert!(features.harmonics.fundamental.unwrap().magnitude < 0.6 * height);
    }
}

fn measured_test(options: &HammerOptions, name: &str) -> Option<HammerTest> {
    let data = measured::hits(name)?;
    let force: Vec<f64> = data.iter().flat_map(|(force, _)| force.clone()).collect();
    let response: Vec<f64> = data.iter().flat_map(|(_, response)| response.clone()).collect();
    Some(hammer_test(&force, &response, measured::RATE, options).unwrap())
}

/// Verified against each other: three measured hits of 69 to 85 N on one structure give one
/// frequency within 0.02 Hz, one height within 10 %, and one damping ratio by each method within
/// 10 %. The resonance at 900 Hz was read off the spectra beforehand.
#[test]
fn measured_hits_agree_with_each_other() {
    let mut options = options(25_500);
    options.fundamental = FundamentalSearch::Band((500.0, 1400.0), FrfForm::Receptance);
    options.harmonics =
        HarmonicOptions { fundamental_window: (0.9, 1.1), ..HarmonicOptions::default() };
    options.windows.force_s = Some((0.5e-3, 0.5e-3));
    // Modes at 808 and 849 Hz are near.
    options.band_part = 0.035;
    let Some(test) = measured_test(&options, "measured_hits_agree_with_each_other") else {
        return;
    };
    assert_eq!((test.hits.len(), test.average.averages()), (3, 3));
    let features: Vec<_> = test.hits.iter().map(|hit| hit.features.as_ref().unwrap()).collect();
    let peaks: Vec<_> = features.iter().map(|f| f.harmonics.fundamental.unwrap()).collect();
    for (features, peak) in features.iter().zip(&peaks) {
        assert!((peak.frequency_hz - 900.0).abs() < 1.0, "{peak:?}");
        assert!((peak.frequency_hz - peaks[0].frequency_hz).abs() < 0.02, "{peaks:?}");
        assert!((peak.magnitude / peaks[0].magnitude - 1.0).abs() < 0.1, "{peaks:?}");
        assert_eq!(features.mode.damping.ratios().count(), 3, "{:?}", features.mode.damping);
        assert!(features.mode.damping.spread().unwrap() < 0.1, "{:?}", features.mode.damping);
        let backbone = features.backbone.as_ref().unwrap();
        assert!(backbone.points.len() > 10, "{backbone:?}");
        for point in &backbone.points {
            assert!((point.frequency_hz / peak.frequency_hz - 1.0).abs() < 2e-3, "{point:?}");
        }
        let sigma = features.fundamental_uncertainty.unwrap();
        assert!(sigma.frequency_hz < 0.1 && sigma.relative < 0.01, "{sigma:?}");
    }
    let coherence = test.average.coherence().unwrap();
    let k = (900.0 * 25_500.0 / measured::RATE).round() as usize;
    assert!(coherence.values[k] > 0.98, "{}", coherence.values[k]);
    let window = ForceWindow { begin_s: 0.0, end_s: 0.0, taper_s: 0.0 };
    assert_eq!(window.weight(1.0), 0.0);
}

/// Verified against the functions that sum over all samples at each frequency: the features of a hit,
/// whose transforms are interpolated, are theirs to 1e-12 of a frequency, where the refinement of a
/// peak ends, and to the 2e-14 of `dt sum |x|` that an interpolation is off: that is 1e-13 of a peak,
/// and 1e-11 of a curvature or a width of a hundredth.
#[test]
fn features_are_those_of_the_direct_sums() {
    let (force, response) = record();
    let options = options(9_500);
    let test = hammer_test(&force, &response, RATE, &options).unwrap();
    let (hits, _) = find_hits(&force, &[&response], RATE, &options.hits).unwrap();
    let mut compared = 0;
    for (found, mut hit) in test.hits.iter().zip(hits) {
        let Some(features) = &found.features else { continue };
        Offset::at_rest(&hit.force).unwrap().remove(&mut hit.force);
        let response = hit.response(0, ResponseKind::Acceleration).unwrap();
        let direct = find_harmonics(&response, features.reference_hz, &options.harmonics);
        let (peak, exact) = (features.harmonics.fundamental.unwrap(), direct.fundamental.unwrap());
        assert!((peak.frequency_hz / exact.frequency_hz - 1.0).abs() < 1e-12);
        assert!((peak.value / exact.value - 1.0).norm() < 1e-11, "{peak:?} {exact:?}");
        // Noise has a peak there, which is no harmonic.
        assert!(features.harmonics.second.is_none() && direct.second.is_some());
        let same = |a: Option<f64>, b: Option<f64>, bound: f64| {
            let (a, b) = (a.unwrap(), b.unwrap());
            assert!((a / b - 1.0).abs() < bound, "{a} {b} {:e}", a / b - 1.0);
        };
        same(features.mode.damping.half_power, half_power(&response, &exact), 1e-9);
        let circle = circle_fit(&response, &exact).map(|circle| circle.ratio);
        same(features.mode.damping.circle, circle, 1e-9);
        let sigma = peak_uncertainty(&response, &exact, features.noise);
        let stated = features.fundamental_uncertainty;
        if stated.is_some() {
            same(stated.map(|s| s.frequency_hz), sigma.map(|s| s.frequency_hz), 1e-9);
            same(stated.map(|s| s.relative), sigma.map(|s| s.relative), 1e-11);
        }
        compared += 1;
    }
    assert_eq!(compared, 3);
}

/// A hit without noise whose response has 9 or 12 bits, and one with noise that zeros follow: no issue, the
/// decrement of the mode within 1 % (2 % at 9 bits, with eleven cycles) and five of its deviations.
#[test]
fn coarse_steps_and_padding_leave_the_decrement() {
    let mode = Mode { damping: 0.035, ..MODE };
    let stiffness = mode.mass * mode.omega().powi(2);
    let viscosity = 2.0 * mode.damping * mode.omega() * mode.mass;
    let restoring = move |u: f64, v: f64| stiffness * u + viscosity * v;
    let pulse = hammer_pulse(20.0, 3.4e-4);
    let pulse = move |t: f64| if t > 0.01 { pulse(t - 0.01) } else { 0.0 };
    let count = 6_000;
    let (_, clean) = integrated(mode.mass, restoring, &pulse, RATE, count, 4);
    let quiet: Vec<f64> = (0..count).map(|n| pulse(n as f64 / RATE)).collect();
    let largest = clean.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let coarse = |bits: i32| -> Vec<f64> {
        let step = largest * 2.0_f64.powi(1 - bits);
        clean.iter().map(|x| (x / step).round() * step).collect()
    };
    let padded = |samples: &[f64], level: f64| {
        let mut noisy = Noise::new(5).added_to(&samples[..4_000], level);
        noisy.resize(count, 0.0);
        noisy
    };
    let force = Noise::new(4).added_to(&quiet, 0.005);
    let cases = [
        ("9 bits", 0.02, force.clone(), coarse(9)),
        ("12 bits", 0.01, force, coarse(12)),
        ("padded", 0.01, padded(&quiet, 0.005), padded(&clean, 0.01)),
    ];
    for (name, bound, force, response) in cases {
        let test = hammer_test(&force, &response, RATE, &options(5_500)).unwrap();
        let hit = &test.hits[0];
        assert!(test.hits.len() == 1 && hit.issues.is_empty(), "{name}: {:?}", hit.issues);
        let features = hit.features.as_ref().unwrap();
        let ratio = features.mode.damping.decrement.unwrap();
        let sigma = features.mode_uncertainty.decrement.unwrap();
        let off = (ratio - mode.damping).abs();
        assert!(off < bound * mode.damping && off < 5.0 * sigma, "{name}: {ratio} ± {sigma}");
        assert!(sigma < 3.0 * bound * mode.damping, "{name}: {sigma}");
    }
}
