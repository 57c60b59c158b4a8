//! Whatever is sampled, nothing panics and what is returned is a number.

use asperity_signal::{
    FrfForm, HarmonicOptions, Response, Spectrum, average_stiffness, find_harmonics,
    half_power_crossings, logarithmic_decrement, transform_at,
};
use proptest::prelude::*;

fn options() -> impl Strategy<Value = HarmonicOptions> {
    let window = || (-1.0..4.0_f64, -1.0..4.0_f64);
    (window(), window(), 0_usize..6, 0.0..0.1_f64, 0.0..5.0_f64, 0.0..1.5_f64).prop_map(
        |(fundamental_window, second_window, padding, prominence, margin, threshold)| {
            HarmonicOptions {
                fundamental_window,
                second_window,
                padding,
                minimum_prominence: prominence,
                leakage_margin: margin,
                force_threshold: threshold,
            }
        },
    )
}

fn hits() -> impl Strategy<Value = Response> {
    let sample = prop_oneof![4 => -1.0..1.0_f64, 1 => Just(0.0), 1 => -1e-300..1e300_f64];
    let pairs = prop::collection::vec((sample.clone(), sample), 1..300);
    (pairs, 1.0..1e6_f64, any::<bool>()).prop_filter_map(
        "a force",
        |(pairs, rate, displacement)| {
            let (force, samples): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            if displacement {
                Response::from_displacement(&force, &samples, rate).ok()
            } else {
                Response::from_acceleration(&force, &samples, rate).ok()
            }
        },
    )
}

proptest! {
    // A failure prints its minimal case; it becomes a test of its own, not a file.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Verified against the promises of `Peak`: inside its window, no lower than beside it.
    #[test]
    fn a_peak_is_a_local_maximum_inside_its_window(
        hit in hits(),
        expected in 1e-3..2.0_f64,
        options in options(),
    ) {
        let expected = expected * hit.sample_rate_hz();
        let found = find_harmonics(&hit, expected, &options);
        if let Some(peak) = found.fundamental {
            let over = peak.frequency_hz / expected;
            let (low, high) = options.fundamental_window;
            prop_assert!(low < over && over < high);
            prop_assert!(peak.magnitude > 0.0 && (0.0..=1.0).contains(&peak.prominence));
            // A step well inside a bin and well outside the rounding of the curve.
            for side in [-1.0, 1.0] {
                let beside = peak.frequency_hz + side * 1e-3 / hit.duration();
                let magnitude = hit.receptance_at(beside).norm();
                prop_assert!(magnitude <= peak.magnitude * (1.0 + 1e-9));
            }
            if let Some(width) = half_power_crossings(&hit, &peak) {
                prop_assert!(width.lower_hz < peak.frequency_hz);
                prop_assert!(width.upper_hz > peak.frequency_hz);
            }
        } else {
            prop_assert!(found.second.is_none());
        }
    }

    /// Verified against arbitrary bit patterns: errors or values, never a panic.
    #[test]
    fn nothing_panics(
        samples in prop::collection::vec(any::<f64>(), 0..200),
        rate in any::<f64>(),
        frequency in any::<f64>(),
        padding in any::<usize>(),
    ) {
        let _ = transform_at(&samples, rate, frequency);
        let _ = logarithmic_decrement(&samples, rate, frequency);
        let _ = average_stiffness(&samples);
        if let Ok(spectrum) = Spectrum::new(&samples, rate, padding % 20) {
            prop_assert!(spectrum.frequency_step() >= 0.0);
        }
        if let Ok(hit) = Response::from_acceleration(&samples, &samples, rate) {
            let found = find_harmonics(&hit, frequency, &HarmonicOptions::default());
            prop_assert!(found.ratio().is_none_or(|ratio| ratio >= 0.0));
            let _ = hit.receptance(padding % 20).to(FrfForm::ApparentMass);
            let _ = hit.force_mask(padding % 20, frequency).coverage();
        }
    }
}
