//! Clicks that begin and end between two looks at the mouse, which the window's library does not
//! see: a touchpad's tap can be as short as that. The X server tells of every press; on other
//! systems none is known to be missed.

#[cfg(all(unix, not(target_os = "macos")))]
pub use x11::Clicks;

#[cfg(not(all(unix, not(target_os = "macos"))))]
pub use elsewhere::Clicks;

#[cfg(not(all(unix, not(target_os = "macos"))))]
mod elsewhere {
    /// Knows of no click.
    pub struct Clicks;

    impl Clicks {
        pub fn of(_: &minifb::Window) -> Self {
            Self
        }

        #[allow(clippy::unused_self)] // as elsewhere
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
    use x11rb::protocol::xproto::{ConnectionExt as _, Window};
    use x11rb::rust_connection::RustConnection;

    /// The left button.
    const LEFT: u32 = 1;

    /// Presses that the server tells of; none where it does not.
    pub struct Clicks {
        server: Option<Server>,
        /// Whether there was a press that has not been seen as a held button yet.
        pressed: bool,
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

        /// To be asked once after every look at the mouse: whether the left button was pressed and
        /// let go over this window without having been seen held.
        pub fn was_missed(&mut self, held: bool) -> bool {
            let Some(server) = &self.server else { return false };
            // The library has looked since: a button that is still held would be seen.
            let missed = self.pressed && !held;
            self.pressed = server.presses() && !held;
            missed && server.is_under_pointer().unwrap_or(false)
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

        /// Whether the left button was pressed since this was last asked, over whatever window.
        fn presses(&self) -> bool {
            let mut pressed = false;
            while let Ok(Some(event)) = self.connection.poll_for_event() {
                pressed |=
                    matches!(event, Event::XinputRawButtonPress(press) if press.detail == LEFT);
            }
            pressed
        }

        /// Whether no other window is between the pointer and this one.
        fn is_under_pointer(&self) -> Option<bool> {
            let top = self.connection.query_pointer(self.root).ok()?.reply().ok()?.child;
            let mut window = self.window;
            // Around the window there may be those of a window manager.
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
