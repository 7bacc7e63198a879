//! Handles the window's keys, and edits the line that is typed in the window.

use super::Window;
use super::input::InputEvent;
use super::page::Page;
use super::tasks::save;
use crate::line_edit::LineEdit;
use crate::session::unused_name;
use minifb::Key;
use std::sync::Arc;
use std::thread::spawn;
use std::time::Instant;
use zeroset_live::{Axes, status_words};

/// An arrow key turns the view like a drag of this many pixels in a window [`ARROW_HEIGHT`] pixels
/// high.
const ARROW: f64 = 20.0;
const ARROW_HEIGHT: usize = 400;
/// Scale factor of one step of the wheel, or of a press of + or -.
pub const ZOOM: f64 = 0.85;

impl Window {
    pub(super) fn keys(&mut self) {
        for typed in self.typed_keys.take() {
            self.active = Instant::now();
            if self.browser.is_open() {
                match typed {
                    InputEvent::Letter(letter) => self.filter_gallery(letter),
                    InputEvent::Key(Key::Escape) => self.toggle_gallery(),
                    InputEvent::Key(key) => self.browse(key),
                    InputEvent::Control(_) => {}
                }
                continue;
            }
            match (typed, &mut self.line) {
                (InputEvent::Letter(letter), Some(line)) => {
                    line.insert(letter);
                    self.follow_typing();
                }
                (InputEvent::Letter(letter), None) => self.shortcut(letter),
                (InputEvent::Control(Key::Z), None) => self.step_back(true),
                (InputEvent::Control(Key::Y), None) => self.step_back(false),
                (InputEvent::Control(_), None) => {}
                (InputEvent::Key(Key::F1), _) => self.next_help(),
                (InputEvent::Key(Key::F2), _) => self.define_letter(),
                (InputEvent::Key(Key::Escape), _) => self.escape(),
                (InputEvent::Key(Key::Enter | Key::NumPadEnter), _) => match self.line.take() {
                    None => self.line = Some(LineEdit::default()),
                    Some(line) => self.enter(line),
                },
                (InputEvent::Key(key) | InputEvent::Control(key), Some(_)) => self.edit(key),
                (InputEvent::Key(key), None) => self.arrow(key),
            }
        }
    }

    /// Cancels the current drag. Without a drag, closes the typed line; without a line, the help
    /// and the page. Never ends the program.
    fn escape(&mut self) {
        self.candidates.clear();
        if self.mouse.cancel() {
            return;
        }
        self.message = None;
        if self.line.take().is_some() {
            self.session.live.type_line("");
            self.session.report_in_window();
        } else {
            (self.help, self.page) = (false, None);
        }
    }

    /// Switches from no help to the list of keys, then to the explanation of the status line, then
    /// to no help.
    fn next_help(&mut self) {
        let was_closed = !self.help && self.page.is_none();
        self.page = self.help.then(|| Page::new(&status_words()));
        self.help = was_closed;
    }

    /// Scrolls the page by this many lines.
    pub(super) fn turn_page(&mut self, lines: isize) {
        let size = self.size();
        let scale = self.scale_at(size.1);
        if let Some(page) = &mut self.page {
            page.scroll(lines, size, scale);
        }
    }

    fn enter(&mut self, line: LineEdit) {
        self.candidates.clear();
        self.message = None;
        let text = line.text().trim().to_owned();
        if text.is_empty() {
            return self.session.live.type_line("");
        }
        self.session.recall([text]);
        self.send(line);
    }

    /// Undoes the last step, or redoes it.
    fn step_back(&mut self, back: bool) {
        self.sliders.pause();
        let live = &self.session.live;
        let is_done = if back { live.undo() } else { live.redo() };
        self.session.follow();
        self.session.report_in_window();
        match (is_done, back) {
            (true, _) => self.message = None,
            (false, true) => self.say("there is nothing to undo"),
            (false, false) => self.say("there is nothing to redo"),
        }
    }

    /// Defines the undefined letter as 1, if that letter is the only error.
    fn define_letter(&mut self) {
        let fault = self.session.live.snapshot().fault;
        let Some(letter) = fault.and_then(|fault| fault.missing_letter()) else { return };
        self.send(format!("{letter} = 1"));
    }

    fn edit(&mut self, key: Key) {
        let Some(line) = &mut self.line else { return };
        let mut candidates = Vec::new();
        match key {
            Key::Backspace => line.backspace(),
            Key::Delete => line.delete(),
            Key::Left => line.left(),
            Key::Right => line.right(),
            Key::Home => line.home(),
            Key::End => line.end(),
            Key::Tab => candidates = line.complete(),
            Key::Up | Key::Down => line.recall(&self.session.history_since(&mut 0), key == Key::Up),
            _ => return,
        }
        self.follow_typing();
        self.candidates = candidates;
    }

    fn follow_typing(&mut self) {
        self.typed = Instant::now();
        self.candidates.clear();
        self.message = None;
        self.follow_line();
    }

    /// Updates the picture from the line that is being typed, if there is one.
    pub(super) fn follow_line(&mut self) {
        if let Some(line) = &self.line {
            self.session.live.type_line(line.text());
            self.session.report_in_window();
        }
    }

    /// Scrolls the page, changes the slider or surface under the pointer, or turns the view.
    fn arrow(&mut self, key: Key) {
        if self.page.is_some() {
            return self.turn_page(match key {
                Key::Up => -1,
                Key::Down => 1,
                Key::PageUp => -10,
                Key::PageDown => 10,
                _ => 0,
            });
        }
        if self.change_surface(key) {
            return;
        }
        let (across, down) = match key {
            Key::Left => (ARROW, 0.0),
            Key::Right => (-ARROW, 0.0),
            Key::Up => (0.0, ARROW),
            Key::Down => (0.0, -ARROW),
            _ => return,
        };
        if down == 0.0 && self.nudge(-across.signum()) {
            return;
        }
        self.session.live.turn(|orbit| orbit.turn(across, down, ARROW_HEIGHT));
    }

    fn shortcut(&mut self, letter: char) {
        let live = &self.session.live;
        let height = self.picture_size().1;
        match letter.to_ascii_lowercase() {
            '/' | ':' => {
                let begun = if letter == ':' { ":" } else { "" };
                self.line = Some(begun.to_owned().into());
                (self.help, self.page) = (false, None);
            }
            '+' | '=' => live.turn(|orbit| orbit.zoom(ZOOM, 0.0, 0.0, height)),
            '-' => live.turn(|orbit| orbit.zoom(1.0 / ZOOM, 0.0, 0.0, height)),
            'r' => live.reset_view(),
            'f' => live.fit(),
            'p' => live.turn(|orbit| orbit.toggle_projection()),
            'u' => live.toggle_undecided(),
            'x' => self.toggle_axes(),
            't' => self.toggle_play(),
            'k' => self.toggle_cut(),
            'g' => self.toggle_gallery(),
            'l' => self.toggle_list(),
            '1'..='9' => self.toggle_surface(letter as usize - '1' as usize),
            's' => {
                let (session, tell) = (Arc::clone(&self.session), self.tell.clone());
                let revision = live.revision();
                self.threads.push(spawn(move || save(&session, None, revision, &tell)));
                self.say("saving the picture once it is finished");
            }
            'm' => match unused_name("stl") {
                Ok(name) => self.line = Some(format!(":mesh {}", name.display()).into()),
                Err(error) => self.say(&error.to_string()),
            },
            'q' => self.session.end(),
            _ => {}
        }
    }

    fn toggle_cut(&mut self) {
        if self.session.live.toggle_cut() {
            self.say("cut open: Ctrl with the wheel moves the cut, K takes it away");
        }
    }

    fn toggle_axes(&self) {
        let live = &self.session.live;
        let Some(seen) = live.snapshot().rendering else { return };
        let are_shown = live.request().axes.are_shown(&seen.document);
        let are_usual = Axes::Usual.are_shown(&seen.document);
        live.set_axes(match (are_shown, are_usual) {
            (true, true) => Axes::Off,
            (false, false) => Axes::On,
            // By default the axes are already in the desired state.
            (true, false) | (false, true) => Axes::Usual,
        });
    }
}
