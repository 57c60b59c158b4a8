//! One NumPy array: the input follows the mark of the format.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"\x93NUMPY".as_slice(), data].concat(), Blocks::Free);
});
