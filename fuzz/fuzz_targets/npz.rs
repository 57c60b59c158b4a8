//! NumPy arrays in a zip archive.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"PK\x03\x04".as_slice(), data].concat(), Blocks::Free);
});
