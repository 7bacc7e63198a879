//! Work without the interpreter's lock, which an interrupt ends.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two looks for an interrupt.
const PAUSE: Duration = Duration::from_millis(20);

/// Flags that no work uses. Flags live forever, so they are used again.
static FREE: Mutex<Vec<&'static AtomicBool>> = Mutex::new(Vec::new());

/// Flags of work that is going on, so that it can be cancelled.
#[derive(Default)]
pub struct Running(Mutex<Vec<&'static AtomicBool>>);

impl Running {
    fn flags(&self) -> MutexGuard<'_, Vec<&'static AtomicBool>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends all work that is going on.
    pub fn cancel(&self) {
        // The lock keeps a flag from being used again in the meantime.
        self.flags().iter().for_each(|flag| flag.store(true, Ordering::Relaxed));
    }
}

/// Runs `work` on a thread of its own, without the interpreter's lock. An interrupt sets the flag
/// that `work` gets, and its exception is raised once `work` has ended. [`Running::cancel`] sets the
/// flag, too, without an exception.
///
/// # Panics
/// If `work` panics.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    running: &Running,
    work: impl FnOnce(&'static AtomicBool) -> T + Send,
) -> PyResult<T> {
    let free = || FREE.lock().unwrap_or_else(PoisonError::into_inner);
    let stop = free().pop().unwrap_or_else(|| Box::leak(Box::default()));
    running.flags().push(stop);
    let found = py.detach(|| {
        thread::scope(|scope| {
            let (done, ended) = channel();
            let worker = scope.spawn(move || {
                let found = work(stop);
                // Nobody waits if the interpreter ends.
                let _ = done.send(());
                found
            });
            let mut interrupt = Ok(());
            while ended.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout) {
                if interrupt.is_ok() {
                    interrupt = Python::attach(|py| py.check_signals());
                    if interrupt.is_err() {
                        stop.store(true, Ordering::Relaxed);
                    }
                }
            }
            let found = worker.join().expect("kernels and tracers do not panic");
            interrupt.map(|()| found)
        })
    });
    running.flags().retain(|flag| !std::ptr::eq(*flag, stop));
    stop.store(false, Ordering::Relaxed);
    free().push(stop);
    found
}
