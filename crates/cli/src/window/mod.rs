//! The window, with mouse and keys. It runs on the main thread. It does not know how pictures are
//! rendered.

mod browser;
mod clicks;
mod clipboard;
mod draw;
mod enlarge;
mod input;
pub mod keys;
mod list;
mod mouse;
mod page;
mod panel;
mod recent;
mod rows;
mod screen;
mod sliders;
mod surfaces;
mod tasks;
mod thumbnails;
mod wheel;

use super::arguments::USUAL_SIZE;
use super::line_edit::LineEdit;
use super::session::Session;
use super::tips;
use super::vector::Size;
use anyhow::Result;
use browser::Browser;
use clicks::Clicks;
use clipboard::LazyClipboard;
use draw::{Backdrop, Content};
use input::{InputQueue, Keyboard};
use minifb::{Key, MouseMode, ScaleMode, WindowOptions};
use mouse::Mouse;
use page::Page;
use recent::RecentMenu;
use sliders::Sliders;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};
use surfaces::Surfaces;
use tasks::{LineGoal, Task, TaskOutcome, do_all};
use zeroset_live::{DocumentSource, Rendering, Snapshot};
use zeroset_render::overlay::{Canvas, Overlay};

const MESSAGE_TIME: Duration = Duration::from_secs(8);
/// A fault is shown after a pause in typing of this length.
const PAUSE: Duration = Duration::from_millis(300);

/// Interval between polls of mouse and keyboard.
const POLL_INTERVAL: Duration = Duration::from_millis(4);
/// Poll interval after [`IDLE_AFTER`] without activity. A poll takes about 100 µs.
const IDLE_POLL_INTERVAL: Duration = Duration::from_millis(20);
const IDLE_AFTER: Duration = Duration::from_secs(2);
/// Least time between two drawings of the window.
const FRAME: Duration = Duration::from_millis(16);
/// Least time between two drawings after [`IDLE_AFTER`] without activity. Then only messages
/// change.
const IDLE_FRAME: Duration = Duration::from_millis(100);

/// Time before the first tip, and between tips.
const TIP_INTERVAL: Duration = Duration::from_secs(20);

/// Windows at least this high have letters of twice the size, on a display without a scale.
const LARGE_TEXT_HEIGHT: usize = 1400;

/// An open window.
pub struct Window {
    native: minifb::Window,
    session: Arc<Session>,
    /// Changes of the document, in order.
    tasks: Sender<Task>,
    outcomes: Receiver<TaskOutcome>,
    /// Channel for the outcomes of tasks. Each task's thread gets a clone.
    tell: Sender<TaskOutcome>,
    threads: Vec<JoinHandle<()>>,
    typed_keys: InputQueue,
    /// Whether the window had the keyboard when it was last asked.
    was_active: bool,
    clipboard: LazyClipboard,
    scale: Option<f64>,
    mouse: Mouse,
    clicks: Clicks,
    /// The rendering whose sliders and surfaces are shown.
    rendering: Option<Arc<Rendering>>,
    sliders: Sliders,
    surfaces: Surfaces,
    browser: Browser,
    recent: Option<RecentMenu>,
    line: Option<LineEdit>,
    goal: LineGoal,
    /// Whether something was entered or pasted. Until then, the window says where to type.
    has_typed: bool,
    /// Possible completions of the line's last word.
    candidates: Vec<String>,
    typed: Instant,
    message: Option<(String, Instant)>,
    /// Time of the last tip.
    tip: Instant,
    help: bool,
    /// A text over the picture, opened by a command or a key.
    page: Option<Page>,
    backdrop: Backdrop,
    drawn: Option<Content>,
    /// Time of the last check whether the window's content has changed.
    compared: Instant,
    title: String,
    /// Revision of the unsaved document for which the window has asked whether to quit.
    asked: Option<u64>,
    /// Time of the last activity.
    active: Instant,
}

/// Opens a window of the system, whose keys go to `typed_keys`.
fn native_window(size: Size, typed_keys: &InputQueue) -> Result<minifb::Window, String> {
    let options = WindowOptions {
        resize: true,
        scale_mode: ScaleMode::UpperLeft,
        ..WindowOptions::default()
    };
    let mut window = minifb::Window::new("zeroset", size.width, size.height, options)
        .map_err(|error| format!("a window cannot be opened ({error})"))?;
    // The loop in `run` sleeps by itself, since it polls more often than it draws.
    window.set_target_fps(0);
    window.set_input_callback(Box::new(Keyboard(typed_keys.clone())));
    Ok(window)
}

impl Window {
    /// Opens a window. Without a `size` it has the usual size times the display's scale, and
    /// without a `scale` its letters have the display's scale.
    ///
    /// # Errors
    /// A phrase that says why the window cannot be opened.
    pub fn open(
        size: Option<Size>,
        scale: Option<f64>,
        session: &Arc<Session>,
    ) -> Result<Self, String> {
        #[cfg(all(unix, not(target_os = "macos")))]
        if std::env::var_os("DISPLAY").is_none_or(|display| display.is_empty()) {
            return Err("there is no display (DISPLAY is not set)".to_owned());
        }
        let display = screen::scale();
        let pixels = |length: usize| (length as f64 * display.unwrap_or(1.0)).round() as usize;
        let size = size
            .unwrap_or(Size { width: pixels(USUAL_SIZE.width), height: pixels(USUAL_SIZE.height) });
        let typed_keys = InputQueue::default();
        let native = native_window(size, &typed_keys)?;
        let (tasks, given) = channel();
        let (tell, outcomes) = channel();
        let thread = {
            let (session, tell) = (Arc::clone(session), tell.clone());
            spawn(move || do_all(&session, &given, &tell))
        };
        let now = Instant::now();
        Ok(Self {
            clicks: Clicks::of(&native),
            native,
            session: Arc::clone(session),
            tasks,
            outcomes,
            tell,
            threads: vec![thread],
            typed_keys,
            was_active: false,
            clipboard: LazyClipboard::default(),
            scale: scale.or(display),
            mouse: Mouse::default(),
            rendering: None,
            sliders: Sliders::default(),
            surfaces: Surfaces::default(),
            browser: Browser::default(),
            recent: None,
            line: None,
            goal: LineGoal::default(),
            has_typed: false,
            candidates: Vec::new(),
            typed: now,
            message: None,
            tip: now,
            help: false,
            page: None,
            backdrop: Backdrop::default(),
            drawn: None,
            compared: now,
            title: String::new(),
            asked: None,
            active: now,
        })
    }

    /// Runs the window until the session ends or the window is closed.
    ///
    /// # Errors
    /// If drawing to the window fails.
    pub fn run(mut self) -> Result<()> {
        self.open_wrong_formula();
        while !self.session.has_ended() && (self.native.is_open() || self.stays_open()) {
            let (width, height) = self.picture_size();
            self.session.live.resize(width, height);
            self.keys();
            self.receive_outcomes();
            let seen = self.session.live.snapshot();
            self.follow(&seen);
            self.mouse(&seen);
            self.play(&seen);
            self.session.live.set_played(self.sliders.played());
            self.session.live.set_moving(self.sliders.is_in_motion());
            self.send_value(&seen);
            self.send_opacity(&seen);
            self.show_tips();
            let is_idle = self.active.elapsed() > IDLE_AFTER;
            let frame = if is_idle { IDLE_FRAME } else { FRAME };
            let is_due = self.compared.elapsed() >= frame;
            let is_drawn = is_due && self.draw(&seen)?;
            if !is_drawn {
                self.native.update();
            }
            sleep(if is_idle { IDLE_POLL_INTERVAL } else { POLL_INTERVAL });
        }
        self.browser.stop();
        // Lines that were already sent are still executed, but without waiting for pictures.
        self.session.end();
        drop(self.tasks);
        for thread in self.threads {
            // The thread's panic has already been reported on standard error.
            let _ = thread.join();
        }
        while let Ok(outcome) = self.outcomes.try_recv() {
            if let TaskOutcome::Refused(.., why) = outcome {
                self.session.say(&why.full);
            }
        }
        Ok(())
    }

    /// Puts a formula that the program was started with into the line, to be mended, if it has an
    /// error.
    fn open_wrong_formula(&mut self) {
        let request = self.session.live.request();
        let text = request.text.trim().to_owned();
        let is_formula = request.source == DocumentSource::Typed && !text.contains('\n');
        if is_formula && !text.is_empty() && request.read().is_err() {
            *self.open_line() = text.into();
            self.follow_typing();
        }
    }

    /// Asks first if the window's close button was pressed and work would be left unsaved. Returns
    /// whether the window is open again: the library cannot hold it, so a new one takes its place.
    fn stays_open(&mut self) -> bool {
        if self.may_quit("closing it once more") {
            return false;
        }
        let (width, height) = self.native.get_size();
        self.typed_keys = InputQueue::default();
        let Ok(native) = native_window(Size { width, height }, &self.typed_keys) else {
            return false;
        };
        self.clicks = Clicks::of(&native);
        self.native = native;
        (self.drawn, self.title) = (None, String::new());
        true
    }

    /// Takes over the sliders and surfaces of the visible rendering, and lays them out.
    fn follow(&mut self, seen: &Snapshot) {
        let rendering = seen.rendering.as_ref();
        if self.rendering.as_ref().map(Arc::as_ptr) != rendering.map(Arc::as_ptr) {
            self.active = Instant::now();
            self.rendering = rendering.cloned();
            self.sliders.follow(rendering.map(|seen| seen.sliders()).unwrap_or_default());
            let (surfaces, curves) =
                rendering.map(|seen| (seen.surfaces(), seen.curves())).unwrap_or_default();
            self.surfaces.follow(surfaces, curves);
        }
        let (width, height) = self.picture_size();
        let letters = Canvas::new(width, height, Vec::new(), self.scale_at(self.size().1));
        // The typed line and a message above it take two rows.
        let row = letters.line_height();
        let free = height.saturating_sub(2 * row);
        let half = if self.surfaces.is_wanted() { width / 2 } else { width };
        self.sliders.lay_out((half, free), &letters);
        let count = rendering.map_or(0, |seen| seen.picture.legends.len());
        let legends = Overlay::legends_height(count, height, letters.scale);
        let above = height.saturating_sub(row + legends).min(free);
        self.surfaces.lay_out(self.sliders.width(), (width, above), &letters);
    }

    /// Enters a line on another thread.
    fn send(&self, line: impl Into<LineEdit>, goal: LineGoal) {
        // The receiver lives as long as the window.
        let _ = self.tasks.send(Task::Enter(line.into(), goal));
    }

    fn size(&self) -> (usize, usize) {
        let (width, height) = self.native.get_size();
        (width.max(1), height.max(1))
    }

    /// Width and height of the part of the window above the status line.
    fn picture_size(&self) -> (usize, usize) {
        let (width, height) = self.size();
        let status = Canvas::line_height_at(self.scale_at(height));
        (width, height.saturating_sub(status).max(1))
    }

    /// Scale of the letters, for a window of this height.
    fn scale_at(&self, height: usize) -> f64 {
        self.scale.unwrap_or(if height >= LARGE_TEXT_HEIGHT { 2.0 } else { 1.0 })
    }

    fn pointer(&self, mode: MouseMode) -> Option<(f64, f64)> {
        self.native.get_mouse_pos(mode).map(|(x, y)| (f64::from(x), f64::from(y)))
    }

    fn is_shifted(&self) -> bool {
        self.native.is_key_down(Key::LeftShift) || self.native.is_key_down(Key::RightShift)
    }

    fn has_control(&self) -> bool {
        self.native.is_key_down(Key::LeftCtrl) || self.native.is_key_down(Key::RightCtrl)
    }

    fn say(&mut self, text: &str) {
        let first = text.lines().next().unwrap_or_default();
        self.message = Some((first.to_owned(), Instant::now()));
    }

    /// Shows a tip if there is no other message.
    fn show_tips(&mut self) {
        if self.message.is_some() || self.line.is_some() || self.tip.elapsed() < TIP_INTERVAL {
            return;
        }
        self.tip = Instant::now();
        if let Some(tip) = tips::next(self.has_typed) {
            self.say(tip);
        }
    }

    /// Receives and shows the results of other threads.
    fn receive_outcomes(&mut self) {
        while let Ok(outcome) = self.outcomes.try_recv() {
            self.active = Instant::now();
            match outcome {
                TaskOutcome::Entered(said) => {
                    self.sliders.pause();
                    match said {
                        Some(text) if text.contains('\n') => self.page = Some(Page::new(&text)),
                        Some(text) => self.say(&text),
                        None => {}
                    }
                    // The line that is being typed may use a definition in the entered line.
                    self.follow_line();
                }
                TaskOutcome::Refused(mut line, goal, why) => {
                    self.session.say(&why.full);
                    self.say(&why.summary);
                    // Offer the refused line for correction, unless another line is being typed.
                    // It is selected, so that another formula can be typed at once.
                    line.select_all();
                    if self.line.is_none() {
                        (self.line, self.goal) = (Some(line), goal);
                    }
                }
                TaskOutcome::Saved(Ok(path)) => {
                    let path = path.display();
                    self.say(&format!(
                        "saved '{path}'; the terminal shows the command that reproduces it"
                    ));
                }
                TaskOutcome::Saved(Err(error)) => self.say(&format!("error: {error:#}")),
            }
        }
        self.threads.retain(|thread| !thread.is_finished());
        if let Some(note) = self.session.notice() {
            self.active = Instant::now();
            self.say(&note);
        }
        if self.session.is_gallery_wanted() && !self.browser.is_open() {
            self.toggle_gallery();
        }
    }

    /// Returns the fault, unless a slider is moving and will soon leave the faulty value.
    fn fault<'a>(&self, seen: &'a Snapshot) -> Option<&'a zeroset_live::Fault> {
        seen.fault.as_deref().filter(|_| !self.sliders.is_moving())
    }

    fn update_title(&mut self) {
        let live = &self.session.live;
        let name = live.request().source.to_string();
        let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let shown: String = last.chars().filter(|c| !c.is_control()).take(60).collect();
        let mark = if live.is_changed() { "*" } else { "" };
        let title = format!("{shown}{mark} - zeroset");
        if title != self.title {
            self.native.set_title(&title);
            self.title = title;
        }
    }
}
