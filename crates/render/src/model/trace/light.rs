//! Lighting of a picture: shadows, ambient occlusion and colors.

use super::super::ground::Ground;
use super::super::layers::Layered;
use super::super::outlines;
use super::super::paint::{Coloring, Painter};
use super::super::{Stopwatch, SurfaceStyle};
use super::RenderPass;
use crate::legend::Legend;
use crate::picture::{Normals, Times};
use crate::pixels::ColorBuffer;
use glam::DVec3;
use zeroset_eval::{KernelFloat, Points};
use zeroset_scene::program::ProgramError;
use zeroset_shade::{
    AmbientOcclusion, Appearance, Colors, Displayed, Haze, Light, LinearRgb, Pattern,
    SurfaceColors, UndecidedStyle, borrow_occlusion, turn,
};
use zeroset_space::Ball;
use zeroset_syntax::{Background, SurfaceColor};
use zeroset_trace::{Driver, GBuffer, KernelStats, RayGrid, Status, TraceOptions};

/// Distance from the surface at which shadow rays start, in widths of the smallest slab. This keeps
/// the surface from shadowing itself.
const SHADOW_OFFSET_SLABS: f64 = 2.0;

/// Radius within which ambient occlusion is computed, as a share of the region's largest extent.
const NEAR: f64 = 0.12;

/// The absence of light.
const BLACK: LinearRgb = LinearRgb([0.0; 3]);

/// Remark on a picture for whose colors there was not enough time.
const CUT: &str = "there was no time to compute the colors of all points";

/// Colors of a picture, and the cost of lighting it.
pub(super) struct Lit {
    pub pixels: ColorBuffer,
    /// As [`Picture::ground`](crate::picture::Picture).
    pub ground: Vec<f32>,
    /// The color of pixels that show no surface, before any shadow.
    pub background: [u8; 3],
    pub legends: Vec<Legend>,
    /// Remarks on the model, and on colors that are missing.
    pub remarks: Vec<String>,
    pub edge_rays: usize,
    pub work: KernelStats,
}

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Computes shadows, ambient occlusion and colors of the traced points. If the colors are
    /// `known`, only antialiasing changes them.
    pub(super) fn light(
        &self,
        rays: &RayGrid,
        buffer: &mut GBuffer,
        known: Option<Colors>,
        times: &mut Times,
    ) -> Result<Lit, ProgramError> {
        let settings = self.settings;
        let mut watch = Stopwatch::start();
        let light = self.model.key_light(self.settings, rays);
        let mut work = self.compute_occlusion(rays, &light, buffer)?;
        times.occlude += watch.lap();
        let mut remarks = self.model.remarks.clone();
        let (mut pixels, mut legends, mut edge_rays) = (ColorBuffer::default(), Vec::new(), 0);
        let mut ground = Vec::new();
        let mut background = self.model.look(settings).background;
        if settings.normals.is_some() {
            let painter = match self.overview {
                Some(whole) => {
                    Painter::new(self.model, &whole.picture.buffer, &whole.rays, self.advance)
                }
                None => Painter::new(self.model, buffer, rays, self.advance),
            };
            let is_seen = || buffer.drawn.iter().any(|drawn| drawn.is_finite());
            let appearance = self.appearance(rays, &is_seen);
            let Ground { colors, light, work: cost } = self.ground(rays, buffer, &appearance)?;
            if self.overview.is_none() {
                ground = light;
            }
            work += cost;
            if !self.model.is_transparent(settings) {
                background = appearance.background.to_srgb();
            }
            let finish = Coloring { appearance, depth: settings.depth, painter, ground: colors };
            legends = finish.painter.as_ref().map(Painter::legends).unwrap_or_default();
            let is_smoothed = settings.antialias != Pattern::ONE;
            let is_translucent = self.is_translucent();
            let mut behind =
                vec![false; if is_smoothed && is_translucent { buffer.status.len() } else { 0 }];
            pixels = if let Some(known) = known {
                self.with_alpha(known, buffer)
            } else {
                let mut tracers = Vec::new();
                if is_translucent {
                    tracers = self.tracers(rays, |options| options)?;
                }
                let tracers: Vec<_> = tracers.iter().collect();
                let layered = Layered {
                    rays,
                    picture: buffer,
                    only: &[],
                    tracers: &tracers,
                    finish: &finish,
                    ground: &|pixel| finish.ground_at(pixel),
                    side: 1,
                };
                self.colored(&layered, &mut behind)?
            };
            for pixel in 0..finish.ground.len() {
                if let Some(ground) = finish.ground_at(pixel).filter(|_| !buffer.is_drawn(pixel)) {
                    pixels.set(pixel, ground);
                }
            }
            if finish.painter.as_ref().is_some_and(Painter::is_cut) {
                remarks.push(CUT.to_owned());
            }
            // Layers are colored as soon as they are traced.
            *(if is_translucent { &mut times.trace } else { &mut times.shade }) += watch.lap();
            if is_smoothed && self.is_wanted() {
                edge_rays = self.smooth_edges(rays, buffer, &behind, &finish, &mut pixels)?;
                times.antialias += watch.lap();
            }
            if !pixels.opacity.is_empty() {
                pixels.divide(self.model.look(settings).background);
            }
            if self.has_outlines() {
                let seen = Displayed::new(buffer, rays);
                outlines::draw(&seen, settings.height, background, &mut pixels);
            }
        }
        Ok(Lit { pixels, ground, background, legends, remarks, edge_rays, work })
    }

    /// Returns whether lines are drawn at edges.
    pub(super) fn has_outlines(&self) -> bool {
        self.model.choices(self.settings).outlines == Some(true)
    }

    /// Returns whether a pixel has a surface's color. Undecided pixels may be left out.
    pub(in crate::model) fn is_painted(&self, picture: &GBuffer, pixel: usize) -> bool {
        let is_left_out = self.settings.undecided == UndecidedStyle::Miss
            && picture.status[pixel] == Status::Undecided;
        picture.is_drawn(pixel) && !is_left_out
    }

    /// The colors of a picture. If the background is transparent, they get opacities: painted
    /// pixels are opaque.
    pub(in crate::model) fn with_alpha(&self, colors: Colors, picture: &GBuffer) -> ColorBuffer {
        let mut opacity = Vec::new();
        if self.model.is_transparent(self.settings) {
            let pixels = 0..picture.drawn.len();
            let of_pixel = |pixel| if self.is_painted(picture, pixel) { 1.0 } else { 0.0 };
            opacity = pixels.map(of_pixel).collect();
        }
        ColorBuffer { colors, opacity }
    }

    /// Number of halvings along a shadow ray. `None` without shadows.
    pub(super) fn shadow_depth(&self) -> Option<u32> {
        let settings = self.settings;
        let depth = || settings.shadow_depth.unwrap_or_else(|| settings.usual_shadow_depth());
        (self.model.choices(settings).shadows == Some(true)).then(depth)
    }

    /// Returns whether ambient occlusion is computed.
    pub(super) fn occludes(&self) -> bool {
        let settings = self.settings;
        settings.occlusion && self.model.look(settings).occlusion && settings.normals.is_some()
    }

    /// Computes how much light shadows and ambient occlusion keep from the painted points.
    fn compute_occlusion(
        &self,
        rays: &RayGrid,
        light: &Light,
        buffer: &mut GBuffer,
    ) -> Result<KernelStats, ProgramError> {
        let model = self.model;
        let occludes = self.occludes();
        let mut work = KernelStats::default();
        let shadow_depth = self.shadow_depth();
        if let Some(depth) = shadow_depth {
            let lights = light.widened(model.region.displayed().centre());
            let light = |pixel| lights[turn(pixel)];
            work += self.shadows(rays, &light, depth, &|_| true, buffer)?;
        }
        if !occludes && shadow_depth.is_none() || !self.is_wanted() {
            return Ok(work);
        }
        let seen = Displayed::new(buffer, rays);
        let box_seen = model.region.displayed();
        let overview = self.overview.filter(|_| occludes);
        let smooths = shadow_depth.is_some() && self.settings.normals.is_some();
        let (mut shadow, mut occlusion) = (None, None);
        if smooths {
            let near = AmbientOcclusion::new(&seen.buffer, &seen.rays, box_seen.centre());
            let mut mean = buffer.shadow.clone();
            // Average twice, since beside an edge the square for the mean is incomplete.
            (0..2).for_each(|_| near.mean(&mut mean));
            shadow = Some(mean);
        }
        if let Some(whole) = overview {
            let whole = Displayed::new(&whole.picture.buffer, &whole.rays);
            occlusion =
                Some(borrow_occlusion(&seen.buffer, &seen.rays, &whole.buffer, &whole.rays));
        } else if occludes {
            let near = AmbientOcclusion::coarse(&seen.buffer, &seen.rays, box_seen.centre());
            let reach = NEAR * 2.0 * box_seen.half_extent();
            occlusion = Some(near.occlusion(reach, &|| self.is_wanted()));
        }
        if let Some(shadow) = shadow {
            buffer.shadow = shadow;
        }
        if let Some(occlusion) = occlusion {
            buffer.occlusion = occlusion;
        }
        Ok(work)
    }

    /// Sets `buffer.shadow` of the painted points from which a light is not seen. `light` gives the
    /// light of a pixel's column and row, in the displayed space. Only the surfaces for which
    /// `casts` is true hide the light.
    pub(in crate::model) fn shadows(
        &self,
        rays: &RayGrid,
        light: &(dyn Fn([usize; 2]) -> Light + Sync),
        depth: u32,
        casts: &dyn Fn(usize) -> bool,
        buffer: &mut GBuffer,
    ) -> Result<KernelStats, ProgramError> {
        // The surface may lie anywhere in the slab that contains it.
        let offset = self.extent() * SHADOW_OFFSET_SLABS * 0.5_f64.powi(depth as i32);
        let stretch = rays.stretch();
        let mut work = KernelStats::default();
        buffer.shadow.clear();
        // Shadow rays do not count as progress.
        let wanted = |_| self.is_wanted();
        for surface in self.model.visible_surfaces().filter(|surface| casts(*surface)) {
            let Some(bounds) = self.zeros_within(surface) else { continue };
            let tracer = self.tracer(surface, |options| TraceOptions { depth, ..options })?;
            let driver = Driver { rays, tracer: &*tracer, advance: &wanted };
            let towards = |pixel, point: DVec3| {
                let (way, distance) = light(pixel).towards(point * stretch);
                let way = way / stretch;
                (way.normalize_or_zero(), distance * way.length())
            };
            work += driver.shadows(buffer, towards, offset, &bounds);
            if !self.is_wanted() {
                break;
            }
        }
        Ok(work)
    }

    /// The haze of a picture, if it has any: it begins at the region's near side, and is strongest
    /// at its far side.
    fn haze(&self, rays: &RayGrid, color: LinearRgb) -> Option<Haze> {
        let strength = self.model.choices(self.settings).haze.unwrap_or(0.0);
        let (rays, region) = (rays.displayed(), self.model.region.displayed());
        let middle = (region.centre() - rays.eye()).dot(rays.forward());
        let between = [-1.0, 1.0].map(|side| middle + side * region.half_extent());
        (strength > 0.0).then_some(Haze { color, between, strength: strength as f32 })
    }

    /// The light and the colors of surfaces. `is_seen` returns whether any surface is painted. If
    /// none is, the sides of surfaces are not determined, since that takes a kernel.
    pub(super) fn appearance(&self, rays: &RayGrid, is_seen: &dyn Fn() -> bool) -> Appearance {
        let settings = self.settings;
        let plain =
            Appearance::new(self.model.look(settings), self.model.key_light(self.settings, rays));
        let (background, typed) = (settings.background, self.model.setting.background);
        let color = match background.or(typed) {
            Some(Background::Color(color)) => LinearRgb::from_srgb(color.rgb),
            Some(Background::Transparent) | None => plain.background,
        };
        // A hidden surface may not have been compiled.
        let turned = |surface: usize| {
            let known = &self.model.turned[surface];
            let find = || is_seen() && *known.get_or_init(|| self.is_negative_outside(surface));
            !self.model.styles[surface].hidden && known.get().copied().unwrap_or_else(find)
        };
        let surface = |(index, style): (usize, &SurfaceStyle)| {
            let colors = match &style.color {
                Some(SurfaceColor::Plain(color)) => {
                    SurfaceColors::around(LinearRgb::from_srgb(color.rgb))
                }
                Some(SurfaceColor::Mapped(_)) | None => SurfaceColors::default_for(index),
            };
            let mut colors = SurfaceColors { material: style.material, ..colors };
            if style.material.opacity < 1.0 {
                // Both sides of glass have one color.
                colors.negative = colors.positive;
            }
            if turned(index) { colors.turned() } else { colors }
        };
        Appearance {
            surfaces: self.model.styles.iter().enumerate().map(surface).collect(),
            // Light before black is light multiplied by the opacity.
            background: if self.model.is_transparent(settings) { BLACK } else { color },
            haze: self.haze(rays, color),
            ambient: self.model.choices(settings).ambient.map_or(plain.ambient, |one| one as f32),
            undecided: settings.undecided,
            ..plain
        }
    }

    /// Returns whether f < 0 on most of the region's boundary. Then the negative side faces
    /// outward.
    fn is_negative_outside(&self, surface: usize) -> bool {
        /// Number of points along each edge of a face.
        const POINTS: usize = 8;
        /// Least share of negative values, among values with a sign.
        const MOST: f64 = 0.75;
        // A parametric surface has no inside.
        if self.model.styles[surface].is_solid || self.model.program.patch(surface).is_some() {
            return false;
        }
        let kernels = self.model.program.kernels::<T>(surface);
        let (low, high) = (self.model.region.low(), self.model.region.high());
        let points = (0..6 * POINTS * POINTS).map(|n| {
            let (face, u, v) = (n / (POINTS * POINTS), n / POINTS % POINTS, n % POINTS);
            let [u, v] = [u, v].map(|place| (place as f64 + 0.5) / POINTS as f64);
            let mut share = [u, v, (face % 2) as f64];
            share.rotate_right(face / 2);
            let point = low + (high - low) * DVec3::from_array(share);
            let on_sphere = |ball: Ball| ball.centre + ball.radius * ball.normal(point);
            self.model.region.ball().map_or(point, on_sphere).to_array()
        });
        let points: Vec<[f64; 3]> = points.collect();
        let batches = Points::near(&points);
        // Use the kernel that computes the normals, since it is compiled anyway.
        let values = match self.settings.normals {
            Some(Normals::Central) => kernels.values().map(|kernel| {
                let values = kernel.eval_all(&batches);
                values.into_iter().map(|out| out.value).collect::<Vec<_>>()
            }),
            Some(Normals::Gradient) | None => kernels.gradients().map(|kernel| {
                let gradients = kernel.eval_all(&batches);
                gradients.into_iter().map(|out| out.value).collect()
            }),
        };
        let Ok(values) = values else { return false };
        let (mut negative, mut signed) = (0_usize, 0_usize);
        for (values, points) in values.iter().zip(points.chunks(16)) {
            for value in values.0.iter().take(points.len()) {
                let value: f64 = (*value).into();
                negative += usize::from(value < 0.0);
                signed += usize::from(value != 0.0 && !value.is_nan());
            }
        }
        negative as f64 > MOST * signed as f64
    }
}
