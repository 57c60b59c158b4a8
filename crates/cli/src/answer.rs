//! Answers on standard output.

use std::fmt::Arguments;
use std::io::{self, Write, stdout};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Writes to standard output.
///
/// # Errors
/// [`Failure::Answer`] where standard output is closed or full, a pipe without a reader included.
/// Commands print after they have written their files, which are then complete.
pub(crate) fn write(text: Arguments<'_>) -> Result<(), Failure> {
    if CLOSED.load(Ordering::Relaxed) {
        return Err(Failure::Answer(io::Error::other("it is closed")));
    }
    stdout().write_fmt(text).map_err(Failure::Answer)
}

/// Writes out what standard output still holds in its buffer.
///
/// # Errors
/// Those of [`write()`].
pub(crate) fn finish() -> Result<(), Failure> {
    stdout().flush().map_err(Failure::Answer)
}

/// [`write()`] of a format; an error is returned from the function.
macro_rules! answer {
    ($($part:tt)*) => { $crate::answer::write(format_args!($($part)*))? };
}

/// [`write()`] of a format and a line break; an error is returned from the function.
macro_rules! answer_line {
    ($($part:tt)*) => { $crate::answer::write(format_args!("{}\n", format_args!($($part)*)))? };
}

/// True if standard output was closed when the program started.
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Records a closed standard output before `main`: the runtime of the language opens the null
/// device in its place, which accepts everything.
#[cfg(any(target_os = "linux", target_os = "macos"))]
#[used]
#[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
#[cfg_attr(target_os = "macos", unsafe(link_section = "__DATA,__mod_init_func"))]
#[allow(unsafe_code, reason = "functions listed in this section run before `main`")]
static BEFORE_MAIN: extern "C" fn() = {
    extern "C" fn look() {
        use std::os::fd::AsFd;
        CLOSED.store(stdout().as_fd().try_clone_to_owned().is_err(), Ordering::Relaxed);
    }
    look
};
