//! Drops members of unions and intersections that are decided by other members.
//!
//! In an intersection with v ≤ c, only points with v ≤ c count for the other members. There the
//! bound v ≤ d holds if d ≥ c. The bound v ≥ d fails if d > c. If d = c, it fails except on the
//! face, which is thin. In a union with v ≤ c, only points with v > c count for the other members,
//! since the union contains all others.

use super::sets::{Bound, Kind, Set, SetId, Sets, Side};
use num_rational::BigRational;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// Largest number of times that the members of one group are looked through. Further members that
/// could be dropped are kept.
const ROUNDS: usize = 4;

/// The range in which a sum of terms is known to be. An end is `None` if it is not known.
#[derive(Clone, Debug, Default)]
pub(super) struct Range {
    pub low: Option<Rc<BigRational>>,
    pub high: Option<Rc<BigRational>>,
}

impl Range {
    /// Narrows the range to points where a bound holds.
    pub fn narrow(&mut self, side: Side, at: &Rc<BigRational>) {
        let end = match side {
            Side::Below => &mut self.high,
            Side::Above => &mut self.low,
        };
        let is_closer = match (&*end, side) {
            (None, _) => true,
            (Some(end), Side::Below) => at < end,
            (Some(end), Side::Above) => at > end,
        };
        if is_closer {
            *end = Some(Rc::clone(at));
        }
    }
}

/// The ranges of all sums, by the numbers of the sums.
pub(super) type Ranges = FxHashMap<u32, Range>;

impl Sets<'_> {
    /// Returns an equal set, up to thin ones, without the members that their neighbors decide.
    pub fn reduce(&mut self, id: SetId) -> SetId {
        self.reduce_within(id, &mut Ranges::default())
    }

    /// Does the work of [`Self::reduce`] where the members around the set restrict values to
    /// `ranges`.
    fn reduce_within(&mut self, id: SetId, ranges: &mut Ranges) -> SetId {
        let Some(work) = self.work.checked_sub(1) else { return id };
        self.work = work;
        let (kind, members) = match self.set(id) {
            Set::All | Set::Nothing => return id,
            Set::Bound(bound) => {
                let bound = bound.clone();
                return match self.decided(&bound, ranges) {
                    Some(true) => SetId::ALL,
                    Some(false) => SetId::NONE,
                    None => id,
                };
            }
            Set::Group(kind, members) => (*kind, Rc::clone(members)),
        };
        let mut members = members;
        let mut now = id;
        for _ in 0..ROUNDS {
            let Some(kept) = self.reduce_members(kind, &members, ranges) else {
                return kind.absorbing();
            };
            if kept[..] == members[..] {
                return now;
            }
            now = self.group(kind, kept);
            match self.set(now) {
                Set::Group(found, found_members) if *found == kind => {
                    members = Rc::clone(found_members);
                }
                // Another kind of set was a member, and is reduced already.
                Set::Group(..) | Set::All | Set::Nothing | Set::Bound(_) => return now,
            }
        }
        now
    }

    /// Returns the remaining members of a group, in their order. `None` if the group is its
    /// absorbing set.
    fn reduce_members(
        &mut self,
        kind: Kind,
        members: &[SetId],
        ranges: &mut Ranges,
    ) -> Option<Vec<SetId>> {
        let mut own = Ranges::default();
        for member in members {
            let Some(bound) = self.bound(*member).cloned() else { continue };
            match self.decided(&bound, ranges) {
                None => {
                    let side = kind.effective(bound.side);
                    own.entry(bound.sum).or_default().narrow(side, &bound.at);
                }
                // The surroundings decide this bound, and the bound decides the group.
                Some(holds) if holds == (kind == Kind::Union) => return None,
                Some(_) => {}
            }
        }
        for (sum, Range { low, high }) in &own {
            let (Some(low), Some(high)) = (low, high) else { continue };
            // In an intersection, no point meets both bounds, up to a thin face. In a union, every
            // point meets one of them.
            if low > high || low == high && self.is_empty_face(kind, *sum, low) {
                return None;
            }
        }
        let mut before = Vec::new();
        for (sum, Range { low, high }) in &own {
            let range = ranges.entry(*sum).or_default();
            before.push((*sum, range.clone()));
            for (side, at) in [(Side::Above, low), (Side::Below, high)] {
                if let Some(at) = at {
                    range.narrow(side, at);
                }
            }
        }
        let mut kept = Vec::with_capacity(members.len());
        let mut is_absorbed = false;
        for member in members {
            let left = match self.bound(*member) {
                Some(bound) => {
                    let range = own.get(&bound.sum);
                    let end = range.and_then(|range| match kind.effective(bound.side) {
                        Side::Below => range.high.as_ref(),
                        Side::Above => range.low.as_ref(),
                    });
                    // The closest of the bounds on one side decides the others.
                    if end == Some(&bound.at) { *member } else { kind.neutral() }
                }
                None => self.reduce_within(*member, ranges),
            };
            if left == kind.absorbing() {
                is_absorbed = true;
                break;
            }
            if left != kind.neutral() {
                kept.push(left);
            }
        }
        for (sum, range) in before {
            ranges.insert(sum, range);
        }
        (!is_absorbed).then_some(kept)
    }

    /// Returns whether v ≤ c and v ≥ c decide a group: their intersection is thin, their union all
    /// of space.
    fn is_empty_face(&mut self, kind: Kind, sum: u32, at: &Rc<BigRational>) -> bool {
        let bound = Bound { sum, side: Side::Below, at: Rc::clone(at) };
        kind == Kind::Union || self.is_thin(&bound)
    }

    /// Returns whether a bound holds within `ranges`, up to thin sets; `None` if that depends.
    pub fn decided(&mut self, bound: &Bound, ranges: &Ranges) -> Option<bool> {
        let Range { low, high } = ranges.get(&bound.sum)?;
        let (holding, failing) = match bound.side {
            Side::Below => (high, low),
            Side::Above => (low, high),
        };
        let is_beyond = |a: &Rc<BigRational>, b: &Rc<BigRational>| match bound.side {
            Side::Below => a < b,
            Side::Above => a > b,
        };
        if let Some(end) = holding
            && !is_beyond(&bound.at, end)
        {
            return Some(true);
        }
        let end = failing.as_ref()?;
        let fails = is_beyond(&bound.at, end) || bound.at == *end && self.is_thin(bound);
        fails.then_some(false)
    }
}

impl Kind {
    /// The side of a bound that holds for the other members of a group: in a union, they only
    /// count where the bound fails.
    pub fn effective(self, side: Side) -> Side {
        match self {
            Self::Intersection => side,
            Self::Union => !side,
        }
    }
}
