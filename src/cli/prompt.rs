//! The prompt: a line that is typed, with history, completion and colours. What a line means is decided elsewhere.

use super::interactive::{KEPT_LINES, Session};
use super::{notes, preview};
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
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use zeroset::gallery;
use zeroset::live::COMMANDS;

/// What is wrong with a line is said when nothing has been typed for so long.
const PAUSE: Duration = Duration::from_millis(300);
/// How often that is looked at.
const LOOK: Duration = Duration::from_millis(50);

/// Where history and the last document are kept, or `None` if there is no place for them.
fn place() -> Option<PathBuf> {
    let from = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = from("XDG_DATA_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(from("HOME")?).join(".local/share")))?;
    let place = base.join("zeroset");
    std::fs::create_dir_all(&place).ok()?;
    Some(place)
}

/// Keeps the document, so that it is there after whatever ends the program.
pub fn remember(text: &str) {
    let Some(place) = place() else { return };
    // A document that cannot be kept is no reason to stop.
    if let Ok(output) = super::output::Output::create(&place.join("last.zset")) {
        let _ = output.finish(|out| writeln!(out, "{text}"));
    }
}

/// Shows messages above the line that is being typed.
pub struct Printer(Box<dyn ExternalPrinter + Send>);

impl Printer {
    pub fn print(&mut self, text: &str) {
        if self.0.print(format!("{text}\n")).is_err() {
            notes::say(text);
        }
    }
}

/// Reads and enters lines until the end of input or of the session. With `preview`, pictures are shown as well.
pub fn run(session: &Arc<Session>, preview: bool) {
    session.watch();
    notes::say(&session.welcome);
    if preview {
        session.show_preview();
        preview::drop_late_answer();
    }
    if let Err(error) = read_lines(session, preview) {
        notes::say(&format!("error: the prompt cannot go on: {error}"));
    }
}

fn read_lines(session: &Arc<Session>, preview: bool) -> rustyline::Result<()> {
    let config = Config::builder()
        .completion_type(CompletionType::List)
        .max_history_size(KEPT_LINES)?
        .build();
    let typed = Arc::new(Mutex::new(Typed { at: Instant::now(), reported: 0 }));
    let mut editor: Editor<Line, FileHistory> = Editor::with_config(config)?;
    editor.set_helper(Some(Line { session: Arc::clone(session), typed: Arc::clone(&typed) }));
    let history = place().map(|place| place.join("history"));
    if let Some(history) = &history {
        // There is none the first time.
        let _ = editor.load_history(history);
        session.recall(editor.history().iter().cloned());
    }
    let mut known = session.recalled(0).len();
    let mut last = preview.then(|| session.live.shown());
    let interactive = std::io::stdin().is_terminal();
    if interactive && let Ok(printer) = editor.create_external_printer() {
        session.print_with(Some(Printer(Box::new(printer))));
        let session = Arc::clone(session);
        std::thread::spawn(move || report_faults(&session, &typed));
    }
    while !session.has_ended() {
        for line in session.recalled(known) {
            editor.add_history_entry(line)?;
            known += 1;
        }
        let line = match editor.readline("zeroset> ") {
            Ok(line) => line,
            Err(ReadlineError::Eof | ReadlineError::Interrupted) => {
                // Without a terminal the window, if there is one, goes on.
                if interactive || preview {
                    session.end();
                }
                break;
            }
            Err(error) => {
                session.print_with(None);
                if interactive {
                    // The terminal has gone, and whoever sat there.
                    session.end();
                }
                return Err(error);
            }
        };
        if !line.trim().is_empty() {
            editor.add_history_entry(&line)?;
            session.recall([line.clone()]);
            known += 1;
        }
        if let Some(history) = &history {
            // At once, so that nothing is lost however the program ends.
            let _ = editor.append_history(history);
        }
        match session.enter(&line) {
            // What a command says is not to scroll away behind a picture that was there already.
            Ok(()) if preview && !line.trim().is_empty() && !session.has_ended() => {
                session.fit_terminal();
                let shown = session.live.shown();
                if last.as_ref() != Some(&shown) {
                    session.show_preview();
                    last = Some(shown);
                }
            }
            Ok(()) => {}
            Err(message) => notes::say(&message),
        }
    }
    session.print_with(None);
    Ok(())
}

/// When something was typed last, and which wish's fault was shown last.
struct Typed {
    at: Instant,
    reported: u64,
}

/// Says what is wrong with what is typed or saved, after a pause.
fn report_faults(session: &Arc<Session>, typed: &Mutex<Typed>) {
    while !session.has_ended() {
        std::thread::sleep(LOOK);
        let mut typed = typed.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(fault) = session.live.view().fault else { continue };
        if typed.at.elapsed() < PAUSE || fault.revision == typed.reported {
            continue;
        }
        typed.reported = fault.revision;
        drop(typed);
        session.say(&fault.render(notes::coloured()));
    }
}

/// Everything that happens while a line is typed.
struct Line {
    session: Arc<Session>,
    typed: Arc<Mutex<Typed>>,
}

impl Helper for Line {}

/// Where the word begins that ends at `pos`.
fn word_start(line: &str, pos: usize) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    line[..pos].char_indices().rev().take_while(|(_, c)| part(*c)).last().map_or(pos, |(at, _)| at)
}

/// What may stand where the line's last word does.
pub fn candidates(line: &str, pos: usize) -> (usize, Vec<String>) {
    let head = &line[..pos];
    if let Some(rest) = head.trim_start().strip_prefix(':') {
        let start = pos - rest.len();
        if !rest.contains(' ') {
            let names = COMMANDS.iter().map(|row| row.name).filter(|name| name.starts_with(rest));
            return (start, names.map(str::to_owned).collect());
        }
        if let Some((_, name)) = rest.split_once(' ').filter(|(command, _)| *command == "load") {
            let slugs = gallery::examples().into_iter().map(|example| example.slug.to_owned());
            let found = slugs.filter(|slug| slug.starts_with(name)).collect();
            return (pos - name.len(), found);
        }
    }
    let start = word_start(line, pos);
    let word = &line[start..pos];
    if word.is_empty() {
        return (start, Vec::new());
    }
    let mut names: Vec<String> = zeroset_syntax::language_names()
        .filter(|name| name.starts_with(word))
        .map(str::to_owned)
        .collect();
    names.sort();
    names.dedup();
    (start, names)
}

impl Completer for Line {
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

impl Hinter for Line {
    type Hint = String;

    /// Called at every key, so that the picture follows what is typed.
    fn hint(&self, line: &str, pos: usize, _: &Context<'_>) -> Option<String> {
        self.typed.lock().unwrap_or_else(PoisonError::into_inner).at = Instant::now();
        self.session.live.type_line(line);
        if pos < line.len() {
            return None;
        }
        let command = line.trim_start().strip_prefix(':')?;
        let row = COMMANDS.iter().find(|row| row.name == command)?;
        (!row.arguments.is_empty()).then(|| format!(" {}", row.arguments))
    }
}

impl Highlighter for Line {
    fn highlight<'l>(&self, line: &'l str, _: usize) -> Cow<'l, str> {
        if !notes::coloured_output() {
            return Cow::Borrowed(line);
        }
        let mut text = String::new();
        let mut rest = line;
        while let Some(first) = rest.chars().next() {
            let kind = |c: char| {
                if c.is_ascii_digit() || c == '.' {
                    "36"
                } else if c.is_alphabetic() || c == '_' {
                    "0"
                } else {
                    "2"
                }
            };
            let same = kind(first);
            let end = rest.find(|c| kind(c) != same).unwrap_or(rest.len());
            let (part, after) = rest.split_at(end);
            let known = same == "0" && part.len() > 1;
            let known = known && zeroset_syntax::language_names().any(|name| name == part);
            let colour = if known { "34" } else { same };
            // Writing to a string cannot fail.
            let _ = match colour {
                "36" | "34" => write!(text, "\x1b[{colour}m{part}\x1b[0m"),
                _ => text.write_str(part),
            };
            rest = after;
        }
        Cow::Owned(text)
    }

    fn highlight_hint<'h>(&self, hint: &'h str) -> Cow<'h, str> {
        if notes::coloured_output() {
            Cow::Owned(format!("\x1b[2m{hint}\x1b[0m"))
        } else {
            Cow::Borrowed(hint)
        }
    }

    fn highlight_char(&self, _: &str, _: usize, kind: CmdKind) -> bool {
        kind != CmdKind::MoveCursor
    }
}

impl Validator for Line {
    fn validate(&self, context: &mut ValidationContext<'_>) -> rustyline::Result<ValidationResult> {
        Ok(if is_open(context.input()) {
            ValidationResult::Incomplete
        } else {
            ValidationResult::Valid(None)
        })
    }
}

/// Whether a bracket is still open, so that another line is to come.
pub fn is_open(text: &str) -> bool {
    let code = text.lines().map(|line| line.split('#').next().unwrap_or(line));
    let depth: i64 = code
        .flat_map(str::chars)
        .map(|c| match c {
            '(' | '[' | '{' => 1,
            ')' | ']' | '}' => -1,
            _ => 0,
        })
        .sum();
    depth > 0 && !text.trim_start().starts_with(':')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_completed_where_they_stand() {
        assert_eq!(candidates(":sta", 4), (1, vec!["status".to_owned()]));
        assert_eq!(candidates(":load gyr", 9), (6, vec!["gyroid".to_owned()]));
        let (start, names) = candidates("x + smooth", 10);
        assert!(start == 4 && names.contains(&"smoothstep".to_owned()), "{names:?}");
        assert_eq!(candidates("x + ", 4).1, Vec::<String>::new());
        assert_eq!(candidates("é²x", 5).0, 0);
    }

    #[test]
    fn open_brackets_ask_for_another_line() {
        assert!(is_open("max(x,"));
        assert!(is_open("x = 1 {y > 0,\n"));
        assert!(
            !is_open("max(x,\ny)") && !is_open("x # (") && !is_open(":help (") && !is_open(")")
        );
    }
}
