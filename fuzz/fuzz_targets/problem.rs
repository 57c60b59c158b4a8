//! Documents of identification problems.
#![no_main]

use asperity_fuzz::documents;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &str| documents::problem(data));
