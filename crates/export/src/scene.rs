//! The meshes of a document's visible surfaces.

use crate::color::{Color, map_colors};
use std::time::{Duration, Instant};
use zeroset_mesh::{
    MOST_CELLS, Mesh, Options, ParametricOptions, Simplification, TOLERANCE, larger, mesh,
    parametric_mesh, simplify,
};
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::program::{Program, ProgramError};
use zeroset_scene::view::{self, Clipping, DomainChoice, SceneError};
use zeroset_space::Region;
use zeroset_syntax::{Document, SurfaceColor};

/// The mesh of one surface.
#[derive(Clone, Debug)]
pub struct Object {
    /// The surface's statement, in one line.
    pub name: String,
    /// Its mesh.
    pub mesh: Mesh,
    /// Its color.
    pub color: Color,
}

/// The meshes of all visible surfaces.
#[derive(Clone, Debug)]
pub struct Meshes {
    /// The meshes, in the order of the document.
    pub objects: Vec<Object>,
    /// The box that they fill.
    pub region: Region,
    /// How the box was found, if it was not given.
    pub searched: Option<AutoDomain>,
    /// Largest allowed distance between a mesh and its surface, in world units.
    pub tolerance: f64,
    /// Notes on surfaces whose functions are constant in the domain.
    pub remarks: Vec<String>,
    /// True if no visible surface's function has a value in the domain.
    pub is_undefined: bool,
    /// Time that simplifying took.
    pub simplify: Duration,
    /// Time that meshing took.
    pub mesh: Duration,
}

/// The tolerance of a mesh, and whether it is proven.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quality {
    /// Largest distance between triangles and surface, in world units. `None` for a thousandth of
    /// the domain's diagonal.
    pub tolerance: Option<f64>,
    /// True if bounds are [estimated](Options::is_estimated) instead of proven.
    pub is_estimated: bool,
    /// True if all triangles of the first mesh stay, instead of as few as the tolerance allows. So
    /// they do for a surface with a color map, whose colors need them, and if bounds are estimated.
    pub is_full: bool,
}

/// Makes the meshes of all visible surfaces, in the document's region. Returns `None` once `wanted`
/// returns false.
///
/// # Errors
/// If there is no domain, or a function is constant, defined nowhere or too large.
pub fn meshes(
    document: &Document,
    domain: DomainChoice,
    cut: Clipping,
    Quality { tolerance, is_estimated, is_full }: Quality,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Meshes>, SceneError> {
    let found = view::region_while(&mut None, document, domain, cut, wanted)?;
    let Some((region, searched)) = found else { return Ok(None) };
    let clock = Instant::now();
    let larger = larger(&region, searched.as_ref());
    let program = Program::new(document, zeroset_mesh::domain(&larger.unwrap_or(region)))?;
    let simplifying = clock.elapsed();
    let tolerance = tolerance.unwrap_or(TOLERANCE * (region.high() - region.low()).length());
    let clock = Instant::now();
    let program = program.with_patches(document)?;
    let visible = document.drawn_surfaces().enumerate().filter(|(_, surface)| !surface.hidden);
    let (mut objects, mut surfaces, mut is_undefined) = (Vec::new(), Vec::new(), true);
    for (number, surface) in visible {
        let (name, color) = (surface.line(), Color::of(number, &surface));
        surfaces.push(number);
        let is_mapped = matches!(surface.color, Some(SurfaceColor::Mapped(_)));
        let is_full = is_full || is_mapped;
        if let Some(patch) = program.patch(number) {
            is_undefined = false;
            let tree = patch.tree().map_err(ProgramError::from)?;
            let options = ParametricOptions { region, tolerance, is_full, most_cells: MOST_CELLS };
            let Some(mesh) = parametric_mesh(tree, &options, wanted) else { return Ok(None) };
            objects.push(Object { name, mesh, color });
            continue;
        }
        is_undefined &= program.is_undefined(number);
        let is_solid = program.is_solid(number);
        // Half of the tolerance is for the first mesh, and half for fewer triangles.
        let distance = if is_full || is_estimated { 0.0 } else { 0.5 * tolerance };
        let options = Options {
            region,
            larger,
            tolerance: tolerance - distance,
            is_solid,
            is_estimated,
            has_large_faces: distance > 0.0,
            most_cells: MOST_CELLS,
        };
        let Some(mut mesh) = mesh(&program, number, &options, wanted)? else { return Ok(None) };
        if distance > 0.0 {
            let options = Simplification { region, tolerance, distance };
            let done = simplify(&program, number, &mut mesh, &options, wanted);
            if done.map_err(ProgramError::from)?.is_none() {
                return Ok(None);
            }
        }
        objects.push(Object { name, mesh, color });
    }
    map_colors(document, &surfaces, &mut objects);
    let mesh = clock.elapsed();
    let remarks = program.remarks(document);
    Ok(Some(Meshes {
        objects,
        region,
        searched,
        tolerance,
        remarks,
        is_undefined,
        simplify: simplifying,
        mesh,
    }))
}

impl Meshes {
    /// Returns whether no surface has a triangle.
    pub fn is_empty(&self) -> bool {
        self.objects.iter().all(|object| object.mesh.triangles.is_empty())
    }
}
