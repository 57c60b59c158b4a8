//! Speed and memory of the analysis of a large file.
//!
//! `cargo run --release -p asperity-experiment --example large_analysis -- SIZE_MB [FILE]`
//! writes a universal file (58b) of `SIZE_MB` megabytes with one hit of one second in each record, and
//! analyses it. With FILE the file is kept. If `python3`, or the interpreter in `PYTHON`, has pyuff,
//! `large_analysis.py` reads the same file. The two programs run in turn, three times each.
#![allow(clippy::unwrap_used, reason = "its files are valid")]
#![allow(clippy::print_stdout, reason = "an example prints its result")]

use std::f64::consts::{PI, TAU};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use asperity_experiment::{AnalysisOptions, FrequencyBand, analyse};
use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, Origin, Record, Samples, WriteOptions,
    write,
};

const RATE: f64 = 51_200.0;
const SAMPLES: usize = 51_200;
const NATURAL_HZ: f64 = 800.0;
const DAMPING: f64 = 0.01;
/// Runs of each program.
const RUNS: usize = 3;
/// Different hits, which the file repeats.
const LEVELS: usize = 8;

fn main() {
    let mut words = std::env::args().skip(1);
    let megabytes: u64 = words.next().and_then(|word| word.parse().ok()).unwrap_or(100);
    let kept = words.next().map(PathBuf::from);
    let folder = tempfile::tempdir().unwrap();
    let file = kept.unwrap_or_else(|| folder.path().join("large.uff"));
    write_hits(folder.path(), &file, megabytes * 1_000_000);
    let size = std::fs::metadata(&file).unwrap().len() as f64 / 1e6;

    let band_hz = Some(FrequencyBand { low_hz: 600.0, high_hz: 1000.0 });
    let options = AnalysisOptions { band_hz, ..AnalysisOptions::default() };
    let (mut best, mut script): (f64, Option<Script>) = (f64::INFINITY, None);
    for run in 0..RUNS {
        let started = Instant::now();
        let mut analysis = analyse(std::slice::from_ref(&file), &options).unwrap();
        let analysis = analysis.responses.remove(0);
        best = best.min(started.elapsed().as_secs_f64());
        if run == 0 {
            let first = analysis.report.average.frequency_hz.unwrap();
            println!("file          {size:.0} MB, {} hits", analysis.report.hits.len());
            println!(
                "fundamental   {:.3} +- {:.3} Hz",
                first.mean,
                first.standard_deviation.unwrap_or(0.0)
            );
        }
        drop(analysis);
        script = match (Script::run(&file), script) {
            (Some(now), Some(before)) if before.seconds < now.seconds => Some(before),
            (now, before) => now.or(before),
        };
    }
    println!("analysed in   {best:.2} s, {:.0} MB/s, the best of {RUNS}", size / best);
    match peak_megabytes() {
        Some(peak) => println!("peak memory   {peak:.0} MB"),
        None => println!("peak memory   not available on this system"),
    }
    match script {
        Some(script) => {
            let Script { versions, seconds, megabytes } = script;
            println!("{versions}, which compute less:");
            println!("              {seconds:.2} s, {:.0} MB/s, {megabytes:.0} MB", size / seconds);
            println!("time ratio    {:.2}", best / seconds);
        }
        None => println!("no Python with pyuff to compare with"),
    }
}

/// Output of `large_analysis.py`, which excludes the start of the interpreter.
struct Script {
    versions: String,
    seconds: f64,
    megabytes: f64,
}

impl Script {
    fn run(file: &Path) -> Option<Self> {
        let python = std::env::var_os("PYTHON").unwrap_or("python3".into());
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/large_analysis.py");
        let output = Command::new(python).arg(script).arg(file).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        let mut lines = text.lines().skip(1);
        let versions = lines.next()?.to_owned();
        let mut numbers = lines.next()?.split_whitespace().map(|word| word.parse().ok());
        Some(Self { versions, seconds: numbers.next()??, megabytes: numbers.next()?? })
    }
}

/// Writes records up to a size of the file; universal files may be concatenated.
fn write_hits(folder: &Path, file: &Path, bytes: u64) {
    let hits: Vec<Vec<u8>> = (0..LEVELS)
        .map(|level| {
            let one = folder.join("one.uff");
            let record = hit(10.0 + 5.0 * level as f64);
            write(&one, &[record], Format::UniversalBinary, &WriteOptions::default()).unwrap();
            std::fs::read(one).unwrap()
        })
        .collect();
    let mut out = File::create(file).unwrap();
    let mut written = 0;
    for hit in hits.iter().cycle() {
        if written >= bytes {
            break;
        }
        out.write_all(hit).unwrap();
        written += hit.len() as u64;
    }
}

/// Mode of 1.6 kg, hit by a half-sine pulse of 0.6 ms, with noise of 1e-4 of the maximum.
fn hit(peak_n: f64) -> Record {
    let (mass, omega) = (1.6, TAU * NATURAL_HZ);
    let (step, begin, duration) = (1.0 / RATE, 0.01, 0.6e-3);
    let mut seed = 12_345_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let (mut u, mut v) = (0.0, 0.0);
    let (mut force, mut acceleration) = (Vec::new(), Vec::new());
    for n in 0..SAMPLES {
        let t = n as f64 * step - begin;
        let f = if (0.0..duration).contains(&t) { peak_n * (PI * t / duration).sin() } else { 0.0 };
        let a = f / mass - 2.0 * DAMPING * omega * v - omega * omega * u;
        v += a * step;
        u += v * step;
        force.push(f + 1e-4 * peak_n * noise());
        acceleration.push(a + 1e-4 * peak_n / mass * noise());
    }
    let channel = |name: &str, unit: &str, samples| Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real(samples),
        origin: Origin::default(),
    };
    let channels =
        vec![channel("force", "N", force), channel("acceleration", "m/s^2", acceleration)];
    Record { channels, ..Record::default() }
}

/// Peak memory in MB; `None` on a system without `/proc`.
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1e3)
}
