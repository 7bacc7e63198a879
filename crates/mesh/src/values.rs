//! The values at the corners of a grid that define the function g: see [`proof`].
//!
//! [`proof`]: crate::proof

use crate::cells::PartBounds;
use crate::grid::{Corner, Grid};
use crate::leaf::{Kind, Leaf};
use crate::proof::MOVED;
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use zeroset_scene::choices::Level;

/// Greatest distance by which values of parts are moved away from 0, as a share of the greatest
/// value at a corner of each leaf around. Zeros move by less than the proof of distances allows.
const APART: f64 = 0.9 * MOVED;

/// Largest rounding of a quotient of a value and a factor, as a share.
const ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Values of parts at corners, by the corners' numbers.
#[derive(Default)]
pub struct CornerValues(Vec<SmallVec<[CornerValue; 1]>>);

/// The value of a part at a corner.
#[derive(Clone, Copy)]
struct CornerValue {
    part: u16,
    /// The sampled value.
    sample: f64,
    /// The value of g, which is not too near 0.
    value: f64,
}

impl CornerValues {
    /// The value of g's part at a corner.
    ///
    /// # Panics
    /// If it has not been sampled.
    pub fn at(&self, corner: u32, part: u16) -> f64 {
        self.0[corner as usize].iter().find(|one| one.part == part).expect("a sample").value
    }

    /// The value of f's part at a corner, with g's sign.
    ///
    /// # Panics
    /// If it has not been sampled.
    pub fn sample(&self, corner: u32, part: u16) -> f64 {
        self.0[corner as usize].iter().find(|one| one.part == part).expect("a sample").sample
    }

    /// Makes room for the values at this many corners.
    pub fn resize(&mut self, corners: usize) {
        self.0.resize(corners, SmallVec::new());
    }

    /// Makes room for the value of a part at a corner. Returns false if there is one.
    pub fn reserve(&mut self, corner: u32, part: u16) -> bool {
        let all = &mut self.0[corner as usize];
        let is_new = all.iter().all(|one| one.part != part);
        if is_new {
            all.push(CornerValue { part, sample: f64::NAN, value: f64::NAN });
        }
        is_new
    }

    /// Sets a sampled value of a part, for which there is room.
    pub fn set(&mut self, corner: u32, part: u16, value: f64) {
        let mut all = self.0[corner as usize].iter_mut();
        let room = all.find(|one| one.part == part).expect("room");
        *room = CornerValue { part, sample: value, value };
    }

    /// Computes g's values from samples. At corners of leaves with several parts, each value is
    /// moved away from 0 by its own share of the values around. So no zero is at a corner. And the
    /// zeros of parts differ, even of symmetric parts, which are equal on whole planes of the grid.
    /// `moves` has, for some corners, the number of times that other shares were requested.
    ///
    /// Returns, for each corner, whether a value changed since the last time.
    pub fn move_apart(
        &mut self,
        leaves: &[Leaf],
        levels: &[Level],
        grid: &Grid,
        moves: &FxHashMap<u32, u64>,
    ) -> Vec<bool> {
        let mut largest: Vec<SmallVec<[f64; 1]>> =
            self.0.iter().map(|all| smallvec![f64::INFINITY; all.len()]).collect();
        let mut has_several = vec![false; self.0.len()];
        for leaf in leaves {
            let Kind::Open { local, .. } = &leaf.kind else { continue };
            let group = |part: &PartBounds| levels[usize::from(part.part)].group;
            let is_mixed = local.parts.windows(2).any(|two| group(&two[0]) != group(&two[1]));
            for PartBounds { part, .. } in &local.parts {
                let corners = leaf.cell.numbers.map(|corner| {
                    let all = &self.0[corner as usize];
                    (corner, all.iter().position(|one| one.part == *part).expect("a sample"))
                });
                let size = |(corner, k): (u32, usize)| self.0[corner as usize][k].sample.abs();
                let most = corners.map(size).into_iter().fold(0.0, f64::max);
                for (corner, k) in corners {
                    let largest = &mut largest[corner as usize][k];
                    *largest = largest.min(most);
                    has_several[corner as usize] |= is_mixed;
                }
            }
        }
        let moved = |(number, all): (usize, &mut SmallVec<[CornerValue; 1]>)| {
            let times = moves.get(&(number as u32)).copied().unwrap_or_default();
            let mut changes = false;
            let level = |part: u16| levels[usize::from(part)];
            let parts: SmallVec<[u16; 4]> = all.iter().map(|one| one.part).collect();
            for one in all {
                // Levels of one function keep their order, since all of them move by one share of
                // one value.
                let (mut first, mut largest_of_group) = (one.part, f64::INFINITY);
                for (part, largest) in parts.iter().zip(&largest[number]) {
                    if level(*part).group == level(one.part).group {
                        let scale = (level(one.part).factor / level(*part).factor).abs();
                        largest_of_group = largest_of_group.min(scale * largest);
                        first = first.min(*part);
                    }
                }
                let largest = largest_of_group;
                let chance = chance(grid.corners[number], first, times);
                let by = 0.5 * APART * largest * (1.0 + chance);
                let is_moved = has_several[number] && by.is_finite();
                let by = if is_moved { by.copysign(one.sample) } else { 0.0 };
                changes |= one.sample + by != one.value;
                one.value = one.sample + by;
            }
            changes
        };
        self.0.iter_mut().enumerate().map(moved).collect()
    }
}

/// Returns whether values at the corners of a tetrahedron are proven to have the order of their
/// parts' levels. Then no two linear functions with these values are 0 at one point, if their parts
/// are levels of one function.
pub fn keep_order(values: &[(u16, [f64; 4])], levels: &[Level]) -> bool {
    let level = |part: u16| levels[usize::from(part)];
    values.iter().enumerate().all(|(k, (part, own))| {
        values[..k].iter().all(|(other, of_other)| {
            let (one, other) = (level(*part), level(*other));
            let is_in_order = |(own, of_other): (&f64, &f64)| {
                let (own, of_other) = (own / one.factor, of_other / other.factor);
                let rise = if one.rank < other.rank { own - of_other } else { of_other - own };
                // False for NaN.
                rise > ROUNDING * (own.abs() + of_other.abs())
            };
            one.group != other.group || own.iter().zip(of_other).all(is_in_order)
        })
    })
}

/// A pseudorandom number between 0 and 1, determined by the arguments.
fn chance(corner: Corner, part: u16, times: u64) -> f64 {
    // The steps of the generator SplitMix64.
    let mix = |value: u64| {
        let value = (value ^ value >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        value ^ value >> 31
    };
    let [x, y, z] = corner.coordinates().map(u64::from);
    let number = [x, y, z, u64::from(part), times]
        .into_iter()
        .fold(0, |all: u64, next| mix(all.wrapping_add(next).wrapping_add(0x9e37_79b9_7f4a_7c15)));
    number as f64 / u64::MAX as f64
}
