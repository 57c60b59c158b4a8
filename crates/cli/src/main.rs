//! The asperity command.
fn main() {}
