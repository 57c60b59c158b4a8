//! Frequency response functions as files, read here and by other programs.

use std::path::Path;
use std::process::Command;

use asperity_measure::{Abscissa, Channel, Format, ReadOptions, Samples, read};
use asperity_signal::Complex64;

use super::{store, test_record};
use crate::{answer, asperity, text};

/// All functions of a file; those of one pair of nodes are records of their own.
fn functions(file: &Path) -> Vec<Channel> {
    let found = read(file, &ReadOptions::default()).unwrap();
    found.records.into_iter().flat_map(|record| record.channels).collect()
}

fn complex(channel: &Channel) -> &[Complex64] {
    let Samples::Complex(values) = &channel.samples else { panic!("real samples") };
    values
}

/// Functions of any file are drawn with their names and units; a file of samples has none.
#[test]
fn functions_of_a_file_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", test_record(), Format::UniversalBinary);
    for format in ["uff", "npz"] {
        let asked = ["analyse", &file, "--frfs", format, "--form", "mobility", "--out", format];
        answer(folder.path(), &[&asked[..], &["--json"]].concat());
        let functions = format!("{format}/frfs.{format}");
        let draw = |more: &[&str]| {
            asperity(folder.path(), &[&["inspect", &functions, "--draw", "frf.svg"], more].concat())
        };
        let output = draw(&["--overwrite"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let figure = std::fs::read_to_string(folder.path().join("frf.svg")).unwrap();
        for part in ["Receptance (m/N)", "Frequency (Hz)", "Phase (°)", "average H1", "hit 1"] {
            assert!(figure.contains(part), "{part}");
        }
        assert_eq!(draw(&[]).status.code(), Some(2));
    }
    let output = asperity(folder.path(), &["inspect", &file, "--draw", "none.svg"]);
    let message = text(&output.stderr);
    assert!(message.contains("no channel for the frequency response function"), "{message}");
    let output = asperity(folder.path(), &["inspect", &file, "--draw", "frf.bmp"]);
    assert!(text(&output.stderr).contains(".svg, .pdf or .png"));
}

/// Verified against `frf.csv` and against each other: the functions of the average and of the three
/// good hits have the same values in each format, to its digits.
#[test]
fn functions_are_the_same_in_each_format() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", test_record(), Format::UniversalBinary);
    let mut all = Vec::new();
    for (format, name) in [("uff", "frfs.uff"), ("uff-ascii", "frfs.uff"), ("npz", "frfs.npz")] {
        let asked = ["analyse", &file, "--frfs", format, "--form", "accelerance", "--out", format];
        answer(folder.path(), &[&asked[..], &["--json"]].concat());
        let found = functions(&folder.path().join(format).join(name));
        let values: Vec<_> = found.iter().map(|channel| complex(channel).to_vec()).collect();
        assert_eq!(values.len(), 4, "the average and three good hits");
        if format != "npz" {
            let channel = &found[1];
            let units = channel.origin.frf.unwrap();
            assert_eq!((units.text().as_str(), channel.name.as_str()), ("m/s^2/N", "hit 1"));
            assert!(
                matches!(channel.abscissa, Abscissa::Even { start, step, .. } if start == step)
            );
        }
        all.push(values);
    }
    let table = std::fs::read_to_string(folder.path().join("uff/frf.csv")).unwrap();
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(2)
        .map(|line| line.split(',').map(|word| word.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    for (row, value) in rows.iter().zip(&all[0][0]) {
        assert_eq!((row[1], row[2]), (value.re, value.im));
    }
    assert_eq!(rows.len(), all[0][0].len());
    for other in &all[1..] {
        for (a, b) in all[0].iter().flatten().zip(other.iter().flatten()) {
            assert!((a - b).norm() <= 1e-11 * a.norm(), "{a} {b}");
        }
    }
}

/// Reads the file by pyuff, and extracts the mode by pyEMA where it is.
const SCRIPT: &str = "
import json, sys
import numpy as np
try:
    import pyuff
except ImportError:
    print(json.dumps(None)); sys.exit()
sets = [s for s in pyuff.UFF(sys.argv[1]).read_sets() if s['type'] == 58]
first = sets[1]
answer = {
    'types': [int(s['func_type']) for s in sets], 'name': first['id1'].strip(),
    'x': [float(first['x'][0]), float(first['x'][-1])],
    'real': [float(v.real) for v in first['data']], 'imag': [float(v.imag) for v in first['data']],
    'denominator': int(first['orddenom_spec_data_type']),
}
try:
    from pyEMA import Model
    low, high = float(sys.argv[2]), float(sys.argv[3])
    model = Model(first['data'][None, :], first['x'], lower=low, upper=high,
                  pol_order_high=20, frf_form='accelerance')
    model.get_poles(show_progress=False)
    model.select_closest_poles([float(sys.argv[4])])
    answer['mode'] = [float(model.nat_freq[0]), float(model.nat_xi[0])]
except ImportError:
    pass
print(json.dumps(answer))
";

/// Verified against pyuff, which reads the same numbers, and against pyEMA, whose least-squares
/// complex frequency estimate of the mode agrees with the circle fit and the half-power width to what
/// one mode sampled at a finite rate leaves. Skipped where they are not installed.
#[test]
fn other_programs_read_the_functions() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", test_record(), Format::UniversalBinary);
    let asked =
        ["analyse", &file, "--frfs", "uff", "--form", "accelerance", "--out", "a", "--json"];
    let report = answer(folder.path(), &asked);
    let place = folder.path().join("a/frfs.uff");
    let first = &report["hits"][0]["fundamental"];
    let of = |key: &str| first[key].as_f64().unwrap();
    let natural = of("natural_frequency_hz");
    let limits = [0.5 * natural, 1.5 * natural, natural].map(|frequency| frequency.to_string());
    let output = Command::new("python3").args(["-c", SCRIPT]).arg(&place).args(&limits).output();
    let skip = |reason: &str| eprintln!("skipped other_programs_read_the_functions: {reason}");
    let Ok(output) = output else { return skip("no python3") };
    let text = String::from_utf8_lossy(&output.stdout);
    let last = text.lines().last().unwrap_or_default();
    let Ok(found) = serde_json::from_str::<serde_json::Value>(last) else {
        return skip(&format!("python3 failed: {}", String::from_utf8_lossy(&output.stderr)));
    };
    if found.is_null() {
        return skip("no pyuff");
    }
    let own = functions(&place);
    let values = complex(&own[1]);
    assert_eq!(found["types"], serde_json::json!([4, 4, 4, 4]));
    assert_eq!((&found["name"], &found["denominator"]), (&"hit 1".into(), &13.into()));
    for (n, value) in values.iter().enumerate() {
        assert_eq!(found["real"][n].as_f64(), Some(value.re));
        assert_eq!(found["imag"][n].as_f64(), Some(value.im));
    }
    let Some(mode) = found.get("mode") else { return skip("no pyEMA; pyuff agrees") };
    let (frequency, damping) = (mode[0].as_f64().unwrap(), mode[1].as_f64().unwrap());
    assert!((frequency / natural - 1.0).abs() < 1e-4, "{frequency} {natural}");
    assert!((damping / of("damping_ratio") - 1.0).abs() < 5e-3, "{damping}");
}
