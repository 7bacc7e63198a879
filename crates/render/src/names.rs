//! Names of the values of settings, for command line, prompt and messages: one table per setting.

use crate::picture::{Normals, Precision};
use zeroset_scene::view::ClipShape;
use zeroset_shade::UndecidedStyle;

/// A type of setting whose values have names.
pub trait Named: Copy + PartialEq + Send + Sync + 'static {
    /// The table of values, each with its name and one line of help.
    const NAMES: &'static [(Self, &'static str, &'static str)];

    /// The value called `name`.
    fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// The value's name.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }
}

impl Named for Precision {
    const NAMES: &'static [(Self, &'static str, &'static str)] = Self::NAMES;
}

impl Named for Normals {
    const NAMES: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Gradient, "gradient", "From the exact derivative"),
        (Self::Central, "central", "From central differences, as in the paper"),
    ];
}

impl Named for UndecidedStyle {
    const NAMES: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Shade, "shade", "Like hits"),
        (Self::Hatch, "hatch", "Like hits, with stripes"),
        (Self::Tint, "tint", "Like hits, tinted"),
        (Self::Miss, "miss", "Not at all"),
    ];
}

impl Named for ClipShape {
    const NAMES: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::Auto,
            "auto",
            "As the document says; else to a ball where a surface without end looks better so",
        ),
        (
            Self::Ball,
            "ball",
            "To the ball about the domain's centre that reaches to its farthest faces",
        ),
        (Self::Box, "box", "To the domain's box"),
    ];
}
