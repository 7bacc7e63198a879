//! One picture of a model: finds the surfaces one after another, then lights them.

mod light;

use super::layers::BlockLimits;
use super::paint::Painter;
use super::strips::Overview;
use super::{Model, Stopwatch, options};
use crate::picture::{
    Normals, Picture, Precision, Settings, Statistics, Times, UndecidedStatistics,
};
use crate::pixels::Pixels;
use crate::progress::Done;
use std::borrow::Cow;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use zeroset_eval::{Enclose, Kernel, KernelFloat};
use zeroset_scene::coordinate::coordinate;
use zeroset_scene::program::ProgramError;
use zeroset_shade::{Colors, ColorsMut, NormalSource, Pattern, Shader, normals};
use zeroset_space::Camera;
use zeroset_trace::{
    BAND_ROWS, Driver, Fallback, GBuffer, Kept, KernelStats, Method, PATCH, PixelCounts, RayGrid,
    Rows, TraceOptions, Tracer, Window, cap, cap_rows, may_cut, patch_tracer,
};

/// Callback with the work done since the last call. The work ends if it returns `false`.
pub(super) type Advance<'a> = &'a (dyn Fn(Done) -> bool + Sync);

/// Step of central differences, as a share of the region's largest extent.
const STEP: f64 = 1e-3;

/// Beyond this many half extents of the region from the origin, `f32` is too coarse for normals.
const FAR: f64 = 1024.0;

/// Runs a pass whose kernels for colors compute in the precision of the settings.
macro_rules! in_precision {
    ($model:expr, $settings:expr, $advance:expr, |$pass:ident| $run:expr) => {
        match $settings.options.precision {
            Precision::Auto | Precision::F32 => {
                let $pass = RenderPass::<f32>::new($model, $settings, $advance);
                $run
            }
            Precision::F64 => {
                let $pass = RenderPass::<f64>::new($model, $settings, $advance);
                $run
            }
        }
    };
}

impl Model {
    /// Draws a picture. `advance` gets the work done since the last call. The work ends early if
    /// `advance` returns `false` or the settings' budget is used up. Pixels not reached by then are
    /// undecided and unpainted.
    ///
    /// # Errors
    /// If a kernel that [`Model::new`] has not compiled fails to compile.
    pub fn trace(
        &self,
        camera: &Camera,
        settings: &Settings,
        advance: Advance<'_>,
    ) -> Result<Picture, ProgramError> {
        let wanted = settings.limit.wanted();
        let advance = |done| advance(done) && wanted();
        let rays = RayGrid::new(camera, settings.width, settings.height);
        self.along(&rays, settings, &advance, None, None)
    }

    /// Draws the picture along these rays. For a strip, only the rows `own` are kept, and
    /// `overview` supplies ambient occlusion and color scales.
    pub(super) fn along(
        &self,
        rays: &RayGrid,
        settings: &Settings,
        advance: Advance<'_>,
        overview: Option<&Overview>,
        own: Option<Range<usize>>,
    ) -> Result<Picture, ProgramError> {
        in_precision!(self, settings, advance, |pass| RenderPass { overview, own, ..pass }
            .draw(rays))
    }

    /// Traces again the pixels that a preview (`Settings::is_preview`) left undecided. `settings`
    /// must be those of the preview, except for `is_preview`. A preview without normals is drawn
    /// again, and the statistics then cover only the new picture. `advance` is as for
    /// [`Model::trace`], but only pixels that are traced again count. Returns `None` if `advance`
    /// returned `false`.
    ///
    /// # Errors
    /// As [`Model::trace`].
    pub fn settle(
        &self,
        picture: &Picture,
        camera: &Camera,
        settings: &Settings,
        advance: Advance<'_>,
    ) -> Result<Option<Picture>, ProgramError> {
        let rays = RayGrid::new(camera, settings.width, settings.height);
        in_precision!(self, settings, advance, |pass| pass.settle(picture, &rays))
    }

    /// Draws the picture in other light. It is traced again only if its normals were not kept.
    /// `settings` must be those of the picture, except for the light. `advance` is as for
    /// [`Model::trace`].
    ///
    /// # Errors
    /// As [`Model::trace`].
    pub fn relight(
        &self,
        picture: &Picture,
        camera: &Camera,
        settings: &Settings,
        advance: Advance<'_>,
    ) -> Result<Picture, ProgramError> {
        if picture.buffer.normal.is_empty() {
            return self.trace(camera, settings, advance);
        }
        let rays = RayGrid::new(camera, settings.width, settings.height);
        in_precision!(self, settings, advance, |pass| pass.relight(picture, &rays))
    }
}

/// A surface that is ready to be traced.
pub(super) struct PreparedSurface<'a> {
    /// The surface's number.
    pub surface: usize,
    pub tracer: Box<dyn Tracer + 'a>,
    /// The pixels that may show the surface.
    pub window: Window,
}

/// Result of tracing surfaces along some rays.
struct Traced {
    buffer: GBuffer,
    /// Number of pixels by status, if they were counted during tracing.
    counts: Option<PixelCounts>,
    work: KernelStats,
    /// Colors, if they were computed during tracing.
    colors: Option<Colors>,
    /// Surfaces that were traced by a fallback method.
    fallbacks: Vec<(usize, Fallback)>,
}

/// State shared by all steps of drawing a picture. Kernels for colors compute in `T`.
pub(super) struct RenderPass<'a, T> {
    pub model: &'a Model,
    pub settings: &'a Settings,
    pub advance: Advance<'a>,
    /// A picture of the whole scene, if this pass draws a strip.
    pub overview: Option<&'a Overview>,
    /// The rows of a strip that are kept. `None` for all.
    pub own: Option<Range<usize>>,
    /// Limits of the memory for translucent surfaces.
    pub block: BlockLimits,
    /// Whether each surface is looked for in the whole picture, even if there are several.
    pub whole: bool,
    floats: PhantomData<fn() -> T>,
}

impl<'a, T: KernelFloat> RenderPass<'a, T> {
    pub fn new(model: &'a Model, settings: &'a Settings, advance: Advance<'a>) -> Self {
        let block = BlockLimits::default();
        let (overview, own, whole) = (None, None, false);
        Self { model, settings, advance, overview, own, block, whole, floats: PhantomData }
    }

    /// Returns whether more work is wanted.
    pub fn is_wanted(&self) -> bool {
        (self.advance)(Done::NOTHING)
    }

    /// Prepares the method for a surface, with options changed by `change`.
    pub fn tracer(
        &self,
        surface: usize,
        change: impl Fn(TraceOptions) -> TraceOptions,
    ) -> Result<Box<dyn Tracer + 'a>, ProgramError> {
        let options = change(options(self.settings, self.model.styles[surface].is_solid));
        if let Some(patch) = self.model.program.patch(surface) {
            return Ok(patch_tracer(patch.tree()?, &self.model.region, options));
        }
        let (surface, region) = (self.model.program.surface(surface), &self.model.region);
        Ok(self.settings.method.prepare(surface, region, options)?)
    }

    /// The method of a parametric surface, if another than the default method was asked for.
    fn own_method(&self, surface: usize) -> Option<Fallback> {
        let is_asked = self.settings.method != <&Method>::default();
        let is_own = is_asked && self.model.program.patch(surface).is_some();
        is_own.then(|| Fallback { method: &PATCH, why: "it is given by parameters".to_owned() })
    }

    /// Adds the arrays to a layer that the surface needs.
    pub fn make_room(&self, surface: usize, layer: &mut GBuffer) {
        if self.model.program.patch(surface).is_some() {
            layer.keep_parameters();
        }
    }

    /// Traces a surface along the rays selected by `only`, or along all if that is empty.
    pub fn find(
        &self,
        surface: usize,
        tracer: &dyn Tracer,
        rays: &RayGrid,
        only: &[bool],
        layer: &mut GBuffer,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<KernelStats, ProgramError> {
        let mut work = Driver { rays, tracer, advance }.picture_where(only, layer);
        layer.surface.fill(surface as u16);
        if let Some(kernel) = self.caps(surface)? {
            work += cap(layer, rays, &self.model.region, kernel, only);
        }
        Ok(work)
    }

    /// The kernel that finds caps. `None` if the surface is no solid, or the region does not cut
    /// it.
    pub fn caps(&self, surface: usize) -> Result<Option<&'a dyn Kernel<Enclose, T>>, ProgramError> {
        let model = self.model;
        if !model.styles[surface].is_solid {
            return Ok(None);
        }
        let kernel = model.program.kernels::<T>(surface).bounds()?;
        let known = &model.cut[surface][T::FORMAT as usize];
        let is_cut = *known.get_or_init(|| may_cut(&model.region, kernel));
        Ok(is_cut.then_some(kernel))
    }

    /// Computes the normals of a surface at its painted points.
    pub fn compute_normals(
        &self,
        surface: usize,
        rays: &RayGrid,
        layer: &mut GBuffer,
    ) -> Result<KernelStats, ProgramError> {
        let source = self.normals_of(surface)?;
        let compute_normals = |source| normals(layer, rays, source, self.extent() * STEP);
        Ok(source.map_or_else(KernelStats::default, compute_normals))
    }

    /// Kernels that compute a surface's normals, if normals are wanted.
    fn normals_of(&self, surface: usize) -> Result<Option<NormalSource<'a, T>>, ProgramError> {
        let kernels = self.model.program.kernels::<T>(surface);
        Ok(match self.settings.normals {
            None => None,
            Some(_) if let Some(patch) = self.model.program.patch(surface) => {
                Some(NormalSource::Parametric(patch.normals()?))
            }
            Some(Normals::Gradient) if self.settings.options.precision == Precision::Auto => {
                let (region, kernel) = (&self.model.region, kernels.gradients()?);
                let farthest = region.low().abs().max(region.high().abs()).max_element();
                let everywhere = farthest > FAR * region.half_extent();
                let double = self.model.program.surface(surface).double();
                Some(NormalSource::Refined { kernel, double, everywhere })
            }
            Some(Normals::Gradient) => Some(NormalSource::Gradient(kernels.gradients()?)),
            Some(Normals::Central) => Some(NormalSource::Central(kernels.values()?)),
        })
    }

    fn extent(&self) -> f64 {
        2.0 * self.model.region.half_extent()
    }

    /// Draws the picture of these rays. Only the rows `own` are kept.
    pub fn draw(&self, rays: &RayGrid) -> Result<Picture, ProgramError> {
        let mut times = self.model.times.unwrap_or_default();
        let appearance = self.is_plain(rays).then(|| self.appearance(rays, &|| true));
        let shader = appearance.as_ref().map(|appearance| Shader::new(rays, appearance));
        let found = self.surfaces(rays, &[], shader.as_ref(), &mut times)?;
        self.finished(rays, found, times)
    }

    /// Traces again the pixels that a preview left undecided. `None` if the work was ended early.
    fn settle(&self, picture: &Picture, rays: &RayGrid) -> Result<Option<Picture>, ProgramError> {
        if picture.buffer.normal.is_empty() {
            let anew = self.draw(rays)?;
            return Ok(self.is_wanted().then_some(anew));
        }
        let open_mask: Vec<bool> = picture.open_mask().collect();
        let Statistics { mut times, mut work, .. } = picture.statistics;
        let settled = self.surfaces(rays, &open_mask, None, &mut times)?;
        if !self.is_wanted() {
            settled.buffer.hand_back();
            return Ok(None);
        }
        work += settled.work;
        let mut buffer = picture.buffer.clone();
        buffer.replace(&settled.buffer, &open_mask);
        settled.buffer.hand_back();
        let found =
            Traced { buffer, counts: None, work, colors: None, fallbacks: settled.fallbacks };
        self.finished(rays, found, times).map(Some)
    }

    fn relight(&self, picture: &Picture, rays: &RayGrid) -> Result<Picture, ProgramError> {
        let mut lit = picture.clone();
        lit.buffer.shadow.clear();
        lit.buffer.occlusion.clear();
        let light = self.light(rays, &mut lit.buffer, None, &mut lit.statistics.times)?;
        lit.statistics.work += light.work;
        lit.statistics.edge_rays = light.edge_rays;
        lit.light = light.pixels.light();
        Pixels { rgb: lit.rgb, alpha: lit.alpha } = light.pixels.into_bytes();
        (lit.legends, lit.remarks) = (light.legends, light.remarks);
        (lit.ground, lit.background) = (light.ground, light.background);
        lit.look = self.model.look(self.settings);
        Ok(lit)
    }

    /// Returns whether each band can be colored as soon as it is traced.
    fn is_plain(&self, rays: &RayGrid) -> bool {
        self.settings.normals.is_some()
            && !rays.is_stretched()
            && self.model.visible_surfaces().count() == 1
            && self.shadow_depth().is_none()
            && !self.occludes()
            && !self.is_translucent()
            && !Painter::is_wanted(self.model)
    }

    /// Traces all surfaces along the rays selected by `only`, or along all rays if that is empty.
    /// With a shader, which needs normals, it also colors the picture. Each band is finished while
    /// it is in the cache.
    fn surfaces(
        &self,
        rays: &RayGrid,
        only: &[bool],
        shader: Option<&Shader<'_>>,
        times: &mut Times,
    ) -> Result<Traced, ProgramError> {
        let Self { model, settings, .. } = *self;
        let advance = |pixels| (self.advance)(Done::Pixels(pixels));
        let mut watch = Stopwatch::start();
        let (width, height) = (rays.width(), rays.height());
        let (mut work, mut fallbacks) = (KernelStats::default(), Vec::new());
        let mut picture: Option<GBuffer> = None;
        let counted = Mutex::new(PixelCounts::default());
        let mut colors = shader.map(|_| Colors::unset(settings.depth, width * height));
        let windows = self.windows(rays)?;
        let (last, is_one) = (model.visible_surfaces().last(), windows.len() == 1);
        for (surface, window) in model.visible_surfaces().zip(windows) {
            let tracer = self.tracer(surface, |options| options)?;
            let fallback = tracer.fallback(rays).or_else(|| self.own_method(surface));
            fallbacks.extend(fallback.map(|fallback| (surface, fallback)));
            let source = self.normals_of(surface)?;
            let caps = self.caps(surface)?;
            let Window { columns, rows, .. } = &window.with_whole_tiles(rays);
            let is_whole = columns.len() * rows.len() == width * height;
            let part = (!is_whole).then(|| rays.part(columns.clone(), rows.clone()));
            let own = part.as_ref().unwrap_or(rays);
            let asked = only;
            let only = &*part_of(asked, width, columns, rows);
            // The window holds the surface, so the rays of all other pixels are proven to miss it.
            let count = |only: &[bool]| only.iter().filter(|asked| **asked).count();
            advance(if asked.is_empty() {
                width * height - columns.len() * rows.len()
            } else {
                count(asked) - count(only)
            });
            let shading = AtomicU64::new(0);
            let finish = |rows: &mut Rows<'_>, colors: ColorsMut<'_>| {
                let mut work = KernelStats::default();
                if let Some(kernel) = caps {
                    work += cap_rows(rows, own, &model.region, kernel, only);
                }
                let mut watch = Stopwatch::start();
                if let Some(source) = &source {
                    let canvas = shader.map(|shader| shader.canvas(colors));
                    work += source.compute_normals(rows, own, self.extent() * STEP, canvas);
                }
                shading.fetch_add(watch.lap().as_nanos() as u64, Ordering::Relaxed);
                // Count before taking the lock, so that other threads wait less.
                let counts = rows.counts();
                *counted.lock().unwrap_or_else(PoisonError::into_inner) += counts;
                work
            };
            let all = colors.as_mut().map(Colors::as_mut).unwrap_or_default();
            let mut parts = all.split((BAND_ROWS * width).max(1));
            parts.resize_with(height.div_ceil(BAND_ROWS), Default::default);
            let driver = Driver { rays: own, tracer: &*tracer, advance: &advance };
            // Normals are kept for shading after tracing, for caps, and to find edges.
            let needs_normals = shader.is_none()
                || caps.is_some()
                || settings.antialias != Pattern::ONE
                || self.has_outlines();
            let kept = Kept {
                normals: settings.keeps_normals || needs_normals,
                // Layers of several surfaces are merged by their brackets.
                brackets: settings.brackets || !is_one,
                caps: caps.is_some(),
                parameters: model.program.patch(surface).is_some(),
            };
            if !is_whole && picture.is_none() {
                let blank = GBuffer::of_nothing(width, height);
                picture = Some(if kept.brackets { blank.with_brackets() } else { blank });
            }
            let seen = match &picture {
                Some(picture) if !is_whole => picture.seen_in(columns, rows),
                _ => (Vec::new(), Vec::new()),
            };
            let before = match &picture {
                Some(picture) if is_whole => (&*picture.status, &*picture.drawn),
                _ => (&*seen.0, &*seen.1),
            };
            let (layer, found) =
                driver.new_picture(surface as u16, kept, only, before, parts, finish);
            work += found;
            // The time of shading is summed over all threads, so divide it by their number.
            let shading = shading.into_inner() / rayon::current_num_threads() as u64;
            let (lap, shading) = (watch.lap(), Duration::from_nanos(shading));
            times.trace += lap.saturating_sub(shading);
            times.shade += lap.min(shading);
            // Merge each layer at once, so that memory does not grow with the number of surfaces.
            match &mut picture {
                None => picture = Some(layer),
                Some(picture) => {
                    picture.merge_at(&layer, [columns.start, rows.start]);
                    layer.hand_back();
                }
            }
            times.shade += watch.lap();
            if !advance(0) {
                if let Some(picture) = picture.as_mut().filter(|_| Some(surface) != last) {
                    picture.give_up();
                }
                break;
            }
        }
        let mut buffer = picture.unwrap_or_else(|| GBuffer::of_nothing(width, height));
        if !settings.brackets {
            buffer.bracket.clear();
        }
        // With several surfaces or cropped rows, these counts would be wrong.
        let is_counted = self.own.is_none() && is_one;
        let counts =
            is_counted.then(|| counted.into_inner().unwrap_or_else(PoisonError::into_inner));
        Ok(Traced { buffer, counts, work, colors, fallbacks })
    }

    /// Lights the traced rays and fills in the statistics.
    fn finished(
        &self,
        rays: &RayGrid,
        found: Traced,
        mut times: Times,
    ) -> Result<Picture, ProgramError> {
        let Self { model, settings, .. } = *self;
        let Traced { mut buffer, counts, mut work, colors, fallbacks } = found;
        let mut lit = self.light(rays, &mut buffer, colors, &mut times)?;
        if let Some(own) = &self.own {
            buffer.crop(own.clone());
            lit.pixels.crop(own.start * rays.width()..own.end * rays.width());
        }
        work += lit.work;
        let made = model.program.made();
        let pixels = counts.unwrap_or_else(|| buffer.counts());
        let drawn_by =
            fallbacks.first().filter(|_| fallbacks.len() == model.visible_surfaces().count());
        let method = drawn_by.map_or(settings.method, |(_, fallback)| fallback.method);
        let statistics = Statistics {
            times,
            pixels,
            open: if pixels.undecided > 0 {
                UndecidedStatistics::of(&buffer, method.proves)
            } else {
                UndecidedStatistics::default()
            },
            work,
            edge_rays: lit.edge_rays,
            code_bytes: made.iter().map(|made| made.bytes).sum(),
            kernels: made,
            nodes: model.program.nodes(),
        };
        let has_eye = rays.ray(0, 0).origin == rays.eye();
        if has_eye && 2 * pixels.undecided > buffer.status.len() && model.meets_eye(rays.eye()) {
            let place = rays.eye().to_array().map(coordinate).join(", ");
            lit.remarks.push(format!("the eye ({place}) is on a surface: move it off the surface"));
        }
        // If a function is 0 everywhere, every ray through the region is undecided.
        let flat = pixels.hit == 0 && pixels.undecided > 0 && model.is_flat::<T>()?;
        let light = lit.pixels.light();
        let Pixels { rgb, alpha } = lit.pixels.into_bytes();
        Ok(Picture {
            buffer,
            rgb,
            alpha,
            light,
            method,
            fallbacks,
            precision: settings.options.precision,
            look: model.look(settings),
            ground: lit.ground,
            background: lit.background,
            legends: lit.legends,
            statistics,
            undefined: model.visible_functions().any(|surface| model.program.is_undefined(surface)),
            remarks: lit.remarks,
            flat,
        })
    }

    /// Prepares the method for each visible surface, for pictures along `rays`.
    pub fn tracers(
        &self,
        rays: &RayGrid,
        change: impl Fn(TraceOptions) -> TraceOptions,
    ) -> Result<Vec<PreparedSurface<'a>>, ProgramError> {
        let windows = self.windows(rays)?;
        let one = |(surface, window)| {
            Ok(PreparedSurface { surface, tracer: self.tracer(surface, &change)?, window })
        };
        self.model.visible_surfaces().zip(windows).map(one).collect()
    }
}

/// The elements of a part of a picture. `all` has one for each of its pixels, or is empty.
fn part_of<'a>(
    all: &'a [bool],
    width: usize,
    columns: &Range<usize>,
    rows: &Range<usize>,
) -> Cow<'a, [bool]> {
    if columns.len() * rows.len() == all.len() || all.is_empty() {
        return Cow::Borrowed(all);
    }
    let row = |row: usize| &all[row * width + columns.start..row * width + columns.end];
    Cow::Owned(rows.clone().flat_map(row).copied().collect())
}
