//! One picture of a model: surfaces are found one after another, then lit.

use super::paint::{Finish, Painter};
use super::strips::Overview;
use super::{Aim, Model, Stopwatch, Style, options};
use crate::legend::Legend;
use crate::picture::{Normals, Open, Picture, Precision, Settings, Statistics, Times};
use crate::program::ProgramError;
use glam::DVec3;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use zeroset_eval::{KernelFloat, Points};
use zeroset_syntax::{SurfaceColor, SurfaceKind};
use zeroset_trace::{
    Appearance, BAND_ROWS, Ball, Camera, Driver, GBuffer, Light, LinearRgb, Near, NormalSource,
    Pattern, RayGrid, Rows, Shader, SurfaceColours, Tracer, Work, borrow_occlusion, cap, cap_rows,
    normals, unset_colours,
};

/// Told how many pixels were finished since it was last called; `false` ends the work.
pub(super) type Advance<'a> = &'a (dyn Fn(usize) -> bool + Sync);

/// Shadow rays start this many of their own slabs away from the surface, so that it does not shade itself.
const SHADOW_OFFSET_SLABS: f64 = 2.0;

/// Reach of central differences, as a share of the domain's largest extent.
const STEP: f64 = 1e-3;

/// What is within this share of the domain's largest extent may take ambient light away.
const NEAR: f64 = 0.12;

impl Model {
    /// Takes a picture. `advance` is told how many pixels of how many surfaces were finished since it was last called,
    /// and ends the work early by returning `false`, as the end of the settings' budget does: what was not reached then is
    /// undecided, and not painted.
    ///
    /// # Errors
    /// If a kernel is needed that cannot be made. What [`Model::new`] compiled is there already.
    pub fn trace(
        &self,
        camera: &Camera,
        settings: &Settings,
        advance: Advance<'_>,
    ) -> Result<Picture, ProgramError> {
        let end = settings.budget.and_then(|budget| Instant::now().checked_add(budget));
        let advance = |done| advance(done) && end.is_none_or(|end| Instant::now() < end);
        let rays = camera.rays(settings.width, settings.height);
        self.along(&rays, settings, &advance, None)
    }

    /// The picture along these rays: of a strip's, those rows of it are kept that `part` says, and what is near to what is
    /// what its overview knows.
    pub(super) fn along(
        &self,
        rays: &RayGrid,
        settings: &Settings,
        advance: Advance<'_>,
        part: Option<Part<'_>>,
    ) -> Result<Picture, ProgramError> {
        match settings.precision {
            Precision::Auto | Precision::F32 => {
                Shot::<f32>::new(self, settings, advance).of(part).take(rays)
            }
            Precision::F64 => Shot::<f64>::new(self, settings, advance).of(part).take(rays),
        }
    }
}

/// What is known of the whole, and the rows that are kept of a strip.
pub(super) type Part<'a> = (Option<&'a Overview>, Range<usize>);

impl Model {
    /// The same picture with what a preview (`Settings::is_preview`) left open looked at again, as `settings` say, which are
    /// those of the picture but for that. `advance` is as for [`Model::trace`]; nothing is worth keeping of a picture that it
    /// ended.
    ///
    /// # Errors
    /// As [`Model::trace`].
    pub fn settle(
        &self,
        picture: &Picture,
        camera: &Camera,
        settings: &Settings,
        advance: Advance<'_>,
    ) -> Result<Picture, ProgramError> {
        let rays = camera.rays(settings.width, settings.height);
        match settings.precision {
            Precision::Auto | Precision::F32 => {
                Shot::<f32>::new(self, settings, advance).settle(picture, &rays)
            }
            Precision::F64 => Shot::<f64>::new(self, settings, advance).settle(picture, &rays),
        }
    }

    /// The same picture in other light: what was found is not looked for again. `settings` are those of the picture but for
    /// what lights it, and `advance` is as for [`Model::trace`].
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
        let mut lit = picture.clone();
        let (rays, times) =
            (camera.rays(settings.width, settings.height), &mut lit.statistics.times);
        let buffer = &mut lit.buffer;
        buffer.shadow.fill(0);
        buffer.occlusion.fill(0);
        let light = match settings.precision {
            Precision::Auto | Precision::F32 => {
                Shot::<f32>::new(self, settings, advance).light(&rays, buffer, None, times)
            }
            Precision::F64 => {
                Shot::<f64>::new(self, settings, advance).light(&rays, buffer, None, times)
            }
        };
        let light = light?;
        lit.statistics.work += light.work;
        (lit.statistics.edge_rays, lit.rgb) = (light.edge_rays, light.rgb);
        lit.legends = light.legends;
        lit.look = self.look(settings);
        Ok(lit)
    }
}

/// The colours of a picture, and what they took.
struct Lit {
    rgb: Vec<u8>,
    legends: Vec<Legend>,
    edge_rays: usize,
    work: Work,
}

/// Surfaces by number, each with what finds it.
pub(super) type Tracers<'a> = Vec<(usize, Box<dyn Tracer + 'a>)>;

/// What all parts of a picture share; colours come from kernels of `T`.
pub(super) struct Shot<'a, T> {
    pub model: &'a Model,
    pub settings: &'a Settings,
    pub advance: Advance<'a>,
    /// What is known of the whole, if this is a strip.
    overview: Option<&'a Overview>,
    /// The rows that are kept of a strip; `None` if all are.
    pub own: Option<Range<usize>>,
    floats: PhantomData<fn() -> T>,
}

impl<'a, T: KernelFloat> Shot<'a, T> {
    fn new(model: &'a Model, settings: &'a Settings, advance: Advance<'a>) -> Self {
        Self { model, settings, advance, overview: None, own: None, floats: PhantomData }
    }

    /// The same for some rows of a strip; for the whole, if there is no part.
    fn of(self, part: Option<Part<'a>>) -> Self {
        let (overview, own) = part.unzip();
        Self { overview: overview.flatten(), own, ..self }
    }

    /// The method at work on a surface.
    pub fn tracer(&self, surface: usize, aim: Aim) -> Result<Box<dyn Tracer + 'a>, ProgramError> {
        let options = options(self.settings, self.model.styles[surface].kind, aim);
        let (surface, region) = (self.model.program.surface(surface), &self.model.region);
        Ok(self.settings.method.prepare(surface, region, options)?)
    }

    /// Looks for a surface along the rays for which `only` says so, all if that is empty.
    pub fn find(
        &self,
        surface: usize,
        tracer: &dyn Tracer,
        rays: &RayGrid,
        only: &[bool],
        layer: &mut GBuffer,
        advance: Advance<'_>,
    ) -> Result<Work, ProgramError> {
        let mut work = Driver { rays, tracer, advance }.picture_where(only, layer);
        layer.surface.fill(surface as u16);
        if self.model.styles[surface].kind == SurfaceKind::Solid {
            let kernel = self.model.program.kernels::<T>(surface).bounds()?;
            work += cap(layer, rays, &self.model.region, kernel, only);
        }
        Ok(work)
    }

    /// The normals of a surface where it was found.
    pub fn face(
        &self,
        surface: usize,
        rays: &RayGrid,
        layer: &mut GBuffer,
    ) -> Result<Work, ProgramError> {
        let source = self.normals_of(surface)?;
        let face = |source| normals(layer, rays, source, self.extent() * STEP);
        Ok(source.map_or_else(Work::default, face))
    }

    /// What answers for a surface's normals, if they are wanted.
    fn normals_of(&self, surface: usize) -> Result<Option<NormalSource<'a, T>>, ProgramError> {
        let kernels = self.model.program.kernels::<T>(surface);
        Ok(match self.settings.normals {
            None => None,
            Some(Normals::Gradient) => Some(NormalSource::Gradient(kernels.gradients()?)),
            Some(Normals::Central) => Some(NormalSource::Central(kernels.values()?)),
        })
    }

    fn extent(&self) -> f64 {
        2.0 * self.model.region.half_extent()
    }

    /// The picture of these rays, of which only some rows may be kept.
    pub fn take(&self, rays: &RayGrid) -> Result<Picture, ProgramError> {
        let mut times = self.model.times.unwrap_or_default();
        let appearance = self.is_plain().then(|| self.appearance(self.lamp(rays)));
        let shader = appearance.as_ref().map(|appearance| Shader::new(rays, appearance));
        let (buffer, work, rgb) = self.surfaces(rays, &[], shader.as_ref(), &mut times)?;
        self.finished(rays, buffer, work, times, rgb)
    }

    /// The picture with its unsettled pixels looked at again.
    fn settle(&self, picture: &Picture, rays: &RayGrid) -> Result<Picture, ProgramError> {
        let unsettled: Vec<bool> = picture.unsettled().collect();
        let Statistics { mut times, mut work, .. } = picture.statistics;
        let (settled, more, _) = self.surfaces(rays, &unsettled, None, &mut times)?;
        work += more;
        let mut buffer = picture.buffer.clone();
        buffer.replace(&settled, &unsettled);
        settled.hand_back();
        self.finished(rays, buffer, work, times, None)
    }

    /// Whether each row of the picture can be coloured once it is traced, whatever is in the others.
    fn is_plain(&self) -> bool {
        self.settings.normals.is_some()
            && self.model.seen().count() == 1
            && self.shadow_depth().is_none()
            && !self.occludes()
            && !self.is_translucent()
            && !Painter::is_wanted(self.model)
    }

    /// All surfaces along the rays for which `only` says so, all if that is empty; and the picture's colours, if there is a
    /// shader for them. Rows go from nothing to colours while they are in the nearer caches.
    fn surfaces(
        &self,
        rays: &RayGrid,
        only: &[bool],
        shader: Option<&Shader<'_>>,
        times: &mut Times,
    ) -> Result<(GBuffer, Work, Option<Vec<u8>>), ProgramError> {
        let Self { model, settings, advance, .. } = *self;
        let mut watch = Stopwatch::start();
        let (width, height) = (rays.width(), rays.height());
        let mut work = Work::default();
        let mut picture: Option<GBuffer> = None;
        let mut rgb = shader.map(|_| unset_colours(width * height));
        let last = model.seen().last();
        for surface in model.seen() {
            let tracer = self.tracer(surface, Aim::of(settings))?;
            let source = self.normals_of(surface)?;
            let is_solid = model.styles[surface].kind == SurfaceKind::Solid;
            let kernels = model.program.kernels::<T>(surface);
            let solid = if is_solid { Some(kernels.bounds()?) } else { None };
            let shading = AtomicU64::new(0);
            let finish = |rows: &mut Rows<'_>, bytes: &mut [u8]| {
                let mut work = Work::default();
                if let Some(kernel) = solid {
                    work += cap_rows(rows, rays, &model.region, kernel, only);
                }
                let mut watch = Stopwatch::start();
                if let Some(source) = &source {
                    work += source.face(rows, rays, self.extent() * STEP);
                }
                if let Some(shader) = shader {
                    shader.rows(rows, bytes);
                }
                shading.fetch_add(watch.lap().as_nanos() as u64, Ordering::Relaxed);
                work
            };
            let bytes = rgb.as_deref_mut().unwrap_or_default();
            let mut parts: Vec<&mut [u8]> =
                bytes.chunks_mut((3 * BAND_ROWS * width).max(1)).collect();
            parts.resize_with(height.div_ceil(BAND_ROWS), Default::default);
            let driver = Driver { rays, tracer: &*tracer, advance };
            let (layer, found) =
                driver.new_picture(surface as u16, settings.brackets, only, parts, finish);
            work += found;
            // As if all threads had been busy all the time.
            let shading = shading.into_inner() / rayon::current_num_threads() as u64;
            let (lap, shading) = (watch.lap(), Duration::from_nanos(shading));
            times.trace += lap.saturating_sub(shading);
            times.shade += lap.min(shading);
            // One layer at a time, so that many surfaces take no more memory than one.
            match &mut picture {
                None => picture = Some(layer),
                Some(picture) => {
                    picture.merge(&layer);
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
        Ok((picture.unwrap_or_else(|| GBuffer::new(width, height, 0)), work, rgb))
    }

    /// What was found of these rays, lit and accounted for.
    fn finished(
        &self,
        rays: &RayGrid,
        mut buffer: GBuffer,
        mut work: Work,
        mut times: Times,
        rgb: Option<Vec<u8>>,
    ) -> Result<Picture, ProgramError> {
        let Self { model, settings, .. } = *self;
        let mut lit = self.light(rays, &mut buffer, rgb, &mut times)?;
        if let Some(own) = &self.own {
            buffer.crop(own.clone());
            lit.rgb.truncate(3 * rays.width() * own.end);
            lit.rgb.drain(..(3 * rays.width() * own.start).min(lit.rgb.len()));
        }
        work += lit.work;
        let made = model.program.made();
        let pixels = buffer.counts();
        let statistics = Statistics {
            times,
            pixels,
            open: if pixels.undecided > 0 {
                Open::of(&buffer, settings.method.proves)
            } else {
                Open::default()
            },
            work,
            edge_rays: lit.edge_rays,
            code_bytes: made.iter().map(|made| made.bytes).sum(),
            kernels: made,
            nodes: model.program.nodes(),
        };
        let undefined = model.seen().any(|surface| model.program.is_undefined(surface));
        let (method, precision) = (settings.method, settings.precision);
        let (hit, undecided) = (statistics.pixels.hit, statistics.pixels.undecided);
        // Where it is 0 everywhere no ray through the region is decided.
        let flat = hit == 0 && undecided > 0 && model.is_flat::<T>()?;
        let (remarks, rgb, look) = (model.remarks.clone(), lit.rgb, model.look(settings));
        let legends = lit.legends;
        Ok(Picture {
            buffer,
            rgb,
            method,
            precision,
            look,
            legends,
            statistics,
            undefined,
            remarks,
            flat,
        })
    }

    /// Where the light comes from that casts shadows.
    fn lamp(&self, rays: &RayGrid) -> Light {
        match self.settings.light.or(self.model.setting.light) {
            Some(place) => Light::Positional(place),
            None => Light::above_left(rays),
        }
    }

    /// Colours of what was found, unless they are `known`.
    fn light(
        &self,
        rays: &RayGrid,
        buffer: &mut GBuffer,
        known: Option<Vec<u8>>,
        times: &mut Times,
    ) -> Result<Lit, ProgramError> {
        let settings = self.settings;
        let mut watch = Stopwatch::start();
        let light = self.lamp(rays);
        let work = self.hide(rays, &light, buffer)?;
        times.occlude += watch.lap();
        let (mut rgb, mut legends, mut edge_rays) = (Vec::new(), Vec::new(), 0);
        if settings.normals.is_some() {
            let painter = match self.overview {
                Some(whole) => Painter::new(self.model, &whole.picture.buffer, &whole.rays),
                None => Painter::new(self.model, buffer, rays),
            };
            let finish = Finish { appearance: self.appearance(light), painter };
            legends = finish.painter.as_ref().map(Painter::legends).unwrap_or_default();
            let mut layers = Vec::new();
            if self.is_translucent() {
                layers = self.layers(rays, &[], &self.tracers(Aim::of(settings))?)?;
                times.trace += watch.lap();
            }
            rgb = known.unwrap_or_else(|| self.coloured(rays, buffer, &layers, &finish, 1));
            times.shade += watch.lap();
            if settings.antialias != Pattern::ONE && (self.advance)(0) {
                edge_rays = self.smooth_edges(rays, buffer, &layers, &finish, &mut rgb)?;
                times.antialias += watch.lap();
            }
        }
        Ok(Lit { rgb, legends, edge_rays, work })
    }

    /// The method at work on each surface that is seen, with its number.
    pub fn tracers(&self, aim: Aim) -> Result<Tracers<'a>, ProgramError> {
        let one = |surface| Ok((surface, self.tracer(surface, aim)?));
        self.model.seen().map(one).collect()
    }

    /// How often the way of a shadow ray is halved; `None` if there are no shadows.
    fn shadow_depth(&self) -> Option<u32> {
        let settings = self.settings;
        let typed = self.model.setting.shadows.then(|| settings.usual_shadow_depth());
        settings.shadow_depth.or(typed)
    }

    /// Whether what is near takes ambient light away.
    fn occludes(&self) -> bool {
        let settings = self.settings;
        settings.occlusion && self.model.look(settings).occlusion && settings.normals.is_some()
    }

    /// Finds what hides painted points from light: surfaces in the way, if shadows are wanted, and what is near.
    fn hide(
        &self,
        rays: &RayGrid,
        light: &Light,
        buffer: &mut GBuffer,
    ) -> Result<Work, ProgramError> {
        let Self { model, advance, .. } = *self;
        let occludes = self.occludes();
        let mut work = Work::default();
        let shadow_depth = self.shadow_depth();
        if let Some(depth) = shadow_depth {
            work += self.shadows(rays, light, depth, buffer)?;
        }
        if !occludes && shadow_depth.is_none() || !advance(0) {
            return Ok(work);
        }
        let near = || Near::new(buffer, rays, model.region.centre());
        let overview = self.overview.filter(|_| occludes);
        let near = (shadow_depth.is_some() || overview.is_none()).then(near);
        if let Some(near) = near.as_ref().filter(|_| shadow_depth.is_some()) {
            // Twice, since beside an edge a square is not whole.
            (0..2).for_each(|_| near.mean(&mut buffer.shadow));
        }
        if let Some(whole) = overview {
            borrow_occlusion(buffer, rays, &whole.picture.buffer, &whole.rays);
        } else if let Some(near) = near.filter(|_| occludes) {
            near.occlusion(buffer, NEAR * self.extent());
            near.mean(&mut buffer.occlusion);
        }
        Ok(work)
    }

    fn shadows(
        &self,
        rays: &RayGrid,
        light: &Light,
        depth: u32,
        buffer: &mut GBuffer,
    ) -> Result<Work, ProgramError> {
        // A slab of the last depth may lie on either side of the surface that it holds.
        let offset = self.extent() * SHADOW_OFFSET_SLABS * 0.5_f64.powi(depth as i32);
        let lights = light.widened(self.model.region.centre());
        let mut work = Work::default();
        let mut hidden = vec![0; buffer.drawn.len()];
        // Shadows are no pixels finished.
        let wanted = |_| (self.advance)(0);
        for surface in self.model.seen() {
            let tracer = self.tracer(surface, Aim { depth, ..Aim::of(self.settings) })?;
            let driver = Driver { rays, tracer: &*tracer, advance: &wanted };
            work += driver.shadows(buffer, &lights, offset);
            hidden.iter_mut().zip(&buffer.shadow).for_each(|(all, this)| *all |= this);
            if !(self.advance)(0) {
                break;
            }
        }
        buffer.shadow = hidden;
        Ok(work)
    }

    fn appearance(&self, light: Light) -> Appearance {
        let settings = self.settings;
        let plain = Appearance::new(self.model.look(settings), light);
        let typed = self.model.setting.background.map(|color| LinearRgb::from_srgb(color.rgb));
        // A hidden surface is not asked: there may be no code for it.
        let turned = |surface: usize| {
            let known = &self.model.turned[surface];
            !self.model.styles[surface].hidden
                && *known.get_or_init(|| self.is_negative_outside(surface))
        };
        let surface = |(index, style): (usize, &Style)| {
            let colours = match &style.color {
                Some(SurfaceColor::Plain(color)) => {
                    SurfaceColours::around(LinearRgb::from_srgb(color.rgb))
                }
                Some(SurfaceColor::Mapped(_)) | None => SurfaceColours::default_for(index),
            };
            if turned(index) { colours.turned() } else { colours }
        };
        Appearance {
            surfaces: self.model.styles.iter().enumerate().map(surface).collect(),
            background: settings.background.or(typed).unwrap_or(plain.background),
            ambient: settings.ambient.unwrap_or(plain.ambient),
            undecided: settings.undecided,
            ..plain
        }
    }

    /// Whether f < 0 on most of the region's boundary, so that the side seen from far away is the negative one.
    fn is_negative_outside(&self, surface: usize) -> bool {
        /// Points along each edge of a face.
        const POINTS: usize = 8;
        /// Of those that have a sign.
        const MOST: f64 = 0.75;
        if self.model.styles[surface].kind == SurfaceKind::Solid {
            return false;
        }
        let Ok(kernel) = self.model.program.kernels::<T>(surface).gradients() else { return false };
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
        let (mut negative, mut signed) = (0_usize, 0_usize);
        for (out, points) in kernel.ask_all(&Points::near(&points)).iter().zip(points.chunks(16)) {
            for value in out.value.0.iter().take(points.len()) {
                let value: f64 = (*value).into();
                negative += usize::from(value < 0.0);
                signed += usize::from(value != 0.0 && !value.is_nan());
            }
        }
        negative as f64 > MOST * signed as f64
    }
}
