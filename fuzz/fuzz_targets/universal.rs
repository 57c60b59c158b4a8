//! Universal files: the input follows the line that opens a dataset.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"    -1\n    58".as_slice(), data].concat(), Blocks::Same);
});
