//! Stated uncertainties against scatter, and dominant frequencies.

use crate::noise::Noise;
use crate::oscillator::{Mode, hit, impulse_response, integrated};
use asperity_signal::{
    ForceWindow, FrequencyResponse, FrfForm, HarmonicOptions, NoiseDensity, Pulse, band_density,
    dominant_frequency, find_harmonics, peak_uncertainty, ratio_uncertainty, white_density,
};
use std::f64::consts::PI;

const RATE: f64 = 12_800.0;
const COUNT: usize = 1024;
const FIRST: Mode = Mode { natural_hz: 830.0, damping: 0.03, mass: 1.6 };
const SECOND: Mode = Mode { natural_hz: 1560.0, damping: 0.02, mass: 3.0 };

/// Scatter of f1, A1, f2, A2 and A2/A1 over 200 noisy records, over the stated deviations.
fn scatter_over_stated(force_noise: f64, response_noise: f64) -> [f64; 5] {
    let (force, response) = impulse_response(&[FIRST, SECOND], RATE, COUNT);
    let exact =
        find_harmonics(&hit(&[FIRST, SECOND], RATE, COUNT), 830.0, &HarmonicOptions::default());
    let exact = [exact.fundamental.unwrap(), exact.second.unwrap()];
    let exact_ratio = exact[1].magnitude / exact[0].magnitude;
    let density = |deviation: f64| 2.0 * deviation * deviation / RATE;
    let densities = NoiseDensity {
        force: density(force_noise),
        response: density(response_noise),
        ..NoiseDensity::default()
    };
    let mut noise = Noise::new(2024);
    let runs = 200;
    let (mut errors, mut stated) = ([0.0; 5], [0.0; 5]);
    for _ in 0..runs {
        let f = noise.added_to(&force, force_noise);
        let x = noise.added_to(&response, response_noise);
        let noisy = FrequencyResponse::from_displacement(&f, &x, RATE).unwrap();
        let options = HarmonicOptions { leakage_margin: 0.0, ..HarmonicOptions::default() };
        let found = find_harmonics(&noisy, 830.0, &options);
        let peaks = [found.fundamental.unwrap(), found.second.unwrap()];
        let sigmas = peaks.map(|peak| peak_uncertainty(&noisy, &peak, densities).unwrap());
        for n in 0..2 {
            assert!(sigmas[n].is_first_order(), "{sigmas:?}");
            errors[2 * n] += (peaks[n].frequency_hz - exact[n].frequency_hz).powi(2);
            errors[2 * n + 1] += (peaks[n].magnitude - exact[n].magnitude).powi(2);
            stated[2 * n] += sigmas[n].frequency_hz.powi(2);
            stated[2 * n + 1] += sigmas[n].magnitude.powi(2);
        }
        let ratio = found.ratio().unwrap();
        errors[4] += (ratio - exact_ratio).powi(2);
        stated[4] += ratio_uncertainty(ratio, &sigmas[0], &sigmas[1]).powi(2);
    }
    std::array::from_fn(|n| (errors[n] / stated[n]).sqrt())
}

/// Verified against the scatter of 200 records, with noise on the response, on the force, and
/// on both: the stated deviations are right within 20 % (a deviation from 200 has an error of
/// 5 %; the rest is the second order, noise of a roughness of up to a tenth).
#[test]
fn deviations_are_those_of_many_records() {
    let peak = FIRST.sampled_receptance(829.0, RATE).0.norm();
    let on_response = 2.5e-4 * peak * RATE / (COUNT as f64).sqrt();
    let on_force = 2.5e-4 * RATE / (COUNT as f64).sqrt();
    for (force, response) in [(0.0, on_response), (on_force, 0.0), (on_force, on_response)] {
        let over = scatter_over_stated(force, response);
        assert!(over.iter().all(|x| (0.8..1.25).contains(x)), "{force} {response}: {over:?}");
    }
}

/// Verified against the noise added: the density of white noise from its
/// variance and from its spectrum in a band beside the modes; a force window removes the effect of
/// noise on the force.
#[test]
fn noise_is_measured_and_windowed() {
    let (force, response) = impulse_response(&[FIRST, SECOND], RATE, COUNT);
    let mut noise = Noise::new(77);
    let deviation = 1e-9 * RATE;
    let noisy = noise.added_to(&response, deviation);
    let expected = 2.0 * deviation * deviation / RATE;
    // The median of 104 bins has an error of about 1 / sqrt(104) / ln 2 = 14 %.
    let found = band_density(&noisy, RATE, (5000.0, 6300.0)).unwrap().unwrap();
    assert!((found / expected - 1.0).abs() < 0.4, "{found:e} {expected:e}");
    let quiet = noise.added_to(&vec![0.0; 2000], deviation);
    assert!((white_density(&quiet, RATE).unwrap() / expected - 1.0).abs() < 0.1);
    assert_eq!(band_density(&noisy, RATE, (5000.0, 5001.0)), Ok(None));

    let mut with_noise = noise.added_to(&force, 3.0);
    let densities = NoiseDensity { force: 18.0 / RATE, ..NoiseDensity::default() };
    let sigma = |force: &[f64]| {
        let hit = FrequencyResponse::from_displacement(force, &response, RATE).unwrap();
        let peak = find_harmonics(&hit, 830.0, &HarmonicOptions::default()).fundamental.unwrap();
        peak_uncertainty(&hit, &peak, densities).unwrap().relative
    };
    let before = sigma(&with_noise);
    let pulse = Pulse::of(&with_noise, RATE).unwrap();
    ForceWindow::around(&pulse, 4.0 / RATE, 0.0).apply(&mut with_noise, RATE, None);
    // At most 9 of 1024 samples are left: sqrt(9/1024) = 0.09.
    assert!(sigma(&with_noise) < 0.1 * before);
    let clean = hit(&[FIRST], RATE, COUNT);
    let peak = find_harmonics(&clean, 830.0, &HarmonicOptions::default()).fundamental.unwrap();
    let wrong = NoiseDensity { force: -1.0, ..NoiseDensity::default() };
    assert_eq!(peak_uncertainty(&clean, &peak, wrong), None);
}

/// Verified against the modes simulated: the largest receptance is the lower mode's, the largest
/// accelerance the higher's where that is heavier by less than the square of their ratio; a
/// band's edge is not a peak.
#[test]
fn the_dominant_mode_depends_on_the_form() {
    let high = Mode { natural_hz: 2900.0, damping: 0.01, mass: 3.0 };
    let hit = hit(&[FIRST, high], RATE, COUNT);
    let found = |band, form| dominant_frequency(&hit, band, form, 0.02);
    let near = |found: Option<f64>, expected: f64| (found.unwrap() / expected - 1.0).abs() < 5e-3;
    assert!(near(found((100.0, 5000.0), FrfForm::Receptance), 830.0));
    assert!(near(found((100.0, 5000.0), FrfForm::DynamicStiffness), 830.0));
    assert!(near(found((100.0, 5000.0), FrfForm::Accelerance), 2900.0));
    assert!(near(found((1000.0, 5000.0), FrfForm::Receptance), 2900.0));
    assert_eq!(found((900.0, 2000.0), FrfForm::Receptance), None, "only flanks");
    for band in [(0.0, f64::INFINITY), (200.0, 100.0), (f64::NAN, 1.0), (-5.0, 10.0)] {
        assert_eq!(found(band, FrfForm::Receptance), None);
    }
    let plain = find_harmonics(&hit, 830.0, &HarmonicOptions::default()).fundamental.unwrap();
    let refined = found((500.0, 1500.0), FrfForm::Mobility).unwrap();
    assert!((refined / plain.frequency_hz - 1.0).abs() < 1e-9);
}

/// Verified against the zero of a half-sine at 1.5 over its duration: the response
/// there is divided by nearly zero, which gives the largest value of the band and no mode.
#[test]
fn the_dominant_mode_is_not_a_zero_of_the_force() {
    let duration = 1.5 / 1660.0;
    let pulse = |t: f64| if t < duration { 20.0 * (PI * t / duration).sin() } else { 0.0 };
    let (stiffness, viscosity) =
        (FIRST.mass * FIRST.omega().powi(2), 2.0 * FIRST.damping * FIRST.omega() * FIRST.mass);
    let restoring = move |u: f64, v: f64| stiffness * u + viscosity * v;
    let (mut u, _) = integrated(FIRST.mass, restoring, pulse, RATE, COUNT, 4);
    let largest = u.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    u[40] += 0.1 * largest;
    let force: Vec<f64> = (0..COUNT).map(|n| pulse(n as f64 / RATE)).collect();
    let hit = FrequencyResponse::from_displacement(&force, &u, RATE).unwrap();
    let found =
        |threshold| dominant_frequency(&hit, (1450.0, 1900.0), FrfForm::Receptance, threshold);
    assert!((found(0.0).unwrap() / 1660.0 - 1.0).abs() < 0.01, "{:?}", found(0.0));
    assert!(found(0.02).is_none_or(|f| (f / 1660.0 - 1.0).abs() > 0.01), "{:?}", found(0.02));
}
