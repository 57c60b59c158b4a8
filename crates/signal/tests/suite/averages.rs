//! Averages of hits against definitions, closed forms and an independent computation.

use crate::measured;
use crate::noise::Noise;
use crate::oscillator::{Mode, impulse_response};
use asperity_signal::{
    Complex64, FrequencyResponse, Frf, FrfAverage, FrfEstimator, FrfForm, HvScaling, ResponseKind,
    SignalError, SpectralDensity,
};

const MODE: Mode = Mode { natural_hz: 830.0, damping: 0.02, mass: 1.5 };
const RATE: f64 = 20_000.0;
const COUNT: usize = 4000;

fn estimator(padding: usize) -> FrfAverage {
    FrfAverage::new(COUNT, RATE, ResponseKind::Displacement, padding).unwrap()
}

/// Hits of one mode with normal noise on force and response.
fn noisy(hits: u64, force_noise: f64, response_noise: f64) -> (FrfAverage, Vec<Frf>) {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let mut noise = Noise::new(42);
    let mut average = estimator(1);
    let own = (0..hits).map(|_| {
        let (f, x) =
            (noise.added_to(&force, force_noise), noise.added_to(&response, response_noise));
        average.push(&f, &x).unwrap()
    });
    let own = own.collect();
    (average, own)
}

fn bin(frequency: f64) -> usize {
    (frequency * COUNT as f64 / RATE).round() as usize
}

/// Verified against Fourier sums: between the lines the response of one hit is that of the hit with
/// each estimator, that of noisy hits with H1 the quotient of the summed products; zeros after a record
/// change neither.
#[test]
fn an_average_is_exact_between_its_lines() {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let mut noise = Noise::new(7);
    let hits: Vec<[Vec<f64>; 2]> =
        (0..5).map(|_| [noise.added_to(&force, 0.02), noise.added_to(&response, 1e-3)]).collect();
    let exact = |hits: &[[Vec<f64>; 2]], frequency: f64| {
        let (mut cross, mut auto) = (Complex64::ZERO, 0.0);
        for [force, response] in hits {
            let hit = FrequencyResponse::from_displacement(force, response, RATE).unwrap();
            let f = hit.force_at(frequency);
            cross += f.norm_sqr() * hit.receptance_at(frequency);
            auto += f.norm_sqr();
        }
        cross / auto
    };
    let frequencies = [101.3, 700.02, 829.99, 831.7, 1660.4, 4321.0];
    for samples in [COUNT, 2 * COUNT + 77] {
        let average = |hits: &[[Vec<f64>; 2]]| {
            let mut sums = FrfAverage::new(samples, RATE, ResponseKind::Displacement, 1).unwrap();
            for [force, response] in hits {
                sums.push(force, response).unwrap();
            }
            sums
        };
        for count in [1, 5] {
            let found = average(&hits[..count]).response(FrfEstimator::H1).unwrap();
            for frequency in frequencies {
                let off = found.receptance_at(frequency) / exact(&hits[..count], frequency) - 1.0;
                assert!(off.norm() < 1e-9, "{count} hits, {samples}, {frequency} Hz: {off}");
            }
        }
        for estimator in [FrfEstimator::H2, FrfEstimator::Hv(HvScaling::EqualRatios)] {
            let found = average(&hits[..1]).response(estimator).unwrap();
            let off = found.receptance_at(831.7) / exact(&hits[..1], 831.7) - 1.0;
            assert!(off.norm() < 1e-9, "{estimator:?}, {samples}: {off}");
        }
    }
}

/// Verified against the hits pushed one by one: averages of one and of five hits merge to that of
/// six, sums and deviations to rounding; an average of another length is rejected.
#[test]
fn merged_averages_are_those_of_all_hits() {
    let (whole, own) = noisy(6, 0.01, 0.01);
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let mut noise = Noise::new(42);
    let (mut first, mut others) = (estimator(1), estimator(1));
    for hit in 0..own.len() {
        let (f, x) = (noise.added_to(&force, 0.01), noise.added_to(&response, 0.01));
        let average = if hit == 0 { &mut first } else { &mut others };
        average.push(&f, &x).unwrap();
    }
    let mut merged = estimator(1);
    merged.merge(&first).unwrap();
    assert_eq!(
        merged.frf(FrfEstimator::H1).unwrap().values,
        first.frf(FrfEstimator::H1).unwrap().values
    );
    merged.merge(&others).unwrap();
    merged.merge(&estimator(1)).unwrap();
    assert_eq!(merged.averages(), 6);
    let near = |a: &[f64], b: &[f64]| {
        // Six terms, added in another order; the deviation is a small difference of them.
        a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-10)
    };
    assert!(near(&merged.coherence().unwrap().values, &whole.coherence().unwrap().values));
    let (a, b) = (merged.spread().unwrap(), whole.spread().unwrap());
    assert!(near(&a.mean, &b.mean) && near(&a.standard_deviation, &b.standard_deviation));
    let short = FrfAverage::new(COUNT / 2, RATE, ResponseKind::Displacement, 1).unwrap();
    assert!(matches!(merged.merge(&short), Err(SignalError::TooLong { .. })));
}

/// Verified against Parseval: the energy density integrates to the energy of the samples, the
/// power density to their mean square, padded or not. Exact up to the sum's rounding.
#[test]
fn densities_integrate_to_energy_and_power() {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let energy = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>() / RATE;
    for padding in [1, 3] {
        let mut average = estimator(padding);
        let stronger: Vec<f64> = force.iter().map(|x| 2.0 * x).collect();
        average.push(&force, &response).unwrap();
        average.push(&stronger, &response).unwrap();
        let step = average.frequency_hz()[1];
        let integral = |values: Vec<f64>| values.iter().sum::<f64>() * step;
        let found = integral(average.force_auto(SpectralDensity::Energy).unwrap());
        let expected = 0.5 * (energy(&force) + energy(&stronger));
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        let found = integral(average.response_auto(SpectralDensity::Energy).unwrap());
        assert!((found / energy(&response) - 1.0).abs() < 1e-12);
        let power = integral(average.response_auto(SpectralDensity::Power).unwrap());
        let mean_square = energy(&response) * RATE / COUNT as f64;
        assert!((power / mean_square - 1.0).abs() < 1e-12);
    }
}

/// Verified against the receptance of the response: without noise all estimators and the function of
/// each hit are equal to it, in all forms.
#[test]
fn without_noise_all_estimators_agree() {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let mut average = estimator(1);
    let own = average.push(&force, &response).unwrap();
    average.push(&force, &response).unwrap();
    let exact =
        FrequencyResponse::from_displacement(&force, &response, RATE).unwrap().receptance(1);
    let kinds = [
        FrfEstimator::H1,
        FrfEstimator::H2,
        FrfEstimator::Hv(HvScaling::EqualRatios),
        FrfEstimator::Hv(HvScaling::NoiseRatio(1e-6)),
    ];
    for kind in kinds {
        let found = average.frf(kind).unwrap();
        assert_eq!(found.form, FrfForm::Receptance);
        assert_eq!(found.frequency_hz, exact.frequency_hz);
        for (a, b) in found.values.iter().zip(&exact.values) {
            assert!((a / b - 1.0).norm() < 1e-12, "{kind:?}");
        }
    }
    assert_eq!(own.frequency_hz, exact.frequency_hz);
    for (a, b) in own.values.iter().zip(&exact.values) {
        assert!((a / b - 1.0).norm() < 1e-12);
    }
    let coherence = average.coherence().unwrap();
    assert!(coherence.values.iter().all(|g2| (g2 - 1.0).abs() < 1e-12));
    let spread = average.spread().unwrap();
    let k = bin(830.0);
    assert!((spread.mean[k] / exact.values[k].norm() - 1.0).abs() < 1e-13);
    assert!(spread.standard_deviation[k] < 1e-13 * spread.mean[k]);
    for form in FrfForm::ALL {
        assert_eq!(average.frf(FrfEstimator::H1).unwrap().to(form).form, form);
    }
}

/// Verified against the limits of total least squares: a response noise much larger gives H1,
/// much smaller gives H2, equal ratios their geometric mean; and against the defining
/// property, that H fits the smallest eigenvector of the spectral matrix.
#[test]
fn total_least_squares_has_h1_and_h2_as_limits() {
    let (average, _) = noisy(5, 2000.0, 2e-5);
    let at = |kind| average.frf(kind).unwrap().values[bin(700.0)];
    let (h1, h2) = (at(FrfEstimator::H1), at(FrfEstimator::H2));
    assert!(h2.norm() > 1.01 * h1.norm(), "the noise matters: {h1} {h2}");
    let hv = |ratio| at(FrfEstimator::Hv(HvScaling::NoiseRatio(ratio)));
    assert!((hv(1e3) / h1 - 1.0).norm() < 1e-9);
    assert!((hv(1e-16) / h2 - 1.0).norm() < 1e-9);
    let mean = at(FrfEstimator::Hv(HvScaling::EqualRatios));
    assert!((mean.norm() / (h1.norm() * h2.norm()).sqrt() - 1.0).abs() < 1e-12);
    assert!((mean / h1).arg().abs() < 1e-12 && (h2 / h1).arg().abs() < 1e-12);

    let s = 1e-8;
    let h = hv(s) / s;
    let k = bin(700.0);
    let gff = average.force_auto(SpectralDensity::Energy).unwrap()[k];
    let gxx = average.response_auto(SpectralDensity::Energy).unwrap()[k] / (s * s);
    let gfx: Complex64 = average.cross(SpectralDensity::Energy).unwrap()[k] / s;
    // (1, h) is an eigenvector of [[Gff, conj(Gfx)], [Gfx, Gxx]]; the sum is the larger root.
    let first = gff + gfx.conj() * h;
    let second = gfx + gxx * h;
    assert!((second / (first * h) - 1.0).norm() < 1e-12);
    assert!(first.re > 0.5 * (gff + gxx));
}

/// Verified against the expectations of many hits: H1 is low by 1 + Gnn/Gff with
/// noise on the force and right with noise on the response, H2 the reverse, Hv with the true
/// ratio right in both. 400 hits, averaged over 20 bins: errors of the mean below
/// 0.3 / sqrt(8000) = 0.4 %, asserted to 1.5 %.
#[test]
fn each_estimator_is_unbiased_under_its_noise() {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let exact =
        FrequencyResponse::from_displacement(&force, &response, RATE).unwrap().receptance(1);
    let bins = bin(780.0)..bin(880.0);
    let ratio = |average: &FrfAverage, kind| {
        let found = average.frf(kind).unwrap();
        let each = bins.clone().map(|k| (found.values[k] / exact.values[k]).re);
        each.sum::<f64>() / bins.len() as f64
    };
    // dt^2 N s^2 of noise on |F|^2 = 1.
    let share = 0.1_f64;
    let force_noise = (share * RATE * RATE / COUNT as f64).sqrt();
    let (on_force, _) = noisy(400, force_noise, 0.0);
    assert!((ratio(&on_force, FrfEstimator::H1) * (1.0 + share) - 1.0).abs() < 0.015);
    assert!((ratio(&on_force, FrfEstimator::H2) - 1.0).abs() < 0.015);

    let response_noise = 0.05 * exact.values[bin(830.0)].norm() * RATE / (COUNT as f64).sqrt();
    let (on_response, _) = noisy(400, 0.0, response_noise);
    assert!((ratio(&on_response, FrfEstimator::H1) - 1.0).abs() < 0.015);
    assert!(ratio(&on_response, FrfEstimator::H2) > 1.01);

    let (on_both, _) = noisy(400, force_noise, response_noise);
    let true_ratio = FrfEstimator::Hv(HvScaling::NoiseRatio(response_noise / force_noise));
    assert!((ratio(&on_both, true_ratio) - 1.0).abs() < 0.015);
    assert!(ratio(&on_both, FrfEstimator::H1) < 0.93);
}

/// Verified against the scatter of many averages: the stated random errors of |H1| and its phase
/// are the deviations of 200 averages of 8 noisy hits, and the spread over hits is the
/// error of one hit. A deviation from 200 has an error of 5 %; asserted within 15 %.
#[test]
fn random_errors_are_those_of_many_averages() {
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    let exact =
        FrequencyResponse::from_displacement(&force, &response, RATE).unwrap().receptance(1);
    let k = bin(845.0);
    let deviation = 0.2 * exact.values[k].norm() * RATE / (COUNT as f64).sqrt();
    let mut noise = Noise::new(9);
    let (runs, hits) = (200, 8);
    let (mut magnitudes, mut phases, mut stated) = (0.0, 0.0, 0.0);
    let mut spread = 0.0;
    for _ in 0..runs {
        let mut average = estimator(1);
        for _ in 0..hits {
            average.push(&force, &noise.added_to(&response, deviation)).unwrap();
        }
        let found = average.frf(FrfEstimator::H1).unwrap().values[k] / exact.values[k];
        magnitudes += (found.norm() - 1.0).powi(2);
        phases += found.arg().powi(2);
        let coherence = average.coherence().unwrap();
        assert_eq!(coherence.magnitude_error()[k], coherence.phase_error()[k]);
        stated += coherence.magnitude_error()[k].powi(2);
        spread +=
            (average.spread().unwrap().standard_deviation[k] / exact.values[k].norm()).powi(2);
    }
    let root = |sum: f64| (sum / f64::from(runs)).sqrt();
    assert!(
        (root(magnitudes) / root(stated) - 1.0).abs() < 0.15,
        "{} {}",
        root(magnitudes),
        root(stated)
    );
    assert!((root(phases) / root(stated) - 1.0).abs() < 0.15);
    let one = root(stated) * f64::from(hits).sqrt();
    assert!((root(spread) / one - 1.0).abs() < 0.15, "{} {one}", root(spread));
}

/// Verified against the two-pass mean and deviation of the hits' own functions.
#[test]
fn the_spread_is_that_of_the_hits() {
    let (average, own) = noisy(6, 500.0, 1e-6);
    let spread = average.spread().unwrap();
    for k in (1..COUNT / 2).step_by(131) {
        let magnitudes: Vec<f64> = own.iter().map(|frf| frf.values[k].norm()).collect();
        let mean = magnitudes.iter().sum::<f64>() / 6.0;
        let square = magnitudes.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 5.0;
        assert!((spread.mean[k] / mean - 1.0).abs() < 1e-13);
        assert!((spread.standard_deviation[k] / square.sqrt() - 1.0).abs() < 1e-10);
    }
}

/// Verified against the documentation: one hit has no coherence, no hit has no average, and invalid
/// hits are rejected without being added.
#[test]
fn quantities_without_enough_hits_are_rejected() {
    let mut average = estimator(1);
    let few =
        |quantity, averages, needed| SignalError::TooFewAverages { quantity, averages, needed };
    let none = average.frf(FrfEstimator::H1).unwrap_err();
    assert_eq!(none, few("frequency response function", 0, 1));
    assert_eq!(average.force_mask(0.02).unwrap_err(), few("force mask", 0, 1));
    assert_eq!(
        average.force_auto(SpectralDensity::Energy).unwrap_err(),
        few("auto spectrum", 0, 1)
    );
    let (force, response) = impulse_response(&[MODE], RATE, COUNT);
    average.push(&force, &response).unwrap();
    assert_eq!(average.coherence().unwrap_err(), few("coherence", 1, 2));
    assert_eq!(average.spread().unwrap_err(), few("spread", 1, 2));
    let ratio = FrfEstimator::Hv(HvScaling::NoiseRatio(0.0));
    assert!(matches!(average.frf(ratio), Err(SignalError::Option { .. })));

    let before = average.frf(FrfEstimator::H1).unwrap();
    let long = vec![1.0; COUNT + 1];
    assert_eq!(
        average.push(&long, &long),
        Err(SignalError::TooLong { samples: COUNT + 1, limit: COUNT })
    );
    assert!(matches!(
        average.push(&force, &response[1..]),
        Err(SignalError::LengthMismatch { .. })
    ));
    assert_eq!(average.push(&[0.0; 9], &[1.0; 9]), Err(SignalError::NoForce { samples: 9 }));
    assert!(matches!(average.push(&[1.0], &[f64::NAN]), Err(SignalError::NotFinite { .. })));
    assert_eq!((average.averages(), average.frf(FrfEstimator::H1).unwrap()), (1, before));
    let new =
        |samples, padding| FrfAverage::new(samples, RATE, ResponseKind::Displacement, padding);
    assert!(matches!(new(0, 1), Err(SignalError::Empty { .. })));
    assert!(matches!(new(10, 0), Err(SignalError::Padding { .. })));
    assert!(matches!(new(usize::MAX, 2), Err(SignalError::TooLong { .. })));
}

/// Verified against SciPy's cross and auto spectral densities of three measured hits (see
/// fixtures/reference/hammer): agreement to 1e-9, where rounding alone would give 1e-12.
#[test]
fn measured_hits_give_the_reference() {
    let Some(hits) = measured::hits("measured_hits_give_the_reference") else {
        return;
    };
    let mut average =
        FrfAverage::new(25_600, measured::RATE, ResponseKind::Acceleration, 1).unwrap();
    for (force, response) in &hits {
        average.push(force, response).unwrap();
    }
    let table = include_str!("../../../../fixtures/reference/hammer/reference.csv");
    let (h1, h2) = (average.frf(FrfEstimator::H1).unwrap(), average.frf(FrfEstimator::H2).unwrap());
    assert_eq!(h1.form, FrfForm::Accelerance);
    let coherence = average.coherence().unwrap();
    let force = average.force_auto(SpectralDensity::Power).unwrap();
    let response = average.response_auto(SpectralDensity::Power).unwrap();
    let mask = average.force_mask(0.02).unwrap();
    let mut rows = 0;
    for line in table.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let k = row[0] as usize;
        assert!((h1.frequency_hz[k] - row[0]).abs() < 1e-9 && mask.valid[k]);
        let close = |a: Complex64, re: f64, im: f64| (a / Complex64::new(re, im) - 1.0).norm();
        assert!(close(h1.values[k], row[1], row[2]) < 1e-9, "H1 at {} Hz", row[0]);
        assert!(close(h2.values[k], row[3], row[4]) < 1e-9, "H2 at {} Hz", row[0]);
        assert!((coherence.values[k] / row[5] - 1.0).abs() < 1e-9);
        assert!((force[k] / row[6] - 1.0).abs() < 1e-9);
        assert!((response[k] / row[7] - 1.0).abs() < 1e-9);
        rows += 1;
    }
    assert_eq!(rows, 40);
}
