//! Files of force samples.
#![no_main]

use asperity_fuzz::documents;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| documents::load_samples(data));
