//! Displacement, velocity and acceleration of one hit.

use crate::oscillator::Mode;
use asperity_signal::{
    Complex64, ExponentialWindow, FrequencyResponse, FrfAverage, FrfEstimator, FrfForm,
    HarmonicOptions, Peak, ResponseKind, find_harmonics, half_power,
};

const MODE: Mode = Mode { natural_hz: 831.0, damping: 0.01, mass: 1.6 };
const RATE: f64 = 51_200.0;
/// Time of the maximum of the pulse \[s\].
const RISE_S: f64 = 3.4e-4;
const KINDS: [ResponseKind; 3] =
    [ResponseKind::Displacement, ResponseKind::Velocity, ResponseKind::Acceleration];

/// A mode under the pulse `(t / rise)^2 exp(2 (1 - t / rise))`: force and the three motions, exact.
///
/// With the pole `p` and `q = p + 2 / rise`, the pulse and `exp(p t)` convolve to
/// `g = 2 e / q^3 - (t^2 / q + 2 t / q^2 + 2 / q^3) exp(-2 t / rise)`, `e = exp(p t)`; the
/// displacement is `Im g / (m w_d)`, and `g' = p g + F`.
fn impulse_response(count: usize) -> [Vec<f64>; 4] {
    let pole = Complex64::new(-MODE.damping * MODE.omega(), MODE.damped_omega());
    let (rate, height) = (2.0 / RISE_S, 2.0_f64.exp() / (RISE_S * RISE_S));
    let q = pole + rate;
    let mut signals: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::with_capacity(count));
    for n in 0..count {
        let t = n as f64 / RATE;
        let fall = (-rate * t).exp();
        let force = height * t * t * fall;
        let rest = (1.0 / q * t + 2.0 / (q * q)) * t + 2.0 / (q * q * q);
        let g = ((pole * t).exp() * 2.0 / (q * q * q) - rest * fall) * height;
        let over = 1.0 / (MODE.mass * MODE.damped_omega());
        let motions = [g, pole * g, pole * pole * g + pole * force].map(|z| z.im * over);
        for (signal, x) in signals.iter_mut().zip([force, motions[0], motions[1], motions[2]]) {
            signal.push(x);
        }
    }
    signals
}

fn response(kind: ResponseKind, signals: &[Vec<f64>; 4]) -> FrequencyResponse {
    let [force, u, v, a] = signals;
    match kind {
        ResponseKind::Displacement => FrequencyResponse::from_displacement(force, u, RATE),
        ResponseKind::Velocity => FrequencyResponse::from_velocity(force, v, RATE),
        ResponseKind::Acceleration => FrequencyResponse::from_acceleration(force, a, RATE),
    }
    .unwrap()
}

fn peak(response: &FrequencyResponse) -> Peak {
    find_harmonics(response, 831.0, &HarmonicOptions::default()).fundamental.unwrap()
}

/// Relative error of a receptance by the rectangle rule, by Euler and Maclaurin: sums of signals that
/// begin as `t^2` and `t^3` are off by `dt^4 / 720` times the third derivative at zero. With
/// `s = i w` and `z = 2 / rise + s` that is `e = |z dt|^4 / 240` for the force; the motions make it `e |1 + d|`,
/// `d = 0`, `1 / (3 m s z H)` and `-1 / (m s^2 H)`. 3 % are left for the next term.
fn sampling_error(kind: ResponseKind, s: Complex64, receptance: Complex64) -> f64 {
    let z = s + 2.0 / RISE_S;
    let force = (z / RATE).norm().powi(4) / 240.0;
    let over = (receptance * MODE.mass).inv();
    let motion = match kind {
        ResponseKind::Displacement => Complex64::ZERO,
        ResponseKind::Velocity => over / (s * z * 3.0),
        ResponseKind::Acceleration => -over / (s * s),
    };
    1.03 * force * (1.0 + motion).norm()
}

fn on_axis(frequency: f64) -> Complex64 {
    Complex64::new(0.0, std::f64::consts::TAU * frequency)
}

/// Verified against the continuous receptance and the mode's peak, by each kind, to the
/// error of the rectangle rule, 2e-6 at the peak. The peak frequency and the damping ratio change by
/// less than that over Q.
#[test]
fn three_response_kinds_give_one_receptance() {
    let signals = impulse_response(51_200);
    let top = MODE.natural_hz * (1.0 - 2.0 * MODE.damping * MODE.damping).sqrt();
    let height = MODE.receptance(top).norm();
    for kind in KINDS {
        let response = response(kind, &signals);
        assert_eq!((response.kind(), kind.form().derivatives()), (kind, kind.derivatives()));
        for frequency in [400.0, 820.0, 831.0, 840.0, 1600.0] {
            let exact = MODE.receptance(frequency);
            let off = (response.receptance_at(frequency) / exact - 1.0).norm();
            assert!(
                off < sampling_error(kind, on_axis(frequency), exact),
                "{kind:?} {frequency} Hz: {off:e}"
            );
        }
        let peak = peak(&response);
        assert!((peak.frequency_hz / top - 1.0).abs() < 1e-7, "{kind:?} {peak:?}");
        let bound = sampling_error(kind, on_axis(top), MODE.receptance(top));
        assert!((peak.magnitude / height - 1.0).abs() < bound, "{kind:?} {peak:?}");
        let ratio = half_power(&response, &peak).unwrap();
        assert!((ratio / MODE.damping - 1.0).abs() < 1e-5, "{kind:?} {ratio}");
    }
}

/// Verified against the slope of differences: `d ln |H|^2 / df` of a velocity is zero at the peak,
/// which the refinement of a peak solves for.
#[test]
fn a_peak_from_velocity_is_the_greatest_value_beside_it() {
    let response = response(ResponseKind::Velocity, &impulse_response(20_000));
    let peak = peak(&response);
    for step in [1e-3, 1e-2, 0.1] {
        for beside in [peak.frequency_hz - step, peak.frequency_hz + step] {
            assert!(response.receptance_at(beside).norm() < peak.magnitude);
        }
    }
}

/// Verified against each other and the shifted line of the exponential window: one hit's average
/// is a mobility from velocity, and its receptance that of the windowed velocity, by `s` for `i w`.
/// Tolerance as above.
#[test]
fn an_average_of_velocities_is_a_mobility() {
    let signals = impulse_response(25_600);
    let mut average = FrfAverage::new(25_600, RATE, ResponseKind::Velocity, 1).unwrap();
    let own = average.push(&signals[0], &signals[2]).unwrap();
    let h1 = average.frf(FrfEstimator::H1).unwrap();
    assert_eq!((own.form, h1.form), (FrfForm::Mobility, FrfForm::Mobility));
    let window = ExponentialWindow::new(0.02).unwrap();
    let mut windowed = signals.clone();
    for samples in &mut windowed {
        window.apply(samples, RATE, 0);
    }
    for kind in KINDS {
        let response = response(kind, &windowed);
        for frequency in [400.0, 831.0, 1600.0] {
            let s = Complex64::new(window.rate(), std::f64::consts::TAU * frequency);
            let (sigma, w0) = (2.0 * MODE.damping * MODE.omega(), MODE.omega());
            let exact = (MODE.mass * (s * s + s * sigma + w0 * w0)).inv();
            let found = response.receptance_at(frequency);
            let found = window.corrected_receptance(frequency, found, kind);
            let off = (found / exact - 1.0).norm();
            assert!(off < sampling_error(kind, s, exact), "{kind:?} {frequency}: {off:e}");
        }
    }
}
