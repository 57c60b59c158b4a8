//! Arbitrary samples: no panic, and finite results or none.

use asperity_signal::{
    BackboneOptions, BandPass, Complex64, ExponentialWindow, ForceWindow, FrequencyResponse,
    FrfForm, FundamentalSearch, HammerOptions, HarmonicOptions, HitLength, HitOptions, HitRecord,
    NoiseDensity, Offset, Pulse, QualityOptions, ResponseKind, Spectrum, TriggerLevel, backbone,
    band_density, circle_fit, circle_fit_of, dominant_frequency, double_hits, find_harmonics,
    half_power_crossings, hammer_test, logarithmic_decrement, peak_uncertainty, quality_issues,
    transform_at,
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

fn hits() -> impl Strategy<Value = FrequencyResponse> {
    let sample = prop_oneof![4 => -1.0..1.0_f64, 1 => Just(0.0), 1 => -1e-300..1e300_f64];
    let pairs = prop::collection::vec((sample.clone(), sample), 1..300);
    (pairs, 1.0..1e6_f64, any::<bool>()).prop_filter_map(
        "a force",
        |(pairs, rate, displacement)| {
            let (force, samples): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            if displacement {
                FrequencyResponse::from_displacement(&force, &samples, rate).ok()
            } else {
                FrequencyResponse::from_acceleration(&force, &samples, rate).ok()
            }
        },
    )
}

proptest! {
    // A failure prints its minimal case, which becomes a test of its own.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Verified against the documentation of `Peak`: inside its window, no lower than beside it.
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
        if let Ok(spectrum) = Spectrum::new(&samples, rate, padding % 20) {
            prop_assert!(spectrum.frequency_step() >= 0.0);
        }
        if let Ok(hit) = FrequencyResponse::from_acceleration(&samples, &samples, rate) {
            let found = find_harmonics(&hit, frequency, &HarmonicOptions::default());
            prop_assert!(found.ratio().is_none_or(|ratio| ratio >= 0.0));
            let _ = hit.receptance(padding % 20).to(FrfForm::ApparentMass);
            let _ = hit.force_mask(padding % 20, frequency).coverage();
        }
    }

    /// Verified against arbitrary bit patterns in the conditioning: issues and pulses, or nothing.
    #[test]
    fn conditioning_never_panics(
        force in prop::collection::vec(any::<f64>(), 0..150),
        response in prop::collection::vec(any::<f64>(), 0..150),
        rate in any::<f64>(),
        number in any::<f64>(),
        count in any::<usize>(),
    ) {
        let _ = double_hits(&force, rate, number);
        let _ = band_density(&force, rate, (number, rate));
        if let Some(offset) = Offset::at_rest(&force) {
            prop_assert!(offset.value.is_finite() && offset.samples >= 8);
        }
        let _ = Offset::before(&force, count % 200, count % 7);
        if let Some(pulse) = Pulse::of(&force, rate) {
            prop_assert!(pulse.peak_n > 0.0 && pulse.width_s >= 0.0);
            let mut windowed = force.clone();
            ForceWindow::around(&pulse, number, rate).apply(&mut windowed, rate, None);
        }
        let quality = QualityOptions {
            second_fraction: number,
            flat_samples: count % 10,
            full_scale_n: Some(number),
            full_scale_response: None,
            constant_samples: count % 11,
            undecayed_ratio: number,
        };
        let responses = vec![response.clone(), Vec::new()];
        let hit = HitRecord {
            start: 0,
            trigger: count,
            force: force.clone(),
            responses,
            sample_rate_hz: rate,
            missing: 0,
        };
        let _ = quality_issues(&hit, &quality);
        let values: Vec<Complex64> =
            force.iter().zip(&response).map(|(a, b)| Complex64::new(*a, *b)).collect();
        let _ = circle_fit_of(&force, &values);
        let _ = circle_fit_of(&force[..values.len()], &values);
        if let Ok(band) = BandPass::new(number, rate, force.first().copied().unwrap_or(1.0)) {
            let _ = backbone(&response, rate, &BackboneOptions::new(band));
        }
    }

    /// Verified against hits of finite samples: the analysis gives finite numbers or none.
    #[test]
    fn analysis_never_panics(
        hit in hits(),
        expected in 1e-3..0.4_f64,
        tau in 1e-6..1.0_f64,
        part in 0.01..0.9_f64,
        density in 0.0..1e3_f64,
    ) {
        let rate = hit.sample_rate_hz();
        let band = (0.5 * expected * rate, 1.2 * expected * rate);
        if let Some(frequency) = dominant_frequency(&hit, band, FrfForm::Accelerance, 0.02) {
            prop_assert!(frequency > band.0 && frequency < band.1);
        }
        let found = find_harmonics(&hit, expected * rate, &HarmonicOptions::default());
        if let Some(peak) = found.fundamental {
            let noise = NoiseDensity { force: density, response: density, ..NoiseDensity::default() };
            if let Some(sigma) = peak_uncertainty(&hit, &peak, noise) {
                prop_assert!(sigma.frequency_hz >= 0.0 && sigma.relative >= 0.0);
            }
            if let Some(circle) = circle_fit(&hit, &peak) {
                prop_assert!(circle.ratio > 0.0 && circle.natural_hz > 0.0);
            }
        }
        let cut = HitOptions {
            trigger_level: TriggerLevel::Fraction(0.1),
            pre_trigger: 3,
            length: HitLength::UntilNext { limit: 90 },
            hold_off: 10,
        };
        let reference = FundamentalSearch::Band(band, FrfForm::Receptance);
        let mut options = HammerOptions::new(cut, ResponseKind::Acceleration, reference);
        options.band_part = part;
        options.windows.exponential = ExponentialWindow::new(tau).ok();
        options.windows.force_s = Some((3.0 / rate, 1.0 / rate));
        if let Ok(test) = hammer_test(hit.force(), hit.samples(), rate, &options) {
            let averaged = test.hits.iter().filter(|hit| hit.is_averaged()).count();
            prop_assert_eq!(averaged, test.average.averages());
        }
    }
}
