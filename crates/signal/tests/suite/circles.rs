//! Circle fits of known mobilities.

use crate::noise::Noise;
use crate::oscillator::{Mode, hit};
use asperity_signal::{
    Complex64, DampingComparison, HarmonicOptions, circle_fit, circle_fit_of, find_harmonics,
};
use std::f64::consts::TAU;

fn mobility(mode: &Mode, frequency: f64) -> Complex64 {
    mode.receptance(frequency) * Complex64::new(0.0, TAU * frequency)
}

fn band(mode: &Mode, parts: (f64, f64), count: usize) -> Vec<f64> {
    let width = mode.damping * mode.natural_hz;
    let at = |k: usize| parts.0 + (parts.1 - parts.0) * k as f64 / (count - 1) as f64;
    (0..count).map(|k| mode.natural_hz + at(k) * width).collect()
}

/// Verified against one viscous mode, of which a mobility is exactly a circle through the
/// origin with diameter 1/(2 m zeta w0): exact to rounding for any damping and any part of it.
#[test]
fn one_mode_is_a_circle() {
    for damping in [1e-4, 0.01, 0.05, 0.3] {
        let mode = Mode { natural_hz: 830.0, damping, mass: 1.6 };
        for parts in [(-1.0, 1.0), (-2.5, 2.5), (-0.4, 1.5)] {
            let frequencies = band(&mode, parts, 31);
            let values: Vec<Complex64> = frequencies.iter().map(|f| mobility(&mode, *f)).collect();
            let found = circle_fit_of(&frequencies, &values).unwrap();
            assert!((found.ratio / damping - 1.0).abs() < 1e-9, "{damping} {found:?}");
            assert!((found.natural_hz / 830.0 - 1.0).abs() < 1e-10 * damping.max(0.1), "{found:?}");
            let diameter = 1.0 / (2.0 * mode.mass * damping * mode.omega());
            assert!((2.0 * found.radius / diameter - 1.0).abs() < 1e-10);
            assert!((found.centre - 0.5 * diameter).norm() < 1e-10 * diameter);
            assert!((found.modal_constant * mode.mass - 1.0).norm() < 1e-8, "{found:?}");
            assert!(found.scatter < 1e-10 && found.angle_scatter < 1e-9);
            let height = mode.receptance(830.0 * (1.0_f64 - 2.0 * damping * damping).sqrt()).norm();
            assert!((found.peak_receptance() / height - 1.0).abs() < 1e-8);
        }
    }
}

/// Verified against a mode with a complex constant and a constant neighbour: the circle is
/// shifted and rotated, and the mode is exact.
#[test]
fn a_shifted_and_rotated_circle_gives_the_mode() {
    let mode = Mode { natural_hz: 830.0, damping: 0.01, mass: 1.6 };
    let frequencies = band(&mode, (-1.2, 1.0), 41);
    let turn = Complex64::from_polar(1.0, 0.4);
    let radius = 0.25 / (mode.mass * mode.damping * mode.omega());
    let rest = Complex64::new(0.3, -0.8) * radius;
    let values: Vec<Complex64> =
        frequencies.iter().map(|f| mobility(&mode, *f) * turn + rest).collect();
    let found = circle_fit_of(&frequencies, &values).unwrap();
    assert!((found.ratio / 0.01 - 1.0).abs() < 1e-9, "{found:?}");
    assert!((found.natural_hz / 830.0 - 1.0).abs() < 1e-11, "{found:?}");
    assert!((found.modal_constant * mode.mass / turn - 1.0).norm() < 1e-8, "{found:?}");
}

/// Verified against the mode under noise: 200 fits of 61 points over half the circle with
/// noise of 2 % of the radius. The mean is right within 1 % and the scatter below 3 %.
#[test]
fn circle_fits_under_noise_are_unbiased() {
    let mode = Mode { natural_hz: 830.0, damping: 0.02, mass: 1.6 };
    let frequencies = band(&mode, (-1.0, 1.0), 61);
    let radius = 0.25 / (mode.mass * mode.damping * mode.omega());
    let mut noise = Noise::new(21);
    let (mut sum, mut square) = (0.0, 0.0);
    for _ in 0..200 {
        let mut noisy = |f: &f64| {
            let error = Complex64::new(noise.normal(), noise.normal());
            mobility(&mode, *f) + error * (0.02 * radius)
        };
        let values: Vec<Complex64> = frequencies.iter().map(&mut noisy).collect();
        let error = circle_fit_of(&frequencies, &values).unwrap().ratio / mode.damping - 1.0;
        sum += error;
        square += error * error;
    }
    assert!((sum / 200.0_f64).abs() < 0.01, "{}", sum / 200.0);
    assert!((square / 200.0_f64).sqrt() < 0.03, "{}", (square / 200.0_f64).sqrt());
}

/// Verified against the samples of a mode: the three methods agree within their own errors
/// (parabola of the decrement, 1e-4 at 60 samples a cycle); a wrong
/// frequency gives a spread.
#[test]
fn three_methods_agree_on_one_mode() {
    let mode = Mode { natural_hz: 832.0, damping: 0.02, mass: 1.61 };
    let hit = hit(&[mode], 50_000.0, 12_500);
    let peak = find_harmonics(&hit, 832.0, &HarmonicOptions::default()).fundamental.unwrap();
    let decay = hit.samples().to_vec();
    let found = DampingComparison::of(&hit, &peak, &decay);
    for ratio in [found.half_power.unwrap(), found.circle.unwrap(), found.decrement.unwrap()] {
        assert!((ratio / 0.02 - 1.0).abs() < 1e-3, "{found:?}");
    }
    assert!((found.mean().unwrap() / 0.02 - 1.0).abs() < 1e-3);
    assert!(found.spread().unwrap() < 1e-3);
    let short = DampingComparison::of(&hit, &peak, &decay[..20]);
    assert_eq!(short.decrement, None);
    assert_eq!(DampingComparison::default().spread(), None);
    assert_eq!(circle_fit(&hit, &peak).map(|circle| circle.ratio), found.circle);
}

/// Verified against points that are not on the circle of a mode.
#[test]
fn points_on_no_circle_are_rejected() {
    let frequencies = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let line: Vec<Complex64> = frequencies.iter().map(|f| Complex64::new(*f, 2.0 * f)).collect();
    assert_eq!(circle_fit_of(&frequencies, &line), None);
    assert_eq!(circle_fit_of(&frequencies, &[Complex64::ONE; 6]), None);
    assert_eq!(circle_fit_of(&frequencies, &line[..5]), None);
    assert_eq!(circle_fit_of(&[], &[]), None);
    let mut lost = line.clone();
    lost[2].re = f64::NAN;
    assert_eq!(circle_fit_of(&frequencies, &lost), None);
    // Counter-clockwise: no passive mode.
    let mode = Mode { natural_hz: 3.5, damping: 0.3, mass: 1.0 };
    let wrong: Vec<Complex64> = frequencies.iter().map(|f| mobility(&mode, *f).conj()).collect();
    assert_eq!(circle_fit_of(&frequencies, &wrong), None);
}
