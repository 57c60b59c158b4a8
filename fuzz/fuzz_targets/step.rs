//! Time steps of both integrators on any small structure.
#![no_main]

use asperity_fuzz::steps;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| steps::step(data));
