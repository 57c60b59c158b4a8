//! Truncated, mutated, spliced and inconsistent files: a result or an
//! error, without panic, endless loop or unbounded memory.
//!
//! Mutations have a fixed seed, so that a failure repeats. The allocator counts the memory of the
//! reading thread.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "tests build valid files, and report what they skip"
)]

mod announcements;
mod compact;
mod corpus;
mod counting;

mod mutate;
mod tdms;

use asperity_measure::{ReadOptions, Reader, read_bytes};
use std::io::Cursor;

use counting::{peak_of, start_counting};
use mutate::Mutator;

/// Mutated inputs for each file of the corpus.
const MUTATIONS: usize = 2_000;

/// One MiB, for the buffers of readers and format detection.
const BUFFERS: usize = 1 << 20;

fn survive(name: &str, bytes: &[u8]) {
    survive_within(BUFFERS, name, bytes);
}

/// Reads `bytes` whole and in blocks; peak memory stays within ten times the
/// input and `buffers`.
fn survive_within(buffers: usize, name: &str, bytes: &[u8]) {
    let whole = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    let blocks = ReadOptions { block: 7, ..whole.clone() };
    start_counting();
    let outcome = read_bytes(bytes, &whole).map(drop);
    let peak = peak_of();
    if let Err(error) = outcome {
        assert!(error.to_string().len() < 1500, "{name}: an error of reasonable length");
    }
    let limit = 10 * bytes.len() + buffers;
    assert!(peak <= limit, "{name}: {peak} bytes of memory for {} of input", bytes.len());
    if let Ok(mut reader) = Reader::from_stream(name, Cursor::new(bytes), &blocks) {
        let mut records = 0;
        while let Ok(Some(_)) = reader.next_record() {
            records += 1;
            assert!(records <= bytes.len() + 1, "{name}: more records than bytes");
        }
    }
}

fn every_mutation(seeds: &[(&'static str, Vec<u8>)]) {
    every_mutation_within(BUFFERS, seeds);
}

fn every_mutation_within(buffers: usize, seeds: &[(&'static str, Vec<u8>)]) {
    for (index, (name, seed)) in seeds.iter().enumerate() {
        survive_within(buffers, name, seed);
        for part in 0..=64 {
            survive_within(buffers, name, &seed[..seed.len() * part / 64]);
        }
        let mut mutator = Mutator::new(0x9E37_79B9_7F4A_7C15 ^ index as u64);
        for _ in 0..MUTATIONS {
            let other = &seeds[mutator.below(seeds.len())].1;
            survive_within(buffers, name, &mutator.mutated(seed, other));
        }
    }
}

#[test]
fn universal_files() {
    every_mutation(&corpus::universal());
}

#[test]
fn texts() {
    every_mutation(&corpus::text());
}

#[test]
fn arrays_of_numpy() {
    every_mutation(&corpus::numpy());
}

#[test]
fn matlab_files() {
    every_mutation(&corpus::matlab());
}

/// The reader of HDF5 is that of another project: no panic, no endless loop, and four MiB of
/// buffers, of which it uses one for its windows.
#[cfg(feature = "hdf5")]
#[test]
fn hdf5_files() {
    every_mutation_within(4 << 20, &corpus::hdf5());
}

#[test]
fn tdms_files() {
    every_mutation(&corpus::tdms());
}

#[test]
fn wave_files() {
    every_mutation(&corpus::wave());
}
