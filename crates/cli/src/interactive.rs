//! `zeroset` without a command: a window and a prompt, or a prompt with pictures in the terminal.
//! Window and prompt share one [`Session`].

use super::arguments::InteractiveArgs;
use super::session::Session;
use super::{INTERRUPTED, interrupt, notes, prompt};
use anyhow::Result;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

/// Time that Ctrl-C leaves for an orderly end.
const PATIENCE: Duration = Duration::from_secs(2);

pub fn run(arguments: &InteractiveArgs) -> Result<ExitCode> {
    let session = Arc::new(Session::new(arguments)?);
    let working = Arc::clone(&session);
    interrupt::listen_with(move || answer_interrupt(&working))?;
    let window =
        if arguments.preview { Err("--preview".to_owned()) } else { open(arguments, &session) };
    match window {
        #[cfg(feature = "window")]
        Ok(window) => {
            let prompt = Arc::clone(&session);
            let restore_terminal = super::terminal::keep_setup();
            let thread = std::thread::spawn(move || prompt::run(&prompt, false));
            window.run()?;
            if thread.is_finished() {
                // The thread's panic has already been reported on standard error.
                thread.join().unwrap_or(Ok(()))?;
            }
            // The prompt may still be waiting for a key, and has changed the terminal's modes.
            restore_terminal();
        }
        #[cfg(not(feature = "window"))]
        Ok(never) => match never {},
        Err(why) => {
            if !arguments.preview {
                notes::note(&format!("{why}, so pictures are shown in the terminal"));
            }
            session.fit_terminal();
            prompt::run(&session, true)?;
        }
    }
    session.say_what_is_kept();
    Ok(ExitCode::SUCCESS)
}

/// Cancels the current work of the program. Without work, ends the session and then the program,
/// which may wait for input that never comes.
fn answer_interrupt(session: &Session) {
    if session.has_ended() || !session.give_up() {
        session.end();
        std::thread::sleep(PATIENCE);
        session.say_what_is_kept();
        std::process::exit(INTERRUPTED.into());
    }
}

#[cfg(feature = "window")]
fn open(
    arguments: &InteractiveArgs,
    session: &Arc<Session>,
) -> Result<super::window::Window, String> {
    super::window::Window::open(arguments.size, arguments.ui_scale, session)
}

#[cfg(not(feature = "window"))]
fn open(_: &InteractiveArgs, _: &Arc<Session>) -> Result<std::convert::Infallible, String> {
    Err("this zeroset was built without a window".to_owned())
}
