//! The domain of surfaces that move: for all values of a parameter, such as the time, in a range.
//!
//! Enclosures over the whole range are too wide for most motions, such as turns. So domains are
//! found at some values. Then the surfaces are proven to lie near these for each part of the range.
//! If a part has no proof, the finding says so. Nothing here knows pictures or their number.

use super::{AutoDomain, Finding, Reach, cell_search, find_while, grown, reach, share, tighten};
use crate::program::{Program, ProgramError};
use std::cell::Cell as Counter;
use zeroset_interval::Interval;
use zeroset_space::Cell;

/// Number of parts of the range at whose ends domains are found.
const PARTS: u32 = 16;

/// Number of further values, if there is no proof. They are multiples of the golden ratio: evenly
/// spaced values may all be at one point of the period of a motion.
const MORE: u32 = 48;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A part may extend the domain by the share `ALLOWED` of its extent on each side. A part that
/// needs more is halved up to `HALVINGS` times. Then it may extend the domain by `FARTHEST`.
const ALLOWED: f64 = 0.1;
const HALVINGS: u32 = 5;
const FARTHEST: f64 = 3.0;

/// Largest number of evaluations for the proofs of all parts.
const WORK: u64 = 1_600_000;

/// A parameter that moves, and its range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// The parameter's place in the list of parameters.
    pub parameter: usize,
    /// All values that it takes.
    pub range: Interval,
}

impl Motion {
    /// `program` for the values between two shares of the range, which are from 0 to 1.
    fn part(&self, program: &Program, [from, to]: [f64; 2]) -> Program {
        let Interval { lo, hi } = self.range;
        let at = |share: f64| (lo * (1.0 - share) + hi * share).clamp(lo, hi);
        program.during(self.parameter, Interval { lo: at(from), hi: at(to) })
    }
}

/// Chooses a domain for all values of a motion. If the surfaces are bounded at the values that are
/// tried, all of them lie in the domain at all values, unless the finding is
/// [`Finding::BoundedAtTimes`]. The result is `None` once `wanted` returns false.
///
/// # Errors
/// If a kernel cannot be compiled.
pub(crate) fn find_moving(
    program: &Program,
    motion: Motion,
    is_stretched: bool,
    wanted: &dyn Fn() -> bool,
) -> Result<Option<AutoDomain>, ProgramError> {
    let sampled = |shares: &mut dyn Iterator<Item = f64>| -> Result<_, ProgramError> {
        let mut whole: Option<AutoDomain> = None;
        for share in shares {
            let now = motion.part(program, [share; 2]);
            let Some(found) = find_while(&now, is_stretched, wanted)? else { return Ok(None) };
            whole = Some(whole.map_or(found, |whole| whole.hull(found)));
        }
        Ok(whole)
    };
    let even = |n: u32| f64::from(n) / f64::from(PARTS);
    let Some(mut whole) = sampled(&mut (0..=PARTS).map(even))? else { return Ok(None) };
    if !whole.finding.is_bounded() && !whole.finding.is_empty() {
        return Ok(Some(whole));
    }
    let proof = Proof {
        start: (!whole.finding.is_empty()).then_some(Cell { low: whole.low, high: whole.high }),
        work: Counter::new(share(program, WORK)),
        wanted,
    };
    let (cell, finding) = proof.over_parts(program, motion)?;
    if let Some(cell) = cell.filter(|cell| proof.start != Some(*cell)) {
        let cell = grown(&cell, 0.0);
        (whole.low, whole.high) = (cell.low, cell.high);
    }
    whole.finding = whole.finding.max(finding);
    if finding == Finding::BoundedAtTimes {
        let golden = |n: u32| (f64::from(n) * GOLDEN).fract();
        let Some(more) = sampled(&mut (1..=MORE).map(golden))? else { return Ok(None) };
        whole = whole.hull(more);
    }
    Ok(wanted().then_some(whole))
}

/// A proof that surfaces stay in a box while they move.
struct Proof<'a> {
    /// The box that holds them at some values. `None` if they are empty there.
    start: Option<Cell>,
    /// Number of evaluations left.
    work: Counter<u64>,
    wanted: &'a dyn Fn() -> bool,
}

impl Proof<'_> {
    /// A box that holds the surfaces at all values for which that can be proven.
    fn over_parts(
        &self,
        program: &Program,
        motion: Motion,
    ) -> Result<(Option<Cell>, Finding), ProgramError> {
        let (mut whole, mut finding) = (self.start, Finding::Empty);
        let share = |n: u32| f64::from(n) / f64::from(PARTS);
        let first = |n: u32| Part { ends: [n, n + 1].map(share), halvings: 0, known: None };
        let mut open: Vec<Part> = (0..PARTS).map(first).collect();
        while let Some(part) = open.pop() {
            let (is_last, is_over) = (part.halvings == HALVINGS, self.work.get() == 0);
            let room = if is_last && !is_over { FARTHEST } else { ALLOWED };
            let found = self.extent(&motion.part(program, part.ends), part.known)?;
            match found {
                Some(Extent { cell, bounded, .. }) if self.is_near(whole, cell, room) => {
                    whole =
                        whole.zip(cell).map(|(one, other)| one.around(&other)).or(whole).or(cell);
                    finding = finding.max(bounded);
                }
                _ if is_last || is_over => return Ok((whole, Finding::BoundedAtTimes)),
                found => open.extend(part.halves(found)),
            }
        }
        Ok((whole, finding))
    }

    /// Returns whether a box is in `whole`, or in the box at the start with the share `room` of its
    /// extent on each side. So many small extensions do not add up. Without a box at the start,
    /// every box is near. So is the box of an empty surface.
    fn is_near(&self, whole: Option<Cell>, cell: Option<Cell>, room: f64) -> bool {
        let Some(((whole, cell), start)) = whole.zip(cell).zip(self.start) else { return true };
        (0..3).all(|axis| {
            let room = room * start.extent(axis);
            let (low, high) = (start.low[axis] - room, start.high[axis] + room);
            whole.low[axis].min(low) <= cell.low[axis]
                && cell.high[axis] <= whole.high[axis].max(high)
        })
    }

    /// The proven extent of the surfaces. All of them are in `known`. `None` without a proof.
    fn extent(
        &self,
        program: &Program,
        known: Option<Extent>,
    ) -> Result<Option<Extent>, ProgramError> {
        let Some(mut search) = cell_search(program, self.wanted)? else { return Ok(None) };
        let left = search.work.get().min(self.work.get());
        search.work.set(left);
        let reach = match known {
            Some(Extent { cell: Some(cell), bounded, empty }) => {
                Reach::Within(cell, [bounded, empty])
            }
            Some(Extent { cell: None, .. }) => Reach::Empty,
            None => reach(program, &search),
        };
        let found = match reach {
            Reach::Empty => {
                Some(Extent { cell: None, bounded: Finding::Empty, empty: Finding::Empty })
            }
            Reach::Open(_) => None,
            Reach::Within(whole, [bounded, empty]) => {
                let cell = tighten(program, &mut search, whole)?;
                let bounded = if cell.is_some() { bounded } else { empty };
                Some(Extent { cell, bounded, empty })
            }
        };
        self.work.set(self.work.get() - left + search.work.get());
        Ok(found.filter(|_| search.is_wanted()))
    }
}

/// The proven extent of surfaces for a part of a motion.
#[derive(Clone, Copy)]
struct Extent {
    /// A box that holds them. `None` if they are empty.
    cell: Option<Cell>,
    /// The finding.
    bounded: Finding,
    /// The finding if a part of the part has no surface in the box.
    empty: Finding,
}

/// A part of a motion.
struct Part {
    /// Its ends, as shares of the range.
    ends: [f64; 2],
    /// Number of times that the range was halved.
    halvings: u32,
    /// The proven extent for a larger part.
    known: Option<Extent>,
}

impl Part {
    /// Both halves of the part, of which `known` is proven.
    fn halves(self, known: Option<Extent>) -> [Self; 2] {
        let ([from, to], halvings) = (self.ends, self.halvings + 1);
        let middle = from.midpoint(to);
        [[from, middle], [middle, to]].map(|ends| Self { ends, halvings, known })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::found;
    use super::*;

    /// Solids that turn, swing and appear, with the exact ends of the box that they sweep.
    #[test]
    fn a_domain_holds_a_solid_at_all_times_and_is_not_much_larger() {
        let [far, corner] = [1.25_f64.sqrt(), 1.3_f64.hypot(0.3)];
        let ring = "p = (x cos(t) + z sin(t), y, z cos(t) - x sin(t)); \
                    length((length(p.xz) - 1, p.y)) = 0.3";
        let tilted = "u = x cos(t) - z sin(t); w = z cos(t) + x sin(t); c = cos(0.7); \
                      s = sin(0.7); max(abs(u*c - y*s), abs(y*c + u*s), abs(w)) <= 0.5";
        let upright = 0.5 * (0.7_f64.cos() + 0.7_f64.sin());
        let across = upright.hypot(0.5);
        for (text, until, low, high) in [
            ("rotate(box(1,0.5,0.3), t) <= 0", 3.0, [-far, -far, -0.3], [far, far, 0.3]),
            ("rotate(box(1,0.5,0.3), t) <= 0", 100.0, [-far, -far, -0.3], [far, far, 0.3]),
            ("rotate(torus(1,0.3), t, (1,0,0)) <= 0", 3.0, [-1.3; 3], [1.3; 3]),
            ("rotate(sphere(0.5,(1,0,0)), t) <= 0", 3.0, [-1.49, -0.5, -0.5], [1.5, 1.5, 0.5]),
            (
                "rotate(translate(box(0.3),1,0,0), 2*t) <= 0",
                3.0,
                [-corner, -corner, -0.3],
                [corner, corner, 0.3],
            ),
            (ring, 3.0, [-1.3, -0.3, -1.3], [1.3, 0.3, 1.3]),
            (tilted, 3.0, [-across, -upright, -across], [across, upright, across]),
            ("(x-sin(7t))^2+y^2+z^2 = 1", 10.0, [-2.0, -1.0, -1.0], [2.0, 1.0, 1.0]),
            ("x^2+y^2+z^2 = sin(8pi*t)", 4.0, [-1.0; 3], [1.0; 3]),
        ] {
            let found = found(&format!("t = 0 in [0, {until}]; {text}"));
            // Sixteen turns are too many for a proof.
            assert_eq!(found.finding.is_bounded(), until < 99.0, "{text} until {until}: {found:?}");
            for axis in 0..3 {
                let room = 0.6 * (high[axis] - low[axis]);
                let is_low = (low[axis] - room..=low[axis]).contains(&found.low[axis]);
                let is_high = (high[axis]..=high[axis] + room).contains(&found.high[axis]);
                assert!(is_low && is_high, "{text} until {until}: {found:?}");
            }
        }
    }

    /// A sphere that is bounded at all times tried, but for an instant between them.
    #[test]
    fn bounded_is_said_only_of_what_is_bounded_at_all_times() {
        let found = found("t = 0 in [0, 1]; (x^2+y^2+z^2)*(t-0.52)^2 = 1");
        assert_eq!(found.finding, Finding::BoundedAtTimes, "{found:?}");
        assert!(!found.finding.is_bounded());
    }
}
