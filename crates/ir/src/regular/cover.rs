//! Sets that cover the faces which the members of a group share.
//!
//! The union of P ∩ (v ≤ c) and Q ∩ (v ≥ c) contains P ∩ Q. So adding P ∩ Q to the union does not
//! change the set. But it makes the function of the union negative on the shared face v = c, at
//! points of both P and Q. (Logic design adds such terms against hazards; logicians call them
//! consensus, or resolvents.) If the added set contains a member, the member is dropped. So two
//! boxes with a common face become one box. The intersection of unions has the dual rule.

use super::reduce::Ranges;
use super::sets::{Bound, Kind, Set, SetId, Sets, Side};
use num_rational::BigRational;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// A group of n members gets at most n + `ADDED` additional sets.
const ADDED: usize = 16;

/// A member of a group: a group of the other kind, or a set that was added.
struct Member {
    set: SetId,
    is_dropped: bool,
    /// The ranges to which its own bounds confine the sums. If the group is an intersection, these
    /// are the ranges of its complement.
    ranges: Ranges,
    /// True if the set was added.
    is_added: bool,
}

/// The members that have a bound, by the bound.
#[derive(Default)]
struct Index(FxHashMap<Bound, Vec<usize>>);

impl Index {
    fn add(&mut self, bounds: &[Bound], member: usize) {
        for bound in bounds {
            self.0.entry(bound.clone()).or_default().push(member);
        }
    }

    fn of(&self, bound: &Bound) -> &[usize] {
        self.0.get(bound).map_or(&[], Vec::as_slice)
    }
}

impl Sets<'_> {
    /// Returns a set that is equal up to thin sets. The result or its complement contains the faces
    /// that members share.
    pub fn cover(&mut self, id: SetId) -> SetId {
        let mut known = FxHashMap::default();
        self.cover_once(id, &mut known)
    }

    /// Covers a set after its members. `known` has the sets that are covered already.
    fn cover_once(&mut self, id: SetId, known: &mut FxHashMap<SetId, SetId>) -> SetId {
        let Set::Group(kind, members) = self.set(id) else { return id };
        if let Some(covered) = known.get(&id) {
            return *covered;
        }
        let (kind, members) = (*kind, Rc::clone(members));
        let inner: Vec<SetId> = members.iter().map(|id| self.cover_once(*id, known)).collect();
        let group = if inner[..] == members[..] { id } else { self.group(kind, inner) };
        let covered = match self.set(group) {
            Set::Group(found, members) if *found == kind => {
                let members = Rc::clone(members);
                self.cover_members(kind, &members).unwrap_or(group)
            }
            Set::Group(..) | Set::All | Set::Nothing | Set::Bound(_) => group,
        };
        known.insert(id, covered);
        covered
    }

    /// The group of these members and of the sets that cover the faces which they share. `None` if
    /// nothing is added.
    fn cover_members(&mut self, kind: Kind, sets: &[SetId]) -> Option<SetId> {
        let (others, groups): (Vec<SetId>, Vec<SetId>) =
            sets.iter().partition(|id| self.bound(**id).is_some());
        let limit = 2 * groups.len() + ADDED;
        let mut members: Vec<Member> = Vec::new();
        let mut rest: Vec<(SetId, bool)> = groups.into_iter().rev().map(|id| (id, false)).collect();
        let (mut near, mut far) = (Index::default(), Index::default());
        let mut added = 0;
        while let Some((set, is_added)) = rest.pop() {
            let (first, inner) = (members.len(), self.inner_bounds(kind, set));
            let [own, nested] = &inner;
            let mut pairs: Vec<(Bound, usize)> = Vec::new();
            for bound in own {
                let opposite = Bound { side: !bound.side, ..bound.clone() };
                let found = near.of(&opposite).iter().chain(far.of(&opposite));
                pairs.extend(found.map(|member| (bound.clone(), *member)));
            }
            for bound in nested {
                let opposite = Bound { side: !bound.side, ..bound.clone() };
                pairs.extend(near.of(&opposite).iter().map(|member| (bound.clone(), *member)));
            }
            near.add(own, first);
            far.add(nested, first);
            let ranges = ranges_of(kind, own);
            members.push(Member { set, is_dropped: false, ranges, is_added });
            for (bound, other) in pairs {
                if members[first].is_dropped {
                    break;
                }
                if members[other].is_dropped || added == limit {
                    continue;
                }
                self.work = self.work.checked_sub(1)?;
                let Some(cover) = self.shared(kind, &bound, [&members[first], &members[other]])
                else {
                    continue;
                };
                if cover == kind.absorbing() {
                    return Some(cover);
                }
                let [own, _] = self.inner_bounds(kind, cover);
                let ranges = ranges_of(kind, &own);
                let is_in = |k: usize| self.is_part(kind, (cover, &ranges), members[k].set);
                let is_same = |member: &Member| !member.is_dropped && member.set == cover;
                if is_in(first)
                    || is_in(other)
                    || members.iter().any(is_same)
                    || rest.iter().any(|(set, _)| *set == cover)
                {
                    continue;
                }
                let is_part = |member: &Member| {
                    !member.is_dropped && self.is_part(kind, (member.set, &member.ranges), cover)
                };
                let parts: Vec<usize> =
                    (0..members.len()).filter(|k| is_part(&members[*k])).collect();
                // An added set is paired with others only if the new cover contains a member, which
                // is then dropped.
                if parts.is_empty() && (is_added || members[other].is_added) {
                    continue;
                }
                added += 1;
                for k in parts {
                    members[k].is_dropped = true;
                }
                rest.push((cover, true));
            }
        }
        let kept = members.iter().filter(|member| !member.is_dropped).map(|member| member.set);
        let kept: Vec<SetId> = kept.chain(others).collect();
        (added > 0).then(|| self.group(kind, kept))
    }

    /// The bounds inside `set`, a member of a group of this kind. The first list has the bounds
    /// among its own members, the second has the bounds among the members of its members.
    fn inner_bounds(&self, kind: Kind, set: SetId) -> [Vec<Bound>; 2] {
        let (mut own, mut nested) = (Vec::new(), Vec::new());
        for member in &*self.members(!kind, set) {
            if let Some(bound) = self.bound(*member) {
                own.push(bound.clone());
            } else {
                let inner = self.members(kind, *member);
                nested.extend(inner.iter().filter_map(|id| self.bound(*id)).cloned());
            }
        }
        [own, nested]
    }

    /// The set that covers the face of `bound`. The first member has `bound`, and the second has
    /// the opposite bound. `None` if no such set is needed, or none is found.
    fn shared(
        &mut self,
        kind: Kind,
        bound: &Bound,
        [first, second]: [&Member; 2],
    ) -> Option<SetId> {
        if exclude(&first.ranges, &second.ranges, bound) || !self.is_thin(bound) {
            return None;
        }
        let opposite = Bound { side: !bound.side, ..bound.clone() };
        let parts = [
            self.substitute_bounds(kind, first.set, [bound, &opposite])?,
            self.substitute_bounds(kind, second.set, [&opposite, bound])?,
        ];
        let cover = self.group(!kind, parts);
        let cover = self.reduce(cover);
        (cover != kind.neutral()).then_some(cover)
    }

    /// Substitutes truth values for two bounds inside a member of a group. In a union, `held` is
    /// true and `other` is false; in an intersection, the reverse. `None` if this takes too many
    /// steps.
    fn substitute_bounds(
        &mut self,
        kind: Kind,
        set: SetId,
        [held, other]: [&Bound; 2],
    ) -> Option<SetId> {
        self.work = self.work.checked_sub(1)?;
        match self.set(set) {
            Set::Bound(bound) if bound == held => Some(kind.absorbing()),
            Set::Bound(bound) if bound == other => Some(kind.neutral()),
            Set::All | Set::Nothing | Set::Bound(_) => Some(set),
            Set::Group(found, members) => {
                let (found, members) = (*found, Rc::clone(members));
                let left: Option<Vec<SetId>> = members
                    .iter()
                    .map(|id| self.substitute_bounds(kind, *id, [held, other]))
                    .collect();
                let left = left?;
                Some(if left[..] == members[..] { set } else { self.group(found, left) })
            }
        }
    }

    /// Returns whether a member of a union, with its ranges, is proven to lie in `cover`. In an
    /// intersection, the complement of the member is proven to lie in the complement of `cover`.
    fn is_part(&self, kind: Kind, (set, ranges): (SetId, &Ranges), cover: SetId) -> bool {
        let own = self.members(!kind, set);
        self.members(!kind, cover).iter().all(|id| match self.bound(*id) {
            Some(bound) => {
                let side = (!kind).effective(bound.side);
                ranges.get(&bound.sum).is_some_and(|range| match side {
                    Side::Below => range.high.as_ref().is_some_and(|high| *high <= bound.at),
                    Side::Above => range.low.as_ref().is_some_and(|low| *low >= bound.at),
                })
            }
            None => *id == set || own.contains(id),
        })
    }
}

/// Returns whether a bound other than `except` separates two members: they share at most points of
/// its face.
fn exclude(first: &Ranges, second: &Ranges, except: &Bound) -> bool {
    let ends = |a: &Option<Rc<BigRational>>, b: &Option<Rc<BigRational>>| {
        a.as_ref().zip(b.as_ref()).is_some_and(|(a, b)| a >= b)
    };
    first.iter().any(|(sum, a)| {
        *sum != except.sum
            && second.get(sum).is_some_and(|b| ends(&a.low, &b.high) || ends(&b.low, &a.high))
    })
}

/// Returns the ranges to which a member's bounds confine the sums.
fn ranges_of(kind: Kind, bounds: &[Bound]) -> Ranges {
    let mut ranges = Ranges::default();
    for bound in bounds {
        let side = (!kind).effective(bound.side);
        ranges.entry(bound.sum).or_default().narrow(side, &bound.at);
    }
    ranges
}
