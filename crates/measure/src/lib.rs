//! Measures of surfaces: volume, mass, centroid and inertia of solids between proven bounds, area
//! between proven bounds and as an estimate, and pieces and genus where they are proven.

mod area;
mod clip;
mod density;
mod hint;
mod inertia;
mod part;
mod pieces;
mod polygon;
mod quantity;
mod scene;
mod shape;
mod taylor;
mod text;
mod volume;
mod wall;

pub use area::{Area, area};
pub use density::{Density, DensityFault};
pub use inertia::Inertia;
pub use quantity::Quantity;
pub use scene::{MeasureError, Measured, measures};
pub use shape::{Piece, Shape};
pub use volume::{Limit, Solid, SolidKernels, solid};

use shape::hull;
use zeroset_interval::Interval;
use zeroset_mesh::{Mesh, mesh};
use zeroset_scene::program::Program;
use zeroset_space::Region;
use zeroset_syntax::Document;

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
    /// Mass and moments, weighted by the density. `None` without a density.
    pub weighted: Option<Solid>,
    /// The least and the greatest coordinates of the surface. `None` if they are not proven.
    pub ends: Option<[[Interval; 3]; 2]>,
    /// Pieces and genus of a mesh.
    pub shape: Shape,
    /// Number of cells in which the mesh is not proven to have the surface's shape. If it is 0,
    /// `shape` is the shape of the surface. 0 without a mesh.
    pub unproven: usize,
    /// Bounds of the area. `None` without a request, or if the function has too many parts.
    pub area_bounds: Option<Area>,
    /// The area of a mesh: an estimate.
    pub area: f64,
    /// The difference from the area of a coarser mesh.
    pub area_change: f64,
}

impl Measures {
    /// The centroid and the moments of inertia. `None` if they were not asked for, or the volume or
    /// the mass may be 0.
    pub fn inertia(&self) -> Option<Inertia> {
        self.weighted.as_ref().or(self.solid.as_ref())?.inertia()
    }

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
    /// Largest width of a volume's bounds, as a share of the volume, and of those of a mass or an
    /// area. They are wider only if narrower ones take too many boxes.
    pub relative: f64,
    /// The density of solids: the function of the document's one surface. Without it, the density
    /// is 1.
    pub density: Option<&'a Document>,
    /// True if the area is to have bounds, if it is asked for. They take ten times as long as the
    /// estimate.
    pub has_area_bounds: bool,
}

impl Request<'_> {
    /// All measures, with the default width of bounds, and without those of the area.
    pub const ALL: Self = Self {
        quantities: &Quantity::ALL,
        relative: RELATIVE,
        density: None,
        has_area_bounds: false,
    };

    /// Returns whether a measure is asked for. There is no mass without a density.
    pub fn has(&self, quantity: Quantity) -> bool {
        self.quantities.contains(&quantity)
            && (quantity != Quantity::Mass || self.density.is_some())
    }

    /// Returns whether a measure is asked for that takes integrals over a solid, either weighted by
    /// the density or not.
    fn has_integrals(&self, is_weighted: bool) -> bool {
        let is_such = |one: &&Quantity| {
            one.is_of_solid() && is_weighted == (one.is_weighted() && self.density.is_some())
        };
        self.quantities.iter().filter(is_such).any(|one| self.has(*one))
    }
}

/// Measures a surface of a program in a region. Meshes are made in a [larger](zeroset_mesh::larger)
/// one, if there is one, and only if a measure needs them. Returns `None` once `wanted` returns
/// false.
///
/// # Errors
/// If a function is too large, a kernel is not available, or the density has no value or no bounds
/// in the solid.
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
) -> Result<Option<Measures>, MeasureError> {
    let is_solid = program.is_solid(surface);
    let has_ends = request.has(Quantity::Ends);
    let integrals = |density: Option<&Density>, has_ends: bool| {
        let mut kernels = SolidKernels::of(program, surface)?;
        if let Some(density) = density {
            kernels = kernels.weighted(density);
        }
        let solid = solid(&kernels, region, request.relative, has_ends, wanted);
        match solid.and_then(|solid| solid.fault) {
            Some(fault) => Err(MeasureError::from(fault)),
            None => Ok(solid),
        }
    };
    let (mut solid, mut weighted) = (None, None);
    if is_solid && (has_ends || request.has_integrals(false)) {
        solid = integrals(None, has_ends)?;
        if solid.is_none() {
            return Ok(None);
        }
    }
    if let Some(density) = request.density.filter(|_| is_solid && request.has_integrals(true)) {
        let density = Density::new(density, program.domain())?;
        weighted = integrals(Some(&density), false)?;
        if weighted.is_none() {
            return Ok(None);
        }
    }
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
    let mut area_bounds = None;
    if has_area && request.has_area_bounds {
        let found = self::area(program, surface, region, larger, request.relative, wanted)?;
        let Some(found) = found else { return Ok(None) };
        area_bounds = found;
    }
    Ok(Some(Measures {
        is_solid,
        area_bounds,
        ends: match &solid {
            Some(solid) => solid.low.zip(solid.high).map(<[_; 2]>::from),
            None => ends(&fine, tolerance),
        },
        solid,
        weighted,
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
