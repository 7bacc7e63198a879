//! The three facts that every enclosure carries.

use std::fmt;
use std::ops::BitOr;

/// Facts that are proven about a function over a box, besides its bounds: a set of three bits.
///
/// A bit that is not set claims nothing. [`Facts::NOWHERE`] never occurs with another bit.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Facts(u32);

impl Facts {
    /// Nothing is proven.
    pub const NONE: Self = Self(0);
    /// The function is defined at no point of the box. Its enclosure is empty, whatever the bounds.
    pub const NOWHERE: Self = Self(1);
    /// The function is defined at every point of the box.
    pub const DEFINED: Self = Self(2);
    /// The function is defined and continuous at every point of the box.
    pub const CONTINUOUS: Self = Self(4);
    /// Both [`Facts::DEFINED`] and [`Facts::CONTINUOUS`].
    pub const TOTAL: Self = Self(6);

    /// Returns whether this set has every bit of `other`.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Facts {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl fmt::Debug for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            (Self::NOWHERE, "nowhere"),
            (Self::DEFINED, "defined"),
            (Self::CONTINUOUS, "continuous"),
        ];
        f.debug_set().entries(names.iter().filter(|n| self.has(n.0)).map(|n| n.1)).finish()
    }
}
