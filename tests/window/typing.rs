//! Typing in a real window: every printable key types, and the line is edited as lines are.

use crate::display::Display;
use crate::scene::{CUBE, Scene, painted};
use crate::terminal_support::{Terminal, until};
use std::io::Write as _;
use std::process::{Command, Stdio};

/// Formulas that a newcomer may type. Together they begin with most kinds of keys.
const FORMULAS: [&str; 50] = [
    "x^2+y^2=1",
    "z = sqrt(x)",
    "x^2+y^2+z^2 = 1",
    "sin(x)+sin(y)+sin(z) = 0",
    "z = x^2 - y^2",
    "r = 1",
    "y = x^2",
    "tan(x) = z",
    "1 = x^2 + z^2",
    "2x + 3y = z",
    "-x + y = z",
    "+x = z",
    "(x^2+y^2-1)^2 = z",
    "|x|+|y|+|z| = 1",
    "max(abs(x),abs(y),abs(z)) = 1",
    "min(x,y) = z",
    "exp(x) = z",
    "log(x) = z",
    "pi*x = z",
    "abs(x) = z",
    "floor(x) = z",
    "gamma(x) = z",
    "hypot(x,y) = 1",
    "x*y*z = 1",
    "x y z = 1/2",
    "cos x = z",
    "z^2 = cos(x) cos(y)",
    "z <= x",
    "x^2 + y^2 < 1",
    "y > x^2",
    "x >= z^2",
    "sphere(1) <= 0",
    "union(sphere(1), box(0.8)) <= 0",
    "translate(sphere(1), 2, 0, 0) <= 0",
    "torus(1, 0.3) = 0",
    "z = {x < 0: x^2, x}",
    "z = mod(x, 1)",
    "9x^2 = 4 - z",
    "8 = x^4+y^4+z^4",
    "7x = z",
    "0 = x - z",
    ".5 = x z",
    "tanh(x) = z",
    "u = 2",
    "k = 3",
    "f(a) = a^2",
    "lambda = 2",
    "domain 3",
    "t = 1",
    "m = 4",
];

impl Scene {
    /// Types a text by the keyboard.
    pub fn type_text(&self, text: &str) {
        self.display.tool(&["type", "--delay", "8", "--", text]);
    }

    /// The document, as Ctrl-C in the window copies it.
    pub fn copied(&self) -> String {
        self.key("ctrl+c");
        // Or it might copy after others have put something there.
        self.turn();
        self.clipboard("clipboard")
    }

    fn clipboard(&self, selection: &str) -> String {
        let run = Command::new("xclip")
            .env("DISPLAY", &self.display.name)
            .args(["-o", "-selection", selection])
            .output();
        String::from_utf8(run.expect("xclip runs").stdout).expect("UTF-8")
    }

    pub fn put(&self, selection: &str, text: &str) {
        let mut child = Command::new("xclip")
            .env("DISPLAY", &self.display.name)
            .args(["-i", "-selection", selection])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("xclip runs");
        child.stdin.take().expect("piped").write_all(text.as_bytes()).expect("written");
        child.wait().expect("it ends");
    }

    pub fn is_document(&self, text: &str) {
        let mut last = String::new();
        until(&format!("the document is {text:?}"), || {
            last = self.copied();
            last.trim_end() == text
        });
    }
}

/// Nobody looks at the window before the keys are pressed, and so none of them may be a command.
pub fn fifty_formulas_typed_blind_are_drawn() {
    let scene = Scene::start(CUBE);
    let place = scene.terminal.place().to_owned();
    let files = || std::fs::read_dir(&place).expect("listed").count();
    let before = files();
    for formula in FORMULAS {
        scene.type_text(formula);
        scene.key("Return");
        let mut text = String::new();
        until(&format!("{formula} is in the document"), || {
            text = scene.copied();
            text.lines().any(|line| line == formula)
        });
    }
    assert_eq!(files(), before, "a file was written");
    scene.quits_after_a_question();
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_line_is_selected_copied_cut_pasted_and_undone() {
    let scene = Scene::start(CUBE);
    scene.type_text("z = x^2 + y^3");
    scene.display.tool(&["key", "shift+Left", "shift+Left", "shift+Left"]);
    scene.display.keep(&scene.window, "selected");
    scene.key("ctrl+x");
    until("it was cut", || scene.clipboard("clipboard") == "y^3");
    scene.type_text("sin(");
    scene.key("ctrl+v");
    scene.type_text(")");
    scene.key("Return");
    scene.is_document("z = x^2 + sin(y^3)");
    // Undo first takes back what was typed, and then what was entered.
    scene.type_text("x = 1");
    scene.display.tool(&["key", "ctrl+z", "ctrl+y", "Home", "Delete"]);
    scene.type_text("y");
    scene.key("Return");
    scene.is_document("y = 1");
    scene.key("ctrl+z");
    scene.is_document("z = x^2 + sin(y^3)");
    // A refused line comes back, and typing replaces it.
    scene.type_text("z = x + foo");
    scene.key("Return");
    scene.terminal.shows("`foo` is not defined");
    until("the line is back", || scene.copied() == "z = x + foo");
    scene.type_text("z = 7");
    scene.key("Return");
    scene.is_document("z = 7");
    // Select all, and type over it.
    scene.type_text("nonsense(");
    scene.key("ctrl+a");
    scene.type_text("z = 2x");
    scene.key("Return");
    scene.is_document("z = 2x");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_wrong_formula_from_the_command_line_is_mended_in_the_line() {
    let display = Display::start();
    let terminal = Terminal::start(&["x^2+y^2+z^2 =", "--size", "400x320"], Some(&display.name));
    let window = display.window();
    let scene = Scene { terminal, display, window };
    scene.point(200, 160);
    scene.turn();
    scene.type_text(" 1");
    scene.key("Return");
    until("the picture is there", || painted(&scene.picture()).is_some());
    scene.is_document("x^2+y^2+z^2 = 1");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn tab_writes_the_line_that_the_advice_gives() {
    let scene = Scene::start(CUBE);
    scene.type_text("z = sine(x)");
    until("the advice is there", || scene.is_faulty());
    scene.key("Tab");
    until("it is mended", || !scene.is_faulty());
    scene.key("Return");
    scene.is_document("z = sin(x)");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn other_programs_texts_are_pasted() {
    let scene = Scene::start(CUBE);
    scene.put("clipboard", "z = 3x");
    scene.key("ctrl+v");
    scene.key("Return");
    scene.is_document("z = 3x");
    scene.put("clipboard", "z = 4x\n");
    scene.key("shift+Insert");
    scene.key("Return");
    scene.is_document("z = 4x");
    // The middle button pastes what is selected elsewhere.
    scene.put("primary", "z = 5x");
    scene.press("2");
    scene.key("Return");
    scene.is_document("z = 5x");
    // Several lines are a document, which is undone in one step.
    scene.put("clipboard", "a = 2 in [0, 3]\nx^2 + y^2 + z^2 = a\nz = 1\n");
    scene.key("ctrl+v");
    scene.is_document("a = 2 in [0, 3]\nx^2 + y^2 + z^2 = a\nz = 1");
    scene.key("ctrl+z");
    scene.is_document("z = 5x");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}
