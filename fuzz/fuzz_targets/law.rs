//! Contact laws of any parameters.
#![no_main]

use asperity_fuzz::laws;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| laws::law(data));
