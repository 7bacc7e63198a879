//! Converts the scroll counts of the window's library to steps of the mouse wheel.

/// The library's count for one step. On X11 the wheel is a button, of which press and release are
/// both counted.
const COUNTED: f32 = if cfg!(all(unix, not(target_os = "macos"))) { 2.0 } else { 1.0 };

/// Converts scroll counts to steps. Keeps the count of a step that is not complete yet.
#[derive(Default)]
pub struct Wheel {
    /// Count of a step whose button has not been released yet.
    begun: f32,
}

impl Wheel {
    /// Converts the count since the last call to steps, positive for upwards.
    pub fn steps(&mut self, counted: f32) -> f64 {
        let all = self.begun + counted;
        // On other systems, a touchpad scrolls by fractions of a step.
        let steps = if COUNTED == 1.0 { all } else { (all / COUNTED).trunc() };
        self.begun = all - COUNTED * steps;
        f64::from(steps)
    }
}
