//! Translucent surfaces: finds all points of each surface along a ray, and mixes their colors.
//!
//! Proofs concern the nearest point only, so layers do not affect them.

use super::paint::Coloring;
use super::trace::{RenderPass, Tracers};
use rayon::prelude::*;
use zeroset_eval::KernelFloat;
use zeroset_scene::program::ProgramError;
use zeroset_shade::{LinearRgb, UndecidedStyle, hand_back_colors, shade};
use zeroset_trace::{Driver, GBuffer, RayGrid, Start, Status};

/// Largest number of points of one surface along a ray.
const MOST: usize = 8;

/// Light from behind is ignored if its share is smaller than this. Such light is not visible.
const DARK: f32 = 1.0 / 512.0;

/// An undecided point has no proven end along the ray. A point at least this many pixels behind it
/// counts as another point.
const PIXELS_BEHIND: f64 = 2.0;

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Returns whether any visible surface is translucent.
    pub fn is_translucent(&self) -> bool {
        self.model.visible_surfaces().any(|surface| self.model.styles[surface].opacity < 1.0)
    }

    /// Finds all points along the rays selected by `only`, or along all rays if that is empty. Each
    /// surface has several layers: first its nearest points, then the points behind them, and so
    /// on. The result is empty if nothing is translucent.
    pub fn layers(
        &self,
        rays: &RayGrid,
        only: &[bool],
        tracers: &Tracers<'_>,
    ) -> Result<Vec<GBuffer>, ProgramError> {
        let mut layers: Vec<GBuffer> = Vec::new();
        if !self.is_translucent() {
            return Ok(layers);
        }
        let wanted = |_| (self.advance)(0);
        let new = || GBuffer::new(rays.width(), rays.height(), 0).with_brackets();
        for &(surface, ref tracer) in tracers {
            let mut layer = new();
            self.find(surface, &**tracer, rays, only, &mut layer, &wanted)?;
            for point in 1.. {
                self.compute_normals(surface, rays, &mut layer)?;
                let starts = self.starts(rays, &layer);
                layers.push(layer);
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

    /// Computes the colors of a picture, as sRGB bytes. `layers` holds the points of all layers if
    /// there is a translucent surface, and else is empty.
    pub fn colored(
        &self,
        rays: &RayGrid,
        picture: &GBuffer,
        layers: &[GBuffer],
        finish: &Coloring<'_>,
        side: usize,
    ) -> Vec<u8> {
        let Coloring { appearance, painter } = finish;
        let shaded = |buffer: &GBuffer| {
            let paint = painter.as_ref().map(|painter| painter.paint(buffer, rays, side));
            shade(buffer, rays, appearance, &paint.unwrap_or_default())
        };
        let first = shaded(picture);
        if layers.is_empty() {
            return first;
        }
        let colors: Vec<Vec<u8>> = layers.iter().map(shaded).collect();
        let opacity = |buffer: &GBuffer, pixel: usize| {
            let is_left_out = appearance.undecided == UndecidedStyle::Miss
                && buffer.status[pixel] == Status::Undecided;
            let style = &self.model.styles[usize::from(buffer.surface[pixel])];
            if is_left_out { 0.0 } else { style.opacity as f32 }
        };
        let mixed = |order: &mut Vec<usize>, pixel: usize| {
            let color = |bytes: &[u8]| LinearRgb::from_srgb(bytes.as_chunks().0[pixel]).0;
            if !picture.is_drawn(pixel) {
                return color(&first);
            }
            // The picture's own point is used as the nearest point, since it has shadows.
            let is_behind = |layer: &usize| {
                let layer = &layers[*layer];
                let is_first = layer.surface[pixel] == picture.surface[pixel]
                    && layer.drawn[pixel] <= picture.drawn[pixel];
                layer.is_drawn(pixel) && !is_first
            };
            order.clear();
            order.extend((0..layers.len()).filter(is_behind));
            order.sort_by(|a, b| layers[*a].drawn[pixel].total_cmp(&layers[*b].drawn[pixel]));
            let nearest = opacity(picture, pixel);
            let mut light = color(&first).map(|own| nearest * own);
            let mut left = 1.0 - nearest;
            for &layer in order.iter() {
                if left < DARK {
                    break;
                }
                let share = left * opacity(&layers[layer], pixel);
                let own = color(&colors[layer]);
                light.iter_mut().zip(own).for_each(|(light, own)| *light += share * own);
                left -= share;
            }
            let behind = appearance.background.0;
            light.iter_mut().zip(behind).for_each(|(light, behind)| *light += left * behind);
            light
        };
        let pixels = (0..rays.width() * rays.height()).into_par_iter();
        let bytes =
            pixels.map_init(Vec::new, |order, pixel| LinearRgb(mixed(order, pixel)).to_srgb());
        let bytes = bytes.collect::<Vec<[u8; 3]>>().into_flattened();
        colors.into_iter().chain([first]).for_each(hand_back_colors);
        bytes
    }
}
