//! Work on other threads, so that the window does not wait for it.

use crate::line_edit::LineEdit;
use crate::session::{LineError, Session};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::thread::spawn;

/// Result of such work.
pub enum TaskOutcome {
    /// A line was entered, perhaps with a message, or refused.
    Entered(LineEdit, Result<Option<String>, LineError>),
    /// A picture was saved, or could not be.
    Saved(anyhow::Result<()>),
}

/// Enters lines until the channel closes.
pub fn enter_all(session: &Arc<Session>, lines: &Receiver<LineEdit>, tell: &Sender<TaskOutcome>) {
    let mut saves = Vec::new();
    for line in lines {
        let result = session.enter(line.text().trim(), |to| {
            // Later lines need not wait for the picture. When the session ends, a newer request
            // ends the wait for this one.
            let revision = session.live.revision();
            anyhow::ensure!(!session.has_ended(), "not saved: the window was closed");
            let (session, tell) = (Arc::clone(session), tell.clone());
            saves.push(spawn(move || save(&session, to.as_deref(), revision, &tell)));
            Ok(())
        });
        // Nobody receives this once the window is closed.
        let _ = tell.send(TaskOutcome::Entered(line, result));
    }
    for save in saves {
        let _ = save.join();
    }
}

pub fn save(session: &Session, to: Option<&str>, revision: u64, tell: &Sender<TaskOutcome>) {
    let _ = tell.send(TaskOutcome::Saved(session.png(to, revision)));
}
