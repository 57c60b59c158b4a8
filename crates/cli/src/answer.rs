//! Answers on standard output.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};

/// Writes to standard output. A reader that closes it early, as `head` does, is not a failure: files
/// are still written.
pub(crate) fn write(text: Arguments<'_>) {
    match stdout().write_fmt(text) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("warning: the answer cannot be written to standard output: {error}");
        }
        _ => {}
    }
}

/// [`write()`] of a format.
macro_rules! answer {
    ($($part:tt)*) => { $crate::answer::write(format_args!($($part)*)) };
}

/// [`write()`] of a format and a line break.
macro_rules! answer_line {
    ($($part:tt)*) => { $crate::answer::write(format_args!("{}\n", format_args!($($part)*))) };
}
