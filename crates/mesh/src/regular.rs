//! Regularizes a solid in a cell: removes faces that are not on the boundary of its interior.
//!
//! A part p stands for the set p ≤ 0, and its opposite for the complement, up to the thin set where
//! p is 0. A minimum stands for a union, a maximum for an intersection. So a choice is a Boolean
//! function of a few sets. Where it does not depend on one of them, that set's boundary is no
//! boundary of the solid: coincident faces vanish.
//!
//! The choice is written anew as the union of all prime implicants. These are the intersections of
//! sets and complements that are in the solid and in no larger such intersection. At a point where
//! the parts of some sets are 0, each of these sets may hold the point or not. The new choice is
//! below 0 there if the function is true in all these cases, above 0 if it is false in all, and
//! else 0. So its sign depends on the point alone. Two cells in which different sets matter agree
//! on it wherever they meet.

use crate::cells::{Side, parts_of};
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
/// Largest number of sets that may occur in a choice together with their complements: more planes
/// have no point in common, unless by chance.
pub const MOST_TWO_SIDED: usize = 3;

/// A regularized choice.
pub enum Regularized {
    Choice(Choice),
    /// The same choice as before, if the boundary of the solid may cross itself.
    Crossing(Choice),
    /// The choice has no zero that bounds an interior. This is its sign elsewhere, −1 or 1.
    Constant(i8),
}

/// Returns the regularized choice. It is the same if each part occurs once in it, or if there are
/// too many parts.
pub fn regularize(choice: Choice) -> Regularized {
    let Some(sets) = Sets::of(&choice) else {
        let is_both = |part: &usize| Side::of(*part as u16, &choice) == Side::Both;
        let is_crossing = parts_of(&choice).iter().any(is_both);
        let same = if is_crossing { Regularized::Crossing } else { Regularized::Choice };
        return same(choice);
    };
    match sets.values(&choice) {
        0 => Regularized::Constant(1),
        u64::MAX => Regularized::Constant(-1),
        values => match sets.choice(values) {
            Some(regular) => Regularized::Choice(regular),
            None => Regularized::Crossing(choice),
        },
    }
}

/// The parts of a choice in which some part occurs twice. Each is the part of a set.
struct Sets(SmallVec<[usize; MOST]>);

impl Sets {
    /// The sets of a choice. `None` if each part occurs once, or if there are too many.
    fn of(choice: &Choice) -> Option<Self> {
        fn add(choice: &Choice, parts: &mut SmallVec<[usize; MOST]>, count: &mut usize) {
            match choice {
                Choice::Part(part) | Choice::Opposite(part) => {
                    *count += 1;
                    if !parts.contains(part) {
                        parts.push(*part);
                    }
                }
                Choice::Min(all) | Choice::Max(all) => {
                    for one in all {
                        add(one, parts, count);
                    }
                }
            }
        }
        let (mut parts, mut count) = (SmallVec::new(), 0);
        add(choice, &mut parts, &mut count);
        (parts.len() < count && parts.len() <= MOST).then_some(Self(parts))
    }

    /// All values of the Boolean function: bit k tells whether points are in the choice's set if
    /// they are in the sets of the bits of k.
    fn values(&self, choice: &Choice) -> u64 {
        let inside = |part: &usize| {
            INSIDE[self.0.iter().position(|one| one == part).expect("a part of the choice")]
        };
        match choice {
            Choice::Part(part) => inside(part),
            Choice::Opposite(part) => !inside(part),
            Choice::Min(all) => all.iter().fold(0, |union, one| union | self.values(one)),
            Choice::Max(all) => all.iter().fold(u64::MAX, |common, one| common & self.values(one)),
        }
    }

    /// The union of all prime implicants. `None` if the boundary may cross itself.
    fn choice(&self, values: u64) -> Option<Choice> {
        // Whether a point that enters a set may enter the solid, and whether it may leave it.
        let changes = |number: &usize| {
            let inside = values & INSIDE[*number];
            let outside = (values & !INSIDE[*number]) << (1 << *number);
            (inside & !outside != 0, outside & !inside != 0)
        };
        let used: SmallVec<[usize; MOST]> =
            (0..self.0.len()).filter(|number| changes(number) != (false, false)).collect();
        let is_two_sided = used.iter().any(|number| changes(number) == (true, true));
        if is_two_sided && !(used.len() <= MOST_TWO_SIDED && is_manifold(values, &used)) {
            return None;
        }
        // Each set is a digit to base 3: it does not matter, or its part does, or the opposite.
        let digits = |term: u32| {
            (0..used.len() as u32).map(move |number| term / 3_u32.pow(number) % 3).zip(&used)
        };
        let size = |term: &u32| digits(*term).filter(|(digit, _)| *digit > 0).count();
        let is_within = |term: u32, other: u32| {
            digits(term).zip(digits(other)).all(|((own, _), (of, _))| of == 0 || own == of)
        };
        let mut terms: Vec<u32> = (0..3_u32.pow(used.len() as u32)).collect();
        terms.sort_by_key(size);
        let mut primes: Vec<u32> = Vec::new();
        for term in terms {
            let common = digits(term).fold(u64::MAX, |common, (digit, number)| match digit {
                0 => common,
                1 => common & INSIDE[*number],
                _ => common & !INSIDE[*number],
            });
            if common & !values == 0 && !primes.iter().any(|prime| is_within(term, *prime)) {
                primes.push(term);
            }
        }
        let intersection = |term: u32| {
            let part = |(digit, number): (u32, &usize)| match digit {
                0 => None,
                1 => Some(Choice::Part(self.0[*number])),
                _ => Some(Choice::Opposite(self.0[*number])),
            };
            single(digits(term).filter_map(part).collect(), Choice::Max)
        };
        Some(single(primes.into_iter().map(intersection).collect(), Choice::Min))
    }
}

/// Returns whether the boundary of a solid is a surface, also where all of up to three planes meet.
/// The octants inside are then connected by faces, and so are those outside, and the same holds of
/// the quadrants around each line.
fn is_manifold(values: u64, used: &[usize]) -> bool {
    let bits = |octant: usize| -> usize {
        used.iter().enumerate().map(|(k, number)| (octant >> k & 1) << *number).sum()
    };
    let count = 1_usize << used.len();
    let is_inside = |octant: usize| values >> bits(octant) & 1 == 1;
    let is_connected = |side: bool, fixed: usize, at: usize| {
        let is_own = |octant: &usize| octant & fixed == at && is_inside(*octant) == side;
        let Some(first) = (0..count).find(is_own) else { return true };
        let (mut found, mut rest) = (1_u32 << first, vec![first]);
        while let Some(octant) = rest.pop() {
            for next in (0..used.len()).map(|axis| octant ^ 1 << axis).filter(is_own) {
                if found >> next & 1 == 0 {
                    found |= 1 << next;
                    rest.push(next);
                }
            }
        }
        (0..count).filter(is_own).count() == found.count_ones() as usize
    };
    (0..count).all(|fixed| {
        let mut places = (0..count).filter(|at| at & !fixed == 0);
        places.all(|at| is_connected(true, fixed, at) && is_connected(false, fixed, at))
    })
}

/// The only choice, or a group of several.
fn single(mut all: Vec<Choice>, group: fn(Vec<Choice>) -> Choice) -> Choice {
    if all.len() == 1 { all.remove(0) } else { group(all) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Choice::{Max, Min, Opposite, Part};

    /// A random choice of parts and opposites.
    fn random_choice(random: &mut fastrand::Rng, parts: usize, depth: usize) -> Choice {
        if depth == 0 {
            let part = random.usize(..parts);
            return if random.bool() { Part(part) } else { Opposite(part) };
        }
        let all = (0..2 + random.usize(..2)).map(|_| {
            let below = random.usize(..depth);
            random_choice(random, parts, below)
        });
        let all = all.collect();
        if random.bool() { Min(all) } else { Max(all) }
    }

    fn value(choice: &Choice, of: &[i32]) -> i32 {
        let each = |all: &[Choice]| -> Vec<i32> { all.iter().map(|one| value(one, of)).collect() };
        match choice {
            Part(part) => of[*part],
            Opposite(part) => -of[*part],
            Min(all) => each(all).into_iter().min().expect("some"),
            Max(all) => each(all).into_iter().max().expect("some"),
        }
    }

    /// All combinations of values of parts among `of`, where the parts that `given` has as 0 vary.
    fn combinations(given: &[i32], of: &[i32]) -> Vec<Vec<i32>> {
        given.iter().fold(vec![Vec::new()], |all, value| {
            let choices = if *value == 0 { of } else { std::slice::from_ref(value) };
            let longer = |start: &Vec<i32>| {
                let start = start.clone();
                choices.iter().map(move |value| [&start[..], &[*value]].concat())
            };
            all.iter().flat_map(longer).collect()
        })
    }

    /// The sign of a regularized choice at a point is that of all places around it, if it is the
    /// same there, and else 0.
    #[test]
    fn signs_are_those_of_the_neighborhood() {
        let (mut zeros, mut signs, mut crossing, mut constant) = (0, 0, 0, 0);
        for seed in 0..6000 {
            let random = &mut fastrand::Rng::with_seed(seed);
            let parts = 2 + random.usize(..3);
            let choice = random_choice(random, parts, 4);
            let regular = match regularize(choice.clone()) {
                Regularized::Choice(regular) => Ok(regular),
                Regularized::Constant(sign) => Err(i32::from(sign)),
                Regularized::Crossing(same) => {
                    assert_eq!(same, choice, "seed {seed}");
                    crossing += 1;
                    continue;
                }
            };
            constant += usize::from(regular.is_err());
            for at in combinations(&vec![0; parts], &[-1, 0, 1]) {
                let around = combinations(&at, &[-1, 1]);
                let mut around = around.iter().map(|place| value(&choice, place));
                let first = around.next().expect("a place");
                let expected = if around.all(|sign| sign == first) { first } else { 0 };
                let found =
                    regular.as_ref().map_or_else(|sign| *sign, |regular| value(regular, &at));
                assert_eq!(found, expected, "seed {seed}: {choice:?} at {at:?}");
                zeros += usize::from(expected == 0);
                signs += usize::from(expected != 0);
            }
        }
        println!("{zeros} zeros, {signs} signs, {constant} constant, {crossing} crossing");
        assert!(zeros.min(signs) > 5000 && constant.min(crossing) > 50);
    }

    #[test]
    fn coincident_faces_vanish() {
        let regular = |choice: Choice| match regularize(choice) {
            Regularized::Choice(choice) => choice,
            Regularized::Constant(sign) => panic!("constant: {sign}"),
            Regularized::Crossing(choice) => panic!("crossing: {choice:?}"),
        };
        // Two halves, and a hole that ends in a face.
        let halves = Min(vec![Max(vec![Part(0), Part(1)]), Max(vec![Part(1), Opposite(0)])]);
        assert_eq!(regular(halves), Part(1));
        let hole = Max(vec![Part(0), Min(vec![Opposite(0), Part(1)])]);
        assert_eq!(regular(hole), Max(vec![Part(0), Part(1)]));
        // A sheet, and all of space.
        let sheet = regularize(Max(vec![Part(0), Opposite(0), Part(1)]));
        assert!(matches!(sheet, Regularized::Constant(1)));
        let all = regularize(Min(vec![Part(0), Part(1), Opposite(0)]));
        assert!(matches!(all, Regularized::Constant(-1)));
        // Two wedges that share an edge.
        let wedges = Min(vec![Max(vec![Part(0), Part(1)]), Max(vec![Opposite(0), Opposite(1)])]);
        assert!(matches!(regularize(wedges), Regularized::Crossing(_)));
        // Boxes that cross: one above a plane, one below.
        let crossed = Min(vec![Max(vec![Part(0), Part(1)]), Max(vec![Opposite(0), Part(2)])]);
        let Min(terms) = regular(crossed) else { panic!("a union") };
        assert!(terms.len() == 3 && terms.contains(&Max(vec![Part(1), Part(2)])), "{terms:?}");
    }
}
