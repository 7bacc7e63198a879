//! A change of a few triangles, and the proof that it keeps the shape.
//!
//! A vertex moves along a straight line, and another one may become one with it. Seen along some
//! direction, all triangles turn to the left before and after, and so they do on the way, since
//! their areas change evenly. They are in one layer as seen: around the vertex they turn once, or
//! less than once on a rim. So the old and the new triangles, and all on the way, are graphs. No
//! other triangle meets the space that they sweep. So nothing passes through anything.
//!
//! At some corners, triangles are graphs along no direction. There a vertex may move alone: around
//! it is a closed curve, and each edge of the curve has another triangle outside. These triangles
//! meet no swept space but in shared corners. So no two points of the curve are ever in the same
//! direction from the vertex, and the triangles around the vertex do not meet on the way.

#[cfg(test)]
mod tests;

use crate::index::Bounds;
use crate::simplify::apart::{Corners as Apart, are_apart, are_beside_plane, cross};
use crate::simplify::distance::distance_to;
use crate::simplify::projection::{Direction, Seen, area, volume};
use crate::simplify::triangulation::{Edges, Few, Triangulation, facing};
use crate::simplify::view::{
    Sides, View, are_beside, ends_stay_apart, is_on_side, turned_left, turns, turns_left,
};
use glam::{DVec3, I64Vec3};
use smallvec::SmallVec;

/// Least cosine of the angle by which a triangle may turn.
const TURN: f64 = 0.5;

/// A cosine that is above 0 in spite of rounding. The normals of a triangle that changes evenly are
/// between the first and the last one. So none is 0 if the cosine of their angle is above this.
const ROUNDING: f64 = 1e-12;

/// Number of steps toward a vector that many are along.
const STEPS: usize = 16;

/// Points of new triangles.
#[derive(Default)]
pub struct Samples {
    pub inner: SmallVec<[DVec3; 64]>,
    /// Points on the new rim.
    pub rim: SmallVec<[DVec3; 8]>,
}

/// Shares of a rim's edge.
const ALONG: [f64; 3] = [0.25, 0.5, 0.75];
/// Shares of the two corners that face the moved vertex, for samples of a triangle: on the edge
/// that it shares with the next new triangle, and inside.
const SHARES: [[f64; 2]; 7] = [
    [0.5, 0.0],
    [0.25, 0.0],
    [0.75, 0.0],
    [1.0 / 3.0, 1.0 / 3.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
    [1.0 / 6.0, 1.0 / 6.0],
];

/// A vertex moves, and another one may become one with it.
pub struct Change<'a> {
    mesh: &'a Triangulation,
    keep: u32,
    to: I64Vec3,
    /// The triangles that change.
    old: Few,
    /// For each new triangle, the edge that faces `keep`.
    facing: Edges,
    /// Vertices that move, or are dropped.
    moving: SmallVec<[u32; 2]>,
    /// The ends of the rim around the only vertex that moves, if it is on a rim.
    rim: Option<[u32; 2]>,
}

impl<'a> Change<'a> {
    /// Replaces `drop` by `keep`, which stays where it is. `None` if that would change how
    /// triangles are connected.
    pub fn into_other(mesh: &'a Triangulation, drop: u32, keep: u32) -> Option<Self> {
        let rim = mesh.link(drop)?.rim;
        let along_rim = rim.is_some_and(|ends| ends.contains(&keep));
        let is_possible = if rim.is_some() {
            along_rim && shared(mesh, drop, keep) == 1
        } else {
            shared(mesh, drop, keep) == 2 && !is_tetrahedron(mesh, drop, keep)
        };
        let facing = facing_all(mesh, drop, Some(keep));
        if !is_possible || facing.is_empty() {
            return None;
        }
        let (old, to) = (Few::from_slice(mesh.around(drop)), mesh.place(keep));
        Some(Self { mesh, keep, to, old, facing, moving: [drop].into_iter().collect(), rim })
    }

    /// Moves two vertices to a place, where they are one. `None` if that would change how triangles
    /// are connected, or if one is on a rim.
    pub fn joined(mesh: &'a Triangulation, drop: u32, keep: u32, to: I64Vec3) -> Option<Self> {
        let is_inner = |vertex| mesh.link(vertex).is_some_and(|link| link.rim.is_none());
        if !is_inner(drop) || !is_inner(keep) || shared(mesh, drop, keep) != 2 {
            return None;
        }
        if is_tetrahedron(mesh, drop, keep) {
            return None;
        }
        let mut facing = facing_all(mesh, drop, Some(keep));
        facing.extend(facing_all(mesh, keep, Some(drop)));
        let mut old = Few::from_slice(mesh.around(drop));
        let is_new = |one: &&u32| !mesh.corners(**one).contains(&drop);
        old.extend(mesh.around(keep).iter().filter(is_new).copied());
        let moving = [drop, keep].into_iter().collect();
        Some(Self { mesh, keep, to, old, facing, moving, rim: None })
    }

    /// Moves a vertex.
    pub fn moved(mesh: &'a Triangulation, keep: u32, to: I64Vec3) -> Option<Self> {
        let rim = mesh.link(keep)?.rim;
        let facing = facing_all(mesh, keep, None);
        let old = Few::from_slice(mesh.around(keep));
        Some(Self { mesh, keep, to, old, facing, moving: [keep].into_iter().collect(), rim })
    }

    /// Returns whether the shape is proven to stay, and the new triangles are near the surface.
    /// `near` is asked for some of their points, unless old and new triangles are the same set of
    /// points. No vertex strays by more than `most` units. Triangles whose height is less than
    /// `thin` units may turn.
    pub fn is_proven(&self, most: f64, thin: f64, near: &dyn Fn(&Samples) -> bool) -> bool {
        if self.turns(thin) || self.strays(most) {
            return false;
        }
        let normals: SmallVec<[DVec3; 16]> =
            self.old.iter().map(|one| normal(self.places(*one))).collect();
        let sum: DVec3 = normals.iter().sum();
        let mut view = View::default();
        let mut is_graph = |vector: DVec3| {
            vector.try_normalize().is_some_and(|vector| {
                Direction::near(vector).any(|direction| self.see(direction, &mut view))
            })
        };
        if is_graph(sum) || is_graph(middle(&normals)) {
            let sides = if self.rim.is_some() { Sides::new() } else { view.sides() };
            (self.rim.is_none() && view.is_same())
                || (near(&self.samples())
                    && self.is_free(|other| self.is_clear(other, &view, &sides)))
        } else {
            self.may_be_no_graph()
                && near(&self.samples())
                && self.is_free(|other| {
                    self.is_apart(other, |triangle, swept| {
                        are_apart(triangle, swept) || are_apart_in_plane(triangle, swept.places)
                    })
                })
        }
    }

    /// Returns whether only one vertex moves, which is in no triangle with an edge of a rim, and
    /// its triangles have an area on the way.
    fn may_be_no_graph(&self) -> bool {
        let keeps_area = |[a, b]: &[u32; 2]| {
            let [a, b] = [a, b].map(|end| self.mesh.place(*end));
            let [old, new] = [self.mesh.place(self.keep), self.to]
                .map(|apex| DVec3::from_array(cross(a - apex, b - apex).map(|along| along as f64)));
            old.dot(new) > ROUNDING * old.length() * new.length()
        };
        self.rim.is_none()
            && self.moving[..] == [self.keep]
            && self
                .facing
                .iter()
                .all(|edge| !self.mesh.is_rim(edge[0], edge[1]) && keeps_area(edge))
    }

    /// The least share of the distance that is allowed at a corner of the triangles.
    pub fn share(&self) -> f64 {
        let all = self.facing.iter().flatten().chain(&self.moving).chain([&self.keep]);
        all.map(|vertex| self.mesh.shares[*vertex as usize]).fold(1.0, f64::min)
    }

    /// A box around old and new triangles.
    pub fn bounds(&self) -> Bounds {
        let ring = self.facing.iter().flatten().chain(&self.moving);
        let corners = self.old.iter().flat_map(|one| self.mesh.corners(*one));
        let all = ring.copied().chain(corners).map(|vertex| self.mesh.place(vertex));
        Bounds::of(all.chain([self.to]))
    }

    fn places(&self, triangle: u32) -> [I64Vec3; 3] {
        self.mesh.corners(triangle).map(|corner| self.mesh.place(corner))
    }

    /// Points of new edges and triangles, in units.
    fn samples(&self) -> Samples {
        let place = |vertex: u32| self.mesh.place(vertex).as_dvec3();
        let to = self.to.as_dvec3();
        let mut all = Samples::default();
        if self.mesh.place(self.keep) != self.to {
            all.inner.push(to);
        }
        for edge in &self.facing {
            let [from, next] = edge.map(place);
            all.inner.extend(SHARES.map(|[a, b]| a * from + b * next + (1.0 - a - b) * to));
        }
        for end in self.rim.into_iter().flatten().filter(|end| *end != self.keep) {
            all.rim.push(to);
            all.rim.extend(ALONG.map(|share| to.lerp(place(end), share)));
        }
        all
    }

    /// Returns whether a triangle would turn by too large an angle.
    fn turns(&self, thin: f64) -> bool {
        let turns = |[a, b]: &[u32; 2]| {
            let has = |one: &&u32| {
                let corners = self.mesh.corners(**one);
                corners.contains(a) && corners.contains(b)
            };
            let Some(old) = self.old.iter().find(has) else { return true };
            let corners = self.places(*old);
            let old = normal(corners);
            // The direction of a thin triangle is a matter of rounding.
            let [p, q, r] = corners.map(|corner| corner.as_dvec3());
            let longest = (q - p).length().max((r - q).length()).max((p - r).length());
            if old.length() <= thin * longest {
                return false;
            }
            let new = normal([self.to, self.mesh.place(*a), self.mesh.place(*b)]);
            old.dot(new) < TURN * old.length() * new.length()
        };
        self.facing.iter().any(turns)
    }

    /// Returns whether a vertex that moves is more than `most` units beside the new triangles, or
    /// beside the new rim.
    fn strays(&self, most: f64) -> bool {
        let place = |vertex: u32| self.mesh.place(vertex).as_dvec3();
        let to = self.to.as_dvec3();
        let new = || self.facing.iter().map(|&[a, b]| [to, place(a), place(b)]);
        self.moving.iter().any(|moving| {
            let from = place(*moving);
            match self.rim {
                Some([first, last]) => {
                    let rim = [[to, place(first), place(first)], [to, place(last), place(last)]];
                    rim.iter().all(|side| distance_to(from, side) > most)
                }
                None => new().all(|triangle| distance_to(from, &triangle) > most),
            }
        })
    }

    /// Sees the triangles along a direction. Returns whether they are proven to be graphs.
    fn see(&self, direction: Direction, view: &mut View) -> bool {
        view.direction = direction;
        let see = |vertex: &u32| direction.see(self.mesh.place(*vertex));
        let apex = direction.see(self.to);
        view.apex = apex;
        view.old.clear();
        view.old.extend(self.old.iter().map(|one| self.mesh.corners(*one).each_ref().map(see)));
        view.new.clear();
        view.new.extend(self.facing.iter().map(|[a, b]| [apex, see(a), see(b)]));
        if !view.old.iter().chain(&view.new).all(turns_left) {
            return false;
        }
        view.moving.clear();
        view.moving.extend(self.moving.iter().map(see));
        view.sweeps.clear();
        // The edges that face the only vertex that moves.
        let facing_it =
            || self.old.iter().map(|one| facing(self.mesh.corners(*one), self.moving[0]));
        let Some(rim) = self.rim else {
            let ahead = |center: Seen| Seen { x: center.x + 1, ..center };
            let around = |center: Seen, edges: &mut dyn Iterator<Item = [u32; 2]>| {
                turns(center, ahead(center), edges.map(|edge| edge.each_ref().map(see))) == 1
            };
            return match view.moving[..] {
                [only] => around(only, &mut facing_it()),
                _ => around(apex, &mut self.facing.iter().copied()),
            };
        };
        let turns_less_than_once = |center: Seen, edges: &Edges| {
            let start = edges.iter().map(|edge| edge[0]);
            let start = start.into_iter().find(|one| edges.iter().all(|edge| edge[1] != *one));
            let edges = edges.iter().map(|edge| edge.each_ref().map(see));
            start.is_some_and(|start| turns(center, see(&start), edges) == 0)
        };
        let from = view.moving[0];
        let before: Edges = facing_it().collect();
        let ends = before.iter().flatten().map(see);
        view.sweeps.extend(ends.filter_map(|end| turned_left([from, apex, end])));
        turns_less_than_once(from, &before)
            && turns_less_than_once(apex, &self.facing)
            && ends_stay_apart(rim.each_ref().map(see), [from, apex])
    }

    /// Returns whether no other triangle meets the space between old and new triangles, apart from
    /// their boundary: all others that are near are clear.
    fn is_free(&self, is_clear: impl Fn(u32) -> bool) -> bool {
        let bounds = self.bounds();
        // Corners of all old triangles and of the tetrahedra that they sweep.
        let swept = self.facing.iter().flatten().chain(&self.moving).chain([&self.keep]);
        let mut swept: SmallVec<[I64Vec3; 32]> = swept.map(|one| self.mesh.place(*one)).collect();
        swept.push(self.to);
        self.mesh.index.all_near(&bounds, &mut |other| {
            self.old.contains(&other)
                || !self.mesh.bounds(other).meets(&bounds)
                || are_beside_plane(&swept, &self.places(other))
                || is_clear(other)
        })
    }

    /// Returns whether a triangle is proven not to meet the space that old triangles sweep, which
    /// is to the left of `sides`.
    fn is_clear(&self, other: u32, view: &View, sides: &Sides) -> bool {
        let numbers = self.mesh.corners(other);
        let places = self.places(other);
        let seen = places.map(|place| view.direction.see(place));
        if sides.iter().any(|&[a, b]| seen.iter().all(|corner| area(a, b, *corner) <= 0)) {
            return true;
        }
        let is_beside = if self.rim.is_some() {
            // The new rim must not touch anything else.
            let has =
                |number: u32| self.old.iter().any(|one| self.mesh.corners(*one).contains(&number));
            // A vertex that moves to a new place might come to lie on a side.
            let is_new = self.moving.contains(&self.keep);
            let may_lie = is_new && is_on_side(&seen, view.apex);
            !may_lie && view.all().all(|one| are_beside(&seen, numbers.map(has), one))
        } else {
            view.new.iter().all(|one| are_beside(&seen, [true; 3], one))
        };
        is_beside || self.is_apart(other, are_apart)
    }

    /// Returns whether a triangle is apart from each tetrahedron that an old triangle sweeps.
    fn is_apart(
        &self,
        other: u32,
        are_apart: impl Fn(&Apart<'_, 3>, &Apart<'_, 4>) -> bool,
    ) -> bool {
        let (numbers, places) = (self.mesh.corners(other), self.places(other));
        self.old.iter().all(|old| {
            let corners = self.mesh.corners(*old);
            let [a, b, c] = self.places(*old);
            // Another vertex that replaces the moving one may belong to the triangle.
            let replaces = !self.moving.contains(&self.keep);
            let is_own =
                |number: &u32| corners.contains(number) || (replaces && *number == self.keep);
            let swept = [a, b, c, self.to];
            let own = Apart { places: &places, is_shared: numbers.map(|one| is_own(&one)) };
            let shared = |place: &I64Vec3| {
                places.iter().zip(own.is_shared).any(|(one, shared)| shared && one == place)
            };
            let is_shared = swept.each_ref().map(shared);
            are_apart(&own, &Apart { places: &swept, is_shared })
        })
    }
}

/// Returns whether a triangle meets four points and all between them in shared corners alone, if
/// all are in one plane.
fn are_apart_in_plane(triangle: &Apart<'_, 3>, swept: &[I64Vec3; 4]) -> bool {
    let Some(direction) = normal(*triangle.places).try_normalize().map(Direction::near) else {
        return false;
    };
    direction.take(1).any(|direction| {
        let corners = triangle.places.map(|place| direction.see(place));
        let [a, b, c, to] = swept.map(|place| direction.see(place));
        let is_level = |point: Seen| volume(corners[0], corners[1], corners[2], point) == 0;
        turned_left(corners).is_some()
            && [a, b, c, to].into_iter().all(is_level)
            && [[a, b, c], [a, b, to], [b, c, to], [c, a, to]]
                .into_iter()
                .filter_map(turned_left)
                .all(|part| are_beside(&corners, triangle.is_shared, &part))
    })
}

/// A vector that all of some vectors are along, as far as that is found in a few steps: each step
/// adds the one that is along least.
fn middle(vectors: &[DVec3]) -> DVec3 {
    let units: SmallVec<[DVec3; 16]> = vectors.iter().map(|one| one.normalize_or_zero()).collect();
    let mut sum: DVec3 = units.iter().sum();
    for _ in 0..STEPS {
        let least = units.iter().min_by(|a, b| a.dot(sum).total_cmp(&b.dot(sum)));
        let Some(least) = least else { break };
        sum = sum.normalize_or_zero() + 0.25 * *least;
    }
    sum
}

/// Returns whether two neighbors, with just two neighbors in common, are corners of a tetrahedron
/// whose faces are all of its piece. Without one, two triangles would be left with the same
/// corners.
fn is_tetrahedron(mesh: &Triangulation, one: u32, other: u32) -> bool {
    [one, other].iter().all(|vertex| mesh.around(*vertex).len() == 3)
}

/// The number of vertices that are neighbors of both.
fn shared(mesh: &Triangulation, one: u32, other: u32) -> usize {
    let others = mesh.neighbors(other);
    mesh.neighbors(one).iter().filter(|vertex| others.contains(vertex)).count()
}

/// The edges that face a vertex, but for those at `but`.
fn facing_all(mesh: &Triangulation, vertex: u32, but: Option<u32>) -> Edges {
    let edges = mesh.around(vertex).iter().map(|one| facing(mesh.corners(*one), vertex));
    edges.filter(|edge| but.is_none_or(|but| !edge.contains(&but))).collect()
}

fn normal([a, b, c]: [I64Vec3; 3]) -> DVec3 {
    (b - a).as_dvec3().cross((c - a).as_dvec3())
}
