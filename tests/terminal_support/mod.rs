//! Runs the program in a pseudo-terminal, for several test binaries.

pub mod sixel;

use crate::surroundings::zeroset;
use rustix::termios::Winsize;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Time limit far above every duration here, even on a slow and busy machine.
pub const LIMIT: Duration = Duration::from_mins(1);

/// Polls until `holds` returns true, at first often.
pub fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let end = Instant::now() + LIMIT;
    let mut pause = Duration::from_millis(1);
    while !holds() {
        assert!(Instant::now() < end, "waited in vain until {what}");
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(30));
    }
}

/// The value of a field in a file of `/proc`.
fn field<'a>(status: &'a str, name: &str) -> Option<&'a str> {
    status.lines().find_map(|line| line.strip_prefix(name)).map(str::trim)
}

/// Counts of the times that the program's threads have waited. A thread that works is running, or
/// waits when its work is done.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Pulse {
    /// Waits of the main thread, which polls all the time if it has a window.
    pub main: u64,
    /// Waits of the thread that looks for faults to report, which polls, too.
    pub reporter: u64,
    /// Waits of all other threads.
    pub others: u64,
    /// Whether another thread than the main one runs, or would if there were a processor for it.
    pub is_busy: bool,
}

/// The output of a terminal.
#[derive(Default)]
struct Log {
    shown: Vec<u8>,
    /// Number of lines that the program has begun to read.
    begun: usize,
    ended: usize,
}

impl Log {
    /// The program enables bracketed paste when it begins to read a line.
    const BEGIN: &[u8] = b"\x1b[?2004h";
    const END: &[u8] = b"\x1b[?2004l";

    fn add(&mut self, part: &[u8]) {
        // The sequence that marks a line may be split over two parts of the output.
        let start = self.shown.len().saturating_sub(Self::BEGIN.len() - 1);
        self.shown.extend_from_slice(part);
        let count = |what: &[u8]| {
            self.shown[start..].windows(what.len()).filter(|window| *window == what).count()
        };
        let (begun, ended) = (count(Self::BEGIN), count(Self::END));
        self.begun += begun;
        self.ended += ended;
    }
}

/// A new directory in which the program's tips are off, since a tip would appear in pictures that
/// are compared.
fn place() -> Arc<TempDir> {
    let directory = tempfile::tempdir().expect("a directory");
    let data = directory.path().join("data/zeroset");
    std::fs::create_dir_all(&data).expect("made");
    std::fs::write(data.join("tips"), "off").expect("written");
    Arc::new(directory)
}

/// The program under a pseudo-terminal, in a directory of its own.
pub struct Terminal {
    child: Child,
    master: File,
    log: Arc<Mutex<Log>>,
    directory: Arc<TempDir>,
    /// Flag that ends the thread which reads the terminal. This thread uses the terminal last.
    closed: Arc<AtomicBool>,
}

impl Terminal {
    /// Starts `zeroset` with these arguments, and on this display if one is given.
    pub fn start(arguments: &[&str], display: Option<&str>) -> Self {
        Self::of(&[], arguments, display, None, place())
    }

    /// Like [`Terminal::start`], in the directory of an earlier start.
    pub fn start_again(place: Arc<TempDir>, arguments: &[&str], display: Option<&str>) -> Self {
        Self::of(&[], arguments, display, None, place)
    }

    /// The directory, for another start in it.
    pub fn shared_place(&self) -> Arc<TempDir> {
        Arc::clone(&self.directory)
    }

    /// Like [`Terminal::start`], but as the controlling terminal: closing it sends a signal.
    pub fn controlling(arguments: &[&str], display: Option<&str>) -> Self {
        Self::of(&["setsid", "--ctty"], arguments, display, None, place())
    }

    /// Like [`Terminal::start`] without a display, with colors and this value of `TERM`.
    pub fn start_in(kind: &str, arguments: &[&str]) -> Self {
        let by = ["env", "-u", "NO_COLOR", &format!("TERM={kind}")];
        Self::of(&by, arguments, None, None, place())
    }

    /// Like [`Terminal::start`] without a display, in a terminal that gives this answer when it is
    /// asked for its device attributes.
    pub fn answering(answer: &'static str, arguments: &[&str]) -> Self {
        Self::of(&[], arguments, None, Some(answer), place())
    }

    fn of(
        by: &[&str],
        arguments: &[&str],
        display: Option<&str>,
        mut answer: Option<&'static str>,
        directory: Arc<TempDir>,
    ) -> Self {
        use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
        // The flag `CLOEXEC` keeps the child from inheriting this end and keeping it open.
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let master = openpt(flags).expect("a terminal");
        grantpt(&master).expect("granted");
        unlockpt(&master).expect("unlocked");
        let name = ptsname(&master, Vec::new()).expect("a name").into_string().expect("UTF-8");
        let size = Winsize { ws_row: 30, ws_col: 90, ws_xpixel: 0, ws_ypixel: 0 };
        let slave = File::options().read(true).write(true).open(name).expect("opened");
        rustix::termios::tcsetwinsize(&slave, size).expect("sized");
        let stdio = || Stdio::from(slave.try_clone().expect("cloned"));
        let mut command = zeroset(by, &directory.path().join("data"));
        command
            .args(arguments)
            .current_dir(directory.path())
            .env("TERM", "xterm")
            .env("NO_COLOR", "1")
            .stdin(stdio())
            .stdout(stdio())
            .stderr(stdio());
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let child = command.spawn().expect("the program starts");
        let log = Arc::new(Mutex::new(Log::default()));
        let master = File::from(master);
        let (mut output, reader) = (master.try_clone().expect("cloned"), Arc::clone(&log));
        let mut input = master.try_clone().expect("cloned");
        let closed = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&closed);
        std::thread::spawn(move || {
            use rustix::event::{PollFd, PollFlags, Timespec, poll};
            let mut part = [0; 4096];
            let pause = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };
            while !stop.load(Ordering::Relaxed) {
                match poll(&mut [PollFd::new(&output, PollFlags::IN)], Some(&pause)) {
                    Ok(0) | Err(_) => continue,
                    Ok(_) => {}
                }
                // Reading the terminal fails after the program's end.
                let Ok(length @ 1..) = output.read(&mut part) else { break };
                let mut log = reader.lock().expect("whole");
                log.add(&part[..length]);
                if answer.is_some() && log.shown.windows(3).any(|letters| letters == b"\x1b[c") {
                    let answer = answer.take().unwrap_or_default();
                    input.write_all(answer.as_bytes()).expect("answered");
                }
            }
        });
        Self { child, master, log, directory, closed }
    }

    pub fn place(&self) -> &Path {
        self.directory.path()
    }

    /// All output of the terminal as text.
    pub fn shown(&self) -> String {
        String::from_utf8_lossy(&self.log.lock().expect("whole").shown).into_owned()
    }

    /// Gives the terminal another size.
    pub fn resize(&self, columns: u16, rows: u16) {
        let size = Winsize { ws_row: rows, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        rustix::termios::tcsetwinsize(&self.master, size).expect("sized");
    }

    /// All output of the terminal, as the raw bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.log.lock().expect("whole").shown.clone()
    }

    /// Sends raw bytes.
    pub fn send(&mut self, bytes: &[u8]) {
        self.master.write_all(bytes).expect("sent");
    }

    /// Types text once the program reads a line, since the program drops earlier input. After the
    /// end of each line, waits until the program has read the line.
    pub fn type_in(&mut self, text: &str) {
        let lines = || {
            let log = self.log.lock().expect("whole");
            (log.begun, log.ended)
        };
        until("a line is read", || lines().0 > lines().1);
        let ended = lines().1;
        self.master.write_all(text.as_bytes()).expect("typed");
        if text.ends_with('\r') {
            let lines = || self.log.lock().expect("whole").ended;
            until("the line is read", || lines() > ended);
        }
    }

    /// Resident memory of the program in kilobytes. `None` on systems other than Linux.
    pub fn resident(&self) -> Option<u64> {
        self.status("VmRSS:")
    }

    /// Number of threads of the program. `None` on systems other than Linux.
    pub fn threads(&self) -> Option<u64> {
        self.status("Threads:")
    }

    fn status(&self, what: &str) -> Option<u64> {
        cfg!(target_os = "linux").then(|| {
            let path = format!("/proc/{}/status", self.child.id());
            let status = std::fs::read_to_string(path).expect("readable");
            let value = field(&status, what).expect("a line");
            value.trim_end_matches("kB").trim().parse().expect("a number")
        })
    }

    /// Counts how often the program's threads have waited so far. `None` on systems other than
    /// Linux.
    pub fn pulse(&self) -> Option<Pulse> {
        let main = self.child.id().to_string();
        let threads = std::fs::read_dir(format!("/proc/{main}/task")).ok()?;
        let mut pulse = Pulse::default();
        for thread in threads.filter_map(Result::ok) {
            // A thread may end before its file is read.
            let Ok(status) = std::fs::read_to_string(thread.path().join("status")) else {
                continue;
            };
            let number = |what: &str| field(&status, what)?.parse::<u64>().ok();
            let waits = number("voluntary_ctxt_switches:").unwrap_or_default();
            if thread.file_name().to_str() == Some(&main) {
                pulse.main = waits;
            } else if field(&status, "Name:") == Some("faults") {
                pulse.reporter = waits;
            } else {
                pulse.others += waits;
                pulse.is_busy |= field(&status, "State:").is_some_and(|it| it.starts_with('R'));
            }
        }
        Some(pulse)
    }

    /// Waits until the terminal shows a text.
    pub fn shows(&self, text: &str) {
        until(&format!("the terminal shows {text:?}; it shows:\n{}", self.shown()), || {
            self.shown().contains(text)
        });
    }

    /// Ends the prompt's input, and waits for the program's end.
    pub fn leaves(mut self) {
        self.type_in("\u{4}");
        assert_eq!(self.ends(), 0);
    }

    /// Waits for the program's end, and returns the exit code.
    pub fn ends(mut self) -> i32 {
        self.end().code().expect("a code")
    }

    fn end(&mut self) -> ExitStatus {
        let mut status = None;
        until("the program ends", || {
            status = self.child.try_wait().expect("waited for");
            status.is_some()
        });
        status.expect("one")
    }

    /// Closes the terminal as if its window were closed. Asserts that the program ends, and that
    /// the history and the document are saved.
    pub fn hang_up(mut self) {
        self.type_in("z = x^3\r");
        self.type_in("x^2 +");
        self.closed.store(true, Ordering::Relaxed);
        self.master = File::open("/dev/null").expect("there is one");
        self.end();
        let data = self.place().join("data/zeroset");
        let read = |name: &str| std::fs::read_to_string(data.join(name)).expect(name);
        assert!(read("history").contains("z = x^3") && read("last.zset").contains("z = x^3"));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
