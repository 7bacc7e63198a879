//! Parts of a picture in which a surface can do with fewer operations.
//!
//! A surface of many parts is a long formula, of which a few pixels see little. So a band is
//! divided across and in depth until its surface gets no simpler. Each part is traced by the
//! kernels of its own surface, the nearest part of a pixel first. A part in which the surface has
//! no zero is left out.

use super::Affine;
use super::tiles::{Area, BandPart, BandState, examined};
use super::tracer::{LAST, SIDES};
use crate::band::Band;
use crate::grid::{Patch, RayGrid};
use crate::kernel_stats::KernelStats;
use crate::method::Task;
use crate::scalar::Scalar;
use std::ops::Range;
use zeroset_eval::{LANES, PartSurface, SurfaceKernels, Tiles};

/// Number of divisions that may bring no simpler surface. The first parts of a picture are large.
pub(super) const IN_VAIN: u32 = 1;
/// A part of a band is not divided in depth if its segment is at most this many times as long as
/// the part is wide.
const LONGEST: f64 = 2.0;
/// Number of parts along each direction if a part is divided in both.
const EACH: usize = 4;

/// A band that is traced part by part.
pub(super) struct BandPass<'p, 'b, 'm, T: Scalar> {
    pub method: &'p Affine<'m, T>,
    pub state: &'p mut BandState<T>,
    pub rays: &'p RayGrid,
    pub band: &'p mut Band<'b>,
    pub work: &'p mut KernelStats,
}

impl<T: Scalar> BandPass<'_, '_, '_, T> {
    /// Traces a part by its own surface, or else by the method's. `divisions` is the number of
    /// divisions since the surface got simpler. Returns whether the rest of the band is no longer
    /// wanted.
    pub fn trace(
        &mut self,
        surface: Option<&dyn SurfaceKernels>,
        part: &BandPart,
        divisions: u32,
    ) -> bool {
        let kernels = T::kernels(surface.unwrap_or(self.method.task.surface));
        let parts = if kernels.has_parts() { self.divided(part) } else { Vec::new() };
        let surfaces =
            if parts.is_empty() { Vec::new() } else { kernels.in_tiles(&self.batch(&parts)) };
        let is_same = |surface: &PartSurface| matches!(surface, PartSurface::Same);
        // Large parts are divided once more.
        let is_last = divisions >= IN_VAIN || part.columns.len() == 1;
        if surfaces.is_empty() || is_last && surfaces.iter().all(is_same) {
            return self.trace_whole(surface, part);
        }
        self.work.tiles.called(parts.len() as u32);
        for (part, own) in parts.iter().zip(&surfaces) {
            if !self.state.is_open(part) {
                continue;
            }
            let is_over = match own {
                PartSurface::Empty => {
                    self.state.pass_over(part);
                    !self.band.is_wanted()
                }
                PartSurface::Same => self.trace(surface, part, divisions + 1),
                PartSurface::Short(own) => self.trace(Some(&**own), part, 0),
            };
            if is_over {
                return true;
            }
        }
        false
    }

    /// Traces all of a part by its own surface, or else by the method's.
    fn trace_whole(&mut self, surface: Option<&dyn SurfaceKernels>, part: &BandPart) -> bool {
        let Self { method, state, rays, band, work } = self;
        let own = surface.map(|surface| Affine::for_part(Task { surface, ..method.task }));
        match own {
            Some(Ok(own)) => state.trace(&own, rays, band, part, work),
            _ => state.trace(method, rays, band, part, work),
        }
    }

    /// Divides a part into at most sixteen parts: area by area, and each area from near to far. The
    /// list is empty if the surface gets hardly simpler in shorter parts, or if the region is
    /// behind the eye.
    fn divided(&self, part: &BandPart) -> Vec<BandPart> {
        let Some((across, deep)) = self.counts(part) else { return Vec::new() };
        let mut parts = Vec::new();
        for area in self.areas(part, across) {
            let [near, far] = self.segment(&area);
            let end = |k: usize| match k {
                0 => part.span[0],
                _ if k == deep => part.span[1],
                _ => T::nearest(near + (far - near) * k as f64 / deep as f64).into(),
            };
            for span in (0..deep).map(|k| [end(k), end(k + 1)]).filter(|[near, far]| near < far) {
                parts.push(BandPart { span, ..area.clone() });
            }
        }
        parts
    }

    /// Number of areas into which a part is divided across, and number of parts of each in depth.
    /// `None` if it is one tile or patch that is shorter than wide.
    fn counts(&self, part: &BandPart) -> Option<(usize, usize)> {
        let patches = part.rows.len();
        if patches > 1 {
            return Some((patches, LANES / patches));
        }
        let [near, far] = self.segment(part);
        let start = self.state.frame.start;
        let middle = if self.rays.parallel { 1.0 } else { start + 0.5 * (near + far) };
        let [[_, half], _] = self.area(part);
        let width = 2.0 * (half + self.rays.unit) * middle.max(0.0);
        let length = far - near;
        Some(match part.columns.len() {
            1 if part.level == LAST && length < width => return None,
            1 if part.level == LAST || length > LONGEST * width => (1, LANES),
            1 => (LANES, 1),
            _ if length > EACH as f64 * width => (1, LANES),
            _ if EACH as f64 * length < width => (LANES, 1),
            _ => (EACH, EACH),
        })
    }

    /// Divides the tiles or patches of a part into at most `across` areas, with the segment of the
    /// part.
    fn areas(&self, part: &BandPart, across: usize) -> Vec<BandPart> {
        let BandPart { level, columns, rows, .. } = part;
        if across == 1 {
            return vec![part.clone()];
        }
        if rows.len() > 1 {
            let patch = |row: usize| BandPart { rows: row..row + 1, ..part.clone() };
            return rows.clone().map(patch).collect();
        }
        if columns.len() > 1 {
            let step = columns.len().div_ceil(across);
            let area = |start: usize| BandPart {
                columns: start..columns.end.min(start + step),
                ..part.clone()
            };
            return columns.clone().step_by(step).map(area).collect();
        }
        let sizes = [self.band.width, self.band.height];
        let [columns, rows] = [(columns, sizes[0]), (rows, sizes[1])].map(|(one, size)| {
            let finer = SIDES[*level] / SIDES[LAST];
            finer * one.start..(finer * one.end).min(size.div_ceil(SIDES[LAST]))
        });
        let tile = |column: usize, row: usize| BandPart {
            level: LAST,
            columns: column..column + 1,
            rows: row..row + 1,
            ..part.clone()
        };
        columns.flat_map(|column| rows.clone().map(move |row| tile(column, row))).collect()
    }

    /// Returns parts as tiles. Each part is one patch, or has no patches.
    fn batch(&self, parts: &[BandPart]) -> Tiles<T> {
        let mut tiles = self.state.frame.tiles::<T>();
        tiles.count = parts.len() as u32;
        for (lane, part) in parts.iter().enumerate() {
            for (axis, range) in self.area(part).into_iter().enumerate() {
                self.state.frame.place_tile(axis, range, lane, &mut tiles);
            }
            [tiles.near[lane], tiles.far[lane]] = self.segment(part).map(T::nearest);
        }
        tiles
    }

    /// The span of a part, or the segment of it that is examined if it is one patch.
    fn segment(&self, part: &BandPart) -> [f64; 2] {
        let row = self.band.top + part.rows.start;
        let [near, far] = examined::<T>(self.rays, row, self.state.frame.start, part.span);
        // What is wanted may lie before or behind the part.
        [near.min(part.span[1]), far.max(part.span[0])]
    }

    /// The area of some tiles, or of one patch.
    pub fn area(&self, part: &BandPart) -> Area {
        let Self { rays, band, .. } = self;
        let BandPart { level, columns, rows, .. } = part;
        let side = SIDES[*level];
        let range =
            |some: &Range<usize>, size: usize| [side * some.start, (side * some.end).min(size)];
        let (columns, rows) =
            if let Some(Patch { column, row, .. }) = rays.patch(band.top + rows.start) {
                ([column, column + side], [row, row + side])
            } else {
                let rows = range(rows, band.height).map(|row| band.top + row);
                (range(columns, band.width), rows)
            };
        let extent = |axis: usize, [first, end]: [usize; 2]| {
            let sum = first + end - 1;
            [rays.screen(sum, sum)[axis], (end - 1 - first) as f64 * rays.unit]
        };
        [extent(0, columns), extent(1, rows)]
    }
}
