//! Translucent surfaces: finds all points of each surface along a ray, and mixes their colors.
//!
//! Proofs concern the nearest point only, so layers do not affect them.

mod block;
#[cfg(test)]
mod tests;

use super::paint::Coloring;
use super::trace::{PreparedSurface, RenderPass};
use crate::pixels::ColorBuffer;
use block::Block;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use zeroset_eval::KernelFloat;
use zeroset_scene::program::ProgramError;
use zeroset_shade::{Colors, ColorsMut, Displayed, LinearRgb, UndecidedStyle, edges, shade};
use zeroset_trace::{Driver, GBuffer, RayGrid, Start, Status};

/// Largest number of points of one surface along a ray.
const MOST: usize = 8;

/// Light from behind is ignored if its share is smaller than this. Such light is not visible.
const DARK: f32 = 1.0 / 512.0;

/// Cosine between normal and ray below which a sheet's opacity does not grow further.
const LEAST_FACING: f32 = 0.12;

/// An undecided point has no proven end along the ray. A point at least this many pixels behind it
/// counts as another point.
const PIXELS_BEHIND: f64 = 2.0;

/// Limits of the memory for a picture's layers.
#[derive(Clone, Copy)]
pub(super) struct BlockLimits {
    /// Largest number of pixels that are traced at a time.
    pub pixels: usize,
    /// Largest number of points that are kept until they are mixed. A block of pixels with more
    /// points is divided.
    pub points: usize,
}

impl Default for BlockLimits {
    /// About 100 MB for one layer, and 80 MB for the points if colors are bytes.
    fn default() -> Self {
        Self { pixels: 1 << 20, points: 1 << 22 }
    }
}

/// A picture, and how its layers are found and colored.
#[derive(Clone, Copy)]
pub(super) struct Layered<'a> {
    pub rays: &'a RayGrid,
    pub picture: &'a GBuffer,
    /// The rays that are followed. Empty for all.
    pub only: &'a [bool],
    pub tracers: &'a [&'a PreparedSurface<'a>],
    pub finish: &'a Coloring<'a>,
    /// The light and opacity of the ground at a pixel, if it is seen there.
    pub ground: &'a (dyn Fn(usize) -> Option<Vec4> + Sync),
    /// A pixel of the final picture is this many of these pixels wide and high.
    pub side: usize,
}

/// A point that a translucent surface does not hide.
struct Point {
    /// Index in the picture.
    pixel: u32,
    /// Opacity, within [0, 1].
    opacity: f32,
    /// Distance from the ray's origin.
    drawn: f64,
}

/// Points of one surface, at most one for each ray.
struct Layer {
    /// In the order of the pixels.
    points: Vec<Point>,
    /// The color of each point.
    colors: Colors,
}

impl Layered<'_> {
    fn shaded(&self, buffer: &GBuffer, rays: &RayGrid) -> Colors {
        let Coloring { appearance, painter, depth, .. } = self.finish;
        let paint = painter.as_ref().map(|painter| painter.paint(buffer, rays, self.side));
        let seen = Displayed::new(buffer, rays);
        shade(&seen.buffer, &seen.rays, appearance, &paint.unwrap_or_default(), *depth)
    }
}

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Returns whether any visible surface is translucent.
    pub fn is_translucent(&self) -> bool {
        self.model.visible_surfaces().any(|surface| self.model.styles[surface].opacity < 1.0)
    }

    /// Computes the colors of a picture, multiplied by the opacity if it has opacities. If a
    /// surface is translucent, sets `edge` of each pixel at which a layer has an edge. `edge` may
    /// be empty.
    ///
    /// Layers are found block by block, and only their points are kept, so memory does not grow
    /// with the number of surfaces.
    pub fn colored(
        &self,
        all: &Layered<'_>,
        edge: &mut [bool],
    ) -> Result<ColorBuffer, ProgramError> {
        let mut pixels = self.with_alpha(all.shaded(all.picture, all.rays), all.picture);
        if self.is_translucent() {
            let mut blocks = Block::of_picture(all.rays, self.block.pixels);
            while let Some(mut block) = blocks.pop() {
                let layers = self.layers(all, &mut block, &mut blocks, edge)?;
                self.mix(all, &block, &layers, &mut pixels);
            }
        }
        Ok(pixels)
    }

    /// Finds all points along the rays of a block. Each surface has several layers: first its
    /// nearest points, then the points behind them, and so on. If there are too many points, the
    /// block shrinks, and its other part is added to `rest`.
    fn layers(
        &self,
        all: &Layered<'_>,
        block: &mut Block,
        rest: &mut Vec<Block>,
        edge: &mut [bool],
    ) -> Result<Vec<Layer>, ProgramError> {
        let mut layers: Vec<Layer> = Vec::new();
        let wanted = |_| self.is_wanted();
        for &&PreparedSurface { surface, ref tracer, ref window } in all.tracers {
            let known = block.known(all.rays);
            if !all.rays.is_patched() && !window.shows(&known.columns, &known.rows) {
                continue;
            }
            let rays = &known.rays(all.rays);
            let only = known.part(all.only, all.rays.width());
            let new = || {
                let mut layer = GBuffer::new(rays.width(), rays.height(), 0).with_brackets();
                self.make_room(surface, &mut layer);
                layer
            };
            let mut layer = new();
            self.find(surface, &**tracer, rays, &only, &mut layer, &wanted)?;
            for point in 1.. {
                self.compute_normals(surface, rays, &mut layer)?;
                if !edge.is_empty() {
                    // Edges behind a translucent surface are visible.
                    let seen = Displayed::new(&layer, rays);
                    known.mark(&edges(&seen.buffer, &seen.rays), edge, all.rays.width());
                }
                let starts = self.starts(rays, &layer);
                layers.push(self.points(all, block, &known, &layer, rays));
                layer.hand_back();
                while layers.iter().map(|layer| layer.points.len()).sum::<usize>()
                    > self.block.points
                    && let Some(part) = block.halve(all.rays)
                {
                    rest.push(part);
                    for layer in &mut layers {
                        layer.keep(block, all.rays.width());
                    }
                }
                if point == MOST || starts.iter().all(|start| start.is_infinite()) || !wanted(0) {
                    break;
                }
                // The ray must leave the surface before it can meet it again.
                layer = new();
                let driver = Driver { rays, tracer: &**tracer, advance: &wanted };
                driver.behind(&starts, Start::OnSurface, &mut layer);
                layer.surface.fill(surface as u16);
            }
        }
        Ok(layers)
    }

    /// The opacity of a pixel's point. A surface is a thin sheet, so a ray that crosses it at a
    /// grazing angle passes more of it.
    fn opacity(
        &self,
        finish: &Coloring<'_>,
        buffer: &GBuffer,
        rays: &RayGrid,
        pixel: usize,
    ) -> f32 {
        let is_left_out = finish.appearance.undecided == UndecidedStyle::Miss
            && buffer.status[pixel] == Status::Undecided;
        let style = &self.model.styles[usize::from(buffer.surface[pixel])];
        let opacity = style.opacity as f32;
        if is_left_out || opacity <= 0.0 {
            return 0.0;
        }
        let (Some(normal), true) = (buffer.normal.get(pixel), opacity < 1.0) else {
            return opacity;
        };
        let way = rays.ray_of(pixel).direction.normalize().as_vec3();
        let facing = Vec3::from_array(*normal).dot(way).abs();
        1.0 - (1.0 - opacity).powf(1.0 / facing.max(LEAST_FACING))
    }

    /// The points of a layer that are mixed with the picture's points. `layer` is traced along
    /// `rays`, those of the block `known`.
    fn points(
        &self,
        all: &Layered<'_>,
        block: &Block,
        known: &Block,
        layer: &GBuffer,
        rays: &RayGrid,
    ) -> Layer {
        let (picture, width) = (all.picture, all.rays.width());
        let colors = all.shaded(layer, rays);
        let (mut points, mut kept) = (Vec::new(), Colors::unset(all.finish.depth, 0));
        for (pixel, own) in block.pixels_of(known, width) {
            // The picture's own point is used as the nearest point, since it has shadows.
            let is_first = || {
                layer.surface[own] == picture.surface[pixel]
                    && layer.drawn[own] <= picture.drawn[pixel]
            };
            if !layer.is_drawn(own) || !picture.is_drawn(pixel) || is_first() {
                continue;
            }
            let share = self.opacity(all.finish, layer, rays, own);
            let is_hidden = 1.0 - self.opacity(all.finish, picture, all.rays, pixel) < DARK;
            if share > 0.0 && !is_hidden {
                let (pixel, drawn) = (pixel as u32, layer.drawn[own]);
                points.push(Point { pixel, opacity: share, drawn });
                kept.push(colors.get(own));
            }
        }
        colors.hand_back();
        points.shrink_to_fit();
        kept.shrink_to_fit();
        Layer { points, colors: kept }
    }

    /// For each pixel, the distance at which its ray continues behind a translucent point, in world
    /// units. Infinite if the ray ends.
    fn starts(&self, rays: &RayGrid, front: &GBuffer) -> Vec<f64> {
        let start = |pixel: usize| {
            let surface = usize::from(front.surface[pixel]);
            if !front.is_drawn(pixel) || self.model.styles[surface].opacity >= 1.0 {
                return f64::INFINITY;
            }
            let drawn = front.drawn[pixel];
            let end = front.bracket.get(pixel).map_or(f64::NAN, |bracket| bracket[1]);
            // The bracket belongs to the hit, but another point may be painted in front of it.
            if front.status[pixel] == Status::Hit && end >= drawn && !front.is_cap(pixel) {
                return end;
            }
            let ray = rays.ray_of(pixel);
            let footprint = ray.distance(rays.footprint(ray.parameter(drawn)));
            drawn + if front.is_cap(pixel) { 0.0 } else { PIXELS_BEHIND * footprint }
        };
        (0..front.drawn.len()).into_par_iter().map(start).collect()
    }

    /// Mixes the colors of a block's pixels with those of its layers.
    fn mix(&self, all: &Layered<'_>, block: &Block, layers: &[Layer], pixels: &mut ColorBuffer) {
        let Layered { picture, finish, .. } = *all;
        let [red, green, blue] = finish.appearance.background.0;
        let covers = if pixels.opacity.is_empty() { 1.0 } else { 0.0 };
        let background = Vec4::new(red, green, blue, covers);
        let width = all.rays.width();
        let mixed = |pixel: usize, own: LinearRgb, behind: &[(f64, f32, LinearRgb)]| {
            let color = |light: LinearRgb| Vec3::from_array(light.0).extend(1.0);
            let nearest = self.opacity(finish, picture, all.rays, pixel);
            let (mut light, mut left) = (nearest * color(own), 1.0 - nearest);
            for &(_, opacity, own) in behind {
                if left < DARK {
                    break;
                }
                light += left * opacity * color(own);
                left *= 1.0 - opacity;
            }
            light + left * (all.ground)(pixel).unwrap_or(background)
        };
        let mut opacities: Vec<&mut [f32]> = pixels.opacity.chunks_mut(width).collect();
        opacities.resize_with(all.rays.height(), Default::default);
        let rows = pixels.colors.as_mut().split(width).into_par_iter().zip(opacities).enumerate();
        let mix_row = |(row, (mut colors, opacities)): (usize, (ColorsMut<'_>, &mut [f32]))| {
            let first = row * width;
            let after =
                |layer: &Layer| layer.points.partition_point(|p| (p.pixel as usize) < first);
            let mut places: Vec<usize> = layers.iter().map(after).collect();
            let mut behind = Vec::new();
            for column in block.columns.clone() {
                let pixel = first + column;
                behind.clear();
                for (place, layer) in places.iter_mut().zip(layers) {
                    let next = layer.points.get(*place);
                    if let Some(point) = next.filter(|point| point.pixel as usize == pixel) {
                        behind.push((point.drawn, point.opacity, layer.colors.get(*place)));
                        *place += 1;
                    }
                }
                if picture.is_drawn(pixel) {
                    behind.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));
                    let found = mixed(pixel, colors.get(column), &behind);
                    colors.set(column, LinearRgb(found.truncate().to_array()));
                    if let Some(own) = opacities.get_mut(column) {
                        *own = found.w;
                    }
                }
            }
        };
        rows.skip(block.rows.start).take(block.rows.len()).for_each(mix_row);
    }
}

impl Layer {
    /// Removes all points outside of the block.
    fn keep(&mut self, block: &Block, width: usize) {
        let is_kept = |point: &Point| block.contains(point.pixel as usize, width);
        let mut kept = self.points.iter().map(is_kept);
        self.colors.retain(|| kept.next() == Some(true));
        self.points.retain(is_kept);
        self.points.shrink_to_fit();
        self.colors.shrink_to_fit();
    }
}
