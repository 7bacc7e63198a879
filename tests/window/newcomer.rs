//! A newcomer's first day, from the first formula to the saved file on the next day. Keys are
//! pressed without a look at the window.

use crate::display::Display;
use crate::scene::Scene;
use crate::terminal_support::{Terminal, until};

pub fn a_newcomer_is_at_home_on_a_small_screen() {
    first_day("800x500", "96", 1);
}

pub fn a_newcomer_is_at_home_on_a_usual_screen() {
    first_day("1920x1080", "96", 1);
}

pub fn a_newcomer_is_at_home_on_a_dense_screen() {
    first_day("3840x2160", "192", 2);
}

/// Height of a row of text, and the space above the first row, in dots of a letter.
const ROW: i32 = 20;
const TOP: i32 = 6;

impl Scene {
    fn has_title(&self, title: &str) {
        let title = format!("{title} - zeroset");
        until(&format!("the title is {title:?}"), || {
            self.display.tool(&["getwindowname", &self.window]) == title
        });
    }

    fn has_keyboard(&self) {
        until("it has the keyboard", || self.display.tool(&["getactivewindow"]) == self.window);
        self.rest();
    }

    /// Quits, and starts again in the same directory.
    fn restarted(self, arguments: &[&str]) -> Self {
        self.key("ctrl+q");
        self.started_again(arguments)
    }

    /// Starts again in the same directory, once the program has ended.
    fn started_again(self, arguments: &[&str]) -> Self {
        let place = self.terminal.shared_place();
        let Self { terminal, display, window } = self;
        assert_eq!(terminal.ends(), 0);
        // The server learns of the end later than this test.
        until("the window is gone", || {
            let named = display.tool(&["search", "--name", " - zeroset$"]);
            named.lines().all(|other| other != window)
        });
        let terminal = Terminal::start_again(place, arguments, Some(&display.name));
        let window = display.window();
        let scene = Self { terminal, display, window };
        scene.has_keyboard();
        scene
    }
}

fn first_day(size: &str, dpi: &str, scale: i32) {
    let display = Display::sized(size);
    let _manager = display.manage();
    display.set_dpi(dpi);
    let terminal = Terminal::start(&[], Some(&display.name));
    let window = display.window();
    let scene = Scene { terminal, display, window };
    scene.has_keyboard();
    scene.has_title("gyroid");
    scene.keep(size, "start");
    scene.types_formulas(scale);
    scene.keep(size, "three surfaces");
    let text = scene.drags_turns_and_cuts(scale);
    scene.keep(size, "cut");
    scene.saves(scale, &text);
    scene.keep(size, "saved");
    finds_it_again(scene, &text);
}

impl Scene {
    fn keep(&self, size: &str, name: &str) {
        self.display.keep(&self.window, &format!("newcomer {size} {name}"));
    }

    fn types_formulas(&self, scale: i32) {
        // Three formulas. The second has a mistake, and the third lacks a value.
        self.type_text("x^2 + y^2 + z^2 = 4");
        self.key("Return");
        self.is_document("x^2 + y^2 + z^2 = 4");
        self.type_text("z = sin(x)*cos(y*");
        self.key("Return");
        self.terminal.shows("`(` is never closed");
        until("the mistake is marked", || self.is_faulty());
        until("the line is back", || self.copied() == "z = sin(x)*cos(y*");
        self.key("Right");
        self.type_text("x)");
        self.key("Return");
        self.is_document("z = sin(x)*cos(y*x)");
        until("the mistake is mended", || !self.is_faulty());
        self.put("clipboard", "x^2 + y^2 - z^2 = r");
        self.key("ctrl+v");
        until("a value is missing", || self.is_faulty());
        self.key("F2");
        until("it is there", || !self.is_faulty());
        self.key("Return");
        self.is_document("r = 1\nx^2 + y^2 - z^2 = r");
        // Two more surfaces: by a click in the list, and by a key.
        let width = self.picture().width();
        self.point(width as i32 - 30 * scale, scale * (TOP + ROW + ROW / 2));
        self.display.tool(&["click", "1"]);
        self.rest();
        self.type_text("z = 3");
        self.key("Return");
        self.is_document("r = 1\nx^2 + y^2 - z^2 = r\nz = 3");
        self.type_text("y = 1");
        self.key("ctrl+Return");
        self.is_document("r = 1\nx^2 + y^2 - z^2 = r\nz = 3\ny = 1");
    }

    /// Drags a value, turns the view, and cuts the picture open. Returns the document.
    fn drags_turns_and_cuts(&self, scale: i32) -> String {
        let middle = scale * (TOP + ROW / 2);
        self.changes("dragged value", || {
            self.point(70 * scale, middle);
            self.display.tool(&["mousedown", "1"]);
            self.point(120 * scale, middle);
            // Hold the button until the window has seen where the pointer is.
            self.rest();
            self.display.tool(&["mouseup", "1"]);
        });
        let mut text = String::new();
        until("the value is in the document", || {
            self.copied().trim_end().clone_into(&mut text);
            text.starts_with("r = 1.") && text.contains(" in [0, 2]\n")
        });
        let (width, height) = self.picture().dimensions();
        let (x, y) = (width as i32 / 2, height as i32 / 2);
        self.changes("turned", || self.drag("1", (x, y), (x + 60, y + 10)));
        self.changes("cut", || self.key("F7"));
        self.changes("moved cut", || {
            self.display.tool(&["keydown", "Control_L", "click", "4", "keyup", "Control_L"]);
        });
        text
    }

    /// Saves the document, which has this text, and the picture. The window says so above the
    /// status line.
    fn saves(&self, scale: i32, text: &str) {
        let place = self.terminal.shared_place();
        let file = |name: &str| place.path().join(name);
        let (width, height) = self.picture().dimensions();
        self.key("Escape");
        self.rest();
        let ground = self.picture();
        self.key("ctrl+s");
        self.key("Return");
        self.terminal.shows("saved 'zeroset-1.zset'");
        self.has_title("zeroset-1.zset");
        let place_of_message = (2, height - (scale * ROW * 3 / 2) as u32);
        let at =
            |picture: &image::RgbImage| picture.get_pixel(place_of_message.0, place_of_message.1).0;
        until("the window says so", || at(&self.picture()) != at(&ground));
        let saved = std::fs::read_to_string(file("zeroset-1.zset")).expect("saved");
        assert_eq!(saved.trim_end(), text);
        self.key("ctrl+p");
        self.terminal.shows("-o zeroset-1.png");
        let picture = image::open(file("zeroset-1.png")).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (width, height - (scale * ROW) as u32));
    }
}

fn finds_it_again(scene: Scene, text: &str) {
    // All is saved, so nothing is said at the end.
    let shown = scene.terminal.shown();
    assert!(!shown.contains("was not saved"), "{shown}");
    let scene = scene.restarted(&["zeroset-1.zset"]);
    scene.has_title("zeroset-1.zset");
    scene.is_document(text);
    // Unsaved work outlasts the program.
    scene.type_text("x = 2");
    scene.key("ctrl+Return");
    scene.has_title("zeroset-1.zset*");
    let more = format!("{text}\nx = 2");
    scene.is_document(&more);
    scene.quits_after_a_question();
    let scene = scene.started_again(&["--last"]);
    scene.is_document(&more);
    // It is offered once, by the first start that would show something else.
    let scene = scene.restarted(&[]);
    scene.terminal.shows("The last document was not saved: `:load last` opens it.");
    let scene = scene.restarted(&[]);
    scene.terminal.shows("This is the gyroid.");
    // The file is among the recent ones.
    scene.has_title("gyroid");
    scene.changes("recent files", || scene.key("ctrl+r"));
    scene.key("Return");
    scene.has_title("zeroset-1.zset");
    scene.is_document(text);
    scene.type_text("x = 3");
    scene.key("Return");
    scene.has_title("zeroset-1.zset*");
    scene.quits_after_a_question();
    scene.terminal.shows("the document was not saved");
    scene.terminal.shows("`zeroset --last`");
    assert_eq!(scene.terminal.ends(), 0);
}
