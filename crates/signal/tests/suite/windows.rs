//! Windows on transients and the correction of frequency, damping and amplitude.

use crate::oscillator::{Mode, hammer_pulse, impulse_response, integrated};
use asperity_signal::{
    ExponentialWindow, ForceWindow, FrequencyResponse, HarmonicOptions, Offset, Pulse,
    ResponseKind, circle_fit, find_harmonics, half_power,
};

const MODE: Mode = Mode { natural_hz: 400.0, damping: 0.002, mass: 2.0 };
const RATE: f64 = 25_600.0;

/// One pulse into the mode, 2 s long, where it falls to exp(-10) by itself.
fn measured() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let count = 51_200;
    let stiffness = MODE.mass * MODE.omega().powi(2);
    let viscosity = 2.0 * MODE.damping * MODE.omega() * MODE.mass;
    let pulse = hammer_pulse(20.0, 3.4e-4);
    let restoring = move |u: f64, v: f64| stiffness * u + viscosity * v;
    let (u, a) = integrated(MODE.mass, restoring, &pulse, RATE, count, 2);
    let force = (0..count).map(|n| pulse(n as f64 / RATE)).collect();
    (force, u, a)
}

/// Verified against the mode the samples were made with, cut off after 0.5 s, where it has
/// only fallen to exp(-2.5): with the window and its correction the damping is right within
/// 1 % by both methods, the height within 1 %, and the modal mass within 0.5 %; without a
/// window the cut widens the peak by more than a fifth. Both windowed signals have fallen to
/// 3e-4 at the end, which is the error to expect.
#[test]
fn the_exponential_window_is_corrected() {
    let (force, displacement, acceleration) = measured();
    let cut = 12_800;
    let exact_height = 1.0
        / (2.0
            * MODE.mass
            * MODE.damping
            * MODE.omega()
            * MODE.omega()
            * (1.0 - MODE.damping.powi(2)).sqrt());
    let plain =
        FrequencyResponse::from_displacement(&force[..cut], &displacement[..cut], RATE).unwrap();
    let peak = find_harmonics(&plain, 400.0, &HarmonicOptions::default()).fundamental.unwrap();
    assert!(half_power(&plain, &peak).unwrap() > 1.2 * MODE.damping);

    let window = ExponentialWindow::falling_to(4e-3, 0.5).unwrap();
    for (kind, samples) in
        [(ResponseKind::Displacement, displacement), (ResponseKind::Acceleration, acceleration)]
    {
        let (mut force, mut samples) = (force[..cut].to_vec(), samples[..cut].to_vec());
        window.apply(&mut force, RATE, 0);
        window.apply(&mut samples, RATE, 0);
        let response = match kind {
            ResponseKind::Displacement => {
                FrequencyResponse::from_displacement(&force, &samples, RATE)
            }
            ResponseKind::Velocity => FrequencyResponse::from_velocity(&force, &samples, RATE),
            ResponseKind::Acceleration => {
                FrequencyResponse::from_acceleration(&force, &samples, RATE)
            }
        };
        let response = response.unwrap();
        let peak = find_harmonics(&response, 400.0, &HarmonicOptions::default());
        let peak = peak.fundamental.unwrap();
        let circle = circle_fit(&response, &peak).unwrap();
        assert!(circle.ratio > 2.0 * MODE.damping, "the window adds damping: {circle:?}");
        let mass = 1.0 / circle.modal_constant.norm();
        assert!((mass / MODE.mass - 1.0).abs() < 5e-3, "{mass}");
        for ratio in [circle.ratio, half_power(&response, &peak).unwrap()] {
            let damping = window.corrected_damping(circle.natural_hz, ratio);
            assert!((damping / MODE.damping - 1.0).abs() < 0.01, "{kind:?} {damping}");
            let height = window.corrected_peak(circle.natural_hz, ratio, peak.magnitude);
            assert!((height / exact_height - 1.0).abs() < 0.01, "{kind:?} {height}");
        }
    }
}

/// Verified against the receptance on the shifted line: with both signals windowed, `H_w(iw)`
/// is `1 / (m (s^2 + 2 zeta w0 s + w0^2))` at `s = iw + 1/tau`, by both kinds, whatever the
/// window's origin. The sampled pulse differs from the pulse by
/// aliasing, `(rise/2 2 pi rate)^-3 = 5e-5`; asserted to twice that.
#[test]
fn a_windowed_receptance_lies_on_a_shifted_line() {
    let (force, displacement, acceleration) = measured();
    let window = ExponentialWindow::new(0.1).unwrap();
    let shifted = |frequency: f64| {
        let s = asperity_signal::Complex64::new(window.rate(), std::f64::consts::TAU * frequency);
        let w0 = MODE.omega();
        (MODE.mass * (s * s + s * (2.0 * MODE.damping * w0) + w0 * w0)).inv()
    };
    for origin in [0, 700] {
        let windowed = |samples: &[f64]| {
            let mut samples = samples.to_vec();
            window.apply(&mut samples, RATE, origin);
            samples
        };
        let force = windowed(&force);
        let by_u =
            FrequencyResponse::from_displacement(&force, &windowed(&displacement), RATE).unwrap();
        let by_a =
            FrequencyResponse::from_acceleration(&force, &windowed(&acceleration), RATE).unwrap();
        for (response, kind) in
            [(by_u, ResponseKind::Displacement), (by_a, ResponseKind::Acceleration)]
        {
            for frequency in [150.0, 390.0, 400.0, 405.0, 900.0] {
                let found = response.receptance_at(frequency);
                let found = window.corrected_receptance(frequency, found, kind);
                let error = (found / shifted(frequency) - 1.0).norm();
                assert!(error < 1e-4, "{kind:?} {frequency}: {error:e}");
            }
        }
    }
}

/// Verified against the pole to rounding, for any damping, and against invalid time constants.
#[test]
fn corrections_are_exact_for_a_pole() {
    let window = ExponentialWindow::new(0.05).unwrap();
    for (damping, natural) in [(0.001, 900.0), (0.1, 50.0), (0.5, 20.0)] {
        let omega = std::f64::consts::TAU * natural;
        let (sigma, damped) = (damping * omega, omega * (1.0_f64 - damping * damping).sqrt());
        let with = sigma + window.rate();
        let natural_with = with.hypot(damped);
        let found = natural_with / std::f64::consts::TAU;
        let ratio = window.corrected_damping(found, with / natural_with);
        assert!((ratio / damping - 1.0).abs() < 1e-12, "{ratio}");
        let height = window.corrected_peak(found, with / natural_with, 1.0 / with);
        assert!((height * sigma - 1.0).abs() < 1e-12);
        if damping < 0.5 {
            let peak = |sigma: f64| (damped * damped - sigma * sigma).sqrt();
            let without = window.corrected_peak_frequency(
                found,
                with / natural_with,
                peak(with) / std::f64::consts::TAU,
            );
            assert!((without * std::f64::consts::TAU / peak(sigma) - 1.0).abs() < 1e-12);
        }
    }
    assert!(window.corrected_peak(10.0, 0.01, 1.0).is_nan());
    assert!(window.corrected_damping(10.0, 0.01) < 0.0);
    for tau in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(ExponentialWindow::new(tau).is_err());
    }
    assert!(ExponentialWindow::falling_to(1.0, 1.0).is_err());
    let falling = ExponentialWindow::falling_to(0.01, 2.0).unwrap();
    assert!(((-2.0 / falling.tau_s()).exp() - 0.01).abs() < 1e-15);
}

/// Verified against its definition: the pulse is unchanged, offset and noise are removed,
/// and the taper is a cosine. The receptance of a force with an offset is corrected.
#[test]
fn the_force_window_keeps_the_pulse_only() {
    let (force, displacement, _) = measured();
    let exact = FrequencyResponse::from_displacement(&force, &displacement, RATE).unwrap();
    let mut noisy: Vec<f64> = force.iter().map(|x| x + 0.125).collect();
    let offset = Offset::at_rest(&noisy).unwrap();
    let pulse = Pulse::of(&force, RATE).unwrap();
    let window = ForceWindow::around(&pulse, 1e-3, 0.5e-3);
    window.apply(&mut noisy, RATE, Some(&offset));
    assert!(noisy.iter().zip(&force).take(60).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(noisy[200..].iter().all(|x| *x == 0.0));
    assert_eq!(window.weight(window.end_s), 1.0);
    assert!((window.weight(window.end_s + 0.25e-3) - 0.5).abs() < 1e-9);
    assert_eq!(window.weight(window.end_s + 0.5e-3), 0.0);
    assert_eq!(window.weight(window.begin_s - 1.0), 0.0);
    let (_, response, _) = measured();
    let found = FrequencyResponse::from_displacement(&noisy, &response, RATE).unwrap();
    for frequency in [100.0, 400.0, 800.0] {
        let (a, b) = (found.receptance_at(frequency), exact.receptance_at(frequency));
        // A gamma pulse has a tail: 1e-4 of it is beyond the window.
        assert!((a / b - 1.0).norm() < 1e-4, "{frequency}: {a} {b}");
    }
    let (force, _) = impulse_response(&[MODE], RATE, 100);
    assert!(Pulse::of(&force, RATE).is_some());
}
