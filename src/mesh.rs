//! Meshes of scenes, and their settings.

use crate::error::Error;
use crate::settings::Domain;
use glam::DVec3;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use zeroset_export::{Format, Meshes, Object, Quality, meshes};
use zeroset_render::atomic_file::AtomicFile;
use zeroset_render::limit::{Limit, StopFlag};
use zeroset_scene::view::Clipping;
use zeroset_syntax::Document;

/// Settings of a mesh, for [`Scene::mesh`](crate::Scene::mesh).
///
/// ```
/// let settings = zeroset::MeshSettings::new()
///     .domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0])
///     .tolerance(1e-2);
/// # let _ = settings;
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[must_use]
pub struct MeshSettings {
    domain: Domain,
    tolerance: Option<f64>,
    is_estimated: bool,
    is_full: bool,
    limit: Limit,
}

/// Triangles of a scene's surfaces, and what is proven of them.
#[derive(Clone, Debug)]
pub struct Mesh {
    surfaces: Vec<SurfaceMesh>,
    objects: Vec<Object>,
    tolerance: f64,
}

/// Triangles of one surface.
#[derive(Clone, Debug)]
pub struct SurfaceMesh {
    name: String,
    vertices: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    unproven: Vec<[RangeInclusive<f64>; 3]>,
    is_proven: bool,
    is_closed: bool,
}

impl MeshSettings {
    /// Returns the default settings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the box in which the surfaces are looked for. Default: [`Domain::Text`].
    pub fn domain(mut self, domain: impl Into<Domain>) -> Self {
        self.domain = domain.into();
        self
    }

    /// Sets the largest distance between triangles and surface, in world units. Must be above 0.
    /// Default: a thousandth of the domain's diagonal.
    pub fn tolerance(mut self, length: f64) -> Self {
        self.tolerance = Some(length);
        self
    }

    /// Estimates bounds from samples, so that nothing is proven. Many meshes are done several times
    /// as fast.
    pub fn estimate(mut self) -> Self {
        self.is_estimated = true;
        self
    }

    /// Keeps all triangles of the first mesh. Default: as few triangles as the tolerance allows.
    pub fn full(mut self) -> Self {
        self.is_full = true;
        self
    }

    /// Limits the time. A mesh that is not done in time is an error. Default: no limit.
    pub fn budget(mut self, time: Duration) -> Self {
        self.limit.budget = Some(time);
        self
    }

    /// Ends the work once the flag is set, with an error. Default: none.
    pub fn stop(mut self, flag: &'static AtomicBool) -> Self {
        self.limit.stop = Some(StopFlag(flag));
        self
    }
}

impl Mesh {
    pub(crate) fn new(document: &Document, settings: &MeshSettings) -> Result<Self, Error> {
        let &MeshSettings { tolerance, is_estimated, is_full, limit, .. } = settings;
        let quality = Quality { tolerance, is_estimated, is_full };
        if !tolerance.is_none_or(|tolerance| tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::argument("tolerance must be a finite length above 0"));
        }
        let wanted = limit.wanted();
        let found =
            meshes(document, settings.domain.choice(), Clipping::default(), quality, &wanted);
        let Some(Meshes { objects, tolerance, .. }) = found.map_err(Error::scene)? else {
            return Err(Error::unfinished("the mesh was", &limit));
        };
        Ok(Self { surfaces: objects.iter().map(SurfaceMesh::of).collect(), objects, tolerance })
    }

    /// Returns the meshes of all surfaces that are not hidden, in the order of the text.
    pub fn surfaces(&self) -> &[SurfaceMesh] {
        &self.surfaces
    }

    /// Returns the largest distance between triangles and surface, in world units.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Returns whether the mesh of every surface [is proven](SurfaceMesh::is_proven).
    pub fn is_proven(&self) -> bool {
        self.surfaces.iter().all(SurfaceMesh::is_proven)
    }

    /// Writes the triangles to a file, with colors and normals if the format has them. The path's
    /// extension names the format: `stl`, `obj`, `ply`, `3mf` or `glb`. A 3MF file's coordinates
    /// are millimeters. The file appears whole or not at all.
    ///
    /// # Errors
    /// If the path has another extension or cannot be written, or if there are no triangles.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let format = Format::of(path).map_err(Error::argument)?;
        if self.surfaces.iter().all(|surface| surface.faces.is_empty()) {
            return Err(Error::argument("there are no triangles to write"));
        }
        let save = || {
            let mut file = AtomicFile::create(path)?;
            format.write(&self.objects, None, &mut file)?;
            file.commit()
        };
        save().map_err(|error| Error::file(path, &error))
    }
}

impl SurfaceMesh {
    fn of(object: &Object) -> Self {
        let mesh = &object.mesh;
        let ranges = |centre: DVec3, size: DVec3| {
            let (low, high) = (centre - 0.5 * size, centre + 0.5 * size);
            [low.x..=high.x, low.y..=high.y, low.z..=high.z]
        };
        Self {
            name: object.name.clone(),
            vertices: mesh.vertices.iter().map(DVec3::to_array).collect(),
            faces: mesh.triangles.clone(),
            unproven: mesh.unproven.iter().map(|cell| ranges(cell.centre, cell.size)).collect(),
            is_proven: mesh.is_proven(),
            is_closed: mesh.is_closed,
        }
    }

    /// Returns the surface's formula as it was read, in one line.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the places of the vertices, in world units.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Returns the vertices of each triangle, by number. They go counterclockwise as seen from
    /// outside, where the function is above 0. If it is below 0 around a closed piece of an
    /// equation, outside is where it is below 0, for this piece and for all pieces inside of it.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns whether the mesh is proven to be isotopic to the surface in the domain, and within
    /// the tolerance of it.
    pub fn is_proven(&self) -> bool {
        self.is_proven
    }

    /// Returns boxes around the places in which the shape is not proven.
    pub fn unproven(&self) -> &[[RangeInclusive<f64>; 3]] {
        &self.unproven
    }

    /// Returns whether the triangles have no rim.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }
}
