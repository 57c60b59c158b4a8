//! Reading, converting and writing measurements.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "what tests build is valid, and what they skip is told"
)]

mod build;
mod by_hand;
mod calibration;
mod complex_arrays;
mod errors;
mod pyuff_check;
mod reference_files;
mod round_trip;
mod shared_data;
mod tdms_by_hand;
mod tdms_files;
mod text_files;
mod writing;
