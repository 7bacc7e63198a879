//! A tree of parts of a picture.
//!
//! A part is a range of the screen over a segment of the rays. It keeps its surface and its own
//! parts, which are created when rays in them are first traced. All bands share them, and all
//! patches.

use super::frame::RayFrame;
use super::parts::{BandPass, IN_VAIN};
use super::tiles::{Area, BandPart};
use super::tracer::LAST;
use crate::grid::RayGrid;
use crate::method::Task;
use crate::painted::ones;
use crate::scalar::Scalar;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use zeroset_eval::{LANES, PartSurface, SurfaceKernels, Tiles};

/// A part of a picture.
struct Part {
    area: Area,
    /// Values of s, which are floats of the tracer's precision.
    span: [f64; 2],
    /// The part's surface; `None` for that of the whole picture.
    surface: Option<Arc<dyn SurfaceKernels>>,
    /// Number of divisions since the surface got simpler.
    divisions: u32,
    /// Whether the part is proven to hold no zero.
    is_empty: bool,
    /// The parts of this part, nearest first. The list is empty if the surface gets no simpler.
    parts: OnceLock<Vec<Part>>,
}

/// The parts of a picture.
pub(super) struct PartTree {
    root: Part,
    /// The picture's rays.
    frame: RayFrame,
    /// Half the distance between rays on the screen.
    unit: f64,
}

impl PartTree {
    /// Creates the tree of a picture.
    pub fn new<T: Scalar>(frame: RayFrame, rays: &RayGrid) -> Self {
        let [near, far] = frame.span;
        let root = Part {
            area: rays.reach.map(|reach| [0.0, reach]),
            span: [-T::above(-near).into(), T::above(far).into()],
            surface: None,
            divisions: 0,
            is_empty: false,
            parts: OnceLock::new(),
        };
        Self { root, frame, unit: rays.unit }
    }

    /// Returns whether the tree belongs to these rays, and to pixels of this size.
    pub fn is_of(&self, frame: &RayFrame, rays: &RayGrid) -> bool {
        let Self { frame: own, unit, .. } = self;
        (own.origin, own.direction, own.span, own.start, own.reach, *unit)
            == (frame.origin, frame.direction, frame.span, frame.start, frame.reach, rays.unit)
    }

    /// Traces a band. Returns whether the rest of the band is no longer wanted.
    pub fn trace<T: Scalar>(&self, pass: BandPass<'_, '_, '_, T>) -> bool {
        let BandPart { columns, rows, .. } = pass.state.whole(pass.rays, pass.band);
        if !pass.rays.is_patched() {
            return TreePass { tree: self, pass }.trace_tiles(&self.root, columns);
        }
        let area = |row: usize| pass.area(&patches(row, row + 1, self.root.span));
        let areas: Vec<Area> = rows.map(area).collect();
        let all = u16::MAX >> (LANES - areas.len());
        TreePass { tree: self, pass }.trace_patches(&self.root, &areas, all)
    }

    /// Divides a part into sixteen. The list is empty if the part is low, or if the surface has too
    /// few choices.
    fn divided<T: Scalar>(&self, part: &Part, rays: &RayGrid, task: Task<'_>) -> Vec<Part> {
        let kernels = T::kernels(part.surface.as_deref().unwrap_or(task.surface));
        let low = if rays.is_patched() { LOW_OF_PATCHES } else { LOW };
        if part.area[1][1] <= low * self.unit || !kernels.has_parts() {
            return Vec::new();
        }
        let frame = &self.frame;
        let [near, far] = part.span;
        let middle = if rays.parallel { 1.0 } else { (frame.start + 0.5 * (near + far)).max(0.0) };
        let mut sizes = [part.area[0][1] * middle, part.area[1][1] * middle, 0.5 * (far - near)];
        let mut counts = [1; 3];
        while counts.iter().product::<usize>() < LANES {
            let longest = (0..3).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b])).unwrap_or(2);
            counts[longest] *= 2;
            sizes[longest] /= 2.0;
        }
        let margin = TILE_MARGIN * self.unit;
        let range = |axis: usize, k: usize| {
            let [centre, half] = part.area[axis];
            let step = 2.0 * half / counts[axis] as f64;
            [centre - half + (k as f64 + 0.5) * step, 0.5 * step + margin]
        };
        let end = |k: usize| match k {
            0 => near,
            _ if k == counts[2] => far,
            _ => T::nearest(near + (far - near) * k as f64 / counts[2] as f64).into(),
        };
        let mut areas = Vec::with_capacity(LANES);
        for depth in 0..counts[2] {
            for row in 0..counts[1] {
                for column in 0..counts[0] {
                    areas.push(([range(0, column), range(1, row)], [end(depth), end(depth + 1)]));
                }
            }
        }
        let mut tiles: Tiles<T> = frame.tiles();
        tiles.count = areas.len() as u32;
        for (lane, (area, span)) in areas.iter().enumerate() {
            for (axis, range) in area.iter().enumerate() {
                frame.place_tile(axis, *range, lane, &mut tiles);
            }
            [tiles.near[lane], tiles.far[lane]] = span.map(T::nearest);
        }
        let surfaces = kernels.in_tiles(&tiles);
        if surfaces.is_empty() {
            return Vec::new();
        }
        let divisions = part.divisions + 1;
        let part = |((area, span), surface): ((Area, [f64; 2]), PartSurface)| {
            let is_empty = matches!(surface, PartSurface::Empty);
            let (surface, divisions) = match surface {
                PartSurface::Empty => (None, 0),
                PartSurface::Same => (part.surface.clone(), divisions),
                PartSurface::Short(surface) => (Some(Arc::from(surface)), 0),
            };
            let is_last = divisions > IN_VAIN;
            let parts = if is_last { OnceLock::from(Vec::new()) } else { OnceLock::new() };
            (span[0] < span[1]).then_some(Part { area, span, surface, divisions, is_empty, parts })
        };
        areas.into_iter().zip(surfaces).filter_map(part).collect()
    }
}

/// A band that is traced.
struct TreePass<'p, 'b, 'm, T: Scalar> {
    tree: &'p PartTree,
    pass: BandPass<'p, 'b, 'm, T>,
}

impl<T: Scalar> TreePass<'_, '_, '_, T> {
    /// Traces these columns of tiles in a part. Returns whether the rest of the band is no longer
    /// wanted.
    fn trace_tiles(&mut self, part: &Part, columns: Range<usize>) -> bool {
        let Part { span, surface, .. } = part;
        let own = BandPart { level: 0, columns: columns.clone(), rows: 0..1, span: *span };
        if !self.pass.state.is_open(&own) {
            return !self.pass.band.is_wanted();
        }
        let divide = || self.tree.divided::<T>(part, self.pass.rays, self.pass.method.task);
        let inner = part.parts.get_or_init(divide);
        if inner.is_empty() {
            return self.pass.trace(surface.as_deref(), &own, part.divisions);
        }
        // Areas overlap. In each range of depth, a tile is traced in the first area around it.
        // Areas are in order from left to right. A tile around which there is no area would stay
        // unseen.
        let (mut first, mut span) = (columns.start, None);
        for inner in inner {
            if span != Some(inner.span) {
                (first, span) = (columns.start, Some(inner.span));
            }
            if inner.is_empty {
                for column in columns.clone() {
                    if contains(&inner.area, &self.tile_area(column)) {
                        let (columns, span) = (column..column + 1, inner.span);
                        self.pass.state.pass_over(&BandPart { columns, span, ..own.clone() });
                    }
                }
                continue;
            }
            let is_inside = |&column: &usize| contains(&inner.area, &self.tile_area(column));
            let Some(start) = (first..columns.end).find(is_inside) else { continue };
            let end = (start..columns.end).find(|column| !is_inside(column));
            first = end.unwrap_or(columns.end);
            if self.trace_tiles(inner, start..first) {
                return true;
            }
        }
        false
    }

    /// The area of the tile in a column of the band.
    fn tile_area(&self, column: usize) -> Area {
        let (columns, span) = (column..column + 1, self.tree.root.span);
        let tile = BandPart { level: 0, columns, rows: 0..1, span };
        self.pass.area(&tile)
    }

    /// Traces the patches of these rows in a part. Returns whether the rest of the band is no
    /// longer wanted.
    fn trace_patches(&mut self, part: &Part, areas: &[Area], rows: u16) -> bool {
        let rows: u16 =
            ones(rows).filter(|row| self.is_wanted(*row, part)).map(|row| 1 << row).sum();
        if rows == 0 {
            return !self.pass.band.is_wanted();
        }
        let parts = part
            .parts
            .get_or_init(|| self.tree.divided::<T>(part, self.pass.rays, self.pass.method.task));
        if parts.is_empty() {
            return self.trace_all(part, areas.len(), rows);
        }
        // Areas overlap. In each range of depth, a patch is traced in the first area around it. A
        // patch around which there is no area would stay unseen.
        let (mut rest, mut span) = (rows, None);
        for inner in parts {
            if span != Some(inner.span) {
                (rest, span) = (rows, Some(inner.span));
            }
            let inside: u16 = ones(rest)
                .filter(|row| contains(&inner.area, &areas[*row]))
                .map(|row| 1 << row)
                .sum();
            if inner.is_empty {
                ones(inside).for_each(|row| {
                    self.pass.state.pass_over(&patches(row, row + 1, inner.span));
                });
                continue;
            }
            rest &= !inside;
            if inside != 0 && self.trace_patches(inner, areas, inside) {
                return true;
            }
        }
        false
    }

    /// Returns whether the patch of a row has pixels that are not finished, and zeros in this part
    /// are wanted.
    fn is_wanted(&self, row: usize, part: &Part) -> bool {
        let [near, far] = part.span.map(|s| self.tree.frame.start + s);
        let wanted = self.pass.rays.patch(self.pass.band.top + row).expect("a patch").between;
        let slack = 1e-9 * (near.abs() + far.abs());
        near - slack <= wanted[1]
            && wanted[0] <= far + slack
            && self.pass.state.is_open(&patches(row, row + 1, part.span))
    }

    /// Traces those of `count` patches that are in these rows.
    fn trace_all(&mut self, part: &Part, count: usize, rows: u16) -> bool {
        let mut first = 0;
        while first < count {
            let some = (rows >> first).trailing_ones() as usize;
            if some > 0 {
                let own = patches(first, first + some, part.span);
                if self.pass.trace(part.surface.as_deref(), &own, part.divisions) {
                    return true;
                }
            }
            first += some + 1;
        }
        false
    }
}

/// Parts at most this high are not divided further in the tree. In units, from the middle. Smaller
/// parts serve so few tiles that they are made where they are needed, and not kept.
const LOW: f64 = 160.0;
/// [`LOW`] for patches. It is smaller, since many patches lie in one part, in any order.
const LOW_OF_PATCHES: f64 = 120.0;
/// How far the area of a part reaches beyond its share of the screen, in units. It is more than
/// half the extent of a tile of 16×16 pixels, whose rays are two units apart, or of a patch. So
/// each of them lies in at least one area.
const TILE_MARGIN: f64 = 16.0;

/// The patches in some rows of a band.
fn patches(first: usize, end: usize, span: [f64; 2]) -> BandPart {
    BandPart { level: LAST, columns: 0..1, rows: first..end, span }
}

/// Returns whether all of an area lies in another.
fn contains(outer: &Area, inner: &Area) -> bool {
    outer
        .iter()
        .zip(inner)
        .all(|([centre, half], [at, reach])| (at - centre).abs() + reach <= *half)
}
