//! The window's keys: a table of commands, and the keys that edit the typed line.

use super::Window;
use super::input::{InputEvent, Modifiers};
use super::page::Page;
use super::screen;
use super::tasks::{LineGoal, Task, save};
use crate::help;
use crate::line_edit::{LineEdit, Motion};
use crate::session::unused_name;
use minifb::Key;
use std::sync::Arc;
use std::thread::spawn;
use std::time::Instant;
use zeroset_live::{Axes, Snapshot, status_words};

/// An arrow key turns the view like a drag of this many pixels in a window [`ARROW_HEIGHT`] pixels
/// high.
const ARROW: f64 = 20.0;
const ARROW_HEIGHT: usize = 400;
/// Scale factor of one step of the wheel, or of a press of Ctrl and + or -.
pub const ZOOM: f64 = 0.85;

/// A command of the window. Every printable key types, so commands are on other keys.
pub struct Shortcut {
    /// The keys, as help writes them.
    pub name: &'static str,
    /// A description of the command, in two or three words.
    pub help: &'static str,
    held: Held,
    keys: &'static [Key],
    run: fn(&mut Window, Key),
}

/// The keys that are held for a command.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Nothing,
    Shift,
    Control,
    ControlShift,
    /// Ctrl, and Shift or not, as the key's sign may need it.
    ControlOrBoth,
}

impl Held {
    /// Returns whether exactly the required modifiers are pressed.
    fn fits(self, Modifiers { control, shift }: Modifiers) -> bool {
        match self {
            Self::Nothing => !control && !shift,
            Self::Shift => !control && shift,
            Self::Control => control && !shift,
            Self::ControlShift => control && shift,
            Self::ControlOrBoth => control,
        }
    }
}

const DIGITS: [Key; 9] = [
    Key::Key1,
    Key::Key2,
    Key::Key3,
    Key::Key4,
    Key::Key5,
    Key::Key6,
    Key::Key7,
    Key::Key8,
    Key::Key9,
];

/// All commands, in the order of the help.
#[rustfmt::skip]
pub const SHORTCUTS: &[Shortcut] = &[
    Shortcut { name: "F1", help: "help, next help", held: Held::Nothing, keys: &[Key::F1],
        run: |window, _| window.next_help() },
    Shortcut { name: "F2", help: "give a name a value", held: Held::Nothing, keys: &[Key::F2],
        run: |window, _| window.define_letter() },
    Shortcut { name: "F3", help: "axes", held: Held::Nothing, keys: &[Key::F3],
        run: |window, _| window.toggle_axes() },
    Shortcut { name: "F4", help: "formulas", held: Held::Nothing, keys: &[Key::F4],
        run: |window, _| window.toggle_list() },
    Shortcut { name: "F5", help: "play time", held: Held::Nothing, keys: &[Key::F5],
        run: |window, _| window.toggle_play() },
    Shortcut { name: "F6", help: "perspective", held: Held::Nothing, keys: &[Key::F6],
        run: |window, _| window.session.live.turn(|orbit| orbit.toggle_projection()) },
    Shortcut { name: "F7", help: "cut open", held: Held::Nothing, keys: &[Key::F7],
        run: |window, _| window.toggle_cut() },
    Shortcut { name: "F8", help: "mark undecided", held: Held::Nothing, keys: &[Key::F8],
        run: |window, _| window.session.live.toggle_undecided() },
    Shortcut { name: "F11", help: "full screen", held: Held::Nothing, keys: &[Key::F11],
        run: |window, _| window.toggle_full_screen() },
    Shortcut { name: "Ctrl-O", help: "gallery", held: Held::Control, keys: &[Key::O],
        run: |window, _| window.toggle_gallery() },
    Shortcut { name: "Ctrl-R", help: "recent files", held: Held::Control, keys: &[Key::R],
        run: |window, _| window.toggle_recent() },
    Shortcut { name: "Ctrl-S", help: "save the document", held: Held::Control, keys: &[Key::S],
        run: |window, _| window.begin_save() },
    Shortcut { name: "Ctrl-P", help: "save the picture", held: Held::Control, keys: &[Key::P],
        run: |window, _| window.save_picture() },
    Shortcut { name: "Ctrl-E", help: "save a mesh", held: Held::Control, keys: &[Key::E],
        run: |window, _| window.begin_mesh() },
    Shortcut { name: "Ctrl-Z", help: "undo", held: Held::Control, keys: &[Key::Z],
        run: |window, _| window.undo_or_redo(true) },
    Shortcut { name: "Ctrl-Y", help: "redo", held: Held::Control, keys: &[Key::Y],
        run: |window, _| window.undo_or_redo(false) },
    Shortcut { name: "Ctrl-Shift-Z", help: "redo", held: Held::ControlShift, keys: &[Key::Z],
        run: |window, _| window.undo_or_redo(false) },
    Shortcut { name: "Ctrl-C", help: "copy", held: Held::Control, keys: &[Key::C],
        run: |window, _| window.copy(false) },
    Shortcut { name: "Ctrl-X", help: "cut", held: Held::Control, keys: &[Key::X],
        run: |window, _| window.copy(true) },
    Shortcut { name: "Ctrl-V", help: "paste", held: Held::Control, keys: &[Key::V],
        run: |window, _| window.paste(false) },
    Shortcut { name: "Shift-Insert", help: "paste", held: Held::Shift, keys: &[Key::Insert],
        run: |window, _| window.paste(false) },
    Shortcut { name: "Ctrl-A", help: "select all", held: Held::Control, keys: &[Key::A],
        run: |window, _| window.select_all() },
    Shortcut { name: "Ctrl-0", help: "first view", held: Held::Control, keys: &[Key::Key0, Key::NumPad0],
        run: |window, _| window.session.live.reset_view() },
    Shortcut { name: "Ctrl-F", help: "fit the domain", held: Held::Control, keys: &[Key::F],
        run: |window, _| window.session.live.fit() },
    Shortcut { name: "Ctrl-+", help: "zoom in", held: Held::ControlOrBoth, keys: &[Key::Equal, Key::NumPadPlus],
        run: |window, _| window.zoom(ZOOM) },
    Shortcut { name: "Ctrl--", help: "zoom out", held: Held::ControlOrBoth, keys: &[Key::Minus, Key::NumPadMinus],
        run: |window, _| window.zoom(1.0 / ZOOM) },
    Shortcut { name: "Ctrl-1 to 9", help: "hide, show", held: Held::Control, keys: &DIGITS,
        run: |window, key| window.toggle_surface(DIGITS.iter().position(|one| *one == key).unwrap_or(0)) },
    Shortcut { name: "Ctrl-Q", help: "quit", held: Held::Control, keys: &[Key::Q],
        run: |window, _| window.quit() },
];

impl Window {
    /// Handles the keys that were typed since the last call.
    pub(super) fn keys(&mut self) {
        let is_active = self.native.is_active();
        if self.was_active && !is_active {
            self.typed_keys.let_go();
        }
        self.was_active = is_active;
        for typed in self.typed_keys.take() {
            self.active = Instant::now();
            match typed {
                InputEvent::Letter(letter) if self.browser.is_open() => self.filter_gallery(letter),
                InputEvent::Letter(letter) => self.type_letter(letter),
                InputEvent::Key(key, held) => self.press(key, held),
            }
        }
    }

    fn type_letter(&mut self, letter: char) {
        self.recent = None;
        self.open_line().insert(letter);
        self.follow_typing();
    }

    /// Returns the line that is being typed, opened if necessary.
    pub(super) fn open_line(&mut self) -> &mut LineEdit {
        if self.line.is_none() {
            (self.help, self.page) = (false, None);
            self.goal = LineGoal::default();
        }
        self.line.get_or_insert_default()
    }

    fn press(&mut self, key: Key, held: Modifiers) {
        if self.browser.is_open() {
            return match key {
                Key::Escape => self.toggle_gallery(),
                Key::R if held.control => {
                    self.toggle_gallery();
                    self.toggle_recent();
                }
                Key::O | Key::Q if held.control => self.run_shortcut(key, held),
                _ => self.browse(key),
            };
        }
        if self.recent.is_some() {
            return self.choose_recent(key);
        }
        match key {
            Key::Escape => self.escape(),
            Key::Enter | Key::NumPadEnter => match self.line.take() {
                None => drop(self.open_line()),
                Some(line) => self.enter(line, held.control || held.shift),
            },
            _ if self.line.is_some() && self.edit(key, held) => {}
            _ if SHORTCUTS.iter().any(|row| row.is_meant(key, held)) => {
                self.run_shortcut(key, held);
            }
            _ if self.line.is_none() && !held.control => self.arrow(key),
            _ => {}
        }
    }

    fn run_shortcut(&mut self, key: Key, held: Modifiers) {
        if let Some(row) = SHORTCUTS.iter().find(|row| row.is_meant(key, held)) {
            (row.run)(self, key);
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
        let keys = Page::new(&help::text());
        let size = self.size();
        let is_small = help::fitting(size, self.scale_at(size.1)).is_none();
        let is_first = self.help || self.page.as_ref().is_some_and(|page| page.is_like(&keys));
        let was_closed = !self.help && self.page.is_none();
        self.page = match (is_first, was_closed) {
            (true, _) => Some(Page::new(&status_words())),
            (false, true) if is_small => Some(keys),
            (false, _) => None,
        };
        self.help = was_closed && !is_small;
    }

    /// Scrolls the page by this many lines.
    pub(super) fn turn_page(&mut self, lines: isize) {
        let size = self.size();
        let scale = self.scale_at(size.1);
        if let Some(page) = &mut self.page {
            page.scroll(lines, size, scale);
        }
    }

    /// Enters a line. With `adding`, a formula is drawn beside the others.
    fn enter(&mut self, line: LineEdit, adding: bool) {
        self.candidates.clear();
        self.message = None;
        let text = line.text().trim().to_owned();
        if text.is_empty() {
            return self.session.live.type_line("");
        }
        self.has_typed = true;
        self.session.recall([text]);
        let goal = if adding { LineGoal::Add } else { self.goal };
        self.send(line, goal);
    }

    /// Undoes a step if `is_undo`, else redoes one. The step is of the typed line, or of the
    /// document if no line is open.
    fn undo_or_redo(&mut self, is_undo: bool) {
        if let Some(line) = &mut self.line {
            let is_done = if is_undo { line.undo() } else { line.redo() };
            if is_done {
                return self.follow_typing();
            }
            let word = if is_undo { "undo" } else { "redo" };
            return self.say(&format!("there is nothing to {word} in this line; Esc closes it"));
        }
        self.sliders.pause();
        let live = &self.session.live;
        let is_done = if is_undo { live.undo() } else { live.redo() };
        self.session.follow();
        self.session.report_in_window();
        match (is_done, is_undo) {
            (true, _) => self.message = None,
            (false, true) => self.say("there is nothing to undo"),
            (false, false) => self.say("there is nothing to redo"),
        }
    }

    /// Defines the undefined letter as 1, if that letter is the only error.
    fn define_letter(&mut self) {
        let fault = self.session.live.snapshot().fault;
        match fault.and_then(|fault| fault.missing_letter()) {
            // The receiver lives as long as the window.
            Some(letter) => {
                self.message = None;
                drop(self.tasks.send(Task::Define(letter)));
            }
            None => self.say("every name has a value"),
        }
    }

    /// Edits the typed line. Returns whether the key has a meaning in a line.
    fn edit(&mut self, key: Key, Modifiers { control, shift }: Modifiers) -> bool {
        let Some(line) = &mut self.line else { return false };
        let mut candidates = Vec::new();
        let motion = match (key, control) {
            (Key::Left, false) => Some(Motion::Left),
            (Key::Right, false) => Some(Motion::Right),
            (Key::Left, true) => Some(Motion::WordLeft),
            (Key::Right, true) => Some(Motion::WordRight),
            (Key::Home, _) => Some(Motion::Home),
            (Key::End, _) => Some(Motion::End),
            _ => None,
        };
        match (key, control) {
            _ if motion.is_some() => motion.into_iter().for_each(|to| line.step(to, shift)),
            (Key::Backspace, false) => line.backspace(),
            (Key::Backspace, true) => line.remove(Motion::WordLeft),
            (Key::Delete, false) if !shift => line.delete(),
            (Key::Delete, true) => line.remove(Motion::WordRight),
            (Key::Tab, false) => {
                let before = line.text().to_owned();
                candidates = line.complete();
                if candidates.is_empty() && line.text() == before {
                    correct(line, &self.session.live.snapshot());
                }
            }
            (Key::Up | Key::Down, false) => {
                line.recall(&self.session.history_since(&mut 0), key == Key::Up);
            }
            _ => return false,
        }
        self.follow_typing();
        self.candidates = candidates;
        true
    }

    pub(super) fn follow_typing(&mut self) {
        self.typed = Instant::now();
        self.candidates.clear();
        self.message = None;
        self.follow_line();
    }

    /// Updates the picture from the line that is being typed, if there is one.
    pub(super) fn follow_line(&mut self) {
        if let Some(line) = &self.line {
            self.session.live.type_line(&self.goal.command(line.text()));
            self.session.report_in_window();
        }
    }

    fn select_all(&mut self) {
        if let Some(line) = &mut self.line {
            line.select_all();
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

    fn zoom(&mut self, factor: f64) {
        let height = self.picture_size().1;
        self.session.live.turn(|orbit| orbit.zoom(factor, 0.0, 0.0, height));
    }

    /// Saves the picture on another thread, once it is finished.
    fn save_picture(&mut self) {
        let (session, tell) = (Arc::clone(&self.session), self.tell.clone());
        let revision = session.live.revision();
        self.threads.push(spawn(move || save(&session, None, revision, &tell)));
        self.say("saving the picture once it is finished");
    }

    /// Opens a line that saves the document to its own file, or else to a new one.
    fn begin_save(&mut self) {
        let name = self.session.path().map_or_else(|| unused_name("zset"), Ok);
        self.begin_command("save", name);
    }

    fn begin_mesh(&mut self) {
        self.begin_command("mesh", unused_name("stl"));
    }

    /// Opens a line with a command and a file's name. An earlier line is kept in the history.
    fn begin_command(&mut self, command: &str, name: anyhow::Result<std::path::PathBuf>) {
        match name {
            Ok(name) => {
                self.put_line_away();
                *self.open_line() = format!(":{command} {}", name.display()).into();
                self.follow_typing();
            }
            Err(error) => self.say(&error.to_string()),
        }
    }

    /// Closes the typed line, and keeps it in the history.
    pub(super) fn put_line_away(&mut self) {
        if let Some(line) = self.line.take().filter(|line| !line.text().trim().is_empty()) {
            self.session.recall([line.text().trim().to_owned()]);
        }
    }

    /// Ends the program. Asks first if work would be left unsaved.
    fn quit(&mut self) {
        if self.may_quit("Ctrl-Q once more") {
            self.session.end();
        }
    }

    /// Returns whether no work would be left unsaved, or the window has asked already. Otherwise
    /// asks; `again` names the way to quit in spite of that.
    pub(super) fn may_quit(&mut self, again: &str) -> bool {
        let revision = self.session.live.revision();
        let asks =
            self.session.has_unsaved_work() && self.asked.replace(revision) != Some(revision);
        if asks {
            self.say(&format!("not saved: Ctrl-S saves it; {again} quits and keeps a copy"));
        }
        !asks
    }

    fn toggle_full_screen(&mut self) {
        if !screen::toggle_full_screen(&self.native) {
            self.say("F11 works with a window manager of X11 only: try the button in the frame of the window");
        }
    }

    fn toggle_cut(&mut self) {
        if self.session.live.toggle_cut() {
            self.say("cut open: Ctrl with the wheel moves the cut, F7 takes it away");
        }
    }

    fn toggle_axes(&mut self) {
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

/// Writes the line that the advice on an error gives in place of the statement with the error.
fn correct(line: &mut LineEdit, seen: &Snapshot) {
    let Some((typed, meant)) = seen.fault.as_ref().and_then(|fault| fault.correction()) else {
        return;
    };
    if line.text().contains(typed) {
        let corrected = line.text().replacen(typed, meant, 1);
        line.select_all();
        line.insert_text(&corrected);
    }
}

impl Shortcut {
    fn is_meant(&self, key: Key, held: Modifiers) -> bool {
        self.keys.contains(&key) && self.held.fits(held)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manual_has_every_command() {
        let manual = include_str!("../../../../docs/window.md");
        let rows = SHORTCUTS.iter().map(|row| format!("| {} | {} |", row.name, row.help));
        let rows = rows.collect::<Vec<_>>().join("\n");
        assert!(manual.contains(&format!("| key | command |\n|---|---|\n{rows}\n\n")), "{rows}");
    }

    #[test]
    fn every_key_has_one_command() {
        let modifiers = [(false, false), (false, true), (true, false), (true, true)]
            .map(|(control, shift)| Modifiers { control, shift });
        for key in SHORTCUTS.iter().flat_map(|row| row.keys) {
            for held in modifiers {
                let meant = SHORTCUTS.iter().filter(|row| row.is_meant(*key, held));
                let names: Vec<&str> = meant.map(|row| row.name).collect();
                assert!(names.len() <= 1, "{names:?}");
            }
        }
    }
}
