//! The sides of the rectangle of u and v: which of them are glued, and which are one point.

use super::{PARTS, Place, parameter};
use glam::DVec3;
use zeroset_eval::LANES;
use zeroset_space::PatchTree;

/// Points agree if they are nearer than this share of the surface's size. Sides that agree by their
/// formula differ by rounding alone.
const SAME: f64 = 1e-12;
/// Number of parts of a side whose ends are compared. Sides may be moved along each other by so
/// many parts.
const POINTS: usize = 96;

/// Two directions are opposite if the cosine of their angle is below this, times −1.
const OPPOSITE: f64 = 0.9;

/// The points of a side agree with those of a side of the same axis, perhaps of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Glue {
    /// The axis on which the sides lie at an end.
    axis: usize,
    /// The ends, 0 or [`PARTS`].
    ends: [u32; 2],
    /// True if one side runs along the other in the opposite direction.
    is_turned: bool,
    /// How far one side is moved along the other, around its end.
    shift: u32,
}

/// The sides at the ends of u and at the ends of v.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Sides {
    glued: Vec<Glue>,
    /// Axis and end of each side that is one point.
    points: Vec<(usize, u32)>,
}

impl Sides {
    /// Largest distance by which gluing moves a vertex of a surface of this size.
    pub fn moved(size: f64) -> f64 {
        SAME * size
    }

    /// Compares points of the sides of a surface of this size.
    pub fn find(tree: &PatchTree, size: f64) -> Self {
        let is_same = |one: DVec3, other: DVec3| one.distance(other) <= SAME * size;
        let all_same = |one: &[DVec3], other: &[DVec3], glue: &Glue| {
            (0..=POINTS).all(|k| is_same(one[k], other[glue.number(k)]))
        };
        let lines = [0, 1].map(|axis| [0, PARTS].map(|end| line(tree, axis, end)));
        // Whether a side begins where it ends, for each axis.
        let is_round = |axis: usize| {
            let straight = Glue::of(1 - axis, [0, PARTS], false, 0);
            all_same(&lines[1 - axis][0], &lines[1 - axis][1], &straight)
        };
        let mut sides = Self::default();
        for (axis, own) in lines.iter().enumerate() {
            for (end, points) in [0, PARTS].into_iter().zip(own) {
                if points.iter().all(|point| is_same(*point, points[0])) {
                    sides.points.push((axis, end));
                }
            }
            let shifts = if is_round(axis) { POINTS } else { 1 };
            let ways = |ends: [u32; 2]| {
                (0..shifts).flat_map(move |shift| {
                    [false, true].map(|is_turned| Glue::of(axis, ends, is_turned, shift))
                })
            };
            let of = |end: u32| &own[usize::from(end == PARTS)];
            let agrees = |glue: &Glue| all_same(of(glue.ends[0]), of(glue.ends[1]), glue);
            if let Some(glue) = ways([0, PARTS]).find(agrees) {
                sides.glued.push(glue);
                continue;
            }
            for end in [0, PARTS].into_iter().filter(|end| !sides.points.contains(&(axis, *end))) {
                // The surface goes on across the side if it comes from opposite directions.
                let beside = line(tree, axis, if end == 0 { STEP } else { PARTS - STEP });
                let inward: Vec<DVec3> =
                    beside.iter().zip(of(end)).map(|(beside, at)| *beside - *at).collect();
                let along = |glue: &Glue| -> f64 {
                    (0..=POINTS).map(|k| inward[k].dot(inward[glue.number(k)])).sum()
                };
                let limit = -OPPOSITE * inward.iter().map(|way| way.length_squared()).sum::<f64>();
                let found = ways([end; 2]).filter(|glue| !glue.is_nothing() && agrees(glue));
                let found = found.map(|glue| (along(&glue), glue));
                let best = found.min_by(|(one, _), (other, _)| one.total_cmp(other));
                sides.glued.extend(best.filter(|(along, _)| *along < limit).map(|(_, glue)| glue));
            }
        }
        sides
    }

    /// The place that stands for all that are the same point.
    pub fn first(&self, place: Place) -> Place {
        self.copies(place).into_iter().min().unwrap_or(place)
    }

    /// All places that are the same point. A side that is one point counts by its ends alone.
    pub fn copies(&self, place: Place) -> Vec<Place> {
        let mut all = vec![place];
        let mut next = 0;
        while let Some(&place) = all.get(next) {
            next += 1;
            let glued = self.glued.iter().flat_map(|glue| glue.others(place));
            let at_point = |(axis, end): &&(usize, u32)| place[*axis] == *end;
            let ends = self.points.iter().filter(at_point);
            let ends = ends.flat_map(|&(axis, end)| [0, PARTS].map(|along| at(axis, end, along)));
            for other in glued.chain(ends) {
                if !all.contains(&other) {
                    all.push(other);
                }
            }
        }
        all
    }
}

/// Distance of the points at which sides are compared.
const STEP: u32 = PARTS / POINTS as u32;

/// The place at an end of an axis, and `along` the other.
fn at(axis: usize, end: u32, along: u32) -> Place {
    if axis == 0 { [end, along] } else { [along, end] }
}

impl Glue {
    /// `shift` is a number of parts.
    fn of(axis: usize, ends: [u32; 2], is_turned: bool, shift: usize) -> Self {
        Self { axis, ends, is_turned, shift: STEP * shift as u32 }
    }

    /// Returns whether each point would be glued to itself.
    fn is_nothing(&self) -> bool {
        self.ends[0] == self.ends[1] && !self.is_turned && self.shift == 0
    }

    /// The number of the point on the second side that agrees with point `k` of the first.
    fn number(&self, k: usize) -> usize {
        (self.along(STEP * k as u32) / STEP) as usize
    }

    /// The place along the second side for one along the first.
    fn along(&self, along: u32) -> u32 {
        let along = if self.is_turned { PARTS - along } else { along };
        let moved = along + self.shift;
        if moved > PARTS { moved - PARTS } else { moved }
    }

    /// The place along the first side for one along the second.
    fn back(&self, along: u32) -> u32 {
        let moved = if along < self.shift { along + PARTS } else { along } - self.shift;
        if self.is_turned { PARTS - moved } else { moved }
    }

    /// The places that are glued to a place.
    fn others(self, place: Place) -> impl Iterator<Item = Place> {
        let (end, along) = (place[self.axis], place[1 - self.axis]);
        let [first, second] = self.ends;
        let forth = (end == first).then(|| at(self.axis, second, self.along(along)));
        let back = (end == second).then(|| at(self.axis, first, self.back(along)));
        forth.into_iter().chain(back)
    }
}

/// Points at equal distances along the line at a place of an axis.
fn line(tree: &PatchTree, axis: usize, place: u32) -> Vec<DVec3> {
    let here = parameter(tree, axis, place);
    let cell = |k: usize| {
        let along = parameter(tree, 1 - axis, STEP * k as u32);
        let (here, along) = ([here, here], [along, along]);
        if axis == 0 { [here, along] } else { [along, here] }
    };
    let cells: Vec<_> = (0..=POINTS).map(cell).collect();
    let points = cells.chunks(LANES).flat_map(|some| {
        let found = tree.over(some);
        let point = |lane: usize| DVec3::from_array([0, 1, 2].map(|axis| found.centre[axis][lane]));
        (0..some.len()).map(point).collect::<Vec<_>>()
    });
    points.collect()
}
