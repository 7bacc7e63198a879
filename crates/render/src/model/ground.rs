//! The ground on which surfaces stand: a plane below them, on which they cast shadows.
//!
//! The ground is part of the picture's background. Statuses and distances do not know it: a pixel
//! that shows the ground is a miss.

use super::Model;
use super::blur::blur;
use super::strips::Overview;
use super::trace::RenderPass;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use zeroset_eval::KernelFloat;
use zeroset_scene::program::ProgramError;
use zeroset_shade::{Appearance, Light, LinearRgb, neighbors};
use zeroset_trace::{GBuffer, KernelStats, RayGrid};

/// Limits of the search for the lowest point of a surface: evaluations, and halvings of a box.
const WORK: u64 = 1 << 16;
const DEPTH: u32 = 10;

/// The ground fades into the background between these distances from the region's middle, in half
/// extents of the region.
const FADES: [f64; 2] = [1.3, 3.2];

/// Share of the ground's light that comes from all sides.
const AMBIENT: f32 = 0.5;

/// Light that the ground adds to a dark background, on which shadows would not be seen.
const LIFT: f32 = 0.06;

/// Radius of the blur of shadows, as a share of the picture's height: of the lamp's shadows, which
/// have edges, and of the sky's, which have none.
const BLUR_RADIUS: [f64; 2] = [1.0 / 180.0, 1.0 / 45.0];

/// Least radius of the blur, in pixels.
const LEAST_BLUR_RADIUS: [usize; 2] = [2, 4];

/// Multiples of these, without their whole parts, fill a square evenly: powers of the real root of
/// x³ = x + 1, inverted (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
const R2_SEQUENCE: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// The ground of a picture.
#[derive(Default)]
pub(super) struct Ground {
    /// The light and the opacity at each pixel. `None` where the ground is not seen. Before a
    /// transparent background, the ground is black, and only as opaque as its shadow.
    pub colors: Vec<Option<[f32; 4]>>,
    /// The share of the unshadowed light that reaches the ground at each pixel; NaN far from where
    /// the ground is seen.
    pub light: Vec<f32>,
    /// The cost of the shadows.
    pub work: KernelStats,
}

impl<T: KernelFloat> RenderPass<'_, T> {
    /// The ground of a picture; empty without a ground, or if the eye is below it. It is computed
    /// for pixels that show no opaque surface, and for their neighbors, where edges are smoothed.
    pub(super) fn ground(
        &self,
        rays: &RayGrid,
        picture: &GBuffer,
        appearance: &Appearance,
    ) -> Result<Ground, ProgramError> {
        let height = if self.model.has_ground(self.settings) {
            self.model.ground_height()
        } else {
            f64::NAN
        };
        // This is false for NaN, too.
        let is_seen = rays.eye().z > height;
        if !is_seen {
            return Ok(Ground::default());
        }
        let region = self.model.region().displayed();
        let is_open = |pixel: usize| {
            let surface = usize::from(picture.surface[pixel]);
            !picture.is_drawn(pixel) || self.model.styles[surface].opacity < 1.0
        };
        let is_near =
            |pixel: usize| is_open(pixel) || rays.beside(pixel).into_iter().flatten().any(is_open);
        let mut plane = GBuffer::new(rays.width(), rays.height(), 0);
        let mut shares = vec![0.0_f32; plane.drawn.len()];
        let place = |(pixel, (share, drawn)): (usize, (&mut f32, &mut f64))| {
            let ray = rays.ray_of(pixel);
            let t = (height - ray.origin.z) / ray.direction.z;
            if !(t > 0.0 && t.is_finite() && is_near(pixel)) {
                return;
            }
            let off = ray.at(t) * rays.stretch() - region.centre();
            let far = DVec2::new(off.x, off.y).length() / region.half_extent();
            let [near, end] = FADES;
            let part = ((far - near) / (end - near)).clamp(0.0, 1.0);
            *share = (1.0 - part * part * (3.0 - 2.0 * part)) as f32;
            if *share > 0.0 {
                *drawn = ray.distance(t);
            }
        };
        shares.par_iter_mut().zip(plane.drawn.par_iter_mut()).enumerate().for_each(place);
        let (light, work) = match self.overview {
            // A strip does not show enough of the ground for means over neighbors.
            Some(whole) => (whole.interpolated_light(rays, &plane.drawn), KernelStats::default()),
            None => self.light_of_ground(rays, &appearance.light, &mut plane)?,
        };
        let back = appearance.background.0;
        let is_transparent = self.model.is_transparent(self.settings);
        let is_dark = !is_transparent && back.iter().sum::<f32>() < 0.3;
        let color = |(share, light): (&f32, &f32)| {
            (*share > 0.0).then(|| {
                let light = if light.is_nan() { 1.0 } else { *light };
                let lift = if is_dark { LIFT * share } else { 0.0 };
                let factor = 1.0 - share * (1.0 - light);
                let [red, green, blue] = back.map(|part| (part + lift) * factor);
                // Programs that show pictures mix bytes, not light. Before white, they show this
                // opacity as a ground of this brightness.
                let [bright, ..] = LinearRgb([factor; 3]).encoded();
                [red, green, blue, if is_transparent { 1.0 - bright } else { 1.0 }]
            })
        };
        let colors = shares.iter().zip(&light).map(color).collect();
        Ok(Ground { colors, light, work })
    }

    /// The share of the unshadowed light that reaches the ground at each pixel of `plane`, and the
    /// cost.
    fn light_of_ground(
        &self,
        rays: &RayGrid,
        lamp: &Light,
        plane: &mut GBuffer,
    ) -> Result<(Vec<f32>, KernelStats), ProgramError> {
        let lamp = lamp.disc(self.model.region().displayed().centre());
        let lights: [&(dyn Fn([usize; 2]) -> Light + Sync); 2] =
            [&|pixel| lamp(quasirandom(pixel)), &|pixel| sky(quasirandom(pixel))];
        let mut work = KernelStats::default();
        let mut light = vec![1.0; plane.drawn.len()];
        for ((from, part), (soft, least)) in lights
            .into_iter()
            .zip([1.0 - AMBIENT, AMBIENT])
            .zip(BLUR_RADIUS.into_iter().zip(LEAST_BLUR_RADIUS))
        {
            let (hidden, cost) = self.hidden(rays, from, plane)?;
            work += cost;
            let radius = ((soft * rays.height() as f64).round() as usize).max(least);
            let hidden = blur(&hidden, &plane.drawn, rays.width(), radius);
            for (light, hidden) in light.iter_mut().zip(hidden) {
                *light -= part * hidden / 255.0;
            }
        }
        Ok((light, work))
    }

    /// The share of `light` that is hidden from each point of the ground; 255 means all of it.
    /// Translucent surfaces let a part of the light through.
    fn hidden(
        &self,
        rays: &RayGrid,
        light: &(dyn Fn([usize; 2]) -> Light + Sync),
        plane: &mut GBuffer,
    ) -> Result<(Vec<u8>, KernelStats), ProgramError> {
        let depth = self.settings.usual_shadow_depth();
        let opacity_of = |surface: usize| self.model.styles[surface].opacity;
        let mut work = self.shadows(rays, light, depth, &|n| opacity_of(n) >= 1.0, plane)?;
        let mut hidden = std::mem::take(&mut plane.shadow);
        hidden.resize(plane.drawn.len(), 0);
        let clear = self.model.visible_surfaces().map(opacity_of).filter(|part| *part < 1.0);
        if let Some(opacity) = clear.reduce(f64::max) {
            work += self.shadows(rays, light, depth, &|n| opacity_of(n) < 1.0, plane)?;
            // A ray crosses most surfaces twice.
            let part = (255.0 * (1.0 - (1.0 - opacity).powi(2))).round() as u8;
            for (hidden, shadow) in hidden.iter_mut().zip(std::mem::take(&mut plane.shadow)) {
                *hidden = (*hidden).max(shadow.min(part));
            }
        }
        Ok((hidden, work))
    }
}

impl Model {
    /// The height of the ground: below all visible surfaces, and as near as a short search finds.
    /// NaN if there is no surface.
    pub(crate) fn ground_height(&self) -> f64 {
        let lowest = |surface: usize| {
            let is_solid = self.styles[surface].is_solid;
            Some(self.search_bounds(surface, is_solid, WORK, DEPTH)?.low[2])
        };
        let search = || self.visible_surfaces().filter_map(lowest).reduce(f64::min);
        *self.ground.get_or_init(|| search().unwrap_or(f64::NAN))
    }
}

impl Overview {
    /// The share of the unshadowed light that reaches the ground at each pixel whose distance
    /// `drawn` is finite; NaN at other pixels.
    fn interpolated_light(&self, rays: &RayGrid, drawn: &[f64]) -> Vec<f32> {
        let of_pixel = |pixel: usize| {
            let (mut sum, mut weights) = (0.0, 0.0);
            let place = [pixel % rays.width(), pixel / rays.width()];
            let near = neighbors(rays, &self.rays, place).filter(|_| drawn[pixel].is_finite());
            for (there, weight) in near {
                let light = self.picture.ground.get(there).copied().unwrap_or(f32::NAN);
                if !light.is_nan() {
                    sum += weight as f32 * light;
                    weights += weight as f32;
                }
            }
            sum / weights
        };
        (0..drawn.len()).into_par_iter().map(of_pixel).collect()
    }
}

/// A place in the unit square for each pixel. The places of neighboring pixels fill it evenly.
fn quasirandom([column, row]: [usize; 2]) -> [f64; 2] {
    let [column, row] = [column as f64, row as f64];
    [
        (R2_SEQUENCE[0] * column + R2_SEQUENCE[1] * row).fract(),
        (R2_SEQUENCE[1] * column - R2_SEQUENCE[0] * row).rem_euclid(1.0),
    ]
}

/// A distant light for a place in the unit square. If places are spread evenly over the square, the
/// number of lights per solid angle is proportional to the light that a horizontal plane receives
/// from there.
fn sky([square, turns]: [f64; 2]) -> Light {
    let (sine, cosine) = (turns * TAU).sin_cos();
    let aside = square.sqrt();
    Light::Directional(DVec3::new(aside * cosine, aside * sine, (1.0 - square).sqrt()))
}
