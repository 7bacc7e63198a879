//! A newcomer's first day, from the first formula to the saved file on the next day. Nobody looks at
//! the window while keys are pressed.

use crate::display::Display;
use crate::scene::Scene;
use crate::terminal_support::{Terminal, until};
use std::sync::Arc;
use std::time::Duration;

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

    /// Returns whether the border says that the typed line has a fault.
    fn is_faulty(&self) -> bool {
        let [r, _, b] = self.picture().get_pixel(0, 150).0;
        r > 180 && b < 80
    }

    /// Quits, and starts again in the same directory.
    fn restarted(self, arguments: &[&str]) -> Self {
        self.key("ctrl+q");
        let place = self.terminal.shared_place();
        let Self { terminal, display, .. } = self;
        assert_eq!(terminal.ends(), 0);
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
    let place = Arc::clone(&scene.terminal.shared_place());
    let file = |name: &str| place.path().join(name);
    let shot = |scene: &Scene, name: &str| {
        scene.display.keep(&scene.window, &format!("newcomer {size} {name}"));
    };
    shot(&scene, "start");
    // Three formulas. The second has a mistake, and the third lacks a value.
    scene.type_text("x^2 + y^2 + z^2 = 4");
    scene.key("Return");
    scene.is_document("x^2 + y^2 + z^2 = 4");
    scene.type_text("z = sin(x)*cos(y");
    scene.key("Return");
    scene.terminal.shows("`(` is never closed");
    until("the mistake is marked", || scene.is_faulty());
    shot(&scene, "mistake");
    std::thread::sleep(Duration::from_millis(300));
    scene.key("Right");
    scene.type_text(")");
    scene.key("Return");
    scene.is_document("z = sin(x)*cos(y)");
    until("the mistake is mended", || !scene.is_faulty());
    scene.put("clipboard", "x^2 + y^2 - z^2 = r");
    scene.key("ctrl+v");
    until("a value is missing", || scene.is_faulty());
    scene.key("F2");
    until("it is there", || !scene.is_faulty());
    scene.key("Return");
    scene.is_document("r = 1\nx^2 + y^2 - z^2 = r");
    // Two more surfaces: by a click in the list, and by a key.
    let (width, height) = scene.picture().dimensions();
    scene.point(width as i32 - 30 * scale, scale * (TOP + ROW + ROW / 2));
    scene.display.tool(&["click", "1"]);
    scene.rest();
    scene.type_text("z = 3");
    scene.key("Return");
    scene.is_document("r = 1\nx^2 + y^2 - z^2 = r\nz = 3");
    scene.type_text("y = 1");
    scene.key("ctrl+Return");
    scene.is_document("r = 1\nx^2 + y^2 - z^2 = r\nz = 3\ny = 1");
    shot(&scene, "three surfaces");
    // A value is dragged, the view is turned, and the picture is cut open.
    let middle = scale * (TOP + ROW / 2);
    scene.changes("dragged value", || {
        scene.point(70 * scale, middle);
        scene.display.tool(&["mousedown", "1"]);
        scene.point(120 * scale, middle);
        // Hold the button until the window has seen where the pointer is.
        std::thread::sleep(Duration::from_millis(300));
        scene.rest();
        scene.display.tool(&["mouseup", "1"]);
    });
    let mut text = String::new();
    until("the value is in the document", || {
        scene.copied().trim_end().clone_into(&mut text);
        text.starts_with("r = 1.") && text.contains(" in [0, 2]\n")
    });
    let (x, y) = (width as i32 / 2, height as i32 / 2);
    scene.changes("turned", || scene.drag("1", (x, y), (x + 60, y + 10)));
    scene.changes("cut", || scene.key("F7"));
    scene.changes("moved cut", || {
        scene.display.tool(&["keydown", "Control_L", "click", "4", "keyup", "Control_L"]);
    });
    shot(&scene, "cut");
    // The document and the picture are saved. The window says so above the status line.
    scene.key("Escape");
    scene.rest();
    let ground = scene.picture();
    scene.key("ctrl+s");
    scene.key("Return");
    scene.terminal.shows("saved 'zeroset-1.zset'");
    scene.has_title("zeroset-1.zset");
    let place_of_message = (2, height - (scale * ROW * 3 / 2) as u32);
    let at =
        |picture: &image::RgbImage| picture.get_pixel(place_of_message.0, place_of_message.1).0;
    until("the window says so", || at(&scene.picture()) != at(&ground));
    shot(&scene, "saved");
    let saved = std::fs::read_to_string(file("zeroset-1.zset")).expect("saved");
    assert_eq!(saved.trim_end(), text);
    scene.key("ctrl+p");
    scene.terminal.shows("-o zeroset-1.png");
    let picture = image::open(file("zeroset-1.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (width, height - (scale * ROW) as u32));
    // All is saved, so nothing is said at the end.
    let shown = scene.terminal.shown();
    assert!(!shown.contains("was not saved"), "{shown}");
    let scene = scene.restarted(&["zeroset-1.zset"]);
    scene.has_title("zeroset-1.zset");
    scene.is_document(&text);
    // Unsaved work outlasts the program.
    scene.type_text("x = 2");
    scene.key("ctrl+Return");
    scene.has_title("zeroset-1.zset*");
    let more = format!("{text}\nx = 2");
    scene.is_document(&more);
    let scene = scene.restarted(&["--last"]);
    scene.is_document(&more);
    // The file is among the recent ones.
    let scene = scene.restarted(&[]);
    scene.has_title("gyroid");
    scene.changes("recent files", || scene.key("ctrl+r"));
    scene.key("Return");
    scene.has_title("zeroset-1.zset");
    scene.is_document(&text);
    scene.type_text("x = 3");
    scene.key("Return");
    scene.has_title("zeroset-1.zset*");
    scene.key("ctrl+q");
    scene.terminal.shows("the document was not saved");
    scene.terminal.shows("`zeroset --last`");
    assert_eq!(scene.terminal.ends(), 0);
}
