//! HDF5: the input follows the mark of the format.
#![no_main]

use asperity_fuzz::readers::{Blocks, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    read(&[b"\x89HDF\r\n\x1a\n".as_slice(), data].concat(), Blocks::Free);
});
