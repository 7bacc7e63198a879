//! The window: pictures as they come, the mouse and the keys. It owns the main thread and knows
//! nothing of how a picture is made.

use super::canvas::{Canvas, Rgb};
use super::help;
use super::line_edit::LineEdit;
use super::overlay::draw_box;
use super::pick::Pick;
use super::session::Session;
use super::vector::Size;
use anyhow::{Context, Result};
use minifb::{InputCallback, Key, MouseButton, MouseMode, ScaleMode, WindowOptions};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};
use zeroset::live::{Fault, Orbit, Rendering, Request, Snapshot};
use zeroset::scene::CameraChoice;

const PAPER: Rgb = 0x00f4_f4f6;
const LIGHT: Rgb = 0x00f0_f0f4;
const DIM: Rgb = 0x00b0_b0bc;
const WRONG: Rgb = 0x00d0_3030;
const WRONG_TEXT: Rgb = 0x00ff_9090;

/// A message in the window is shown for so long.
const MESSAGE: Duration = Duration::from_secs(8);
/// What is wrong with a line is said when nothing has been typed for so long.
const PAUSE: Duration = Duration::from_millis(300);

/// A press that moves no farther than this, in pixels, is a click.
const CLICK: f64 = 3.0;
/// Pixels that an arrow key turns by, in a window this high.
const ARROW: f64 = 20.0;
const ARROW_HEIGHT: usize = 400;
/// What one step of the wheel, or of + and -, scales by.
const ZOOM: f64 = 0.85;

/// Windows at least this high get letters twice as large, unless told otherwise.
const HIGH: usize = 1400;

/// What was typed, in order. A key that is pressed and let go between two looks at the keyboard is
/// not lost.
#[derive(Clone, Copy)]
enum Input {
    Letter(char),
    Key(Key),
}

/// Collects what is typed until it is looked at.
struct Keyboard(Rc<RefCell<VecDeque<Input>>>);

impl InputCallback for Keyboard {
    fn add_char(&mut self, letter: u32) {
        if let Some(letter) = char::from_u32(letter).filter(|letter| !letter.is_control()) {
            self.0.borrow_mut().push_back(Input::Letter(letter));
        }
    }

    fn set_key_state(&mut self, key: Key, down: bool) {
        if down {
            self.0.borrow_mut().push_back(Input::Key(key));
        }
    }
}

/// What was done on another thread, so that the window goes on meanwhile.
enum Outcome {
    /// A line was entered, or refused.
    Entered(LineEdit, Result<(), String>),
    /// A picture was saved, or could not be.
    Saved(anyhow::Result<()>),
}

/// A window that has been opened.
pub struct Window {
    native: minifb::Window,
    session: Arc<Session>,
    /// Lines to be entered one after the other.
    lines: Sender<LineEdit>,
    outcomes: Receiver<Outcome>,
    /// Hands out ends for whoever has an outcome to tell.
    tell: Sender<Outcome>,
    threads: Vec<JoinHandle<()>>,
    keyboard: Rc<RefCell<VecDeque<Input>>>,
    scale: Option<usize>,
    drag: Option<Drag>,
    line: Option<LineEdit>,
    typed: Instant,
    message: Option<(String, Instant)>,
    help: bool,
    axes: bool,
    /// The view that shows the whole box, where it was taken for that.
    fitted: Option<Orbit>,
    backdrop: Backdrop,
    drawn: Option<Content>,
}

/// A press of a mouse button that has not ended.
struct Drag {
    start: (f64, f64),
    last: (f64, f64),
    moves: bool,
    pans: bool,
    /// Esc ends a drag before the button does.
    cancelled: bool,
}

/// The picture at the window's size, kept while only what lies over it changes.
#[derive(Default)]
struct Backdrop {
    rendering: Option<Arc<Rendering>>,
    size: (usize, usize),
    pixels: Vec<Rgb>,
}

/// Everything that a window's content depends on; drawn again only when it changes.
#[derive(Clone, PartialEq)]
struct Content {
    size: (usize, usize),
    /// The rendering, by its place in memory: it is kept while it is shown.
    rendering: usize,
    fault: Option<String>,
    wrong: bool,
    hover: Option<String>,
    line: Option<(String, usize)>,
    message: Option<String>,
    help: bool,
    axes: bool,
}

impl Window {
    /// Opens a window.
    ///
    /// # Errors
    /// One phrase that says why there can be none.
    pub fn open(size: Size, scale: Option<usize>, session: &Arc<Session>) -> Result<Self, String> {
        #[cfg(all(unix, not(target_os = "macos")))]
        if std::env::var_os("DISPLAY").is_none_or(|display| display.is_empty()) {
            return Err("there is no display (DISPLAY is not set)".to_owned());
        }
        let options = WindowOptions {
            resize: true,
            scale_mode: ScaleMode::UpperLeft,
            ..WindowOptions::default()
        };
        let mut window = minifb::Window::new("zeroset", size.width, size.height, options)
            .map_err(|error| format!("a window cannot be opened ({error})"))?;
        window.set_target_fps(60);
        let keyboard = Rc::new(RefCell::new(VecDeque::new()));
        window.set_input_callback(Box::new(Keyboard(Rc::clone(&keyboard))));
        let (lines, entered) = channel();
        let (tell, outcomes) = channel();
        let thread = {
            let (session, tell) = (Arc::clone(session), tell.clone());
            spawn(move || enter_all(&session, &entered, &tell))
        };
        Ok(Self {
            native: window,
            session: Arc::clone(session),
            lines,
            outcomes,
            tell,
            threads: vec![thread],
            keyboard,
            scale,
            drag: None,
            line: None,
            typed: Instant::now(),
            message: None,
            help: false,
            axes: false,
            fitted: None,
            backdrop: Backdrop::default(),
            drawn: None,
        })
    }

    /// Shows the session until it or the window ends.
    ///
    /// # Errors
    /// If the window can no longer be drawn to.
    pub fn run(mut self) -> Result<()> {
        while self.native.is_open() && !self.session.has_ended() {
            let (width, height) = self.picture_size();
            self.session.live.resize(width, height);
            self.keys();
            self.settle();
            let seen = self.session.live.snapshot();
            self.mouse(&seen);
            self.draw(&seen)?;
        }
        // What was begun is finished, but no picture is waited for any more.
        self.session.end();
        drop(self.lines);
        for thread in self.threads {
            // A panic has been reported where it happened.
            let _ = thread.join();
        }
        while let Ok(outcome) = self.outcomes.try_recv() {
            if let Outcome::Entered(_, Err(wrong)) = outcome {
                self.session.say(&wrong);
            }
        }
        Ok(())
    }

    fn size(&self) -> (usize, usize) {
        let (width, height) = self.native.get_size();
        (width.max(1), height.max(1))
    }

    /// The part above the status line.
    fn picture_size(&self) -> (usize, usize) {
        let (width, height) = self.size();
        let status = Canvas::line_height_at(self.scale_at(height));
        (width, height.saturating_sub(status).max(1))
    }

    /// Pixels on the side of one dot of a letter, in a window this high.
    fn scale_at(&self, height: usize) -> usize {
        self.scale.unwrap_or(if height >= HIGH { 2 } else { 1 })
    }

    fn say(&mut self, text: &str) {
        let first = text.lines().next().unwrap_or_default();
        self.message = Some((first.to_owned(), Instant::now()));
    }

    fn keys(&mut self) {
        let typed: Vec<Input> = self.keyboard.borrow_mut().drain(..).collect();
        for typed in typed {
            match (typed, &mut self.line) {
                (Input::Letter(letter), Some(line)) => {
                    line.insert(letter);
                    self.follow_line();
                }
                (Input::Letter(letter), None) => self.shortcut(letter),
                (Input::Key(Key::F1), _) => self.help = !self.help,
                (Input::Key(Key::Escape), _) => self.escape(),
                (Input::Key(Key::Enter | Key::NumPadEnter), _) => match self.line.take() {
                    None => self.line = Some(LineEdit::default()),
                    Some(line) => self.enter(line),
                },
                (Input::Key(key), Some(_)) => self.edit(key),
                (Input::Key(key), None) => self.turn(key),
            }
        }
    }

    /// Closes what is open, the last first; never the program.
    fn escape(&mut self) {
        if let Some(drag) = &mut self.drag {
            drag.cancelled = true;
        } else if self.line.take().is_some() {
            self.session.live.type_line("");
        } else {
            self.help = false;
            self.message = None;
        }
    }

    fn enter(&mut self, line: LineEdit) {
        let text = line.text().trim().to_owned();
        if text.is_empty() {
            return self.session.live.type_line("");
        }
        self.session.recall([text]);
        // There is somebody to take it as long as there is a window.
        let _ = self.lines.send(line);
    }

    /// Shows what has been done meanwhile.
    fn settle(&mut self) {
        while let Ok(outcome) = self.outcomes.try_recv() {
            match outcome {
                Outcome::Entered(_, Ok(())) => {}
                Outcome::Entered(line, Err(wrong)) => {
                    self.session.say(&wrong);
                    self.say(&wrong);
                    // It is there to be mended.
                    self.line.get_or_insert(line);
                }
                Outcome::Saved(Ok(())) => {
                    self.say("saved; the terminal shows the command that reproduces it");
                }
                Outcome::Saved(Err(error)) => self.say(&format!("error: {error:#}")),
            }
        }
        self.threads.retain(|thread| !thread.is_finished());
    }

    fn edit(&mut self, key: Key) {
        let Some(line) = &mut self.line else { return };
        match key {
            Key::Backspace => line.backspace(),
            Key::Delete => line.delete(),
            Key::Left => line.left(),
            Key::Right => line.right(),
            Key::Home => line.home(),
            Key::End => line.end(),
            Key::Tab => line.complete(),
            Key::Up | Key::Down => line.recall(&self.session.recalled(0), key == Key::Up),
            _ => return,
        }
        self.follow_line();
    }

    /// Lets the picture follow the line.
    fn follow_line(&mut self) {
        if let Some(line) = &self.line {
            self.typed = Instant::now();
            self.session.live.type_line(line.text());
        }
    }

    /// Turns the view by an arrow key.
    fn turn(&self, key: Key) {
        let (across, down) = match key {
            Key::Left => (ARROW, 0.0),
            Key::Right => (-ARROW, 0.0),
            Key::Up => (0.0, ARROW),
            Key::Down => (0.0, -ARROW),
            _ => return,
        };
        self.session.live.turn(|orbit| orbit.turn(across, down, ARROW_HEIGHT));
    }

    fn shortcut(&mut self, letter: char) {
        let live = &self.session.live;
        let height = self.picture_size().1;
        match letter.to_ascii_lowercase() {
            '/' | ':' => {
                let mut line = LineEdit::default();
                if letter == ':' {
                    line.insert(':');
                }
                self.line = Some(line);
            }
            '+' | '=' => live.turn(|orbit| orbit.zoom(ZOOM, 0.0, 0.0, height)),
            '-' => live.turn(|orbit| orbit.zoom(1.0 / ZOOM, 0.0, 0.0, height)),
            'r' => live.reset_view(),
            'f' => live.fit(),
            'p' => live.turn(|orbit| orbit.toggle_projection()),
            'u' => live.toggle_undecided(),
            'x' => self.toggle_axes(),
            's' => {
                let (session, tell) = (Arc::clone(&self.session), self.tell.clone());
                let revision = live.revision();
                self.threads.push(spawn(move || save(&session, None, revision, &tell)));
                self.say("saving the picture once it is finished");
            }
            'q' => self.session.end(),
            _ => {}
        }
    }

    /// Shows the box, or no longer. The view by default cuts corners off, and so is left for one
    /// that shows them all, until the box is hidden again; a view that somebody chose stays.
    fn toggle_axes(&mut self) {
        let live = &self.session.live;
        self.axes = !self.axes;
        let Request { orbit, choice, .. } = live.request();
        let chosen = choice != CameraChoice::default()
            || live.snapshot().rendering.is_some_and(|seen| seen.document.view.is_some());
        if self.axes && orbit.is_none() && !chosen {
            live.fit();
            self.fitted = live.request().orbit;
        } else if !self.axes && orbit.is_some() && orbit == self.fitted.take() {
            live.reset_view();
        }
    }

    fn pointer(&self, mode: MouseMode) -> Option<(f64, f64)> {
        self.native.get_mouse_pos(mode).map(|(x, y)| (f64::from(x), f64::from(y)))
    }

    fn mouse(&mut self, seen: &Snapshot) {
        let Some(at) = self.pointer(MouseMode::Pass) else { return };
        let (width, height) = self.picture_size();
        let inside = self.pointer(MouseMode::Discard).is_some_and(|(_, y)| y < height as f64);
        if let Some((_, steps)) = self.native.get_scroll_wheel()
            && steps != 0.0
            && inside
        {
            let factor = ZOOM.powf(f64::from(steps.clamp(-5.0, 5.0)));
            let (across, down) = (at.0 - width as f64 / 2.0, at.1 - height as f64 / 2.0);
            self.session.live.turn(|orbit| orbit.zoom(factor, across, down, height));
        }
        let left = self.native.get_mouse_down(MouseButton::Left);
        let right = self.native.get_mouse_down(MouseButton::Right);
        let held = left || right;
        match &mut self.drag {
            None if held && inside => {
                let shift = self.native.is_key_down(Key::LeftShift)
                    || self.native.is_key_down(Key::RightShift);
                let pans = right || shift;
                self.drag =
                    Some(Drag { start: at, last: at, moves: false, pans, cancelled: false });
            }
            None => {}
            Some(drag) if held => {
                let far = (at.0 - drag.start.0).hypot(at.1 - drag.start.1) > CLICK;
                drag.moves |= far;
                let (across, down) = (at.0 - drag.last.0, at.1 - drag.last.1);
                if drag.moves && !drag.cancelled && (across, down) != (0.0, 0.0) {
                    drag.last = at;
                    let pans = drag.pans;
                    self.session.live.turn(|orbit| {
                        if pans {
                            orbit.pan(across, down, height);
                        } else {
                            orbit.turn(across, down, height);
                        }
                    });
                }
            }
            Some(drag) => {
                let click = !drag.moves && !drag.pans && !drag.cancelled;
                let start = drag.start;
                self.drag = None;
                if click
                    && let Some(rendering) = &seen.rendering
                    && let Some(pick) = Pick::at(rendering, start, (width, height))
                {
                    self.session.say(&pick.describe());
                    self.say(pick.describe().as_str());
                }
            }
        }
    }

    fn draw(&mut self, seen: &Snapshot) -> Result<()> {
        let size = self.size();
        let place = self.pointer(MouseMode::Discard);
        let pick = seen
            .rendering
            .as_ref()
            .zip(place)
            .and_then(|(rendering, at)| Pick::at(rendering, at, self.picture_size()));
        let hover = pick.and_then(|pick| pick.coordinates());
        if self.message.as_ref().is_some_and(|(_, since)| since.elapsed() > MESSAGE) {
            self.message = None;
        }
        let rested = self.typed.elapsed() > PAUSE;
        let fault = seen.fault.as_deref().filter(|_| rested).map(Fault::message);
        let content = Content {
            size,
            rendering: seen
                .rendering
                .as_ref()
                .map_or(0, |rendering| Arc::as_ptr(rendering) as usize),
            fault,
            wrong: seen.fault.is_some(),
            hover,
            line: self.line.as_ref().map(|line| (line.text().to_owned(), line.column())),
            message: self.message.as_ref().map(|(text, _)| text.clone()),
            help: self.help,
            axes: self.axes,
        };
        if self.drawn.as_ref() == Some(&content) {
            self.native.update();
            return Ok(());
        }
        self.backdrop.follow(seen.rendering.as_ref(), self.picture_size(), size);
        let canvas = self.compose(&content);
        self.native
            .update_with_buffer(&canvas.pixels, canvas.width, canvas.height)
            .context("the window cannot be drawn to")?;
        self.drawn = Some(content);
        Ok(())
    }

    fn compose(&self, content: &Content) -> Canvas {
        let (width, height) = content.size;
        let scale = self.scale_at(height);
        let mut canvas = Canvas { width, height, pixels: self.backdrop.pixels.clone(), scale };
        if let Some(rendering) = self.backdrop.rendering.as_ref().filter(|_| content.axes) {
            draw_box(&mut canvas, (&**rendering).into(), self.picture_size().1);
        }
        if content.wrong {
            canvas.border(2 * scale, WRONG);
        }
        let row = canvas.line_height();
        let margin = 6 * scale;
        let room = width.saturating_sub(2 * margin);
        let bottom = height as i64 - row as i64;
        // The status line, then what lies above it.
        canvas.fill(0, bottom, width, row, 0x0020_2028, 255);
        let status = match &self.backdrop.rendering {
            Some(rendering) if rendering.coarse => format!("{} · refining", rendering.summary()),
            Some(rendering) => rendering.summary(),
            None => "no picture yet".to_owned(),
        };
        let hover = content.hover.clone().unwrap_or_else(|| "F1 help".to_owned());
        let taken = hover.chars().count() * canvas.advance();
        let text_y = bottom + 2 * scale as i64;
        let right = (width as i64 - margin as i64 - taken as i64).max(0);
        if room >= status.chars().count() * canvas.advance() + taken + 2 * margin {
            canvas.write(&hover, right, text_y, DIM);
        } else if content.line.is_none() {
            // Both do not fit one line.
            canvas.label(&hover, right, bottom - row as i64, DIM);
        }
        let left = canvas.fitting(&status, room);
        canvas.write(&left, margin as i64, text_y, LIGHT);
        let mut above = bottom - row as i64;
        if let Some((text, column)) = &content.line {
            canvas.fill(0, above, width, row, 0x0010_1014, 240);
            // The end of a long line is where it is typed.
            let letters = (room / canvas.advance()).saturating_sub(3).max(1);
            let skip = column.saturating_sub(letters);
            let part: String = text.chars().skip(skip).take(letters + 1).collect();
            canvas.write(&format!("> {part}"), margin as i64, above + 2 * scale as i64, LIGHT);
            let at = margin + (2 + column - skip) * canvas.advance();
            canvas.fill(at as i64, above + 2 * scale as i64, 2 * scale, 16 * scale, LIGHT, 255);
            above -= row as i64;
        }
        let note = content.fault.as_ref().map(|text| (text, WRONG_TEXT));
        let note = note.or(content.message.as_ref().map(|text| (text, LIGHT)));
        if let Some((text, colour)) = note {
            let text = canvas.fitting(text, room);
            canvas.label(&text, 0, above, colour);
        }
        if let Some(rendering) = &self.backdrop.rendering {
            let echo =
                rendering.document.surfaces.first().map_or("", |surface| surface.echo.as_str());
            let more = rendering.document.surfaces.len().saturating_sub(1);
            let text = if more > 0 { format!("{echo}  and {more} more") } else { echo.to_owned() };
            let text = canvas.fitting(&text, room);
            canvas.label(&text, 0, 0, LIGHT);
        }
        if content.help {
            help::draw(&mut canvas);
        }
        canvas
    }
}

/// Enters lines as long as there are any to come.
fn enter_all(session: &Arc<Session>, lines: &Receiver<LineEdit>, tell: &Sender<Outcome>) {
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

fn save(session: &Session, to: Option<&str>, revision: u64, tell: &Sender<Outcome>) {
    let _ = tell.send(Outcome::Saved(session.png(to, revision)));
}

impl Backdrop {
    /// Scales the rendering's picture to its part of the window, if either has changed.
    fn follow(
        &mut self,
        rendering: Option<&Arc<Rendering>>,
        picture: (usize, usize),
        window: (usize, usize),
    ) {
        let same = match (&self.rendering, rendering) {
            (Some(old), Some(new)) => Arc::ptr_eq(old, new),
            (None, None) => !self.pixels.is_empty(),
            (Some(_), None) | (None, Some(_)) => false,
        };
        if same && self.size == window {
            return;
        }
        self.rendering = rendering.cloned();
        self.size = window;
        self.pixels.clear();
        self.pixels.resize(window.0 * window.1, PAPER);
        let Some(rendering) = rendering else { return };
        let (width, height) = picture;
        let buffer = &rendering.picture.buffer;
        for (y, row) in self.pixels.chunks_exact_mut(width).take(height).enumerate() {
            let line = y * buffer.height / height * buffer.width;
            for (x, pixel) in row.iter_mut().enumerate() {
                let at = 3 * (line + x * buffer.width / width);
                let [r, g, b] = [0, 1, 2].map(|k| u32::from(rendering.picture.rgb[at + k]));
                *pixel = r << 16 | g << 8 | b;
            }
        }
    }
}
