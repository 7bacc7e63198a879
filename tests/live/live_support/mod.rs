//! A live picture without a window.

use std::sync::Arc;
use std::time::Duration;
use zeroset::live::{Live, Rendering, Request};
use zeroset::picture::Settings;

/// Longer than anything here takes on a slow machine that does other things as well.
pub const LIMIT: Duration = Duration::from_mins(1);

/// Of `text`, in a picture of `side` by `side` pixels.
pub fn start(text: &str, side: usize) -> Live {
    let settings = Settings { width: side, height: side, ..Settings::default() };
    Live::new(Request { text: text.into(), settings, ..Request::default() })
}

/// The finished picture.
pub fn settled(live: &Live) -> Arc<Rendering> {
    assert!(live.wait(LIMIT), "the picture does not settle");
    let view = live.snapshot();
    assert!(view.fault.is_none(), "{:?}", view.fault.map(|fault| fault.message()));
    view.rendering.expect("a picture")
}
