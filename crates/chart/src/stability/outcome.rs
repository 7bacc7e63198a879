//! The class of a method's result on a case.

use crate::errors::PixelErrors;
use serde::Serialize;

/// The class of a method's picture of a difficult formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Almost all pixels are right.
    Sound,
    /// Roots are missed, or a root other than the first is painted.
    Holes,
    /// Something is painted where there is no root.
    Phantoms,
    /// Points painted where there is no root cover a large part of the picture.
    Wall,
    /// Both holes and phantoms, or points far from the root.
    Noise,
    /// The time limit was reached.
    Slow,
    /// There is no picture.
    Refused,
    /// The reference has no pixel that certainly shows a root, and some that it leaves open.
    Unjudged,
}

/// Greatest share of wrong pixels in a sound picture. It allows for silhouettes.
const SOUND: f64 = 1.0 / 200.0;
/// Greatest share of roots that a sound picture misses. Without this limit, a picture could miss a
/// thin feature, which covers few pixels.
const WHOLE: f64 = 1.0 / 50.0;
/// Above this share of pixels, points painted without a root are a wall.
const WALL: f64 = 1.0 / 20.0;
/// Holes and phantoms are noise if each is at least this share of the wrong pixels.
const BOTH: f64 = 0.25;
/// Greatest median distance from the root in a sound picture, in pixels' footprints.
const NEAR: f64 = 1.0;

impl Outcome {
    /// All outcomes, in the order of tables.
    pub const ALL: [Self; 8] = [
        Self::Sound,
        Self::Holes,
        Self::Phantoms,
        Self::Wall,
        Self::Noise,
        Self::Slow,
        Self::Refused,
        Self::Unjudged,
    ];

    /// The outcome's name.
    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Classifies a picture with these errors. `is_late` is true if the time limit was reached.
    pub fn of(errors: &PixelErrors, is_late: bool) -> Self {
        let decided = errors.decided() as f64;
        let (holes, phantoms) = ((errors.missed + errors.wrong_root) as f64, errors.phantom as f64);
        let wrong = holes + phantoms;
        let [off, ..] = errors.off_pixels.unwrap_or_default();
        if is_late {
            Self::Slow
        } else if errors.roots == 0 && errors.open > 0 {
            Self::Unjudged
        } else if wrong <= SOUND * decided && holes <= WHOLE * errors.roots as f64 {
            if off <= NEAR { Self::Sound } else { Self::Noise }
        } else if holes.min(phantoms) >= BOTH * wrong {
            Self::Noise
        } else if holes > phantoms {
            Self::Holes
        } else if phantoms > WALL * decided {
            Self::Wall
        } else {
            Self::Phantoms
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_named_after_what_is_wrong() {
        let plain = || PixelErrors { samples: 4000, roots: 1000, ..PixelErrors::default() };
        let cases = [
            (plain(), Outcome::Sound),
            (PixelErrors { phantom: 20, ..plain() }, Outcome::Sound),
            (PixelErrors { off_pixels: Some([2.0, 3.0, 4.0]), ..plain() }, Outcome::Noise),
            (PixelErrors { missed: 10, wrong_root: 20, ..plain() }, Outcome::Holes),
            (PixelErrors { phantom: 100, missed: 5, ..plain() }, Outcome::Phantoms),
            (PixelErrors { phantom: 300, missed: 5, ..plain() }, Outcome::Wall),
            (PixelErrors { phantom: 30, missed: 30, ..plain() }, Outcome::Noise),
            // A thin feature covers few pixels, all of which are missed.
            (PixelErrors { roots: 10, missed: 10, ..plain() }, Outcome::Holes),
            (PixelErrors { roots: 0, ..plain() }, Outcome::Sound),
            (PixelErrors { roots: 0, open: 9, phantom: 300, ..plain() }, Outcome::Unjudged),
        ];
        for (errors, outcome) in cases {
            assert_eq!(Outcome::of(&errors, false), outcome, "{errors:?}");
            assert_eq!(Outcome::of(&errors, true), Outcome::Slow, "{errors:?}");
        }
    }
}
