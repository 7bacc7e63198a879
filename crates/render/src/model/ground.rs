//! The ground on which surfaces stand: a plane below them, on which they cast shadows.
//!
//! The ground is part of the picture's background. Statuses and distances do not know it: a pixel
//! that shows the ground is a miss.

use super::trace::RenderPass;
use glam::{DVec2, DVec3};
use zeroset_eval::KernelFloat;
use zeroset_scene::program::ProgramError;
use zeroset_shade::{AmbientOcclusion, Appearance, Displayed, Light, LinearRgb, TURNS};
use zeroset_syntax::SurfaceKind;
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

/// Number of times that the shadows of neighboring pixels are averaged.
const MEANS: usize = 3;

/// The golden angle, in radians.
const GOLDEN: f64 = 2.399_963_23;

/// The color and the opacity of the ground at each pixel. `None` where it is not seen. Before a
/// transparent background, the ground is black, and only as opaque as its shadow.
pub(super) type GroundColors = Vec<Option<[u8; 4]>>;

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Returns whether the picture has a ground.
    fn has_ground(&self) -> bool {
        self.settings.ground.unwrap_or(self.model.setting.lines.ground == Some(true))
            && self.settings.normals.is_some()
    }

    /// The colors of the ground of a picture, and the cost of its shadows. `None` without a ground,
    /// or if the eye is below it. They are computed for pixels that show no opaque surface, and for
    /// their neighbors, where edges are smoothed.
    pub(super) fn ground(
        &self,
        rays: &RayGrid,
        picture: &GBuffer,
        appearance: &Appearance,
    ) -> Result<Option<(GroundColors, KernelStats)>, ProgramError> {
        let height = if self.has_ground() { self.lowest() } else { f64::NAN };
        // This is false for NaN, too.
        let is_seen = rays.eye().z > height;
        if !is_seen {
            return Ok(None);
        }
        let (width, region) = (rays.width(), self.model.region().displayed());
        let is_open = |pixel: usize| {
            let surface = usize::from(picture.surface[pixel]);
            !picture.is_drawn(pixel) || self.model.styles[surface].opacity < 1.0
        };
        let is_near =
            |pixel: usize| is_open(pixel) || rays.beside(pixel).into_iter().flatten().any(is_open);
        let mut plane = GBuffer::new(width, rays.height(), 0);
        let mut shares = vec![0.0_f32; plane.drawn.len()];
        for (pixel, share) in shares.iter_mut().enumerate() {
            let ray = rays.ray_of(pixel);
            let t = (height - ray.origin.z) / ray.direction.z;
            if !(t > 0.0 && t.is_finite() && is_near(pixel)) {
                continue;
            }
            let off = ray.at(t) * rays.stretch() - region.centre();
            let far = DVec2::new(off.x, off.y).length() / region.half_extent();
            let [near, end] = FADES;
            let part = ((far - near) / (end - near)).clamp(0.0, 1.0);
            *share = (1.0 - part * part * (3.0 - 2.0 * part)) as f32;
            if *share > 0.0 {
                plane.drawn[pixel] = ray.distance(t);
                plane.normal[pixel] = [0.0, 0.0, 1.0];
            }
        }
        let mut work = KernelStats::default();
        let mut hidden = |lights: &[Light; TURNS], plane: &mut GBuffer| {
            let (hidden, cost) = self.hidden(rays, lights, plane)?;
            work += cost;
            Ok::<_, ProgramError>(hidden)
        };
        let mut all = [
            hidden(&appearance.light.widened(region.centre()), &mut plane)?,
            hidden(&sky(0.0), &mut plane)?,
            hidden(&sky(0.5), &mut plane)?,
        ];
        let seen = Displayed::new(&plane, rays);
        let near = AmbientOcclusion::new(&seen.buffer, &seen.rays, region.centre());
        for hidden in &mut all {
            (0..MEANS).for_each(|_| near.mean(hidden));
        }
        let back = appearance.background.0;
        let is_transparent = self.model.is_transparent(self.settings);
        let is_dark = !is_transparent && back.iter().sum::<f32>() < 0.3;
        let color = |pixel: usize| {
            let share = shares[pixel];
            (share > 0.0).then(|| {
                let [direct, one, other] =
                    all.each_ref().map(|hidden| 1.0 - f32::from(hidden[pixel]) / 255.0);
                let light = AMBIENT * 0.5 * (one + other) + (1.0 - AMBIENT) * direct;
                let lift = if is_dark { LIFT * share } else { 0.0 };
                let factor = 1.0 - share * (1.0 - light);
                let color = LinearRgb(back.map(|part| (part + lift) * factor));
                let [red, green, blue] = color.to_srgb();
                // Programs that show pictures mix bytes, not light. Before white, they show this
                // opacity as a ground of this brightness.
                let [bright, ..] = LinearRgb([factor; 3]).to_srgb();
                [red, green, blue, if is_transparent { 255 - bright } else { 255 }]
            })
        };
        Ok(Some(((0..shares.len()).map(color).collect(), work)))
    }

    /// The share of `lights` that is hidden from each point of the ground; 255 means that all of
    /// them are hidden. Translucent surfaces let a part of the light through.
    fn hidden(
        &self,
        rays: &RayGrid,
        lights: &[Light; TURNS],
        plane: &mut GBuffer,
    ) -> Result<(Vec<u8>, KernelStats), ProgramError> {
        let depth = self.settings.usual_shadow_depth();
        let opacity_of = |surface: usize| self.model.styles[surface].opacity;
        let mut work = self.shadows(rays, lights, depth, &|n| opacity_of(n) >= 1.0, plane)?;
        let mut hidden = std::mem::take(&mut plane.shadow);
        hidden.resize(plane.drawn.len(), 0);
        let clear = self.model.visible_surfaces().map(opacity_of).filter(|part| *part < 1.0);
        if let Some(opacity) = clear.reduce(f64::max) {
            work += self.shadows(rays, lights, depth, &|n| opacity_of(n) < 1.0, plane)?;
            // A ray crosses most surfaces twice.
            let part = (255.0 * (1.0 - (1.0 - opacity).powi(2))).round() as u8;
            for (hidden, shadow) in hidden.iter_mut().zip(std::mem::take(&mut plane.shadow)) {
                *hidden = (*hidden).max(shadow.min(part));
            }
        }
        Ok((hidden, work))
    }

    /// The height of the ground: below all visible surfaces, and as near as a short search finds.
    /// NaN if there is no surface.
    fn lowest(&self) -> f64 {
        let heights = self.model.visible_surfaces().filter_map(|surface| {
            let is_solid = self.model.styles[surface].kind == SurfaceKind::Solid;
            Some(self.model.search_bounds(surface, is_solid, WORK, DEPTH)?.low[2])
        });
        heights.reduce(f64::min).unwrap_or(f64::NAN)
    }
}

/// Distant lights in sixteen directions, as many per solid angle as a horizontal plane receives
/// light from there. `turn` is from 0 to 1: other turns have other directions.
fn sky(turn: f64) -> [Light; TURNS] {
    std::array::from_fn(|n| {
        // Consecutive directions lie far apart.
        let place = (7 * n % TURNS) as f64 + turn;
        let sine = ((place + 0.25) / TURNS as f64).sqrt();
        let [x, y] = [(place * GOLDEN).cos(), (place * GOLDEN).sin()];
        Light::Directional(DVec3::new(sine * x, sine * y, (1.0 - sine * sine).sqrt()))
    })
}
