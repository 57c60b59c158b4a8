//! Development tasks of asperity.
fn main() {}
