//! Parts of a picture in which a surface can do with fewer operations.
//!
//! A surface of many parts is a long formula, of which a few pixels see little. So a band is divided
//! across and in depth until its surface gets no simpler. Each part is traced by the kernels of its
//! own surface, the nearest part of a pixel first. A part in which the surface has no zero is left
//! out.

use super::Affine;
use super::tiles::{BandPart, BandState, WIDTH};
use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::Task;
use crate::scalar::Scalar;
use zeroset_eval::{LANES, PartSurface, Tiles};

/// A part of a band is not divided in depth if its segment is at most this many times as long as
/// the part is wide.
const SLENDER: f64 = 2.0;
/// Number of parts along each direction if a part is divided in both.
const EACH: usize = 4;

/// Traces a part of a band. Returns whether the rest of the band is no longer wanted.
pub(super) fn trace<T: Scalar>(
    method: &Affine<'_, T>,
    state: &mut BandState<T>,
    rays: &RayGrid,
    band: &mut Band<'_>,
    part: &BandPart,
    work: &mut KernelStats,
) -> bool {
    let parts = divided::<T>(state, rays, band, part);
    let batch = batch(state, rays, band, &parts);
    let surfaces = T::kernels(method.task.surface).in_tiles(&batch);
    if surfaces.iter().all(|surface| matches!(surface, PartSurface::Same)) {
        return state.trace(method, rays, band, part, work);
    }
    work.tiles.called(parts.len() as u32);
    for (part, surface) in parts.iter().zip(&surfaces) {
        if !state.is_open(rays, &part.places) {
            continue;
        }
        let is_over = match surface {
            PartSurface::Empty => !band.is_wanted(),
            PartSurface::Same => state.trace(method, rays, band, part, work),
            PartSurface::Short(surface) => {
                match Affine::<T>::for_part(Task { surface: &**surface, ..method.task }) {
                    Ok(short) => trace(&short, state, rays, band, part, work),
                    Err(_) => state.trace(method, rays, band, part, work),
                }
            }
        };
        if is_over {
            return true;
        }
    }
    false
}

/// Divides a part into at most sixteen: for each range of places, segments from near to far.
fn divided<T: Scalar>(
    state: &BandState<T>,
    rays: &RayGrid,
    band: &Band<'_>,
    part: &BandPart,
) -> Vec<BandPart> {
    let BandPart { places, span: [near, far] } = part;
    let [columns, _] = pixels(rays, band, part);
    let middle = if rays.parallel { 1.0 } else { state.frame.start + 0.5 * (near + far) };
    let width = 2.0 * (columns[1] - columns[0]) as f64 * rays.unit * middle.max(0.0);
    let length = far - near;
    let (across, deep) = if length > EACH as f64 * width {
        (1, LANES)
    } else if places.len() > 1 && EACH as f64 * length < width {
        (LANES, 1)
    } else if length > SLENDER * width || places.len() > 1 {
        (EACH, EACH)
    } else {
        (LANES, 1)
    };
    let step = places.len().div_ceil(across).max(1);
    let ends: Vec<f64> = (0..=deep)
        .map(|k| match k {
            0 => *near,
            _ if k == deep => *far,
            _ => T::nearest(near + length * k as f64 / deep as f64).into(),
        })
        .collect();
    let mut parts = Vec::new();
    for start in places.clone().step_by(step) {
        let some = start..places.end.min(start + step);
        for ends in ends.windows(2).filter(|ends| ends[0] < ends[1]) {
            parts.push(BandPart { places: some.clone(), span: [ends[0], ends[1]] });
        }
    }
    parts
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
        for (axis, [first, last]) in pixels(rays, band, part).into_iter().enumerate() {
            let centre = rays.screen(first + last, first + last)[axis];
            let half = (last - first) as f64 * rays.unit;
            state.frame.place_tile(axis, [centre, half], lane, &mut tiles);
        }
        [tiles.near[lane], tiles.far[lane]] = part.span.map(T::nearest);
    }
    tiles
}

/// Returns the first and last column and row of the pixels in a part of a band.
fn pixels(rays: &RayGrid, band: &Band<'_>, part: &BandPart) -> [[usize; 2]; 2] {
    let patches = part.places.clone().filter_map(|row| rays.patch(band.top + row));
    let around =
        patches.map(|patch| [[patch.column, patch.column + 3], [patch.row, patch.row + 3]]);
    let all = [
        [WIDTH * part.places.start, (WIDTH * part.places.end).min(band.width) - 1],
        [band.top, band.top + band.height - 1],
    ];
    around
        .reduce(|a, b| [0, 1].map(|axis| [a[axis][0].min(b[axis][0]), a[axis][1].max(b[axis][1])]))
        .unwrap_or(all)
}
