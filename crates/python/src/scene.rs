//! A text with its surfaces: values, bounds, rays, pictures, meshes and measures.

use crate::arguments::{
    DomainArgument, PRECISIONS, UNDECIDED, background, chosen, domain, ends, named, points, seconds,
};
use crate::error::{exception, wrong};
use crate::mesh::Mesh;
use crate::picture::Picture;
use crate::work::{Stop, interruptible};
use numpy::ndarray::{Array1, Array2};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock, RwLockReadGuard};
use zeroset::TraceSettings;
use zeroset::{Camera, Function, MeasureSettings, MeshSettings, Ray, RayResult, Settings};

/// A text with its surfaces.
#[pyclass(frozen, module = "zeroset")]
pub struct Scene {
    text: String,
    state: RwLock<State>,
}

/// The two forms in which the library takes the text, with the same values of parameters.
struct State {
    scene: zeroset::Scene,
    /// The text as a function. An error unless the text has exactly one equation.
    function: OnceLock<Result<Function, zeroset::Error>>,
}

type Arrays<'py, const N: usize> = [Bound<'py, PyArray1<f64>>; N];

impl Scene {
    /// The state for reading. The interpreter's lock must not be held: a thread that waits for it
    /// may hold the state.
    fn state(&self) -> RwLockReadGuard<'_, State> {
        self.state.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Calls `work` with the function, without the interpreter's lock.
    fn with_function<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&Function) -> Result<T, zeroset::Error> + Send,
    ) -> PyResult<T> {
        let found = py.detach(|| {
            let state = self.state();
            let function = state.function.get_or_init(|| {
                let mut function = Function::parse(&self.text)?;
                for parameter in state.scene.parameters() {
                    function.set(&parameter.name, parameter.value)?;
                }
                Ok(function)
            });
            function.as_ref().map_err(Clone::clone).and_then(work)
        });
        found.map_err(|error| exception(&error))
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, text: String) -> PyResult<Self> {
        let scene = py.detach(|| zeroset::Scene::read(&text)).map_err(|error| exception(&error))?;
        let state = RwLock::new(State { scene, function: OnceLock::new() });
        Ok(Self { text, state })
    }

    /// The text as it was given.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The surfaces as they were read, one line each.
    #[getter]
    fn surfaces(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.state().scene.surfaces().map(str::to_owned).collect())
    }

    /// Places where the text could have been meant otherwise.
    #[getter]
    fn notes(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.state().scene.notes().iter().map(ToString::to_string).collect())
    }

    /// Names, values and ranges of the parameters.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> Vec<(String, f64, Option<[f64; 2]>)> {
        let parameters = py.detach(|| self.state().scene.parameters());
        let row = |one: zeroset::Parameter| (one.name, one.value, one.range.as_ref().map(ends));
        parameters.into_iter().map(row).collect()
    }

    /// Sets a parameter.
    fn set(&self, py: Python<'_>, name: &str, value: f64) -> PyResult<()> {
        let set = || {
            let mut state = self.state.write().unwrap_or_else(PoisonError::into_inner);
            state.scene.set(name, value)?;
            match state.function.get_mut() {
                Some(Ok(function)) => function.set(name, value),
                _ => Ok(()),
            }
        };
        py.detach(set).map_err(|error| exception(&error))
    }

    /// Writes values at points, given as arrays (N,) of coordinates, to `out` (N,): NaN where the
    /// function is undefined. The caller allocates `out`, since NumPy uses large pages, which the
    /// system supplies sooner.
    fn values<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
        z: PyReadonlyArray1<'py, f64>,
        mut out: PyReadwriteArray1<'py, f64>,
    ) -> PyResult<()> {
        let axes = [x.as_slice()?, y.as_slice()?, z.as_slice()?];
        let out = out.as_slice_mut()?;
        self.with_function(py, |function| function.eval_axes(axes, out))
    }

    /// Gradients at points (N, 3): float64 (N, 3), NaN where the function has no gradient.
    fn gradients<'py>(
        &self,
        py: Python<'py>,
        at: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let at = points("points", &at)?;
        let found = self.with_function(py, |function| function.gradient(at))?;
        let rows = Array2::from_shape_vec((found.len(), 3), found.as_flattened().to_vec());
        Ok(rows.expect("three numbers a point").into_pyarray(py))
    }

    /// Bounds over boxes, given by their corners (N, 3). Returns lower bounds, upper bounds, and
    /// facts as bits: 1 undefined, 2 defined, 4 continuous.
    fn enclosures<'py>(
        &self,
        py: Python<'py>,
        low: PyReadonlyArray2<'py, f64>,
        high: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<(Arrays<'py, 2>, Bound<'py, PyArray1<u8>>)> {
        let (low, high) = (points("lo", &low)?, points("hi", &high)?);
        if low.len() != high.len() {
            return Err(wrong(format!("lo has {} rows, hi has {}", low.len(), high.len())));
        }
        let found = self.with_function(py, |function| {
            let corners = low.iter().zip(high);
            let boxes: Vec<_> = corners
                .map(|(low, high)| std::array::from_fn(|axis| low[axis]..=high[axis]))
                .collect();
            function.enclose(&boxes)
        })?;
        let (lower, upper): (Vec<f64>, Vec<f64>) =
            found.iter().map(|one| (*one.bounds.start(), *one.bounds.end())).unzip();
        let bounds = [lower, upper].map(|numbers| numbers.into_pyarray(py));
        let facts = |one: &zeroset::Enclosure| {
            u8::from(one.undefined) | u8::from(one.defined) << 1 | u8::from(one.continuous) << 2
        };
        Ok((bounds, found.iter().map(facts).collect::<Array1<u8>>().into_pyarray(py)))
    }

    /// Follows rays, given by origins and directions (N, 3). Returns t where the surface is drawn,
    /// lower and upper ends of brackets, and statuses: 0 miss, 1 hit, 2 undecided.
    #[pyo3(signature = (origins, directions, *, region=None, method=None, precision=None, accuracy=None))]
    fn rays<'py>(
        &self,
        py: Python<'py>,
        origins: PyReadonlyArray2<'py, f64>,
        directions: PyReadonlyArray2<'py, f64>,
        region: Option<DomainArgument>,
        method: Option<&str>,
        precision: Option<&str>,
        accuracy: Option<f64>,
    ) -> PyResult<(Arrays<'py, 3>, Bound<'py, PyArray1<u8>>)> {
        let origins = points("origins", &origins)?;
        let directions = points("directions", &directions)?;
        if origins.len() != directions.len() {
            let [a, b] = [origins.len(), directions.len()];
            return Err(wrong(format!("origins has {a} rows, directions has {b}")));
        }
        let mut settings = TraceSettings::new().domain(domain(region)?);
        if let Some(method) = method {
            settings = settings.method(named(method)?);
        }
        if let Some(precision) = precision {
            settings = settings.precision(chosen("precision", precision, &PRECISIONS)?);
        }
        if let Some(accuracy) = accuracy {
            settings = settings.accuracy(accuracy);
        }
        let found = self.with_function(py, |function| {
            let pairs = origins.iter().zip(directions);
            let rays: Vec<Ray> =
                pairs.map(|(&origin, &direction)| Ray { origin, direction }).collect();
            function.trace_with(&rays, &settings)
        })?;
        let row = |result: &RayResult| match *result {
            RayResult::Miss => ([f64::INFINITY, f64::NAN, f64::NAN], 0),
            RayResult::Hit { t, bracket: [near, far], .. } => ([t, near, far], 1),
            RayResult::Undecided { from, t, .. } => {
                ([t.unwrap_or(f64::INFINITY), from, f64::NAN], 2)
            }
            _ => ([f64::NAN; 3], 2),
        };
        let (numbers, statuses): (Vec<[f64; 3]>, Vec<u8>) = found.iter().map(row).unzip();
        let columns = [0, 1, 2]
            .map(|n| numbers.iter().map(|row| row[n]).collect::<Array1<f64>>().into_pyarray(py));
        Ok((columns, statuses.into_pyarray(py)))
    }

    /// The box in which `rays` looks for zeros: lower and upper end of x, y and z.
    fn domain(&self, py: Python<'_>) -> PyResult<[[f64; 2]; 3]> {
        self.with_function(py, |function| Ok(function.domain()?.each_ref().map(ends)))
    }

    /// Renders a picture; `settings` has the options of `Surface.render`. `stop` ends it.
    /// `progress` is called with the stage and its percent, whenever these have changed.
    #[pyo3(signature = (width, height, settings, stop=None, progress=None))]
    fn render(
        &self,
        py: Python<'_>,
        width: usize,
        height: usize,
        settings: &Bound<'_, PyDict>,
        stop: Option<PyRef<'_, Stop>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Picture> {
        let mut options = Settings::new(width, height);
        let mut camera = Camera::new();
        for (key, value) in settings {
            let key: String = key.extract()?;
            let name = || value.extract::<String>();
            let number = || value.extract::<f64>();
            let is_on = || value.extract::<bool>();
            let point = || value.extract::<[f64; 3]>();
            options = match key.as_str() {
                "domain" => options.domain(domain(Some(value.extract()?))?),
                "method" => options.method(named(&name()?)?),
                "precision" => options.precision(chosen("precision", &name()?, &PRECISIONS)?),
                "max_depth" => options.max_depth(value.extract()?),
                "steps" => options.steps(value.extract()?),
                "tolerance" => options.tolerance(number()?),
                "look" => options.look(named(&name()?)?),
                "background" => options.background(background(&value)?),
                "light" => options.light(point()?),
                "occlusion" => options.occlusion(is_on()?),
                "antialias" => options.antialias(value.extract()?),
                "bits" => options.bits(value.extract()?),
                "undecided" => options.undecided(chosen("undecided", &name()?, &UNDECIDED)?),
                "title" => options.title(name()?),
                "budget" => options.budget(seconds(number()?)?),
                key if Settings::choices().any(|(name, _)| name == key) => {
                    let value = match is_on() {
                        Ok(is_on) => ["off", "on"][usize::from(is_on)].to_owned(),
                        Err(_) => number()?.to_string(),
                    };
                    options.set(key, &value).map_err(|error| exception(&error))?
                }
                _ => {
                    camera = match key.as_str() {
                        "view" => camera.view(named(&name()?)?),
                        "eye" => camera.eye(point()?),
                        "target" => camera.target(point()?),
                        "up" => camera.up(point()?),
                        "fov" => camera.fov(number()?),
                        "orthographic" => camera.orthographic(number()?),
                        _ => {
                            let why = format!("render has no option {key:?}");
                            return Err(PyTypeError::new_err(why));
                        }
                    };
                    options
                }
            };
        }
        let options = options.camera(camera);
        let (own, given) = (Stop::new(), stop.as_deref());
        let told = Mutex::new(None);
        let tell = |stage: &'static str, percent: usize| {
            *told.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage, percent));
        };
        let mut shown = None;
        let show = |py: Python<'_>| {
            let now = *told.lock().unwrap_or_else(PoisonError::into_inner);
            let (Some(call), Some(now)) = (&progress, now.filter(|_| now != shown)) else {
                return Ok(());
            };
            shown = Some(now);
            call.call1(py, now).map(drop)
        };
        let found = interruptible(py, given.unwrap_or(&own), show, |stop| {
            let options = options.clone().stop(stop);
            let scene = &self.state().scene;
            if progress.is_some() {
                scene.render_telling(&options, &tell)
            } else {
                scene.render(&options)
            }
        })?;
        found.map(Picture).map_err(|error| exception(&error))
    }

    /// Makes triangles of all surfaces.
    #[pyo3(signature = (*, region=None, tolerance=None, estimate=false, full=false, budget=None))]
    fn mesh(
        &self,
        py: Python<'_>,
        region: Option<DomainArgument>,
        tolerance: Option<f64>,
        estimate: bool,
        full: bool,
        budget: Option<f64>,
    ) -> PyResult<Mesh> {
        let mut settings = MeshSettings::new().domain(domain(region)?);
        if let Some(tolerance) = tolerance {
            settings = settings.tolerance(tolerance);
        }
        if estimate {
            settings = settings.estimate();
        }
        if full {
            settings = settings.full();
        }
        if let Some(budget) = budget {
            settings = settings.budget(seconds(budget)?);
        }
        let found = interruptible(
            py,
            &Stop::new(),
            |_| Ok(()),
            |stop| self.state().scene.mesh(&settings.clone().stop(stop)),
        )?;
        found.map(|mesh| Mesh(Arc::new(mesh))).map_err(|error| exception(&error))
    }

    /// Measures all surfaces. Returns a dictionary for each.
    #[pyo3(signature = (*, region=None, only=None, relative=None, density=None, budget=None))]
    fn measure<'py>(
        &self,
        py: Python<'py>,
        region: Option<DomainArgument>,
        only: Option<Vec<String>>,
        relative: Option<f64>,
        density: Option<String>,
        budget: Option<f64>,
    ) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let mut settings = MeasureSettings::new().domain(domain(region)?);
        if let Some(only) = only {
            let named: PyResult<Vec<zeroset::Measure>> =
                only.iter().map(|one| named(one)).collect();
            settings = settings.only(named?);
        }
        if let Some(relative) = relative {
            settings = settings.relative(relative);
        }
        if let Some(density) = density {
            settings = settings.density(density);
        }
        if let Some(budget) = budget {
            settings = settings.budget(seconds(budget)?);
        }
        let found = interruptible(
            py,
            &Stop::new(),
            |_| Ok(()),
            |stop| self.state().scene.measure(&settings.clone().stop(stop)),
        )?;
        let found = found.map_err(|error| exception(&error))?;
        let row = |one: zeroset::Measures| {
            let row = PyDict::new(py);
            row.set_item("name", one.name)?;
            row.set_item("volume", one.volume.as_ref().map(ends))?;
            row.set_item("mass", one.mass.as_ref().map(ends))?;
            row.set_item("centroid", one.centroid.map(|all| all.each_ref().map(ends)))?;
            row.set_item("moments", one.moments.map(|all| all.each_ref().map(ends)))?;
            let corners = one.ends.map(|both| both.map(|all| all.each_ref().map(ends)));
            row.set_item("corners", corners)?;
            row.set_item("area_bounds", one.area_bounds.as_ref().map(ends))?;
            row.set_item("area", one.area)?;
            row.set_item("area_change", one.area_change)?;
            row.set_item("genus", one.genus)?;
            row.set_item("proven", one.is_shape_proven)?;
            Ok(row)
        };
        found.into_iter().map(row).collect()
    }
}

/// Names and texts of the gallery's surfaces.
#[pyfunction]
pub fn gallery() -> Vec<(String, String)> {
    zeroset::gallery().map(|example| (example.name.to_owned(), example.text.to_owned())).collect()
}

/// Names of the methods that find surfaces, each with a line of help.
#[pyfunction]
pub fn methods() -> Vec<(&'static str, &'static str)> {
    zeroset::Method::all().map(|method| (method.name(), method.help())).collect()
}

/// Names of the looks, each with a line of help.
#[pyfunction]
pub fn looks() -> Vec<(&'static str, &'static str)> {
    zeroset::Look::all().map(|look| (look.name(), look.help())).collect()
}

/// Names of the choices for a picture, each with a line of help.
#[pyfunction]
pub fn choices() -> Vec<(&'static str, String)> {
    Settings::choices().collect()
}

/// Names of the views.
#[pyfunction]
pub fn views() -> Vec<&'static str> {
    zeroset::View::all().map(zeroset::View::name).collect()
}
