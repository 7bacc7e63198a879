//! What is done on other threads, so that the window goes on meanwhile.

use crate::line_edit::LineEdit;
use crate::session::{Session, Wrong};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::thread::spawn;

/// What has been done.
pub enum Outcome {
    /// A line was entered, which said something or not; or it was refused.
    Entered(LineEdit, Result<Option<String>, Wrong>),
    /// A picture was saved, or could not be.
    Saved(anyhow::Result<()>),
}

/// Enters lines as long as there are any to come.
pub fn enter_all(session: &Arc<Session>, lines: &Receiver<LineEdit>, tell: &Sender<Outcome>) {
    let mut saves = Vec::new();
    for line in lines {
        let result = session.enter(line.text().trim(), |to| {
            // The lines after it need not wait for the picture. Whoever ends the session asks for
            // another one after that, so that it is not waited for.
            let revision = session.live.revision();
            anyhow::ensure!(!session.has_ended(), "not saved: the window was closed");
            let (session, tell) = (Arc::clone(session), tell.clone());
            saves.push(spawn(move || save(&session, to.as_deref(), revision, &tell)));
            Ok(())
        });
        // Nobody is left to tell once the window is closed.
        let _ = tell.send(Outcome::Entered(line, result));
    }
    for save in saves {
        let _ = save.join();
    }
}

pub fn save(session: &Session, to: Option<&str>, revision: u64, tell: &Sender<Outcome>) {
    let _ = tell.send(Outcome::Saved(session.png(to, revision)));
}
