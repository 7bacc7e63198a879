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
use std::cell::OnceCell;
use std::ops::Range;
use zeroset_eval::{LANES, PartSurface, SurfaceKernels, Tiles};

/// A part of a band is not divided in depth if its segment is at most this many times as long as
/// the part is wide.
const LONGEST: f64 = 2.0;
/// Number of parts along each direction if a part is divided in both.
const EACH: usize = 4;

/// Traces a part of a band by a method, or by the surface of that part if there is one. Returns
/// whether the rest of the band is no longer wanted.
pub(super) fn trace<T: Scalar>(
    method: &Affine<'_, T>,
    surface: Option<&dyn SurfaceKernels>,
    state: &mut BandState<T>,
    rays: &RayGrid,
    band: &mut Band<'_>,
    part: &BandPart,
    work: &mut KernelStats,
) -> bool {
    // Most parts are divided again. Then no kernels are needed that trace with their surfaces.
    let own = OnceCell::new();
    let create = || Affine::for_part(Task { surface: surface?, ..method.task }).ok();
    let trace_all = |state: &mut BandState<T>, band: &mut Band<'_>, part, work: &mut _| match own
        .get_or_init(create)
    {
        Some(own) => state.trace(own, rays, band, part, work),
        None => state.trace(method, rays, band, part, work),
    };
    let parts = divided::<T>(state, rays, band, part);
    if parts.is_empty() {
        return trace_all(state, band, part, work);
    }
    let batch = batch(state, rays, band, &parts);
    let kernels = T::kernels(surface.unwrap_or(method.task.surface));
    let surfaces = kernels.in_tiles(&batch);
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

/// Divides a part into at most sixteen parts: area by area, and each area from near to far. The
/// list is empty if the surface gets hardly simpler in shorter parts, or if the region is behind
/// the eye.
fn divided<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    part: &BandPart,
) -> Vec<BandPart> {
    let Some((across, deep)) = counts(state, rays, band, part) else { return Vec::new() };
    let mut parts = Vec::new();
    for area in areas(band, part, across) {
        let [near, far] = segment(state, rays, band, &area);
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
fn counts<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    part: &BandPart,
) -> Option<(usize, usize)> {
    let patches = part.rows.len();
    if patches > 1 {
        return Some((patches, LANES / patches));
    }
    let [near, far] = segment(state, rays, band, part);
    let middle = if rays.parallel { 1.0 } else { state.frame.start + 0.5 * (near + far) };
    let [[_, half], _] = area(rays, band, part);
    let width = 2.0 * (half + rays.unit) * middle.max(0.0);
    let length = far - near;
    let is_several = part.columns.len() > 1;
    Some(if !is_several && part.level == LAST {
        if length < width {
            return None;
        }
        (1, LANES)
    } else if !is_several && length > LONGEST * width {
        (1, LANES)
    } else if !is_several {
        (LANES, 1)
    } else if length > EACH as f64 * width {
        (1, LANES)
    } else if EACH as f64 * length < width {
        (LANES, 1)
    } else {
        (EACH, EACH)
    })
}

/// Divides the tiles or patches of a part into at most `across` areas, with the segment of the
/// part.
fn areas(band: &Band<'_>, part: &BandPart, across: usize) -> Vec<BandPart> {
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

/// Returns parts of a band as tiles. Each part is one patch, or has no patches.
fn batch<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    parts: &[BandPart],
) -> Tiles<T> {
    let mut tiles = state.frame.tiles::<T>();
    tiles.count = parts.len() as u32;
    for (lane, part) in parts.iter().enumerate() {
        for (axis, range) in area(rays, band, part).into_iter().enumerate() {
            state.frame.place_tile(axis, range, lane, &mut tiles);
        }
        let segment = segment(state, rays, band, part);
        [tiles.near[lane], tiles.far[lane]] = segment.map(T::nearest);
    }
    tiles
}

/// The span of a part, or the segment of it that is examined if it is one patch.
fn segment<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    part: &BandPart,
) -> [f64; 2] {
    let row = band.top + part.rows.start;
    let [near, far] = examined::<T>(rays, row, state.frame.start, part.span);
    // What is wanted may lie before or behind the part.
    [near.min(part.span[1]), far.max(part.span[0])]
}

/// The area of some tiles, or of one patch.
pub(super) fn area(rays: &RayGrid, band: &Band<'_>, part: &BandPart) -> Area {
    let BandPart { level, columns, rows, .. } = part;
    let side = SIDES[*level];
    let range = |some: &Range<usize>, size: usize| [side * some.start, (side * some.end).min(size)];
    let (columns, rows) = match rays.patch(band.top + rows.start) {
        Some(Patch { column, row, .. }) => ([column, column + side], [row, row + side]),
        None => {
            let rows = range(rows, band.height).map(|row| band.top + row);
            (range(columns, band.width), rows)
        }
    };
    let extent = |axis: usize, [first, end]: [usize; 2]| {
        let sum = first + end - 1;
        [rays.screen(sum, sum)[axis], (end - 1 - first) as f64 * rays.unit]
    };
    [extent(0, columns), extent(1, rows)]
}
