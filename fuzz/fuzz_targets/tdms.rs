//! TDMS files: the input follows the first tag.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"TDSm".as_slice(), data].concat(), Blocks::Same);
});
