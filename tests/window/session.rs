//! A real window on a virtual display: mouse, keys, the edit line, saving, reloading.

use crate::scene::{CUBE, Scene, painted};
use crate::terminal_support::until;

pub fn the_picture_is_centred_and_follows_mouse_and_keys() {
    // This method leaves some pixels undecided, so that they can be marked.
    let scene = Scene::start(&[CUBE, &["--method", "knoll"]].concat());
    scene.display.keep(&scene.window, "start");
    let [left, right, top, bottom] = painted(&scene.picture()).expect("a cube");
    assert!((left + right).abs_diff(400) < 24, "not centred: {left} to {right}");
    assert!(bottom - top > 120 && right - left > 120, "small: {top} to {bottom}");
    let start = scene.rest();
    scene.changes("drag", || scene.drag("1", (200, 160), (260, 180)));
    scene.changes("pan", || scene.drag("3", (200, 160), (240, 140)));
    scene.changes("wheel", || {
        scene.display.tool(&["click", "4"]);
    });
    scene.changes("arrow", || scene.key("Left"));
    scene.changes("plus", || scene.key("ctrl+plus"));
    scene.changes("fit", || scene.key("ctrl+f"));
    assert!(scene.changes("reset", || scene.key("ctrl+0")) == start, "not as at the start");
    scene.changes("parallel", || scene.key("F6"));
    assert!(scene.changes("reset again", || scene.key("ctrl+0")) == start);
    scene.changes("undecided", || scene.key("F8"));
    assert!(scene.changes("decided", || scene.key("F8")) == start);
    scene.changes("no axes", || scene.key("F3"));
    assert!(scene.changes("axes", || scene.key("F3")) == start);
    scene.changes("help", || scene.key("F1"));
    assert!(scene.changes("no help", || scene.key("Escape")) == start);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// The X server reports a step of the wheel as a button that is pressed and released.
pub fn one_step_of_the_wheel_zooms_as_far_as_a_key() {
    let scene = Scene::start(CUBE);
    // The middle of the picture, above a status line of 20 pixels.
    scene.point(200, 150);
    let start = scene.rest();
    let zoomed = scene.changes("plus", || scene.key("ctrl+plus"));
    let back = || assert!(scene.changes("reset", || scene.key("ctrl+0")) == start);
    back();
    let step = scene.changes("a step", || {
        scene.display.tool(&["click", "4"]);
    });
    assert!(step == zoomed, "a step of the wheel is no step of the key");
    back();
    // In a slow step, one poll of the mouse sees the button pressed, and another sees it released.
    let slow = scene.changes("a slow step", || {
        scene.display.tool(&["mousedown", "4"]);
        scene.turn();
        scene.display.tool(&["mouseup", "4"]);
    });
    assert!(slow == zoomed, "a slow step is another");
    back();
    let far = scene.changes("minus", || scene.key("ctrl+minus"));
    back();
    let step = scene.changes("a step back", || {
        scene.display.tool(&["click", "5"]);
    });
    assert!(step == far, "a step back is no step of the key");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_line_is_typed_corrected_and_entered_in_the_window() {
    let mut scene = Scene::start(CUBE);
    let type_in = |scene: &Scene, text: &str| {
        scene.display.tool(&["type", "--delay", "30", text]);
    };
    let start = scene.rest();
    scene.changes("typing", || type_in(&scene, "z = x^2"));
    // After an error the picture stays. The border and one line show the error.
    type_in(&scene, " + q(");
    until("there is a border", || scene.is_faulty());
    scene.display.keep(&scene.window, "mistake");
    assert!(scene.changes("closing", || scene.key("Escape")) == start, "not as before");
    scene.changes("another", || {
        scene.key("Return");
        type_in(&scene, "z = x^3");
    });
    scene.key("Return");
    // The window reads keys only when it next polls, so wait before typing at the prompt.
    scene.rest();
    scene.terminal.type_in(":list\r");
    scene.terminal.shows("z = x^3");
    // The prompt, which waits, also records the line that was entered in the window.
    let history = scene.terminal.place().join("data/zeroset/history");
    let history = std::fs::read_to_string(history).expect("kept");
    let lines: Vec<&str> = history.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(lines, ["z = x^3", ":list"]);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// A program with a loop, a vector and a word that only programs have.
const PROGRAM: &str = "float map(vec3 p) {
  float d = 1e3;
  for (int i = 0; i < 4; i++) {
    d = min(d, length(p - vec3(float(i) - 1.5, 0.0, 0.0)) - 0.6);
  }
  return d;
}";

/// Several lines: two surfaces, of which the second is in front.
const LINES: &str =
    "view front\nr = 0.5\nx^2 + z^2 + (y - 2)^2 = r^2\n# the wall\ny = -1 + 0.1*sin(3*x)*r";

pub fn a_click_and_a_saved_picture_can_be_repeated_from_the_terminal() {
    let size = ["--size", "400x320"];
    repeats_click_and_picture(CUBE, "max(abs(x)");
    repeats_click_and_picture(&[&[PROGRAM], &size[..]].concat(), "float map");
    repeats_click_and_picture(&[&[LINES], &size[..]].concat(), "# the wall");
    let directory = tempfile::tempdir().expect("a directory");
    let file = directory.path().join("it's a file.glsl");
    std::fs::write(&file, format!("{PROGRAM}\n")).expect("written");
    let file = file.to_str().expect("a name in UTF-8");
    let commands = repeats_click_and_picture(&[&[file], &size[..]].concat(), "s a file.glsl'");
    assert!(commands.iter().all(|command| command.lines().count() == 1), "{commands:?}");
}

/// Clicks and saves a picture, then runs both commands that the terminal shows. They hold this part
/// of the document.
fn repeats_click_and_picture(arguments: &[&str], part: &str) -> [String; 2] {
    let mut scene = Scene::start(arguments);
    scene.changes("turning", || scene.drag("1", (200, 160), (190, 155)));
    scene.point(200, 160);
    scene.turn();
    scene.press("1");
    scene.terminal.shows("| zeroset eval");
    scene.key("ctrl+p");
    scene.terminal.shows("-o zeroset-1.png");
    let shown = scene.terminal.shown().replace("\r\n", "\n");
    // A command ends with the line in which its last quote is closed.
    let command = |begin: &str| {
        let rest = &shown[shown.find(begin).unwrap_or_else(|| panic!("no {begin:?} in {shown}"))..];
        // A quote within a word is written as '\''.
        let is_whole =
            |end: &usize| rest[..*end].replace("\\'", "").matches('\'').count().is_multiple_of(2);
        let end = rest.match_indices('\n').map(|(end, _)| end).find(is_whole);
        rest[..end.expect("a whole command")].to_owned()
    };
    let commands = [command("echo '{"), command("zeroset render ")];
    assert!(commands.iter().all(|command| command.matches(part).count() == 1), "{commands:?}");
    let program = env!("CARGO_BIN_EXE_zeroset");
    let shell = |line: &str| {
        let line = line.replace("| zeroset", &format!("| {program}"));
        let line = line.replacen("zeroset render", &format!("{program} render"), 1);
        let run = std::process::Command::new("sh")
            .args(["-c", &line])
            .current_dir(scene.terminal.place())
            .output();
        let run = run.expect("sh runs");
        assert!(run.status.success(), "{line}: {}", String::from_utf8_lossy(&run.stderr));
        String::from_utf8(run.stdout).expect("UTF-8")
    };
    let answer: serde_json::Value = serde_json::from_str(&shell(&commands[0])).expect("JSON");
    let value = format!("f = {}", answer["value"].as_f64().expect("a number"));
    assert!(shown.contains(&value), "{value} is not in {shown}");
    let pixels = |name| image::open(scene.terminal.place().join(name)).expect("saved");
    let saved = pixels("zeroset-1.png");
    shell(&commands[1].replace("-o zeroset-1.png", "-o again.png"));
    assert!(saved == pixels("again.png"), "the command makes another picture");
    scene.terminal.type_in(":quit\r");
    assert_eq!(scene.terminal.ends(), 0);
    commands
}

pub fn a_key_and_enter_save_a_mesh() {
    let mut scene = Scene::start(CUBE);
    scene.rest();
    scene.key("ctrl+e");
    scene.turn();
    scene.key("Return");
    let file = scene.terminal.place().join("zeroset-1.stl");
    let triangles = || {
        let bytes = std::fs::read(&file).unwrap_or_default();
        bytes.get(80..84).map_or(0, |count| u32::from_le_bytes(count.try_into().expect("four")))
    };
    until("the mesh is saved", || triangles() >= 12);
    scene.terminal.type_in(":quit\r");
    assert_eq!(scene.terminal.ends(), 0);
}

/// The window stays responsive while another thread waits for a slow picture.
pub fn saving_a_slow_picture_does_not_hold_the_window() {
    // The coarse picture takes seconds, and the fine one would take minutes.
    let terms = (1..80).map(|k| format!("sin({k}*x+y)*cos({k}*y-z)"));
    let formula = format!("{} = 5", terms.collect::<Vec<_>>().join("+"));
    let fine = ["--size", "900x700", "--precision", "f64", "--max-depth", "20", "--domain", "1"];
    let mut scene = Scene::start_working(&[&[formula.as_str()][..], &fine[..]].concat());
    scene.key("ctrl+p");
    scene.changes_meanwhile("help", || scene.key("F1"));
    scene.changes_meanwhile("no help", || scene.key("Escape"));
    assert!(!scene.terminal.place().join("zeroset-1.png").exists(), "that was no slow picture");
    // Ctrl-C in the terminal gives up the picture, and not the program.
    scene.terminal.type_in("\u{3}");
    scene.terminal.shows("the picture was given up");
    scene.changes("help again", || scene.key("F1"));
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}
