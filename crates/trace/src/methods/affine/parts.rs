//! Parts of a picture in which a surface can do with fewer operations.
//!
//! A surface of many parts is a long formula, of which a few pixels see little. So a band is
//! divided across and in depth until its surface gets no simpler. Each part is traced by the
//! kernels of its own surface, the nearest part of a pixel first. A part in which the surface has
//! no zero is left out.

use super::Affine;
use super::tiles::{BandPart, BandState};
use super::tracer::{LAST, SIDES};
use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::Task;
use crate::scalar::Scalar;
use std::cell::OnceCell;
use std::ops::Range;
use zeroset_eval::{LANES, PartSurface, SurfaceKernels, Tiles};

/// A part of a band is not divided in depth if its segment is at most this many times as long as
/// the part is wide.
const LONGEST: f64 = 2.0;
/// Number of parts along each direction if a part is divided in both.
const EACH: usize = 4;

/// Traces a part of a band of pixels, not of patches, by a method, or by the surface of that part
/// if there is one. Returns whether the rest of the band is no longer wanted.
pub(super) fn trace<T: Scalar>(
    method: &Affine<'_, T>,
    surface: Option<&dyn SurfaceKernels>,
    state: &mut BandState<T>,
    rays: &RayGrid,
    band: &mut Band<'_>,
    part: &BandPart,
    work: &mut KernelStats,
) -> bool {
    let parts = divided::<T>(state, rays, band, part);
    if parts.is_empty() {
        // The region is behind the eye.
        return state.trace(method, rays, band, part, work);
    }
    let batch = batch(state, rays, band, &parts);
    let kernels = T::kernels(surface.unwrap_or(method.task.surface));
    let surfaces = kernels.in_tiles(&batch);
    // Most parts are divided again. Then no kernels are needed that trace with their surfaces.
    let own = OnceCell::new();
    let create = || Affine::for_part(Task { surface: surface?, ..method.task }).ok();
    let trace_all = |state: &mut BandState<T>, band: &mut Band<'_>, part, work: &mut _| match own
        .get_or_init(create)
    {
        Some(own) => state.trace(own, rays, band, part, work),
        None => state.trace(method, rays, band, part, work),
    };
    if surfaces.iter().all(|surface| matches!(surface, PartSurface::Same)) {
        return trace_all(state, band, part, work);
    }
    work.tiles.called(parts.len() as u32);
    for (part, surface) in parts.iter().zip(&surfaces) {
        if !state.is_open(part) {
            continue;
        }
        let is_over = match surface {
            PartSurface::Empty => {
                state.pass_over(part);
                !band.is_wanted()
            }
            PartSurface::Same => trace_all(state, band, part, work),
            PartSurface::Short(surface) => {
                trace(method, Some(&**surface), state, rays, band, part, work)
            }
        };
        if is_over {
            return true;
        }
    }
    false
}

/// Divides a part into at most sixteen parts: area by area, and each area from near to far.
fn divided<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    part: &BandPart,
) -> Vec<BandPart> {
    let [near, far] = part.span;
    let [columns, _] = pixels(band, part);
    let middle = if rays.parallel { 1.0 } else { state.frame.start + 0.5 * (near + far) };
    let width = 2.0 * (columns[1] - columns[0] + 1) as f64 * rays.unit * middle.max(0.0);
    let length = far - near;
    let is_several = part.columns.len() > 1;
    let (across, deep) = if !is_several && (part.level == LAST || length > LONGEST * width) {
        (1, LANES)
    } else if !is_several {
        (LANES, 1)
    } else if length > EACH as f64 * width {
        (1, LANES)
    } else if EACH as f64 * length < width {
        (LANES, 1)
    } else {
        (EACH, EACH)
    };
    let ends: Vec<f64> = (0..=deep)
        .map(|k| match k {
            0 => near,
            _ if k == deep => far,
            _ => T::nearest(near + length * k as f64 / deep as f64).into(),
        })
        .collect();
    let mut parts = Vec::new();
    for area in areas(band, part, is_several, across) {
        for ends in ends.windows(2).filter(|ends| ends[0] < ends[1]) {
            parts.push(BandPart { span: [ends[0], ends[1]], ..area.clone() });
        }
    }
    parts
}

/// Divides the tiles of a part into at most `across` areas, with the segment of the part.
fn areas(band: &Band<'_>, part: &BandPart, is_several: bool, across: usize) -> Vec<BandPart> {
    let BandPart { level, columns, rows, .. } = part;
    if across == 1 {
        return vec![part.clone()];
    }
    if is_several {
        let step = columns.len().div_ceil(across);
        let area = |start: usize| BandPart {
            columns: start..columns.end.min(start + step),
            ..part.clone()
        };
        return columns.clone().step_by(step).map(area).collect();
    }
    let [columns, rows] = [(columns, band.width), (rows, band.height)].map(|(one, size)| {
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

/// Returns parts of a band as tiles.
fn batch<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    parts: &[BandPart],
) -> Tiles<T> {
    let mut tiles = state.frame.tiles::<T>();
    tiles.count = parts.len() as u32;
    for (lane, part) in parts.iter().enumerate() {
        for (axis, [first, last]) in pixels(band, part).into_iter().enumerate() {
            let centre = rays.screen(first + last, first + last)[axis];
            let half = (last - first) as f64 * rays.unit;
            state.frame.place_tile(axis, [centre, half], lane, &mut tiles);
        }
        [tiles.near[lane], tiles.far[lane]] = part.span.map(T::nearest);
    }
    tiles
}

/// Returns the first and last column and row of the pixels in a part of a band.
fn pixels(band: &Band<'_>, part: &BandPart) -> [[usize; 2]; 2] {
    let side = SIDES[part.level];
    let range =
        |some: &Range<usize>, size: usize| [side * some.start, (side * some.end).min(size) - 1];
    let rows = range(&part.rows, band.height).map(|row| band.top + row);
    [range(&part.columns, band.width), rows]
}
