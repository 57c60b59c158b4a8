//! The Fourier sum against closed forms.

use asperity_signal::{Complex64, Spectrum, fast_length, transform_at, transform_pair_at};
use std::f64::consts::TAU;

/// Reproducible noise in [-1, 1).
fn noise(count: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    std::iter::repeat_with(next).take(count).collect()
}

/// Verified against Parseval's theorem: `dt sum x^2 = df sum |X|^2` over both sides.
/// Tolerance: rounding of an FFT of 10 000 points and of two sums.
#[test]
fn the_transform_conserves_energy() {
    for (count, padding) in [(1, 1), (997, 1), (4096, 1), (5000, 3)] {
        let (samples, rate) = (noise(count), 51_200.0);
        let spectrum = Spectrum::new(&samples, rate, padding).unwrap();
        let (ends, inner): (f64, f64) =
            spectrum.values().iter().enumerate().fold((0.0, 0.0), |(ends, inner), (k, value)| {
                if k == 0 || k + 1 == spectrum.values().len() {
                    (ends + value.norm_sqr(), inner)
                } else {
                    (ends, inner + value.norm_sqr())
                }
            });
        let in_frequency = (ends + 2.0 * inner) * spectrum.frequency_step();
        let in_time = samples.iter().map(|x| x * x).sum::<f64>() / rate;
        assert!((in_frequency / in_time - 1.0).abs() < 1e-13, "{count}");
    }
}

/// Verified against the geometric sum of a decaying exponential,
/// `dt (1 - r^N) / (1 - r)` with `r = exp(-(a + i 2 pi f) dt)`.
/// Tolerance: 1e-13 of `dt sum |x|`, the rounding of the documentation with room
/// for the closed form's own.
#[test]
fn a_decaying_exponential_has_its_geometric_sum() {
    let (decay, rate, count) = (180.0, 200_000.0, 24_000_usize);
    let dt = 1.0 / rate;
    let samples: Vec<f64> = (0..count).map(|n| (-decay * n as f64 * dt).exp()).collect();
    let absolute = samples.iter().sum::<f64>() * dt;
    // 1 - exp(z) without cancellation at small z.
    let missing = |z: Complex64| (z * 0.5).sinh() * (z * 0.5).exp() * -2.0;
    let exact = |frequency: f64| {
        let exponent = Complex64::new(-decay, -TAU * frequency) * dt;
        let last = exponent * count as f64;
        missing(last) / missing(exponent) * dt
    };
    for frequency in [0.0, 1e-3, 12.5, 831.98, 1634.6, 3000.0] {
        let error = (transform_at(&samples, rate, frequency) - exact(frequency)).norm();
        assert!(error < 1e-13 * absolute, "{frequency} Hz: {error:e}");
    }
    let spectrum = Spectrum::new(&samples, rate, 2).unwrap();
    for (k, value) in spectrum.values().iter().enumerate().take(400) {
        let error = (value - exact(spectrum.frequency(k))).norm();
        assert!(error < 1e-13 * absolute, "bin {k}: {error:e}");
    }
    // And towards the continuous transform 1 / (a + i w): the rectangle rule is
    // off by dt x(0) / 2 to first order, and by the tail exp(-a T) = 4e-10.
    let continuous = Complex64::new(decay, TAU * 831.98).inv();
    let leading = transform_at(&samples, rate, 831.98) - continuous - 0.5 * dt;
    assert!(leading.norm() < dt * dt * (decay + TAU * 831.98));
}

/// Verified against each other: the sum at a bin's frequency and the FFT, on noise.
/// A rate of 2^16 and power-of-two lengths make every bin's frequency exact, so the
/// whole band holds to 1e-14 of `dt sum |x|`; 1e-13 leaves room for the FFT.
#[test]
fn single_frequencies_agree_with_every_bin() {
    let (samples, rate) = (noise(16_384), 65_536.0);
    let absolute = samples.iter().map(|x| x.abs()).sum::<f64>() / rate;
    let spectrum = Spectrum::new(&samples, rate, 2).unwrap();
    assert_eq!(spectrum.values().len(), 16_385);
    for k in (0..spectrum.values().len()).step_by(61).chain([16_384]) {
        let (value, half) =
            transform_pair_at(&samples, &samples[..777], rate, spectrum.frequency(k));
        assert!((value - spectrum.values()[k]).norm() < 1e-13 * absolute, "bin {k}");
        let direct: Complex64 = samples[..777]
            .iter()
            .enumerate()
            .map(|(n, x)| {
                let turns = (k * n) % 32_768; // exact integer phase
                Complex64::from_polar(x / rate, -TAU * turns as f64 / 32_768.0)
            })
            .sum();
        assert!((half - direct).norm() < 1e-14 * absolute, "bin {k}");
    }
}

/// Verified against phases reduced in integers: 17 kHz at 48 kHz is no binary fraction, and a
/// phase of 17/48 in one rounding would be off by 2e-10 after 10^6 samples.
#[test]
fn phases_of_long_records_are_exact() {
    let (samples, rate) = (noise(1_000_000), 48_000.0);
    let turns = |n: usize| (17_000 * n % 48_000) as f64 / rate;
    let direct: Complex64 = samples
        .iter()
        .enumerate()
        .skip(990_000)
        .map(|(n, x)| Complex64::from_polar(x / rate, -TAU * turns(n)))
        .sum();
    let mut late = samples;
    late[..990_000].fill(0.0);
    let absolute = late.iter().map(|x| x.abs()).sum::<f64>() / rate;
    let error = (transform_at(&late, rate, 17_000.0) - direct).norm();
    assert!(error < 1e-13 * absolute, "{:e}", error / absolute);
}

/// Verified against the definition of the grid: without padding the length is a fast length.
#[test]
fn the_grid_is_that_of_the_padded_length() {
    let spectrum = Spectrum::new(&noise(24_000), 200_000.0, 16).unwrap();
    let length = fast_length(16 * 24_000);
    assert_eq!(length, 384_000);
    assert_eq!(spectrum.values().len(), length / 2 + 1);
    assert_eq!(spectrum.frequency(length / 2), 100_000.0);
}
