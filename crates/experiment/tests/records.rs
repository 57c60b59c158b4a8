//! Records with offsets, starts apart, several parts and bad samples.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;

use asperity_experiment::{
    AnalysisError, AnalysisOptions, FrequencyBand, RejectedHit, ResponseAnalysis, analyse, convert,
    inspect,
};
use asperity_measure::{InvalidCells, ReadOptions};
use tempfile::TempDir;

const RATE: f64 = 10_000.0;

/// Force and acceleration of a mode of 1 kg at 300 Hz with 2 % damping, hit every half second.
fn hit_mode(hits: usize) -> (Vec<f64>, Vec<f64>) {
    hit_mode_at(RATE, hits)
}

/// The same at any rate.
fn hit_mode_at(rate: f64, hits: usize) -> (Vec<f64>, Vec<f64>) {
    let (omega, damping, step) = (TAU * 300.0, 0.02, 1.0 / rate);
    let (mut u, mut v) = (0.0, 0.0);
    let sample = |n: usize| {
        let since = (n as f64 * step) % 0.5 - 0.02;
        let f = if (0.0..2e-3).contains(&since) { 10.0 * (PI * since / 2e-3).sin() } else { 0.0 };
        let a = f - 2.0 * damping * omega * v - omega * omega * u;
        v += a * step;
        u += v * step;
        (f, a)
    };
    (0..(hits as f64 * 0.5 * rate) as usize).map(sample).unzip()
}

fn store(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// A text with a time for each channel, the response `late` samples after the force.
fn text(force: &[f64], response: &[f64], late: usize) -> String {
    let mut text = String::from("t_hammer (s),hammer (N),t_top (s),top (m/s^2)\n");
    for (n, (f, a)) in force.iter().zip(&response[late..]).enumerate() {
        let (t, own) = (n as f64 / RATE, (n + late) as f64 / RATE);
        let _ = writeln!(text, "{t:.4},{f},{own:.4},{a}");
    }
    text
}

fn only(file: &PathBuf, options: &AnalysisOptions) -> Result<ResponseAnalysis, AnalysisError> {
    analyse(std::slice::from_ref(file), options).map(|mut found| found.responses.remove(0))
}

fn peak(found: &ResponseAnalysis) -> (f64, f64) {
    let first = found.report.average.fundamental.unwrap();
    (first.frequency_hz, first.magnitude)
}

/// Verified against the same samples at one start, for blocks of any size.
#[test]
fn starts_apart_are_lined_up() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(2);
    let together = store(&folder, "a.csv", &text(&force, &response, 0));
    let apart = store(&folder, "b.csv", &text(&force, &response, 37));
    let (f1, a1) = peak(&only(&together, &AnalysisOptions::default()).unwrap());
    assert!((f1 - 300.0).abs() < 3.0 && a1 > 0.0);
    for block in [100, 1 << 16] {
        let reading = ReadOptions { block, ..ReadOptions::default() };
        let options = AnalysisOptions { reading, ..AnalysisOptions::default() };
        let found = only(&apart, &options).unwrap();
        let (own_f1, own_a1) = peak(&found);
        assert!((own_f1 / f1 - 1.0).abs() < 1e-5 && (own_a1 / a1 - 1.0).abs() < 1e-4, "{own_a1}");
        let notices = &found.report.notices;
        assert!(notices.iter().any(|notice| notice.contains("lined up by their starts")));
    }
}

/// Verified against the same signals at common times: starts a quarter of a sample apart, and half the
/// rate for the response, in blocks of any size.
#[test]
fn channels_at_other_times_are_resampled() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode_at(4.0 * RATE, 2);
    let every = |samples: &[f64], from: usize, step: usize| -> Vec<f64> {
        samples.iter().skip(from).step_by(step).copied().collect()
    };
    let (own_force, own) = (every(&force, 0, 4), every(&response, 0, 4));
    let reference = store(&folder, "a.csv", &text(&own_force, &own, 0));
    let band = Some(FrequencyBand { low_hz: 200.0, high_hz: 400.0 });
    let options = AnalysisOptions { band_hz: band, ..AnalysisOptions::default() };
    let (f1, a1) = peak(&only(&reference, &options).unwrap());
    for (name, from, step) in [("quarter.csv", 1, 4), ("half.csv", 0, 8), ("both.csv", 3, 8)] {
        let mut table = String::from("t_hammer (s),hammer (N),t_top (s),top (m/s^2)\n");
        let own = every(&response, from, step);
        for (n, f) in own_force.iter().enumerate() {
            let t = n as f64 / RATE;
            let _ = match own.get(n) {
                Some(a) => {
                    let own = (from + n * step) as f64 / (4.0 * RATE);
                    writeln!(table, "{t:.6},{f},{own:.6},{a}")
                }
                None => writeln!(table, "{t:.6},{f},,"),
            };
        }
        let file = store(&folder, name, &table);
        for block in [100, 1 << 16] {
            let reading = ReadOptions { block, ..ReadOptions::default() };
            let found = only(&file, &AnalysisOptions { reading, ..options.clone() }).unwrap();
            let (own_f1, own_a1) = peak(&found);
            assert!((own_f1 / f1 - 1.0).abs() < 1e-4, "{name}: {own_f1} {f1}");
            assert!((own_a1 / a1 - 1.0).abs() < 2e-3, "{name}: {own_a1} {a1}");
            let told = |notice: &String| notice.contains("resampled at common times");
            assert!(found.report.notices.iter().any(told), "{:?}", found.report.notices);
        }
    }
}

#[test]
fn rates_and_starts_that_do_not_fit_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (force, _) = hit_mode(1);
    let mut rates = String::from("time 1 (s),hammer (N),time 2 (s),top (m/s^2)\n");
    for (n, f) in force.iter().enumerate().take(400) {
        let _ = writeln!(rates, "{:.4},{},{:.5},{}", n as f64 / RATE, f, n as f64 / 4e3, n % 7);
    }
    let message = |text: &str| {
        only(&store(&folder, "c.csv", text), &AnalysisOptions::default()).unwrap_err().to_string()
    };
    let rates = message(&rates);
    assert!(rates.contains("not sampled together"), "{rates}");
    assert!(rates.contains("at 10000.000000 Hz") && rates.contains("at 4000.000000 Hz"), "{rates}");
    // No common time.
    let mut later = String::from("time 1 (s),hammer (N),time 2 (s),top (m/s^2)\n");
    for (n, f) in force.iter().enumerate().take(400) {
        let t = n as f64 / RATE;
        let _ = writeln!(later, "{t:.4},{},{:.4},{}", f, t + 10.0, n % 7);
    }
    let later = message(&later);
    assert!(
        later.contains("not sampled together") && later.contains("from 10.000000 s"),
        "{later}"
    );
}

/// An offset of the response takes neither the band nor the peak away; a drift goes by the high-pass.
#[test]
fn offsets_and_drifts_of_the_response() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(1);
    let exact = store(&folder, "d.csv", &text(&force, &response, 0));
    let exact = peak(&only(&exact, &AnalysisOptions::default()).unwrap());
    let largest = response.iter().copied().fold(0.0, f64::max);
    let mut state = 1_u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5) * 2e-4 * largest
    };
    let noisy: Vec<f64> = response.iter().map(|a| a + noise()).collect();
    for part in [0.006, 0.05, -0.3] {
        let shifted: Vec<f64> = noisy.iter().map(|a| a + part * largest).collect();
        let file = store(&folder, "e.csv", &text(&force, &shifted, 0));
        let found = only(&file, &AnalysisOptions::default()).unwrap();
        let (f1, a1) = peak(&found);
        assert!(
            (f1 - exact.0).abs() < 0.1 && (a1 / exact.1 - 1.0).abs() < 0.01,
            "{part}: {f1} {a1}"
        );
        let [low, _] = found.report.settings.band_hz.unwrap();
        assert!(low >= RATE / force.len() as f64, "resolved by the record");
    }
    let drift = |n: usize| 0.5 * largest * (TAU * 0.7 * n as f64 / RATE).sin();
    let drifting: Vec<f64> = noisy.iter().enumerate().map(|(n, a)| a + drift(n)).collect();
    let file = store(&folder, "f.csv", &text(&force, &drifting, 0));
    let options = AnalysisOptions { high_pass_hz: Some(10.0), ..AnalysisOptions::default() };
    let (f1, a1) = peak(&only(&file, &options).unwrap());
    assert!((f1 - exact.0).abs() < 0.1 && (a1 / exact.1 - 1.0).abs() < 0.01, "{f1} {a1}");
}

/// A hit with cells that are no number is told, as dropout or overload, and the others are averaged.
#[test]
fn no_hit_is_lost_for_a_cell() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(3);
    let good = text(&force, &response, 0);
    let lines: Vec<&str> = good.lines().collect();
    let at = 260;
    let broken: Vec<String> = lines
        .iter()
        .enumerate()
        .map(|(n, line)| match line.rsplit_once(',') {
            Some((kept, _)) if n == at => format!("{kept},OVL"),
            _ => (*line).to_owned(),
        })
        .collect();
    let file = store(&folder, "g.csv", &broken.join("\n"));
    let error = only(&file, &AnalysisOptions::default()).unwrap_err().to_string();
    assert!(error.contains(&format!("line {}: `OVL` for `top`", at + 1)), "{error}");
    let to = folder.path().join("g.npz");
    let converted = convert(&file, &to, &asperity_experiment::ConvertOptions::default());
    assert!(converted.unwrap_err().to_string().contains("is no number"));
    for (invalid_cells, word) in
        [(InvalidCells::Dropout, "dropout"), (InvalidCells::Overload, "overload")]
    {
        let reading = ReadOptions { invalid_cells, ..ReadOptions::default() };
        let options = AnalysisOptions { reading, ..AnalysisOptions::default() };
        let found = only(&file, &options).unwrap();
        let hits = &found.report.hits;
        assert_eq!((hits.len(), found.report.average.excluded.clone()), (3, vec![1]));
        assert!(hits[0].issues[0].starts_with(word), "{:?}", hits[0].issues);
        assert_eq!((hits[0].dropout, hits[0].overload), (word == "dropout", word == "overload"));
    }
}

#[test]
fn rejected_hits_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(4);
    let file = store(&folder, "h.csv", &text(&force, &response, 0));
    let rejected =
        |rejected| only(&file, &AnalysisOptions { rejected, ..AnalysisOptions::default() });
    let at = RejectedHit::At { file: file.display().to_string(), time_s: 1.0202 };
    let found = rejected(vec![RejectedHit::Number(1), at]).unwrap();
    assert_eq!(found.report.average.excluded, [1, 3]);
    assert_eq!(found.report.average.hits, 2);
    assert_eq!(found.report.hits[2].issues, ["rejected"]);
    let error = rejected(vec![RejectedHit::Number(5)]).unwrap_err();
    assert_eq!(error.to_string(), "hit 5 cannot be rejected: there are 4 hits");
}

/// A response in another record is named with the reason; options name channels that exist.
#[test]
fn channels_elsewhere_and_names_of_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let header = |name: &str, kind: u32, unit: &str, points: usize, step: &str| {
        format!(
            "    -1\n    58\n{name}\nNONE\nNONE\nNONE\nNONE\n    1         0    0         0 NONE{:15}0   0 NONE{:15}0   0\n{:>10}{points:>10}{:>10}  0.00000E+00{step:>13}  0.00000E+00\n{:>10}    0    0    0 {:21}{:20}\n{kind:>10}    0    0    0 {:21}{unit:20}\n{:>10}    0    0    0 NONE                 NONE                \n{:>10}    0    0    0 NONE                 NONE                \n",
            "", "", 2, 1, 17, "Time", "s", "Y", 0, 0
        )
    };
    let numbers = |points: usize| "  1.00000E+00\n".repeat(points) + "    -1\n";
    let file = header("hammer", 13, "N", 12, "1.00000E-03")
        + &numbers(12)
        + &header("top", 12, "m/s^2", 6, "2.00000E-03")
        + &numbers(6);
    let path = store(&folder, "i.uff", &file);
    let error = only(&path, &AnalysisOptions::default()).unwrap_err().to_string();
    assert!(error.contains("the response `top` is in record 2"), "{error}");
    assert!(error.contains("1000 Hz and 500 Hz"), "{error}");
    let found = inspect(&path, &AnalysisOptions::default()).unwrap();
    assert!(found.response.text.contains("`top` is in record 2"), "{}", found.response.text);

    let volts = store(&folder, "j.csv", "time_s,hammer [V],top [V]\n0,0,0\n0.001,1,1\n0.002,0,1\n");
    let options = AnalysisOptions {
        sensitivities: vec!["Hamer=2mV/N".parse().unwrap()],
        ..AnalysisOptions::default()
    };
    let error = only(&volts, &options).unwrap_err().to_string();
    assert!(error.contains("option `sensitivity` names `Hamer`"), "{error}");
    assert!(error.contains("did you mean `hammer`?"), "{error}");
    let reading =
        ReadOptions { names: vec!["force".to_owned()], complete: true, ..ReadOptions::default() };
    let options = AnalysisOptions { reading, ..AnalysisOptions::default() };
    let error = only(&volts, &options).unwrap_err().to_string();
    assert!(error.contains("`names` is a list of 1; expected 2"), "{error}");
}

/// A notice of many files is said once.
#[test]
fn notices_of_many_files_are_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(1);
    let rounded = text(&force, &response, 0).replace("t_hammer (s)", "x");
    let rounded = rounded.replace("x,hammer (N),t_top (s)", "t (s),hammer (N),note");
    let files: Vec<PathBuf> =
        (0..4).map(|n| store(&folder, &format!("k{n}.csv"), &rounded)).collect();
    let found = analyse(&files, &AnalysisOptions::default()).unwrap();
    let notices = &found.responses[0].report.notices;
    let no_unit: Vec<&String> = notices.iter().filter(|one| one.contains("has no unit")).collect();
    assert_eq!(no_unit.len(), 1, "{notices:?}");
    assert!(no_unit[0].contains("k0.csv and 3 more: channel `note` has no unit"), "{no_unit:?}");
}

/// Functions of a universal file become real and imaginary parts in a text.
#[test]
fn functions_of_frequency_are_converted() {
    let folder = tempfile::tempdir().unwrap();
    let (force, response) = hit_mode(1);
    let hits = store(&folder, "l.csv", &text(&force, &response, 0));
    let options = AnalysisOptions { keep_frfs: true, ..AnalysisOptions::default() };
    let analysis = analyse(&[hits], &options).unwrap();
    let record = analysis.frf_record(false);
    let (uff, csv) = (folder.path().join("l.uff"), folder.path().join("l2.csv"));
    let writing = asperity_measure::WriteOptions::default();
    let format = asperity_measure::Format::UniversalBinary;
    asperity_measure::write(&uff, std::slice::from_ref(&record), format, &writing).unwrap();
    let done = convert(&uff, &csv, &asperity_experiment::ConvertOptions::default()).unwrap();
    assert_eq!(done.records, 1);
    let read = asperity_measure::read(&csv, &ReadOptions::default()).unwrap();
    let asperity_measure::Samples::Complex(values) = &record.channels[0].samples else {
        panic!("a function")
    };
    let real: Vec<f64> = values.iter().map(|value| value.re).collect();
    assert_eq!(read.records[0].channels[0].samples.real(), Some(&real[..]));
    let error = only(&uff, &AnalysisOptions::default()).unwrap_err().to_string();
    assert!(error.contains("functions of frequency are no hits"), "{error}");
}
