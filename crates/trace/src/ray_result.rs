//! The result for one ray.

/// The proven status of the ray through a pixel's center.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// The ray meets no zero inside the region.
    #[default]
    Miss = 0,
    /// The ray meets a zero.
    Hit = 1,
    /// Neither a miss nor a hit is proven.
    Undecided = 2,
}

/// The reason why a ray's first undecided segment is undecided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum UndecidedReason {
    /// The ray is decided, or the method gives no reason.
    #[default]
    None = 0,
    /// The function is as near to 0 as arithmetic can resolve, but has no proven change of sign. It
    /// touches 0, or the surface meets itself.
    Touching = 1,
    /// The function may be undefined on the segment.
    Undefined = 2,
    /// The function may be discontinuous on the segment.
    Discontinuous = 3,
    /// The effort allowed for the ray or the picture is used up.
    Budget = 4,
    /// The method proves nothing about such a ray, even if it draws a point.
    Unproven = 5,
    /// The method needs a bound of the function's slope, and none is known on the segment.
    Steep = 6,
    /// No method examined the segment. Every pixel begins so, and nothing but a proof makes it a
    /// miss. In a finished picture, such a pixel shows a flaw in the program.
    Unseen = 7,
}

impl UndecidedReason {
    /// All reasons, in the order of their discriminants.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Touching,
        Self::Undefined,
        Self::Discontinuous,
        Self::Budget,
        Self::Unproven,
        Self::Steep,
        Self::Unseen,
    ];

    /// The reason's name, one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "other",
            Self::Touching => "touching",
            Self::Undefined => "undefined",
            Self::Discontinuous => "discontinuous",
            Self::Budget => "budget",
            Self::Unproven => "unproven",
            Self::Steep => "steep",
            Self::Unseen => "unseen",
        }
    }

    /// The reason as a phrase that follows the word "undecided".
    pub fn describe(self) -> &'static str {
        match self {
            Self::None => "without a reason that is known",
            Self::Touching => "where f comes near 0 and no change of sign is proven",
            Self::Undefined => "where f may be undefined",
            Self::Discontinuous => "where f may be discontinuous",
            Self::Budget => "for which effort or time ran out",
            Self::Unproven => "of which this method proves nothing",
            Self::Steep => "where no bound of f's slope is known, which this method needs",
            Self::Unseen => "that were not examined, by a flaw in this program: please report it",
        }
    }
}

/// Bound of the relative error of a direction's length, and of the length times a number.
pub(crate) const LENGTH_ERROR: f64 = 8.0 * f64::EPSILON;

/// The result for one ray. All distances are values of the ray's parameter t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayResult {
    /// The proven status, which does not depend on the distances.
    pub status: Status,
    /// Distance of the hit, or of the start of the first undecided segment; infinite for a miss.
    pub distance: f64,
    /// Distance of the painted point; infinite if nothing is painted.
    pub drawn: f64,
    /// Reason for an undecided ray.
    pub reason: UndecidedReason,
    /// Bracket of a hit: the ray's first zero is proven to lie in it. NaN for other rays.
    pub bracket: [f64; 2],
    /// For a painted point of a parametric surface, approximate values of u and v. Else 0.
    pub parameters: [f32; 2],
}

impl RayResult {
    /// A ray that is proven to meet no zero.
    pub const MISS: Self = Self {
        status: Status::Miss,
        distance: f64::INFINITY,
        drawn: f64::INFINITY,
        reason: UndecidedReason::None,
        bracket: [f64::NAN; 2],
        parameters: [0.0; 2],
    };

    /// Returns whether the result is a miss.
    pub(crate) fn is_miss(&self) -> bool {
        self.status == Status::Miss
    }

    /// The result for a ray that was not examined. Every result begins so.
    pub const UNSEEN: Self = Self {
        status: Status::Undecided,
        distance: 0.0,
        reason: UndecidedReason::Unseen,
        ..Self::MISS
    };

    /// Returns whether the ray was not examined.
    pub(crate) fn is_unseen(&self) -> bool {
        self.reason == UndecidedReason::Unseen
    }

    /// The result for a ray that was not followed, for lack of time.
    pub(crate) const GIVEN_UP: Self = Self {
        status: Status::Undecided,
        distance: 0.0,
        reason: UndecidedReason::Budget,
        ..Self::MISS
    };

    /// This result with distances in world units. `length` is the length of the ray's direction.
    pub(crate) fn scaled(self, length: f64) -> Self {
        let [near, far] = self.bracket.map(|t| t * length);
        Self {
            distance: self.distance * length,
            drawn: self.drawn * length,
            bracket: [near - LENGTH_ERROR * near.abs(), far + LENGTH_ERROR * far.abs()],
            ..self
        }
    }
}
