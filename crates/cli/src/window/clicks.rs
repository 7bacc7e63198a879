//! Detects clicks that begin and end between two polls of the mouse, such as a short tap on a
//! touchpad. The window's library misses such clicks on X11, but the X server reports every press.
//! On other systems no missed clicks are known.

#[cfg(all(unix, not(target_os = "macos")))]
pub use x11::Clicks;

#[cfg(not(all(unix, not(target_os = "macos"))))]
pub use elsewhere::Clicks;

#[cfg(not(all(unix, not(target_os = "macos"))))]
mod elsewhere {
    /// A detector that reports no clicks.
    pub struct Clicks;

    impl Clicks {
        pub fn of(_: &minifb::Window) -> Self {
            Self
        }

        #[allow(clippy::unused_self)] // same signature as on X11
        pub fn was_missed(&mut self, _: bool) -> bool {
            false
        }
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
mod x11 {
    use x11rb::connection::Connection;
    use x11rb::protocol::Event;
    use x11rb::protocol::xinput::{ConnectionExt as _, Device, EventMask, XIEventMask};
    use x11rb::protocol::xproto::{ConnectionExt as _, KeyButMask, Window};
    use x11rb::rust_connection::RustConnection;

    /// Number of the left button.
    const LEFT: u32 = 1;

    /// Detects missed clicks by the presses that the X server reports, if there is a connection.
    pub struct Clicks {
        server: Option<Server>,
        /// Set if the server has reported a press of a button that no poll has found held.
        pressed: bool,
    }

    /// State of the pointer.
    struct Pointer {
        /// Set if the left button is down.
        is_down: bool,
        /// Set if this window is the topmost one under the pointer.
        is_here: bool,
    }

    struct Server {
        connection: RustConnection,
        root: Window,
        window: Window,
    }

    impl Clicks {
        pub fn of(window: &minifb::Window) -> Self {
            let server = Server::connect(window.get_window_handle() as usize as Window);
            Self { server, pressed: false }
        }

        /// Whether the left button was pressed and released over this window between two polls, and
        /// thus missed by the library. Call this once after every poll of the mouse.
        pub fn was_missed(&mut self, held: bool) -> bool {
            let Some(server) = &self.server else { return false };
            // The library has polled since the press. It would report a button that is still held.
            let missed = self.pressed && !held;
            self.pressed = server.presses() && !held;
            if !missed {
                return false;
            }
            match server.pointer() {
                // A window manager may see the press first, and pass it on later. While the button
                // is down, the library may still report it.
                Some(Pointer { is_down: true, is_here: true }) => {
                    self.pressed = true;
                    false
                }
                Some(Pointer { is_here, .. }) => is_here,
                None => false,
            }
        }
    }

    impl Server {
        fn connect(window: Window) -> Option<Self> {
            let (connection, screen) = x11rb::connect(None).ok()?;
            let root = connection.setup().roots.get(screen)?.root;
            connection.xinput_xi_query_version(2, 2).ok()?.reply().ok()?;
            let mask = vec![XIEventMask::RAW_BUTTON_PRESS];
            let mask = EventMask { deviceid: Device::ALL_MASTER.into(), mask };
            connection.xinput_xi_select_events(root, &[mask]).ok()?.check().ok()?;
            Some(Self { connection, root, window })
        }

        /// Whether the left button was pressed since the last call, wherever the pointer was.
        fn presses(&self) -> bool {
            let mut pressed = false;
            while let Ok(Some(event)) = self.connection.poll_for_event() {
                pressed |=
                    matches!(event, Event::XinputRawButtonPress(press) if press.detail == LEFT);
            }
            pressed
        }

        fn pointer(&self) -> Option<Pointer> {
            let pointer = self.connection.query_pointer(self.root).ok()?.reply().ok()?;
            let is_down = pointer.mask.contains(KeyButMask::BUTTON1);
            Some(Pointer { is_down, is_here: self.is_below(pointer.child)? })
        }

        /// Returns whether this window is the given one, or is inside of it.
        fn is_below(&self, top: Window) -> Option<bool> {
            let mut window = self.window;
            // A window manager may place the window inside windows of its own.
            while window != top {
                let parent = self.connection.query_tree(window).ok()?.reply().ok()?.parent;
                if parent == self.root || parent == x11rb::NONE {
                    return Some(false);
                }
                window = parent;
            }
            Some(true)
        }
    }
}
