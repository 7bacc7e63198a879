//! A virtual display for a real window.

use crate::terminal_support::until;
use image::RgbImage;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use x11rb::connection::Connection as _;
use x11rb::errors::ReplyError;
use x11rb::protocol::xproto::{ConnectionExt as _, ImageFormat, Window};
use x11rb::rust_connection::RustConnection;

/// A virtual display.
pub struct Display {
    server: Child,
    pub name: String,
    /// A connection for screenshots.
    connection: RustConnection,
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
        let name = format!(":{}", number.trim());
        let (connection, _) = x11rb::connect(Some(&name)).expect("connected");
        Self { server, name, connection }
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
        // It answers once it has begun to manage windows. One that opens before does not get the
        // keyboard.
        for desktop in ["1", "0"] {
            until("the manager answers", || {
                self.tool(&["set_desktop", desktop]);
                self.tool(&["get_desktop"]) == desktop
            });
        }
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

    /// A screenshot of the part of a window that is on the screen.
    pub fn picture(&self, window: &str) -> RgbImage {
        let id = window.parse().expect("a number");
        // While a window manager moves or resizes the window, its place is out of date.
        let mut picture = None;
        until("there is a screenshot", || {
            picture = self.screenshot(id).ok();
            picture.is_some()
        });
        picture.expect("waited for")
    }

    fn screenshot(&self, window: Window) -> Result<RgbImage, ReplyError> {
        let server = &self.connection;
        let root = server.setup().roots[0].root;
        let geometry = server.get_geometry(window)?.reply()?;
        let place = server.translate_coordinates(window, root, 0, 0)?.reply()?;
        let screen = server.get_geometry(root)?.reply()?;
        let part = |start: i16, length: u16, limit: u16| {
            let end = (i32::from(start) + i32::from(length)).clamp(0, limit.into());
            let start = i32::from(start).clamp(0, end);
            (start as i16, (end - start) as u16)
        };
        let (x, width) = part(place.dst_x, geometry.width, screen.width);
        let (y, height) = part(place.dst_y, geometry.height, screen.height);
        let image = server.get_image(ImageFormat::Z_PIXMAP, root, x, y, width, height, !0)?;
        // A pixel has four bytes: blue, green, red, and one that is not used.
        let data = image.reply()?.data;
        let pixels = data.chunks_exact(4).flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]);
        let picture = RgbImage::from_raw(width.into(), height.into(), pixels.collect());
        Ok(picture.expect("24 bits per pixel"))
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
