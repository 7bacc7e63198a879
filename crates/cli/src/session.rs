//! A live picture and the files around it, as prompt and window share them.

use super::arguments::InteractiveArgs;
use super::data::keep;
use super::gallery::listed;
use super::history::History;
use super::output::{Output, print};
use super::png_file::{Origin, check_png, write_png};
use super::render::{beautiful, kernel_settings};
use super::source::{self, Source};
use super::subject::{Subject, note_time};
use super::watch::{Change, Watch};
use super::{explain, notes, preview, tips};
use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use zeroset_live::{Axes, DocumentSource, Live, Refusal, Reply, Request};
use zeroset_render::overlay::Around;
use zeroset_render::picture::Settings;
use zeroset_scene::gallery::{example, examples};

/// What is shown when nothing is asked for.
const FIRST: &str = "gyroid";

/// A picture of a terminal that is to be saved gets so many pixels squared, at least.
const SMALLEST: usize = 128;

/// A picture to be saved or shown in the terminal is waited for so long.
const PATIENCE: Duration = Duration::from_mins(5);

/// Why a line was refused.
pub struct Wrong {
    /// One line of plain text.
    #[cfg_attr(not(feature = "window"), allow(dead_code))]
    pub summary: String,
    /// All of it for the terminal, with carets.
    pub full: String,
}

impl From<Refusal> for Wrong {
    fn from(refusal: Refusal) -> Self {
        let mut full = refusal.render(notes::colored());
        if let Some(letter) = refusal.missing_letter() {
            // Writing to a string cannot fail.
            let _ = write!(
                full,
                "\nhelp: type `{letter} = 1` to give it a value, and then the line once more \
                 (Up brings it back)"
            );
        }
        Self { summary: refusal.to_string().lines().next().unwrap_or_default().to_owned(), full }
    }
}

/// Shows a message above the line that is being typed, and tells whether it could.
pub type Printer = Box<dyn FnMut(&str) -> bool + Send>;

/// A live picture and the files around it.
pub struct Session {
    pub live: Live,
    /// The file that the document came from, and what watches it.
    file: Mutex<Option<(PathBuf, Watch)>>,
    /// Messages for the terminal, where the prompt knows how to show them.
    printer: Mutex<Option<Printer>>,
    /// Lines entered, in prompt and window.
    history: Mutex<History>,
    /// Held while a picture is saved, so that no two take the same name.
    saving: Mutex<()>,
    /// What the window has not yet said of the file.
    notice: Mutex<Option<String>>,
    /// A file of somebody else's that the document was to be written over.
    guarded: Mutex<Option<PathBuf>>,
    /// Whether pictures are as large as the terminal, not as a window.
    in_terminal: AtomicBool,
    /// Whether somebody asked for the gallery.
    gallery: AtomicBool,
    ended: AtomicBool,
    /// What is wrong with requests up to this one is said in the window, and not in the terminal.
    hushed: AtomicU64,
    /// Shown before anything else.
    pub welcome: String,
}

/// Locks what several threads use of a session.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // None of it is left half changed by a panic elsewhere.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    pub fn new(arguments: &InteractiveArgs) -> Result<Self> {
        arguments.size.held_whole()?;
        let settings = kernel_settings(&arguments.kernels)?;
        let given = arguments.source.as_deref();
        let source = match given {
            Some(given) => source::find(given)?,
            None => example(FIRST).context("the gallery has it")?.into(),
        };
        let Source { from, text } = source;
        let (mut width, mut height) = (arguments.size.width, arguments.size.height);
        if arguments.preview {
            // From the first picture on: one of the window's size would be made for nothing.
            (width, height) = preview::room();
        }
        let request = Request {
            source: from,
            text: text.into(),
            overrides: arguments.values.overrides()?,
            time: arguments.values.time()?,
            domain: arguments.values.domain(),
            clip: arguments.camera.clip(),
            choice: arguments.camera.choice(),
            orbit: None,
            axes: if arguments.preview { Axes::Off } else { Axes::Usual },
            settings: Settings { width, height, ..beautiful(&settings) },
        };
        if let Ok(document) = request.read() {
            note_time(request.time, &document);
        }
        let welcome = match given {
            None => format!(
                "This is the {FIRST}. Type a formula such as x^2+y^2+z^2 = 1, or :help for more."
            ),
            Some(_) if request.source == DocumentSource::Typed => {
                "Type a formula to replace this one, or :help for more.".to_owned()
            }
            Some(_) => {
                format!("{}. Type a formula to replace it, or :help for more.", request.source)
            }
        };
        Ok(Self {
            live: Live::new(request),
            file: Mutex::default(),
            printer: Mutex::default(),
            history: Mutex::default(),
            saving: Mutex::default(),
            notice: Mutex::default(),
            guarded: Mutex::default(),
            in_terminal: AtomicBool::new(arguments.preview),
            gallery: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            hushed: AtomicU64::new(0),
            welcome,
        })
    }

    /// The path of the file that the document came from, if it did.
    fn path(&self) -> Option<PathBuf> {
        match self.live.request().source {
            DocumentSource::File(path) => Some(path),
            _ => None,
        }
    }

    /// Begins to watch the file that the document came from, if there is one. Changes count from
    /// the text that was `read`, or without one from what is in the file now.
    pub fn watch(self: &Arc<Self>, read: Option<&str>) {
        let path = self.path();
        let mut file = lock(&self.file);
        // The old watch ends before its thread could find the lock taken.
        *file = None;
        let Some(path) = path else { return };
        let session = Arc::downgrade(self);
        let watched = DocumentSource::File(path.clone());
        let report = move |change| {
            let Some(session) = session.upgrade() else { return };
            // Whoever took the loading of the file back no longer wants to see it.
            if session.live.request().source != watched {
                return;
            }
            match change {
                Change::Text(text) => {
                    session.live.load(watched.clone(), &text, true);
                    if session.in_terminal.load(Ordering::Relaxed) {
                        let revision = session.live.revision();
                        std::thread::spawn(move || session.show_reloaded(revision));
                    }
                }
                Change::Lost(message) => {
                    let note = format!("note: the last version is still shown: {message}");
                    session.say(&note);
                    *lock(&session.notice) = Some(note);
                }
            }
        };
        let known = match read {
            Some(text) => text.to_owned(),
            // What was changed since it was read is not the file's.
            None => source::open(&path).map_or_else(|_| self.live.text(), |source| source.text),
        };
        match Watch::start(&path, &known, report) {
            Ok(watch) => *file = Some((path, watch)),
            Err(error) => {
                self.say(&format!("note: '{}' is not watched: {error:#}", path.display()));
            }
        }
    }

    /// Watches the file that the document came from, if that is another one now.
    pub fn follow(self: &Arc<Self>) {
        let watched = lock(&self.file).as_ref().map(|(path, _)| path.clone());
        if watched != self.path() {
            self.watch(None);
        }
    }

    /// Says that whatever is wrong with what was asked for so far is said in the window.
    #[cfg(feature = "window")]
    pub fn hush(&self) {
        self.hushed.fetch_max(self.live.revision(), Ordering::Relaxed);
    }

    /// That the file cannot be read any more, once.
    #[cfg(feature = "window")]
    pub fn notice(&self) -> Option<String> {
        lock(&self.notice).take()
    }

    /// Whether what is wrong with a request is to be said in the terminal.
    pub fn is_told(&self, revision: u64) -> bool {
        revision > self.hushed.load(Ordering::Relaxed)
    }

    /// Tells every thread to end. A picture that is waited for to be saved is given up.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
        self.live.refresh();
    }

    pub fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Adds to the lines that can be had again.
    pub fn recall(&self, lines: impl IntoIterator<Item = String>) {
        let mut history = lock(&self.history);
        lines.into_iter().for_each(|line| history.add(line));
    }

    /// Of the lines entered after the first `known` ones those that are kept, the latest last; all
    /// are known then.
    pub fn recalled(&self, known: &mut usize) -> Vec<String> {
        lock(&self.history).news(known)
    }

    /// Shows the picture of a file that was changed above the line that is being typed, unless
    /// something else is wanted before it is finished.
    fn show_reloaded(&self, revision: u64) {
        if let Some(seen) = self.live.finished(revision, PATIENCE) {
            let text = preview::text(&seen.picture, &seen.summary());
            if !lock(&self.printer).as_mut().is_some_and(|print| print(&text)) {
                // Whoever no longer reads misses nothing.
                let _ = print(&format!("{text}\n"));
            }
        }
    }

    /// Lets the prompt show messages from now on.
    pub fn print_with(&self, printer: Option<Printer>) {
        *lock(&self.printer) = printer;
    }

    /// Shows a message in the terminal without breaking the line that is being typed.
    pub fn say(&self, text: &str) {
        let printed = lock(&self.printer).as_mut().is_some_and(|print| print(text));
        if !printed {
            notes::say(text);
        }
    }

    /// Enters a line, from prompt or window, and does what it asks for; `png` saves the picture,
    /// under a name if one is given. Returns what it said in the terminal.
    ///
    /// # Errors
    /// What to show if it is refused.
    pub fn enter(
        self: &Arc<Self>,
        line: &str,
        png: impl FnOnce(Option<String>) -> Result<()>,
    ) -> Result<Option<String>, Wrong> {
        let mut said = None;
        let reply = self.live.enter(line)?;
        let done = match reply {
            Reply::Done => Ok(()),
            Reply::Say(text) => {
                self.say(&text);
                said = Some(text);
                Ok(())
            }
            Reply::Gallery => {
                if self.in_terminal.load(Ordering::Relaxed) {
                    self.say(listed(&examples()).trim_end());
                }
                self.gallery.store(true, Ordering::Relaxed);
                Ok(())
            }
            Reply::Load(from) => self.load(&from),
            Reply::Save(to) => self.save(to.as_deref()),
            Reply::Png(to) => png(to),
            Reply::Explain { code } => self.explain(code),
            Reply::Tips(wanted) => {
                tips::switch(wanted);
                Ok(())
            }
            Reply::Quit => {
                self.end();
                Ok(())
            }
        };
        done.map_err(|error| {
            let summary = format!("error: {error:#}");
            Wrong { full: summary.clone(), summary }
        })?;
        self.follow();
        keep("last.zset", &self.live.text());
        Ok(said)
    }

    /// Whether the gallery was asked for since this was last asked.
    #[cfg(feature = "window")]
    pub fn is_gallery_wanted(&self) -> bool {
        self.gallery.swap(false, Ordering::Relaxed)
    }

    fn load(self: &Arc<Self>, from: &str) -> Result<()> {
        let found = source::find(OsStr::new(from))?;
        anyhow::ensure!(
            found.from != DocumentSource::Typed,
            "there is no file or gallery surface named '{from}'"
        );
        let Source { from, text } = found;
        self.live.load(from, &text, false);
        self.watch(Some(&text));
        Ok(())
    }

    fn save(self: &Arc<Self>, to: Option<&str>) -> Result<()> {
        let path = match to {
            Some(path) => PathBuf::from(path),
            None => {
                self.path().context("the document did not come from a file; use :save FILE.zset")?
            }
        };
        // However either is spelled.
        let place = path.canonicalize().ok();
        let own = self.path().and_then(|own| own.canonicalize().ok());
        let is_another = place.is_some() && place != own;
        if is_another && lock(&self.guarded).replace(path.clone()).as_ref() != Some(&path) {
            anyhow::bail!(
                "there is another file '{}' already; enter the line once more to write over it",
                path.display()
            );
        }
        let text = self.live.text();
        Output::create(&path)?.finish(|out| writeln!(out, "{}", text.trim_end()))?;
        *lock(&self.guarded) = None;
        self.live.saved(&path, &text);
        self.follow();
        self.say(&format!("saved '{}'", path.display()));
        Ok(())
    }

    /// Waits for the fine picture of the request with this number, saves it and shows the command
    /// that reproduces it.
    ///
    /// # Errors
    /// If there will be no such picture, or it cannot be written.
    pub fn png(&self, to: Option<&str>, mut revision: u64) -> Result<()> {
        let _one_at_a_time = lock(&self.saving);
        let path = match to {
            Some(path) => PathBuf::from(path),
            None => (1..=9999)
                .map(|number| PathBuf::from(format!("zeroset-{number}.png")))
                .find(|path| !path.exists())
                .context("all names up to zeroset-9999.png are taken")?,
        };
        check_png(&path)?;
        let output = Output::create(&path)?;
        // What fits a terminal is too small for a file.
        let Settings { width, height, .. } = self.live.settings();
        let small =
            self.in_terminal.load(Ordering::Relaxed) && width * height < SMALLEST * SMALLEST;
        if small {
            let usual = Settings::default();
            self.live.resize(usual.width, usual.height);
            revision = self.live.revision();
        }
        let finished = self.live.finished(revision, PATIENCE);
        if small {
            self.live.resize(width, height);
        }
        let picture = finished
            .context("not saved: the picture was changed before it was finished, or never was")?;
        let buffer = &picture.picture.buffer;
        let rgb = Around::said(&picture.document).over((&*picture).into());
        let name = path.display().to_string();
        let command = picture.command(&name);
        let size = [buffer.width, buffer.height];
        output.finish(|out| write_png(out, &rgb, size, &Origin::command(&command)))?;
        self.say(&format!("saved '{name}'; the command that reproduces it:\n{command}"));
        Ok(())
    }

    fn explain(&self, code: bool) -> Result<()> {
        let seen = self.live.snapshot().rendering.context("there is no picture yet")?;
        let request = &seen.request;
        let subject = Subject {
            source: Source { from: request.source.clone(), text: request.text.to_string() },
            document: (*seen.document).clone(),
            domain: request.domain,
            parse: seen.parse,
        };
        let (method, precision) = (seen.picture.method, seen.picture.precision);
        let text = explain::explain(&subject, method, precision, code)?;
        self.say(text.trim_end());
        Ok(())
    }

    /// Asks for pictures that fit the terminal as it is now.
    pub fn fit_terminal(&self) {
        self.in_terminal.store(true, Ordering::Relaxed);
        // There they would take more than they tell.
        if self.live.request().axes != Axes::Off {
            self.live.set_axes(Axes::Off);
        }
        let (columns, rows) = preview::room();
        self.live.resize(columns, rows);
    }

    /// Shows the fine picture in the terminal, once it is there.
    ///
    /// # Errors
    /// If the terminal cannot be written to.
    pub fn show_preview(&self) -> Result<()> {
        if !self.live.wait(PATIENCE) {
            return Ok(());
        }
        let seen = self.live.snapshot();
        match (&seen.fault, &seen.rendering) {
            (Some(fault), _) => notes::say(&fault.render(notes::colored())),
            (None, Some(seen)) => {
                print(&format!("{}\n", preview::text(&seen.picture, &seen.summary())))?;
            }
            (None, None) => {}
        }
        Ok(())
    }
}
