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
        Self::sized("1000x800")
    }

    /// A display of this size, such as 800x500.
    pub fn sized(size: &str) -> Self {
        let screen = format!("{size}x24");
        // By default the server resets when its last client disconnects, and then rejects a program
        // that connects. While the test waits for the window, that client may be xdotool.
        let mut server = Command::new("Xvfb")
            .args(["-noreset", "-displayfd", "1", "-screen", "0", &screen, "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        let output = server.stdout.take().expect("piped");
        BufReader::new(output).read_line(&mut number).expect("a display number");
        Self { server, name: format!(":{}", number.trim()) }
    }

    /// Sets the display's resource for dots per inch.
    pub fn set_dpi(&self, dpi: &str) {
        let resources = ["-root", "-f", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER"];
        let set = Command::new("xprop")
            .env("DISPLAY", &self.name)
            .args(resources)
            .arg(format!("Xft.dpi:\t{dpi}\n"))
            .status();
        assert!(set.expect("xprop runs").success());
    }

    /// Starts a window manager.
    pub fn manage(&self) -> Manager {
        let mut manager = Command::new("openbox");
        let manager = manager.env("DISPLAY", &self.name).stderr(Stdio::null()).spawn();
        let manager = Manager(manager.expect("openbox runs"));
        // Without a manager xdotool counts one desktop. This manager has four.
        until("there is a manager", || self.tool(&["get_num_desktops"]) == "4");
        manager
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

/// A running window manager.
pub struct Manager(Child);

impl Drop for Manager {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
