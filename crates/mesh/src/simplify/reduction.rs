//! The removal of edges.

use crate::index::Bounds;
use crate::simplify::blocks;
use crate::simplify::change::Change;
use crate::simplify::guide::Guide;
use crate::simplify::lattice::Lattice;
use crate::simplify::quadric::Quadric;
use crate::simplify::queue::{Entry, Queue};
use crate::simplify::triangulation::Triangulation;
use glam::{DVec3, I64Vec3};
use smallvec::SmallVec;

/// Share of triangles that a pass must remove for another pass to follow.
const PROGRESS: f64 = 0.02;
/// Largest number of triangles around a vertex that is changed.
const MOST_AROUND: usize = 64;
/// Least cosine of the angle between a triangle and the plane that stands for the surface there.
const ALIKE: f64 = 0.7;
/// The plane that cuts the region, beside the six faces of the domain.
const CLIP: u8 = 1 << 6;
/// A vertex is on that plane if it is no farther from it than this share of the distance that
/// samples may have.
const ON_CLIP: f64 = 0.01;
/// Distance from a plane that rounding may cause, in units.
const ROUNDING: f64 = 8.0;
/// If an end of the edge costs more than the best place, but less than by this share, the edge is
/// moved to the end: fewer triangles change.
const ALMOST: f64 = 1e-4;
/// Number of steps of the lattice that a vertex may always move.
const STEPS: f64 = 4.0;
/// The cost of a squared squared length, so that the shortest of edges that cost nothing comes
/// first.
const LENGTH: f64 = 1e-12;

/// All that a reduction does not change.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    pub lattice: &'a Lattice,
    pub guide: &'a Guide<'a>,
    /// Corners of the domain.
    pub ends: [I64Vec3; 2],
    /// Largest distance from the surface that samples may have, in world units. Around some
    /// vertices only a [share](Triangulation::shares) of it is allowed.
    pub most: f64,
}

impl Setting<'_> {
    /// The distance that samples may have where a share is allowed. Vertices may always move to
    /// rounded places.
    fn within(&self, share: f64) -> f64 {
        (share * self.most).max(STEPS * self.lattice.step_length())
    }
}

/// Triangles that become fewer.
pub struct Reduction<'a> {
    pub setting: &'a Setting<'a>,
    pub mesh: Triangulation,
    queue: Queue,
    /// All changes are strictly inside this box, if there is one.
    pub within: Option<Bounds>,
}

/// A place for both ends of an edge.
#[derive(Clone, Copy)]
struct Target {
    cost: f64,
    /// The end that stays where it is, if one does.
    end: Option<usize>,
    place: I64Vec3,
}

impl<'a> Reduction<'a> {
    pub fn new(setting: &'a Setting<'a>, mesh: Triangulation) -> Self {
        Self { setting, mesh, queue: Queue::new(), within: None }
    }

    /// Finds each vertex's quadric, from the planes that touch the surface near the triangles
    /// around it. Vertices may be a little beside the surface's edges, but those planes are not.
    pub fn measure(&mut self) {
        let Setting { lattice, guide, most, .. } = self.setting;
        let present: Vec<u32> = self.mesh.present().collect();
        let places = |one: &u32| {
            self.mesh.corners(*one).map(|corner| lattice.relative(self.mesh.place(corner)))
        };
        let all: Vec<[DVec3; 3]> = present.iter().map(places).collect();
        let origin = lattice.place(I64Vec3::ZERO);
        let middle = |places: &[DVec3; 3]| places.iter().sum::<DVec3>() / 3.0;
        let middles: Vec<DVec3> = all.iter().map(|places| origin + middle(places)).collect();
        let planes = guide.planes(&middles);
        for ((triangle, places), plane) in present.iter().zip(all).zip(planes) {
            let [a, b, c] = places;
            let across = (b - a).cross(c - a);
            let Some(own) = across.try_normalize() else { continue };
            let of_surface =
                plane.filter(|(normal, off)| normal.dot(own).abs() > ALIKE && off.abs() <= *most);
            let (normal, point) = match of_surface {
                Some((normal, off)) => (normal, middle(&places) - off * normal),
                None => (own, a),
            };
            let quadric = Quadric::of_plane(normal, point, across.length());
            let corners = self.mesh.corners(*triangle);
            for corner in corners {
                self.mesh.quadrics[corner as usize] += quadric;
            }
            for k in 0..3 {
                let (one, other) = (corners[k], corners[(k + 1) % 3]);
                if !self.mesh.is_rim(one, other) {
                    continue;
                }
                // A rim stays where it is.
                let along = places[(k + 1) % 3] - places[k];
                let Some(aside) = along.cross(own).try_normalize() else { continue };
                let quadric = Quadric::of_plane(aside, places[k], along.length_squared());
                self.mesh.quadrics[one as usize] += quadric;
                self.mesh.quadrics[other as usize] += quadric;
            }
        }
    }

    /// Removes edges until few are left that can be removed. `None` once `wanted` returns false.
    pub fn run(&mut self, wanted: &(dyn Fn() -> bool + Sync)) -> Option<()> {
        blocks::reduce(self, wanted)?;
        let mut left = self.mesh.present().count();
        loop {
            self.pass(wanted)?;
            let now = self.mesh.present().count();
            if now as f64 >= (1.0 - PROGRESS) * left as f64 {
                return Some(());
            }
            left = now;
        }
    }

    /// Tries all edges, the cheapest first.
    pub fn pass(&mut self, wanted: &(dyn Fn() -> bool + Sync)) -> Option<()> {
        self.mesh.sort();
        for triangle in self.mesh.present().collect::<Vec<u32>>() {
            let [a, b, c] = self.mesh.corners(triangle);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                if from < to || self.mesh.is_rim(from, to) {
                    self.offer([from, to]);
                }
            }
        }
        let mut count = 0;
        while let Some(Entry { ends, stamps }) = self.queue.pop() {
            count += 1;
            if count % 1024 == 0 && !wanted() {
                return None;
            }
            let is_fresh = |k: usize| {
                let end = ends[k] as usize;
                self.mesh.stamps[end] == stamps[k] && !self.mesh.around[end].is_empty()
            };
            if !(is_fresh(0) && is_fresh(1)) {
                continue;
            }
            if let Some(kept) = self.remove(ends) {
                for neighbor in self.mesh.neighbors(kept) {
                    self.offer([kept, neighbor]);
                }
            }
        }
        Some(())
    }

    fn offer(&mut self, ends: [u32; 2]) {
        if self
            .within
            .is_some_and(|within| !ends.iter().all(|end| within.holds(self.mesh.place(*end))))
        {
            return;
        }
        let quadric = self.joined(ends);
        let cost = self.targets(ends, &quadric)[0].cost;
        // The surface is too far from the cheapest place.
        let share = ends.map(|end| self.mesh.shares[end as usize]);
        let most = self.setting.within(share[0].min(share[1]));
        if cost > most.powi(2) * quadric.weight() {
            return;
        }
        let stamps = ends.map(|end| self.mesh.stamps[end as usize]);
        self.queue.push(cost, Entry { ends, stamps });
    }

    /// The sum of the quadrics at both ends of an edge.
    fn joined(&self, [one, other]: [u32; 2]) -> Quadric {
        let mut quadric = self.mesh.quadrics[one as usize];
        quadric += self.mesh.quadrics[other as usize];
        quadric
    }

    /// Places to which both ends of an edge may move, the cheapest first.
    fn targets(&self, ends: [u32; 2], quadric: &Quadric) -> [Target; 3] {
        let lattice = self.setting.lattice;
        let [one, other] = ends.map(|end| self.mesh.place(end));
        let [from, to] = [one, other].map(|place| lattice.relative(place));
        let tie = LENGTH * (to - from).length_squared().powi(2);
        let faces = [one, other].map(|place| self.faces(place));
        let best = self.best(quadric, 0.5 * (from + to), faces[0] | faces[1]);
        let floor = self.floor(quadric);
        let cost = |place: I64Vec3| quadric.at(lattice.relative(place)).max(floor) + tie;
        let end = |k: usize, place: I64Vec3| {
            let leaves_face = faces[1 - k] & !faces[k] != 0;
            let cost = if leaves_face { f64::MAX } else { cost(place) };
            Target { cost, end: Some(k), place }
        };
        let best = Target { cost: (1.0 + ALMOST) * cost(best), end: None, place: best };
        let mut all = [end(0, one), end(1, other), best];
        all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        all
    }

    /// The faces of the domain on which a point lies, a bit for each, and [`CLIP`] for the plane
    /// that cuts the region.
    pub fn faces(&self, point: I64Vec3) -> u8 {
        let Setting { lattice, guide, ends, most } = self.setting;
        let on = |k: usize, end: I64Vec3| {
            (0..3).map(|axis| u8::from(point[axis] == end[axis]) << (3 * k + axis)).sum::<u8>()
        };
        let clip = guide.clip(lattice.place(point));
        let is_cut = clip.is_some_and(|(_, off)| off.abs() <= ON_CLIP * most);
        on(0, ends[0]) | on(1, ends[1]) | if is_cut { CLIP } else { 0 }
    }

    /// The rounded point with the least sum of a quadric, in faces of the domain.
    pub fn best(&self, quadric: &Quadric, middle: DVec3, faces: u8) -> I64Vec3 {
        let Setting { lattice, guide, ends: [low, high], .. } = self.setting;
        let mut best = quadric.best(middle).unwrap_or(middle);
        if faces & CLIP != 0
            && let Some((normal, off)) = guide.clip(lattice.place(I64Vec3::ZERO) + best)
        {
            best -= off * normal;
        }
        let mut best = lattice.rounded_relative(best).clamp(*low, *high);
        for (k, end) in [low, high].into_iter().enumerate() {
            for axis in 0..3 {
                if faces >> (3 * k + axis) & 1 == 1 {
                    best[axis] = end[axis];
                }
            }
        }
        best
    }

    /// The least sum of a quadric that is told from 0.
    pub fn floor(&self, quadric: &Quadric) -> f64 {
        (ROUNDING * self.setting.lattice.unit).powi(2) * quadric.weight()
    }

    /// Removes an edge, if that is proven. Returns the vertex that is left.
    fn remove(&mut self, ends: [u32; 2]) -> Option<u32> {
        if ends.iter().any(|end| self.mesh.around(*end).len() > MOST_AROUND) {
            return None;
        }
        for Target { cost, end, place } in self.targets(ends, &self.joined(ends)) {
            if cost == f64::MAX {
                continue;
            }
            let [drop, keep] = if end == Some(0) { [ends[1], ends[0]] } else { ends };
            let change = match end {
                Some(_) => Change::into_other(&self.mesh, drop, keep),
                None => Change::joined(&self.mesh, drop, keep, place),
            };
            if change.is_some_and(|change| self.is_proven(&change, 0.0)) {
                self.mesh.apply(keep, Some(drop), place);
                return Some(keep);
            }
        }
        None
    }

    /// Returns whether a change is proven to keep the shape, and seems to stay near the surface.
    /// Triangles may turn whose height is less than `thin`, a share of the allowed distance.
    pub fn is_proven(&self, change: &Change<'_>, thin: f64) -> bool {
        let &Setting { lattice, guide, .. } = self.setting;
        let most = self.setting.within(change.share());
        if self.within.is_some_and(|within| !within.holds_all(&change.bounds())) {
            return false;
        }
        change.is_proven(most / lattice.unit, thin * most / lattice.unit, &|points| {
            let places = |some: &[DVec3]| -> SmallVec<[DVec3; 64]> {
                some.iter().map(|point| lattice.between(*point)).collect()
            };
            guide.are_near(&places(&points.inner), most)
                && guide.are_near_rim(&places(&points.rim), most)
        })
    }

    /// Returns whether a change by a step is proven to keep the shape.
    pub fn keeps_shape(&self, change: &Change<'_>) -> bool {
        let Setting { lattice, .. } = self.setting;
        change.is_proven(self.setting.within(change.share()) / lattice.unit, 0.0, &|_| true)
    }
}
