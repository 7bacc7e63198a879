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
    /// Of no pixel it is certain that it shows a root, and of some it is not certain that it does not.
    Unjudged,
}

/// What an outcome is found from: numbers of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Of which it is certain what they show.
    pub decided: usize,
    /// Of which it is not.
    pub open: usize,
    /// Of which it is certain that they show a root.
    pub roots: usize,
    /// Roots that are not painted.
    pub missed: usize,
    /// Painted without a root.
    pub phantom: usize,
    /// Painted nearer to the next root.
    pub wrong_root: usize,
    /// Left open by the method.
    pub undecided: usize,
    /// Claimed wrongly.
    pub false_claims: usize,
    /// How far 999 in 1000 painted pixels are at most from their root, in pixels' footprints.
    pub off_pixels: f64,
    /// How far half of them are at most.
    pub off_median: f64,
    /// Whether time ran out.
    pub is_late: bool,
}

/// As many pixels may be wrong in a sound picture: silhouettes are as thin as that.
const SOUND: f64 = 1.0 / 200.0;
/// So much of what is to be seen may be missing: thin things cover few pixels, so these are counted in roots.
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
    pub fn name(self) -> &'static str {
        match self {
            Self::Sound => "sound",
            Self::Holes => "holes",
            Self::Phantoms => "phantoms",
            Self::Wall => "wall",
            Self::Noise => "noise",
            Self::Slow => "slow",
            Self::Refused => "refused",
            Self::Unjudged => "unjudged",
        }
    }
}

impl Counts {
    /// Of a picture's errors.
    pub fn of(errors: &Errors, is_late: bool) -> Self {
        let [off_median, off_pixels, _] = errors.off_pixels.unwrap_or_default();
        Self {
            decided: errors.decided(),
            open: errors.open,
            roots: errors.roots,
            missed: errors.missed,
            phantom: errors.phantom,
            wrong_root: errors.wrong_root,
            undecided: errors.undecided,
            false_claims: errors.false_claims,
            off_pixels,
            off_median,
            is_late,
        }
    }

    /// The outcome.
    pub fn outcome(&self) -> Outcome {
        let decided = self.decided as f64;
        let (holes, phantoms) = ((self.missed + self.wrong_root) as f64, self.phantom as f64);
        let wrong = holes + phantoms;
        if self.is_late {
            Outcome::Slow
        } else if self.roots == 0 && self.open > 0 {
            Outcome::Unjudged
        } else if wrong <= SOUND * decided && holes <= WHOLE * self.roots as f64 {
            if self.off_median <= NEAR { Outcome::Sound } else { Outcome::Noise }
        } else if holes.min(phantoms) >= BOTH * wrong {
            Outcome::Noise
        } else if holes > phantoms {
            Outcome::Holes
        } else if phantoms > WALL * decided {
            Outcome::Wall
        } else {
            Outcome::Phantoms
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_named_after_what_is_wrong() {
        let plain = Counts { decided: 4000, roots: 1000, ..Counts::default() };
        let cases = [
            (plain, Outcome::Sound),
            (Counts { phantom: 20, ..plain }, Outcome::Sound),
            (Counts { off_median: 2.0, ..plain }, Outcome::Noise),
            (Counts { missed: 10, wrong_root: 20, ..plain }, Outcome::Holes),
            (Counts { phantom: 100, missed: 5, ..plain }, Outcome::Phantoms),
            (Counts { phantom: 300, missed: 5, ..plain }, Outcome::Wall),
            (Counts { phantom: 30, missed: 30, ..plain }, Outcome::Noise),
            (Counts { phantom: 300, is_late: true, ..plain }, Outcome::Slow),
            // Of a thin thing little is missing, and yet all.
            (Counts { roots: 10, missed: 10, ..plain }, Outcome::Holes),
            (Counts { roots: 0, ..plain }, Outcome::Sound),
            (Counts { roots: 0, open: 9, phantom: 300, ..plain }, Outcome::Unjudged),
        ];
        for (counts, outcome) in cases {
            assert_eq!(counts.outcome(), outcome, "{counts:?}");
        }
    }
}
