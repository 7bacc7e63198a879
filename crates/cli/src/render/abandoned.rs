//! Work within a limit of time.
//!
//! The code generator cannot be interrupted. It runs on threads that nobody waits for if the time
//! ends, and that end with the process.

use anyhow::{Context, Result};
use rayon::ThreadPool;
use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Runs `work` on the threads of `pool` for at most this time. Returns its result and the pool.
/// `None` if the time ended first: then the pool's threads may still be busy.
///
/// # Errors
/// If `work` fails, or no thread can be started.
///
/// # Panics
/// If `work` panics.
pub fn within<T: Send + 'static>(
    limit: Duration,
    pool: ThreadPool,
    work: impl FnOnce() -> Result<T> + Send + 'static,
) -> Result<Option<(T, ThreadPool)>> {
    let (sender, receiver) = channel();
    let run = move || {
        let done = pool.install(work);
        // Nobody receives it if the time has ended.
        let _ = sender.send(done.map(|done| (done, pool)));
    };
    let thread = thread::Builder::new().spawn(run).context("cannot start a thread")?;
    match receiver.recv_timeout(limit) {
        Ok(done) => done.map(Some),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        // The thread has panicked before it could send.
        Err(RecvTimeoutError::Disconnected) => match thread.join() {
            Ok(()) => Ok(None),
            Err(panic) => resume_unwind(panic),
        },
    }
}
