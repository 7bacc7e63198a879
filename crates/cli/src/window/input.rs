//! The queue of keyboard input. Knows no commands.

use minifb::{InputCallback, Key};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// A key or a letter. Events are queued, so a key released before the next poll is not lost.
#[derive(Clone, Copy)]
pub enum InputEvent {
    Letter(char),
    Key(Key),
    /// A key pressed while Ctrl was held.
    Control(Key),
}

/// Input that has not been handled yet.
#[derive(Clone, Default)]
pub struct InputQueue(Rc<RefCell<VecDeque<InputEvent>>>);

impl InputQueue {
    /// Takes all input, in order.
    pub fn take(&self) -> Vec<InputEvent> {
        self.0.borrow_mut().drain(..).collect()
    }
}

/// Receives input from the window's library.
pub struct Keyboard {
    pub typed: InputQueue,
    /// Whether the left and the right Ctrl key are held.
    pub controls: [bool; 2],
}

impl InputCallback for Keyboard {
    fn add_char(&mut self, letter: u32) {
        if let Some(letter) = char::from_u32(letter).filter(|letter| !letter.is_control()) {
            self.typed.0.borrow_mut().push_back(InputEvent::Letter(letter));
        }
    }

    fn set_key_state(&mut self, key: Key, down: bool) {
        match key {
            Key::LeftCtrl => self.controls[0] = down,
            Key::RightCtrl => self.controls[1] = down,
            _ => {}
        }
        if down {
            let held = self.controls.contains(&true);
            let input = if held { InputEvent::Control(key) } else { InputEvent::Key(key) };
            self.typed.0.borrow_mut().push_back(input);
        }
    }
}
