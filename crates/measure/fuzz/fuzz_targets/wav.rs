//! RIFF WAVE: the input follows the mark of the format.
#![no_main]

use asperity_measure::{ReadOptions, read_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    let _ = read_bytes(&[b"RIFF\xff\xff\0\0WAVE".as_slice(), data].concat(), &options);
});
