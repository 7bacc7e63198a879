//! The native half of the Python package `zeroset`: the module `zeroset._zeroset`. The Python half,
//! under `python/zeroset`, reads formulas of other kinds and has what users call.
//!
//! Arrays are NumPy's, row by row. Kernels run on other threads while the interpreter's lock is
//! released, and an interrupt from the keyboard ends them.

mod arguments;
mod error;
mod mesh;
mod picture;
mod scene;
mod work;

use pyo3::prelude::*;

/// Compiled formulas, pictures and meshes.
#[pymodule]
mod _zeroset {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::error::Error;
    #[pymodule_export]
    use super::mesh::{Mesh, SurfaceMesh};
    #[pymodule_export]
    use super::picture::Picture;
    #[pymodule_export]
    use super::scene::{Scene, choices, gallery, looks, methods, views};
    #[pymodule_export]
    use super::work::Stop;

    /// Adds the version.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
