//! A bound of the distance between mesh and surface, where tetrahedra are too large for the bound
//! of [`proof`](crate::proof): triangle by triangle.
//!
//! `docs/meshes.md` has the argument, in "The distance".

use crate::cells::{Enclosure, PartBounds, PartKernels, Query, Side, enclosures};
use crate::extract::Extracted;
use crate::index::{Bounds, Index};
use crate::leaf::{Kind, Leaf, Nearness};
use crate::proof::{MARGIN, least_slope, middle};
use crate::refine::Refined;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use zeroset_eval::LANES;
use zeroset_interval::Interval;

/// The distance that is proven for whole tetrahedra, in allowed distances.
pub const LOOSE: f64 = 4.0;
/// Width of the space around a triangle in which gradients are bounded, in such distances.
const AROUND: f64 = 2.0;
/// Largest distance of a gradient from their middle there, as a share of the middle: two gradients
/// are then at an angle below 45 degrees.
const SPREAD: f64 = 0.38;
/// Largest distance from the surface that a triangle may have, as a share of the allowed distance:
/// where it is large, more of its edges can be removed.
const SHARE: f64 = 0.7;
/// Share of leaves below which none stays loose.
const FEW: f64 = 0.3;
/// Number of parts into which a triangle's edges are divided.
const PARTS: usize = 4;

/// The part whose zeros are the surface around a place, and the side on which the function is above
/// 0.
type Only = (u16, Side);

/// Returns whether a tetrahedron with some bounds, of a size in world units, may be
/// [`Nearness::Loose`]. Not if gradients around it seem to differ too much for the proof.
pub fn may_be_loose(query: &Query<'_>, parts: &[PartBounds], size: f64, distance: f64) -> bool {
    let wider = 1.0 + 2.0 * AROUND * LOOSE * distance / size;
    let gradient = only(query, parts).and_then(|_| parts[0].gradient);
    gradient
        .is_some_and(|gradient| spread(&gradient) * wider <= SPREAD * middle(&gradient).length())
}

/// Largest distance of a gradient from the middle of its bounds.
fn spread(gradient: &[Interval; 3]) -> f64 {
    0.5 * DVec3::from_array(gradient.map(|along| along.hi - along.lo)).length() * (1.0 + MARGIN)
}

fn only(query: &Query<'_>, parts: &[PartBounds]) -> Option<Only> {
    let [part] = parts else { return None };
    let is_surface = usize::from(part.part) < query.first_cut && query.estimated == 0.0;
    let is_sided = matches!(part.side, Side::Above | Side::Below);
    (is_surface && is_sided && part.gradient.is_some()).then_some((part.part, part.side))
}

/// Loose leaves in which mesh and surface are not proven to be within the allowed distance.
#[derive(Default)]
pub struct Far {
    /// Leaves with such a triangle: it may be near if they are split.
    pub large: Vec<usize>,
    /// Leaves near which something else prevents the proof.
    pub strict: Vec<usize>,
}

impl Far {
    pub fn is_empty(&self) -> bool {
        self.large.is_empty() && self.strict.is_empty()
    }
}

/// The loose leaves with one part.
struct Group {
    only: Only,
    leaves: Vec<usize>,
    /// Their boxes, wider by the reach.
    index: Index,
}

/// The [loose](Nearness::Loose) leaves of a grid.
pub struct Loose<'a> {
    refined: &'a Refined,
    query: &'a Query<'a>,
    distance: f64,
    /// Width of the space around a triangle in which gradients are bounded, in world units.
    reach: f64,
    /// For each leaf, the only part that matters in it.
    only: Vec<Option<Only>>,
    groups: Vec<Group>,
}

impl<'a> Loose<'a> {
    pub fn new(refined: &'a Refined, query: &'a Query<'a>, distance: f64) -> Self {
        let only = |leaf: &Leaf| match &leaf.kind {
            Kind::Open { local, .. } => only(query, &local.parts),
            Kind::Inside(_) => None,
        };
        let only: Vec<Option<Only>> = refined.leaves.iter().map(only).collect();
        let mut of: FxHashMap<Only, Vec<usize>> = FxHashMap::default();
        for (number, (leaf, only)) in refined.leaves.iter().zip(&only).enumerate() {
            if let (Kind::Open { near: Nearness::Loose, .. }, Some(only)) = (&leaf.kind, only) {
                of.entry(*only).or_default().push(number);
            }
        }
        let reach = AROUND * LOOSE * distance;
        let mut all = Self { refined, query, distance, reach, only, groups: Vec::new() };
        let group = |(only, leaves): (Only, Vec<usize>)| {
            let boxes = leaves.iter().zip(0..).map(|(leaf, k)| {
                let [low, high] = all.ends(*leaf);
                (k, query.space.units([low - reach, high + reach]))
            });
            let index = Index::new(leaves.len(), &boxes.collect::<Vec<_>>());
            Group { only, leaves, index }
        };
        all.groups = of.into_iter().map(group).collect();
        all
    }

    fn ends(&self, leaf: usize) -> [DVec3; 2] {
        let [x, y, z] = self.query.space.between(self.refined.leaves[leaf].cell.bounds());
        [DVec3::new(x.lo, y.lo, z.lo), DVec3::new(x.hi, y.hi, z.hi)]
    }

    /// The loose leaves near a box, but for those with the part `but`.
    fn around(&self, bounds: &Bounds, but: Option<Only>, found: &mut FxHashSet<usize>) {
        for group in self.groups.iter().filter(|group| Some(group.only) != but) {
            group.index.all_near(bounds, &mut |k| {
                found.insert(group.leaves[k as usize]);
                true
            });
        }
    }

    /// Finds the loose leaves near leaves with another part, or with several. If few leaves are
    /// loose, finds them all, since the proof for triangles would take more time than it saves.
    pub fn mixed(&self) -> Vec<usize> {
        let mut found = FxHashSet::default();
        let loose = self.groups.iter().flat_map(|group| &group.leaves);
        if (loose.clone().count() as f64) < FEW * self.only.len() as f64 {
            return loose.copied().collect();
        }
        for (leaf, only) in self.only.iter().enumerate() {
            self.around(&self.query.space.units(self.ends(leaf)), *only, &mut found);
        }
        sorted(found)
    }

    /// Finds the loose leaves that are not proven to be near the triangles of a mesh. None must be
    /// [mixed](Self::mixed).
    pub fn far(&self, mesh: &Extracted) -> Far {
        let (mut large, mut strict) = (FxHashSet::default(), FxHashSet::default());
        let corners = |number: usize| mesh.triangles[number].map(|k| mesh.vertices[k as usize]);
        let units = |number: usize| {
            let [a, b, c] = corners(number);
            self.query.space.units([a.min(b).min(c), a.max(b).max(c)])
        };
        for Group { only, index, .. } in &self.groups {
            let is_asked = |number: &usize| {
                self.only[mesh.leaves[*number]] == Some(*only)
                    && !index.all_near(&units(*number), &mut |_| false)
            };
            let asked: Vec<usize> =
                (0..mesh.triangles.len()).into_par_iter().filter(is_asked).collect();
            let far = |some: &[usize]| -> SmallVec<[usize; LANES]> {
                let triangles = some.iter().map(|number| corners(*number));
                let near = self.are_near(&triangles.collect::<Vec<_>>(), *only);
                let numbered = some.iter().zip(near);
                numbered.filter(|(_, is_near)| !is_near).map(|(number, _)| *number).collect()
            };
            let far: Vec<usize> = asked.par_chunks(LANES / 2).flat_map_iter(far).collect();
            for number in far {
                let leaf = mesh.leaves[number];
                let kind = &self.refined.leaves[leaf].kind;
                if matches!(kind, Kind::Open { near: Nearness::Loose, .. }) {
                    large.insert(leaf);
                } else {
                    self.around(&units(number), None, &mut strict);
                }
            }
        }
        large.retain(|leaf| !strict.contains(leaf));
        Far { large: sorted(large), strict: sorted(strict) }
    }

    /// For each of some triangles, at most half of [`LANES`], returns whether it is proven to be
    /// near the zeros of a part.
    fn are_near(&self, triangles: &[[DVec3; 3]], (part, side): Only) -> SmallVec<[bool; LANES]> {
        let kernels = &self.query.parts[usize::from(part)];
        let boxes = triangles.iter().flat_map(|[a, b, c]| {
            let (low, high) = (a.min(*b).min(*c), a.max(*b).max(*c));
            let wide = [low - self.reach, high + self.reach];
            let [own, around] = [[low, high], wide].map(interval_box);
            // Nothing is bounded outside of the domain.
            [own, if self.query.space.holds(&around) { around } else { own }]
        });
        let boxes: SmallVec<[[Interval; 3]; LANES]> = boxes.collect();
        let gradients: SmallVec<[Option<[Interval; 3]>; LANES]> =
            enclosures(kernels, &boxes).map(|Enclosure { gradient, .. }| gradient).collect();
        let of = |(corners, k): (&[DVec3; 3], usize)| {
            let [own, around] = [gradients[2 * k]?, gradients[2 * k + 1]?];
            if boxes[2 * k] == boxes[2 * k + 1] {
                return None;
            }
            let slope = slope_along(&around)?;
            let [a, b, c] = *corners;
            let normal = (b - a).cross(c - a);
            let out = if side == Side::Below { -normal } else { normal };
            if least_slope(&around, out).0 <= 0.0 {
                return None;
            }
            let most = most_off(kernels, corners, &own);
            (most <= SHARE * self.distance * slope).then_some(())
        };
        triangles.iter().zip(0..).map(|one| of(one).is_some()).collect()
    }
}

fn sorted(found: FxHashSet<usize>) -> Vec<usize> {
    let mut all: Vec<usize> = found.into_iter().collect();
    all.sort_unstable();
    all
}

/// The least slope of a function along each vector that its gradient may be, if the gradient is
/// within bounds. `None` if it is not positive, or two gradients may be at an angle of 45 degrees.
fn slope_along(gradient: &[Interval; 3]) -> Option<f64> {
    let (length, spread) = (middle(gradient).length(), spread(gradient));
    // A gradient is at most `spread` from the middle. So is the component of another one along it.
    let slope = (length * length - spread * spread).sqrt() - spread - MARGIN * length;
    // False for NaN.
    (spread <= SPREAD * length && slope > 0.0).then_some(slope)
}

/// A bound of |f| in a triangle: the largest value at some points, and half of the difference that
/// the gradient allows between neighbors.
fn most_off(kernels: &PartKernels<'_>, [a, b, c]: &[DVec3; 3], gradient: &[Interval; 3]) -> f64 {
    let points = (0..=PARTS).flat_map(|i| (0..=PARTS - i).map(move |j| (i, j)));
    let at = |(i, j): (usize, usize)| {
        let [i, j] = [i, j].map(|count| count as f64 / PARTS as f64);
        let point = a + i * (b - a) + j * (c - a);
        interval_box([point, point])
    };
    let points: SmallVec<[[Interval; 3]; LANES]> = points.map(at).collect();
    let largest = |Enclosure { value, .. }: Enclosure| value.hi.max(-value.lo);
    let most = enclosures(kernels, &points).map(largest).fold(0.0, f64::max);
    let span = a.max(*b).max(*c) - a.min(*b).min(*c);
    let width = DVec3::from_array(gradient.map(|along| along.hi - along.lo));
    // A mean of distances from a mean is at most half the span, and a gradient differs by at most
    // half of the width from the middle.
    most + 0.25 * width.dot(span) / PARTS as f64 * (1.0 + MARGIN)
}

fn interval_box([low, high]: [DVec3; 2]) -> [Interval; 3] {
    [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] })
}
