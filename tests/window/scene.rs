//! A window with a picture, and functions that operate it.

use crate::display::Display;
use crate::terminal_support::{Pulse, Terminal, until};
use image::RgbImage;
use std::time::Duration;

pub const CUBE: &[&str] = &["max(abs(x),abs(y),abs(z)) = 1", "--size", "400x320"];

/// Number of waits of the main thread in which the window polls several times and draws at least
/// once, idle or not: in each of its turns it waits for the server two or three times.
const WAITS: u64 = 16;

/// A window that shows a cube, with its terminal and display.
pub struct Scene {
    pub terminal: Terminal,
    pub display: Display,
    pub window: String,
}

impl Scene {
    /// A window whose picture rests.
    pub fn start(arguments: &[&str]) -> Self {
        let scene = Self::start_working(arguments);
        scene.rest();
        scene
    }

    /// A window that shows a picture, and may work on a finer one.
    pub fn start_working(arguments: &[&str]) -> Self {
        let display = Display::start();
        let terminal = Terminal::start(arguments, Some(&display.name));
        let window = display.window();
        let scene = Self { terminal, display, window };
        scene.point(200, 160);
        until("the picture is there", || painted(&scene.picture()).is_some());
        scene
    }

    pub fn picture(&self) -> RgbImage {
        self.display.picture(&self.window)
    }

    /// The picture without the lines of text at top and bottom.
    pub fn middle(&self) -> RgbImage {
        let picture = self.picture();
        let (width, height) = picture.dimensions();
        image::imageops::crop_imm(&picture, 0, 24, width, height - 90).to_image()
    }

    /// Quits although there are unsaved changes: the first Ctrl-Q only asks, in the row above the
    /// status line.
    pub fn quits_after_a_question(&self) {
        self.turn();
        let before = self.picture();
        self.key("ctrl+q");
        until("the question is there", || self.picture() != before);
        self.key("ctrl+q");
    }

    /// Waits until the window has polled mouse and keys several times, and has drawn what that
    /// changed.
    pub fn turn(&self) {
        let Some(start) = self.terminal.pulse() else {
            // Nothing else tells it on this system.
            return std::thread::sleep(Duration::from_millis(100));
        };
        until("the window polls", || {
            self.terminal.pulse().is_some_and(|now| now.main >= start.main + WAITS)
        });
    }

    /// Waits until no thread works and the picture stops changing, and returns it.
    pub fn rest(&self) -> RgbImage {
        self.stands(|now, last| now == last && !now.is_some_and(|pulse| pulse.is_busy))
    }

    /// Waits until the picture stops changing while threads may work, and returns it.
    pub fn still(&self) -> RgbImage {
        self.stands(|_, _| true)
    }

    fn stands(&self, is_over: impl Fn(Option<Pulse>, Option<Pulse>) -> bool) -> RgbImage {
        let others = || self.terminal.pulse().map(|pulse| Pulse { main: 0, reporter: 0, ..pulse });
        let (mut last, mut worked) = (self.middle(), others());
        until("the picture comes to rest", || {
            self.turn();
            let (now, works) = (self.middle(), others());
            let is_same = now == last && is_over(works, worked);
            (last, worked) = (now, works);
            is_same
        });
        last
    }

    /// Returns whether the border says that the text has a fault.
    pub fn is_faulty(&self) -> bool {
        let [r, _, b] = self.picture().get_pixel(0, 100).0;
        r > 180 && b < 80
    }

    pub fn point(&self, x: i32, y: i32) {
        let (x, y) = (x.to_string(), y.to_string());
        self.display.tool(&["mousemove", "--window", &self.window, &x, &y]);
    }

    /// Calls `act`, and waits until the picture has changed and rests again. Returns the picture.
    pub fn changes(&self, what: &str, act: impl FnOnce()) -> RgbImage {
        let before = self.rest();
        self.differs(what, &before, act);
        self.rest()
    }

    /// Like [`Scene::changes`], while threads work.
    pub fn changes_meanwhile(&self, what: &str, act: impl FnOnce()) -> RgbImage {
        let before = self.still();
        self.differs(what, &before, act);
        self.still()
    }

    fn differs(&self, what: &str, before: &RgbImage, act: impl FnOnce()) {
        act();
        until(&format!("{what} changes the picture"), || self.middle() != *before);
        self.display.keep(&self.window, what);
    }

    pub fn key(&self, key: &str) {
        self.display.tool(&["key", key]);
    }

    pub fn drag(&self, button: &str, from: (i32, i32), to: (i32, i32)) {
        self.point(from.0, from.1);
        self.display.tool(&["mousedown", button]);
        for step in 1..=5 {
            self.turn();
            let at = |a: i32, b: i32| a + (b - a) * step / 5;
            self.point(at(from.0, to.0), at(from.1, to.1));
        }
        self.turn();
        self.display.tool(&["mouseup", button]);
        self.turn();
    }

    /// Presses and releases a button where the pointer is, as slowly as a finger does.
    pub fn press(&self, button: &str) {
        self.display.tool(&["mousedown", button]);
        self.turn();
        self.display.tool(&["mouseup", button]);
        self.turn();
    }
}

/// Bounds of the colored pixels between the lines of text: left, right, top, bottom.
pub fn painted(picture: &RgbImage) -> Option<[u32; 4]> {
    let (width, height) = picture.dimensions();
    let mut bounds = None;
    for y in 24..height.saturating_sub(66) {
        for x in 4..width - 4 {
            let [r, g, b] = picture.get_pixel(x, y).0.map(i32::from);
            if (r - b).abs() > 30 || (r - g).abs() > 30 {
                let [l, r, t, u] = bounds.unwrap_or([x, x, y, y]);
                bounds = Some([l.min(x), r.max(x), t.min(y), u.max(y)]);
            }
        }
    }
    bounds
}
