//! Hits under a shared force against the exact analysis.

use std::iter;

use crate::oscillator::{Mode, hammer_pulse, impulse_response};
use asperity_signal::{
    DecimationFilter, FrequencyResponse, HarmonicOptions, SharedForce, UnfilteredEnd,
    find_harmonics, half_power,
};

const RATE: f64 = 100_000.0;
const FIRST: Mode = Mode { natural_hz: 830.0, damping: 0.035, mass: 1.61 };
const SECOND: Mode = Mode { natural_hz: 1634.6, damping: 0.02, mass: 40.0 };

/// Force and displacement of a hit, `count` samples at `RATE`, times `factor`.
fn records(modes: &[Mode], count: usize, factor: f64) -> (Vec<f64>, Vec<f64>) {
    let (_, impulse) = impulse_response(modes, RATE, count);
    let pulse = hammer_pulse(1.0, 0.34e-3);
    let force: Vec<f64> = (0..count).map(|n| pulse(n as f64 / RATE)).collect();
    let displacement = (0..count)
        .map(|n| (0..=n.min(900)).map(|k| force[k] * impulse[n - k]).sum::<f64>() / RATE)
        .collect();
    let scaled = |column: Vec<f64>| column.into_iter().map(|x| factor * x).collect();
    (scaled(force), scaled(displacement))
}

/// Both signals decimated by the filter that keeps `high`.
fn decimated(force: &[f64], displacement: &[f64], high: f64) -> (Vec<f64>, Vec<f64>, f64) {
    let filter = DecimationFilter::keeping(RATE, high);
    let whole = 0..force.len();
    let rate = RATE / filter.factor() as f64;
    (filter.apply(force, &whole), filter.apply(displacement, &whole), rate)
}

/// Verified against the analysis of the full records by the exact transform. The decimation aliases
/// 1e-5 of the spectrum above the band, which is small for a hammer pulse.
#[test]
fn decimated_hits_are_analysed_as_the_full_records() {
    for (modes, count) in [(vec![FIRST, SECOND], 12_000), (vec![FIRST], 12_000)] {
        let (force, displacement) = records(&modes, count, 7.0);
        let full = FrequencyResponse::from_displacement(&force, &displacement, RATE).unwrap();
        let options = HarmonicOptions::default();
        let exact = find_harmonics(&full, 850.0, &options);
        let high = 850.0 * 1.4 * 2.3;
        let (few_forces, few, rate) = decimated(&force, &displacement, high);
        let unit: Vec<f64> = few_forces.iter().map(|f| f / 7.0).collect();
        let shared = SharedForce::new(&unit, rate, high).unwrap();
        let found = shared.analyse((&few, None), 7.0, 850.0, &options).unwrap();
        let first = found.harmonics.fundamental.unwrap();
        let expected = exact.fundamental.unwrap();
        assert!((first.frequency_hz / expected.frequency_hz - 1.0).abs() < 2e-6);
        assert!((first.magnitude / expected.magnitude - 1.0).abs() < 1e-5);
        assert!((first.value - expected.value).norm() < 2e-5 * expected.magnitude);
        let damping = half_power(&full, &expected).unwrap();
        assert!((found.damping_ratio().unwrap() / damping - 1.0).abs() < 5e-5);
        assert_eq!(found.harmonics.second.is_some(), exact.second.is_some());
        if let (Some(second), Some(expected)) = (found.harmonics.second, exact.second) {
            assert!((second.frequency_hz / expected.frequency_hz - 1.0).abs() < 4e-6);
            assert!((second.magnitude / expected.magnitude - 1.0).abs() < 4e-5);
            assert!((second.prominence - expected.prominence).abs() < 1e-3);
        }
    }
}

/// Verified against the exact analysis: the transform of a truncated record varies too fast for the
/// interpolation, so the analysis is exact or `None`, wherever the fundamental lies on the grid.
#[test]
fn a_record_that_has_not_decayed_is_exact_or_none() {
    let options = HarmonicOptions::default();
    let high = 850.0 * 1.4 * 2.3;
    let (mut right, mut none) = (0, 0);
    for (damping, count) in [(1e-4, 6000), (0.01, 6000), (0.02, 6000), (0.03, 7500), (0.03, 9600)] {
        for shift in 0..50 {
            let first = Mode { natural_hz: 830.0 + 0.1 * f64::from(shift), damping, mass: 1.61 };
            let (force, displacement) = records(&[first, SECOND], count, 1.0);
            let (force, displacement, rate) = decimated(&force, &displacement, high);
            let shared = SharedForce::new(&force, rate, high).unwrap();
            let Some(found) = shared.analyse((&displacement, None), 1.0, 850.0, &options) else {
                none += 1;
                continue;
            };
            let hit = FrequencyResponse::from_displacement(&force, &displacement, rate).unwrap();
            let exact = find_harmonics(&hit, 850.0, &options);
            let (first, expected) =
                (found.harmonics.fundamental.unwrap(), exact.fundamental.unwrap());
            let off = first.frequency_hz / expected.frequency_hz - 1.0;
            assert!(off.abs() < 2e-6, "{first:?} {expected:?}");
            assert!(
                (first.magnitude / expected.magnitude - 1.0).abs() < 1e-6,
                "{first:?} {expected:?}"
            );
            assert_eq!(found.harmonics.second.is_some(), exact.second.is_some());
            right += 1;
        }
    }
    assert!(right > 20 && none > 20, "{right} right, {none} none");
}

/// A mode that a filter removes rings at the end of a record: with the end before the filter the second harmonic, or none,
/// is that of the samples before the filter; without this mode in that end ripples are found as peaks.
#[test]
fn the_end_of_a_motion_that_a_filter_removes_counts() {
    let high = 850.0 * 1.4 * 2.3;
    let options = HarmonicOptions::default();
    let filter = DecimationFilter::keeping_within(RATE, high, 1e-9);
    let rate = RATE / filter.factor() as f64;
    let (mut mistaken, mut peaks) = (0, 0);
    for (natural_hz, count) in (6000..7000).step_by(40).flat_map(|n| [(10_100.0, n), (20_300.0, n)])
    {
        let fast = Mode { natural_hz, damping: 1e-4, mass: 0.3 };
        for modes in [&[FIRST, fast][..], &[FIRST, SECOND, fast]] {
            let (force, displacement) = impulse_response(modes, RATE, count);
            let full = FrequencyResponse::from_displacement(&force, &displacement, RATE).unwrap();
            let expected = find_harmonics(&full, 850.0, &options);
            let [force, filtered] =
                [&force, &displacement].map(|samples| filter.apply(samples, &(0..count)));
            let hit = FrequencyResponse::from_displacement(&force, &filtered, rate).unwrap();
            let end_of = |samples: &'_ [f64]| samples[count - 500..].to_vec();
            let (_, slow) = impulse_response(&modes[..modes.len() - 1], RATE, count);
            let [slow, all] = [slow, displacement].map(|samples| end_of(&samples));
            let [slow, end] =
                [&slow, &all].map(|samples| UnfilteredEnd { samples, sample_rate_hz: RATE });
            let without = find_harmonics(&hit.clone().with_unfiltered_end(slow), 850.0, &options);
            let shared = SharedForce::new(&force, rate, high).unwrap();
            let shared = shared.analyse((&filtered, Some(end)), 1.0, 850.0, &options);
            let exact = find_harmonics(&hit.with_unfiltered_end(end), 850.0, &options);
            let shared = shared.map(|found| (found.harmonics, 1e-3));
            for (found, tolerance) in iter::once((exact, 1e-6)).chain(shared) {
                match [found.second, expected.second] {
                    [Some(found), Some(expected)] => {
                        let off = found.frequency_hz / expected.frequency_hz - 1.0;
                        assert!(off.abs() < tolerance, "{natural_hz} {count}: {off}");
                        peaks += 1;
                    }
                    [None, None] => {}
                    seconds => panic!("{natural_hz} {count}: {seconds:?}"),
                }
                assert_eq!(found.marginal_hz.len(), expected.marginal_hz.len());
            }
            mistaken += usize::from(without.second.is_some() && expected.second.is_none());
        }
    }
    assert!(mistaken > 10 && peaks > 10, "{mistaken} ripples, {peaks} peaks");
}

#[test]
fn invalid_signals_have_no_analysis() {
    let pulse = hammer_pulse(5.0, 0.3e-3);
    let force: Vec<f64> = (0..1000).map(|n| pulse(f64::from(n) / RATE)).collect();
    assert!(SharedForce::new(&[0.0; 100], RATE, 2000.0).is_none());
    assert!(SharedForce::new(&[f64::NAN; 100], RATE, 2000.0).is_none());
    assert!(SharedForce::new(&force, 0.0, 2000.0).is_none());
    assert!(SharedForce::new(&force, RATE, f64::NAN).is_none());
    let shared = SharedForce::new(&force, RATE, 2000.0).unwrap();
    let options = HarmonicOptions::default();
    assert!(shared.analyse((&force[1..], None), 1.0, 800.0, &options).is_none());
    assert!(shared.analyse((&vec![f64::NAN; force.len()], None), 1.0, 800.0, &options).is_none());
    assert!(shared.analyse((&force, None), 0.0, 800.0, &options).is_none());
}

/// Verified against the documentation: filters of one factor are equal at every rate, and low rates
/// are not decimated.
#[test]
fn the_filter_depends_on_the_factor_alone() {
    let (a, b) = (DecimationFilter::keeping(1e5, 2.5e3), DecimationFilter::keeping(2e5, 5e3));
    assert_eq!((a.factor(), a.taps()), (b.factor(), b.taps()));
    assert_eq!(a.factor(), 9);
    let none = DecimationFilter::keeping(5e3, 2e3);
    assert_eq!((none.factor(), none.taps()), (1, [1.0].as_slice()));
}
