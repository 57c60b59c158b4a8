//! Force pulses and quality of hits.

use crate::noise::Noise;
use crate::oscillator::hammer_pulse;
use asperity_signal::{
    HitChannel, HitRecord, Pulse, QualityIssue, QualityOptions, double_hits, quality_issues,
};
use std::f64::consts::PI;

const RATE: f64 = 51_200.0;

fn half_sine(peak: f64, duration: f64) -> impl Fn(f64) -> f64 {
    move |t| if (0.0..duration).contains(&t) { peak * (PI * t / duration).sin() } else { 0.0 }
}

fn sampled(count: usize, signal: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..count).map(|n| signal(n as f64 / RATE)).collect()
}

/// Verified against closed forms: a half-sine of duration T has impulse 2 F T / pi, width
/// 2 T / 3 and lasts T (1 - 2 asin(0.1) / pi) above a tenth. Tolerances: chords of a sine are
/// low by (pi dt / T)^2 / 8 = 5e-4 of the peak at 51 samples; the impulse misses the two feet
/// below 1 %, 1e-4 of it, and the trapezoids (pi dt / T)^2 / 12 = 3e-4.
#[test]
fn a_half_sine_has_its_widths() {
    let duration = 1.0e-3;
    let shifted = half_sine(20.0, duration);
    let force = sampled(400, |t| shifted(t - 1.003e-3));
    let pulse = Pulse::of(&force, RATE).unwrap();
    assert!((pulse.refined_peak_n / 20.0 - 1.0).abs() < 1e-6, "{pulse:?}");
    assert!(pulse.peak_n <= 20.0 && pulse.peak_n > 19.98);
    assert!((pulse.peak_time_s - 1.503e-3).abs() < 1e-8);
    assert!((pulse.impulse_n_s / (40.0 * duration / PI) - 1.0).abs() < 5e-4);
    assert!((pulse.width_s / (2.0 / 3.0 * duration) - 1.0).abs() < 1e-3);
    let tenth = duration * (1.0 - 2.0 * 0.1_f64.asin() / PI);
    assert!((pulse.duration_s / tenth - 1.0).abs() < 1e-3, "{pulse:?}");
    assert_eq!(Pulse::of(&[0.0, -1.0], RATE), None);
    assert_eq!(Pulse::of(&[1.0, f64::NAN], RATE), None);
    assert_eq!(Pulse::of(&[], RATE), None);
    assert_eq!(Pulse::of(&[1.0; 3], 0.0), None);
}

/// Verified against signals with one pulse, none of them a double hit.
#[test]
fn single_hits_are_not_double_hits() {
    let clean = half_sine(30.0, 1.0e-3);
    let gamma = hammer_pulse(30.0, 3.4e-4);
    // A sensor that undershoots by a quarter and rings back by 14 % after the pulse.
    let ringing = |t: f64| {
        let after = (t - 1.0e-3).max(0.0);
        -9.0 * (-2500.0 * after).exp() * (PI * after / 2.0e-4).sin()
    };
    // A shoulder on the flank, as a soft tip makes it: no valley.
    let shoulder = |t: f64| clean(t) + half_sine(9.0, 0.6e-3)(t - 0.75e-3);
    let mut noise = Noise::new(11);
    let signals: [Vec<f64>; 4] = [
        sampled(2000, &clean),
        sampled(2000, &gamma),
        sampled(2000, |t| clean(t) + ringing(t)),
        sampled(2000, shoulder),
    ];
    for (index, signal) in signals.iter().enumerate() {
        for deviation in [0.0, 0.1] {
            let force = noise.added_to(signal, deviation);
            assert_eq!(double_hits(&force, RATE, 0.1), [], "signal {index}, noise {deviation}");
        }
    }
}

/// Verified against an added second pulse: found at its time with its ratio, apart or
/// overlapping with a valley, weaker or stronger; below the fraction it is not.
#[test]
fn double_hits_are_found() {
    let duration = 1.0e-3;
    for (ratio, delay) in [(0.3, 1.0e-3), (0.3, 1.4e-3), (0.3, 8.0e-3), (0.12, 5.0e-3), (3.0, 2e-3)]
    {
        let both =
            |t: f64| half_sine(20.0, duration)(t) + half_sine(20.0 * ratio, duration)(t - delay);
        let force = Noise::new(5).added_to(&sampled(2000, both), 0.02);
        let found = double_hits(&force, RATE, 0.1);
        assert_eq!(found.len(), 1, "{ratio} {delay}");
        // The top is flat: noise of 0.02 N moves its maximum by some samples.
        assert!((found[0].second_s - delay - 0.5e-3).abs() < 1e-4, "{found:?}");
        assert!((found[0].ratio / ratio - 1.0).abs() < 0.03, "{found:?}");
        assert!(found[0].valley < 0.1 && found[0].threshold == 0.1);
    }
    // Overlapping: two hits of 1 ms, 0.8 ms apart, leave a valley.
    let both = |t: f64| half_sine(20.0, duration)(t) + half_sine(12.0, duration)(t - 0.85e-3);
    let found = double_hits(&sampled(2000, both), RATE, 0.1);
    assert_eq!(found.len(), 1);
    assert!(found[0].valley > 0.2 && (found[0].ratio - 0.6).abs() < 0.05, "{found:?}");
    let weak = |t: f64| half_sine(20.0, duration)(t) + half_sine(1.8, duration)(t - 3e-3);
    assert_eq!(double_hits(&sampled(2000, weak), RATE, 0.1), []);
    assert_eq!(double_hits(&sampled(2000, weak), RATE, 0.08).len(), 1);
    assert_eq!(double_hits(&sampled(2000, weak), RATE, f64::NAN), []);
}

fn hit(force: Vec<f64>, response: Vec<f64>) -> HitRecord {
    let (responses, sample_rate_hz) = (vec![response], RATE);
    HitRecord { start: 0, trigger: 2, force, responses, sample_rate_hz, missing: 0 }
}

/// Verified against faults added one by one: each is reported at its time, and nothing else.
#[test]
fn each_fault_is_reported() {
    let force = sampled(4000, half_sine(20.0, 1.0e-3));
    let decay = |t: f64| 50.0 * (-120.0 * t).exp() * (2.0 * PI * 800.0 * t).sin();
    let response = sampled(4000, decay);
    let issues_of = |force: &[f64], response: &[f64]| {
        quality_issues(&hit(force.to_vec(), response.to_vec()), &QualityOptions::default())
    };
    assert_eq!(issues_of(&force, &response), []);

    let clipped: Vec<f64> = force.iter().map(|x| x.min(15.0)).collect();
    let issues = issues_of(&clipped, &response);
    let [QualityIssue::Overload { channel: HitChannel::Force, samples, value, time_s, .. }] =
        issues[..]
    else {
        panic!("{issues:?}");
    };
    assert_eq!(value, 15.0);
    // Above 15 N of 20 N for acos(0.75) of the quarter turn: 23.5 of 51.2 samples.
    assert!((23..=24).contains(&samples), "{samples}");
    assert!((time_s - 0.27e-3).abs() < 2e-5);

    let mut held = response.clone();
    held[300..315].fill(response[300]);
    let issues = issues_of(&force, &held);
    let [QualityIssue::Dropout { channel: HitChannel::Response(0), samples: 15, time_s, .. }] =
        issues[..]
    else {
        panic!("{issues:?}");
    };
    assert_eq!(time_s, 300.0 / RATE);

    let mut dead = force.clone();
    dead[22..26].fill(0.0);
    let issues = issues_of(&dead, &response);
    let dropout = |v: &QualityIssue| {
        matches!(
            v,
            QualityIssue::Dropout { channel: HitChannel::Force, samples: 4, value: 0.0, .. }
        )
    };
    assert_eq!(issues.iter().filter(|v| dropout(v)).count(), 1, "{issues:?}");

    let mut lost = response.clone();
    lost[77..79].fill(f64::NAN);
    let issues = issues_of(&force, &lost);
    let time_s = 77.0 / RATE;
    let channel = HitChannel::Response(0);
    let not_finite = |infinite| QualityIssue::NotFinite { channel, time_s, samples: 2, infinite };
    assert_eq!(issues, [not_finite(false)]);
    lost[77..79].fill(f64::NEG_INFINITY);
    let issues = issues_of(&force, &lost);
    assert!(issues.contains(&not_finite(true)), "{issues:?}");
    assert!(issues[0].to_string().starts_with("overload"), "{issues:?}");

    let short = &response[..800];
    let issues = issues_of(&force[..800], short);
    assert!(matches!(issues[..], [QualityIssue::NotDecayed { ratio, .. }] if ratio > 0.05));
}

/// A fast decay that is clipped touches its limits at single samples only; unclipped decays, digitised
/// or not, and noise of a few converter steps have no such limit.
#[test]
fn a_clipped_oscillation_is_reported() {
    let force = sampled(4000, half_sine(20.0, 1.0e-3));
    // About eight samples a cycle, so that no two in a row are beyond 47 of 50.
    let decay = |t: f64| 50.0 * (-60.0 * t).exp() * (2.0 * PI * 6013.0 * t).sin();
    let response = sampled(4000, decay);
    let issues_of = |response: &[f64]| {
        let all =
            quality_issues(&hit(force.clone(), response.to_vec()), &QualityOptions::default());
        let of_limits = |issue: &QualityIssue| {
            matches!(issue, QualityIssue::Clipped { .. } | QualityIssue::Overload { .. })
        };
        all.into_iter().filter(of_limits).collect::<Vec<_>>()
    };
    let clipped: Vec<f64> = response.iter().map(|x| x.clamp(-46.0, 46.0)).collect();
    let at_limits = clipped.iter().filter(|x| x.abs() == 46.0).count();
    assert!((8..=40).contains(&at_limits), "{at_limits}");
    let [QualityIssue::Clipped { channel: HitChannel::Response(0), times, value, .. }] =
        issues_of(&clipped)[..]
    else {
        panic!("{:?}", issues_of(&clipped));
    };
    assert!(value.abs() == 46.0 && times >= 5, "{value} {times}");
    assert_eq!(issues_of(&response), []);
    let digitised = |steps: f64| -> Vec<f64> {
        response.iter().map(|x| (x / 50.0 * steps).round() * 50.0 / steps).collect()
    };
    for steps in [32768.0, 2048.0, 10.0] {
        assert_eq!(issues_of(&digitised(steps)), [], "{steps}");
    }
}

/// Verified against the full scale of the converter, an overload, and against a coarsely digitised
/// slow oscillation with flat maxima, which is none.
#[test]
fn coarse_steps_are_not_an_overload() {
    let force = sampled(4000, half_sine(20.0, 1.0e-3));
    let slow =
        |t: f64| (40.0 * (-60.0 * t).exp() * (2.0 * PI * 100.0 * t).sin() / 0.5).round() * 0.5;
    let coarse = sampled(6000, slow);
    let quality = QualityOptions {
        undecayed_ratio: 1.0,
        constant_samples: 1000,
        ..QualityOptions::default()
    };
    let mut force_long = force.clone();
    force_long.resize(6000, 0.0);
    assert_eq!(quality_issues(&hit(force_long.clone(), coarse.clone()), &quality), []);
    let limited = QualityOptions { full_scale_response: Some(30.0), ..quality };
    let issues = quality_issues(&hit(force_long, coarse), &limited);
    assert!(!issues.is_empty());
    for issue in issues {
        assert!(
            matches!(issue, QualityIssue::Overload { full_scale: Some(30.0), .. }),
            "{issue:?}"
        );
    }
}
