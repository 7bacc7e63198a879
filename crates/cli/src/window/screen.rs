//! The screen that the window is on: its scale, and the switch to full screen. On systems other
//! than X11 the system itself scales windows, and has a button for full screen.

#[cfg(all(unix, not(target_os = "macos")))]
pub use x11::{scale, toggle_full_screen};

#[cfg(not(all(unix, not(target_os = "macos"))))]
pub use elsewhere::{scale, toggle_full_screen};

#[cfg(not(all(unix, not(target_os = "macos"))))]
mod elsewhere {
    pub fn scale() -> Option<f64> {
        None
    }

    pub fn toggle_full_screen(_: &minifb::Window) -> bool {
        false
    }
}

#[cfg(all(unix, not(target_os = "macos")))]
mod x11 {
    use x11rb::connection::Connection;
    use x11rb::protocol::xproto::{AtomEnum, ClientMessageEvent, ConnectionExt as _, EventMask};
    use x11rb::resource_manager::new_from_default;

    /// Least and greatest scale that is believed.
    const RANGE: (f64, f64) = (0.5, 6.0);
    /// Resolution at which letters have their usual size, in dots per inch.
    const USUAL_DPI: f64 = 96.0;
    /// The request to switch a state on or off, whichever it is not.
    const TOGGLE: u32 = 2;
    /// The request comes from a program, not from a pager.
    const FROM_PROGRAM: u32 = 1;

    /// The display's scale, as other programs follow it: from the variable `GDK_SCALE`, and from
    /// the resource `Xft.dpi`. `None` if the display has none.
    pub fn scale() -> Option<f64> {
        let asked = std::env::var("GDK_SCALE").ok().and_then(|scale| scale.parse().ok());
        let resource = || {
            let (connection, _) = x11rb::connect(None).ok()?;
            let resources = new_from_default(&connection).ok()?;
            let dpi = resources.get_value::<f64>("Xft.dpi", "Xft.Dpi").ok()??;
            Some(dpi / USUAL_DPI)
        };
        asked.or_else(resource).filter(|scale| (RANGE.0..=RANGE.1).contains(scale))
    }

    /// Asks the window manager for a full screen, or for the window's former size. Returns false if
    /// there is no window manager.
    pub fn toggle_full_screen(window: &minifb::Window) -> bool {
        ask_manager(window.get_window_handle() as usize as u32).unwrap_or(false)
    }

    fn ask_manager(window: u32) -> Option<bool> {
        let (connection, screen) = x11rb::connect(None).ok()?;
        let root = connection.setup().roots.get(screen)?.root;
        let atom = |name: &str| {
            let reply = connection.intern_atom(false, name.as_bytes()).ok()?.reply().ok()?;
            Some(reply.atom)
        };
        let (check, any) = (atom("_NET_SUPPORTING_WM_CHECK")?, AtomEnum::ANY);
        let manager = connection.get_property(false, root, check, any, 0, 1).ok()?.reply().ok()?;
        if manager.value_len == 0 {
            return Some(false);
        }
        let (state, full) = (atom("_NET_WM_STATE")?, atom("_NET_WM_STATE_FULLSCREEN")?);
        let event = ClientMessageEvent::new(32, window, state, [TOGGLE, full, 0, FROM_PROGRAM, 0]);
        let mask = EventMask::SUBSTRUCTURE_REDIRECT | EventMask::SUBSTRUCTURE_NOTIFY;
        connection.send_event(false, root, mask, event).ok()?.check().ok()?;
        Some(true)
    }
}
