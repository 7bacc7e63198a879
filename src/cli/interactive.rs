//! `zeroset` without a command: a window and a prompt, or a prompt with pictures in the terminal.
//!
//! Both ends share one [`Live`] and one [`Session`], which carries out what touches files.

use super::arguments::Interactive;
use super::notes;
use super::output::{Output, check_png, write_png};
use super::prompt;
use super::render::{camera_choice, check_depth};
use super::source::{self, Source};
use super::subject::{self, Subject};
use super::vector::Domain;
use super::watch::{Change, Watch};
use super::{explain, preview};
use anyhow::{Context, Result};
use glam::DVec3;
use std::collections::VecDeque;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use zeroset::live::{Live, Reply, Start};
use zeroset::picture::{Precision, Settings};
use zeroset::scene::DomainChoice;
use zeroset_trace::HalfSpace;

/// What is shown when nothing is asked for.
const FIRST: &str = "gyroid";

/// A picture to be saved has so many pixels squared, at least.
const SMALLEST: usize = 128;

/// A picture to be saved or shown in the terminal is waited for so long.
const PATIENCE: Duration = Duration::from_mins(5);

pub fn run(arguments: &Interactive) -> Result<ExitCode> {
    let session = Arc::new(Session::new(arguments)?);
    let window = if arguments.preview { Err("--preview".to_owned()) } else { open(arguments) };
    match window {
        #[cfg(feature = "window")]
        Ok(window) => {
            let prompt = Arc::clone(&session);
            let saved = super::terminal::State::save();
            let thread = std::thread::spawn(move || prompt::run(&prompt, false));
            window.run(&session)?;
            session.end();
            if thread.is_finished() {
                // It has reported its own errors.
                let _ = thread.join();
            }
            // The prompt may still be waiting for a key, with the terminal set up for that.
            saved.restore();
        }
        #[cfg(not(feature = "window"))]
        Ok(never) => match never {},
        Err(why) => {
            if !arguments.preview {
                notes::note(&format!("{why}, so pictures are shown in the terminal"));
            }
            session.fit_terminal();
            prompt::run(&session, true);
        }
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(feature = "window")]
fn open(arguments: &Interactive) -> Result<super::window::Window, String> {
    super::window::Window::open(arguments.size, arguments.ui_scale.map(usize::from))
}

#[cfg(not(feature = "window"))]
fn open(_: &Interactive) -> Result<std::convert::Infallible, String> {
    Err("this zeroset was built without a window".to_owned())
}

/// So many lines are kept of those that were entered, here, in the prompt and in the history file.
pub const KEPT_LINES: usize = 1000;

/// The latest lines entered.
#[derive(Default)]
struct History {
    lines: VecDeque<String>,
    /// How many came before them.
    dropped: usize,
}

impl History {
    fn add(&mut self, line: String) {
        if self.lines.len() == KEPT_LINES {
            self.lines.pop_front();
            self.dropped += 1;
        }
        self.lines.push_back(line);
    }
}

/// A live picture and the files around it.
pub struct Session {
    pub live: Live,
    /// The file that the document came from, and what watches it.
    file: Mutex<Option<(PathBuf, Watch)>>,
    /// Messages for the terminal, where the prompt knows how to show them.
    printer: Mutex<Option<prompt::Printer>>,
    /// Lines entered, in prompt and window.
    history: Mutex<History>,
    ended: AtomicBool,
    /// Shown before anything else.
    pub welcome: String,
}

impl Session {
    fn new(arguments: &Interactive) -> Result<Self> {
        let precision = arguments.precision.into();
        check_depth("--max-depth", arguments.max_depth, precision)?;
        let given = arguments.source.as_deref();
        let Source { name, text } = source::find(given.unwrap_or(OsStr::new(FIRST)))?;
        let time = arguments.time.as_deref().map(subject::time).transpose()?;
        let clip = arguments.camera.clip.map(|plane| {
            let [a, b, c, d] = plane.0;
            HalfSpace { normal: DVec3::new(a, b, c), offset: d }
        });
        let mut start = Start {
            name,
            text,
            overrides: subject::overrides(&arguments.define)?,
            time,
            domain: match arguments.domain {
                None => DomainChoice::Document,
                Some(Domain::Auto) => DomainChoice::Auto,
                Some(Domain::Bounds(bounds)) => DomainChoice::Bounds(bounds),
            },
            clip,
            choice: camera_choice(&arguments.camera)?,
            settings: Settings {
                width: arguments.size.width,
                height: arguments.size.height,
                precision,
                max_depth: arguments.max_depth,
                ..Settings::default()
            },
        };
        if arguments.preview {
            // From the first picture on: one of the window's size would be made for nothing.
            let (columns, rows) = preview::room();
            (start.settings.width, start.settings.height) = (columns, rows);
        }
        let welcome = match given {
            None => format!(
                "This is the {FIRST}. Type a formula such as x^2+y^2+z^2 = 1, or :help for more."
            ),
            Some(_) => format!("{}. Type a formula to replace it, or :help for more.", start.name),
        };
        let session = Self {
            live: Live::new(start),
            file: Mutex::new(None),
            printer: Mutex::new(None),
            history: Mutex::new(History::default()),
            ended: AtomicBool::new(false),
            welcome,
        };
        Ok(session)
    }

    /// Begins to watch the file that the document came from, if there is one.
    pub fn watch(self: &Arc<Self>) {
        let name = self.live.name();
        let path = Path::new(&name);
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        // The old watch ends before its thread could find the lock taken.
        *file = None;
        if !path.is_file() {
            return;
        }
        let session = Arc::downgrade(self);
        let report = move |change| {
            let Some(session) = session.upgrade() else { return };
            match change {
                Change::Text(text) => session.live.load(&session.live.name(), &text, true),
                Change::Lost(message) => session.say(&format!("note: {message}; still showing it")),
            }
        };
        match Watch::start(path, &self.live.text(), report) {
            Ok(watch) => *file = Some((path.to_owned(), watch)),
            Err(error) => self.say(&format!("note: '{name}' is not watched: {error:#}")),
        }
    }

    /// Tells every thread to end.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
    }

    pub fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Adds to the lines that can be had again.
    pub fn recall(&self, lines: impl IntoIterator<Item = String>) {
        let mut history = self.history.lock().unwrap_or_else(PoisonError::into_inner);
        lines.into_iter().for_each(|line| history.add(line));
    }

    /// Of the lines entered after the first `known` ones those that are kept, the latest last.
    pub fn recalled(&self, known: usize) -> Vec<String> {
        let history = self.history.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = known.saturating_sub(history.dropped);
        history.lines.iter().skip(kept).cloned().collect()
    }

    /// Lets the prompt show messages from now on.
    pub fn print_with(&self, printer: Option<prompt::Printer>) {
        *self.printer.lock().unwrap_or_else(PoisonError::into_inner) = printer;
    }

    /// Shows a message in the terminal without breaking the line that is being typed.
    pub fn say(&self, text: &str) {
        let mut printer = self.printer.lock().unwrap_or_else(PoisonError::into_inner);
        match &mut *printer {
            Some(printer) => printer.print(text),
            None => notes::say(text),
        }
    }

    /// Enters a line, from prompt or window, and does what it asks for.
    ///
    /// # Errors
    /// What to show if it is refused, with carets.
    pub fn enter(self: &Arc<Self>, line: &str) -> Result<(), String> {
        let reply = self.live.enter(line).map_err(|refusal| refusal.render(notes::coloured()))?;
        let wrong = |error: anyhow::Error| format!("error: {error:#}");
        match reply {
            Reply::Done => {}
            Reply::Say(text) => self.say(&text),
            Reply::Load(from) => {
                let Source { name, text } = source::find(OsStr::new(&from)).map_err(wrong)?;
                if name == "formula" {
                    return Err(format!("error: there is no file and no gallery name '{from}'"));
                }
                self.live.load(&name, &text, false);
                self.watch();
            }
            Reply::Save(to) => self.save(to.as_deref()).map_err(wrong)?,
            Reply::Png(to) => self.png(to.as_deref()).map_err(wrong)?,
            Reply::Explain { code } => self.explain(code).map_err(wrong)?,
            Reply::Quit => self.end(),
        }
        prompt::remember(&self.live.text());
        Ok(())
    }

    fn save(self: &Arc<Self>, to: Option<&str>) -> Result<()> {
        let path = if let Some(path) = to {
            PathBuf::from(path)
        } else {
            let file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            let known = file.as_ref().map(|(path, _)| path.clone());
            known.context("the document came from no file; say :save FILE.zset")?
        };
        let text = self.live.text();
        Output::create(&path)?.finish(|out| writeln!(out, "{}", text.trim_end()))?;
        self.say(&format!("saved '{}'", path.display()));
        Ok(())
    }

    /// Saves the fine picture and shows the command that makes it again.
    pub fn png(&self, to: Option<&str>) -> Result<()> {
        let path = match to {
            Some(path) => PathBuf::from(path),
            None => (1..=9999)
                .map(|number| PathBuf::from(format!("zeroset-{number}.png")))
                .find(|path| !path.exists())
                .context("every name is taken")?,
        };
        check_png(&path)?;
        let output = Output::create(&path)?;
        // What fits a terminal is too small for a file.
        let settings = self.live.settings();
        let small = settings.width * settings.height < SMALLEST * SMALLEST;
        if small {
            let usual = Settings::default();
            self.live.resize(usual.width, usual.height);
        }
        self.live.wait(PATIENCE);
        let frame = self.live.view().frame.filter(|frame| !frame.coarse);
        if small {
            self.live.resize(settings.width, settings.height);
        }
        let frame = frame.context("there is no finished picture")?;
        let buffer = &frame.picture.buffer;
        output.finish(|out| write_png(out, &frame.picture.rgb, buffer.width, buffer.height))?;
        let name = path.display().to_string();
        self.say(&format!("saved '{name}'; the same again:\n{}", frame.command(&name, quote)));
        Ok(())
    }

    fn explain(&self, code: bool) -> Result<()> {
        let frame = self.live.view().frame.context("there is no picture yet")?;
        let subject = Subject {
            source: Source { name: frame.wish.name.clone(), text: frame.wish.text.to_string() },
            document: (*frame.document).clone(),
            domain: frame.wish.domain,
            parse: frame.parse,
        };
        let text = match frame.picture.precision {
            Precision::F32 => explain::explain::<f32>(&subject, code)?,
            Precision::F64 => explain::explain::<f64>(&subject, code)?,
        };
        self.say(text.trim_end());
        Ok(())
    }

    /// Asks for pictures that fit the terminal as it is now.
    pub fn fit_terminal(&self) {
        let (columns, rows) = preview::room();
        self.live.resize(columns, rows);
    }

    /// Shows the fine picture in the terminal, once it is there.
    pub fn show_preview(&self) {
        if !self.live.wait(PATIENCE) {
            return;
        }
        let view = self.live.view();
        match (&view.fault, &view.frame) {
            (Some(fault), _) => notes::say(&fault.render(notes::coloured())),
            (None, Some(frame)) => {
                preview::print(&frame.picture);
                println!("{}", frame.summary());
            }
            (None, None) => {}
        }
    }
}

/// `text` as one word of a POSIX shell.
pub fn quote(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_lines_are_kept_and_counted_from_the_first() {
        let mut history = History::default();
        (0..KEPT_LINES + 5).for_each(|line| history.add(line.to_string()));
        assert_eq!((history.lines.len(), history.dropped), (KEPT_LINES, 5));
        assert_eq!(history.lines.front().map(String::as_str), Some("5"));
    }
}
