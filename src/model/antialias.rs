//! Colours of pixels through which an edge goes: the mean over many rays, each followed and lit as the one through the
//! centre was.

use super::paint::Finish;
use super::trace::{Shot, Tracers};
use crate::picture::Settings;
use crate::program::ProgramError;
use rayon::prelude::*;
use std::ops::Range;
use zeroset_eval::KernelFloat;
use zeroset_trace::{GBuffer, Pattern, RayGrid, Status, UndecidedStyle, edges, hand_back_colours};

/// Columns and rows of the finer picture that are traced at a time: as many tiles as a kernel takes, and few enough for the
/// nearer caches.
const BLOCK: [usize; 2] = [256, 16];

/// Room for a block.
type Buffers = [GBuffer; 2];

impl<T: KernelFloat> Shot<'_, T> {
    /// Gives pixels with edges the mean of their colours; returns how many rays it took.
    pub(super) fn smooth_edges(
        &self,
        rays: &RayGrid,
        picture: &GBuffer,
        layers: &[GBuffer],
        finish: &Finish<'_>,
        rgb: &mut [u8],
    ) -> Result<usize, ProgramError> {
        let Settings { antialias: pattern, tolerance, .. } = *self.settings;
        let side = pattern.side;
        // Pixels of the finer picture are so much smaller.
        let tolerance = tolerance * side as f64;
        let tracers = &self.tracers(tolerance)?;
        let mut wanted = edges(picture, rays);
        for layer in layers {
            // What is seen through a surface has edges, too.
            wanted.iter_mut().zip(edges(layer, rays)).for_each(|(all, edge)| *all |= edge);
        }
        if finish.appearance.undecided != UndecidedStyle::Shade {
            // What is marked stays marked.
            wanted.iter_mut().zip(&picture.status).for_each(|(edge, status)| {
                *edge &= *status != Status::Undecided;
            });
        }
        let edge = Edges {
            shot: self,
            tracers,
            rays,
            finer: rays.finer(side),
            picture,
            wanted,
            pattern,
            finish,
            is_hidden: picture.shadow.iter().chain(&picture.occlusion).any(|hidden| *hidden > 0),
        };
        let (width, height) = (rays.width(), rays.height());
        let [across, down] = BLOCK.map(|size| (size / side).max(1));
        let columns = (0..width).step_by(across).map(|first| first..width.min(first + across));
        let rows = (0..height).step_by(down).map(|first| first..height.min(first + down));
        let columns: Vec<_> = columns.collect();
        let blocks: Vec<_> = rows
            .flat_map(|rows| columns.iter().map(move |columns| (columns.clone(), rows.clone())))
            .collect();
        let new = || [0; 2].map(|size| GBuffer::new(size, size, 0));
        let smooth = |buffers: &mut Buffers, (columns, rows)| edge.smooth(buffers, columns, rows);
        let found: Result<Vec<_>, ProgramError> =
            blocks.into_par_iter().map_init(new, smooth).collect();
        let pixels = rgb.as_chunks_mut::<3>().0;
        let mut count = 0;
        for (pixel, colour) in found?.into_iter().flatten() {
            pixels[pixel] = colour;
            count += pattern.count();
        }
        Ok(count)
    }
}

struct Edges<'a, T> {
    shot: &'a Shot<'a, T>,
    tracers: &'a Tracers<'a>,
    rays: &'a RayGrid,
    finer: RayGrid,
    picture: &'a GBuffer,
    wanted: Vec<bool>,
    pattern: Pattern,
    finish: &'a Finish<'a>,
    /// Whether light is hidden from any point.
    is_hidden: bool,
}

impl<T: KernelFloat> Edges<'_, T> {
    /// The colours of a block's pixels with edges.
    fn smooth(
        &self,
        [all, layer]: &mut Buffers,
        columns: Range<usize>,
        rows: Range<usize>,
    ) -> Result<Vec<(usize, [u8; 3])>, ProgramError> {
        let (side, across) = (self.pattern.side, columns.len());
        let pixel = |square: usize| {
            (rows.start + square / across) * self.rays.width() + columns.start + square % across
        };
        let row = |row: usize| {
            let first = row * self.rays.width();
            &self.wanted[first + columns.start..first + columns.end]
        };
        let edges: Vec<bool> = rows.clone().flat_map(row).copied().collect();
        if !edges.contains(&true) || !(self.shot.advance)(0) {
            return Ok(Vec::new());
        }
        let finer = |range: &Range<usize>| range.start * side..range.end * side;
        let rays = self.finer.part(finer(&columns), finer(&rows));
        let (width, height) = (rays.width(), rays.height());
        let only = self.pattern.rays(&edges, across);
        for (place, &(surface, ref tracer)) in self.tracers.iter().enumerate() {
            let target = if place == 0 { &mut *all } else { &mut *layer };
            target.reset(width, height, 0);
            self.shot.find(surface, &**tracer, &rays, &only, target, &|_| true)?;
            self.shot.face(surface, &rays, target)?;
            if place > 0 {
                all.merge(layer);
            }
        }
        if self.is_hidden {
            for n in (0..only.len()).filter(|&n| only[n]) {
                let square = n / width / side * across + n % width / side;
                self.borrow(all, n, pixel(square));
            }
        }
        let layers = self.shot.layers(&rays, &only, self.tracers)?;
        let bytes = self.shot.coloured(&rays, all, &layers, self.finish, side);
        let squares = (0..edges.len()).filter(|&square| edges[square]);
        let colour = |square| (pixel(square), self.pattern.mean(&bytes, square, across));
        let found = squares.map(colour).collect();
        hand_back_colours(bytes);
        Ok(found)
    }

    /// How much light is hidden from a point of the finer picture: as much as from the nearest one of the same surface that
    /// is known, in the pixel that it belongs to or beside it.
    fn borrow(&self, finer: &mut GBuffer, n: usize, pixel: usize) {
        if !finer.is_drawn(n) {
            return;
        }
        let (width, height) = (self.rays.width(), self.rays.height());
        let (column, row) = (pixel % width, pixel / width);
        let columns = column.saturating_sub(1)..(column + 2).min(width);
        let rows = row.saturating_sub(1)..(row + 2).min(height);
        let beside = rows.flat_map(|row| columns.clone().map(move |column| row * width + column));
        let known = beside.filter(|&there| {
            self.picture.is_drawn(there) && self.picture.surface[there] == finer.surface[n]
        });
        let off = |there: &usize| (self.picture.drawn[*there] - finer.drawn[n]).abs();
        if let Some(nearest) = known.min_by(|a, b| off(a).total_cmp(&off(b))) {
            finer.shadow[n] = self.picture.shadow[nearest];
            finer.occlusion[n] = self.picture.occlusion[nearest];
        }
    }
}
