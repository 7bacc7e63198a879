//! Converts the scroll counts of the window's library to steps of the mouse wheel.

/// The count that the window's library gives for one step of the wheel. On X11 the wheel is a
/// button, and the library counts both its press and its release.
const COUNTED: f32 = if cfg!(all(unix, not(target_os = "macos"))) { 2.0 } else { 1.0 };

/// Converts scroll counts to steps. The count of an incomplete step is kept for the next call.
#[derive(Default)]
pub struct Wheel {
    /// Count of the incomplete step.
    begun: f32,
}

impl Wheel {
    /// Converts the count since the last call into a number of steps. Upward steps are positive.
    pub fn steps(&mut self, counted: f32) -> f64 {
        let all = self.begun + counted;
        // On systems other than X11, a touchpad scrolls by fractions of a step.
        let steps = if COUNTED == 1.0 { all } else { (all / COUNTED).trunc() };
        self.begun = all - COUNTED * steps;
        f64::from(steps)
    }
}
