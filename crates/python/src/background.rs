//! Long computations on a thread of their own, while the calling thread waits for signals.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Longest time until a signal is noticed, and shortest between two calls of a progress function.
const TICK: Duration = Duration::from_millis(50);

/// Fraction done of a computation, and the request to stop it.
#[derive(Debug, Default)]
pub(crate) struct Progress {
    /// Bits of the fraction.
    fraction: AtomicU64,
    stopped: AtomicBool,
}

/// A computation under way, as the calling thread sees it.
pub(crate) trait Watched: Send + Sync + 'static {
    /// Fraction done, 0 to 1.
    fn fraction(&self) -> f64;

    /// Asks the computation to end soon.
    fn stop(&self);
}

/// Payload that unwinds the threads of a stopped computation.
struct Stopped;

impl Progress {
    /// Reports the fraction done; ends the computation here if it is to stop.
    pub(crate) fn report(&self, fraction: f64) {
        self.fraction.store(fraction.to_bits(), Ordering::Relaxed);
        if self.stopped.load(Ordering::Relaxed) {
            // Does not call the panic hook.
            resume_unwind(Box::new(Stopped));
        }
    }
}

impl Watched for Progress {
    fn fraction(&self) -> f64 {
        f64::from_bits(self.fraction.load(Ordering::Relaxed))
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }
}

/// Carries out `work`, which reports its progress, as [`run_watched`] does.
///
/// # Errors
/// Those of [`run_watched`].
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    listener: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Progress) -> T + Send + 'static,
) -> PyResult<T> {
    run_watched(py, listener, Arc::new(Progress::default()), work)
}

/// Process that imported the package.
static IMPORTED_BY: OnceLock<u32> = OnceLock::new();

/// Threads of a process that was forked from it.
static FORKED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Notes the process that imports the package.
pub(crate) fn imported() {
    IMPORTED_BY.get_or_init(std::process::id);
}

/// Carries out `work` on threads of this process.
///
/// A process that was forked has the pool of its parent without the threads, and would wait for them for
/// ever; it gets a pool of its own. None if its threads cannot be started.
fn on_own_threads<T: Send>(work: impl FnOnce() -> T + Send) -> Option<T> {
    let process = std::process::id();
    if IMPORTED_BY.get().is_none_or(|imported| *imported == process) {
        return Some(work());
    }
    let pool = {
        let mut forked = FORKED.lock().unwrap_or_else(PoisonError::into_inner);
        match &*forked {
            Some((of, pool)) if *of == process => Arc::clone(pool),
            _ => {
                let pool = Arc::new(ThreadPoolBuilder::new().build().ok()?);
                // The pool of a parent that was forked itself has no threads to end.
                std::mem::forget(forked.replace((process, Arc::clone(&pool))));
                pool
            }
        }
    };
    Some(pool.install(work))
}

/// Carries out `work` without the interpreter's lock.
///
/// The calling thread calls `listener`, if there is one, with the fraction done, and checks signals.
/// After Ctrl-C or an exception of the listener it returns at once; the work is asked to stop, and its
/// result is dropped.
///
/// # Errors
/// The exception of the listener or of a signal handler.
pub(crate) fn run_watched<T: Send + 'static, W: Watched>(
    py: Python<'_>,
    listener: Option<&Bound<'_, PyAny>>,
    watched: Arc<W>,
    work: impl FnOnce(&W) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = mpsc::sync_channel(1);
    // Only this thread receives; the lock makes the borrow fit to leave the interpreter with.
    let receiver = Mutex::new(receiver);
    let reported = Arc::clone(&watched);
    let thread = std::thread::Builder::new().name("asperity".to_owned()).spawn(move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| on_own_threads(|| work(&reported))));
        // Nobody receives the outcome of a stopped computation.
        let _ = sender.send(outcome);
    });
    thread.map_err(|error| PyRuntimeError::new_err(format!("cannot start a thread: {error}")))?;
    let mut told = 0.0;
    loop {
        let received = py
            .detach(|| receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK));
        let fraction = watched.fraction();
        if let Some(listener) = listener
            && fraction != told
            && let Err(error) = listener.call1((fraction,))
        {
            watched.stop();
            return Err(error);
        }
        told = fraction;
        match received {
            Ok(Ok(Some(result))) => return Ok(result),
            Ok(Ok(None)) => {
                return Err(PyRuntimeError::new_err("cannot start threads in a forked process"));
            }
            // A defect of the program, shown as pyo3 shows panics.
            Ok(Err(payload)) => resume_unwind(payload),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| {
                watched.stop();
            })?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the computation ended without a result"));
            }
        }
    }
}
