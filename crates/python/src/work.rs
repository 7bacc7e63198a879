//! Work without the interpreter's lock, which an interrupt ends.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Interval between checks for an interrupt.
const PAUSE: Duration = Duration::from_millis(20);

/// Flags that are not in use. Flags live forever, so they are reused.
static FREE: Mutex<Vec<&'static AtomicBool>> = Mutex::new(Vec::new());

fn free() -> MutexGuard<'static, Vec<&'static AtomicBool>> {
    FREE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A flag that ends work, also work that has not begun.
#[pyclass(frozen, module = "zeroset")]
pub struct Stop(&'static AtomicBool);

#[pymethods]
impl Stop {
    #[new]
    pub fn new() -> Self {
        Self(free().pop().unwrap_or_else(|| Box::leak(Box::default())))
    }

    /// Ends the work that has this flag. A picture is returned unfinished.
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Drop for Stop {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Relaxed);
        free().push(self.0);
    }
}

/// Runs `work` on a thread of its own, without the interpreter's lock. Meanwhile calls `look` at
/// intervals. An interrupt or an error of `look` sets the flag `stop`, which `work` gets, and the
/// exception is raised once `work` has ended.
///
/// # Panics
/// If `work` panics.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    stop: &Stop,
    mut look: impl FnMut(Python<'_>) -> PyResult<()> + Send,
    work: impl FnOnce(&'static AtomicBool) -> T + Send,
) -> PyResult<T> {
    let flag = stop.0;
    py.detach(|| {
        thread::scope(|scope| {
            let (done, ended) = channel();
            let worker = scope.spawn(move || {
                let found = work(flag);
                // Nobody waits if the interpreter ends.
                let _ = done.send(());
                found
            });
            let mut interrupt = Ok(());
            while ended.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout) {
                if interrupt.is_ok() {
                    interrupt = Python::attach(|py| py.check_signals().and_then(|()| look(py)));
                    if interrupt.is_err() {
                        stop.set();
                    }
                }
            }
            let found = worker.join().expect("kernels and tracers do not panic");
            interrupt.map(|()| found)
        })
    })
}
