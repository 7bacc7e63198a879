//! What becomes of one ray.

/// What is proven of the ray through a pixel's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// It meets no zero inside the region.
    #[default]
    Miss = 0,
    /// It meets one.
    Hit = 1,
    /// Neither is proven.
    Undecided = 2,
}

/// Why nothing is proven of an undecided ray, by the first part of it that is so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum UndecidedReason {
    /// It is decided, or the method does not tell.
    #[default]
    None = 0,
    /// The function comes as near to 0 as arithmetic can tell, and shows no change of sign: it
    /// touches 0, or the surface meets itself.
    Touching = 1,
    /// It is not known to be defined there.
    Undefined = 2,
    /// It is not known to be continuous there.
    Discontinuous = 3,
    /// What was to be spent on the ray, or on the picture, was not enough.
    Budget = 4,
    /// The method proves nothing of such a ray, whether it draws something or not.
    Unproven = 5,
    /// No bound of its slope is known there, without which the method cannot go on.
    Steep = 6,
}

impl UndecidedReason {
    /// Every reason, in the order of its number.
    pub const ALL: [Self; 7] = [
        Self::None,
        Self::Touching,
        Self::Undefined,
        Self::Discontinuous,
        Self::Budget,
        Self::Unproven,
        Self::Steep,
    ];

    /// What it is called, in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "other",
            Self::Touching => "touching",
            Self::Undefined => "undefined",
            Self::Discontinuous => "discontinuous",
            Self::Budget => "budget",
            Self::Unproven => "unproven",
            Self::Steep => "steep",
        }
    }

    /// What it says of a ray, after "undecided".
    pub fn describe(self) -> &'static str {
        match self {
            Self::None => "without a reason that is known",
            Self::Touching => "where f comes near 0 and no change of sign is proven",
            Self::Undefined => "where f may be undefined",
            Self::Discontinuous => "where f may be discontinuous",
            Self::Budget => "for which effort or time ran out",
            Self::Unproven => "of which this method proves nothing",
            Self::Steep => "where no bound of f's slope is known, which this method needs",
        }
    }
}

/// A relative error above that of a direction's length, and of what is multiplied by it.
pub(crate) const LENGTH_ERROR: f64 = 8.0 * f64::EPSILON;

/// What became of one ray. Distances are values of its parameter t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayResult {
    /// What is proven, whatever the distances are.
    pub status: Status,
    /// Of the hit, or of the start of the first undecided part; infinite for a miss.
    pub distance: f64,
    /// Of what is to be painted; infinite for nothing.
    pub drawn: f64,
    /// Why it is undecided.
    pub reason: UndecidedReason,
    /// Of a hit: the part of the ray that is proven to hold its first zero, and nothing before it.
    /// Else NaN.
    pub bracket: [f64; 2],
}

impl RayResult {
    /// No zero.
    pub const MISS: Self = Self {
        status: Status::Miss,
        distance: f64::INFINITY,
        drawn: f64::INFINITY,
        reason: UndecidedReason::None,
        bracket: [f64::NAN; 2],
    };

    /// Whether this says anything but that there is no zero.
    pub(crate) fn is_miss(&self) -> bool {
        self.status == Status::Miss
    }

    /// Nothing is known of the ray, for lack of time.
    pub(crate) const GIVEN_UP: Self = Self {
        status: Status::Undecided,
        distance: 0.0,
        reason: UndecidedReason::Budget,
        ..Self::MISS
    };

    /// The same with distances in world units, for a ray whose direction has this length.
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
