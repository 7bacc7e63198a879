//! A note while work takes long: what it is, and what would end it sooner. On a terminal only.

use super::notes;
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

/// Work shorter than this has no note.
const PATIENCE: Duration = Duration::from_secs(5);

/// Work that has begun. When it is dropped, the work is done.
pub struct LongWork {
    done: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl LongWork {
    /// Begins work that has this note if it takes long.
    pub fn begin(note: &'static str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self { done: None, thread: None };
        }
        Self::after(PATIENCE, move || notes::note(note))
    }

    /// Begins work. Unless it is done before, calls `late` after this time.
    fn after(time: Duration, late: impl FnOnce() + Send + 'static) -> Self {
        let (done, waiting) = channel::<()>();
        let thread = spawn(move || {
            if waiting.recv_timeout(time) == Err(RecvTimeoutError::Timeout) {
                late();
            }
        });
        Self { done: Some(done), thread: Some(thread) }
    }
}

impl Drop for LongWork {
    fn drop(&mut self) {
        drop(self.done.take());
        if let Some(thread) = self.thread.take() {
            // Its panic has already been reported.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_work_has_a_note() {
        let (tell, told) = channel();
        let long = LongWork::after(Duration::ZERO, {
            let tell = tell.clone();
            move || tell.send("long").expect("somebody hears")
        });
        assert_eq!(told.recv(), Ok("long"));
        drop(long);
        drop(LongWork::after(Duration::from_hours(1), move || {
            tell.send("short").expect("somebody hears");
        }));
        assert!(told.recv().is_err());
    }
}
