//! Triangle meshes of surfaces, with proofs that a mesh has the surface's shape.
//!
//! A grid of tetrahedra is refined until the shape in it is proven and the mesh is near enough
//! ([`mesh`]). The mesh is cut out of the tetrahedra along the zeros on their edges.

mod cells;
mod connected;
mod crossings;
mod edges;
mod embedding;
mod extract;
mod fit;
mod flat;
mod grid;
mod index;
mod leaf;
mod near;
mod orientation;
mod parametric;
mod place;
mod polygon;
mod proof;
mod refine;
mod regular;
mod simplify;
mod space;
mod values;
mod wall;

use cells::{PartKernels, Query};
pub use connected::Connected;
pub use crossings::Crossings;
pub use edges::Edges;
use flat::Flat;
use glam::DVec3;
use leaf::{Kind, Nearness};
use near::{Far, Loose};
pub use parametric::{ParametricOptions, parametric_mesh};
use refine::{Limits, Refined, refine};
pub use simplify::{Simplification, least_for_single, simplify};
use space::Space;
use zeroset_interval::Interval;
use zeroset_scene::choices::Choices;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::program::{Program, ProgramError};
use zeroset_space::Region;

/// Default tolerance, as a share of the domain's diagonal.
pub const TOLERANCE: f64 = 1e-3;
/// Size of boxes over which bounds may be estimated, as a share of the domain's longest edge.
const ESTIMATED: f64 = 1.0 / 64.0;
/// Width of the space that is added around a ball, as a share of the domain's extent.
const AROUND: f64 = 1.0 / 32.0;

/// Width of the space that [`larger`] adds on each side, as a share of the longest edge.
const SPACE: f64 = 1.0 / 8.0;

/// Size of tetrahedra in which the two faces of a wall are proven together, in tolerances. The
/// faces of thicker walls are in different tetrahedra.
const THIN: f64 = 32.0;

/// Number of further attempts, with other linear functions, if triangles would cross.
const TRIALS: usize = 3;

/// Number of times that large tetrahedra are split before all that are too large must be small.
const ROUNDS: usize = 8;

/// Tetrahedra that are too large must be small at once if there are fewer of them than this share.
const FEW: f64 = 0.05;

/// The mesh of one surface.
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
pub struct Mesh {
    /// Places of the vertices, in world units.
    pub vertices: Vec<DVec3>,
    /// The vertices of each triangle, counterclockwise from outside, where f > 0. If f < 0 around a
    /// closed piece of an equation, outside is where f < 0, for this piece and for all pieces
    /// inside of it.
    pub triangles: Vec<[u32; 3]>,
    /// The number of closed pieces of an equation that are inside of no other one, with f < 0
    /// around them. It is 0 if f [was replaced](Program::is_reduced), perhaps by a function with
    /// other signs.
    pub turned: usize,
    /// The places in which the shape is not proven: tetrahedra, and edges of triangles that do not
    /// fit together.
    pub unproven: Vec<Unproven>,
    /// Number of tetrahedra in which the distance between mesh and surface is not proven to be
    /// within the tolerance.
    pub far: usize,
    /// Number of tetrahedra that may hold a part of the surface.
    pub cells: usize,
    /// True if the surface is parametric. Then its shape is that of the rectangle of u and v, and
    /// [unproven](Self::unproven) are the places where it may have a gap.
    pub is_parametric: bool,
    /// The crossings of a parametric surface's mesh. `None` for an equation or solid, which a proof
    /// of the shape covers.
    pub crossings: Option<Crossings>,
    /// True if the triangles have no rim.
    pub is_closed: bool,
    /// True if all coordinates are `f32`.
    pub is_single: bool,
    /// The thickness of the thinnest wall between faces that were meshed as levels of one function:
    /// an estimate. `None` if no wall is thinner than the tetrahedra around it.
    pub wall: Option<f64>,
    /// True if bounds were [estimated](Options::is_estimated), so that nothing is proven: not even
    /// that there is no surface.
    pub is_estimated: bool,
}

impl Mesh {
    /// Returns whether shape and distance are proven.
    pub fn is_proven(&self) -> bool {
        !self.is_estimated && self.unproven.is_empty() && self.far == 0
    }
}

/// A place in which the shape of the surface is not proven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unproven {
    /// Center of the place's bounding box.
    pub centre: DVec3,
    /// The box's extent along each axis.
    pub size: DVec3,
}

/// The options for a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The domain. Its half-space and its ball cut the mesh.
    pub region: Region,
    /// A [larger region](larger) in which the surface is the same, if there is one.
    pub larger: Option<Region>,
    /// Largest allowed distance between mesh and surface, in world units.
    pub tolerance: f64,
    /// Whether the surface bounds a solid, where f ≤ 0. The mesh then covers the solid's part of
    /// the domain's boundary.
    pub is_solid: bool,
    /// True if bounds over small boxes are estimated from samples at their corners. Nothing is then
    /// proven: all tetrahedra count as [unproven](Mesh::unproven) and as [far](Mesh::far).
    pub is_estimated: bool,
    /// True if triangles may be as large as the faces of a surface. If all faces are flat, the mesh
    /// is then exact, whatever the tolerance.
    pub has_large_faces: bool,
    /// Largest number of tetrahedra that may hold the surface. Above it, none is split to reduce
    /// the distance; above twice this number, none is split to prove the shape.
    pub most_cells: usize,
}

/// Default of [`Options::most_cells`].
pub const MOST_CELLS: usize = 1_500_000;

/// The box in which a program must be valid for a mesh in a region. A ball may touch faces of the
/// region's box. There the box is larger, since the shape of a surface that touches a face is not
/// proven.
pub fn domain(region: &Region) -> [Interval; 3] {
    let touches = |axis: usize| {
        region.ball().is_some_and(|ball| {
            let reach = 0.5 * (region.high()[axis] - region.low()[axis]);
            (reach - ball.radius).abs() < AROUND * ball.radius
        })
    };
    [0, 1, 2].map(|axis| {
        let (low, high) = (region.low()[axis], region.high()[axis]);
        let around = if touches(axis) { AROUND * (high - low) } else { 0.0 };
        Interval { lo: low - around, hi: high + around }
    })
}

/// A larger region in which a mesh needs fewer tetrahedra: one that touches a face of the domain
/// must not hold a part of the surface that is along the face. So tetrahedra are smaller than the
/// space between the two, which is narrow around a flat part. `None` if the surface is not proven
/// to lie in `region`, or if a ball or a plane cuts it.
pub fn larger(region: &Region, searched: Option<&AutoDomain>) -> Option<Region> {
    let found = searched.filter(|found| found.finding.is_bounded())?;
    let ends = [found.low, found.high].map(DVec3::from_array);
    if region.ball().is_some() || region.clip().is_some() || ends != [region.low(), region.high()] {
        return None;
    }
    let space = DVec3::splat(SPACE * (region.high() - region.low()).max_element());
    Region::new(region.low() - space, region.high() + space).ok()
}

/// Returns the mesh of a program's surface within a domain, or `None` once `wanted` returns false.
///
/// If no place is [unproven](Mesh::unproven), the mesh is isotopic to the surface, within the
/// domain. If none is [far](Mesh::far) either, each vertex is within the tolerance of the surface,
/// and each point of the surface is within it of the mesh.
///
/// # Errors
/// If a part of the function is too large, or a kernel is not available.
///
/// # Panics
/// If there is no such surface, or the program is not valid in the [`domain`] of each region.
pub fn mesh(
    program: &Program,
    surface: usize,
    options: &Options,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Mesh>, ProgramError> {
    if options.has_large_faces && !options.is_estimated {
        match flat::mesh(program, surface, options, wanted) {
            Flat::Mesh(mesh) => {
                let ends = [options.region.low(), options.region.high()];
                return Ok(Some(finish(program, surface, mesh, ends, options.is_solid, &|_| {
                    false
                })));
            }
            Flat::Other => {}
            Flat::Cancelled => return Ok(None),
        }
    }
    if let Some(larger) = options.larger {
        let Some(found) = mesh_in(program, surface, larger, options, wanted)? else {
            return Ok(None);
        };
        // A solid may fill the domain outside of its surface. Its mesh is closed by faces there.
        let (low, high) = (options.region.low(), options.region.high());
        let is_inside = |place: &DVec3| low.cmplt(*place).all() && place.cmplt(high).all();
        if found.vertices.iter().all(is_inside) {
            return Ok(Some(found));
        }
    }
    mesh_in(program, surface, options.region, options, wanted)
}

/// Returns the mesh in a region.
fn mesh_in(
    program: &Program,
    surface: usize,
    region: Region,
    options: &Options,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Mesh>, ProgramError> {
    let &Options { tolerance, is_solid, is_estimated, most_cells, .. } = options;
    let bounds = domain(&region);
    // Checked once for the whole box, in which all cells lie.
    let is_within =
        |(inner, outer): (&Interval, &Interval)| outer.lo <= inner.lo && inner.hi <= outer.hi;
    assert!(bounds.iter().zip(&program.domain()).all(is_within), "a mesh beyond the domain");
    let [low, high] = [bounds.map(|along| along.lo), bounds.map(|along| along.hi)];
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let Choices { choice, parts, first_cut, levels } = program.choices(surface, &region)?;
    let kernels = PartKernels::of(&parts)?;
    let (space, mut grid) = Space::new(low, high);
    let extent = (high - low).max_element();
    let limits = Limits { tolerance, extent, most_cells };
    // The surface of a solid includes the region's boundary.
    let first_cut = if is_solid { kernels.len() } else { first_cut };
    let estimated = if is_estimated { ESTIMATED * extent } else { 0.0 };
    let (parts, space, levels) = (&kernels[..], &space, &levels[..]);
    let thin = THIN * tolerance;
    let query = Query { parts, space, is_solid, levels, thin, first_cut, estimated };
    let mut refined = Refined::new(&choice, &mut grid, limits);
    let mut rounds = 0;
    let triangles = loop {
        if refine(&mut refined, &query, &mut grid, limits, wanted).is_none() {
            return Ok(None);
        }
        let strict = Loose::new(&refined, &query, tolerance).mixed();
        if !strict.is_empty() {
            refined.tighten(Far { strict, ..Far::default() }, false, &mut grid);
            continue;
        }
        let mut triangles = extract::extract(&refined, &grid, &query)?;
        let mut trials = 0;
        let far = loop {
            let far = Loose::new(&refined, &query, tolerance).far(&triangles);
            // Other leaves fail the proof anyway.
            let mut crossed = triangles.unproven.clone();
            crossed.retain(|leaf| !refined.fails(&refined.leaves[*leaf].cell));
            if !far.is_empty() || crossed.is_empty() || is_estimated || trials == TRIALS {
                break far;
            }
            trials += 1;
            if refined.move_again(&crossed, &query, &grid, wanted).is_none() {
                return Ok(None);
            }
            triangles = extract::extract(&refined, &grid, &query)?;
        };
        if far.is_empty() {
            break triangles;
        }
        rounds += 1;
        let is_last =
            rounds > ROUNDS || (far.large.len() as f64) < FEW * refined.leaves.len() as f64;
        refined.tighten(far, is_last, &mut grid);
    };
    let mut mesh = Mesh {
        vertices: triangles.vertices,
        triangles: triangles.triangles,
        wall: wall::thinnest(&refined, &query),
        is_estimated,
        ..Mesh::default()
    };
    let mut crossed = triangles.unproven.iter().peekable();
    for (number, leaf) in refined.leaves.iter().enumerate() {
        let is_crossed = crossed.next_if_eq(&&number).is_some();
        let Kind::Open { near, .. } = leaf.kind else { continue };
        mesh.cells += 1;
        mesh.far += usize::from(is_estimated || near == Nearness::Far);
        if is_estimated || is_crossed || refined.fails(&leaf.cell) {
            let [x, y, z] = space.between(leaf.cell.bounds());
            let (low, high) = (DVec3::new(x.lo, y.lo, z.lo), DVec3::new(x.hi, y.hi, z.hi));
            mesh.unproven.push(Unproven { centre: 0.5 * (low + high), size: high - low });
        }
    }
    let may_end = |vertex: u32| triangles.is_cut[vertex as usize];
    Ok(Some(finish(program, surface, mesh, [low, high], is_solid, &may_end)))
}

/// Adds whether the triangles of a mesh fit together, and turns those of equations. `ends` and
/// `may_end` are as for [`fit::fit`].
fn finish(
    program: &Program,
    surface: usize,
    mut mesh: Mesh,
    ends: [DVec3; 2],
    is_solid: bool,
    may_end: &dyn Fn(u32) -> bool,
) -> Mesh {
    // Rounding may decide differently in neighbors where more than three parts are 0 at a point.
    let (rims, misfits) = fit::fit(&mesh, ends, is_solid, may_end);
    mesh.is_closed = rims.is_empty();
    if !is_solid {
        let turned = orientation::face_out(&mesh.vertices, &mut mesh.triangles, &rims);
        mesh.turned = if program.is_reduced(surface) { 0 } else { turned };
    }
    for (from, to) in misfits {
        let size = (to - from).abs();
        mesh.unproven.push(Unproven { centre: 0.5 * (from + to), size });
    }
    mesh
}
