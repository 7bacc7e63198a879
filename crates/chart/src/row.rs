//! A row of results: a surface, a view and a configuration, with everything needed to repeat it.

use crate::error::ChartError;
use crate::errors::PixelErrors;
use crate::grid::Configuration;
use crate::machine::Environment;
use crate::measure::Measured;
use crate::surfaces::ChartSurface;
use crate::views::View;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use zeroset_render::names::Named;
use zeroset_space::{Camera, Projection};
use zeroset_trace::{GBuffer, KernelStats, Method, Precision};

/// Conditions that the rows of one view of one surface share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditions {
    /// Side of the square picture, in pixels.
    pub size: usize,
    /// Number of threads.
    pub threads: usize,
    /// Seed of views, sampled pixels and order.
    pub seed: u64,
    /// Number of measured pictures per configuration.
    pub repeats: usize,
    /// Approximate number of pixels checked for errors; 0 for all.
    pub samples: usize,
}

/// Defines the row from its columns: the name of each, its type, and its value in a new row.
macro_rules! columns {
    (
        ($($given:ident: $given_type:ty,)*)
        { $(let $pattern:pat = $part:expr;)* }
        $($(#[$doc:meta])* $column:ident: $type:ty = $value:expr,)*
    ) => {
        /// A row of results. Times are in milliseconds. Distances are in world units, or in pixels
        /// if the field's name says so.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[allow(missing_docs)] // names of columns; docs/performance.md says what is measured
        pub struct Row {
            $($(#[$doc])* pub $column: $type,)*
        }

        impl Row {
            /// A row from the parts of a measurement.
            pub fn new($($given: $given_type,)*) -> Self {
                $(let $pattern = $part;)*
                Self { $($column: $value,)* }
            }
        }
    };
}

columns! {
    (
        surface: &ChartSurface,
        view: &View,
        conditions: Conditions,
        configuration: &Configuration,
        measured: &Measured,
        errors: &PixelErrors,
        machine: &Environment,
    )
    {
        let [eye, target, up] = [view.camera.eye(), view.camera.target(), view.camera.up()];
        let fov = match view.camera.projection() {
            Projection::Perspective { fov } => fov,
            Projection::Orthographic { .. } => 0.0,
        };
        let statistics = &measured.picture.statistics;
        let KernelStats { interval, tiles, segments, point, gradient, given_up, .. } =
            statistics.work;
        let of = |three: Option<[f64; 3]>, place: usize| three.map(|three| three[place]);
    }
    surface: String = surface.name.clone(),
    view: String = view.name.clone(),
    eye_x: f64 = eye.x,
    eye_y: f64 = eye.y,
    eye_z: f64 = eye.z,
    target_x: f64 = target.x,
    target_y: f64 = target.y,
    target_z: f64 = target.z,
    up_x: f64 = up.x,
    up_y: f64 = up.y,
    up_z: f64 = up.z,
    fov: f64 = fov,
    size: usize = conditions.size,
    method: String = configuration.method.name.to_owned(),
    precision: Option<String> = configuration.precision.map(|precision| precision.to_string()),
    max_depth: Option<u32> = configuration.depth,
    tolerance: Option<f64> = configuration.tolerance,
    steps: Option<u32> = configuration.steps,
    threads: usize = conditions.threads,
    seed: u64 = conditions.seed,
    repeats: usize = conditions.repeats,
    samples: usize = conditions.samples,
    trace_ms: f64 = measured.trace.median,
    trace_ms_lower: f64 = measured.trace.lower,
    trace_ms_upper: f64 = measured.trace.upper,
    shade_ms: f64 = measured.shade.median,
    total_ms: f64 = measured.total.median,
    total_ms_lower: f64 = measured.total.lower,
    total_ms_upper: f64 = measured.total.upper,
    compile_ms: f64 = measured.compile,
    cold_ms: f64 = measured.cold,
    looked_at: usize = errors.samples,
    open: usize = errors.open,
    roots: usize = errors.roots,
    missed: usize = errors.missed,
    phantom: usize = errors.phantom,
    wrong_root: usize = errors.wrong_root,
    /// Pixels with a false status: these are wrong even if all undecided pixels are right.
    false_claims: usize = errors.false_claims,
    undecided: usize = errors.undecided,
    painted: usize = errors.painted,
    off_pixels_median: Option<f64> = of(errors.off_pixels, 0),
    off_pixels_999: Option<f64> = of(errors.off_pixels, 1),
    off_pixels_max: Option<f64> = of(errors.off_pixels, 2),
    off_median: Option<f64> = of(errors.off, 0),
    off_999: Option<f64> = of(errors.off, 1),
    off_max: Option<f64> = of(errors.off, 2),
    normal_degrees_median: Option<f64> = of(errors.normal_degrees, 0),
    normal_degrees_999: Option<f64> = of(errors.normal_degrees, 1),
    normal_degrees_max: Option<f64> = of(errors.normal_degrees, 2),
    pixels_miss: usize = statistics.pixels.miss,
    pixels_hit: usize = statistics.pixels.hit,
    pixels_undecided: usize = statistics.pixels.undecided,
    interval_calls: u64 = interval.calls,
    interval_lanes: u64 = interval.lanes,
    tile_calls: u64 = tiles.calls,
    tile_lanes: u64 = tiles.lanes,
    segment_calls: u64 = segments.calls,
    segment_lanes: u64 = segments.lanes,
    point_calls: u64 = point.calls,
    point_lanes: u64 = point.lanes,
    gradient_calls: u64 = gradient.calls,
    gradient_lanes: u64 = gradient.lanes,
    given_up: u64 = given_up,
    status_hash: String = status_hash(&measured.picture.buffer),
    version: String = machine.version.clone(),
    rustc: String = machine.rustc.clone(),
    flags: String = machine.flags.clone(),
    processor: String = machine.processor.clone(),
    processor_threads: usize = machine.processor_threads,
}

/// Hash of all pixels' statuses.
pub fn status_hash(buffer: &GBuffer) -> String {
    let bytes: Vec<u8> = buffer.status.iter().map(|status| *status as u8).collect();
    blake3::hash(&bytes).to_hex().to_string()
}

impl Row {
    /// The conditions of the row's measurement.
    pub fn conditions(&self) -> Conditions {
        let Self { size, threads, seed, repeats, samples, .. } = *self;
        Conditions { size, threads, seed, repeats, samples }
    }

    /// The machine that the row was measured on.
    pub fn machine(&self) -> Environment {
        Environment {
            version: self.version.clone(),
            rustc: self.rustc.clone(),
            flags: self.flags.clone(),
            processor: self.processor.clone(),
            processor_threads: self.processor_threads,
        }
    }

    /// The method with its options.
    ///
    /// # Errors
    /// If this version has no such method.
    pub fn configuration(&self) -> Result<Configuration, ChartError> {
        let unknown = || ChartError::UnknownMethod(self.method.clone());
        Ok(Configuration {
            method: Method::named(&self.method).ok_or_else(unknown)?,
            precision: self.precision.as_deref().and_then(Precision::named),
            depth: self.max_depth,
            tolerance: self.tolerance,
            steps: self.steps,
        })
    }

    /// The camera of the view.
    ///
    /// # Errors
    /// If the numbers do not make a camera.
    pub fn camera(&self) -> Result<Camera, ChartError> {
        let eye = DVec3::new(self.eye_x, self.eye_y, self.eye_z);
        let target = DVec3::new(self.target_x, self.target_y, self.target_z);
        let up = DVec3::new(self.up_x, self.up_y, self.up_z);
        Camera::new(eye, target, up, Projection::Perspective { fov: self.fov })
            .map_err(ChartError::of_surface(&self.surface))
    }

    /// Share of wrong pixels among those that the reference decides; 0 if it decides none.
    pub fn wrong_share(&self) -> f64 {
        let wrong = self.missed + self.phantom + self.wrong_root;
        wrong as f64 / (self.looked_at - self.open).max(1) as f64
    }

    /// Counts of kernel calls, lanes and rays given up, with their names.
    pub fn work(&self) -> [(&'static str, u64); 11] {
        [
            ("interval calls", self.interval_calls),
            ("interval lanes", self.interval_lanes),
            ("tile calls", self.tile_calls),
            ("tile lanes", self.tile_lanes),
            ("segment calls", self.segment_calls),
            ("segment lanes", self.segment_lanes),
            ("point calls", self.point_calls),
            ("point lanes", self.point_lanes),
            ("gradient calls", self.gradient_calls),
            ("gradient lanes", self.gradient_lanes),
            ("rays given up", self.given_up),
        ]
    }
}
