//! Steps of the wheel. Knows nothing of what they do.

/// What the library counts for a step: on X11, where the wheel is a button, it counts each press
/// and each release.
const COUNTED: f32 = if cfg!(all(unix, not(target_os = "macos"))) { 2.0 } else { 1.0 };

/// Makes steps of what is counted.
#[derive(Default)]
pub struct Wheel {
    /// What was counted of a step whose button had not been let go yet.
    begun: f32,
}

impl Wheel {
    /// Steps, upwards if positive, since this was last asked, when so much was counted meanwhile.
    pub fn steps(&mut self, counted: f32) -> f64 {
        let all = self.begun + counted;
        // A touchpad elsewhere scrolls by parts of a step.
        let steps = if COUNTED == 1.0 { all } else { (all / COUNTED).trunc() };
        self.begun = all - COUNTED * steps;
        f64::from(steps)
    }
}
