//! A real window: its size, letters and watched file, and the ways to close window and terminal.

use crate::display::Display;
use crate::scene::{CUBE, Scene, painted};
use crate::terminal_support::{Terminal, until};

/// Height of the status line, with letters `scale` times as large.
const fn status(scale: u32) -> u32 {
    20 * scale
}

pub fn shift_drag_moves_as_the_right_button_does() {
    let scene = Scene::start(CUBE);
    let (from, to) = ((200, 160), (240, 140));
    let right = scene.changes("right", || scene.drag("3", from, to));
    scene.changes("back", || scene.key("ctrl+0"));
    scene.display.tool(&["keydown", "Shift_L"]);
    let shift = scene.changes("shift", || scene.drag("1", from, to));
    scene.display.tool(&["keyup", "Shift_L"]);
    assert!(shift == right, "a drag with shift is another");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn the_picture_fills_a_window_that_grows_or_shrinks() {
    let mut scene = Scene::start(CUBE);
    for (width, height) in [(640, 480), (300, 220), (120, 90)] {
        let (w, h) = (width.to_string(), height.to_string());
        scene.display.tool(&["windowsize", &scene.window, &w, &h]);
        // Keys go to the window under the pointer.
        scene.point(60, 40);
        until("the window has its size", || scene.picture().dimensions() == (width, height));
        scene.rest();
        let picture = scene.picture();
        // Below the list, and above the name of an axis.
        let ground = picture.get_pixel(2, height / 3).0;
        assert!(ground.iter().all(|c| *c > 200), "{ground:?} at the edge of {width}x{height}");
        let line = picture.get_pixel(1, height - 2).0;
        assert!(line.iter().all(|c| *c < 80), "no status line in {width}x{height}");
        // The picture is rendered in the window's size, not stretched to it.
        scene.terminal.type_in(":status\r");
        scene.terminal.shows(&format!("pixels      {width}x{}:", height - status(1)));
        if height > 200 {
            let [left, right, ..] = painted(&picture).expect("a cube");
            assert!((left + right).abs_diff(width) < width / 16, "{left} to {right} of {width}");
            assert!(right - left > height / 3, "{left} to {right} of {width}x{height}");
        }
        scene.display.keep(&scene.window, &format!("size {width}"));
        scene.key("F1");
        until("there is help", || scene.picture() != picture);
        scene.display.keep(&scene.window, &format!("help {width}"));
        scene.key("Escape");
        until("there is no help", || scene.picture() == picture);
    }
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn letters_are_as_large_as_they_are_asked_to_be() {
    let scene = Scene::start(&["x^2+y^2+z^2 = 1", "--size", "700x480", "--ui-scale", "2"]);
    let picture = scene.picture();
    let dark = |y: u32| picture.get_pixel(1, y).0.iter().all(|c| *c < 80);
    // The hint where to type is above the status line.
    assert!(dark(480 - 2 * status(2) + 1) && !dark(480 - 2 * status(2) - 2));
    scene.changes("large without axes", || scene.key("F3"));
    scene.changes("large help", || scene.key("F1"));
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// Windows and letters are larger on a display with more than the usual 96 dots per inch.
pub fn a_display_s_scale_is_followed() {
    let display = Display::start();
    display.set_dpi("115.2");
    let terminal = Terminal::start(&["x^2+y^2+z^2 = 1"], Some(&display.name));
    let window = display.window();
    let scene = Scene { terminal, display, window };
    scene.rest();
    // 800x640 pixels, times 1.2.
    assert_eq!(scene.picture().dimensions(), (960, 768));
    let picture = scene.picture();
    let dark = |y: u32| picture.get_pixel(1, y).0.iter().all(|c| *c < 80);
    // The status line and the hint have 24 rows each.
    assert!(dark(768 - 47) && !dark(768 - 50));
    scene.point(200, 160);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn f11_takes_the_whole_screen_and_gives_it_back() {
    let display = Display::start();
    let _manager = display.manage();
    let terminal = Terminal::start(CUBE, Some(&display.name));
    let window = display.window();
    let scene = Scene { terminal, display, window };
    scene.rest();
    until("it has the keyboard", || scene.display.tool(&["getactivewindow"]) == scene.window);
    scene.key("F11");
    until("the screen is filled", || scene.picture().dimensions() == (1000, 800));
    scene.key("F11");
    until("the window has its size", || scene.picture().dimensions() == (400, 320));
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// Also takes the window's picture for the README.
pub fn the_overlay_is_drawn_around_the_picture() {
    let scene = Scene::start(&["barth-sextic", "--size", "800x620"]);
    let axes = scene.rest();
    let plain = scene.changes("no axes", || scene.key("F3"));
    scene.changes("axes", || scene.key("F3"));
    scene.point(400, 260);
    scene.turn();
    scene.display.keep(&scene.window, "window");
    // Lines and labels are dark. The background without them is not.
    let dark = |picture: &image::RgbImage| {
        picture.pixels().filter(|pixel| pixel.0.iter().all(|c| (30..120).contains(c))).count()
    };
    assert!(dark(&axes) > dark(&plain) + 500, "{} and {}", dark(&axes), dark(&plain));
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_saved_file_is_seen_at_once() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("surface.zset");
    let save = |text: &str| std::fs::write(&path, text).expect("written");
    save("domain 2\nmax(abs(x),abs(y),abs(z)) = 1\nview eye (4, -6, 3)");
    let name = path.to_str().expect("UTF-8");
    let scene = Scene::start(&[name, "--size", "400x320"]);
    let width = |scene: &Scene| {
        let [left, right, ..] = painted(&scene.rest()).expect("something");
        right - left
    };
    let before = width(&scene);
    scene.changes("reload", || {
        save("domain 2\nmax(abs(x),abs(y),abs(z)) = 1/2\nview eye (4, -6, 3)");
    });
    let small = width(&scene);
    assert!(small * 5 < before * 4, "{small} is not smaller than {before}");
    // After an error, the picture stays and gets a border.
    save("domain 2\nmax(abs(x)");
    until("there is a border", || scene.is_faulty());
    assert_eq!(width(&scene), small);
    scene.terminal.shows("surface.zset:2");
    scene.changes("mended", || {
        save("domain 2\nmax(abs(x),abs(y),abs(z)) = 3/2\nview eye (4, -6, 3)");
    });
    // A deleted file is reported over the picture, above the status line and the hint.
    scene.rest();
    let whole = scene.picture();
    std::fs::remove_file(&path).expect("removed");
    scene.terminal.shows("the last version is still shown");
    until("the window says so", || {
        let picture = scene.picture();
        let rows = 320 - 3 * status(1)..320 - 2 * status(1);
        rows.flat_map(|y| (0..200).map(move |x| (x, y)))
            .any(|(x, y)| picture.get_pixel(x, y) != whole.get_pixel(x, y))
    });
    scene.display.keep(&scene.window, "gone");
    // Its return is reported too, though the text is the same.
    save("domain 2\nmax(abs(x),abs(y),abs(z)) = 3/2\nview eye (4, -6, 3)");
    scene.terminal.shows("can be read again");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// Requests that a window close, as a window manager does.
fn close(scene: &Scene) {
    use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};
    let (connection, _) = x11rb::connect(Some(&scene.display.name)).expect("connected");
    let atom = |name: &str| {
        let reply = connection.intern_atom(false, name.as_bytes()).expect("asked").reply();
        reply.expect("answered").atom
    };
    let window = scene.window.parse().expect("a number");
    let data = [atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
    let event = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
    let sent = connection.send_event(false, window, EventMask::NO_EVENT, event).expect("sent");
    // Wait for the server's reply: the server may drop unread requests when the connection closes.
    sent.check().expect("delivered");
}

pub fn closing_the_window_ends_the_program_and_keeps_the_document() {
    let mut scene = Scene::start(CUBE);
    scene.terminal.type_in("z = x^3\r");
    scene.rest();
    // An unfinished line does not prevent the exit.
    scene.terminal.type_in("x^2+");
    close(&scene);
    let place = scene.terminal.place().to_owned();
    let kept = std::fs::read_to_string(place.join("data/zeroset/last.zset")).expect("kept");
    assert!(kept.contains("z = x^3"), "{kept}");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn the_close_button_asks_before_work_is_lost() {
    let mut scene = Scene::start(CUBE);
    for line in [":add x = 1", ":add y = 1", ":add z = 1"] {
        scene.terminal.type_in(&format!("{line}\r"));
    }
    scene.terminal.type_in(":list\r");
    scene.terminal.shows("z = 1");
    // The window asks, and stays in use.
    let reopened = |scene: &mut Scene| {
        let before = scene.window.clone();
        close(scene);
        until("the window is open again", || {
            scene.window = scene.display.window();
            scene.window != before
        });
        scene.point(200, 160);
        until("it shows the picture", || painted(&scene.picture()).is_some());
    };
    reopened(&mut scene);
    scene.rest();
    scene.changes("another plane", || {
        scene.type_text("x = 1/2");
        scene.key("ctrl+Return");
    });
    // There is more to lose now.
    reopened(&mut scene);
    close(&scene);
    scene.terminal.shows("the document was not saved");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_terminal_that_goes_away_with_a_signal_ends_the_program() {
    Terminal::controlling(&["--preview", "x+y+z"], None).hang_up();
}

pub fn a_terminal_that_goes_away_beside_a_window_ends_the_program() {
    let Scene { terminal, display, .. } = Scene::start(CUBE);
    terminal.hang_up();
    drop(display);
}
