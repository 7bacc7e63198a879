//! A live picture without a window.

use std::sync::Arc;
use std::time::Duration;
use zeroset::live::{Frame, Live, Start};
use zeroset::picture::Settings;

/// Longer than anything here takes on a slow machine that does other things as well.
pub const LIMIT: Duration = Duration::from_mins(1);

/// Of `text`, in a picture of `side` by `side` pixels.
pub fn start(text: &str, side: usize) -> Live {
    let settings = Settings { width: side, height: side, ..Settings::default() };
    Live::new(Start { name: "test".into(), text: text.into(), settings, ..Start::default() })
}

/// The finished picture.
pub fn settled(live: &Live) -> Arc<Frame> {
    assert!(live.wait(LIMIT), "the picture does not settle");
    let view = live.view();
    assert!(view.fault.is_none(), "{:?}", view.fault.map(|fault| fault.message()));
    view.frame.expect("a picture")
}
