//! Regularizes a solid in a cell: removes faces that are not on the boundary of its interior.
//!
//! A part p stands for the set p ≤ 0, a minimum for a union, a maximum for an intersection. Where
//! two parts have opposite signs everywhere, and are 0 on no open set, their sets are complements,
//! up to their common boundary. So a choice is a Boolean function of a few sets. Where it does not
//! depend on one of them, that set's boundary is no boundary of the solid: coincident faces vanish.
//!
//! The choice is then written anew, with the parts on which the Boolean function depends. That is
//! possible if no part occurs in it together with its opposite. Otherwise the solid's boundary
//! crosses itself, and the choice is left as it is: no proof is possible there.

use smallvec::SmallVec;
use zeroset_scene::choices::Choice;

/// Largest number of sets in a choice: the Boolean function of six has 64 values.
const MOST: usize = 6;
/// For each set, the bits of those values of a Boolean function for which a point is in the set.
const INSIDE: [u64; MOST] = [
    0xaaaa_aaaa_aaaa_aaaa,
    0xcccc_cccc_cccc_cccc,
    0xf0f0_f0f0_f0f0_f0f0,
    0xff00_ff00_ff00_ff00,
    0xffff_0000_ffff_0000,
    0xffff_ffff_0000_0000,
];

/// A regularized choice.
pub enum Regularized {
    Choice(Choice),
    /// The choice has no zero that bounds an interior. This is its sign elsewhere, −1 or 1.
    Constant(i8),
}

impl From<Choice> for Regularized {
    fn from(choice: Choice) -> Self {
        Self::Choice(choice)
    }
}

/// Returns the regularized choice. `opposites` has for each part the part with the opposite sign.
/// `is_thin` returns whether a part is proven to be 0 on no open set of the cell.
pub fn regularize(
    choice: Choice,
    opposites: &[Option<usize>],
    is_thin: &dyn Fn(usize) -> bool,
) -> Regularized {
    let Some(sets) = Sets::of(&choice, opposites, is_thin) else { return choice.into() };
    let values = sets.values(&choice);
    if values == 0 || values == u64::MAX {
        return Regularized::Constant(if values == 0 { 1 } else { -1 });
    }
    sets.choice(values).unwrap_or(choice).into()
}

/// The sets of a choice in which some part occurs twice, or with its opposite.
struct Sets<'a> {
    /// The part of each set. Its opposite stands for the complement.
    parts: SmallVec<[usize; MOST]>,
    opposites: &'a [Option<usize>],
}

impl<'a> Sets<'a> {
    /// The sets of a choice. `None` if each has one part that occurs once, if a set's boundary may
    /// be thick, or if there are too many sets.
    fn of(
        choice: &Choice,
        opposites: &'a [Option<usize>],
        is_thin: &dyn Fn(usize) -> bool,
    ) -> Option<Self> {
        let mut occurring = SmallVec::new();
        add_parts(choice, &mut occurring);
        let mut sets = Self { parts: SmallVec::new(), opposites };
        for part in &occurring {
            match sets.of_part(*part) {
                None if sets.parts.len() == MOST => return None,
                None => sets.parts.push(*part),
                Some((_, false)) => {}
                Some((_, true)) if is_thin(*part) => {}
                Some((_, true)) => return None,
            }
        }
        (sets.parts.len() < occurring.len()).then_some(sets)
    }

    /// The number of a part's set, and whether the part stands for the complement.
    fn of_part(&self, part: usize) -> Option<(usize, bool)> {
        let opposite = self.opposites[part];
        let is_own = |one: &usize| *one == part || Some(*one) == opposite;
        let number = self.parts.iter().position(is_own)?;
        Some((number, self.parts[number] != part))
    }

    /// All values of the Boolean function: bit k tells whether points are in the choice's set if
    /// they are in the sets of the bits of k.
    fn values(&self, choice: &Choice) -> u64 {
        match choice {
            Choice::Part(part) => {
                let (number, is_opposite) = self.of_part(*part).expect("a part of the choice");
                if is_opposite { !INSIDE[number] } else { INSIDE[number] }
            }
            Choice::Min(all) => all.iter().fold(0, |union, one| union | self.values(one)),
            Choice::Max(all) => all.iter().fold(u64::MAX, |common, one| common & self.values(one)),
        }
    }

    /// The choice with these values, in which no part occurs together with its opposite. `None` if
    /// there is none.
    fn choice(&self, values: u64) -> Option<Choice> {
        // The sets on which the values depend, each with the part that stands for it or for its
        // complement. A point that moves into such a set moves into the solid, or stays.
        let mut used: SmallVec<[(usize, u64); MOST]> = SmallVec::new();
        for (number, part) in self.parts.iter().enumerate() {
            let shift = 1 << number;
            let inside = values & INSIDE[number];
            let outside = (values & !INSIDE[number]) << shift;
            match (outside & !inside, inside & !outside) {
                (0, 0) => {}
                (0, _) => used.push((*part, INSIDE[number])),
                (_, 0) => used.push((self.opposites[*part]?, !INSIDE[number])),
                _ => return None,
            }
        }
        // The least intersections of sets that are in the solid; the choice is their union.
        let mut least: Vec<u32> = Vec::new();
        let mut groups: Vec<u32> = (0..1 << used.len()).collect();
        groups.sort_by_key(|group| group.count_ones());
        for group in groups {
            let common =
                members(group, &used).fold(u64::MAX, |common, (_, inside)| common & inside);
            if common & !values == 0 && !least.iter().any(|known| known & group == *known) {
                least.push(group);
            }
        }
        let intersection = |group: u32| {
            let parts = members(group, &used).map(|(part, _)| Choice::Part(*part)).collect();
            single(parts, Choice::Max)
        };
        Some(single(least.into_iter().map(intersection).collect(), Choice::Min))
    }
}

/// The members of a group, given as bits.
fn members<T>(group: u32, all: &[T]) -> impl Iterator<Item = &T> {
    all.iter().enumerate().filter(move |(number, _)| group >> number & 1 == 1).map(|(_, one)| one)
}

/// The only choice, or a group of several.
fn single(mut all: Vec<Choice>, group: fn(Vec<Choice>) -> Choice) -> Choice {
    if all.len() == 1 { all.remove(0) } else { group(all) }
}

/// Adds the parts of a choice, as often as they occur.
fn add_parts(choice: &Choice, parts: &mut SmallVec<[usize; 2 * MOST]>) {
    match choice {
        Choice::Part(part) => parts.push(*part),
        Choice::Min(all) | Choice::Max(all) => all.iter().for_each(|one| add_parts(one, parts)),
    }
}
