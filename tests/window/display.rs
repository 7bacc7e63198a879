//! A virtual display for a real window.

use crate::terminal_support::until;
use image::RgbImage;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// A virtual display.
pub struct Display {
    server: Child,
    pub name: String,
}

impl Display {
    pub fn start() -> Self {
        // By default the server resets when its last client disconnects, and then rejects a program
        // that connects. While the test waits for the window, that client may be xdotool.
        let mut server = Command::new("Xvfb")
            .args([
                "-noreset",
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1000x800x24",
                "-nolisten",
                "tcp",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        let output = server.stdout.take().expect("piped");
        BufReader::new(output).read_line(&mut number).expect("a display number");
        Self { server, name: format!(":{}", number.trim()) }
    }

    /// Runs xdotool, and returns its output.
    pub fn tool(&self, arguments: &[&str]) -> String {
        let run = Command::new("xdotool").env("DISPLAY", &self.name).args(arguments).output();
        String::from_utf8_lossy(&run.expect("xdotool runs").stdout).trim().to_owned()
    }

    /// Waits for the window and returns its id.
    pub fn window(&self) -> String {
        let mut window = String::new();
        until("the window is there", || {
            window = self.tool(&["search", "--name", " - zeroset$"]);
            !window.is_empty()
        });
        // Without a window manager, keys go to the window under the pointer.
        window.lines().next().unwrap_or_default().to_owned()
    }

    /// A screenshot of a window.
    pub fn picture(&self, window: &str) -> RgbImage {
        let run = Command::new("import")
            .env("DISPLAY", &self.name)
            .args(["-window", window, "png:-"].map(OsStr::new))
            .output()
            .expect("import runs");
        image::load_from_memory(&run.stdout).expect("a picture").to_rgb8()
    }

    /// Saves a screenshot for people to look at, in the directory given by `ZEROSET_SCREENSHOTS`.
    pub fn keep(&self, window: &str, name: &str) {
        if let Some(place) = std::env::var_os("ZEROSET_SCREENSHOTS") {
            let path = PathBuf::from(place).join(format!("{name}.png"));
            self.picture(window).save(path).expect("saved");
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
