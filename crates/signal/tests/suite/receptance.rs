//! Receptances of integrated oscillators.

use crate::oscillator::{Mode, hammer_pulse, hit, impulse_response, integrated};
use asperity_signal::{Complex64, FrequencyResponse, HarmonicOptions, SignalError, find_harmonics};
use std::f64::consts::TAU;

const MODE: Mode = Mode { natural_hz: 831.98, damping: 0.035, mass: 1.61 };

/// Verified against `1/(2 k zeta sqrt(1 - zeta^2))` at `f0 sqrt(1 - 2 zeta^2)`, and the
/// receptance along its flank against the continuous one. The impulse response starts at
/// zero with slope 1/m, so the rectangle rule is the trapezoidal rule and its error is
/// `-dt^2/(12 m)` at every frequency: slope 2, asserted within 2 %.
#[test]
fn the_receptance_of_an_oscillator_converges_with_the_sampling() {
    let stiffness = MODE.mass * MODE.omega().powi(2);
    let root = (1.0 - MODE.damping * MODE.damping).sqrt();
    let exact = 1.0 / (2.0 * stiffness * MODE.damping * root);
    let at = MODE.natural_hz * (1.0 - 2.0 * MODE.damping * MODE.damping).sqrt();
    let mut errors = Vec::new();
    for rate in [25_000.0, 50_000.0, 100_000.0] {
        let hit = hit(&[MODE], rate, (0.25 * rate) as usize);
        let error = (hit.receptance_at(700.0) - MODE.receptance(700.0)).norm();
        let leading = 1.0 / (12.0 * MODE.mass * rate * rate);
        assert!((error / leading - 1.0).abs() < 0.02, "{rate}: {error:e}");
        errors.push(error);

        // The peak is nearly imaginary and the error real, so the magnitude is better still.
        let peak = find_harmonics(&hit, 800.0, &HarmonicOptions::default());
        let peak = peak.fundamental.unwrap();
        let bound = leading / exact;
        assert!((peak.magnitude / exact - 1.0).abs() < bound, "{peak:?}");
        assert!((peak.frequency_hz / at - 1.0).abs() < bound, "{peak:?}");
    }
    for pair in errors.windows(2) {
        let slope = (pair[0] / pair[1]).log2();
        assert!((slope - 2.0).abs() < 0.02, "slope {slope}");
    }
}

/// Verified against the geometric sum: on the grid and between its points the receptance
/// is that of the samples to rounding, and the record's end, `exp(-183 T) = 2e-20`, is gone.
#[test]
fn the_grid_and_single_frequencies_are_the_same_function() {
    let rate = 100_000.0;
    let hit = hit(&[MODE], rate, 25_000);
    let peak = MODE.sampled_receptance(830.0, rate).0.norm();
    let receptance = hit.receptance(3);
    for k in (0..receptance.len()).step_by(97) {
        let frequency = receptance.frequency_hz[k];
        let exact = MODE.sampled_receptance(frequency, rate).0;
        assert!((receptance.values[k] - exact).norm() < 1e-12 * peak);
        assert!((hit.receptance_at(frequency) - exact).norm() < 1e-12 * peak);
    }
}

/// One hit of the smooth pulse, integrated with 4 Runge-Kutta steps a sample, by both kinds.
fn both_routes(rate: f64) -> [FrequencyResponse; 2] {
    let count = (0.25 * rate) as usize;
    let stiffness = MODE.mass * MODE.omega().powi(2);
    let viscosity = 2.0 * MODE.damping * MODE.omega() * MODE.mass;
    let pulse = hammer_pulse(20.0, 3.4e-4);
    let force: Vec<f64> = (0..count).map(|n| pulse(n as f64 / rate)).collect();
    let restoring = |u: f64, v: f64| stiffness * u + viscosity * v;
    let (u, a) = integrated(MODE.mass, restoring, &pulse, rate, count, 4);
    [
        FrequencyResponse::from_displacement(&force, &u, rate).unwrap(),
        FrequencyResponse::from_acceleration(&force, &a, rate).unwrap(),
    ]
}

/// Verified against the continuous receptance and the rectangle rule's own error. Force and
/// acceleration start as `t^2`, so by Euler and Maclaurin their sums are off by `dt^4 / 720`
/// times the third derivative of `F exp(-i w t)` at zero: of the force's transform, with
/// `x = pi f tp`, that is `e = (dt / tp)^4 (1 + x^2)^2 / 15`. A displacement starts as `t^4`
/// and adds nothing; an acceleration makes it `e |1 + 1 / (m w^2 H)|`. Asserted within 2 %
/// (the next term is `(dt / tp)^2` of it), as is the slope 4 that follows.
#[test]
fn displacement_and_acceleration_converge_to_one_receptance() {
    let coarse = both_routes(50_000.0);
    let fine = both_routes(100_000.0);
    for frequency in [300.0, 700.0, 831.98, 1200.0, 1664.0] {
        let exact = MODE.receptance(frequency);
        let x = std::f64::consts::PI * frequency * 3.4e-4;
        let leading = (1e-5_f64 / 3.4e-4).powi(4) * (1.0 + x * x).powi(2) / 15.0;
        let inertia = MODE.mass * (TAU * frequency).powi(2);
        let predicted = [1.0, (1.0 + (exact * inertia).inv()).norm()].map(|by| by * leading);
        for ((coarse, fine), predicted) in coarse.iter().zip(&fine).zip(predicted) {
            let error = |hit: &FrequencyResponse| {
                (hit.receptance_at(frequency) - exact).norm() / exact.norm()
            };
            let seen = error(fine) / predicted;
            assert!((seen - 1.0).abs() < 0.02, "{:?} {frequency} Hz: {seen}", fine.kind());
            let slope = (error(coarse) / error(fine)).log2();
            assert!((slope - 4.0).abs() < 0.03, "{:?}: slope {slope}", fine.kind());
        }
    }
    let options = HarmonicOptions::default();
    let [first, second] =
        [&fine[0], &fine[1]].map(|hit| find_harmonics(hit, 850.0, &options).fundamental.unwrap());
    assert!((first.frequency_hz / second.frequency_hz - 1.0).abs() < 2e-7);
    assert!((first.magnitude / second.magnitude - 1.0).abs() < 5e-7);

    let dc = fine[1].receptance(1).values[0];
    assert!(dc.re.is_nan() && dc.im.is_nan(), "acceleration has no static receptance");
    let dc = fine[0].receptance(1).values[0] * MODE.mass * MODE.omega().powi(2);
    assert!((dc - Complex64::ONE).norm() < 6e-7, "displacement has one");
}

/// Verified against the half-sine's zeros at 1.5, 2.5, ... over its duration.
#[test]
fn the_force_mask_excludes_the_zeros_of_a_half_sine() {
    let (rate, duration) = (200_000.0, 1e-3);
    let force: Vec<f64> = (0..4000)
        .map(|n| f64::from(n) / rate)
        .map(|t| if t < duration { (TAU * t / (2.0 * duration)).sin() } else { 0.0 })
        .collect();
    let hit = FrequencyResponse::from_displacement(&force, &force, rate).unwrap();
    let mask = hit.force_mask(8, 0.02);
    let valid_at = |frequency: f64| {
        let step = mask.frequency_hz[1];
        mask.valid[(frequency / step).round() as usize]
    };
    for (frequency, valid) in [
        (0.0, true),
        (1000.0, true),
        (1300.0, true),
        (1500.0, false),
        (1900.0, true),
        (2500.0, false),
    ] {
        assert_eq!(valid_at(frequency), valid, "{frequency} Hz");
    }
    // |F| is cos(pi f d) / (1 - 4 f^2 d^2) of its maximum: 0.02 between the first point cut
    // and the one before, up to the rectangle rule's (pi dt / d)^2 / 12 = 2e-5.
    let first = mask.first_masked_hz().unwrap();
    let level = |f: f64| ((std::f64::consts::PI * f).cos() / (1.0 - 4.0 * f * f)).abs();
    assert!(level(first * duration) < 0.02 + 1e-4, "{first}");
    assert!(level((first - mask.frequency_hz[1]) * duration) > 0.02 - 1e-4, "{first}");
    assert!(mask.coverage() < 0.5);
    assert!((hit.force_at(0.0).norm() * 0.02 / mask.floor - 1.0).abs() < 1e-12);
}

/// Verified against the documentation: each fault has its own error.
#[test]
fn invalid_signals_are_rejected() {
    let (force, displacement) = impulse_response(&[MODE], 1e4, 10);
    let rejected = |force: &[f64], displacement: &[f64], rate| {
        FrequencyResponse::from_displacement(force, displacement, rate).unwrap_err()
    };
    assert_eq!(rejected(&[], &displacement, 1e4), SignalError::Empty { signal: "force" });
    assert_eq!(
        rejected(&force[..9], &displacement, 1e4),
        SignalError::LengthMismatch { force: 9, response: 10 }
    );
    assert_eq!(rejected(&force, &displacement, -1.0), SignalError::SampleRate { value: -1.0 });
    assert_eq!(rejected(&[0.0; 10], &displacement, 1e4), SignalError::NoForce { samples: 10 });
    let mut broken = displacement.clone();
    broken[7] = f64::INFINITY;
    assert_eq!(
        rejected(&force, &broken, 1e4),
        SignalError::NotFinite { signal: "displacement", index: 7, value: f64::INFINITY }
    );
    assert_eq!(
        asperity_signal::Spectrum::new(&force, 1e4, 0).unwrap_err(),
        SignalError::Padding { value: 0, limit: 1024 }
    );
}
