//! Cuts triangles at the boundary of the domain: at faces of its box, at its plane and its ball.
//!
//! Where an edge crosses the boundary, there is a new vertex for all triangles of the edge. So what
//! is left fits together. An edge between points outside of the ball is taken to be outside.

use glam::DVec3;
use rustc_hash::FxHashMap;
use zeroset_space::{Ball, HalfSpace, Region};

/// A part of the boundary.
#[derive(Clone, Copy)]
enum Side {
    Plane { normal: DVec3, offset: f64 },
    Ball(Ball),
}

/// The boundary of a domain.
pub(super) struct Cut {
    sides: Vec<Side>,
    /// Vertices that are so near a side are on it.
    slack: f64,
    /// Largest size of cells that the surface of the ball meets.
    longest: f64,
}

impl Cut {
    /// The boundary of a region. Edges at its ball are to be within a tolerance of the ball.
    pub fn new(region: &Region, slack: f64, tolerance: f64) -> Self {
        let faces = [DVec3::X, DVec3::Y, DVec3::Z]
            .into_iter()
            .flat_map(|axis| [(-axis, -region.low().dot(axis)), (axis, region.high().dot(axis))]);
        let mut sides: Vec<Side> =
            faces.map(|(normal, offset)| Side::Plane { normal, offset }).collect();
        sides.extend(region.clip().map(|HalfSpace { normal, offset }| {
            let length = normal.length();
            Side::Plane { normal: normal / length, offset: offset / length }
        }));
        sides.extend(region.ball().map(Side::Ball));
        // An edge of this length has its middle half the tolerance inside of the ball.
        let longest =
            region.ball().map_or(f64::INFINITY, |ball| 2.0 * (ball.radius * tolerance).sqrt());
        Self { sides, slack, longest }
    }

    /// Returns whether a box is outside of the region. Infinite bounds never are.
    pub fn is_outside(&self, bounds: &[[f64; 2]; 3]) -> bool {
        let [low, high] = ends(bounds);
        self.sides.iter().any(|side| match side {
            Side::Plane { normal, offset } => {
                let nearest = DVec3::select(normal.cmpgt(DVec3::ZERO), low, high);
                // An axis across which the plane does not lie has no part in it.
                let nearest = DVec3::select(normal.cmpeq(DVec3::ZERO), DVec3::ZERO, nearest);
                normal.dot(nearest) - offset > self.slack
            }
            Side::Ball(ball) => {
                let nearest = ball.centre.clamp(low, high);
                nearest.distance(ball.centre) - ball.radius > self.slack
            }
        })
    }

    /// Returns whether a box is too large to be cut by the ball.
    pub fn is_coarse(&self, bounds: &[[f64; 2]; 3]) -> bool {
        let [low, high] = ends(bounds);
        let is_cut = |side: &Side| {
            let Side::Ball(ball) = side else { return false };
            (low - ball.centre).abs().max((high - ball.centre).abs()).length() > ball.radius
        };
        low.distance(high) > self.longest && self.sides.iter().any(is_cut)
    }

    /// Drops what is outside. Returns whether there was any.
    pub fn apply(
        &self,
        vertices: &mut Vec<DVec3>,
        triangles: &mut Vec<[u32; 3]>,
        is_single: bool,
    ) -> bool {
        let mut is_cut = false;
        for side in &self.sides {
            let beyond: Vec<f64> = vertices.iter().map(|at| side.beyond(*at)).collect();
            let is_out = |vertex: &u32| beyond[*vertex as usize] > self.slack;
            if !triangles.iter().flatten().any(is_out) {
                continue;
            }
            is_cut = true;
            let round = |at: DVec3| if is_single { at.as_vec3().as_dvec3() } else { at };
            for (vertex, beyond) in vertices.iter_mut().zip(&beyond) {
                if beyond.abs() <= self.slack {
                    *vertex = round(side.nearest(*vertex));
                }
            }
            let mut on_edges: FxHashMap<[u32; 2], u32> = FxHashMap::default();
            let mut crossing = |inner: u32, outer: u32| {
                if beyond[inner as usize] >= -self.slack {
                    return inner;
                }
                *on_edges.entry([inner, outer]).or_insert_with(|| {
                    let [from, to] = [inner, outer].map(|end| vertices[end as usize]);
                    vertices.push(round(side.crossing(from, to)));
                    vertices.len() as u32 - 1
                })
            };
            let mut left = Vec::with_capacity(triangles.len());
            for triangle in triangles.iter() {
                let mut polygon = Vec::with_capacity(4);
                for (k, one) in triangle.iter().enumerate() {
                    let next = &triangle[(k + 1) % 3];
                    match (is_out(one), is_out(next)) {
                        (false, false) => polygon.push(*one),
                        (false, true) => polygon.extend([*one, crossing(*one, *next)]),
                        (true, false) => polygon.push(crossing(*next, *one)),
                        (true, true) => {}
                    }
                }
                polygon.dedup();
                if polygon.len() > 1 && polygon.first() == polygon.last() {
                    polygon.pop();
                }
                left.push(polygon);
            }
            let length = |one: u32, other: u32| {
                vertices[one as usize].distance_squared(vertices[other as usize])
            };
            let parts = |polygon: Vec<u32>| match polygon[..] {
                [a, b, c] => vec![[a, b, c]],
                [a, b, c, d] if length(a, c) <= length(b, d) => vec![[a, b, c], [a, c, d]],
                [a, b, c, d] => vec![[a, b, d], [b, c, d]],
                _ => Vec::new(),
            };
            *triangles = left.into_iter().flat_map(parts).collect();
        }
        is_cut
    }
}

impl Side {
    /// How far a point is outside, below 0 inside.
    fn beyond(&self, point: DVec3) -> f64 {
        match self {
            Self::Plane { normal, offset } => normal.dot(point) - offset,
            Self::Ball(ball) => point.distance(ball.centre) - ball.radius,
        }
    }

    /// The nearest point of this side to one beside it. Those of faces of the box are exact.
    fn nearest(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Plane { normal, offset } => {
                let is_face = normal.abs().cmpeq(DVec3::ONE);
                let moved = point - self.beyond(point) * normal;
                DVec3::select(is_face, offset * normal, moved)
            }
            Self::Ball(ball) => {
                ball.centre + ball.radius * (point - ball.centre).normalize_or(DVec3::X)
            }
        }
    }

    /// Returns the place at which a segment from inside to outside crosses the boundary.
    fn crossing(&self, from: DVec3, to: DVec3) -> DVec3 {
        match self {
            Self::Plane { .. } => {
                let (here, there) = (self.beyond(from), self.beyond(to));
                self.nearest(from.lerp(to, here / (here - there)))
            }
            Self::Ball(ball) => {
                let (start, way) = (from - ball.centre, to - from);
                let (a, b) = (way.length_squared(), start.dot(way));
                let c = start.length_squared() - ball.radius * ball.radius;
                let root = (b * b - a * c).max(0.0).sqrt();
                // c is below 0, so neither form subtracts what is nearly equal.
                let share = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
                from.lerp(to, share.clamp(0.0, 1.0))
            }
        }
    }
}

/// The corners of a box with the least coordinates, and with the greatest.
fn ends(bounds: &[[f64; 2]; 3]) -> [DVec3; 2] {
    [0, 1].map(|end| DVec3::from_array(bounds.map(|axis| axis[end])))
}
