//! RIFF WAVE: the input follows the mark of the format.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"RIFF\xff\xff\0\0WAVE".as_slice(), data].concat(), Blocks::Same);
});
