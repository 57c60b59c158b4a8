//! The numbers behind `--estimator`, `--form` and `--window exponential`.

use std::f64::consts::TAU;
use std::path::Path;

use asperity_measure::Format;
use asperity_signal::Complex64;

use super::exact::{blows, noisy, record};
use super::hammer::{DAMPING, MASS, NATURAL_HZ};
use super::store;
use crate::{answer, asperity, number, text};

/// A row of `frf.csv`: frequency, value, coherence, and whether the force has content.
struct Line {
    frequency_hz: f64,
    value: Complex64,
    coherence: f64,
    valid: bool,
}

/// `frf.csv` of an analysis with these options.
fn lines(folder: &Path, options: &[&str]) -> Vec<Line> {
    let asked = [&["analyse", "test.uff", "--overwrite", "--json", "--out", "a"], options].concat();
    let found = answer(folder, &asked);
    assert_eq!(found["average"]["hits"], found["hits"].as_array().unwrap().len());
    let text = std::fs::read_to_string(folder.join("a/frf.csv")).unwrap();
    let line = |line: &str| {
        // Zero frequency has no receptance, and its row no numbers.
        let numbers: Vec<f64> =
            line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        let [frequency_hz, real, imag, magnitude, phase, coherence, valid] = numbers[..] else {
            panic!("{line}");
        };
        let value = Complex64::new(real, imag);
        let polar = Complex64::from_polar(magnitude, phase);
        assert!(value.is_nan() || (polar - value).norm() <= 1e-12 * magnitude, "{line}");
        Line { frequency_hz, value, coherence, valid: valid == 1.0 }
    };
    text.lines().skip(1).map(line).skip(1).collect()
}

/// Six hits with noise on both signals.
fn noisy_test(folder: &Path, noise: f64) {
    let signals = blows(DAMPING, &[10.0, 14.0, 18.0, 22.0, 26.0, 30.0]);
    let largest = signals[3].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let (force, motion) =
        (noisy(&signals[0], 5.0 * noise, 1), noisy(&signals[3], noise * largest, 2));
    store(
        folder,
        "test.uff",
        record(&force, "top", "m/s^2", &motion, 1.0),
        Format::UniversalBinary,
    );
}

/// Verified against the definitions, at every line with force: `H1 / H2` is the coherence, `Hv` with
/// equal noise ratios their geometric mean, and the three have one phase; all to the rounding of
/// some products. The noise is there: the coherence falls below 0.9 somewhere.
#[test]
fn estimators_are_ordered_by_the_coherence() {
    let folder = tempfile::tempdir().unwrap();
    noisy_test(folder.path(), 0.01);
    let of = |name: &str| lines(folder.path(), &["--estimator", name]);
    let [h1, h2, hv] = ["h1", "h2", "hv"].map(of);
    let mut least: f64 = 1.0;
    let mut seen = 0;
    for ((h1, h2), hv) in h1.iter().zip(&h2).zip(&hv).filter(|((line, _), _)| line.valid) {
        let squared = h1.coherence;
        assert!((h1.value / h2.value - squared).norm() < 1e-12, "{} Hz", h1.frequency_hz);
        let (low, high, mean) = (h1.value.norm(), h2.value.norm(), hv.value.norm());
        assert!((mean * mean / (low * high) - 1.0).abs() < 1e-12, "{} Hz", h1.frequency_hz);
        assert!(low <= mean && mean <= high);
        assert!((hv.value / h1.value).arg().abs() < 1e-12);
        least = least.min(squared);
        seen += 1;
    }
    assert!(seen > 200 && least < 0.9, "{seen} lines, coherence from {least}");
}

/// Verified against the definition: mobility is `i w`, accelerance `-w^2` times the receptance.
/// And against the mode: within 2 % (noise) of `1 / (2 zeta w0 m)` at the mobility's top.
#[test]
fn forms_differ_by_powers_of_i_omega() {
    let folder = tempfile::tempdir().unwrap();
    noisy_test(folder.path(), 0.01);
    let of = |name: &str| lines(folder.path(), &["--form", name]);
    let [receptance, mobility, accelerance] = ["receptance", "mobility", "accelerance"].map(of);
    let mut top: f64 = 0.0;
    for ((h, y), a) in receptance.iter().zip(&mobility).zip(&accelerance) {
        let turn = Complex64::new(0.0, TAU * h.frequency_hz);
        assert!((y.value / (h.value * turn) - 1.0).norm() < 1e-13, "{} Hz", h.frequency_hz);
        assert!((a.value / (h.value * turn * turn) - 1.0).norm() < 1e-13);
        let near = (h.frequency_hz / NATURAL_HZ - 1.0).abs() < 0.1;
        top = if near { top.max(y.value.norm()) } else { top };
    }
    let exact = 1.0 / (2.0 * DAMPING * TAU * NATURAL_HZ * MASS);
    // Lines 2 Hz apart miss the top by at most 1 Hz of a half width of 8.3 Hz: 0.7 %.
    assert!((top / exact - 1.0).abs() < 0.02, "{top} {exact}");
}

/// Verified against the mode, cut off after half a second where it has fallen to exp(-5.2) only: a
/// window of 0.08 s more than doubles the damping, and what is written is right within 1 % again, as
/// are frequency and height. Displacement, velocity and acceleration.
#[test]
fn an_exponential_window_is_undone() {
    let folder = tempfile::tempdir().unwrap();
    let damping = 0.002;
    let signals = blows(damping, &[20.0]);
    let height = 1.0 / (2.0 * MASS * damping * (TAU * NATURAL_HZ).powi(2));
    for (unit, place) in [("m", 1), ("m/s", 2), ("m/s^2", 3)] {
        let test = record(&signals[0], "top", unit, &signals[place], 1.0);
        store(folder.path(), "test.uff", test, Format::UniversalBinary);
        let asked =
            ["analyse", "test.uff", "--window", "exponential:0.08", "--overwrite", "--json"];
        let found = answer(folder.path(), &asked);
        assert_eq!(number(&found, "/settings/exponential_window_s"), 0.08);
        let first = |key: &str| number(&found, &format!("/hits/0/fundamental/{key}"));
        for ratio in ["damping_ratio", "damping_ratio_circle", "damping_ratio_decrement"] {
            assert!((first(ratio) / damping - 1.0).abs() < 0.01, "{unit} {ratio} {}", first(ratio));
        }
        assert!((first("frequency_hz") / NATURAL_HZ - 1.0).abs() < 1e-4, "{unit}");
        assert!((first("magnitude") / height - 1.0).abs() < 0.01, "{unit} {}", first("magnitude"));
    }
}

/// The average of one hit is that hit, with every window, and also where the length asked for is
/// longer than the record; an average of several lies between them.
#[test]
fn an_average_is_refined_and_corrected_as_its_hits_are() {
    let folder = tempfile::tempdir().unwrap();
    let keys = ["frequency_hz", "magnitude", "damping_ratio", "damping_ratio_circle"];
    let analysed = |options: &[&str]| {
        let asked =
            [&["analyse", "test.uff", "--band", "700:1000", "--overwrite", "--json"], options];
        answer(folder.path(), &asked.concat())
    };
    let one = blows(DAMPING, &[20.0]);
    let stored = |signals: [&[f64]; 2]| {
        let test = record(signals[0], "top", "m/s^2", signals[1], 1.0);
        store(folder.path(), "test.uff", test, Format::UniversalBinary);
    };
    stored([&one[0], &one[3]]);
    for window in ["none", "force", "exponential:0.08", "force+exponential"] {
        for length in [&[][..], &["--length", "20"]] {
            let found = analysed(&[&["--window", window], length].concat());
            for key in keys {
                let of_hit = number(&found, &format!("/hits/0/fundamental/{key}"));
                let of_average = number(&found, &format!("/average/fundamental/{key}"));
                let off = (of_average / of_hit - 1.0).abs();
                assert!(off < 1e-7, "{window} {length:?} {key}: {of_average} {of_hit}");
            }
        }
    }
    noisy_test(folder.path(), 1e-3);
    for window in ["none", "exponential:0.08"] {
        let found = analysed(&["--window", window]);
        for key in keys {
            let hits = found["hits"].as_array().unwrap().iter();
            let of_hits: Vec<f64> =
                hits.map(|hit| number(hit, &format!("/fundamental/{key}"))).collect();
            let low = of_hits.iter().copied().fold(f64::INFINITY, f64::min);
            let high = of_hits.iter().copied().fold(0.0, f64::max);
            let of_average = number(&found, &format!("/average/fundamental/{key}"));
            assert!(
                low <= of_average && of_average <= high,
                "{window} {key}: {of_average} {of_hits:?}"
            );
        }
    }
}

/// Each fault of the data is said in words: a file twice, more names than channels, levels that do
/// not average, a clipped response.
#[test]
fn doubtful_data_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let notices = |arguments: &[&str]| {
        let asked = [&["analyse"], arguments, &["--overwrite", "--json", "--out", "a"]].concat();
        let found = answer(folder.path(), &asked);
        let hits = found["hits"].as_array().unwrap().iter();
        let of_hits = hits.flat_map(|hit| hit["verdicts"].as_array().unwrap().clone());
        let all = found["notices"].as_array().unwrap().iter().cloned().chain(of_hits);
        all.map(|text| text.as_str().unwrap().to_owned()).collect::<Vec<String>>()
    };
    let says = |found: &[String], words: &str| found.iter().any(|text| text.contains(words));
    let stored = |name: &str, signals: [&[f64]; 2]| {
        let test = record(signals[0], "top", "m/s^2", signals[1], 1.0);
        store(folder.path(), name, test, Format::UniversalBinary);
    };
    let good = blows(DAMPING, &[20.0, 20.5]);
    stored("a.uff", [&good[0], &good[3]]);
    std::fs::copy(folder.path().join("a.uff"), folder.path().join("b.uff")).unwrap();
    assert_eq!(notices(&["a.uff", "--band", "700:1000"]), Vec::<String>::new());
    let found = notices(&["a.uff", "b.uff", "--band", "700:1000"]);
    assert!(says(&found, "a.uff and b.uff hold the same bytes"), "{found:?}");
    for names in ["hammer,top,side,base", "hammer"] {
        let output = asperity(folder.path(), &["analyse", "a.uff", "--names", names]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2));
        assert!(error.contains("expected 2, one for each channel (`hammer`, `top`)"), "{error}");
    }

    // A weak blow and a strong one whose response is half of the linear.
    let levels = blows(DAMPING, &[10.0, 30.0]);
    let half = levels[3].len() / 2;
    let motion: Vec<f64> = (0..levels[3].len())
        .map(|n| if n < half { levels[3][n] } else { -0.5 * levels[3][n] })
        .collect();
    stored("mixed.uff", [&levels[0], &motion]);
    let found = notices(&["mixed.uff", "--band", "700:1000"]);
    assert!(says(&found, "average over levels"), "{found:?}");

    let largest = good[3].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    // At the limit, but never two samples in a row: no flat top.
    let limit = 0.5 * largest;
    let mut clipped: Vec<f64> = good[3].iter().map(|x| x.clamp(-limit, limit)).collect();
    for n in 1..clipped.len() {
        if clipped[n].abs() == limit && clipped[n - 1].abs() > 0.9 * limit {
            clipped[n] *= 0.95 + 0.01 * (n as f64).sin();
        }
    }
    stored("clipped.uff", [&good[0], &clipped]);
    let found = notices(&["clipped.uff", "--band", "700:1000", "--keep-all"]);
    assert!(says(&found, ", a limit, "), "{found:?}");
}
