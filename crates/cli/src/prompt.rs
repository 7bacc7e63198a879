//! The prompt: a line editor with history, completion and colors. Does not know what a line means.

use super::completion::{TokenClass, abandoned_formula, candidates, is_open, token_classes};
use super::data::data_directory;
use super::history::KEPT_LINES;
use super::session::{Session, lock};
use super::{notes, preview};
use anyhow::anyhow;
use rustyline::completion::{Completer, Pair};
use rustyline::error::ReadlineError;
use rustyline::highlight::{CmdKind, Highlighter};
use rustyline::hint::Hinter;
use rustyline::history::FileHistory;
use rustyline::validate::{ValidationContext, ValidationResult, Validator};
use rustyline::{CompletionType, Config, Context, Editor, ExternalPrinter, Helper};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use zeroset_live::COMMANDS;
use zeroset_syntax::WordKind;

/// Faults are reported after a pause in typing of this length.
const PAUSE: Duration = Duration::from_millis(300);
/// Interval between checks whether faults should be reported.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Reads and executes lines until the input or the session ends. With `preview`, shows pictures in
/// the terminal.
///
/// # Errors
/// If lines cannot be read, for example because the input is not UTF-8 text.
pub fn run(session: &Arc<Session>, preview: bool) -> anyhow::Result<()> {
    session.watch(Some(&session.live.text()));
    notes::say(&session.welcome);
    if preview {
        show(session);
        preview::drop_late_answer();
    }
    read_lines(session, preview).map_err(|error| anyhow!("the prompt has stopped: {error}"))
}

const NOT_TEXT: &str = "the terminal sent bytes that are not UTF-8 text; the line is left out";

fn show(session: &Session) {
    if let Err(error) = session.show_preview() {
        notes::error(&error);
    }
}

fn read_lines(session: &Arc<Session>, preview: bool) -> rustyline::Result<()> {
    let config = Config::builder()
        .completion_type(CompletionType::List)
        .max_history_size(KEPT_LINES)?
        .build();
    let typing = Arc::new(Mutex::new(Typing { at: Instant::now(), is_begun: false, reported: 0 }));
    let mut editor: Editor<PromptHelper, FileHistory> = Editor::with_config(config)?;
    editor.set_helper(Some(PromptHelper {
        session: Arc::clone(session),
        typing: Arc::clone(&typing),
    }));
    let history = data_directory().map(|directory| directory.join("history"));
    if let Some(history) = &history {
        // The file does not exist the first time.
        let _ = editor.load_history(history);
        session.recall(editor.history().iter().cloned());
    }
    // Number of the session's lines that are in the editor's history.
    let mut known = 0;
    session.history_since(&mut known);
    let mut last = preview.then(|| session.live.request());
    let interactive = std::io::stdin().is_terminal();
    if interactive && let Ok(mut printer) = editor.create_external_printer() {
        let print = move |text: &str| printer.print(format!("{text}\n")).is_ok();
        session.print_with(Some(Box::new(print)));
        let session = Arc::clone(session);
        let typing = Arc::clone(&typing);
        let reporter = std::thread::Builder::new().name("faults".to_owned());
        reporter.spawn(move || report_faults(&session, &typing))?;
    }
    while !session.has_ended() {
        learn(session, &mut editor, &mut known)?;
        let line = match editor.readline("zeroset> ") {
            Ok(line) => {
                forget_line(&typing);
                line
            }
            // As in a shell, Ctrl-C drops the typed line. On an empty line it gives up the running
            // picture, and without one it ends the session.
            Err(ReadlineError::Interrupted) if forget_line(&typing) => {
                session.live.type_line("");
                continue;
            }
            Err(ReadlineError::Interrupted) if session.give_up() => continue,
            Err(ReadlineError::Eof | ReadlineError::Interrupted) => {
                // A window stays open when piped input ends.
                if interactive || preview {
                    session.end();
                }
                break;
            }
            // This line is not text, but the next one may be.
            Err(ReadlineError::Io(error))
                if interactive && error.kind() == std::io::ErrorKind::InvalidData =>
            {
                notes::say(NOT_TEXT);
                continue;
            }
            Err(error) => {
                session.print_with(None);
                if interactive {
                    // Without a terminal nobody can type, so the session ends.
                    session.end();
                }
                return Err(error);
            }
        };
        if !line.trim().is_empty() {
            session.recall([line.clone()]);
        }
        // While this line was typed, the window may have entered other lines.
        learn(session, &mut editor, &mut known)?;
        if let Some(history) = &history {
            // Append at once, so that no line is lost if the program crashes.
            let _ = editor.append_history(history);
        }
        let parts =
            abandoned_formula(&line).map_or(vec![&*line], |(open, command)| vec![open, command]);
        for line in parts {
            match session
                .enter(line, |to| session.png(to.as_deref(), session.live.revision()).map(drop))
            {
                // If the line changed nothing, show no picture, so that the line's output stays in
                // view.
                Ok(_) if preview && !line.trim().is_empty() && !session.has_ended() => {
                    session.fit_terminal();
                    let shown = session.live.request();
                    if last.as_ref() != Some(&shown) {
                        show(session);
                        last = Some(shown);
                    }
                }
                Ok(_) => {}
                Err(wrong) => notes::say(&wrong.full),
            }
        }
    }
    session.print_with(None);
    Ok(())
}

/// Adds to the editor's history all lines of the session's history after the first `known`.
fn learn(
    session: &Session,
    editor: &mut Editor<PromptHelper, FileHistory>,
    known: &mut usize,
) -> rustyline::Result<()> {
    for line in session.history_since(known) {
        editor.add_history_entry(line)?;
    }
    Ok(())
}

/// State of the line: time of the last key, whether there is any text, and the revision of the last
/// request whose fault was reported.
struct Typing {
    at: Instant,
    is_begun: bool,
    reported: u64,
}

/// Marks the line as empty, and returns whether it had any text.
fn forget_line(typing: &Mutex<Typing>) -> bool {
    let mut typing = lock(typing);
    std::mem::take(&mut typing.is_begun)
}

/// Reports faults in typed or saved text, after a pause in typing.
fn report_faults(session: &Arc<Session>, typing: &Mutex<Typing>) {
    while !session.has_ended() {
        std::thread::sleep(POLL_INTERVAL);
        let mut typing = lock(typing);
        let Some(fault) = session.live.snapshot().fault else { continue };
        let is_new =
            fault.revision != typing.reported && session.reports_in_terminal(fault.revision);
        if typing.at.elapsed() < PAUSE || !is_new {
            continue;
        }
        typing.reported = fault.revision;
        drop(typing);
        session.say(&fault.render(notes::colored()));
    }
}

/// Functions that the line editor calls while a line is typed.
struct PromptHelper {
    session: Arc<Session>,
    typing: Arc<Mutex<Typing>>,
}

impl Helper for PromptHelper {}

impl Completer for PromptHelper {
    type Candidate = Pair;

    fn complete(
        &self,
        line: &str,
        pos: usize,
        _: &Context<'_>,
    ) -> rustyline::Result<(usize, Vec<Pair>)> {
        let (start, names) = candidates(line, pos);
        let pair = |name: String| Pair { display: name.clone(), replacement: name };
        Ok((start, names.into_iter().map(pair).collect()))
    }
}

impl Hinter for PromptHelper {
    type Hint = String;

    /// Called at every key. Also updates the picture from the line.
    fn hint(&self, line: &str, pos: usize, _: &Context<'_>) -> Option<String> {
        {
            let mut typing = lock(&self.typing);
            (typing.at, typing.is_begun) = (Instant::now(), !line.trim().is_empty());
        }
        self.session.live.type_line(line);
        if pos < line.len() {
            return None;
        }
        let command = line.trim_start().strip_prefix(':')?;
        let row = COMMANDS.iter().find(|row| row.name == command)?;
        (!row.arguments.is_empty()).then(|| format!(" {}", row.arguments))
    }
}

impl Highlighter for PromptHelper {
    fn highlight<'l>(&self, line: &'l str, _: usize) -> Cow<'l, str> {
        if !notes::colored_output() {
            return Cow::Borrowed(line);
        }
        let mut text = String::new();
        let mut end = 0;
        for (place, class) in token_classes(line) {
            let color = match class {
                TokenClass::Number => "36",
                // A single letter is clear enough without color.
                TokenClass::Word(_) if place.len() == 1 => continue,
                TokenClass::Word(WordKind::Function | WordKind::Value) => "34",
                TokenClass::Word(WordKind::Setting | WordKind::InSetting) => "35",
                TokenClass::Word(WordKind::Operator | WordKind::Drawing | WordKind::Program) => {
                    "33"
                }
                TokenClass::Comment => "2",
            };
            text.push_str(&line[end..place.start]);
            // Writing to a string cannot fail.
            let _ = write!(text, "\x1b[{color}m{}\x1b[0m", &line[place.clone()]);
            end = place.end;
        }
        text.push_str(&line[end..]);
        Cow::Owned(text)
    }

    fn highlight_hint<'h>(&self, hint: &'h str) -> Cow<'h, str> {
        if notes::colored_output() {
            Cow::Owned(format!("\x1b[2m{hint}\x1b[0m"))
        } else {
            Cow::Borrowed(hint)
        }
    }

    fn highlight_char(&self, _: &str, _: usize, kind: CmdKind) -> bool {
        kind != CmdKind::MoveCursor
    }
}

impl Validator for PromptHelper {
    fn validate(&self, context: &mut ValidationContext<'_>) -> rustyline::Result<ValidationResult> {
        Ok(if is_open(context.input()) {
            ValidationResult::Incomplete
        } else {
            ValidationResult::Valid(None)
        })
    }
}
