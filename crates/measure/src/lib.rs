//! Measures of surfaces: volume, centroid and inertia of solids between proven bounds, pieces and
//! genus where they are proven, and an estimate of the area.

mod clip;
mod hint;
mod quantity;
mod scene;
mod shape;
mod text;
mod volume;
mod wall;

pub use quantity::Quantity;
pub use scene::{MeasureError, Measured, measures};
pub use shape::{Piece, Shape};
pub use volume::{Inertia, Limit, Solid, SolidKernels, solid};

use shape::hull;
use zeroset_interval::Interval;
use zeroset_mesh::{Mesh, mesh};
use zeroset_scene::program::{Program, ProgramError};
use zeroset_space::Region;

/// Default of the largest width of a volume's bounds, as a share of the volume.
pub const RELATIVE: f64 = 1e-3;
/// Largest distance between surface and mesh, as a share of the domain's diagonal.
const TOLERANCE: f64 = 4e-3;
/// Number of tetrahedra in a mesh above which none is split.
const MOST_CELLS: usize = 200_000;
/// The area is compared with the area of a coarser mesh, whose largest distance is this many times
/// as large.
const COARSER: f64 = 4.0;

/// The measures of a surface in a region, as far as they were asked for.
#[derive(Clone, Debug)]
pub struct Measures {
    /// True if the surface bounds a solid.
    pub is_solid: bool,
    /// Volume and moments. `None` if the surface bounds no solid.
    pub solid: Option<Solid>,
    /// The least and the greatest coordinates of the surface. `None` if they are not proven.
    pub ends: Option<[[Interval; 3]; 2]>,
    /// Pieces and genus of a mesh.
    pub shape: Shape,
    /// Number of cells in which the mesh is not proven to have the surface's shape. If it is 0,
    /// `shape` is the shape of the surface. 0 without a mesh.
    pub unproven: usize,
    /// The area of a mesh: an estimate.
    pub area: f64,
    /// The difference from the area of a coarser mesh.
    pub area_change: f64,
}

impl Measures {
    /// The numbers of pieces and of hollows. A hollow belongs to the piece around it; only a solid
    /// has any. `None` if the mesh has no triangle and the surface is not proven empty.
    pub fn counts(&self) -> Option<(usize, usize)> {
        let pieces = &self.shape.pieces;
        let is_hollow = |piece: &&Piece| self.is_solid && piece.is_hollow;
        let hollows = pieces.iter().filter(is_hollow).count();
        (!pieces.is_empty() || self.unproven == 0).then_some((pieces.len() - hollows, hollows))
    }
}

/// The measures that are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Names of the measures. No other one is computed.
    pub quantities: &'a [Quantity],
    /// Largest width of a volume's bounds, as a share of the volume. They are wider only if
    /// narrower ones take too many boxes.
    pub relative: f64,
}

impl Request<'_> {
    /// All measures, with the default width of bounds.
    pub const ALL: Self = Self { quantities: &Quantity::ALL, relative: RELATIVE };

    /// Returns whether a measure is asked for.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.quantities.contains(&quantity)
    }
}

/// Measures a surface of a program in a region. Meshes are made in a [larger](zeroset_mesh::larger)
/// one, if there is one, and only if a measure needs them. Returns `None` once `wanted` returns
/// false.
///
/// # Errors
/// If the function is too large, or a kernel is not available.
///
/// # Panics
/// If there is no such surface, or the program is not valid in the
/// [domain](zeroset_mesh::domain) of a mesh.
pub fn measure(
    program: &Program,
    surface: usize,
    region: &Region,
    larger: Option<Region>,
    request: &Request<'_>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Measures>, ProgramError> {
    let is_solid = program.is_solid(surface);
    let has_ends = request.has(Quantity::Ends);
    let solid = if is_solid && (has_ends || request.quantities.iter().any(|one| one.is_of_solid()))
    {
        let kernels = SolidKernels::of(program, surface)?;
        let Some(solid) = solid(&kernels, region, request.relative, has_ends, wanted) else {
            return Ok(None);
        };
        Some(solid)
    } else {
        None
    };
    let tolerance = TOLERANCE * (region.high() - region.low()).length();
    let with = |tolerance: f64| {
        let options = zeroset_mesh::Options {
            region: *region,
            larger,
            tolerance,
            is_solid,
            is_estimated: false,
            has_large_faces: true,
            most_cells: MOST_CELLS,
        };
        mesh(program, surface, &options, wanted)
    };
    let (has_area, has_shape) = (request.has(Quantity::Area), request.has(Quantity::Shape));
    let needs_mesh = has_area || has_shape || has_ends && !is_solid;
    let fine = if needs_mesh { with(tolerance)? } else { Some(Mesh::default()) };
    let Some(fine) = fine else { return Ok(None) };
    let area = shape::area(&fine);
    let coarse = if has_area { with(COARSER * tolerance)? } else { Some(Mesh::default()) };
    let Some(coarse) = coarse else { return Ok(None) };
    Ok(Some(Measures {
        is_solid,
        ends: match &solid {
            Some(solid) => solid.low.zip(solid.high).map(<[_; 2]>::from),
            None => ends(&fine, tolerance),
        },
        solid,
        shape: shape::shape(&fine),
        unproven: fine.unproven.len(),
        area,
        area_change: (area - shape::area(&coarse)).abs(),
    }))
}

/// Bounds of the least and the greatest coordinates of a surface, from a mesh whose distance is
/// proven. `None` if it is not.
fn ends(mesh: &Mesh, tolerance: f64) -> Option<[[Interval; 3]; 2]> {
    if !mesh.is_proven() {
        return None;
    }
    let around =
        |at: f64| Interval { lo: (at - tolerance).next_down(), hi: (at + tolerance).next_up() };
    hull(mesh).map(|ends| ends.map(|end| end.to_array().map(around)))
}
