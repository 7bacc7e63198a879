//! Tasks on other threads, so that the window does not wait for them.

use crate::line_edit::LineEdit;
use crate::session::{LineError, Session};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::thread::spawn;

/// What a typed formula does to the document.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LineGoal {
    /// It replaces all formulas.
    #[default]
    Replace,
    /// It is drawn beside the others.
    Add,
    /// It replaces the formula with this index.
    Edit(usize),
}

impl LineGoal {
    /// The line as the prompt takes it. A line that begins with a colon is a command already.
    pub fn command(self, text: &str) -> String {
        let text = text.trim();
        match self {
            _ if text.starts_with(':') || text.is_empty() => text.to_owned(),
            Self::Replace => text.to_owned(),
            Self::Add => format!(":add {text}"),
            Self::Edit(index) => format!(":edit {} {text}", index + 1),
        }
    }
}

/// Work for the thread that changes the document.
pub enum Task {
    Enter(LineEdit, LineGoal),
    /// Gives a letter the value 1.
    Define(char),
}

/// Result of a task.
pub enum TaskOutcome {
    /// A line was entered. It may have a message to show.
    Entered(Option<String>),
    /// A line was refused.
    Refused(LineEdit, LineGoal, LineError),
    /// A picture was saved, or could not be saved.
    Saved(anyhow::Result<PathBuf>),
}

/// Does tasks one after another until the channel closes.
pub fn do_all(session: &Arc<Session>, tasks: &Receiver<Task>, tell: &Sender<TaskOutcome>) {
    let mut saves = Vec::new();
    for task in tasks {
        let (line, goal) = match task {
            Task::Enter(line, goal) => (line, goal),
            Task::Define(letter) => {
                let outcome = match session.define(letter) {
                    Ok(()) => TaskOutcome::Entered(None),
                    Err(why) => {
                        let line = format!("{letter} = 1").into();
                        TaskOutcome::Refused(line, LineGoal::Replace, why)
                    }
                };
                // Sending fails only when the window is closed and nobody receives the outcome.
                let _ = tell.send(outcome);
                continue;
            }
        };
        let result = session.enter(&goal.command(line.text()), |to| {
            // Save on another thread, so that later lines need not wait for the picture. When the
            // session ends, it makes a newer request, and that thread stops waiting.
            let revision = session.live.revision();
            anyhow::ensure!(!session.has_ended(), "not saved: the window was closed");
            let (session, tell) = (Arc::clone(session), tell.clone());
            saves.push(spawn(move || save(&session, to.as_deref(), revision, &tell)));
            Ok(())
        });
        let _ = tell.send(match result {
            Ok(said) => TaskOutcome::Entered(said),
            Err(why) => TaskOutcome::Refused(line, goal, why),
        });
    }
    for save in saves {
        let _ = save.join();
    }
}

pub fn save(session: &Session, to: Option<&str>, revision: u64, tell: &Sender<TaskOutcome>) {
    let _ = tell.send(TaskOutcome::Saved(session.png(to, revision)));
}
