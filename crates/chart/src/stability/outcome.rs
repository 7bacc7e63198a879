//! What becomes of a case, in one word.

use crate::errors::Errors;
use serde::Serialize;

/// What a picture of a difficult formula is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Hardly a pixel is wrong.
    Sound,
    /// Roots are not painted, or not the first ones.
    Holes,
    /// Something is painted where there is no root.
    Phantoms,
    /// Likewise, over a good part of the picture.
    Wall,
    /// Holes and phantoms, or points that are not at the root.
    Noise,
    /// Time ran out.
    Slow,
    /// There is no picture.
    Refused,
    /// Of no pixel it is certain that it shows a root, and of some it is not certain that it does
    /// not.
    Unjudged,
}

/// As many pixels may be wrong in a sound picture: silhouettes are as thin as that.
const SOUND: f64 = 1.0 / 200.0;
/// So much of what is to be seen may be missing: thin things cover few pixels, so these are counted
/// in roots.
const WHOLE: f64 = 1.0 / 50.0;
/// So many phantoms are a wall.
const WALL: f64 = 1.0 / 20.0;
/// Of what is wrong, so much of either kind is noise.
const BOTH: f64 = 0.25;
/// Footprints that half of the painted pixels must be within.
const NEAR: f64 = 1.0;

impl Outcome {
    /// Every outcome.
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

    /// What it is called.
    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// That of a picture with these errors, for which time ran out or not.
    pub fn of(errors: &Errors, is_late: bool) -> Self {
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
        let plain = || Errors { samples: 4000, roots: 1000, ..Errors::default() };
        let cases = [
            (plain(), Outcome::Sound),
            (Errors { phantom: 20, ..plain() }, Outcome::Sound),
            (Errors { off_pixels: Some([2.0, 3.0, 4.0]), ..plain() }, Outcome::Noise),
            (Errors { missed: 10, wrong_root: 20, ..plain() }, Outcome::Holes),
            (Errors { phantom: 100, missed: 5, ..plain() }, Outcome::Phantoms),
            (Errors { phantom: 300, missed: 5, ..plain() }, Outcome::Wall),
            (Errors { phantom: 30, missed: 30, ..plain() }, Outcome::Noise),
            // Of a thin thing little is missing, and yet all.
            (Errors { roots: 10, missed: 10, ..plain() }, Outcome::Holes),
            (Errors { roots: 0, ..plain() }, Outcome::Sound),
            (Errors { roots: 0, open: 9, phantom: 300, ..plain() }, Outcome::Unjudged),
        ];
        for (errors, outcome) in cases {
            assert_eq!(Outcome::of(&errors, false), outcome, "{errors:?}");
            assert_eq!(Outcome::of(&errors, true), Outcome::Slow, "{errors:?}");
        }
    }
}
