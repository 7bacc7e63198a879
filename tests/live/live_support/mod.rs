//! Helpers for tests of the live picture without a window.

use std::sync::Arc;
use std::time::Duration;
use zeroset_live::{Live, Rendering, Request};
use zeroset_render::picture::Settings;

/// Time limit far above every duration here, even on a slow and busy machine.
pub const LIMIT: Duration = Duration::from_mins(1);

/// A live picture of `text` with `side` by `side` pixels.
pub fn start(text: &str, side: usize) -> Live {
    let settings = Settings { width: side, height: side, ..Settings::default() };
    Live::new(Request { text: text.into(), settings, ..Request::default() })
}

/// Waits for the final picture, and returns it.
pub fn settled(live: &Live) -> Arc<Rendering> {
    assert!(live.wait(LIMIT), "the picture does not settle");
    let view = live.snapshot();
    assert!(view.fault.is_none(), "{:?}", view.fault.map(|fault| fault.message()));
    view.rendering.expect("a picture")
}
