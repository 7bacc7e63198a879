//! Ctrl-C while a command works.
//!
//! It ends the process, except while files get their names: they appear whole, and together. While
//! a picture is drawn, the first Ctrl-C ends only the drawing, and the next one the process.

use super::{INTERRUPTED, notes};
use anyhow::{Context, Result};
use std::io::IsTerminal;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread;
use std::time::{Duration, Instant};
use zeroset_render::limit::StopFlag;

/// Longest time that the second Ctrl-C waits for files to get their names.
const PATIENCE: Duration = Duration::from_secs(1);
/// Interval between checks whether the files have their names.
const WAIT: Duration = Duration::from_millis(5);

static STATE: Mutex<State> = Mutex::new(State { remark: String::new(), draws: false });
static ASKED: AtomicBool = AtomicBool::new(false);

struct State {
    /// Message about the files that are left behind if the process ends now.
    remark: String,
    /// True while a picture is drawn.
    draws: bool,
}

/// Listens for Ctrl-C from now on. `remark` is as for [`set_remark`]. A process that was started to
/// ignore Ctrl-C, as shells start those in the background, goes on ignoring it.
///
/// # Errors
/// If the system does not allow it.
pub fn listen(remark: &str) -> Result<()> {
    set_remark(remark);
    listen_with(answer)
}

/// Calls `answer` at every Ctrl-C that the prompt does not read, on a thread of its own.
///
/// # Errors
/// If the system does not allow it.
pub fn listen_with(answer: impl FnMut() + Send + 'static) -> Result<()> {
    match ctrlc::try_set_handler(answer) {
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(()),
        Err(error) => Err(error).context("cannot listen for Ctrl-C"),
    }
}

/// Sets the message that Ctrl-C prints before it ends the process: it names the files that are left
/// behind.
pub fn set_remark(remark: &str) {
    remark.clone_into(&mut state().remark);
}

/// From now on the first Ctrl-C only sets the flag of [`stop_flag`].
pub fn defer_first() {
    state().draws = true;
}

/// Defers the end of the process until the guard is dropped. Until then, a first Ctrl-C only sets
/// the flag of [`stop_flag`].
pub fn hold() -> impl Drop {
    state()
}

/// The flag that Ctrl-C sets.
pub fn stop_flag() -> StopFlag {
    StopFlag(&ASKED)
}

/// Ends the process if there was a Ctrl-C.
pub fn end_if_asked() {
    let state = state();
    if ASKED.load(Ordering::Relaxed) {
        end(&state);
    }
}

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Carries out a Ctrl-C. It runs on a thread of its own.
fn answer() {
    let is_first = !ASKED.load(Ordering::Relaxed);
    let asked = Instant::now();
    loop {
        match STATE.try_lock() {
            Ok(state) if is_first && !state.draws => end(&state),
            Err(TryLockError::WouldBlock) if !is_first && asked.elapsed() < PATIENCE => {
                thread::sleep(WAIT);
            }
            _ if is_first => return ASKED.store(true, Ordering::Relaxed),
            // The lock, if it was taken, is held to the end.
            _held => exit(INTERRUPTED.into()),
        }
    }
}

/// Prints the remark, and ends the process.
fn end(state: &State) -> ! {
    if std::io::stderr().is_terminal() {
        // A terminal shows the keys, and there may be a progress bar.
        notes::say("");
    }
    notes::note(&format!("stopped by Ctrl-C: {}", state.remark));
    exit(INTERRUPTED.into())
}
