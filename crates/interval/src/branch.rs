//! Branches over a box: where a function that jumps has one value, or keeps to one side of a pole.
//!
//! How branches of several functions are combined is not known here.

use crate::bounds::Interval;
use crate::enclosure::Exponent;
use zeroset_ops::{Class, Continuity, Law, Op};

/// Which points of a box count.
///
/// A function that jumps splits a box in two or three branches by its own value; one with a pole
/// splits it in two by the sign of its divisor. The branches of one [`Split`] cover the box, so
/// that what holds over each holds over the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// All of them.
    Whole,
    /// Those where an integer-valued function takes the lowest value of the box, a choice its first
    /// branch, a divisor is negative, an angle is below its cut.
    Low,
    /// All but [`Branch::Low`].
    Rest,
    /// Those where an integer-valued function takes neither its lowest nor its highest value of the
    /// box.
    Middle,
    /// Those where it takes the highest.
    High,
}

/// Into which branches an operation splits a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// It does not.
    Whole,
    /// In two, where its divisor changes sign.
    AtPole,
    /// In two, where it jumps.
    AtJump,
    /// In three, where it jumps twice.
    AtBothJumps,
}

impl Split {
    /// How `op` splits boxes, if its operands, as many as its arity says, keep within `ranges`;
    /// `exponent` says what the last one is as an exponent.
    pub fn of(op: Op, ranges: &[Interval], exponent: Exponent) -> Self {
        let straddles = |range: &Interval| range.lo < 0.0 && range.hi > 0.0;
        let row = op.row();
        if row.continuity == Continuity::Jumps {
            let twice = row.class == Class::Function(Law::Sign);
            return if twice { Self::AtBothJumps } else { Self::AtJump };
        }
        let is_pole = match row.class {
            Class::Quotient => straddles(&ranges[1]),
            // An even power goes the same way on both sides of its pole.
            Class::Power => match exponent {
                Exponent::Integer(n) => n < 0 && n % 2 != 0 && straddles(&ranges[0]),
                Exponent::Real | Exponent::LargeInteger { .. } => false,
            },
            Class::Negation
            | Class::Sum
            | Class::Product
            | Class::Square
            | Class::Remainder
            | Class::FunctionOfTwo
            | Class::Extremum
            | Class::Choice
            | Class::Fallback
            | Class::Restriction(_)
            | Class::Function(_) => false,
        };
        if is_pole { Self::AtPole } else { Self::Whole }
    }

    /// The branches; together they cover the box.
    pub fn branches(self) -> &'static [Branch] {
        match self {
            Self::Whole => &[Branch::Whole],
            Self::AtPole | Self::AtJump => &[Branch::Low, Branch::Rest],
            Self::AtBothJumps => &[Branch::Low, Branch::Middle, Branch::High],
        }
    }
}
