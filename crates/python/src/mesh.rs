//! Triangles.

use crate::arguments::{ends, import};
use crate::error::exception;
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;

/// Triangles of all surfaces of a text.
#[pyclass(frozen, module = "zeroset")]
pub struct Mesh(pub Arc<zeroset::Mesh>);

/// Triangles of one surface.
#[pyclass(frozen, module = "zeroset")]
pub struct SurfaceMesh {
    mesh: Arc<zeroset::Mesh>,
    number: usize,
}

fn vertices<'a>(surfaces: impl Iterator<Item = &'a zeroset::SurfaceMesh>) -> Array2<f64> {
    let numbers: Vec<f64> =
        surfaces.flat_map(|mesh| mesh.vertices().as_flattened()).copied().collect();
    Array2::from_shape_vec((numbers.len() / 3, 3), numbers).expect("three numbers a vertex")
}

fn faces<'a>(surfaces: impl Iterator<Item = &'a zeroset::SurfaceMesh>) -> Array2<u32> {
    let (mut numbers, mut first) = (Vec::new(), 0);
    for mesh in surfaces {
        numbers.extend(mesh.faces().as_flattened().iter().map(|vertex| first + vertex));
        first += mesh.vertices().len() as u32;
    }
    Array2::from_shape_vec((numbers.len() / 3, 3), numbers).expect("three vertices a face")
}

#[pymethods]
impl Mesh {
    /// The vertices of all surfaces: float64 (N, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        vertices(self.0.surfaces().iter()).into_pyarray(py)
    }

    /// The triangles of all surfaces, as rows of `vertices`: uint32 (M, 3). Seen from outside,
    /// their vertices run counterclockwise.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u32>> {
        faces(self.0.surfaces().iter()).into_pyarray(py)
    }

    /// The meshes of the surfaces, in the order of the text.
    #[getter]
    fn surfaces(&self) -> Vec<SurfaceMesh> {
        let numbers = 0..self.0.surfaces().len();
        numbers.map(|number| SurfaceMesh { mesh: Arc::clone(&self.0), number }).collect()
    }

    /// True if every mesh is proven to have the shape of its surface.
    #[getter]
    fn proven(&self) -> bool {
        self.0.is_proven()
    }

    /// Largest distance between triangles and surface, in world units.
    #[getter]
    fn tolerance(&self) -> f64 {
        self.0.tolerance()
    }

    /// Writes the triangles to a file, which appears whole or not at all. The name ends in .stl,
    /// .obj, .ply, .3mf or .glb.
    ///
    /// Raises Error for another name or without triangles, OSError if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.0.save(path)).map_err(|error| exception(&error))
    }

    /// The triangles as a mesh of trimesh, which must be installed.
    fn to_trimesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(py);
        // Keep all vertices, in their order.
        options.set_item("process", false)?;
        let arguments = (self.vertices(py), self.faces(py));
        import(py, "trimesh", "Mesh.to_trimesh")?.call_method("Trimesh", arguments, Some(&options))
    }

    /// The triangles as a mesh of PyVista, which must be installed.
    fn to_pyvista<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        import(py, "pyvista", "Mesh.to_pyvista")?
            .getattr("PolyData")?
            .call_method1("from_regular_faces", (self.vertices(py), self.faces(py)))
    }

    fn __repr__(&self) -> String {
        let count: usize = self.0.surfaces().iter().map(|mesh| mesh.faces().len()).sum();
        let proven = if self.0.is_proven() { "proven" } else { "not proven" };
        format!("<Mesh of {count} triangles, {proven}>")
    }
}

impl SurfaceMesh {
    fn get(&self) -> &zeroset::SurfaceMesh {
        &self.mesh.surfaces()[self.number]
    }
}

#[pymethods]
impl SurfaceMesh {
    /// The surface's formula as it was read, in one line.
    #[getter]
    fn name(&self) -> &str {
        self.get().name()
    }

    /// The vertices: float64 (N, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        vertices([self.get()].into_iter()).into_pyarray(py)
    }

    /// The triangles, as rows of `vertices`: uint32 (M, 3).
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u32>> {
        faces([self.get()].into_iter()).into_pyarray(py)
    }

    /// True if the mesh is proven to have the shape of the surface.
    #[getter]
    fn proven(&self) -> bool {
        self.get().is_proven()
    }

    /// True if the mesh has no rim.
    #[getter]
    fn closed(&self) -> bool {
        self.get().is_closed()
    }

    /// The boxes in which nothing is proven: float64 (K, 3, 2), lower and upper end of x, y and z.
    #[getter]
    fn unproven<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        let boxes = self.get().unproven();
        let numbers: Vec<f64> = boxes.iter().flatten().flat_map(ends).collect();
        Array3::from_shape_vec((boxes.len(), 3, 2), numbers)
            .expect("six numbers a box")
            .into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        format!("<SurfaceMesh of {}: {} triangles>", self.name(), self.get().faces().len())
    }
}
