//! Fewer triangles of the same shape, and coordinates that files hold.
//!
//! Edges are removed, the cheapest first, while the triangles stay near the surface, as far as
//! samples tell. Each removal is [proven](change) to keep the shape. At the end, the distance
//! between the first triangles and the last ones is [proven](distance).

mod apart;
mod blocks;
mod change;
mod distance;
mod guide;
mod lattice;
mod projection;
mod quadric;
mod queue;
mod reduction;
mod rounding;
mod triangulation;
mod view;

use crate::index::Bounds;
use crate::{Mesh, Unproven, domain};
use distance::Cover;
use glam::DVec3;
use guide::Guide;
use lattice::{Lattice, single_spacing};
use reduction::{Reduction, Setting};
use rustc_hash::FxHashSet;
use triangulation::Triangulation;
use zeroset_eval::KernelError;
use zeroset_scene::program::Program;
use zeroset_space::Region;

/// Share of the allowed distance that the samples may be from the surface. The first triangles may
/// be on the other side of the surface.
const SHARE: f64 = 0.6;
/// The share becomes less by this factor around places whose distance is not proven. Then all is
/// done again.
const LESS: f64 = 0.4;
/// Size of the space around such a place, in allowed distances. It is twice as large each time.
const REACH: f64 = 16.0;
/// Number of times that the edges are removed.
const ROUNDS: u32 = 6;
/// Coordinates become `f32` if that moves vertices by less than this share of the tolerance.
const ROUNDING: f64 = 1.0 / 16.0;
/// Largest distance that samples may be from the surface, as a share of the thinnest wall, so that
/// the volume of the wall stays.
const OF_WALL: f64 = 0.6;

/// The wanted triangles.
#[derive(Clone, Copy, Debug)]
pub struct Simplification {
    /// The domain of the mesh.
    pub region: Region,
    /// Largest distance between the mesh and its surface, in world units.
    pub tolerance: f64,
    /// Largest distance between the old triangles and the new ones, above 0.
    pub distance: f64,
}

/// The least tolerance, and the least thickness of a wall, with which [`simplify`] makes the
/// coordinates between two points `f32`.
pub fn least_for_single(ends: [DVec3; 2]) -> f64 {
    single_spacing(ends) / ROUNDING
}

/// Replaces the triangles of a mesh by fewer ones of the same shape, and makes coordinates `f32` if
/// the tolerance allows. A vertex for which that is not proven to keep the shape becomes an
/// [unproven](Mesh::unproven) place. Returns `None` once `wanted` returns false.
///
/// # Errors
/// If a kernel is not available.
pub fn simplify(
    program: &Program,
    surface: usize,
    mesh: &mut Mesh,
    options: &Simplification,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<()>, KernelError> {
    if mesh.triangles.is_empty() {
        return Ok(Some(()));
    }
    let bounds = domain(&options.region);
    let ends = [bounds.map(|along| along.lo), bounds.map(|along| along.hi)];
    let ends = ends.map(DVec3::from_array);
    let wall = mesh.wall.unwrap_or(f64::INFINITY);
    let allowed = options.distance.min(OF_WALL * wall);
    let lattice = Lattice::new(ends, ROUNDING * options.tolerance.min(wall));
    let guide = Guide::new(program, surface, &options.region)?;
    let start = || {
        let places = mesh.vertices.iter().map(|place| lattice.nearest(*place)).collect();
        Triangulation::new(places, mesh.triangles.clone())
    };
    let ends = ends.map(|end| lattice.nearest(end));
    let setting = Setting { lattice: &lattice, guide: &guide, ends, most: SHARE * allowed };
    let distance = options.distance / lattice.unit;
    let mut next = start();
    let first = Cover::new(&next);
    let mut shares = next.shares.clone();
    let mut done = None;
    for round in 0..ROUNDS {
        let mut reduction = Reduction::new(&setting, next);
        reduction.measure();
        reduction.straighten();
        if reduction.run(wanted).is_none() {
            return Ok(None);
        }
        let Some(left) = reduction.round(wanted) else { return Ok(None) };
        let now = Cover::new(&reduction.mesh);
        let mut far = now.far_from(&first, distance);
        far.extend(first.far_from(&now, distance));
        if far.is_empty() {
            done = Some((reduction.mesh, left));
            break;
        }
        next = start();
        for vertex in around(&next, &far, REACH * distance * f64::from(1 << round)) {
            shares[vertex as usize] *= LESS;
        }
        next.shares.clone_from(&shares);
    }
    let (last, left) = if let Some(done) = done {
        done
    } else {
        let setting = Setting { most: 0.0, ..setting };
        let mut reduction = Reduction::new(&setting, start());
        let Some(left) = reduction.round(wanted) else { return Ok(None) };
        (reduction.mesh, left)
    };
    (mesh.vertices, mesh.triangles) = last.compact(|place| lattice.place(place));
    mesh.is_single = lattice.is_single;
    let size = DVec3::splat(lattice.step_length());
    let unproven = |vertex: &u32| Unproven { centre: lattice.place(last.place(*vertex)), size };
    mesh.unproven.extend(left.iter().map(unproven));
    Ok(Some(()))
}

/// The vertices of triangles near some places, in units, each once.
fn around(mesh: &Triangulation, places: &[DVec3], reach: f64) -> FxHashSet<u32> {
    let reach = DVec3::splat(reach);
    let mut all = FxHashSet::default();
    for place in places {
        let [low, high] = [*place - reach, *place + reach].map(|end| end.as_i64vec3());
        mesh.index.all_near(&Bounds { low, high }, &mut |triangle| {
            all.extend(mesh.corners(triangle));
            true
        });
    }
    all
}
