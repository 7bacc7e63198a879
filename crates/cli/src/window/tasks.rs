//! Tasks on other threads, so that the window does not wait for them.

use crate::line_edit::LineEdit;
use crate::session::{LineError, Session};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::thread::spawn;

/// Result of a task.
pub enum TaskOutcome {
    /// A line was entered or refused. An entered line may have a message to show.
    Entered(LineEdit, Result<Option<String>, LineError>),
    /// A picture was saved, or could not be saved.
    Saved(anyhow::Result<()>),
}

/// Enters lines one after another until the channel closes.
pub fn enter_all(session: &Arc<Session>, lines: &Receiver<LineEdit>, tell: &Sender<TaskOutcome>) {
    let mut saves = Vec::new();
    for line in lines {
        let result = session.enter(line.text().trim(), |to| {
            // Save on another thread, so that later lines need not wait for the picture. When the
            // session ends, it makes a newer request, and that thread stops waiting.
            let revision = session.live.revision();
            anyhow::ensure!(!session.has_ended(), "not saved: the window was closed");
            let (session, tell) = (Arc::clone(session), tell.clone());
            saves.push(spawn(move || save(&session, to.as_deref(), revision, &tell)));
            Ok(())
        });
        // Sending fails only when the window is closed and nobody receives the outcome.
        let _ = tell.send(TaskOutcome::Entered(line, result));
    }
    for save in saves {
        let _ = save.join();
    }
}

pub fn save(session: &Session, to: Option<&str>, revision: u64, tell: &Sender<TaskOutcome>) {
    let _ = tell.send(TaskOutcome::Saved(session.png(to, revision)));
}
