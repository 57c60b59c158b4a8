//! Search for the fundamental and the second harmonic.

use crate::oscillator::{
    Mode, hammer_pulse, hit, impulse_response, integrated, maximum, sampled_slope,
};
use asperity_signal::{
    FrequencyResponse, HarmonicOptions, Harmonics, UnfilteredEnd, find_harmonics,
};
use std::f64::consts::{PI, TAU};

const RATE: f64 = 100_000.0;
const COUNT: usize = 25_000;
const FIRST: Mode = Mode { natural_hz: 830.0, damping: 0.035, mass: 1.61 };

fn search(hit: &FrequencyResponse) -> Harmonics {
    find_harmonics(hit, 850.0, &HarmonicOptions::default())
}

/// Verified against the linear oscillator: no second harmonic, and the floor
/// `|H(2 f1)| / |H(f1)| = 2 zeta sqrt(1 - zeta^2) / |1 - r^2 + 2 i zeta r|` at `r = 2 f1/f0`,
/// which is `2 zeta / 3` to first order in zeta^2 (within 0.5 % here).
#[test]
fn a_linear_oscillator_has_a_floor_but_no_second_harmonic() {
    let hit = hit(&[FIRST], RATE, COUNT);
    let found = search(&hit);
    let first = found.fundamental.unwrap();
    assert_eq!(found.second, None);
    assert_eq!(found.ratio(), None);
    assert!(found.masked_hz.is_empty());
    let floor = hit.receptance_at(2.0 * first.frequency_hz).norm() / first.magnitude;
    assert!((floor / (2.0 * 0.035 / 3.0) - 1.0).abs() < 0.005, "{floor}");
}

/// Verified against the maxima of the geometric sum, by bisection on its derivative:
/// 1e-9 in frequency and 1e-11 in magnitude (a maximum is flat), and the continuous
/// second mode's to 1e-3.
#[test]
fn a_second_peak_is_located() {
    let second = Mode { natural_hz: 1634.6, damping: 0.02, mass: 40.0 };
    let modes = [FIRST, second];
    let hit = hit(&modes, RATE, COUNT);
    let found = search(&hit);
    for (peak, low, high) in
        [(found.fundamental.unwrap(), 700.0, 900.0), (found.second.unwrap(), 1600.0, 1670.0)]
    {
        let exact = maximum(&modes, RATE, low, high);
        assert!((peak.frequency_hz / exact - 1.0).abs() < 1e-9, "{peak:?} {exact}");
        let magnitude: f64 = modes
            .iter()
            .map(|mode| mode.sampled_receptance(exact, RATE).0)
            .sum::<asperity_signal::Complex64>()
            .norm();
        assert!((peak.magnitude / magnitude - 1.0).abs() < 1e-11, "{peak:?}");
        assert_eq!(peak.value.norm(), peak.magnitude);
        assert!((0.1..1.0).contains(&peak.prominence), "{peak:?}");
    }
    let ratio = found.second.unwrap().magnitude / found.fundamental.unwrap().magnitude;
    assert_eq!(found.ratio(), Some(ratio));
}

/// Verified against the derivative of the geometric sum, which is negative throughout: a
/// second mode that only bends the skirt of the first is a shoulder, and is `None`.
#[test]
fn a_shoulder_is_not_a_peak() {
    let modes = [FIRST, Mode { natural_hz: 1660.0, damping: 0.035, mass: 300.0 }];
    let bent = |f: f64| sampled_slope(&modes, RATE, f);
    let slopes: Vec<f64> = (1250..1900).map(|f| bent(f64::from(f))).collect();
    assert!(slopes.iter().all(|slope| *slope < 0.0), "the case is a shoulder");
    let least = slopes.iter().copied().fold(f64::INFINITY, f64::min);
    let flattest = slopes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(flattest > 0.3 * least, "and visibly bent: {least} {flattest}");
    assert_eq!(search(&hit(&modes, RATE, COUNT)).second, None);
}

/// Verified against a mode above the window: a value that rises to the edge is not a peak.
#[test]
fn a_rise_to_the_edge_of_the_window_is_not_a_peak() {
    let modes = [FIRST, Mode { natural_hz: 1990.0, damping: 0.02, mass: 5.0 }];
    let hit = hit(&modes, RATE, COUNT);
    let found = search(&hit);
    assert!(found.fundamental.is_some());
    assert_eq!(found.second, None);
    let wider = HarmonicOptions { second_window: (1.5, 2.6), ..HarmonicOptions::default() };
    assert!(find_harmonics(&hit, 850.0, &wider).second.is_some());
}

/// Verified against a linear oscillator cut off at `exp(-sigma T) = 0.03`: the ripples of the
/// rectangular window are maxima, which the leakage margin rejects.
#[test]
fn leakage_ripples_are_not_peaks() {
    let careless = HarmonicOptions { leakage_margin: 0.0, ..HarmonicOptions::default() };
    let mut mistaken = 0;
    for count in (1800..2200).step_by(20) {
        let hit = hit(&[FIRST], RATE, count);
        let found = search(&hit);
        assert!(found.fundamental.is_some());
        assert_eq!(found.second, None, "{count} samples");
        mistaken += usize::from(find_harmonics(&hit, 850.0, &careless).second.is_some());
    }
    assert!(mistaken > 10, "the ripples are there: {mistaken} of 20");
}

/// The margin up to which a ripple is found does not depend on the grid that it is found on.
#[test]
fn a_ripple_is_found_to_one_margin_on_all_grids() {
    let mut compared = 0;
    for count in (1800..2200).step_by(20) {
        let hit = hit(&[FIRST], RATE, count);
        let is_found = |padding, leakage_margin| {
            let options = HarmonicOptions { padding, leakage_margin, ..HarmonicOptions::default() };
            find_harmonics(&hit, 850.0, &options).second.is_some()
        };
        if !is_found(16, 0.5) {
            continue;
        }
        let largest_margin = |padding| {
            let (mut found, mut not_found) = (0.5, 4.0);
            while not_found - found > 1e-3 {
                let middle = 0.5 * (found + not_found);
                *(if is_found(padding, middle) { &mut found } else { &mut not_found }) = middle;
            }
            found
        };
        let fine: f64 = largest_margin(16);
        // About that margin the ripple is marginal, found or not.
        let ripple = |leakage_margin: f64| {
            let padding = 16;
            let options = HarmonicOptions { padding, leakage_margin, ..HarmonicOptions::default() };
            find_harmonics(&hit, 850.0, &options)
        };
        let at = ripple(0.98 * fine).second.unwrap().frequency_hz;
        let is_marginal =
            |part: f64| ripple(part * fine).marginal_hz.iter().any(|f| (f / at - 1.0).abs() < 1e-6);
        assert!(is_marginal(0.98) && is_marginal(1.02), "{count}");
        assert!(!is_marginal(0.85) && !is_marginal(1.15), "{count}");
        for padding in [4, 5, 7] {
            let margin = largest_margin(padding);
            assert!((margin / fine - 1.0).abs() < 0.03, "{count} {padding}: {margin} {fine}");
        }
        compared += 1;
    }
    assert!(compared > 5, "{compared}");
}

/// A record behind whose end a filter runs out, here in zeros for longer than a period, hides the size of its end:
/// ripples are no peaks once the samples before the filter are given.
#[test]
fn ripples_are_told_apart_before_a_filter_runs_out() {
    let mut mistaken = 0;
    for count in (1800..2200).step_by(20) {
        let (force, displacement) = impulse_response(&[FIRST], RATE, count);
        let end = UnfilteredEnd { samples: &displacement[count - 500..], sample_rate_hz: RATE };
        let [force, filtered] = [&force, &displacement]
            .map(|samples| samples.iter().copied().chain([0.0; 200]).collect::<Vec<_>>());
        let hit = FrequencyResponse::from_displacement(&force, &filtered, RATE).unwrap();
        mistaken += usize::from(search(&hit).second.is_some());
        let hit = hit.with_unfiltered_end(end);
        assert_eq!(search(&hit).second, None, "{count} samples");
    }
    assert!(mistaken > 10, "the ripples are there: {mistaken} of 20");
}

/// An oscillator of unit mass under a half sine of duration `pulse`.
fn struck_by_half_sine(
    natural: f64,
    damping: f64,
    pulse: f64,
    rate: f64,
    count: usize,
) -> FrequencyResponse {
    let force = |time: f64| if time < pulse { (PI * time / pulse).sin() } else { 0.0 };
    driven(natural, damping, force, rate, count)
}

/// An oscillator of unit mass under a force, in exact steps under a force that is constant within each.
fn driven(
    natural: f64,
    damping: f64,
    force: impl Fn(f64) -> f64,
    rate: f64,
    count: usize,
) -> FrequencyResponse {
    let omega = TAU * natural;
    let force = |n: usize| force(n as f64 / rate);
    let (decay, turned) =
        ((-damping * omega / rate).exp(), omega * (1.0 - damping * damping).sqrt());
    let (sine, cosine) = (turned / rate).sin_cos();
    let (mut x, mut v, mut samples) = (0.0, 0.0, Vec::with_capacity(count));
    for n in 0..count {
        samples.push(x);
        let rest = 0.5 * (force(n) + force(n + 1)) / (omega * omega);
        let (from, rate) = (x - rest, (v + damping * omega * (x - rest)) / turned);
        x = rest + decay * (from * cosine + rate * sine);
        v = decay * turned * (rate * cosine - from * sine) - damping * omega * (x - rest);
    }
    let forces: Vec<f64> = (0..count).map(force).collect();
    FrequencyResponse::from_displacement(&forces, &samples, rate).unwrap()
}

/// A sine that lasts to the end of a record has zeros `1/T` apart, beside which `U/F` has deep minima, since the structure still rings.
/// The maxima between them are no peaks.
#[test]
fn maxima_between_zeros_of_a_lasting_force_are_no_peaks() {
    let (rate, natural) = (4e5, 7718.0);
    for hertz in [3500.0, 4957.0, 5600.0] {
        for count in (4000..6000).step_by(200) {
            let sine = |time: f64| (TAU * hertz * time).sin();
            let hit = driven(natural, 0.0055, sine, rate, count);
            let found = find_harmonics(&hit, natural, &HarmonicOptions::default());
            let off = found.fundamental.map_or(0.0, |peak| peak.frequency_hz / natural - 1.0);
            assert!(off.abs() < 0.01, "{hertz} {count}: {:?}", found.fundamental);
            assert!(found.masked_hz.iter().any(|masked| (masked / natural - 1.0).abs() < 0.01));
        }
    }
}

/// The pole beside a zero of the force 7 % below a resonance is higher than it where the record ends while it rings. It is no
/// oscillation whose ripples might be the resonance, on whatever grid it is found.
#[test]
fn a_pole_beside_a_zero_of_the_force_hides_no_resonance() {
    let (rate, natural) = (2e4, 80.0);
    for count in (3000..4200).step_by(100) {
        let hit = struck_by_half_sine(natural, 0.002, 1.5 / (0.93 * natural), rate, count);
        for padding in [4, 5, 7, 16, 64] {
            let options = HarmonicOptions { padding, ..HarmonicOptions::default() };
            let found = find_harmonics(&hit, natural, &options).fundamental;
            let off = found.map_or(1.0, |peak| peak.frequency_hz / natural - 1.0);
            assert!(off.abs() < 0.05, "{count} {padding}: {found:?}");
        }
    }
}

/// A zero of the force is beside the resonance, and a pole of `U/F` there, as the record ends while it rings. The height of
/// the resonance is that of the transform on all grids, and the pole is at one frequency. Minima beyond the pole count where the
/// force is strong enough; the grid has no point where that begins, which leaves up to 0.15 % of the height.
#[test]
fn a_trough_beside_a_zero_of_the_force_is_exact_on_all_grids() {
    let (rate, natural, zero) = (2e4, 213.0, 227.7);
    for count in (1500..2500).step_by(100) {
        let hit = struck_by_half_sine(natural, 0.01, 1.5 / zero, rate, count);
        let search = |padding, minimum_prominence| {
            let options = HarmonicOptions {
                padding,
                minimum_prominence,
                leakage_margin: 0.0,
                second_window: (1.5, 1.6),
                ..HarmonicOptions::default()
            };
            find_harmonics(&hit, natural, &options)
        };
        // The largest prominence that can be asked for, and the pole.
        let decided = |padding| {
            let (mut found, mut not_found) = (0.0, 1.0);
            while not_found - found > 1e-6 {
                let middle = 0.5 * (found + not_found);
                let peak = search(padding, middle).fundamental;
                let is_found = peak.is_some_and(|peak| (peak.frequency_hz - natural).abs() < 5.0);
                *(if is_found { &mut found } else { &mut not_found }) = middle;
            }
            let masked = search(padding, 0.5).masked_hz;
            (found, masked.into_iter().find(|pole| (pole - zero).abs() < 1.0))
        };
        let (fine, pole) = decided(64);
        let pole = pole.unwrap();
        for padding in [4, 5, 7] {
            let (prominence, masked) = decided(padding);
            assert!((prominence - fine).abs() < 2e-3, "{count} {padding}: {prominence} {fine}");
            // A pole narrower than a step of the grid may be missed.
            let same = masked.is_none_or(|masked| (masked / pole - 1.0).abs() < 1e-9);
            assert!(same, "{count} {padding}: {masked:?} {pole}");
        }
    }
}

/// The force has 0.021 of its largest magnitude at a resonance below one of its zeros, 0.02 being asked for: it is strong enough
/// whatever points the grid has, and 0.019 is too weak. Both are said to be near.
#[test]
fn a_force_hardly_strong_enough_is_so_on_all_grids() {
    let (rate, natural) = (2e4, 200.0);
    for (cycles, is_strong) in [(1.45, true), (1.456, false)] {
        for count in (4000..6000).step_by(100) {
            let hit = struck_by_half_sine(natural, 0.02, cycles / natural, rate, count);
            for padding in [2, 3, 4, 7] {
                let options =
                    HarmonicOptions { padding, leakage_margin: 0.0, ..HarmonicOptions::default() };
                let found = find_harmonics(&hit, natural, &options);
                let near = |f: &f64| (f / natural - 1.0).abs() < 0.02;
                let peak = found.fundamental.map(|peak| peak.frequency_hz);
                let case = format!("{cycles} {count} {padding}: {found:?}");
                assert_eq!(peak.as_ref().is_some_and(near), is_strong, "{case}");
                assert_eq!(found.masked_hz.iter().any(near), !is_strong, "{case}");
                assert!(found.marginal_hz.iter().any(near), "{case}");
            }
        }
    }
}

/// A half-sine of 9.1 ms hardly excites an oscillator at 170.7 Hz, beside its zero at 165 Hz, and the record ends while
/// that rings: its ripples below the masked resonance are no fundamental, whatever the length of the record.
#[test]
fn ripples_beside_a_masked_resonance_are_no_fundamental() {
    let (rate, natural, damping, pulse) = (2e4, 170.69, 0.0063, 9.092e-3);
    let careless = HarmonicOptions { leakage_margin: 0.0, ..HarmonicOptions::default() };
    let mut mistaken = 0;
    for count in (6000..10_000).step_by(100) {
        let hit = struck_by_half_sine(natural, damping, pulse, rate, count);
        let found = find_harmonics(&hit, natural, &HarmonicOptions::default());
        assert_eq!(found.fundamental, None, "{count} samples");
        assert!(found.masked_hz.iter().any(|f| (f / natural - 1.0).abs() < 0.01), "{found:?}");
        mistaken += usize::from(find_harmonics(&hit, natural, &careless).fundamental.is_some());
    }
    assert!(mistaken > 30, "the ripples are there: {mistaken} of 40");
}

/// Verified against a response equal to the force: `H = 1`, and every maximum is rounding,
/// even without a minimum prominence.
#[test]
fn rounding_is_not_a_peak() {
    let options = HarmonicOptions {
        minimum_prominence: 0.0,
        leakage_margin: 0.0,
        ..HarmonicOptions::default()
    };
    let force: Vec<f64> =
        (0..4000).map(|n| hammer_pulse(9.0, 3.4e-4)(f64::from(n) / RATE)).collect();
    // A power of two would divide exactly; a third leaves a rounding in every sample.
    let response: Vec<f64> = force.iter().map(|x| x / 3.0).collect();
    let hit = FrequencyResponse::from_displacement(&force, &response, RATE).unwrap();
    for expected in [300.0, 600.0, 850.0, 1100.0] {
        let found = find_harmonics(&hit, expected, &options);
        assert_eq!(found, Harmonics::default(), "{expected} Hz");
    }
}

/// Verified against the prominence reported: the peak is found for a smaller minimum and not for a larger one.
#[test]
fn the_prominence_asked_is_the_prominence_reported() {
    let second = Mode { natural_hz: 1634.6, damping: 0.035, mass: 100.0 };
    let hit = hit(&[FIRST, second], RATE, COUNT);
    let peak = search(&hit).second.unwrap();
    for (factor, kept) in [(0.999, true), (1.001, false)] {
        let minimum_prominence = factor * peak.prominence;
        let options = HarmonicOptions { minimum_prominence, ..HarmonicOptions::default() };
        assert_eq!(find_harmonics(&hit, 850.0, &options).second.is_some(), kept);
    }
}

/// Verified against the zero of a half-sine at 1.5 over its duration: a response with a
/// little content there has a pole of `U/F`, which is masked and reported, not a peak.
#[test]
fn a_force_zero_is_masked() {
    let duration = 1.5 / 1660.0;
    let pulse = move |t: f64| if t < duration { 20.0 * (PI * t / duration).sin() } else { 0.0 };
    let (stiffness, viscosity) =
        (FIRST.mass * FIRST.omega().powi(2), 2.0 * FIRST.damping * FIRST.omega() * FIRST.mass);
    // A softening cubic and quadratic spring makes the second harmonic.
    let restoring = |u: f64, v: f64| stiffness * u * (1.0 - 2.0e4 * u) + viscosity * v;
    let (u, _) = integrated(FIRST.mass, restoring, pulse, RATE, COUNT, 1);
    let force: Vec<f64> = (0..COUNT).map(|n| pulse(n as f64 / RATE)).collect();
    let hit = FrequencyResponse::from_displacement(&force, &u, RATE).unwrap();
    let found = search(&hit);
    assert!(found.fundamental.is_some());
    assert_eq!(found.second, None);
    assert_eq!(found.masked_hz.len(), 1, "{found:?}");
    assert!((found.masked_hz[0] / 1660.0 - 1.0).abs() < 0.01, "{found:?}");
    let unmasked = HarmonicOptions { force_threshold: 0.0, ..HarmonicOptions::default() };
    let fooled = find_harmonics(&hit, 850.0, &unmasked);
    assert!((fooled.second.unwrap().frequency_hz / 1660.0 - 1.0).abs() < 0.01);
}

/// Verified against a mass on two faces of power-law stiffness `K = C p^m` struck by 9 N and
/// 3 N: the second harmonic is a shallow but real peak, A2/A1 of a few per cent, growing
/// with the force.
#[test]
fn a_shallow_peak_of_a_contact_is_found() {
    let (c, m, area, mass, gravity) = (1.810e10, 0.3509, 1.15e-4, 1.61, 9.81);
    let closure = |p: f64| 2.0 * p.powf(1.0 - m) / ((1.0 - m) * c);
    let pressure = |x: f64| (0.5 * (1.0 - m) * c * x.max(0.0)).powf(1.0 / (1.0 - m));
    let weight = mass * gravity / area;
    let start = closure(weight);
    let omega = (0.5 * c * weight.powf(m) * area / mass).sqrt();
    let ratio = |peak: f64| {
        let pulse = hammer_pulse(peak, 3.4e-4);
        let restoring =
            |u: f64, v: f64| area * (pressure(start + u) - weight) + 2.0 * 0.035 * omega * mass * v;
        let (u, _) = integrated(mass, restoring, &pulse, 200_000.0, 24_000, 1);
        let force: Vec<f64> = (0..24_000).map(|n| pulse(f64::from(n) / 200_000.0)).collect();
        let hit = FrequencyResponse::from_displacement(&force, &u, 200_000.0).unwrap();
        let found = find_harmonics(&hit, omega / TAU, &HarmonicOptions::default());
        found.ratio()
    };
    let (small, large) = (ratio(9.0).unwrap(), ratio(20.0).unwrap());
    assert!((0.04..0.08).contains(&small), "{small}");
    assert!(large > 1.5 * small, "{large}");
}
