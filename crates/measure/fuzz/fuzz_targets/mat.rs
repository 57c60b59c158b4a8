//! MATLAB files: the input follows a header of either byte order.
#![no_main]

use asperity_measure::{ReadOptions, read_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let options = ReadOptions { sample_rate_hz: Some(1000.0), ..ReadOptions::default() };
    for mark in [b"\x00\x01IM", b"\x01\x00MI"] {
        let head = [[b' '; 124].as_slice(), mark].concat();
        let _ = read_bytes(&[head.as_slice(), data].concat(), &options);
    }
});
