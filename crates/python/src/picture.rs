//! Pictures and their arrays.

use crate::arguments::{ends, import};
use crate::error::exception;
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A finished picture. Its arrays have one entry for each pixel, row by row from the top.
#[pyclass(frozen, module = "zeroset")]
pub struct Picture(pub zeroset::Picture);

impl Picture {
    fn shape(&self) -> (usize, usize) {
        (self.0.height(), self.0.width())
    }

    /// An array with a row of numbers for each pixel.
    fn rows<const N: usize, T: numpy::Element>(
        &self,
        rows: impl Iterator<Item = [T; N]>,
    ) -> Array3<T> {
        let (height, width) = self.shape();
        Array3::from_shape_vec((height, width, N), rows.flatten().collect())
            .expect("one row for each pixel")
    }

    fn single<T: numpy::Element>(&self, numbers: Vec<T>) -> Array2<T> {
        Array2::from_shape_vec(self.shape(), numbers).expect("one number for each pixel")
    }
}

#[pymethods]
impl Picture {
    /// Number of pixels in a row.
    #[getter]
    fn width(&self) -> usize {
        self.0.width()
    }

    /// Number of rows.
    #[getter]
    fn height(&self) -> usize {
        self.0.height()
    }

    /// Colors in sRGB: uint8 (H, W, 3).
    #[getter]
    fn rgb<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<u8>> {
        self.rows(self.0.rgb().as_chunks::<3>().0.iter().copied()).into_pyarray(py)
    }

    /// Opacity of each pixel: uint8 (H, W), or None unless the background is transparent.
    #[getter]
    fn alpha<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray2<u8>>> {
        let alpha = self.0.alpha();
        (!alpha.is_empty()).then(|| self.single(alpha.to_vec()).into_pyarray(py))
    }

    /// Light of each pixel: float32 (H, W, 4), red, green, blue and opacity. None unless the
    /// picture has 16 bits per channel.
    #[getter]
    fn light<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray3<f32>>> {
        let light = self.0.light();
        (!light.is_empty()).then(|| self.rows(light.iter().copied()).into_pyarray(py))
    }

    /// The status of each pixel's ray: uint8 (H, W). 0 is a proven miss, 1 a proven hit, 2 neither.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<u8>> {
        let code = |status: &zeroset::Status| match status {
            zeroset::Status::Miss => 0,
            zeroset::Status::Hit => 1,
            _ => 2,
        };
        self.single(self.0.status().iter().map(code).collect()).into_pyarray(py)
    }

    /// Distance of each drawn point along its ray: float64 (H, W), infinite at the background.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        self.single(self.0.depth().to_vec()).into_pyarray(py)
    }

    /// Bounds of the distance of each hit's first zero: float64 (H, W, 2), NaN elsewhere.
    #[getter]
    fn brackets<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.rows(self.0.brackets().iter().copied()).into_pyarray(py)
    }

    /// Unit normals toward f > 0: float32 (H, W, 3), 0 at the background. They are not proven.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f32>> {
        self.rows(self.0.normals().iter().copied()).into_pyarray(py)
    }

    /// The drawn points: float64 (H, W, 3), NaN at the background.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        self.rows(self.0.points()).into_pyarray(py)
    }

    /// The rays through the centers of the pixels: origins and unit directions, float64 (H, W, 3).
    #[getter]
    fn rays<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray3<f64>>; 2] {
        let (height, width) = self.shape();
        let places = || (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let ray = |(column, row)| self.0.ray(column, row).expect("a pixel of the picture");
        let length = |v: [f64; 3]| v.iter().map(|part| part * part).sum::<f64>().sqrt();
        let unit = |v: [f64; 3]| v.map(|part| part / length(v));
        let origins = self.rows(places().map(|at| ray(at).origin));
        let directions = self.rows(places().map(|at| unit(ray(at).direction)));
        [origins, directions].map(|array| array.into_pyarray(py))
    }

    /// Index of the surface drawn in each pixel: int32 (H, W). Surfaces are numbered from 0 in the
    /// order of the text. The background has −1.
    #[getter]
    fn surface<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i32>> {
        let (height, width) = self.shape();
        let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let number = |(column, row)| self.0.surface(column, row).map_or(-1, |n| n as i32);
        self.single(places.map(number).collect()).into_pyarray(py)
    }

    /// Number of pixels with each status: the keys are miss, hit and undecided.
    #[getter]
    fn counts(&self) -> BTreeMap<&'static str, usize> {
        let counts = self.0.counts();
        [("miss", counts.miss), ("hit", counts.hit), ("undecided", counts.undecided)].into()
    }

    /// Number of undecided pixels for each reason.
    #[getter]
    fn undecided(&self) -> BTreeMap<String, usize> {
        self.0.undecided().map(|(reason, count)| (reason.to_string(), count)).collect()
    }

    /// The view from which the picture was taken, as options of `render`: eye, target, up, and fov
    /// or orthographic.
    #[getter]
    fn camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let view = self.0.viewpoint();
        let options = PyDict::new(py);
        options.set_item("eye", view.eye)?;
        options.set_item("target", view.target)?;
        options.set_item("up", view.up)?;
        for (name, number) in [("fov", view.fov), ("orthographic", view.orthographic)] {
            if let Some(number) = number {
                options.set_item(name, number)?;
            }
        }
        Ok(options)
    }

    /// The box in which the surfaces were looked for: lower and upper end of x, y and z.
    #[getter]
    fn domain(&self) -> [[f64; 2]; 3] {
        self.0.domain().each_ref().map(ends)
    }

    /// Name of the method that found the surfaces.
    #[getter]
    fn method(&self) -> &'static str {
        self.0.method().name()
    }

    /// One line about each formula that is constant in the domain.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.0.remarks().to_vec()
    }

    /// The picture as an image of Pillow, which must be installed.
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let colors = || self.0.rgb().as_chunks::<3>().0.iter();
        let bytes = if self.0.alpha().is_empty() {
            self.rows(colors().copied())
        } else {
            let pixels = colors().zip(self.0.alpha());
            self.rows(pixels.map(|(&[red, green, blue], &alpha)| [red, green, blue, alpha]))
        };
        let image = import(py, "PIL.Image", "Picture.image")?;
        image.call_method1("fromarray", (bytes.into_pyarray(py),))
    }

    /// The picture as the bytes of a PNG file.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        py.detach(|| self.0.write_png(&mut bytes)).map_err(|error| exception(&error))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes the picture to a PNG file, which appears whole or not at all.
    ///
    /// Raises Error if the name does not end in .png, OSError if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.0.save(path)).map_err(|error| exception(&error))
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.png(py)
    }

    fn __repr__(&self) -> String {
        let zeroset::Counts { hit, miss, undecided, .. } = self.0.counts();
        let (height, width) = self.shape();
        format!("<Picture {width}x{height}: {hit} hits, {miss} misses, {undecided} undecided>")
    }
}
