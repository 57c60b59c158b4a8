//! Backbones of decays with known frequency and damping at each amplitude.

use crate::noise::Noise;
use crate::oscillator::{Mode, integrated};
use asperity_signal::{
    Backbone, BackboneOptions, BackbonePoint, BandPass, SignalError, analytic_signal, backbone,
};
use std::f64::consts::{PI, TAU};

const RATE: f64 = 20_000.0;

fn decay(mode: &Mode, count: usize) -> Vec<f64> {
    let scale = mode.mass * mode.damped_omega();
    (0..count).map(|n| scale * mode.impulse_response((n as f64 + 7.0) / RATE)).collect()
}

fn found(samples: &[f64], centre: f64, part: f64) -> Backbone {
    let options = BackboneOptions::new(BandPass::around(centre, part).unwrap());
    backbone(samples, RATE, &options).unwrap()
}

/// Verified against a linear oscillator: one frequency within 1e-4, one damping ratio within
/// 1 %, and the amplitude of the decay within 1 %, at every amplitude; from one and from two
/// modes, of which the band holds one. Edges contribute 3e-4 of the envelope, which over
/// four cycles is 1 % of a damping ratio of 0.2 %.
#[test]
fn a_linear_decay_has_one_frequency_and_damping() {
    for damping in [0.002, 0.01, 0.035] {
        let mode = Mode { natural_hz: 830.0, damping, mass: 1.0 };
        let other = Mode { natural_hz: 2600.0, damping: 0.004, mass: 1.0 };
        let alone = decay(&mode, 10_000);
        let beside: Vec<f64> =
            alone.iter().zip(decay(&other, 10_000)).map(|(a, b)| a + 0.3 * b).collect();
        for samples in [alone, beside] {
            let found = found(&samples, 850.0, 0.5);
            assert!(found.points.len() > 10, "{damping}: {} points", found.points.len());
            // The other mode passes with exp(-19) and dominates once a heavily damped one has
            // fallen to that.
            for point in found.points.iter().filter(|point| point.amplitude > 1e-4) {
                let damped = mode.damped_omega() / TAU;
                assert!((point.frequency_hz / damped - 1.0).abs() < 1e-4, "{damping} {point:?}");
                assert!((point.damping_ratio / damping - 1.0).abs() < 0.01, "{damping} {point:?}");
                let time = point.time_s + 7.0 / RATE;
                let expected = (-damping * mode.omega() * time).exp();
                assert!((point.amplitude / expected - 1.0).abs() < 0.01, "{damping} {point:?}");
            }
        }
    }
}

/// Verified against a linear oscillator of 5 % of critical damping: the part of a decay that the edges
/// of the filter mask, and the rest (frequency within 1e-4, damping within 1 %). The ringing of
/// a band of 0.3 falls by `2 pi^2 0.3 / 6 = 0.99` a cycle and the decay by 0.31, so that the first
/// point is some 15 cycles late and at 1 % of the first amplitude; a band of 0.5 shows the decay
/// from more than 5 % on.
#[test]
fn a_wider_band_shows_more_of_a_heavily_damped_decay() {
    let mode = Mode { natural_hz: 830.0, damping: 0.05, mass: 1.0 };
    let samples = decay(&mode, 10_000);
    let shown = [0.3, 0.5].map(|part| {
        let found = found(&samples, 830.0, part);
        for point in found.points.iter().filter(|point| point.amplitude > 1e-4) {
            let damped = mode.damped_omega() / TAU;
            assert!((point.frequency_hz / damped - 1.0).abs() < 1e-4, "{part} {point:?}");
            assert!((point.damping_ratio / mode.damping - 1.0).abs() < 0.01, "{part} {point:?}");
        }
        found.points[0].amplitude
    });
    assert!(shown[0] < 0.02 && shown[1] > 0.05, "{shown:?}");
}

/// Verified against the first-order backbone `w = w0 + 3/8 alpha a^2 / w0` of a Duffing
/// oscillator integrated with 5 Runge-Kutta steps a sample, hardening and softening, up to a
/// shift of 1 %: the shift is right within 5 % of its largest value, the damping ratio within 3 %.
/// The next order of the backbone is -(15/256) (alpha a^2 / w0^2)^2, 0.4 % of the shift.
#[test]
fn a_duffing_decay_follows_its_backbone() {
    let (natural, damping) = (200.0, 0.004);
    let omega = TAU * natural;
    let amplitude = 1e-3;
    for sign in [1.0, -1.0] {
        // 3/8 alpha a^2 / w0^2 = 0.01 at the first amplitude.
        let cubic = sign * 0.01 * 8.0 / 3.0 * (omega / amplitude).powi(2);
        let restoring =
            move |u: f64, v: f64| omega * omega * u + cubic * u.powi(3) + 2.0 * damping * omega * v;
        let kick = move |t: f64| if t < 1e-4 { amplitude * omega / 1e-4 } else { 0.0 };
        let (u, _) = integrated(1.0, restoring, kick, RATE, 20_000, 5);
        let found = found(&u[3..], natural, 0.5);
        assert!(found.points.len() > 30);
        let largest = found.points[0].amplitude / amplitude;
        assert!(largest > 0.75, "{largest}");
        for point in &found.points {
            let shift = 0.375 * cubic * (point.amplitude / omega).powi(2);
            let error = point.frequency_hz / natural - 1.0 - shift;
            assert!(error.abs() < 5e-4, "{error:e} {point:?}");
            assert!((point.damping_ratio / damping - 1.0).abs() < 0.03, "{point:?}");
        }
    }
}

/// Verified against the displacement of the same decay: frequency and damping from accelerations and
/// velocities, at equal amplitudes, of a softening oscillator whose frequency rises by more than 1 %
/// along the decay. Without integration the damping ratio is several per cent too low where it rises fastest.
#[test]
fn samples_of_every_kind_have_the_backbone_of_the_displacement() {
    let (natural, damping, amplitude) = (200.0, 0.004, 1e-3);
    let omega = TAU * natural;
    let cubic = -0.04 * 8.0 / 3.0 * (omega / amplitude).powi(2);
    let restoring =
        move |u: f64, v: f64| omega * omega * u + cubic * u.powi(3) + 2.0 * damping * omega * v;
    let kick = move |t: f64| if t < 1e-4 { amplitude * omega / 1e-4 } else { 0.0 };
    let (u, a) = integrated(1.0, restoring, kick, RATE, 16_000, 5);
    // Central differences of sixth order.
    let weights = [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0].map(|weight| weight / 60.0 * RATE);
    let slope = |around: &[f64]| around.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>();
    let v: Vec<f64> = u[..15_990].windows(7).map(slope).collect();
    let curve = |samples: &[f64], derivatives: i32| {
        let band = BandPass::around(natural, 0.3).unwrap();
        let edge_level = 1e-6;
        let options = BackboneOptions { derivatives, edge_level, ..BackboneOptions::new(band) };
        backbone(samples, RATE, &options).unwrap().points
    };
    let expected = curve(&u[20..], 0);
    assert!(expected[0].frequency_hz < 0.988 * natural, "{:?}", expected[0]);
    // Linear between the points about an amplitude, in its logarithm.
    let at = |amplitude: f64, value: fn(&BackbonePoint) -> f64| {
        let pair = expected.windows(2).find(|pair| pair[1].amplitude <= amplitude)?;
        let share =
            (amplitude / pair[0].amplitude).ln() / (pair[1].amplitude / pair[0].amplitude).ln();
        (share >= 0.0).then(|| value(&pair[0]) + share * (value(&pair[1]) - value(&pair[0])))
    };
    let worst = |samples: &[f64], derivatives: i32, integrated: bool| {
        let mut worst = [0.0_f64; 2];
        let points = curve(samples, if integrated { derivatives } else { 0 });
        let mut compared = 0;
        for point in points.iter().filter(|point| point.amplitude > 1e-5 * points[0].amplitude) {
            let amplitude = point.amplitude / (TAU * point.frequency_hz).powi(derivatives);
            let of: [fn(&BackbonePoint) -> f64; 2] = [|p| p.frequency_hz, |p| p.damping_ratio];
            for (worst, value) in worst.iter_mut().zip(of) {
                let Some(expected) = at(amplitude, value) else { continue };
                *worst = worst.max((value(point) / expected - 1.0).abs());
                compared += 1;
            }
        }
        assert!(compared > 80, "{compared}");
        worst
    };
    for (name, samples, derivatives) in [("velocity", &v[17..], 1), ("acceleration", &a[20..], 2)] {
        let [frequency, ratio] = worst(samples, derivatives, true);
        assert!(frequency < 1e-5 && ratio < 1e-3, "{name}: {frequency:e}, {ratio:e}");
        let [_, without] = worst(samples, derivatives, false);
        assert!(without > 0.02 * f64::from(derivatives), "{name}: {without:e}");
    }
}

/// Verified against the averaged decay rate of quadratic damping, `u'' + c |u'| u' + w0^2 u`,
/// which is `4/(3 pi) c w0 a`: proportional to the amplitude, within 2 %.
#[test]
fn quadratic_damping_grows_with_amplitude() {
    let omega = TAU * 200.0;
    let c = 3.0;
    let restoring = move |u: f64, v: f64| omega * omega * u + c * v.abs() * v;
    let kick = move |t: f64| if t < 1e-4 { 4e-3 * omega / 1e-4 } else { 0.0 };
    let (u, _) = integrated(1.0, restoring, kick, RATE, 10_000, 5);
    let found = found(&u[3..], 200.0, 0.5);
    let amplitudes: Vec<f64> = found.points.iter().map(|point| point.amplitude).collect();
    assert!(amplitudes[0] > 2.5 * amplitudes[amplitudes.len() - 1], "{amplitudes:?}");
    for point in &found.points {
        let expected = 4.0 / (3.0 * PI) * c * omega * point.amplitude;
        assert!((point.decay_rate / expected - 1.0).abs() < 0.02, "{expected} {point:?}");
        assert!((point.frequency_hz / 200.0 - 1.0).abs() < 1e-4);
    }
}

/// Verified against the noise added: points below five times its filtered envelope are left out
/// and counted, and the rest are right; the floor is that of `sqrt(2 S B)`, checked on noise alone.
#[test]
fn points_below_the_noise_are_left_out() {
    let mode = Mode { natural_hz: 830.0, damping: 0.01, mass: 1.0 };
    let deviation = 0.02;
    let mut noise = Noise::new(5);
    let samples = noise.added_to(&decay(&mode, 10_000), deviation);
    let band = BandPass::around(830.0, 0.3).unwrap();
    let noise_density = 2.0 * deviation * deviation / RATE;
    let options = BackboneOptions { noise_density, ..BackboneOptions::new(band) };
    let found = backbone(&samples, RATE, &options).unwrap();
    assert!(found.masked_noise > 20 && found.points.len() >= 4, "{found:?}");
    assert!(found.points.iter().all(|point| point.amplitude >= found.floor));
    // Phase noise of 0.14 s/a over a line of 4.8 ms that holds 2.4 independent values is a
    // frequency error of 1.3 % s/a of five: four of these.
    for point in &found.points {
        let tolerance = 4.0 * 0.013 * found.floor / point.amplitude;
        assert!((point.frequency_hz / 830.0 - 1.0).abs() < tolerance, "{point:?}");
    }

    let alone = noise.added_to(&vec![0.0; 40_000], deviation);
    let envelope = analytic_signal(&alone, RATE, Some(&band)).unwrap();
    let square = envelope.iter().map(asperity_signal::Complex64::norm_sqr).sum::<f64>() / 40_000.0;
    // 40 000 samples hold 1000 independent values of a band of 498 Hz.
    assert!(
        (square.sqrt() * 5.0 / found.floor - 1.0).abs() < 0.08,
        "{} {}",
        square.sqrt(),
        found.floor
    );
}

/// Verified against the documented bound: the response to a step is below `ringing`, and the
/// band is passed without phase shift and without loss.
#[test]
fn the_band_pass_rings_and_passes_as_documented() {
    let band = BandPass::new(500.0, 1500.0, 60.0).unwrap();
    let mut step = vec![0.0; 4000];
    step[2000..].fill(1.0);
    let felt = analytic_signal(&step, RATE, Some(&band)).unwrap();
    for n in (0..1900).step_by(10) {
        let bound = band.ringing((2000 - n) as f64 / RATE);
        let reach = felt[n].norm();
        assert!(reach < bound + 1e-12, "{n}: {reach:e} {bound:e}");
    }
    let settling = band.settling_s(1e-3);
    assert!((band.ringing(settling) - 1e-3).abs() < 1e-15);

    let tone =
        |f: f64| -> Vec<f64> { (0..8000).map(|n| (TAU * f * f64::from(n) / RATE).cos()).collect() };
    for (frequency, gain) in [(1000.0, 1.0), (500.0, 0.5), (2400.0, 0.0)] {
        let filtered = band.apply(&tone(frequency), RATE).unwrap();
        let original = tone(frequency);
        for n in 2000..6000 {
            assert!((filtered[n] - gain * original[n]).abs() < 5e-4, "{frequency} {n}");
        }
        assert!((band.gain(frequency) - gain).abs() < 5e-4);
    }
}

/// Verified against closed forms: the analytic signal of a windowed tone, and errors.
#[test]
fn the_analytic_signal_of_a_tone() {
    let count = 4000;
    let bell = |n: usize| (-((n as f64 - 2000.0) / 300.0).powi(2)).exp();
    let tone: Vec<f64> = (0..count).map(|n| bell(n) * (0.3 * n as f64).cos()).collect();
    let found = analytic_signal(&tone, RATE, None).unwrap();
    for (n, z) in found.iter().enumerate() {
        let expected = asperity_signal::Complex64::from_polar(bell(n), 0.3 * n as f64);
        // The bell's transform at zero frequency is exp(-(0.3 * 300)^2 / 4): nothing.
        assert!((z - expected).norm() < 1e-12, "{n}");
    }
    let band = BandPass::around(9000.0, 0.5).unwrap();
    assert!(matches!(analytic_signal(&tone, RATE, Some(&band)), Err(SignalError::Option { .. })));
    assert!(BandPass::around(100.0, 1.0).is_err());
    assert!(BandPass::around(-100.0, 0.5).is_err());
    assert!(BandPass::new(5.0, 4.0, 1.0).is_err());
    assert!(BandPass::new(5.0, 6.0, 0.0).is_err());
    let band = BandPass::around(830.0, 0.3).unwrap();
    let wrong = BackboneOptions { cycles: 0.5, ..BackboneOptions::new(band) };
    assert!(matches!(backbone(&tone, RATE, &wrong), Err(SignalError::Option { .. })));
    let short = backbone(&tone[..50], RATE, &BackboneOptions::new(band)).unwrap();
    assert_eq!(short.points, []);
}
