//! Random edits at a real prompt, while the file that it watches is saved repeatedly. The prompt
//! must keep running within bounded memory, and show the last entered line.
//!
//! Memory grows by 2.5 MB in the first hundreds of edits, for code and stacks at their first use
//! and a heap per thread. It grows by 4 MB with the last picture. This picture is the largest one,
//! and the allocator keeps its memory. Thousands of edits in between add almost nothing.
//!
//! A long run, of 10,000 edits and 1,000 saves: `ZEROSET_CASES=10000 cargo test --release --test
//! program prompt_soak -- --nocapture`.

use crate::edit_support::{beginnings, edit};
use crate::terminal_support::{Terminal, until};
use std::path::Path;
use std::process::Command;
use zeroset_testkit::Effort;

const EDITS: u64 = 400;
const SEED: u64 = 20_070_003;
const EDITS_PER_SAVE: u64 = 10;
/// Allowed growth of memory, in kilobytes.
const ALLOWED: u64 = 10 << 10;

/// Contents that the file is saved with: valid, invalid, empty.
const TEXTS: &[&str] = &[
    "domain 2\nx^2+y^2+z^2 = 1",
    "r = 0.5 in [0, 1]\ndomain 2\nx^4+y^4+z^4 = r",
    "x^2+(",
    "",
    "domain 3\nz = x*y {x^2+y^2 < 4}",
    "x = unknown",
];

/// Saves a file in one of the ways of editors: over the file, by renaming, in two pieces.
fn save(path: &Path, text: &str, style: usize) {
    let write = |path: &Path, text: &str| std::fs::write(path, text).expect("written");
    match style {
        0 => write(path, text),
        1 => {
            let other = path.with_extension("swp");
            write(&other, text);
            std::fs::rename(other, path).expect("renamed");
        }
        _ => {
            write(path, &text[..text.len() / 2]);
            write(path, text);
        }
    }
}

/// Whether Enter ends the line. After an open bracket, the input continues on another line.
fn is_closed(line: &str) -> bool {
    let count = |letters: [char; 3]| line.matches(letters).count();
    count(['(', '[', '{']) <= count([')', ']', '}'])
}

#[test]
fn the_prompt_survives_thousands_of_edits_and_saves() {
    let Effort { seed, cases: edits } = Effort::from_environment(SEED, EDITS);
    let mut random = fastrand::Rng::with_seed(seed);
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("surface.zset");
    save(&path, TEXTS[0], 0);
    let name = path.to_str().expect("UTF-8");
    let mut terminal = Terminal::start(&["--preview", name], None);
    terminal.shows("undecided");
    // This picture is as large as `end.png`, so that later growth does not include its memory.
    terminal.type_in(":png first.png\r");
    terminal.shows("saved 'first.png'");
    let first = terminal.resident();
    let mut saves = 0;
    for number in 0..edits {
        if number % EDITS_PER_SAVE == 0 {
            let text = random.choice(TEXTS).expect("some");
            save(&path, &format!("{text}\n# {number}"), random.usize(0..3));
            saves += 1;
        }
        if number % (edits / 8).max(1) == 0 {
            println!("after {number} edits: {:?} kB", terminal.resident());
        }
        let edit = edit(&mut random);
        if edit.entered && is_closed(&edit.line) {
            terminal.type_in(&format!("{}\r", edit.line));
        } else {
            let letters = beginnings(&edit.line, edit.typed).count() - 1;
            terminal.type_in(&edit.line[..edit.typed]);
            terminal.type_in(&"\u{7f}".repeat(letters));
        }
    }
    // The last line is entered only after the last save has taken effect.
    save(&path, "# the end\nr = 0.5\ndomain 2\nx^2+y^2+z^2 = r", 1);
    until("the last save is followed", || {
        terminal.type_in(":list\r");
        terminal.shown().contains("# the end")
    });
    terminal.type_in("z = x*y + r\r");
    println!("before the last picture: {:?} kB", terminal.resident());
    terminal.type_in(":png end.png\r");
    terminal.shows("saved 'end.png'");
    // The prompt's picture is smaller than `end.png`. Wait until the small picture is shown again.
    let file = terminal.shown().len();
    until("the small picture is there again", || {
        terminal.type_in(":status\r");
        terminal.shown()[file..].contains("pixels      90x52")
    });
    // The memory of the large picture is released as small ones follow.
    for line in ["z = x + r", "z = y + r", "z = x - r", "z = y - r"] {
        terminal.type_in(&format!("{line}\r"));
        let before = terminal.shown().len();
        until("it is drawn", || {
            terminal.type_in(":status\r");
            terminal.shown()[before..].contains(&format!("surface     {line}"))
        });
    }
    let last = terminal.resident();
    println!("{edits} edits, {saves} saves; resident: {first:?} kB, then {last:?} kB");
    let shown = terminal.shown().replace("\r\n", "\n");
    let found = shown.rfind("zeroset render").expect("a command");
    let (command, _) = shown[found..].split_once("-o end.png").expect("its end");
    assert!(command.contains("z = x*y + r") && command.contains("r = 0.5"), "{command}");
    let program = env!("CARGO_BIN_EXE_zeroset");
    let command = format!("{}-o again.png", command.replacen("zeroset", program, 1));
    let place = terminal.place().to_owned();
    let run = Command::new("sh").args(["-c", &command]).current_dir(&place).output();
    let run = run.expect("sh runs");
    assert!(run.status.success(), "{command}: {}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| image::open(place.join(name)).expect(name);
    assert!(read("end.png") == read("again.png"), "the last picture is stale");
    terminal.leaves();
    if let (Some(first), Some(last)) = (first, last) {
        assert!(last <= first + ALLOWED, "memory grew from {first} to {last} kB");
    }
}
