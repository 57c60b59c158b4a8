//! `asperity watch`: verdicts on files as they come, and the results of `analyse` at the end.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use asperity_measure::{Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, Origin, Record};
use asperity_measure::{Samples, WriteOptions, write};
use serde_json::{Value, json};

use crate::{answer, asperity};

const RATE: f64 = 20_000.0;
const BAND: [&str; 2] = ["--band", "400:600"];

/// A mode at 500 Hz hit by half sines of 1 ms at these times \[s\] with these peaks \[N\].
pub(crate) fn hit(folder: &Path, name: &str, blows: &[(f64, f64)]) {
    let omega = std::f64::consts::TAU * 500.0;
    let (mut u, mut v) = (0.0, 0.0);
    let (mut force, mut acceleration) = (Vec::new(), Vec::new());
    for n in 0..(0.6 * RATE) as usize {
        let t = n as f64 / RATE;
        let pulse = |(at, peak): &(f64, f64)| {
            let phase = (t - at) / 1e-3;
            if (0.0..=1.0).contains(&phase) {
                peak * (std::f64::consts::PI * phase).sin()
            } else {
                0.0
            }
        };
        let f: f64 = blows.iter().map(pulse).sum();
        let a = f - 2.0 * 0.02 * omega * v - omega * omega * u;
        (v, u) = (v + a / RATE, u + (v + a / RATE) / RATE);
        force.push(f);
        acceleration.push(a);
    }
    let channel = |name: &str, unit: &str, samples| Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real(samples),
        origin: Origin::default(),
    };
    let channels = vec![channel("hammer", "N", force), channel("top", "m/s^2", acceleration)];
    let record = Record { channels, ..Record::default() };
    let options = WriteOptions { replace: true, ..WriteOptions::default() };
    write(&folder.join(name), &[record], Format::UniversalBinary, &options).unwrap();
}

fn lines(out: &std::process::Output) -> Vec<Value> {
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Each file has its verdict, a file that cannot be read is named and left out, and the folder of results
/// is that of `analyse` of the readable files, to the last byte.
#[test]
fn the_results_are_those_of_analyse() {
    let folder = tempfile::tempdir().unwrap();
    let test = folder.path().join("test");
    std::fs::create_dir(&test).unwrap();
    hit(&test, "hit_1.uff", &[(0.02, 10.0)]);
    hit(&test, "hit_2.uff", &[(0.02, 10.3), (0.025, 4.0)]);
    hit(&test, "hit_10.uff", &[(0.02, 20.0)]);
    std::fs::write(test.join("hit_3.uff"), "no measurement").unwrap();
    std::fs::write(test.join("notes.md"), "not looked at").unwrap();

    let asked = ["watch", "test", "--once", "--levels", "10,20,40", "--out", "w", "--json"];
    let out = asperity(folder.path(), &[&asked[..], &BAND].concat());
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let lines = lines(&out);
    let of =
        |name: &str| -> Vec<&Value> { lines.iter().filter(|line| line["file"] == name).collect() };
    assert_eq!(of("hit_1.uff")[0]["verdict"], "good");
    assert_eq!(of("hit_2.uff")[0]["verdict"], "double hit");
    assert_eq!(of("hit_10.uff")[0]["verdict"], "good");
    assert!(of("hit_3.uff")[0]["error"].as_str().unwrap().contains("hit_3.uff"));
    assert!(of("notes.md").is_empty());
    let force = of("hit_10.uff")[0]["hit"]["force_peak_n"].as_f64().unwrap();
    assert!((force - 20.0).abs() < 0.1, "{force}");
    let last = lines.iter().rev().find(|line| line.get("next").is_some()).unwrap();
    assert_eq!(last["next"]["force_n"], 40.0);
    let hits: Vec<_> =
        last["next"]["wanted"].as_array().unwrap().iter().map(|w| &w["hits"]).collect();
    assert_eq!(hits, [&json!(1), &json!(1), &json!(0)]);

    let files = ["test/hit_1.uff", "test/hit_2.uff", "test/hit_10.uff"];
    let rest = ["--out", "a", "--json"];
    answer(folder.path(), &[&["analyse"], &files[..], &BAND, &rest].concat());
    for name in ["hits.csv", "frf.csv", "backbone.csv", "modes.csv", "analysis.json", "report.html"]
    {
        let read = |result: &str| std::fs::read(folder.path().join(result).join(name)).unwrap();
        assert!(read("w") == read("a"), "{name}");
    }
}

/// Wrong requests end at once, with what is accepted.
#[test]
fn wrong_requests_end_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let failed = |asked: &[&str]| {
        let out = asperity(folder.path(), asked);
        assert_eq!(out.status.code(), Some(2), "{asked:?}");
        String::from_utf8_lossy(&out.stderr).into_owned()
    };
    assert!(failed(&["watch", "missing"]).contains("missing"));
    std::fs::create_dir(folder.path().join("test")).unwrap();
    assert!(failed(&["watch", "test", "--levels", "5,0"]).contains("such as 5,10,20"));
    let problem = json!({"schema": "asperity/identify/1"}).to_string();
    std::fs::write(folder.path().join("p.json"), problem).unwrap();
    assert!(failed(&["watch", "test", "--problem", "p.json"]).contains("p.json"));
}

/// A file added while the folder is watched is judged, and an interrupt ends the watch with the results in
/// place.
#[cfg(unix)]
#[test]
fn files_are_judged_as_they_come() {
    let folder = tempfile::tempdir().unwrap();
    let test = folder.path().join("test");
    std::fs::create_dir(&test).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .current_dir(folder.path())
        .args([&["watch", "test", "--out", "w"][..], &BAND].concat())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let wait_for = |done: &dyn Fn() -> bool| {
        while !done() {
            assert!(begun.elapsed() < Duration::from_secs(120), "nothing came");
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    let rows = || {
        let table = std::fs::read_to_string(folder.path().join("w/hits.csv")).unwrap_or_default();
        table.lines().count()
    };
    hit(&test, "hit_1.uff", &[(0.02, 10.0)]);
    wait_for(&|| rows() == 2);
    // Written in two parts, as by a slow program.
    hit(folder.path(), "whole.uff", &[(0.02, 12.0)]);
    let whole = std::fs::read(folder.path().join("whole.uff")).unwrap();
    std::fs::write(test.join("hit_2.uff"), &whole[..whole.len() / 2]).unwrap();
    std::thread::sleep(Duration::from_millis(700));
    std::fs::write(test.join("hit_2.uff"), &whole).unwrap();
    wait_for(&|| rows() == 3);
    rustix::process::kill_process(
        rustix::process::Pid::from_child(&child),
        rustix::process::Signal::INT,
    )
    .unwrap();
    let status = child.wait().unwrap();
    let out = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&out.stdout);
    assert!(status.success(), "{text}");
    assert!(text.contains("hit_1.uff: good, 10.0"), "{text}");
    assert!(text.contains("hit_2.uff: good, 12.0"), "{text}");
    assert!(!text.contains("cannot be analysed"), "{text}");
    assert!(text.contains("next: about 10"), "{text}");
}

/// Deleted, renamed and replaced files leave the watch running, and hits can be rejected by number.
#[cfg(unix)]
#[test]
fn files_may_go_and_hits_may_be_rejected() {
    use std::io::Write;
    let folder = tempfile::tempdir().unwrap();
    let test = folder.path().join("test");
    std::fs::create_dir(&test).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_asperity"))
        .current_dir(folder.path())
        .args([&["watch", "test", "--out", "w"][..], &BAND].concat())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let wait_for = |done: &dyn Fn(&str) -> bool| {
        let table = || std::fs::read_to_string(folder.path().join("w/hits.csv"));
        while !done(&table().unwrap_or_default()) {
            assert!(begun.elapsed() < Duration::from_secs(120), "nothing came: {:?}", table());
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    let rows = |table: &str| table.lines().count();
    for (name, force) in [("a.uff", 10.0), ("b.uff", 12.0), ("c.uff", 14.0)] {
        hit(&test, name, &[(0.02, force)]);
    }
    wait_for(&|table| rows(table) == 4);
    std::fs::remove_file(test.join("a.uff")).unwrap();
    wait_for(&|table| rows(table) == 3 && !table.contains("a.uff"));
    std::fs::rename(test.join("b.uff"), test.join("d.uff")).unwrap();
    wait_for(&|table| table.contains("d.uff") && !table.contains("b.uff"));
    hit(&test, "c.uff", &[(0.02, 20.0)]);
    let force_of_c = |table: &str| -> Option<f64> {
        table.lines().find(|row| row.contains("c.uff,"))?.split(',').nth(4)?.parse().ok()
    };
    wait_for(&|table| force_of_c(table).is_some_and(|force| force > 15.0));
    // Hits 1 to 3 are of a, b and c, 4 of d, 5 of the new c.
    let input = child.stdin.as_mut().unwrap();
    input.write_all(b"reject 4\nreject 1\nnonsense\n").unwrap();
    wait_for(&|table| table.lines().any(|row| row.contains("d.uff") && row.contains("rejected")));
    rustix::process::kill_process(
        rustix::process::Pid::from_child(&child),
        rustix::process::Signal::INT,
    )
    .unwrap();
    let out = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&out.stdout);
    assert!(out.status.success(), "{text}");
    for line in ["a.uff is gone", "#4 d.uff: good", "#5 c.uff: good", "#4 rejected", "#1 not there"]
    {
        assert!(text.contains(line), "{line} in {text}");
    }
    assert!(text.contains("`nonsense` is not understood"), "{text}");
}
