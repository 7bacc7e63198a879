//! Vertices of a mesh, and their places on the surface.

use crate::cells::{PartKernels, Query, parts_of};
use crate::polygon::{NO_PART, VertexKey};
use crate::refine::{Refined, sample};
use glam::{DMat3, DVec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::sync::Arc;
use zeroset_eval::{Gradients, KernelError, Points};
use zeroset_scene::choices::{Choice, Level};

/// Number of times that a bracket on an edge is narrowed.
const NARROWINGS: usize = 48;
/// A bracket of this share of its edge is not narrowed further.
const NARROW: f64 = 1e-12;
/// Least weight of each corner for a vertex that is moved, so that triangles have an area.
const APART: f64 = 1e-4;
/// Least difference of the weights of two vertices on an edge where levels of one function are 0.
/// Each weight is known up to [`NARROW`].
const IN_ORDER: f64 = 1e-11;
/// The function jumps on an edge if its values on both sides of the narrowed bracket differ by more
/// than this share of the values at the corners.
const JUMP: f64 = 1e-3;
/// Number of steps of Newton's method for a vertex where several parts are 0.
const STEPS: usize = 6;

/// Returns the value at each vertex's point of a function that may differ from vertex to vertex.
type ValuesAt<'a> = dyn Fn(&[usize], &[DVec3]) -> Vec<f64> + 'a;

/// The vertices on edges that have several, by the edges' corners.
type SharedEdges = FxHashMap<SmallVec<[u32; 2]>, Shared>;

/// The vertices on an edge that has several.
#[derive(Default)]
struct Shared {
    vertices: SmallVec<[usize; 4]>,
    /// True if the parts that are 0 there are levels of one function.
    is_group: bool,
}

/// The vertices of a mesh.
#[derive(Default)]
pub struct Vertices {
    numbers: FxHashMap<VertexKey, u32>,
    /// The keys of all vertices.
    pub keys: Vec<VertexKey>,
    weights: Vec<[f64; 4]>,
    /// For each vertex, the choice that matters in the tetrahedron that added the vertex.
    choices: Vec<Arc<Choice>>,
    /// The vertices' places, once they are placed.
    pub places: Vec<DVec3>,
}

impl Vertices {
    /// The number of a vertex, which is added if it is new.
    pub fn number(&mut self, key: VertexKey, weights: [f64; 4], choice: &Arc<Choice>) -> u32 {
        *self.numbers.entry(key).or_insert_with(|| {
            self.choices.push(Arc::clone(choice));
            self.keys.push(key);
            self.weights.push(weights);
            (self.keys.len() - 1) as u32
        })
    }

    /// The place of g's zero that a vertex stands for. `at` finds the places of corners.
    pub fn zero(&self, vertex: usize, at: &dyn Fn(u32) -> DVec3) -> DVec3 {
        let corners: SmallVec<[DVec3; 4]> =
            self.keys[vertex].corners().iter().map(|corner| at(*corner)).collect();
        let place = between(&corners, &self.weights[vertex][1..corners.len()]);
        if place.is_finite() {
            return place;
        }
        // Rounding may leave weights without a value. Then nothing is proven there.
        corners.iter().sum::<DVec3>() / corners.len() as f64
    }

    /// Moves vertices to zeros of f. If an edge has several vertices, and they would lose their
    /// order, they stay at g's zeros.
    ///
    /// Returns, for each vertex, whether it is at a zero. It is not where the function jumps.
    pub fn place(
        &mut self,
        refined: &Refined,
        &Query { parts: kernels, levels, .. }: &Query<'_>,
        at: &dyn Fn(u32) -> DVec3,
    ) -> Result<Vec<bool>, KernelError> {
        self.places = (0..self.keys.len()).map(|vertex| self.zero(vertex, at)).collect();
        let mut at_zero = vec![true; self.keys.len()];
        let shared = self.shared_edges(levels);
        let mut sorted: Vec<usize> = (0..self.keys.len()).collect();
        sorted.sort_by_key(|k| self.keys[*k].parts);
        let mut of_choices = Vec::new();
        let groups = sorted.chunk_by(|a, b| self.keys[*a].parts == self.keys[*b].parts);
        let groups: Vec<&[usize]> = groups.collect();
        for some in groups {
            let parts = self.keys[some[0]].parts;
            let vanishing = parts.iter().filter(|part| **part != NO_PART);
            let vanishing: SmallVec<[&PartKernels<'_>; 3]> =
                vanishing.map(|part| &kernels[usize::from(*part)]).collect();
            match &vanishing[..] {
                // A corner of the grid stays in its place.
                [] => {}
                [only] => {
                    // The choice may be 0 where another part is, if its sign changes once.
                    let (of_choice, of_part): (Vec<usize>, Vec<usize>) =
                        some.iter().copied().partition(|vertex| {
                            !matches!(*self.choices[*vertex], Choice::Part(_))
                                && !shared.contains_key(self.keys[*vertex].corners())
                                && self.changes_sign(*vertex, refined)
                        });
                    of_choices.extend(of_choice);
                    let at_corner = |_: usize, corner: u32| refined.values.sample(corner, parts[0]);
                    let values = |_: &[usize], points: &[DVec3]| sample(only.samples, points);
                    self.place_on_edges(&of_part, &shared, &at_corner, &values, at, &mut at_zero);
                }
                several => {
                    for vertex in some {
                        let corners = self.keys[*vertex].corners().iter();
                        let corners: SmallVec<[DVec3; 4]> = corners.map(|c| at(*c)).collect();
                        let start = self.places[*vertex];
                        let found = common_zero(several, &corners, start)?;
                        // Another part may have the choice's value there.
                        let value = |point: DVec3| {
                            let of = |part: usize| sample(kernels[part].samples, &[point])[0];
                            value_of(&self.choices[*vertex], &of).abs()
                        };
                        if value(found) < value(start) {
                            self.places[*vertex] = found;
                        }
                    }
                }
            }
        }
        let choices = std::mem::take(&mut self.choices);
        let at_corner = |vertex: usize, corner: u32| {
            value_of(&choices[vertex], &|part| refined.values.sample(corner, part as u16))
        };
        let values = |vertices: &[usize], points: &[DVec3]| {
            let choices: Vec<&Choice> = vertices.iter().map(|vertex| &*choices[*vertex]).collect();
            sample_choices(&choices, points, kernels)
        };
        self.place_on_edges(&of_choices, &shared, &at_corner, &values, at, &mut at_zero);
        for one in shared.into_values() {
            if !self.keep_order(&one, at) {
                for vertex in one.vertices {
                    self.places[vertex] = self.zero(vertex, at);
                }
            }
        }
        Ok(at_zero)
    }

    /// Returns whether vertices on one edge have the order of g's zeros, and are apart.
    fn keep_order(&self, shared: &Shared, at: &dyn Fn(u32) -> DVec3) -> bool {
        let mut sorted: SmallVec<[(f64, f64); 4]> = shared
            .vertices
            .iter()
            .map(|vertex| {
                let ends = [0, 1].map(|end| at(self.keys[*vertex].corners()[end]));
                let along = ends[1] - ends[0];
                let share = (self.places[*vertex] - ends[0]).dot(along) / along.length_squared();
                (self.weights[*vertex][1], share)
            })
            .collect();
        sorted.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        // False for NaN.
        let least = if shared.is_group { IN_ORDER } else { APART };
        sorted.windows(2).all(|pair| pair[1].1 - pair[0].1 >= least)
    }

    /// The vertices on each edge that has several.
    fn shared_edges(&self, levels: &[Level]) -> SharedEdges {
        let mut edges = SharedEdges::default();
        for (vertex, key) in self.keys.iter().enumerate() {
            let corners = key.corners();
            if corners.len() == 2 && !matches!(*self.choices[vertex], Choice::Part(_)) {
                edges.entry(corners.into()).or_default().vertices.push(vertex);
            }
        }
        edges.retain(|_, shared| shared.vertices.len() > 1);
        let group = |vertex: &usize| levels[usize::from(self.keys[*vertex].parts[0])].group;
        for Shared { vertices, is_group } in edges.values_mut() {
            *is_group = vertices.windows(2).all(|two| group(&two[0]) == group(&two[1]));
        }
        edges
    }

    /// Returns whether the signs of a vertex's choice differ at the ends of its edge.
    fn changes_sign(&self, vertex: usize, refined: &Refined) -> bool {
        let is_below = |corner: &u32| {
            let value = |part: usize| refined.values.at(*corner, part as u16);
            is_below(value_of(&self.choices[vertex], &value))
        };
        let signs: SmallVec<[bool; 2]> = self.keys[vertex].corners().iter().map(is_below).collect();
        signs[0] != signs[1]
    }

    /// Moves each vertex along its edge to a zero of the vertex's function. The function's signs
    /// differ at the ends of the edge. `at_corner` returns values at corners, and `values` returns
    /// values at points.
    fn place_on_edges(
        &mut self,
        vertices: &[usize],
        shared: &SharedEdges,
        at_corner: &dyn Fn(usize, u32) -> f64,
        values: &ValuesAt<'_>,
        at: &dyn Fn(u32) -> DVec3,
        at_zero: &mut [bool],
    ) {
        struct Bracket {
            ends: [DVec3; 2],
            /// The ends as shares of the edge. The function is below 0 at the first end, and not at
            /// the second.
            shares: [f64; 2],
            values: [f64; 2],
            scale: f64,
        }
        let mut brackets: Vec<Bracket> = vertices
            .iter()
            .map(|k| {
                let corners = [0, 1].map(|end| self.keys[*k].corners()[end]);
                let mut values = corners.map(|corner| at_corner(*k, corner));
                let mut shares = [0.0, 1.0];
                if !is_below(values[0]) {
                    values.reverse();
                    shares.reverse();
                }
                let ends = corners.map(at);
                Bracket { ends, shares, values, scale: values[1] - values[0] }
            })
            .collect();
        let mut open: Vec<usize> = (0..brackets.len()).collect();
        for round in 0..NARROWINGS {
            if open.is_empty() {
                break;
            }
            let next = |k: &usize| {
                let Bracket { shares: [from, to], values: [below, above], .. } = brackets[*k];
                let linear = below / (below - above);
                // The linear guess is moved toward the middle, so that both ends come nearer.
                let pull = if round % 3 == 2 { 0.5 } else { 0.02 };
                let share = if linear.is_finite() { linear + pull * (0.5 - linear) } else { 0.5 };
                from + share * (to - from)
            };
            let shares: Vec<f64> = open.iter().map(next).collect();
            let point =
                |(k, t): (&usize, &f64)| brackets[*k].ends[0].lerp(brackets[*k].ends[1], *t);
            let points: Vec<DVec3> = open.iter().zip(&shares).map(point).collect();
            let asked: Vec<usize> = open.iter().map(|k| vertices[*k]).collect();
            for ((k, share), value) in open.iter().zip(&shares).zip(values(&asked, &points)) {
                let side = usize::from(!is_below(value));
                (brackets[*k].shares[side], brackets[*k].values[side]) = (*share, value);
            }
            open.retain(|k| {
                let [from, to] = brackets[*k].shares;
                (to - from).abs() > NARROW
            });
        }
        for (vertex, bracket) in vertices.iter().zip(brackets) {
            let share = bracket.shares[0].midpoint(bracket.shares[1]);
            let has_group = |shared: &Shared| shared.is_group;
            let is_pushed = shared.get(self.keys[*vertex].corners()).is_some_and(has_group);
            let share = if is_pushed { pushed(share) } else { share.clamp(APART, 1.0 - APART) };
            self.places[*vertex] = between(&bracket.ends, &[share]);
            // False for NaN: the function is undefined at an end.
            at_zero[*vertex] = bracket.values[1] - bracket.values[0] <= JUMP * bracket.scale;
        }
    }
}

/// The value of a choice, computed from the values of its parts. An undefined part counts as larger
/// than all others.
fn value_of(choice: &Choice, value: &dyn Fn(usize) -> f64) -> f64 {
    let each = |all: &[Choice], pick: fn(f64, f64) -> f64| {
        all.iter().map(|one| value_of(one, value)).reduce(pick).unwrap_or(f64::NAN)
    };
    match choice {
        Choice::Part(part) => Some(value(*part)).filter(|v| !v.is_nan()).unwrap_or(f64::INFINITY),
        Choice::Opposite(part) => -value(*part),
        Choice::Min(all) => each(all, f64::min),
        Choice::Max(all) => each(all, f64::max),
    }
}

/// The values of choices, each at its own point.
fn sample_choices(choices: &[&Choice], points: &[DVec3], kernels: &[PartKernels<'_>]) -> Vec<f64> {
    let mut asked = vec![Vec::new(); kernels.len()];
    for (number, choice) in choices.iter().enumerate() {
        parts_of(choice).into_iter().for_each(|part| asked[part].push(number));
    }
    let mut found: Vec<SmallVec<[(usize, f64); 4]>> = vec![SmallVec::new(); choices.len()];
    for (part, numbers) in asked.iter().enumerate() {
        let points: Vec<DVec3> = numbers.iter().map(|number| points[*number]).collect();
        for (number, value) in numbers.iter().zip(sample(kernels[part].samples, &points)) {
            found[*number].push((part, value));
        }
    }
    let value = |(choice, found): (&&Choice, &SmallVec<[(usize, f64); 4]>)| {
        let of = |part: usize| found.iter().find(|(one, _)| *one == part).expect("sampled").1;
        value_of(choice, &of)
    };
    choices.iter().zip(&found).map(value).collect()
}

/// A share of an edge that is not near 0 or 1. Shares keep their order.
fn pushed(share: f64) -> f64 {
    share + 0.5 * ((APART - share).max(0.0) - (share - (1.0 - APART)).max(0.0))
}

/// Returns whether a value is below 0. An undefined one is not.
fn is_below(value: f64) -> bool {
    value < 0.0
}

/// The point between corners, by the weights of all but the first. Where all corners have one
/// coordinate in common, the point has it, too.
fn between(corners: &[DVec3], weights: &[f64]) -> DVec3 {
    let side = |(corner, weight): (&DVec3, &f64)| (*corner - corners[0]) * *weight;
    corners[0] + corners[1..].iter().zip(weights).map(side).sum::<DVec3>()
}

/// The point of a triangle or tetrahedron where two or three parts are 0, by Newton's method from
/// `start`. If the iteration leaves the hull of the corners, the result is its last point inside.
fn common_zero(
    parts: &[&PartKernels<'_>],
    corners: &[DVec3],
    start: DVec3,
) -> Result<DVec3, KernelError> {
    let edges: Vec<DVec3> = corners[1..].iter().map(|corner| *corner - corners[0]).collect();
    let mut at = start;
    for _ in 0..STEPS {
        let points = &Points::near(&[at])[0];
        let mut rows = [DVec3::Z; 3];
        let mut rest = DVec3::ZERO;
        for (k, part) in parts.iter().enumerate() {
            let mut found = Gradients::<f64>::default();
            part.all.gradients()?.eval(points, &mut found);
            rest[k] = found.value[0];
            rows[k] = DVec3::from_array(found.gradient.each_ref().map(|axis| axis[0]));
        }
        if parts.len() == 2 {
            // In a triangle, the step is along its plane.
            rows[2] = edges[0].cross(edges[1]);
        }
        let step = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse() * rest;
        let weights = weights_of(at - step, corners);
        let first = 1.0 - weights.iter().sum::<f64>();
        // False for NaN.
        if !(first >= APART && weights.iter().all(|weight| *weight >= APART)) {
            break;
        }
        // Again in the plane of a triangle, which rounding may have left.
        at = between(corners, &weights);
    }
    Ok(at)
}

/// The weights of all corners but the first, for a point of a triangle's plane, or of space.
fn weights_of(point: DVec3, corners: &[DVec3]) -> SmallVec<[f64; 3]> {
    let side = |k: usize| corners[k] - corners[0];
    let third = if corners.len() == 4 { side(3) } else { side(1).cross(side(2)) };
    let basis = DMat3::from_cols(side(1), side(2), third).inverse();
    let weights = basis * (point - corners[0]);
    weights.to_array().into_iter().take(corners.len() - 1).collect()
}
