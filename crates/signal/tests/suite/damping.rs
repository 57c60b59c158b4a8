//! Damping ratios of oscillators from half-power widths and decays.

use std::f64::consts::TAU;

use crate::oscillator::{Mode, hit};
use asperity_signal::{
    FrequencyResponse, HalfPower, HarmonicOptions, ReceptanceFeatures, envelope_decrement,
    find_harmonics, half_power, half_power_crossings, half_power_of, logarithmic_decrement,
};

fn mode(damping: f64) -> Mode {
    Mode { natural_hz: 832.0, damping, mass: 1.61 }
}

fn analytic(damping: f64) -> Option<HalfPower> {
    let mode = mode(damping);
    let peak = mode.natural_hz * (1.0 - 2.0 * damping * damping).sqrt();
    half_power_of(|f| mode.receptance(f).norm_sqr(), peak, 1.0, 1e5)
}

/// Verified against the damping of the analytic receptance, up to the largest that has a
/// lower crossing, `sin(pi/8) = 0.3827`. Tolerance: crossings are found to 1e-10 of their
/// frequency, which is 1e-10/zeta of the ratio.
#[test]
fn the_half_power_ratio_is_exact_for_one_mode() {
    for damping in [1e-4, 0.01, 0.035, 0.1, 0.3, 0.38] {
        let found = analytic(damping).unwrap();
        assert!((found.ratio() - damping).abs() < 1e-9, "{damping}: {found:?}");
        // The usual formula is high by 2 zeta^3.
        let excess = found.small_damping_ratio() - damping;
        if (0.01..0.11).contains(&damping) {
            let expected = 2.0 * damping.powi(3);
            assert!((excess / expected - 1.0).abs() < 0.1, "{damping}: {excess:e}");
        }
    }
    assert_eq!(analytic(0.385), None, "no lower crossing");
}

/// Verified against the damping the samples were made with. Tolerance 1e-6: the sampled
/// receptance is off by `dt^2/(12 m)`, which is `2 zeta (w dt)^2 / 12 = 4e-6` of the peak
/// at 200 kHz, real where the receptance is imaginary, so that it shifts the two crossings alike.
#[test]
fn the_half_power_ratio_of_a_record_is_its_damping() {
    let hit = hit(&[mode(0.035)], 200_000.0, 24_000);
    let peak = find_harmonics(&hit, 800.0, &HarmonicOptions::default());
    let peak = peak.fundamental.unwrap();
    let ratio = half_power(&hit, &peak).unwrap();
    assert!((ratio - 0.035).abs() < 1e-6, "{ratio}");
    let crossings = half_power_crossings(&hit, &peak).unwrap();
    for frequency in [crossings.lower_hz, crossings.upper_hz] {
        let level = hit.receptance_at(frequency).norm_sqr() / peak.magnitude.powi(2);
        assert!((level - 0.5).abs() < 1e-8, "{level}");
    }
}

/// Verified against two modes closer than their width, without half-power crossings.
#[test]
fn overlapping_modes_have_no_width() {
    let (near, far) = (mode(0.035), Mode { natural_hz: 890.0, ..mode(0.035) });
    let hit = hit(&[near, far], 100_000.0, 25_000);
    let found = find_harmonics(&hit, 850.0, &HarmonicOptions::default());
    assert_eq!(half_power(&hit, &found.fundamental.unwrap()), None);
}

/// A peak at 100 Hz beside which the power falls to `least` of it in a minimum of the width of a
/// hundredth of a hertz at 92 Hz, and rises beyond.
fn beside_a_minimum(least: f64) -> impl Fn(f64) -> f64 {
    move |f| {
        let peak = 1.0 / (1.0 + ((f - 100.0) / 20.0).powi(2));
        let beyond = if f < 92.0 { 0.2 * (92.0 - f) } else { 0.0 };
        let dip = (1.0 - least / peak_at_92()) / (1.0 + ((f - 92.0) / 0.01).powi(2));
        (peak + beyond) * (1.0 - dip)
    }
}

fn peak_at_92() -> f64 {
    1.0 / (1.0 + 0.16)
}

/// Verified against a minimum far narrower than the steps of the search: whatever these are, it is a
/// crossing if it is deep enough and none if it is not, and the crossing is where the power is half.
/// Would fail with steps that grow as they like: of these, some pass over the minimum to where power is higher.
#[test]
fn a_narrow_minimum_decides_whatever_the_steps() {
    for step in [0.11, 0.7, 1.3, 2.9, 5.3, 7.9] {
        let deep = beside_a_minimum(0.3);
        let found = half_power_of(&deep, 100.0, step, 1e4).unwrap();
        let level = deep(found.lower_hz);
        assert!(found.lower_hz > 92.0 && (level - 0.5).abs() < 1e-6, "{step}: {found:?} {level}");
        assert!((found.upper_hz - 120.0).abs() < 1e-4, "{step}: {found:?}");
        assert_eq!(half_power_of(beside_a_minimum(0.51), 100.0, step, 1e4), None, "{step}");
    }
}

/// Arguments without an answer have none, and none makes the search run on.
#[test]
fn steps_and_limits_of_no_use_have_no_width() {
    let flat = |_: f64| 1.0;
    for (step, limit) in [(1e-20, 1e4), (1.0, f64::NAN), (1.0, -5.0), (1.0, 50.0), (1.0, 1e300)] {
        assert_eq!(half_power_of(flat, 100.0, step, limit), None, "{step} {limit}");
    }
}

/// Verified against ripples of an amplitude and a period of their own on the way to half power: low ones
/// leave the ratio within what they change at a crossing, high ones leave none.
#[test]
fn low_ripples_are_no_peak() {
    let mode = mode(0.035);
    let rippled = |height: f64| {
        let top = mode.receptance(832.0).norm();
        move |f: f64| {
            let ripple = height * top * (std::f64::consts::TAU * (f - 832.0) / 3.0).cos();
            (mode.receptance(f).norm() + ripple).powi(2)
        }
    };
    let found = half_power_of(rippled(0.005), 832.0, 0.5, 1e5).unwrap();
    // 0.5 % of the peak at a slope of 1/(2 sqrt 2) of it over the half width.
    assert!((found.ratio() / 0.035 - 1.0).abs() < 0.015, "{found:?}");
    assert_eq!(half_power_of(rippled(0.03), 832.0, 0.5, 1e5), None);
}

/// Verified against the damping and frequency of the decay, for any
/// offset. Tolerance: the error of the quartic is of fifth order in the phase per sample, below
/// 1e-7 of the ratio at 54 samples a cycle.
#[test]
fn the_decrement_of_a_decay_is_exact_and_free_of_offset() {
    let rate = 45_000.0;
    for damping in [0.002, 0.035, 0.1] {
        let mode = mode(damping);
        for offset in [0.0, 3.0] {
            let samples: Vec<f64> = (0..9000)
                .map(|n| f64::from(n) / rate)
                .map(|t| mode.impulse_response(t) * mode.mass * mode.damped_omega() + offset)
                .collect();
            let found = logarithmic_decrement(&samples, rate, 800.0).unwrap();
            assert!((found.ratio / damping - 1.0).abs() < 1e-7, "{damping}: {found:?}");
            let damped = mode.damped_omega() / TAU;
            assert!((found.frequency_hz / damped - 1.0).abs() < 1e-4, "{found:?}");
            assert!(found.scatter < 1e-4, "{found:?}");
            // From the first height to 1e-4 of it, or to the end of the record; up to a quarter of a cycle
            // and half a cycle are left out at either end.
            let decrement = TAU * damping / (1.0 - damping * damping).sqrt();
            let expected = (1e4_f64.ln() / decrement).min(0.2 * damped);
            assert!((found.cycles - expected).abs() < 2.1, "{} {expected}", found.cycles);
        }
    }
}

/// Verified against the sampling: the heights' distance from the line falls with the fifth
/// power of the step, the quartic's order on a decay. Slope within 0.4, as the samples
/// fall differently on the extrema.
#[test]
fn the_decrement_converges_with_the_sampling() {
    let mode = mode(0.05);
    let scatter = |per_cycle: f64| {
        let rate = 832.0 * per_cycle;
        let samples: Vec<f64> =
            (0..(0.02 * rate) as usize).map(|n| mode.impulse_response(n as f64 / rate)).collect();
        logarithmic_decrement(&samples, rate, 832.0).unwrap().scatter
    };
    let slope = (scatter(17.3) / scatter(4.0 * 17.3)).log2() / 2.0;
    assert!((slope - 5.0).abs() < 0.4, "slope {slope}");
}

/// Of many samples a cycle a ripple of a light body, far below the decay, hides no extremum.
#[test]
fn a_ripple_does_not_end_the_decay() {
    let (rate, frequency, damping) = (2e5, 930.0, 0.035_f64);
    let natural = TAU * frequency / (1.0 - damping * damping).sqrt();
    let decay = |ripple: f64| -> Vec<f64> {
        let at = |t: f64| {
            let swing = (-damping * natural * t).exp() * (TAU * frequency * t).cos();
            swing + 3e-6 * (TAU * ripple * t).cos()
        };
        (0..12_000).map(|n| at(f64::from(n) / rate)).collect()
    };
    for ripple in (20..98).map(|k| 1e3 * f64::from(k) + 321.0) {
        let found = logarithmic_decrement(&decay(ripple), rate, frequency).unwrap();
        assert!((found.cycles - 41.5).abs() < 1.1, "{ripple}: {found:?}");
        assert!((found.ratio / damping - 1.0).abs() < 3e-3, "{ripple}: {found:?}");
    }
}

/// Verified against the documentation: signals that are no decay give `None`.
#[test]
fn signals_without_decay_have_no_decrement() {
    let ramp: Vec<f64> = (0..1000).map(f64::from).collect();
    assert_eq!(logarithmic_decrement(&ramp, 1000.0, 50.0), None);
    assert_eq!(logarithmic_decrement(&[], 1000.0, 50.0), None);
    assert_eq!(logarithmic_decrement(&ramp, 1000.0, 200.0), None, "5 samples a cycle");
    let sine: Vec<f64> = (0..1000).map(|n| (0.05 * f64::from(n)).sin()).collect();
    let found = logarithmic_decrement(&sine, 1000.0, 8.0).unwrap();
    // Undamped: the quartic's ripple is all there is.
    assert!(found.ratio.abs() < 1e-7, "{found:?}");
    let frequency = 50.0 / std::f64::consts::TAU;
    assert!((found.frequency_hz / frequency - 1.0).abs() < 1e-5, "{found:?}");
}

/// A decaying oscillation of amplitude 1, and a phase \[rad\].
fn decaying(frequency: f64, damping: f64, phase: f64) -> impl Fn(f64) -> f64 {
    let damped = TAU * frequency * (1.0 - damping * damping).sqrt();
    move |t| (-damping * TAU * frequency * t).exp() * (damped * t + phase).cos()
}

fn sampled(of: impl Fn(f64) -> f64, rate: f64, duration: f64) -> Vec<f64> {
    (0..(duration * rate) as usize).map(|n| of(n as f64 / rate)).collect()
}

/// Verified against a decay of one mode with an offset: exact but for the sampling, which is of third order in the phase per
/// sample, and wherever between samples the decay begins; the frequency may be 5 % off.
#[test]
fn the_decrement_of_an_envelope_is_that_of_a_mode() {
    for damping in [0.0, 0.001, 0.02, 0.1] {
        for (per_cycle, most) in [(9.3, 2e-5), (64.0, 5e-6)] {
            for phase in [0.0, 0.7, 2.0] {
                for (start, offset) in [(0.0, 0.0), (3.4, 0.2)] {
                    let mode = decaying(100.0, damping, phase);
                    let rate = 100.0 * per_cycle;
                    let samples = sampled(|t| mode(t) + offset, rate, 0.2);
                    for about in [95.0, 100.0, 105.0] {
                        let found = envelope_decrement(&samples, start..f64::INFINITY, rate, about)
                            .unwrap();
                        let case =
                            format!("{damping} {per_cycle} {phase} {start} {about}: {found}");
                        assert!((found - damping).abs() < most, "{case}");
                    }
                }
            }
        }
    }
}

/// Other modes of the same amplitude, outside the band of the window, do not matter, nor does where the record begins and ends.
#[test]
fn other_modes_leave_the_decrement_of_an_envelope() {
    let (rate, damping) = (1e4, 0.01);
    for other in [210.0, 330.0, 470.0, 1234.0] {
        let (mode, other_mode) = (decaying(100.0, damping, 0.3), decaying(other, 0.002, 1.0));
        let both = |t: f64| mode(t) + other_mode(t);
        let mut before: Option<f64> = None;
        for duration in (0..60).map(|k| 0.15 + 2e-4 * f64::from(k)) {
            let found =
                envelope_decrement(&sampled(both, rate, duration), 7.0..f64::INFINITY, rate, 100.0)
                    .unwrap();
            assert!((found / damping - 1.0).abs() < 0.01, "{other} {duration}: {found}");
            let step = before.map_or(0.0, |before| (found - before).abs());
            assert!(step < 1e-3 * damping, "{other} {duration}: {found}, {before:?}");
            before = Some(found);
        }
    }
}

/// A frequency that rises by a fifth along the decay, as that of a contact does, leaves its damping.
#[test]
fn a_frequency_that_changes_leaves_the_decrement_of_an_envelope() {
    let (rate, damping, low, high) = (2e4, 0.035, 700.0, 840.0);
    // The phase of a frequency that is low + (high - low) (1 - exp(-t / tau)).
    let tau = 0.01;
    let cycles = |t: f64| high * t - (high - low) * tau * (1.0 - (-t / tau).exp());
    let decay = |t: f64| (-damping * TAU * cycles(t)).exp() * (TAU * cycles(t)).cos();
    for about in [700.0, 740.0, 800.0] {
        let found =
            envelope_decrement(&sampled(decay, rate, 0.06), 0.0..f64::INFINITY, rate, about)
                .unwrap();
        assert!((found / damping - 1.0).abs() < 0.01, "{about}: {found}");
    }
}

/// A mode whose record ends early, against the transform `(1 - exp(-s T)) / s` of a decay that is cut off: the half-power
/// ratio is as much too large as the part that remains tells, and the decrement is not.
#[test]
fn the_part_of_a_decay_that_remains_tells_how_much_its_peak_is_widened() {
    let (rate, damping) = (50_000.0, 0.002);
    let omega = TAU * mode(damping).natural_hz;
    for (end, widened) in [(1e-4, 0.0), (0.014_122, 0.0369), (0.028_197, 0.0972), (0.1353, 0.5647)]
    {
        let exponent = -f64::ln(end);
        let duration = exponent / (damping * omega);
        let count = (duration * rate) as usize;
        let at = |n: usize| {
            let t = n as f64 / rate;
            (-damping * omega * t).exp() * (omega * t).sin()
        };
        let displacement: Vec<f64> = (0..count).map(at).collect();
        let mut force = vec![0.0; count];
        force[0] = rate;
        let response = FrequencyResponse::from_displacement(&force, &displacement, rate).unwrap();
        let found = ReceptanceFeatures::of(&response, 800.0, &HarmonicOptions::default());
        assert_eq!(found.remaining, None);
        let found = found.with_decay(&displacement, 0.0..(count - 1) as f64, rate);
        // Root mean square of the last twentieth, whose exponents are those of the end and up to a twentieth more.
        let remaining = end * ((f64::exp(0.1 * exponent) - 1.0) / (0.2 * exponent)).sqrt();
        let told = found.remaining.unwrap() / remaining;
        assert!((told - 1.0).abs() < 0.02, "{end}: {told}");
        let ratio = found.damping_ratio().unwrap() / damping - 1.0;
        // At its phase the end adds a share of a period, 1/(w T), too.
        assert!((ratio - widened).abs() < 0.01, "{end}: {ratio}");
        let decrement = found.damping_ratio_decrement.unwrap() / damping - 1.0;
        assert!(decrement.abs() < 1e-3, "{end}: {decrement}");
    }
    let short = ReceptanceFeatures::default().with_decay(&[1.0; 9], 0.0..8.0, rate);
    assert_eq!(short.remaining, None);
}

/// A motion that is struck again, one that grows, and beats that hardly decay have no decrement; beats that decay, and a motion
/// that lasts, have one.
#[test]
fn an_envelope_that_does_not_decay_has_no_decrement() {
    let (rate, frequency) = (1e4, 100.0);
    let of = |motion: &dyn Fn(f64) -> f64| {
        let samples: Vec<f64> = (0..4000).map(|n| motion(f64::from(n) / rate)).collect();
        envelope_decrement(&samples, 0.0..3999.0, rate, frequency)
    };
    let mode = |decay: f64, f: f64, t: f64| (-decay * t).exp() * (TAU * f * t).sin();
    let struck = |t: f64| {
        mode(20.0, frequency, t)
            + if t > 0.2 { 300.0 * mode(20.0, frequency, t - 0.2) } else { 0.0 }
    };
    assert_eq!(of(&struck), None);
    assert_eq!(of(&|t| mode(-10.0, frequency, t)), None);
    let beats = |decay: f64| move |t: f64| mode(decay, frequency, t) + 0.9 * mode(decay, 112.0, t);
    assert_eq!(of(&beats(0.5)), None);
    let ratio = of(&beats(12.0)).unwrap() * TAU * frequency / 12.0;
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    assert!(of(&|t| mode(0.0, frequency, t)).unwrap().abs() < 1e-9);
}
