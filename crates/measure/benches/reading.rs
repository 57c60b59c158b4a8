//! Megabytes per second of the readers and writers, and the memory they take.
//!
//! `cargo bench -p asperity-measure` writes a universal file (58b) and a CSV
//! file, of 64 MB each or of the first argument, and reads them back
//! in blocks of 65 536 samples. Each row is the best of three runs.
#![allow(missing_docs, reason = "a benchmark has no callers")]
#![allow(clippy::print_stdout, reason = "a benchmark prints its table")]
#![allow(clippy::unwrap_used, reason = "its files are valid")]

use std::path::Path;
use std::time::Instant;

use asperity_measure::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, Format, Origin, ReadOptions, Record, Samples,
    WriteOptions, open, write,
};

const ROUNDS: usize = 3;
const RATE: f64 = 51_200.0;

fn main() {
    let megabytes = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(64);
    let folder = tempfile::tempdir().unwrap();
    println!("format     megabytes   write MB/s   read MB/s   memory of reading MB");
    // Bytes of a sample of two channels in each format.
    for (format, bytes) in [
        (Format::UniversalBinary, 16),
        (Format::UniversalText, 41),
        (Format::Text, 55),
        (Format::Npz, 16),
    ] {
        let path = folder.path().join("file");
        let records = [hit(megabytes * 1_000_000 / bytes)];
        let mut writing = f64::INFINITY;
        for _ in 0..ROUNDS {
            let started = Instant::now();
            write(&path, &records, format, &WriteOptions::default()).unwrap();
            writing = writing.min(started.elapsed().as_secs_f64());
        }
        drop(records);
        let before = resident();
        let (mut reading, mut most) = (f64::INFINITY, 0.0_f64);
        for _ in 0..ROUNDS {
            let started = Instant::now();
            most = most.max(read_blocks(&path));
            reading = reading.min(started.elapsed().as_secs_f64());
        }
        let size = std::fs::metadata(&path).unwrap().len() as f64 / 1e6;
        let memory = before.map_or(f64::NAN, |before| most - before);
        let name = format.to_string();
        println!(
            "{name:<10} {size:>9.0} {:>12.0} {:>11.0} {memory:>22.1}",
            size / writing,
            size / reading
        );
        std::fs::remove_file(&path).unwrap();
    }
}

fn hit(samples: usize) -> Record {
    let channel = |name: &str, unit: &str, scale: f64| Channel {
        name: name.to_owned(),
        quantity: ChannelQuantity::Unknown,
        unit: ChannelUnit::of_text(unit),
        abscissa: Abscissa::even_time(0.0, RATE),
        samples: Samples::Real((0..samples).map(|n| scale * (0.01 * n as f64).sin()).collect()),
        origin: Origin::default(),
    };
    Record {
        channels: vec![channel("hammer", "N", 50.0), channel("top", "g", 8.0)],
        ..Record::default()
    }
}

/// Reads the file in blocks and returns the most memory in use \[MB\], if the system reports it.
fn read_blocks(path: &Path) -> f64 {
    let options = ReadOptions { block: 1 << 16, ..ReadOptions::default() };
    let mut reader = open(path, &options).unwrap();
    let mut sum = 0.0;
    let mut most = 0.0_f64;
    while let Some(record) = reader.next_record().unwrap() {
        most = most.max(resident().unwrap_or(f64::NAN));
        for channel in &record.channels {
            sum += channel.samples.real().unwrap().iter().sum::<f64>();
        }
    }
    assert!(sum.is_finite());
    most
}

/// Megabytes of memory in use, if the system reports it.
fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1e3)
}
