//! Compiling within a budget of time.
//!
//! The code generator cannot be interrupted. It runs on threads that nobody waits for if the budget
//! ends, and that end with the process.

use anyhow::{Context, Result};
use rayon::ThreadPool;
use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_syntax::Document;

/// A model that can be drawn.
pub enum Compiled {
    /// The compiled model, and the threads that compiled it.
    InTime(Model, ThreadPool),
    /// An interpreted model, since the budget ended first. Its picture is what an empty budget
    /// leaves: rays that were not reached. The threads may still be compiling.
    Late(Model),
}

/// Compiles the kernels of a model of `document` on the threads of `pool`, until the budget ends.
///
/// # Errors
/// If a formula is too large to compile, or no thread can be started.
///
/// # Panics
/// If the code generator panics.
pub fn compiled(
    mut model: Model,
    document: &Document,
    settings: &Settings,
    pool: ThreadPool,
) -> Result<Compiled> {
    let Some(left) = settings.time_left() else {
        pool.install(|| model.compile(settings, &|| true))?;
        return Ok(Compiled::InTime(model, pool));
    };
    let late = model.interpreted(document);
    let (sender, receiver) = channel();
    let settings = settings.clone();
    let compile = move || {
        let is_done = pool.install(|| model.compile(&settings, &settings.has_time()));
        // Nobody receives it if the budget has ended.
        let _ = sender.send(is_done.map(|is_done| is_done.then_some((model, pool))));
    };
    let thread = thread::Builder::new().spawn(compile).context("cannot start a thread")?;
    Ok(match receiver.recv_timeout(left) {
        Ok(done) => {
            done?.map_or(Compiled::Late(late), |(model, pool)| Compiled::InTime(model, pool))
        }
        Err(RecvTimeoutError::Timeout) => Compiled::Late(late),
        // The thread has panicked before it could send.
        Err(RecvTimeoutError::Disconnected) => match thread.join() {
            Ok(()) => Compiled::Late(late),
            Err(panic) => resume_unwind(panic),
        },
    })
}
