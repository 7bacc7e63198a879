//! The queue of keyboard input. Knows no commands.

use minifb::{InputCallback, Key};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::mem;
use std::rc::Rc;

/// The keys that are held while another one is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modifiers {
    pub control: bool,
    pub shift: bool,
}

/// A typed letter or a pressed key. Events are queued, so a key released before the next poll is
/// not lost.
#[derive(Clone, Copy)]
pub enum InputEvent {
    Letter(char),
    Key(Key, Modifiers),
}

/// The left and the right key of each kind, and whether it is held.
#[derive(Default)]
struct Held {
    control: [bool; 2],
    shift: [bool; 2],
    alt: [bool; 2],
    command: [bool; 2],
}

impl Held {
    /// The state of this key. `None` if it is no modifier.
    fn of(&mut self, key: Key) -> Option<&mut bool> {
        Some(match key {
            Key::LeftCtrl => &mut self.control[0],
            Key::RightCtrl => &mut self.control[1],
            Key::LeftShift => &mut self.shift[0],
            Key::RightShift => &mut self.shift[1],
            Key::LeftAlt => &mut self.alt[0],
            Key::RightAlt => &mut self.alt[1],
            Key::LeftSuper => &mut self.command[0],
            Key::RightSuper => &mut self.command[1],
            _ => return None,
        })
    }

    /// Returns whether keys give commands. On a Mac the command key does so, and Alt types letters.
    /// Elsewhere Ctrl does so, unless it is held with the right Alt key, which types letters.
    fn commands(&self) -> bool {
        let is_mac = cfg!(target_os = "macos");
        let any = |keys: [bool; 2]| keys.contains(&true);
        any(self.control) && (is_mac || !self.alt[1]) || is_mac && any(self.command)
    }

    /// Returns whether keys belong to the window manager.
    fn is_elsewhere(&self) -> bool {
        !cfg!(target_os = "macos") && (self.alt[0] || self.command.contains(&true))
    }
}

#[derive(Default)]
struct State {
    events: VecDeque<InputEvent>,
    held: Held,
}

/// Input that has not been handled yet.
#[derive(Clone, Default)]
pub struct InputQueue(Rc<RefCell<State>>);

impl InputQueue {
    /// Takes all input, in order.
    pub fn take(&self) -> Vec<InputEvent> {
        mem::take(&mut self.0.borrow_mut().events).into()
    }

    /// Forgets the held keys: a window in the background is not told of their release.
    pub fn let_go(&self) {
        self.0.borrow_mut().held = Held::default();
    }
}

/// Receives input from the window's library.
pub struct Keyboard(pub InputQueue);

impl InputCallback for Keyboard {
    fn add_char(&mut self, letter: u32) {
        let State { events, held } = &mut *self.0.0.borrow_mut();
        let Some(letter) = char::from_u32(letter).filter(|letter| !letter.is_control()) else {
            return;
        };
        if held.is_elsewhere() {
            return;
        }
        if !held.commands() {
            events.push_back(InputEvent::Letter(letter));
        } else if letter == '+'
            && !matches!(events.back(), Some(InputEvent::Key(Key::Equal | Key::NumPadPlus, _)))
        {
            // Some keyboards have a key of its own for +, which the library does not name.
            let modifiers = Modifiers { control: true, shift: false };
            events.push_back(InputEvent::Key(Key::NumPadPlus, modifiers));
        }
    }

    fn set_key_state(&mut self, key: Key, down: bool) {
        let State { events, held } = &mut *self.0.0.borrow_mut();
        if let Some(state) = held.of(key) {
            *state = down;
        } else if down && !held.is_elsewhere() {
            let shift = held.shift.contains(&true);
            events.push_back(InputEvent::Key(key, Modifiers { control: held.commands(), shift }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Presses keys in order, types a letter, and returns the events.
    fn pressed(keys: &[Key], letter: char) -> Vec<String> {
        let mut keyboard = Keyboard(InputQueue::default());
        for key in keys {
            keyboard.set_key_state(*key, true);
        }
        keyboard.add_char(letter.into());
        let name = |event: InputEvent| match event {
            InputEvent::Letter(letter) => letter.to_string(),
            InputEvent::Key(key, Modifiers { control, shift }) => {
                let [control, shift] = [(control, "Ctrl "), (shift, "Shift ")]
                    .map(|(held, name)| if held { name } else { "" });
                format!("{control}{shift}{key:?}")
            }
        };
        keyboard.0.take().into_iter().map(name).collect()
    }

    #[test]
    #[cfg(not(target_os = "macos"))]
    fn letters_are_typed_unless_they_give_commands() {
        use Key::{A, Equal, LeftAlt, LeftCtrl, LeftShift, Q, RightAlt, S};
        assert_eq!(pressed(&[LeftShift, A], 'A'), ["Shift A", "A"]);
        assert_eq!(pressed(&[LeftCtrl, LeftShift, S], 'S'), ["Ctrl Shift S"]);
        assert_eq!(pressed(&[LeftCtrl, Equal], '+'), ["Ctrl Equal"]);
        assert_eq!(pressed(&[LeftCtrl], '+'), ["Ctrl NumPadPlus"]);
        // AltGr on Windows, for example on a German keyboard.
        assert_eq!(pressed(&[LeftCtrl, RightAlt, Q], '@'), ["Q", "@"]);
        assert_eq!(pressed(&[LeftAlt, A], 'a'), Vec::<String>::new());
    }
}
