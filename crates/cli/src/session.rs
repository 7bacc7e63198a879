//! A session: the live picture, its document's watched file, and the history of prompt and window.

use super::arguments::{InteractiveArgs, USUAL_SIZE};
use super::data::{data_directory, note_file, store_text};
use super::gallery::listed;
use super::history::History;
use super::output::{OutputFile, print};
use super::png_file::PictureOrigin;
use super::render::{kernel_settings, with_effects};
use super::source::{self, Source};
use super::subject::{Subject, note_time};
use super::waiting::{self, Waiting};
use super::watch::{Change, Watch};
use super::{explain, measure, mesh, notes, preview, tips};
use anyhow::{Context, Result};
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use zeroset_live::{Axes, DocumentSource, Live, Refusal, Rendering, Reply, Request};
use zeroset_render::overlay::Overlay;
use zeroset_render::picture::Settings;
use zeroset_render::pixels::{Pixels, samples};
use zeroset_render::png_file::{PngFormat, check_png, write_png};
use zeroset_scene::gallery::{all, example};

/// The gallery surface that is shown if no document is given.
const DEFAULT_SURFACE: &str = "gyroid";

/// File in the data directory with the last document that had unsaved changes.
const LAST: &str = "last.zset";
/// File with the last such document that was offered at a start.
const OFFERED: &str = "offered.zset";
/// Name of that document for `:load`.
const LAST_NAME: &str = "last";

/// Number of unsaved lines up to which the window quits without a question.
#[cfg(feature = "window")]
const FEW_LINES: usize = 3;

/// A terminal picture is saved at the default size if it is smaller than a square of this side.
const MIN_SAVED_SIDE: usize = 128;

/// Longest wait for a picture that is to be saved or shown in the terminal.
const PATIENCE: Duration = Duration::from_mins(5);

/// The reason why a line was refused.
pub struct LineError {
    /// The reason as one line of plain text.
    #[cfg_attr(not(feature = "window"), allow(dead_code))]
    pub summary: String,
    /// The reason in full, for the terminal, with carets.
    pub full: String,
}

impl From<Refusal> for LineError {
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

/// Shows a message above the line that is being typed. Returns whether it was shown.
pub type Printer = Box<dyn FnMut(&str) -> bool + Send>;

/// A live picture, with the state that prompt and window share.
pub struct Session {
    pub live: Live,
    /// Path of the file that the document came from, and the running watch on that file.
    file: Mutex<Option<(PathBuf, Watch)>>,
    /// Shows messages in the terminal while the prompt is running.
    printer: Mutex<Option<Printer>>,
    /// Lines entered, in prompt and window.
    history: Mutex<History>,
    /// Held while a picture is saved, so that no two saves choose the same name.
    saving: Mutex<()>,
    /// A note on whether the file can be read. The window shows it and takes it from here.
    notice: Mutex<Option<String>>,
    /// An existing file that `:save` refused to overwrite. Entering the line again overwrites the
    /// file.
    refused_overwrite: Mutex<Option<PathBuf>>,
    /// Whether pictures have the terminal's size, not the window's.
    in_terminal: AtomicBool,
    /// True if the gallery was requested since the window last checked.
    gallery: AtomicBool,
    ended: AtomicBool,
    /// Number of times that Ctrl-C was pressed while the program worked.
    interrupts: AtomicU64,
    /// Number of commands at work that Ctrl-C gives up.
    works: AtomicU64,
    /// True if [`Session::say_what_is_kept`] has printed its message.
    has_parted: AtomicBool,
    /// Faults in requests up to this revision are shown in the window only.
    reported_in_window: AtomicU64,
    /// The first message that is shown.
    pub welcome: String,
}

/// Locks a mutex of a session, even after a panic in another thread.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic leaves no part of a session's state half changed.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    pub fn new(arguments: &InteractiveArgs) -> Result<Self> {
        let size = arguments.size.unwrap_or(USUAL_SIZE);
        size.held_whole()?;
        let settings = kernel_settings(&arguments.kernels)?;
        let given = arguments.source.as_deref();
        let source = match given {
            None if arguments.last => Source { from: DocumentSource::Typed, text: last()? },
            Some(given) => source::find(given)?,
            None => example(DEFAULT_SURFACE).context("the gallery has it")?.into(),
        };
        let Source { from, text } = source;
        if let DocumentSource::File(path) = &from {
            note_file(path);
        }
        let (mut width, mut height) = (size.width, size.height);
        if arguments.preview {
            // Start at the terminal's size, since a picture at the window's size would be wasted.
            (width, height) = preview::pixel_size();
        }
        let request = Request {
            source: from,
            preview: None,
            text: text.into(),
            overrides: arguments.values.overrides()?,
            time: arguments.values.time()?,
            domain: arguments.values.domain(),
            clip: arguments.camera.clip(),
            choice: arguments.camera.choice(),
            orbit: None,
            axes: if arguments.preview { Axes::Off } else { Axes::Usual },
            settings: Settings { width, height, ..with_effects(&settings) },
        };
        if let Ok(document) = request.read() {
            note_time(request.time, &document);
        }
        let welcome = match given {
            None if arguments.last => {
                "This is the last unsaved document. Type a formula, or :help for more.".to_owned()
            }
            None if is_last_offered() => format!(
                "The last document was not saved: `:load {LAST_NAME}` opens it. Or type a formula."
            ),
            None => format!(
                "This is the {DEFAULT_SURFACE}. Type a formula such as x^2+y^2+z^2 = 1, or :help for more."
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
            refused_overwrite: Mutex::default(),
            in_terminal: AtomicBool::new(arguments.preview),
            gallery: AtomicBool::new(false),
            ended: AtomicBool::new(false),
            interrupts: AtomicU64::new(0),
            works: AtomicU64::new(0),
            has_parted: AtomicBool::new(false),
            reported_in_window: AtomicU64::new(0),
            welcome,
        })
    }

    /// Returns the path of the file that the document came from, if it came from one.
    pub fn path(&self) -> Option<PathBuf> {
        match self.live.request().source {
            DocumentSource::File(path) => Some(path),
            _ => None,
        }
    }

    /// Watches the file that the document came from, if there is one. Loads the file's text
    /// whenever it differs from the text loaded last. At first, `read` counts as loaded, or else
    /// the file's text.
    pub fn watch(self: &Arc<Self>, read: Option<&str>) {
        let path = self.path();
        let mut file = lock(&self.file);
        // End the old watch and its thread before another one starts.
        *file = None;
        let Some(path) = path else { return };
        let session = Arc::downgrade(self);
        let watched = DocumentSource::File(path.clone());
        let watched_path = path.clone();
        let report = move |change| {
            let Some(session) = session.upgrade() else { return };
            // The document may have another source by now, for example after an undo.
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
                    session
                        .note_of_file(format!("note: the last version is still shown: {message}"));
                }
                Change::Found => session
                    .note_of_file(format!("note: '{}' can be read again", watched_path.display())),
            }
        };
        let known = match read {
            Some(text) => text.to_owned(),
            // The document may contain edits that the file does not.
            None => source::open(&path).map_or_else(|_| self.live.text(), |source| source.text),
        };
        match Watch::start(&path, &known, report) {
            Ok(watch) => *file = Some((path, watch)),
            Err(error) => {
                self.say(&format!("note: '{}' is not watched: {error:#}", path.display()));
            }
        }
    }

    /// Watches the file that the document came from, unless it is watched already.
    pub fn follow(self: &Arc<Self>) {
        let watched = lock(&self.file).as_ref().map(|(path, _)| path.clone());
        if watched != self.path() {
            self.watch(None);
        }
    }

    /// Shows the faults of all requests so far in the window only, not in the terminal.
    #[cfg(feature = "window")]
    pub fn report_in_window(&self) {
        self.reported_in_window.fetch_max(self.live.revision(), Ordering::Relaxed);
    }

    /// Takes the note on whether the file can be read, if there is one that was not yet shown.
    #[cfg(feature = "window")]
    pub fn notice(&self) -> Option<String> {
        lock(&self.notice).take()
    }

    /// Returns whether the terminal shows the fault of the request with this revision.
    pub fn reports_in_terminal(&self, revision: u64) -> bool {
        revision > self.reported_in_window.load(Ordering::Relaxed)
    }

    /// Tells every thread to end. A save that waits for its picture is abandoned.
    pub fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
        self.live.refresh();
    }

    /// Cancels the current work of the program: the running picture, or else a command. Returns
    /// false if there is no work.
    pub fn give_up(&self) -> bool {
        self.interrupts.fetch_add(1, Ordering::Relaxed);
        if self.live.give_up() {
            self.say("the picture was given up; Ctrl-C once more ends the program");
            return true;
        }
        self.works.load(Ordering::Relaxed) > 0
    }

    pub fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Relaxed)
    }

    /// Adds lines to the history.
    pub fn recall(&self, lines: impl IntoIterator<Item = String>) {
        let mut history = lock(&self.history);
        lines.into_iter().for_each(|line| history.add(line));
    }

    /// Returns the lines in the history, oldest first, without the first `known` lines ever
    /// entered. Sets `known` to the number of all lines entered so far.
    pub fn history_since(&self, known: &mut usize) -> Vec<String> {
        lock(&self.history).since(known)
    }

    /// Shows the reloaded file's picture above the line that is being typed. Does nothing if a
    /// newer request replaces the picture.
    fn show_reloaded(&self, revision: u64) {
        if let Some(seen) = self.live.finished(revision, PATIENCE) {
            let text = preview::text(&seen);
            if !lock(&self.printer).as_mut().is_some_and(|print| print(&text)) {
                // If printing fails, nobody reads the output.
                let _ = print(&format!("{text}\n"));
            }
        }
    }

    /// Sets the prompt's message printer, or removes it.
    pub fn print_with(&self, printer: Option<Printer>) {
        *lock(&self.printer) = printer;
    }

    /// Shows a note on the file in the terminal and the window.
    fn note_of_file(&self, note: String) {
        self.say(&note);
        *lock(&self.notice) = Some(note);
    }

    /// Shows a message in the terminal without breaking the line that is being typed.
    pub fn say(&self, text: &str) {
        let printed = lock(&self.printer).as_mut().is_some_and(|print| print(text));
        if !printed {
            notes::say(text);
        }
    }

    /// Executes a line from prompt or window. If the line saves a picture, calls `png` with the
    /// line's file name, if it has one. Returns the message that was shown in the terminal, if any.
    ///
    /// # Errors
    /// If the line is refused.
    pub fn enter(
        self: &Arc<Self>,
        line: &str,
        png: impl FnOnce(Option<String>) -> Result<()>,
    ) -> Result<Option<String>, LineError> {
        let reply = self.live.enter(line)?;
        let done = match reply {
            Reply::Done => Ok(None),
            Reply::Say(text) => Ok(Some(text)),
            Reply::Gallery => {
                if self.in_terminal.load(Ordering::Relaxed) {
                    self.say(listed(&all()).trim_end());
                }
                self.gallery.store(true, Ordering::Relaxed);
                Ok(None)
            }
            Reply::Load(from) => self.load(&from).map(|()| None),
            Reply::Save(to) => self.save(to.as_deref()).map(Some),
            Reply::Png(to) => png(to).map(|()| None),
            Reply::Mesh { to, tolerance } => self
                .find_out(|seen, wanted| mesh::of_picture(seen, &to, tolerance, wanted))
                .map(Some),
            Reply::Measure => self.find_out(measure::of_picture).map(Some),
            Reply::Explain { code } => self.explain(code).map(Some),
            Reply::Tips(wanted) => {
                tips::switch(wanted);
                Ok(None)
            }
            Reply::Quit => {
                self.end();
                Ok(None)
            }
        };
        let said = done.map_err(|error| {
            let summary = format!("error: {error:#}");
            LineError { full: summary.clone(), summary }
        })?;
        if let Some(text) = &said {
            self.say(text.trim_end());
        }
        self.follow();
        self.keep();
        Ok(said)
    }

    /// Gives a letter the value 1.
    ///
    /// # Errors
    /// If the document would have errors.
    #[cfg(feature = "window")]
    pub fn define(self: &Arc<Self>, letter: char) -> Result<(), LineError> {
        self.live.define(letter, "1")?;
        self.keep();
        Ok(())
    }

    /// Replaces the document by a pasted text.
    #[cfg(feature = "window")]
    pub fn paste(self: &Arc<Self>, text: &str) {
        self.live.load(DocumentSource::Typed, text, false);
        self.follow();
        self.keep();
    }

    /// Keeps a document that has unsaved changes in the data directory.
    pub fn keep(&self) {
        if self.live.is_changed() {
            store_text(LAST, &self.live.text());
        }
    }

    /// Returns whether quitting would leave work unsaved: changes to a file, or more lines than
    /// [`FEW_LINES`]. Values of sliders do not count.
    #[cfg(feature = "window")]
    pub fn has_unsaved_work(&self) -> bool {
        let typed = self.live.typed_lines();
        typed.is_some_and(|lines| self.path().is_some() || lines > FEW_LINES)
    }

    /// Keeps the document if it has unsaved changes, and says where.
    pub fn say_what_is_kept(&self) {
        self.keep();
        if self.live.is_changed()
            && !self.has_parted.swap(true, Ordering::Relaxed)
            && let Some(directory) = data_directory()
        {
            notes::note(&format!(
                "the document was not saved; it is kept in '{}', and `zeroset --last` or `:load \
                 {LAST_NAME}` opens it again",
                directory.join(LAST).display()
            ));
        }
    }

    /// Returns whether the gallery was requested since the last call.
    #[cfg(feature = "window")]
    pub fn is_gallery_wanted(&self) -> bool {
        self.gallery.swap(false, Ordering::Relaxed)
    }

    fn load(self: &Arc<Self>, from: &str) -> Result<()> {
        if from == LAST_NAME && !Path::new(from).exists() {
            self.live.load(DocumentSource::Typed, &last()?, false);
            return Ok(());
        }
        let found = source::find(OsStr::new(from))?;
        anyhow::ensure!(
            found.from != DocumentSource::Typed,
            "there is no file or gallery surface named '{from}'"
        );
        let Source { from, text } = found;
        if let DocumentSource::File(path) = &from {
            note_file(path);
        }
        self.live.load(from, &text, false);
        self.watch(Some(&text));
        Ok(())
    }

    /// Saves the document, and returns a message that says where.
    fn save(self: &Arc<Self>, to: Option<&str>) -> Result<String> {
        let path = match to {
            Some(path) => PathBuf::from(path),
            None => {
                self.path().context("the document did not come from a file; use :save FILE.zset")?
            }
        };
        // Compare canonical paths, since one file can be spelled in several ways.
        let place = path.canonicalize().ok();
        let own = self.path().and_then(|own| own.canonicalize().ok());
        let is_another = place.is_some() && place != own;
        if is_another && lock(&self.refused_overwrite).replace(path.clone()).as_ref() != Some(&path)
        {
            anyhow::bail!(
                "there is another file '{}' already; enter the line once more to write over it",
                path.display()
            );
        }
        let text = self.live.text();
        OutputFile::create(&path)?.finish(|out| writeln!(out, "{}", text.trim_end()))?;
        *lock(&self.refused_overwrite) = None;
        self.live.saved(&path, &text);
        note_file(&path);
        // The copy of this text is not offered at the next start.
        if last().is_ok_and(|last| last.trim_end() == text.trim_end()) {
            store_text(OFFERED, text.trim_end());
        }
        self.follow();
        Ok(format!("saved '{}'", path.display()))
    }

    /// Saves the fine picture of the request with this revision, and shows the command that
    /// reproduces it. Waits for the picture. Returns the file's path.
    ///
    /// # Errors
    /// If the picture is not finished in time, a newer request replaces it, or it cannot be
    /// written.
    pub fn png(&self, to: Option<&str>, mut revision: u64) -> Result<PathBuf> {
        let _one_at_a_time = lock(&self.saving);
        let path = match to {
            Some(path) => PathBuf::from(path),
            None => unused_name("png")?,
        };
        check_png(&path).map_err(anyhow::Error::msg)?;
        let output = OutputFile::create(&path)?;
        // A picture that fits a terminal is too small for a file.
        let Settings { width, height, .. } = self.live.settings();
        let small = self.in_terminal.load(Ordering::Relaxed)
            && width * height < MIN_SAVED_SIDE * MIN_SAVED_SIDE;
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
        let document = &picture.document;
        // A terminal shows no axes for lack of room, but a file has room for them.
        let overlay = if self.in_terminal.load(Ordering::Relaxed) {
            Overlay::said(document)
        } else {
            Overlay::new(picture.request.axes.are_shown(document), document)
        };
        let Pixels { rgb, alpha } = overlay.over((&*picture).into());
        let name = path.display().to_string();
        let from = &picture.request.source;
        let command = picture.command(&name, overlay.axes, |text| source::shell_word(from, text));
        let size = [buffer.width, buffer.height];
        let origin = PictureOrigin::command(&command);
        let (samples, format) = (samples(&rgb, &alpha, &[]), PngFormat::of(&alpha, &[]));
        output.finish(|out| write_png(out, &samples, format, size, &origin.chunks))?;
        self.say(&format!("saved '{name}'; the command that reproduces it:\n{command}"));
        Ok(path)
    }

    /// Waits for the picture, and returns a text about its surfaces. The work is given up when the
    /// session ends.
    fn find_out(
        &self,
        describe: impl FnOnce(&Rendering, &(dyn Fn() -> bool + Sync)) -> Result<String>,
    ) -> Result<String> {
        let seen = self.live.finished(self.live.revision(), PATIENCE);
        let seen = seen.context("there is no picture yet, or it was changed")?;
        let before = self.interrupts.load(Ordering::Relaxed);
        let wanted = || !self.has_ended() && self.interrupts.load(Ordering::Relaxed) == before;
        self.works.fetch_add(1, Ordering::Relaxed);
        let text = describe(&seen, &wanted);
        self.works.fetch_sub(1, Ordering::Relaxed);
        text
    }

    fn explain(&self, code: bool) -> Result<String> {
        let seen = self.live.snapshot().rendering.context("there is no picture yet")?;
        let request = &seen.request;
        let subject = Subject {
            source: Source { from: request.source.clone(), text: request.text.to_string() },
            document: (*seen.document).clone(),
            domain: request.domain,
            parse: seen.parse,
        };
        let (method, precision) = (seen.picture.method, seen.picture.precision);
        explain::explain(&subject, method, precision, code)
    }

    /// Requests pictures that fit the terminal's current size.
    pub fn fit_terminal(&self) {
        self.in_terminal.store(true, Ordering::Relaxed);
        // Show no axes, since they would take too much of a small picture.
        if self.live.request().axes != Axes::Off {
            self.live.set_axes(Axes::Off);
        }
        let (columns, rows) = preview::pixel_size();
        self.live.resize(columns, rows);
    }

    /// Waits for the fine picture and shows it in the terminal. Meanwhile shows coarse pictures.
    ///
    /// # Errors
    /// If the terminal cannot be written to.
    pub fn show_preview(&self) -> Result<()> {
        let (begun, mut waiting) = (Instant::now(), Waiting::begin());
        while !self.live.wait(waiting::STEP) {
            if begun.elapsed() > PATIENCE {
                return waiting.end();
            }
            waiting.show(&self.live.snapshot(), self.live.revision())?;
        }
        waiting.end()?;
        let seen = self.live.snapshot();
        let revision = self.live.revision();
        if seen.rendering.as_ref().is_some_and(|seen| seen.revision < revision)
            && seen.fault.is_none()
        {
            // The picture was given up. The last one would be mistaken for it.
            return Ok(());
        }
        match (&seen.fault, &seen.rendering) {
            (Some(fault), _) => notes::say(&fault.render(notes::colored())),
            (None, Some(seen)) => {
                print(&format!("{}\n", preview::text(seen)))?;
            }
            (None, None) => {}
        }
        Ok(())
    }
}

/// Returns whether there is a document with unsaved changes that no earlier start offered. Then it
/// counts as offered.
fn is_last_offered() -> bool {
    let Ok(last) = last() else { return false };
    let path = data_directory().map(|directory| directory.join(OFFERED));
    let offered = path.and_then(|path| std::fs::read_to_string(path).ok());
    let is_new = offered.is_none_or(|offered| offered.trim_end() != last.trim_end());
    if is_new {
        store_text(OFFERED, last.trim_end());
    }
    is_new
}

/// The last document with unsaved changes, in this session or an earlier one.
fn last() -> Result<String> {
    let directory = data_directory().context("there is no directory for data")?;
    let path = directory.join(LAST);
    std::fs::read_to_string(&path).with_context(|| {
        format!("there is no document with unsaved changes in '{}'", directory.display())
    })
}

/// A name in the current directory that no file has.
pub fn unused_name(extension: &str) -> Result<PathBuf> {
    (1..=9999)
        .map(|number| PathBuf::from(format!("zeroset-{number}.{extension}")))
        .find(|path| !path.exists())
        .with_context(|| format!("all names up to zeroset-9999.{extension} are taken"))
}
