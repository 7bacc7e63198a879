//! Ctrl-C: what is written of a picture, of frames and of a mesh.

use super::cli_render::BULB;
use super::cli_support::Sandbox;
use crate::surroundings::zeroset;
use std::fs::File;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time limit far above every duration here, even on a slow and busy machine.
const LIMIT: Duration = Duration::from_mins(1);
/// The longest wait before Ctrl-C.
const LATEST: Duration = Duration::from_secs(16);

const STOPPED: Option<i32> = Some(130);
const NOTHING: &str = "note: stopped by Ctrl-C: nothing is written\n";

/// A running program, and where it writes its messages.
struct Started(Child, Sandbox);

impl Started {
    fn new(place: &Sandbox, arguments: &[&str]) -> Self {
        Self::with(&[], place, arguments)
    }

    fn with(by: &[&str], place: &Sandbox, arguments: &[&str]) -> Self {
        let outside = Sandbox::new();
        let messages = File::create(outside.path("err")).expect("created");
        let mut command = zeroset(by, &outside.path("data"));
        command.args(arguments).current_dir(place.path(".")).stderr(Stdio::from(messages));
        Self(command.stdout(Stdio::null()).spawn().expect("starts"), outside)
    }

    fn interrupt(&self) {
        let id = self.0.id().to_string();
        let sent = Command::new("kill").args(["-INT", &id]).stderr(Stdio::null()).status();
        sent.expect("kill runs");
    }

    fn is_running(&mut self) -> bool {
        self.0.try_wait().expect("waited for").is_none()
    }

    /// The exit code, and the messages.
    fn end(mut self) -> (Option<i32>, String) {
        let started = Instant::now();
        while self.is_running() {
            if started.elapsed() > LIMIT {
                self.0.kill().expect("ended");
                panic!("still running after {LIMIT:?}");
            }
            sleep(Duration::from_millis(2));
        }
        let messages = std::fs::read_to_string(self.1.path("err")).expect("UTF-8");
        (self.0.wait().expect("ended").code(), messages)
    }
}

/// Runs the program in new directories, each time interrupted twice as late, until `is_hit` says
/// that its messages are those of the stage that is meant. Returns the directory and the messages.
fn interrupted_when(arguments: &[&str], is_hit: impl Fn(&str) -> bool) -> (Sandbox, String) {
    let mut wait = Duration::from_millis(30);
    loop {
        let place = Sandbox::new();
        place.write("bulb.zset", BULB);
        let started = Started::new(&place, arguments);
        // The program does not tell in which stage it is, so a time is searched for that hits it.
        sleep(wait);
        started.interrupt();
        let (code, messages) = started.end();
        // Before the program listens, Ctrl-C kills it without a word.
        let expected = if messages.is_empty() { None } else { STOPPED };
        assert_eq!(code, expected, "{arguments:?} after {wait:?}: {messages}");
        if is_hit(&messages) {
            return (place, messages);
        }
        assert!(wait < LATEST, "{arguments:?} after {wait:?}: {messages}");
        wait *= 2;
    }
}

#[test]
fn the_first_ends_the_drawing_with_the_picture_so_far() {
    let arguments = ["render", "bulb.zset", "--domain", "1.2", "--size", "1500", "-o", "p.png"];
    let (place, messages) = interrupted_when(&arguments, |said| said.contains("so far"));
    assert!(messages.contains("stopped by Ctrl-C: this is the picture so far"), "{messages}");
    assert!(messages.contains("were not reached before Ctrl-C"), "{messages}");
    assert!(!messages.contains("--budget"), "{messages}");
    let picture = image::open(place.path("p.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (1500, 1500));
    assert_eq!(place.files(), ["bulb.zset", "p.png"]);
}

#[test]
fn before_the_drawing_nothing_is_written() {
    for formula in ["product(k=1..1000, x-k*y+z)", "sum(k=1..550, cos(k*x+k^2*y)+cos(z*k)) = 1"] {
        let arguments = ["render", formula, "-o", "p.png", "--status", "s.npy"];
        let (place, messages) = interrupted_when(&arguments, |said| said.contains("stopped"));
        assert_eq!(messages, NOTHING);
        assert_eq!(place.files(), ["bulb.zset"]);
    }
}

/// A pipe that nobody empties keeps the program from answering the first.
#[test]
fn the_second_kills() {
    let place = Sandbox::new();
    let pipe = place.path("p.png");
    let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs");
    assert!(made.success());
    let formula = "sin(99x)+sin(99y)+sin(99z)";
    let arguments = ["render", formula, "--domain", "2", "--size", "900", "-o", "p.png"];
    let mut started = Started::new(&place, &[&arguments[..], &["--status", "s.npy"]].concat());
    let mut begun = [0];
    let mut reader = File::open(&pipe).expect("opened");
    reader.read_exact(&mut begun).expect("a picture");
    started.interrupt();
    // Nothing tells that there is no answer, so time must pass: more than an answer takes.
    sleep(Duration::from_millis(1500));
    assert!(started.is_running());
    started.interrupt();
    let (code, messages) = started.end();
    assert_eq!((code, &*messages), (STOPPED, ""));
    assert_eq!(place.files(), ["p.png"]);
}

#[test]
fn frames_that_are_done_stay() {
    let place = Sandbox::new();
    let moved = ["--domain", "2", "--sweep", "c=1..2", "--frames", "100000", "--size", "64"];
    let arguments = ["render", "x^2+y^2+z^2 = c; c = 0", "-o", "f%d.png"];
    let started = Started::new(&place, &[&arguments[..], &moved].concat());
    let begun = Instant::now();
    while !place.path("f1.png").exists() {
        assert!(begun.elapsed() < LIMIT);
        sleep(Duration::from_millis(2));
    }
    started.interrupt();
    let (code, messages) = started.end();
    let count = place.files().len();
    assert!(count < 100_000);
    for frame in 0..count {
        image::open(place.path(&format!("f{frame}.png"))).expect("a whole picture");
    }
    let expected = format!("note: stopped by Ctrl-C: {count} of 100000 frames are there\n");
    assert_eq!((code, messages), (STOPPED, expected));

    let arguments = ["render", "x^2+y^2+z^2 = c; c = 0", "-o", "f.gif"];
    let in_one_file = [&arguments[..], &moved].concat();
    let (place, messages) = interrupted_when(&in_one_file, |said| said.contains("done stay"));
    assert!(messages.contains("Ctrl-C: nothing is written; with -o frame-%04d.png"), "{messages}");
    assert_eq!(place.files(), ["bulb.zset"]);
}

#[test]
fn no_mesh_is_written() {
    let arguments = ["mesh", "bulb.zset", "--domain", "1.2", "--tolerance", "0.001", "-o", "a.stl"];
    let (place, messages) = interrupted_when(&arguments, |said| said.contains("stopped"));
    assert_eq!(messages, NOTHING);
    assert_eq!(place.files(), ["bulb.zset"]);
}

/// Shells start programs of the background so.
#[test]
fn a_program_that_is_to_ignore_it_goes_on() {
    let place = Sandbox::new();
    // The file tells that the shell ignores the signal.
    let by = ["sh", "-c", "trap '' INT; : > ignored; exec \"$@\"", "sh"];
    let formula = "sin(99x)+sin(99y)+sin(99z)";
    let arguments = ["render", formula, "--domain", "2", "--size", "900", "-o", "p.png"];
    let mut started = Started::with(&by, &place, &arguments);
    let (begun, mut interrupts) = (Instant::now(), 0);
    while !place.path("ignored").exists() {
        assert!(begun.elapsed() < LIMIT);
        sleep(Duration::from_millis(2));
    }
    while started.is_running() && begun.elapsed() < LIMIT {
        started.interrupt();
        interrupts += 1;
        // The number of interrupts does not matter.
        sleep(Duration::from_millis(20));
    }
    let (code, messages) = started.end();
    assert!(interrupts > 2 && !messages.contains("Ctrl-C"), "{interrupts}: {messages}");
    assert_eq!((code, place.files()), (Some(0), ["ignored", "p.png"].map(String::from).to_vec()));
}
