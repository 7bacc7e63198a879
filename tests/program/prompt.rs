//! The prompt in a pseudo-terminal without a display: preview, errors, history, clean exits.

use crate::cli_render::BULB;
use crate::terminal_support::{Terminal, until};
use std::path::PathBuf;

/// Whether the output has a picture made of letters.
fn has_letters(shown: &str) -> bool {
    // Sixel data has no such runs, since it stores a run as a number and one character.
    ["@@@@@", "%%%%%", "#####", "*****"].iter().any(|row| shown.contains(row))
}

/// The picture has a single band, so progress must be reported within the band.
#[test]
fn a_slow_picture_shows_how_far_it_is_and_then_nothing_of_that() {
    let view = ["--domain", "1.2", "--view", "front", "--ortho", "5e-4", "--size", "60000x16"];
    let flags = ["--budget", "6", "-o", "p.png"];
    let terminal = Terminal::start(&[&["render", BULB], &view[..], &flags].concat(), None);
    terminal.shows("tracing");
    let percents = |shown: &str| -> Vec<u32> {
        let number = |before: &str| before.rsplit(' ').next()?.parse().ok();
        shown.split('%').filter_map(number).collect()
    };
    until("some of it is done", || percents(&terminal.shown()).iter().any(|done| *done > 0));
    assert!(!terminal.place().join("p.png").exists());
    until("the line is empty again", || {
        let shown = terminal.shown();
        shown.rfind("\x1b[2K") > shown.rfind("tracing")
    });
    until("it is written", || terminal.place().join("p.png").exists());
    assert_eq!(terminal.ends(), 0);
}

#[test]
fn without_a_display_pictures_are_shown_in_the_terminal() {
    let mut terminal = Terminal::start(&["x^2+y^2+z^2 = 1"], None);
    terminal.shows("there is no display");
    terminal.shows("undecided");
    assert!(has_letters(&terminal.shown()), "no picture");
    terminal.type_in("x^2+y^2+foo = 1\r");
    terminal.shows("`foo` is not defined");
    terminal.type_in(":stauts\r");
    terminal.shows("did you mean :status?");
    // A line with an open bracket continues on the next.
    terminal.type_in("max(abs(x),\rabs(y), abs(z)) = 1\r");
    // A command ends a line whose bracket is still open.
    terminal.type_in("sin(x*\r:status\r");
    terminal.shows("is never closed");
    terminal.shows("surface     max(abs(x), abs(y), abs(z)) = 1");
    terminal.type_in(":save cube.zset\r");
    terminal.shows("saved 'cube.zset'");
    terminal.type_in(":help\r");
    terminal.shows("smoothstep");
    let place = terminal.place().to_owned();
    let read = |name: &str| std::fs::read_to_string(place.join(name)).expect(name);
    assert_eq!(read("cube.zset").replace('\n', " ").trim(), "max(abs(x), abs(y), abs(z)) = 1");
    assert!(read("data/zeroset/history").contains(":save cube.zset"));
    // To overwrite a file of another document, `:save` must be entered twice.
    std::fs::write(place.join("notes.zset"), "x = y\n").expect("a file");
    terminal.type_in(":save notes.zset\r");
    terminal.shows("there is another file 'notes.zset'");
    assert_eq!(read("notes.zset"), "x = y\n");
    terminal.type_in(":save notes.zset\r");
    terminal.shows("saved 'notes.zset'");
    assert!(read("notes.zset").contains("max(abs(x)"));
    // `:save` writes the document's own file, `notes.zset`, at once. `cube.zset` is another file.
    terminal.type_in(":save cube.zset\r");
    terminal.shows("there is another file 'cube.zset'");
    terminal.type_in(":save\r");
    terminal.shows("saved 'notes.zset'");
    assert!(read("data/zeroset/last.zset").contains("abs(z)"));
    terminal.leaves();
}

#[test]
fn without_a_window_the_gallery_is_a_list() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z\nx = y"], None);
    terminal.shows("undecided");
    terminal.type_in(":gallery\r");
    terminal.shows("heart-taubin");
    // These commands do the same as the window's list of surfaces.
    for (line, shown) in [
        (":hide 2\r", "hidden\r\nx = y"),
        (":opacity 1 25%\r", "opacity 25%\r\nx+y+z"),
        (":move 2 1\r", "opacity 25%\r\nhidden off\r\nx+y+z"),
        (":hide 3\r", "there is no drawing 3; they are numbered 1 to 2"),
        (":help status\r", "every pixel proven"),
    ] {
        terminal.type_in(line);
        terminal.type_in(":list\r");
        terminal.shows(shown);
    }
    terminal.leaves();
}

/// Ctrl-C while a picture is traced is a signal, since the prompt reads no keys then.
#[test]
fn an_interrupt_gives_up_the_picture_and_not_the_program() {
    // The fine picture takes minutes.
    let terms = (1..200).map(|k| format!("sin({k}*x+y)*cos({k}*y-z)"));
    let slow = format!("{} = 5", terms.collect::<Vec<_>>().join("+"));
    let fine = ["--precision", "f64", "--max-depth", "30", "--domain", "1"];
    let mut terminal =
        Terminal::controlling(&[&["--preview", slow.as_str()][..], &fine].concat(), None);
    // By then the picture was asked for.
    terminal.shows("Type a formula to replace this one");
    terminal.send(b"\x03");
    terminal.shows("the picture was given up");
    terminal.type_in("z = x\r");
    terminal.shows("undecided");
    // Without work, Ctrl-C on an empty line ends the program. The document was not saved.
    terminal.type_in("\u{3}");
    terminal.shows("`zeroset --last` or `:load last` opens it again");
    assert_eq!(terminal.ends(), 0);
}

#[test]
fn what_was_not_saved_comes_back() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.type_in("z = x^3\r");
    terminal.type_in(":load gyroid\r");
    terminal.type_in(":load last\r");
    terminal.type_in(":list\r");
    terminal.shows("\nz = x^3");
    let mut later = crate::surroundings::zeroset(&[], &terminal.place().join("data"))
        .args(["--preview", "--last"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    std::io::Write::write_all(&mut later.stdin.take().expect("piped"), b":list\n")
        .expect("written");
    let output = later.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("z = x^3"), "{said}");
    terminal.leaves();
}

#[test]
fn what_is_wrong_is_said_after_a_pause_and_the_line_goes_on() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    terminal.type_in("x + fooo");
    terminal.shows("`fooo` is not defined");
    terminal.type_in("\u{7f}\u{7f}\u{7f}\u{7f}y^3\r");
    terminal.type_in(":list\r");
    terminal.shows("x + y^3");
    terminal.type_in("\u{3}");
    assert_eq!(terminal.ends(), 0);
}

/// A prompt that has loaded a file with this text, and the file's path.
fn following(text: &str) -> (Terminal, PathBuf) {
    let mut terminal = Terminal::start(&["--preview", "gyroid"], None);
    terminal.shows("undecided");
    let path = terminal.place().join("surface.zset");
    std::fs::write(&path, text).expect("written");
    terminal.type_in(":load surface.zset\r");
    terminal.type_in(":list\r");
    terminal.shows(text);
    (terminal, path)
}

/// Waits until the document has a line. The prompt does not say that it has read a file again.
fn lists(terminal: &mut Terminal, line: &str) {
    until(&format!("{line} is in the document"), || {
        terminal.type_in(":list\r");
        terminal.shown().contains(line)
    });
}

#[test]
fn a_file_is_followed_while_the_prompt_waits() {
    let (mut terminal, path) = following("x = 1");
    std::fs::write(&path, "x = (1 = y").expect("written");
    terminal.shows("is never closed");
    terminal.shows("surface.zset:1:11");
    std::fs::write(&path, "x = 0.75").expect("written");
    lists(&mut terminal, "x = 0.75");
    terminal.type_in(":q\r");
    assert_eq!(terminal.ends(), 0);
}

#[test]
fn the_picture_of_a_reloaded_file_is_shown_unasked() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    let path = terminal.place().join("surface.zset");
    std::fs::write(&path, "x = 1").expect("written");
    terminal.type_in(":load surface.zset\r");
    until("its picture is there", || terminal.shown().matches("undecided").count() == 2);
    std::fs::write(&path, "x^2+y^2+z^2 = 1/3").expect("written");
    until("that of the next version is there", || {
        terminal.shown().matches("undecided").count() == 3
    });
    let whole = terminal.shown();
    let last = whole.rsplit("surface.zset").next().unwrap_or_default();
    // A ball in letters appears, and the prompt goes on below.
    assert!(last.matches(['@', '%', '#', '*']).count() > 100, "{last}");
    terminal.type_in(":list\r");
    terminal.shows("x^2+y^2+z^2 = 1/3");
    terminal.leaves();
}

#[test]
fn a_file_whose_loading_was_taken_back_is_followed_again_once_it_is_done_again() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    let path = terminal.place().join("surface.zset");
    let save = |text: &str| std::fs::write(&path, text).expect("written");
    save("x = 1.25");
    terminal.type_in(":load surface.zset\r");
    terminal.type_in(":undo\r");
    save("x = 2.25");
    // Nothing tells that a file is not followed, so time must pass: a watch takes 25 to 200 ms.
    std::thread::sleep(std::time::Duration::from_millis(500));
    terminal.type_in(":list\r");
    terminal.type_in(":help undo\r");
    terminal.shows("undo the last step");
    assert!(!terminal.shown().contains("x = 2.25"), "{}", terminal.shown());
    terminal.type_in(":redo\r");
    terminal.type_in(":list\r");
    terminal.shows("x = 1.25");
    save("x = 3.25");
    lists(&mut terminal, "x = 3.25");
    terminal.leaves();
}

#[test]
fn a_file_that_is_gone_for_a_while_is_followed_when_it_is_back() {
    let (mut terminal, path) = following("x = 1.25");
    std::fs::remove_file(&path).expect("removed");
    terminal.type_in(":list\r");
    std::fs::write(&path, "x = 2.25").expect("written");
    lists(&mut terminal, "x = 2.25");
    terminal.leaves();
}

#[cfg(unix)]
#[test]
fn pipes_are_read_once_and_not_waited_for() {
    use std::path::Path;
    use std::process::Command;
    let pipe = |path: &Path| {
        let made = Command::new("mkfifo").arg(path).status().expect("a program for pipes");
        assert!(made.success());
    };
    let place = tempfile::tempdir().expect("a directory");
    let path = place.path().join("pipe");
    pipe(&path);
    let writer = {
        let path = path.clone();
        std::thread::spawn(move || std::fs::write(path, "x = 0.25"))
    };
    let mut terminal = Terminal::start(&["--preview", path.to_str().expect("a name")], None);
    terminal.shows("undecided");
    writer.join().expect("no panic").expect("written");
    terminal.type_in(":save\r");
    terminal.shows("the document did not come from a file");
    terminal.leaves();
    // A watched file that has become a pipe is reported, not read.
    let (terminal, path) = following("x = 1.25");
    std::fs::remove_file(&path).expect("removed");
    pipe(&path);
    terminal.shows("is not a file any more");
    terminal.leaves();
}

#[test]
fn what_came_from_no_file_is_saved_to_none() {
    for start in ["x = 0.25", "sphere"] {
        let mut terminal = Terminal::start(&["--preview", start], None);
        // Files with the documents' names are created only after the start.
        terminal.shows("undecided");
        let place = terminal.place().to_owned();
        let others = ["formula", "sphere"].map(|name| place.join(name));
        for other in &others {
            std::fs::write(other, "notes").expect("written");
        }
        terminal.type_in("y = 0.25\r");
        terminal.type_in(":save\r");
        terminal.shows("the document did not come from a file");
        for other in &others {
            assert_eq!(std::fs::read_to_string(other).expect("there"), "notes");
        }
        terminal.leaves();
    }
}

#[cfg(unix)]
#[test]
fn a_private_file_stays_private() {
    use std::os::unix::fs::PermissionsExt;
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    let path = terminal.place().join("surface.zset");
    std::fs::write(&path, "x = 1.25").expect("written");
    let private = std::fs::Permissions::from_mode(0o600);
    std::fs::set_permissions(&path, private).expect("permitted");
    terminal.type_in(":save surface.zset\r");
    terminal.shows("enter the line once more");
    terminal.type_in(":save surface.zset\r");
    terminal.shows("saved 'surface.zset'");
    assert_eq!(std::fs::read_to_string(&path).expect("there"), "x+y+z\n");
    assert_eq!(std::fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o600);
    terminal.leaves();
}

#[test]
fn bytes_that_are_no_text_end_nothing() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    terminal.send(b"\xff\xfe");
    terminal.shows("not UTF-8 text");
    terminal.type_in("x = 0.125\r");
    terminal.type_in(":status\r");
    terminal.shows("surface     x = 0.125");
    terminal.leaves();
}

#[test]
fn lines_that_come_together_are_all_read() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    terminal.type_in("a = 0.125\rx = a\r:status\r");
    terminal.shows("surface     x = a");
    terminal.leaves();
}

#[test]
fn dumb_terminals_get_no_colors() {
    for (kind, are_colored) in [("xterm", true), ("dumb", false)] {
        let terminal = Terminal::start_in(kind, &["explain", "x = fooo"]);
        terminal.shows("is not defined");
        let shown = terminal.shown();
        assert_eq!(shown.contains('\u{1b}'), are_colored, "{kind}: {shown:?}");
    }
}

/// A Mandelbulb of two rounds, which takes a second or two.
const SLOW: &str = "r = sqrt(x^2+y^2+z^2); a = 8.1 acos(z/r); b = 8.1 atan2(y, x); \
    u = r^8 sin(a) cos(b) + x; v = r^8 sin(a) sin(b) + y; w = r^8 cos(a) + z; \
    s = sqrt(u^2+v^2+w^2); c = 8.1 acos(w/s); d = 8.1 atan2(v, u); \
    (s^8 sin(c) cos(d) + x)^2 + (s^8 sin(c) sin(d) + y)^2 + (s^8 cos(c) + z)^2 = 4";

/// Each picture is written over the one before, and the fine one over the last.
#[test]
fn a_slow_picture_is_coarse_until_it_is_finished() {
    for (kind, picture) in [("xterm", "▀"), ("xterm-kitty", "\u{1b}_Ga=T,f=100,q=2,c=90,r=26,")] {
        let terminal = Terminal::start_in(kind, &["--preview", SLOW, "--domain", "1.2"]);
        terminal.shows("compiled in");
        let shown = terminal.shown();
        let (before, last) = shown.rsplit_once("\u{1b}[J").expect("the last picture is removed");
        assert!(last.contains(picture) && !last.contains("so far"), "{kind}: {last:?}");
        // The picture takes 26 of 30 rows.
        let mut drawn = before.split("\u{1b}[26A");
        assert!(drawn.next().is_some_and(|first| first.contains(picture)), "{kind}: {before:?}");
        let later: Vec<&str> = drawn.collect();
        let (end, later) = later.split_last().expect("the last picture is removed");
        assert!(end.is_empty() && !later.is_empty(), "{kind}: {later:?}");
        assert!(later.iter().all(|one| one.contains(picture)), "{kind}: {later:?}");
        // An image is followed by one end of a line, and each row of characters by its own.
        let rows = if kind == "xterm" { 26 } else { 1 };
        assert!(later.iter().all(|one| one.matches('\n').count() == rows), "{kind}: {later:?}");
        assert!(before.contains(" % · "), "{kind}: {before:?}");
        assert!(before.contains(" of 90x52 so far") || kind != "xterm", "{before:?}");
        terminal.leaves();
    }
}

#[test]
fn terminals_that_take_pixels_get_them() {
    let terminal = Terminal::start_in("xterm-kitty", &["--preview", "x^2+y^2+z^2 = 1"]);
    terminal.shows("undecided");
    let shown = terminal.shown();
    // The picture takes 90 columns and 26 of 30 rows. The terminal does not report its size in
    // pixels, so a character counts as 8 by 16 pixels.
    assert!(shown.contains("\u{1b}_Ga=T,f=100,q=2,c=90,r=26,"), "no picture");
    assert!(shown.contains("720x416"), "another size");
    assert!(!has_letters(&shown), "letters too");
}

/// Run it by `cargo test --features sixel --test program -- --ignored sixels`.
#[test]
#[ignore = "needs a program with the feature `sixel`"]
fn terminals_that_answer_so_get_sixels_that_are_the_picture() {
    let mut terminal = Terminal::answering("\u{1b}[?62;4;22c", &["--preview", "x^2+y^2+z^2 = 1"]);
    terminal.shows("undecided");
    let mut shown = None;
    crate::terminal_support::until("there are sixels", || {
        shown = crate::terminal_support::sixel::picture(&terminal.bytes());
        shown.is_some()
    });
    let shown = shown.expect("waited for");
    terminal.type_in(":png same.png\r");
    terminal.shows("saved 'same.png'");
    let file = std::fs::read(terminal.place().join("same.png")).expect("saved");
    let exact = image::load_from_memory(&file).expect("a picture").to_rgb8();
    // The picture takes 90 columns and 26 rows, with characters of 6 by 12 pixels.
    assert_eq!((exact.dimensions(), shown.dimensions()), ((540, 312), (540, 312)));
    // With 256 colors, every dot is near its exact color, and most dots are very near. Blended
    // colors along edges cover too few dots for palette entries of their own. If the terminal's
    // picture were not antialiased, some dots along edges would be off by more than 100.
    let mut apart: Vec<u8> = exact.iter().zip(shown.iter()).map(|(a, b)| a.abs_diff(*b)).collect();
    apart.sort_unstable();
    let (most, worst) = (apart[apart.len() * 999 / 1000], apart[apart.len() - 1]);
    let mean = apart.iter().map(|apart| f64::from(*apart)).sum::<f64>() / apart.len() as f64;
    println!(
        "dots differ by up to {worst} of 255, 999 in 1000 by {most}, by {mean:.2} in the mean"
    );
    assert!(most <= 40 && worst <= 64 && mean <= 2.0, "{most}, {worst} and {mean}");
    // The terminal's answer is not taken for typed text.
    terminal.type_in(":list\r");
    terminal.shows("x^2+y^2+z^2 = 1");
    let all = terminal.shown();
    // Colors of sixels have numbers, too.
    let parts = all.split("\u{1b}P").enumerate();
    let outside = parts.map(|(k, part)| match part.split_once("\u{1b}\\") {
        Some((_, rest)) if k > 0 => rest,
        _ => part,
    });
    let typed: String = outside.collect();
    assert!(!typed.contains("62;4") && !typed.contains("unknown"), "a stray answer");
    assert!(!has_letters(&all), "letters too");
    terminal.leaves();
}

#[test]
fn terminals_that_answer_otherwise_or_not_get_characters() {
    for answer in ["\u{1b}[?6c", "\u{1b}[?64;14;40;22c", ""] {
        let mut terminal = Terminal::answering(answer, &["--preview", "x^2+y^2+z^2 = 1"]);
        terminal.shows("undecided");
        let all = terminal.shown();
        assert!(has_letters(&all) && !all.contains("\u{1b}P"), "{answer:?}");
        terminal.type_in(":list\r");
        terminal.shows("x^2+y^2+z^2 = 1");
        assert!(!terminal.shown().contains("?6"), "a stray answer");
        terminal.leaves();
    }
}

#[test]
fn pictures_fit_a_terminal_that_grows_or_shrinks() {
    let mut terminal = Terminal::start(&["--preview", "x^2+y^2+z^2 = 1"], None);
    terminal.shows("90x52");
    for (columns, rows) in [(60, 20), (100, 40)] {
        terminal.resize(columns, rows);
        terminal.type_in(":help quit\r");
        terminal.shows(&format!("{columns}x{} ", 2 * (rows - 4)));
    }
    terminal.leaves();
}

#[test]
fn precision_is_chosen_shown_and_kept_in_the_command() {
    let mut terminal =
        Terminal::start(&["--preview", "x^2+y^2+z^2 = 1", "--precision", "f64"], None);
    terminal.shows("affine f64");
    terminal.type_in(":method knoll\r");
    terminal.shows("knoll f64 10");
    terminal.type_in(":depth 32\r");
    terminal.shows("depth 32");
    terminal.type_in(":png fine.png\r");
    terminal.shows("--precision f64 --max-depth 32 -o fine.png");
    terminal.type_in(":precision f32\r");
    terminal.shows("precision f32 (32 bits");
    terminal.shows("knoll f32 20");
    terminal.type_in(":status\r");
    terminal.shows("knoll, precision f32");
    terminal.type_in(":explain\r");
    terminal.shows("simplified  ");
    assert!(!terminal.shown().contains("function u0:0"), "code that nobody asked for");
    terminal.type_in(":explain code\r");
    terminal.shows("function u0:0");
    terminal.leaves();
}

#[test]
fn the_prompt_tells_how_to_give_a_letter_a_value() {
    let mut terminal = Terminal::start(&["--preview", "x+y+z"], None);
    terminal.shows("undecided");
    terminal.type_in("x^2+y^2 = q\r");
    terminal.shows("type `q = 1` to give it a value");
    terminal.type_in("q = 1\r");
    terminal.type_in("x^2+y^2 = q\r");
    terminal.type_in(":list\r");
    terminal.shows("q = 1\r\nx^2+y^2 = q");
    let place = terminal.place().join("data/zeroset/tips");
    for (line, shown) in [(":tips on\r", "0\n"), (":tips off\r", "6\n")] {
        terminal.type_in(line);
        until(line, || std::fs::read_to_string(&place).is_ok_and(|text| text == shown));
    }
    terminal.leaves();
}

#[test]
fn a_terminal_that_goes_away_ends_the_program_and_keeps_history_and_document() {
    Terminal::start(&["--preview", "x+y+z"], None).hang_up();
}
