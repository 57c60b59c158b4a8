//! Detection of hits in records.

use crate::measured;
use crate::noise::Noise;
use crate::oscillator::hammer_pulse;
use asperity_signal::{
    HitFinder, HitLength, HitOptions, Offset, Pulse, QualityIssue, QualityOptions, SignalError,
    TriggerLevel, find_hits, quality_issues,
};
use proptest::prelude::*;

const RATE: f64 = 51_200.0;

fn options(level: TriggerLevel) -> HitOptions {
    let length = HitLength::Samples(2048);
    HitOptions { trigger_level: level, pre_trigger: 32, length, hold_off: 1024 }
}

/// Five hits from 3 to 90 N on noise of 0.02 N with an offset, and their onsets.
fn train() -> (Vec<f64>, Vec<f64>, [usize; 5]) {
    let onsets = [3000, 9000, 15_500, 21_000, 27_777];
    let mut force = vec![0.0; 32_000];
    for (onset, peak) in onsets.into_iter().zip([9.0, 90.0, 3.0, 20.0, 32.0]) {
        let pulse = hammer_pulse(peak, 3.4e-4);
        for (n, x) in force[onset..].iter_mut().enumerate() {
            *x += pulse(n as f64 / RATE);
        }
    }
    let mut noise = Noise::new(7);
    let response = noise.added_to(&vec![0.0; force.len()], 1.0);
    let force = noise.added_to(&force.iter().map(|x| x + 0.05).collect::<Vec<_>>(), 0.02);
    (force, response, onsets)
}

/// Verified against the onsets the record was made with: the automatic level finds hits of
/// very different strength, and the level and noise it reports make sense of them.
#[test]
fn the_automatic_level_finds_every_hit() {
    let (force, response, onsets) = train();
    let (hits, trigger) =
        find_hits(&force, &[&response], RATE, &options(TriggerLevel::Automatic)).unwrap();
    assert_eq!(hits.len(), 5);
    for (hit, onset) in hits.iter().zip(onsets) {
        let at = hit.start as usize + hit.trigger;
        // A pulse of 3 N reaches the level within five samples.
        assert!((onset..onset + 8).contains(&at), "{at} {onset}");
        assert_eq!((hit.trigger, hit.force.len(), hit.missing), (32, 2048, 0));
        let range = hit.start as usize..hit.start as usize + 2048;
        assert_eq!(hit.force, force[range.clone()]);
        assert_eq!(hit.responses[0], response[range]);
        let issues = quality_issues(hit, &QualityOptions::default());
        // The response is nothing but noise and does not decay.
        assert!(issues.iter().all(|v| matches!(v, QualityIssue::NotDecayed { .. })), "{issues:?}");
    }
    assert!((trigger.noise_n / 0.02 - 1.0).abs() < 0.1, "{trigger:?}");
    assert!((89.9..90.2).contains(&trigger.largest_n));
    assert!(trigger.level_n > 0.2 && trigger.level_n < 3.0, "{trigger:?}");
    let rest: Vec<f64> = Noise::new(3).added_to(&vec![0.0; 4000], 0.02);
    let none = find_hits(&rest, &[], RATE, &options(TriggerLevel::Automatic));
    assert!(matches!(none, Err(SignalError::NoHit { .. })), "{none:?}");
}

/// Verified against the onsets: the other rules, hits up to the next one, and a record that
/// begins and ends inside a hit.
#[test]
fn trigger_levels_lengths_and_ends_of_records() {
    let (force, response, onsets) = train();
    let cut = |options: &HitOptions| find_hits(&force, &[&response], RATE, options).unwrap().0;
    assert_eq!(cut(&options(TriggerLevel::Absolute(10.0))).len(), 3);
    assert_eq!(cut(&options(TriggerLevel::Fraction(0.15))).len(), 3);
    assert_eq!(cut(&options(TriggerLevel::Absolute(100.0))).len(), 0);

    let length = HitLength::UntilNext { limit: 6000 };
    let until = HitOptions { length, ..options(TriggerLevel::Absolute(1.0)) };
    let hits = cut(&until);
    let expected = [6000, 6000, 5500, 6000, 32_000 - 27_777 + 32];
    for ((hit, length), onset) in hits.iter().zip(expected).zip(onsets) {
        // Each pulse reaches 1 N at its own time, some samples after its onset.
        assert!(hit.force.len().abs_diff(length) < 8, "{} {length}", hit.force.len());
        assert!((hit.start as usize + 32).abs_diff(onset) < 8);
        assert_eq!(hit.missing, 0);
    }

    let long =
        HitOptions { length: HitLength::Samples(5000), ..options(TriggerLevel::Absolute(1.0)) };
    let last = find_hits(&force[3000..], &[], RATE, &long).unwrap().0;
    assert!(last[0].trigger < 8, "nothing before the record: {}", last[0].trigger);
    let last = last.last().unwrap();
    assert_eq!(last.force.len() + last.missing, 5000);
    let issues = quality_issues(last, &QualityOptions::default());
    let samples = last.force.len();
    assert_eq!(issues, [QualityIssue::Truncated { samples, missing: last.missing }]);
}

/// Verified against the documentation: requests that make no sense are rejected.
#[test]
fn invalid_options_are_rejected() {
    let wrong = |options: HitOptions| find_hits(&[1.0; 50], &[], RATE, &options).unwrap_err();
    let base = options(TriggerLevel::Absolute(0.5));
    let option = |error: &SignalError| matches!(error, SignalError::Option { .. });
    assert!(option(&wrong(HitOptions { length: HitLength::Samples(33), ..base.clone() })));
    let length = HitLength::UntilNext { limit: 100 };
    assert!(option(&wrong(HitOptions { length, hold_off: 32, ..base.clone() })));
    for level in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(option(&wrong(options(TriggerLevel::Absolute(level)))));
    }
    assert!(option(&wrong(options(TriggerLevel::Fraction(1.5)))));
    assert_eq!(find_hits(&[], &[], 0.0, &base), Err(SignalError::SampleRate { value: 0.0 }));
    let mut finder = HitFinder::new(2, RATE, 1.0, &base).unwrap();
    assert_eq!(
        finder.push(&[1.0], &[&[1.0]]),
        Err(SignalError::Channels { found: 1, expected: 2 })
    );
    let uneven = finder.push(&[1.0], &[&[1.0], &[]]);
    assert_eq!(uneven, Err(SignalError::LengthMismatch { force: 1, response: 0 }));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Verified against the whole record pushed at once: block sizes do not change the answer,
    /// the samples are those of the record at the index given, and the level is reached from below.
    #[test]
    fn blocks_do_not_matter(
        force in prop::collection::vec(prop_oneof![6 => -0.5..0.5_f64, 1 => 0.5..3.0_f64, 1 => Just(f64::NAN)], 0..12_000),
        blocks in prop::collection::vec(0_usize..3000, 1..40),
        pre_trigger in 0_usize..40,
        length in 42_usize..300,
        hold_off in 0_usize..400,
        until_next in any::<bool>(),
    ) {
        let length = if until_next {
            HitLength::UntilNext { limit: length }
        } else {
            HitLength::Samples(length)
        };
        let hold_off = if until_next { hold_off + pre_trigger + 1 } else { hold_off };
        let options = HitOptions { trigger_level: TriggerLevel::Absolute(1.0), pre_trigger, length, hold_off };
        let response: Vec<f64> = (0..force.len()).map(|n| n as f64).collect();
        let finder = || HitFinder::new(1, RATE, 1.0, &options).unwrap();

        let mut whole = finder();
        let mut expected = whole.push(&force, &[&response]).unwrap();
        expected.extend(whole.finish());
        for hit in &expected {
            prop_assert!(hit.force.len() <= length.most());
            prop_assert!(hit.force[hit.trigger] >= 1.0);
            prop_assert!(hit.trigger <= pre_trigger);
            // The level is reached from below.
            let at = hit.start as usize + hit.trigger;
            prop_assert!(at == 0 || force[at - 1] < 1.0 || force[at - 1].is_nan());
            prop_assert_eq!(hit.responses[0][0], hit.start as f64);
            prop_assert_eq!(hit.responses[0].len(), hit.force.len());
        }

        let mut pieces = finder();
        let mut found = Vec::new();
        let mut begin = 0;
        for block in blocks.iter().cycle() {
            let end = (begin + block + 1).min(force.len());
            found.extend(pieces.push(&force[begin..end], &[&response[begin..end]]).unwrap());
            begin = end;
            if begin == force.len() {
                break;
            }
        }
        found.extend(pieces.finish());
        // NaN differs from itself: compare what is printed.
        prop_assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    }
}

/// Verified against the offset put in, within four of the standard errors it states.
#[test]
fn offsets_are_found_with_their_error() {
    let (force, _, _) = train();
    let rest = Offset::at_rest(&force).unwrap();
    assert!((rest.value - 0.05).abs() < 4.0 * rest.standard_error(), "{rest:?}");
    assert!((rest.deviation / 0.02 - 1.0).abs() < 0.05, "{rest:?}");
    let before = Offset::before(&force, 3000, 10).unwrap();
    assert_eq!(before.samples, 2990);
    assert!((before.value - 0.05).abs() < 4.0 * before.standard_error(), "{before:?}");
    assert_eq!(Offset::before(&force, 12, 10), None, "two samples");
    assert_eq!(Offset::before(&force, 5, 10), None);
    let mut removed = vec![before.value + 1.0; 3];
    before.remove(&mut removed);
    assert!(removed.iter().all(|x| (x - 1.0).abs() < 1e-15));
}

/// Verified against three measured hits laid end to end: each is found, and none is checked a
/// double hit, overload or dropout, although their sensor rings before and after the pulse and
/// their flank has a shoulder.
#[test]
fn measured_hits_are_good() {
    let Some(data) = measured::hits("measured_hits_are_good") else {
        return;
    };
    let force: Vec<f64> = data.iter().flat_map(|(force, _)| force.clone()).collect();
    let response: Vec<f64> = data.iter().flat_map(|(_, response)| response.clone()).collect();
    let length = HitLength::Samples(25_500);
    let options = HitOptions {
        trigger_level: TriggerLevel::Automatic,
        pre_trigger: 15,
        length,
        hold_off: 12_800,
    };
    let (hits, trigger) = find_hits(&force, &[&response], measured::RATE, &options).unwrap();
    assert_eq!(hits.len(), 3, "{trigger:?}");
    for hit in &hits {
        assert_eq!(quality_issues(hit, &QualityOptions::default()), [], "{}", hit.start);
        let pulse = Pulse::of(&hit.force, hit.sample_rate_hz).unwrap();
        // 68 to 86 N within a quarter of a millisecond: read off the samples.
        assert!((68.0..87.0).contains(&pulse.peak_n) && pulse.width_s < 3e-4, "{pulse:?}");
    }
    // The same pulse with a third of it repeated 3 ms later is a double hit.
    let mut twice = hits[0].clone();
    for n in 77..25_500 {
        twice.force[n] += 0.3 * hits[0].force[n - 77];
    }
    let issues = quality_issues(&twice, &QualityOptions::default());
    let [QualityIssue::DoubleHit(double)] = issues[..] else {
        panic!("{issues:?}");
    };
    assert!((double.ratio - 0.3).abs() < 0.01, "{double:?}");
}
