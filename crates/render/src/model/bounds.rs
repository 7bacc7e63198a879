//! Boxes around surfaces, and the pixels that may show them.
//!
//! If a document has several surfaces, each is traced only in its box. A ray that misses the box
//! misses the surface, so no proof is lost. This module knows no method.

#[cfg(test)]
mod tests;

use super::Model;
use super::trace::RenderPass;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell as Counter;
use zeroset_eval::{Boxes, Enclose, Enclosures, FindZeros, Kernel, KernelFloat, Zeros};
use zeroset_interval::Facts;
use zeroset_scene::program::ProgramError;
use zeroset_space::{Cell, CellSearch, Region};
use zeroset_trace::{NO_TILES, RayGrid, Window};

/// Largest number of evaluations in the search for a box. The search takes a tenth of a
/// millisecond.
const WORK: u64 = 4096;
/// Number of levels of cells from whose bounds the box of a parametric surface is made.
const PATCH_DEPTH: u32 = 2;
/// Number of halvings of a box.
const DEPTH: u32 = 6;

impl Model {
    /// A box that is proven to hold all zeros of a surface in the region. If the region may cut the
    /// surface, a solid, the box also holds all of the solid there. `None` if the region has
    /// neither zeros nor such parts of a solid.
    fn bounds(&self, surface: usize, is_cut: bool) -> Option<Cell> {
        let known = &self.bounds[surface][usize::from(is_cut)];
        *known.get_or_init(|| self.search_bounds(surface, is_cut, WORK, DEPTH))
    }

    /// As [`Model::bounds`], by a search with at most `work` evaluations that halves a box `depth`
    /// times.
    pub(super) fn search_bounds(
        &self,
        surface: usize,
        is_cut: bool,
        work: u64,
        depth: u32,
    ) -> Option<Cell> {
        let [low, high] = [self.region.low(), self.region.high()].map(|end| end.to_array());
        let whole = Cell { low, high };
        if let Some(patch) = self.program.patch(surface) {
            let found =
                patch.tree().ok().map_or(Some([[f64::NEG_INFINITY, f64::INFINITY]; 3]), |tree| {
                    tree.bounds(PATCH_DEPTH)
                });
            let found = found?;
            let low = [0, 1, 2].map(|axis| low[axis].max(found[axis][0]));
            let high = [0, 1, 2].map(|axis| high[axis].min(found[axis][1]));
            return (0..3).all(|axis| low[axis] <= high[axis]).then_some(Cell { low, high });
        }
        let kernels = self.program.kernels::<f64>(surface);
        // A large formula needs no box: its parts are left out anyway where they have no zeros.
        if kernels.has_parts() {
            return Some(whole);
        }
        let search = |kernel: &dyn Kernel<FindZeros, f64>| {
            let (surfaces, work) = (vec![kernel], Counter::new(work));
            let search = CellSearch { surfaces, forms: Vec::new(), wanted: &|| true, work };
            search.tight(whole, depth)
        };
        if is_cut {
            return kernels.bounds().map_or(Some(whole), |bounds| search(&FindSolid(bounds)));
        }
        kernels.zeros().map_or(Some(whole), search)
    }
}

/// Tells which boxes may hold a part of a solid, its boundary included.
struct FindSolid<'a>(&'a dyn Kernel<Enclose, f64>);

impl Kernel<FindZeros, f64> for FindSolid<'_> {
    fn eval(&self, boxes: &Boxes<f64>, zeros: &mut Zeros) {
        let mut bounds = Enclosures::default();
        self.0.eval(boxes, &mut bounds);
        let is_outside =
            |lane: usize| bounds.facts(lane).has(Facts::NOWHERE) || bounds.neg_lo[lane] < 0.0;
        let lanes = (0..boxes.count as usize).filter(|lane| !is_outside(*lane));
        *zeros = Zeros {
            possible: lanes.map(|lane| 1 << lane).sum(),
            unbounded: u16::MAX,
            jumping: u16::MAX,
        };
    }
}

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Returns whether surfaces are looked for in boxes around them. Only tiles leave out parts of
    /// a picture, and a single surface needs no box.
    fn has_bounds(&self) -> bool {
        let Self { model, settings, .. } = *self;
        let is_divided = settings.method.reads.contains(&NO_TILES) && settings.options.tiles;
        is_divided && !self.whole && model.visible_surfaces().nth(1).is_some()
    }

    /// A region that holds all zeros of a surface in the model's region. `None` if the surface is
    /// proven to have none.
    pub fn zeros_within(&self, surface: usize) -> Option<Region> {
        let region = self.model.region;
        if !self.has_bounds() {
            return Some(region);
        }
        let Cell { low, high } = self.model.bounds(surface, false)?;
        Some(Region::new(DVec3::from(low), DVec3::from(high)).unwrap_or(region))
    }

    /// For each visible surface, the pixels that may show it.
    pub fn windows(&self, rays: &RayGrid) -> Result<Vec<Window>, ProgramError> {
        let Self { model, .. } = *self;
        let surfaces: Vec<usize> = model.visible_surfaces().collect();
        if !self.has_bounds() {
            return Ok(vec![rays.everywhere(); surfaces.len()]);
        }
        let window = |&surface: &usize| {
            let is_cut = self.caps(surface)?.is_some();
            Ok(match model.bounds(surface, is_cut) {
                Some(Cell { low, high }) => rays.window(DVec3::from(low), DVec3::from(high)),
                None => Window { columns: 0..0, rows: 0..0 },
            })
        };
        surfaces.par_iter().map(window).collect()
    }
}
