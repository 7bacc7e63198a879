//! A row of results: a surface, a view and a configuration, with everything needed to repeat it.

use crate::error::ChartError;
use crate::errors::PixelErrors;
use crate::grid::{Configuration, precision};
use crate::machine::Environment;
use crate::measure::Measured;
use crate::surfaces::ChartSurface;
use crate::views::View;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use zeroset_trace::{Camera, GBuffer, KernelStats, Method, Projection};

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

/// A row of results. Times are in milliseconds. Distances are in world units, or in pixels if the
/// field's name says so.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // names of columns; docs/performance.md says what is measured
pub struct Row {
    pub surface: String,
    pub view: String,
    pub eye_x: f64,
    pub eye_y: f64,
    pub eye_z: f64,
    pub target_x: f64,
    pub target_y: f64,
    pub target_z: f64,
    pub up_x: f64,
    pub up_y: f64,
    pub up_z: f64,
    pub fov: f64,
    pub size: usize,
    pub method: String,
    pub precision: Option<String>,
    pub max_depth: Option<u32>,
    pub tolerance: Option<f64>,
    pub steps: Option<u32>,
    pub threads: usize,
    pub seed: u64,
    pub repeats: usize,
    pub samples: usize,
    pub trace_ms: f64,
    pub trace_ms_lower: f64,
    pub trace_ms_upper: f64,
    pub shade_ms: f64,
    pub total_ms: f64,
    pub total_ms_lower: f64,
    pub total_ms_upper: f64,
    pub compile_ms: f64,
    pub cold_ms: f64,
    pub looked_at: usize,
    pub open: usize,
    pub roots: usize,
    pub missed: usize,
    pub phantom: usize,
    pub wrong_root: usize,
    /// Pixels with a false status. They are wrong even if all undecided pixels are right.
    pub false_claims: usize,
    pub undecided: usize,
    pub painted: usize,
    pub off_pixels_median: Option<f64>,
    pub off_pixels_999: Option<f64>,
    pub off_pixels_max: Option<f64>,
    pub off_median: Option<f64>,
    pub off_999: Option<f64>,
    pub off_max: Option<f64>,
    pub normal_degrees_median: Option<f64>,
    pub normal_degrees_999: Option<f64>,
    pub normal_degrees_max: Option<f64>,
    pub pixels_miss: usize,
    pub pixels_hit: usize,
    pub pixels_undecided: usize,
    pub interval_calls: u64,
    pub interval_lanes: u64,
    pub tile_calls: u64,
    pub tile_lanes: u64,
    pub segment_calls: u64,
    pub segment_lanes: u64,
    pub point_calls: u64,
    pub point_lanes: u64,
    pub gradient_calls: u64,
    pub gradient_lanes: u64,
    pub given_up: u64,
    pub status_hash: String,
    pub version: String,
    pub rustc: String,
    pub flags: String,
    pub processor: String,
    pub processor_threads: usize,
}

/// Hash of all pixels' statuses.
pub fn status_hash(buffer: &GBuffer) -> String {
    let bytes: Vec<u8> = buffer.status.iter().map(|status| *status as u8).collect();
    blake3::hash(&bytes).to_hex().to_string()
}

impl Row {
    /// A row from the parts of a measurement.
    pub fn new(
        surface: &ChartSurface,
        view: &View,
        conditions: Conditions,
        configuration: &Configuration,
        measured: &Measured,
        errors: &PixelErrors,
        machine: &Environment,
    ) -> Self {
        let [eye, target, up] = [view.camera.eye(), view.camera.target(), view.camera.up()];
        let fov = match view.camera.projection() {
            Projection::Perspective { fov } => fov,
            Projection::Orthographic { .. } => 0.0,
        };
        let statistics = &measured.picture.statistics;
        let KernelStats { interval, tiles, segments, point, gradient, given_up, .. } =
            statistics.work;
        let of = |three: Option<[f64; 3]>, place: usize| three.map(|three| three[place]);
        Self {
            surface: surface.name.clone(),
            view: view.name.clone(),
            eye_x: eye.x,
            eye_y: eye.y,
            eye_z: eye.z,
            target_x: target.x,
            target_y: target.y,
            target_z: target.z,
            up_x: up.x,
            up_y: up.y,
            up_z: up.z,
            fov,
            size: conditions.size,
            method: configuration.method.name.to_owned(),
            precision: configuration.precision.map(|precision| precision.to_string()),
            max_depth: configuration.depth,
            tolerance: configuration.tolerance,
            steps: configuration.steps,
            threads: conditions.threads,
            seed: conditions.seed,
            repeats: conditions.repeats,
            samples: conditions.samples,
            trace_ms: measured.trace.median,
            trace_ms_lower: measured.trace.lower,
            trace_ms_upper: measured.trace.upper,
            shade_ms: measured.shade.median,
            total_ms: measured.total.median,
            total_ms_lower: measured.total.lower,
            total_ms_upper: measured.total.upper,
            compile_ms: measured.compile,
            cold_ms: measured.cold,
            looked_at: errors.samples,
            open: errors.open,
            roots: errors.roots,
            missed: errors.missed,
            phantom: errors.phantom,
            wrong_root: errors.wrong_root,
            false_claims: errors.false_claims,
            undecided: errors.undecided,
            painted: errors.painted,
            off_pixels_median: of(errors.off_pixels, 0),
            off_pixels_999: of(errors.off_pixels, 1),
            off_pixels_max: of(errors.off_pixels, 2),
            off_median: of(errors.off, 0),
            off_999: of(errors.off, 1),
            off_max: of(errors.off, 2),
            normal_degrees_median: of(errors.normal_degrees, 0),
            normal_degrees_999: of(errors.normal_degrees, 1),
            normal_degrees_max: of(errors.normal_degrees, 2),
            pixels_miss: statistics.pixels.miss,
            pixels_hit: statistics.pixels.hit,
            pixels_undecided: statistics.pixels.undecided,
            interval_calls: interval.calls,
            interval_lanes: interval.lanes,
            tile_calls: tiles.calls,
            tile_lanes: tiles.lanes,
            segment_calls: segments.calls,
            segment_lanes: segments.lanes,
            point_calls: point.calls,
            point_lanes: point.lanes,
            gradient_calls: gradient.calls,
            gradient_lanes: gradient.lanes,
            given_up,
            status_hash: status_hash(&measured.picture.buffer),
            version: machine.version.clone(),
            rustc: machine.rustc.clone(),
            flags: machine.flags.clone(),
            processor: machine.processor.clone(),
            processor_threads: machine.processor_threads,
        }
    }

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
            precision: self.precision.as_deref().and_then(precision),
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
