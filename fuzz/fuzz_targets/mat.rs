//! MATLAB files: the input follows a header of either byte order.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    for mark in [b"\x00\x01IM", b"\x01\x00MI"] {
        let head = [[b' '; 124].as_slice(), mark].concat();
        read(&[head.as_slice(), data].concat(), Blocks::Free);
    }
});
