//! Exact meshes of surfaces whose parts are planes.
//!
//! Planes divide space one by one, until no plane that matters in a piece divides it. Each piece is
//! convex, and lies inside of the surface or outside. The surface lies between pieces of the two
//! kinds. All of this is exact. At the end, corners are rounded. A check proves that triangles do
//! not meet when their corners move so little.

mod join;
mod plane;
mod polygon;
mod tree;

use crate::embedding::{Triangle, least_distance};
use crate::index::{Bounds, Index};
use crate::{Mesh, Options, Unproven};
use glam::{DVec3, I64Vec3};
use join::join;
use plane::{Plane, Points};
use polygon::Polygon;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use tree::{Builder, Face};
use zeroset_scene::choices::{Choice, FlatChoice};
use zeroset_scene::program::Program;

/// Number of units along the domain's longest edge, for boxes around triangles.
const UNITS: f64 = (1_u64 << 38) as f64;

/// The result of [`mesh`].
pub enum Flat {
    /// The exact surface, with rounded corners, and the parts of space in which it is not proven
    /// that triangles do not meet.
    Mesh(Mesh),
    /// The surface has parts that are no planes, or a rim, or a part at which the function does not
    /// change its sign.
    Other,
    /// The work is no longer wanted.
    Cancelled,
}

/// Returns the mesh of a surface in the options' region, which no plane and no ball may cut.
pub fn mesh(
    program: &Program,
    surface: usize,
    options: &Options,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Flat {
    let Options { region, is_solid, .. } = options;
    if region.clip().is_some() || region.ball().is_some() {
        return Flat::Other;
    }
    let Some(FlatChoice { choice, planes }) = program.flat_choice(surface) else {
        return Flat::Other;
    };
    // A single plane has a rim.
    if !is_solid && matches!(choice, Choice::Part(_)) {
        return Flat::Other;
    }
    let mut points = Points::new(planes.iter().map(Plane::of).collect());
    let first_of_domain = points.planes.len();
    let domain = Polygon::of_box(region, &mut points);
    let mut builder = Builder { points, pieces: 0, wanted };
    let Some(tree) = builder.divide(domain.clone(), &choice, 0) else {
        return if wanted() { Flat::Other } else { Flat::Cancelled };
    };
    let mut points = builder.points;
    let mut faces = Vec::new();
    tree.faces(&mut points, &mut faces);
    for face in domain {
        // An equation goes on beyond the domain.
        let before = |behind| behind && !is_solid;
        tree.pieces(face, &mut points, &mut |polygon, behind| {
            faces.push(Face { polygon, sides: [behind, before(behind)] });
        });
    }
    let is_sheet =
        |face: &Face| face.sides[0] == face.sides[1] && face.polygon.is_zero(&choice, &points);
    if !is_solid && faces.iter().any(is_sheet) {
        return Flat::Other;
    }
    let mut polygons = Vec::new();
    for Face { polygon, sides: [behind, before] } in faces {
        if behind != before {
            polygons.push(if behind { polygon } else { polygon.turned() });
        }
    }
    let has_rim = |polygon: &Polygon| polygon.edges.iter().any(|plane| *plane >= first_of_domain);
    if !is_solid && polygons.iter().any(has_rim) {
        return Flat::Other;
    }
    let wall = points.thinnest(polygons.iter().map(|polygon| polygon.plane));
    let triangles = join(&polygons, &points);
    let mut mesh = Mesh { triangles, cells: builder.pieces, ..Mesh::default() };
    let mut numbers = FxHashMap::default();
    for corner in mesh.triangles.as_flattened_mut() {
        let next = numbers.len() as u32;
        *corner = *numbers.entry(*corner).or_insert_with(|| {
            mesh.vertices.push(points.place(*corner));
            next
        });
    }
    mesh.wall = wall.filter(|wall| *wall < crate::THIN * options.tolerance);
    check(&mut mesh, options);
    Flat::Mesh(mesh)
}

/// Adds the places in which triangles are not proven to be apart, or in which the surface touches
/// itself.
fn check(mesh: &mut Mesh, options: &Options) {
    let (low, high) = (options.region.low(), options.region.high());
    let least = least_distance(low.abs().max(high.abs()).max_element());
    let triangle = |numbers: &[u32; 3]| Triangle {
        numbers: *numbers,
        corners: numbers.map(|vertex| mesh.vertices[vertex as usize]),
    };
    let triangles: Vec<Triangle> = mesh.triangles.iter().map(triangle).collect();
    let scale = UNITS / (high - low).max_element();
    let bounds = |triangle: &Triangle| {
        let [a, b, c] = triangle.corners.map(|corner| (corner - low) * scale);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        Bounds::of([
            low.floor().as_i64vec3() - I64Vec3::ONE,
            high.ceil().as_i64vec3() + I64Vec3::ONE,
        ])
    };
    let all: Vec<(u32, Bounds)> =
        triangles.iter().enumerate().map(|(k, triangle)| (k as u32, bounds(triangle))).collect();
    let index = Index::new(all.len(), &all);
    let is_apart = |(number, bounds): &(u32, Bounds)| {
        let own = &triangles[*number as usize];
        own.has_area(least)
            && index.all_near(bounds, &mut |other| {
                other <= *number || own.is_apart(&triangles[other as usize], least)
            })
    };
    let crossed: Vec<u32> =
        all.par_iter().filter(|one| !is_apart(one)).map(|(number, _)| *number).collect();
    let around = |corners: &[DVec3]| {
        let (low, high) =
            corners.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |ends, at| {
                (ends.0.min(*at), ends.1.max(*at))
            });
        Unproven { centre: 0.5 * (low + high), size: high - low }
    };
    let mut unproven: Vec<Unproven> =
        crossed.iter().map(|number| around(&triangles[*number as usize].corners)).collect();
    let pinched = pinches(mesh.vertices.len(), &mesh.triangles);
    unproven.extend(pinched.into_iter().map(|vertex| around(&[mesh.vertices[vertex as usize]])));
    mesh.unproven.extend(unproven);
}

/// The vertices whose triangles are not all connected by edges at the vertex.
fn pinches(vertices: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut stars: Vec<Vec<[u32; 2]>> = vec![Vec::new(); vertices];
    for &[a, b, c] in triangles {
        for [tip, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
            stars[tip as usize].push([from, to]);
        }
    }
    let is_pinched = |star: &[[u32; 2]]| {
        let next: FxHashMap<u32, u32> = star.iter().map(|[from, to]| (*from, *to)).collect();
        let Some(&[first, _]) = star.first() else { return false };
        let (mut at, mut count) = (first, 0);
        while let Some(to) = next.get(&at).filter(|_| count < star.len()) {
            (at, count) = (*to, count + 1);
            if at == first {
                break;
            }
        }
        count != star.len()
    };
    (0..vertices as u32).filter(|vertex| is_pinched(&stars[*vertex as usize])).collect()
}
