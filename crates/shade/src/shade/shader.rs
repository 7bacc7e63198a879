//! Shading of sixteen pixels of a window at a time, from their G-buffer to colors.

use super::lanes::{
    by_axis, by_lane, dot, highlight_power, left, panel, smooth_step, splat, tone_map,
};
use super::{Appearance, Haze, Paint, SurfaceColors, UndecidedStyle};
use crate::color::{BLACK, LinearRgb, SrgbTable};
use crate::colors::ColorsMut;
use fearless_simd::{Level, f32x16, mask32x16, prelude::*, u8x16};
use glam::Vec3;
use zeroset_eval::dispatch;
use zeroset_eval::{LANES, Lanes};
use zeroset_style::Material;
use zeroset_trace::painted::{FULL, PixelWindow, bits};
use zeroset_trace::{Columns, RayGrid, Status};

/// Distance between the stripes of a hatch, and their width, in pixels along a row.
const HATCH_PERIOD: usize = 6;
const HATCH_WIDTH: usize = 2;

/// Share of its light that a point loses under a line.
const INK: f32 = 0.8;

/// Share of the key light that reaches points in its shadow.
const SCATTERED: f32 = 0.1;

/// Light that surfaces reflect from the walls.
const WALLS: f32 = 0.28;

/// Light that surfaces reflect from a white background.
const BACKDROP: f32 = 0.42;
/// Light of the floor in front of the background, as a share of the background's light.
const FLOOR: f32 = 0.4;

/// Color of undecided pixels under [`UndecidedStyle::Tint`]. No default pair has its hue.
const TINT: LinearRgb = LinearRgb([0.6, 0.0, 0.6]);

/// The lights and colors of a picture.
pub struct Shader<'a> {
    rays: &'a RayGrid,
    appearance: &'a Appearance,
    palette: Vec<PaletteColors>,
    lamps: CameraLights,
    /// Light of the background behind the surfaces, which they reflect at grazing angles.
    backdrop: f32,
    codes: &'static SrgbTable,
    level: Level,
}

impl<'a> Shader<'a> {
    /// A shader for a picture with these rays.
    pub fn new(rays: &'a RayGrid, appearance: &'a Appearance) -> Self {
        Self {
            rays,
            appearance,
            palette: appearance.palette().into_iter().map(PaletteColors::new).collect(),
            lamps: CameraLights::new(rays),
            backdrop: BACKDROP * appearance.background.0.iter().sum::<f32>() / 3.0,
            codes: SrgbTable::get(),
            level: Level::new(),
        }
    }

    /// The same shader with vectors of this level.
    pub(super) fn with(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// A canvas for the colors of some rows. It is filled with background first.
    pub fn canvas<'b>(&'b self, mut colors: ColorsMut<'b>) -> ColoredRows<'b> {
        colors.fill(self.appearance.background);
        ColoredRows { shader: self, colors, left: Vec::new() }
    }
}

/// The colors of a surface, and whether its material is the default one.
struct PaletteColors {
    colors: SurfaceColors,
    is_plain: bool,
}

impl PaletteColors {
    fn new(colors: SurfaceColors) -> Self {
        Self { colors, is_plain: colors.material == <&Material>::default() }
    }
}

/// The colors of some rows, while they are computed.
pub struct ColoredRows<'a> {
    shader: &'a Shader<'a>,
    colors: ColorsMut<'a>,
    /// Windows that wait for normals.
    pub(crate) left: Vec<PixelWindow>,
}

impl ColoredRows<'_> {
    /// Paints a window whose normals are known.
    #[inline(always)]
    pub(crate) fn paint<S: Simd>(
        &mut self,
        simd: S,
        seen: &ShadingInput<'_>,
        window: PixelWindow,
        faced: ViewAndNormals<S>,
    ) {
        self.shader.paint(simd, seen, window, Some(faced), &mut self.colors);
    }

    /// Paints the windows that waited for normals.
    pub(crate) fn finish(mut self, seen: &ShadingInput<'_>, normals: &[[f32; 3]]) {
        let left = std::mem::take(&mut self.left);
        self.windows(
            &ShadingInput { columns: Columns { normal: normals, ..seen.columns }, ..*seen },
            &left,
        );
    }

    /// As [`ColoredRows::finish`], with the normals of each of the windows, lane by lane.
    pub(crate) fn finish_waiting(self, seen: &ShadingInput<'_>, normals: &[[[f32; 3]; LANES]]) {
        let Self { shader, mut colors, left } = self;
        dispatch!(shader.level, simd => {
            for (&window, normals) in left.iter().zip(normals) {
                let to_eye = shader.rays.ways(simd, window).to_eye;
                let faced = (to_eye, by_axis(simd, normals));
                shader.paint(simd, seen, window, Some(faced), &mut colors);
            }
        });
    }

    /// Paints windows whose normals are in the G-buffer `seen`.
    pub(super) fn windows(&mut self, seen: &ShadingInput<'_>, windows: &[PixelWindow]) {
        let Self { shader, colors, .. } = self;
        dispatch!(shader.level, simd => {
            for &window in windows {
                shader.paint(simd, seen, window, None, colors);
            }
        });
    }
}

/// The G-buffer of some rows, and the paint of their points.
#[derive(Clone, Copy)]
pub(crate) struct ShadingInput<'a> {
    pub columns: Columns<'a>,
    /// Empty if all points have their surface's color.
    pub paint: &'a [Paint],
}

/// Unit vectors of a window's pixels: directions to the eye, then normals.
pub(crate) type ViewAndNormals<S> = ([f32x16<S>; 3], [f32x16<S>; 3]);

/// Quantities of a window's pixels that have their default values in most windows.
struct RareQuantities {
    /// Share of the light that is hidden; 255 means that all is hidden.
    shadow: Lanes<u8>,
    occlusion: Lanes<u8>,
    /// Lanes on a face that cuts a solid open, as bits.
    cuts: u32,
    /// [`Paint::base`], by primary.
    base: [Lanes<f32>; 3],
    ink: Lanes<f32>,
    /// The share of the haze's color.
    haze: Lanes<f32>,
    /// The factor of the light of undecided pixels, and the share of the tint.
    marks: [Lanes<f32>; 2],
}

impl RareQuantities {
    const NONE: Self = Self {
        shadow: Lanes([0; LANES]),
        occlusion: Lanes([0; LANES]),
        cuts: 0,
        base: [Lanes([f32::NAN; LANES]); 3],
        ink: Lanes([0.0; LANES]),
        haze: Lanes([0.0; LANES]),
        marks: [Lanes([1.0; LANES]), Lanes([0.0; LANES])],
    };

    /// The quantities of a window; `None` if all of them are the defaults.
    #[inline]
    fn of(
        seen: &ShadingInput<'_>,
        window: PixelWindow,
        marks: Option<[Lanes<f32>; 2]>,
        haze: Option<Haze>,
    ) -> Option<Self> {
        let ShadingInput { columns: Columns { shadow, occlusion, cap, .. }, paint } = *seen;
        let is_plain = marks.is_none()
            && haze.is_none()
            && paint.is_empty()
            && (cap.is_empty() || *window.load(cap, &mut [false; LANES]) == [false; LANES])
            && [shadow, occlusion].into_iter().all(|hidden| {
                hidden.is_empty() || *window.load(hidden, &mut [0; LANES]) == [0; LANES]
            });
        (!is_plain).then(|| Self::all(seen, window, marks, haze))
    }

    #[inline(never)]
    fn all(
        seen: &ShadingInput<'_>,
        window: PixelWindow,
        marks: Option<[Lanes<f32>; 2]>,
        haze: Option<Haze>,
    ) -> Self {
        let ShadingInput { columns: Columns { shadow, occlusion, cap, drawn, .. }, paint } = *seen;
        let drawn = *window.load(drawn, &mut [0.0; LANES]);
        let (mut is_cap, mut paints) = ([false; LANES], [Paint::NONE; LANES]);
        let (is_cap, paints) = (window.load(cap, &mut is_cap), window.load(paint, &mut paints));
        Self {
            shadow: Lanes(*window.load(shadow, &mut [0; LANES])),
            occlusion: Lanes(*window.load(occlusion, &mut [0; LANES])),
            cuts: bits(|lane| is_cap[lane]),
            base: [0, 1, 2].map(|primary| Lanes(paints.map(|paint| paint.base.0[primary]))),
            ink: Lanes(paints.map(|paint| paint.ink)),
            haze: Lanes(drawn.map(|drawn| haze.map_or(0.0, |haze| haze.share(drawn)))),
            marks: marks.unwrap_or(Self::NONE.marks),
        }
    }
}

/// Unit vectors toward the lights that move with the camera, and along its view.
#[derive(Clone, Copy)]
struct CameraLights {
    forward: Vec3,
    above: Vec3,
    fill: Vec3,
    rim: Vec3,
}

impl CameraLights {
    fn new(rays: &RayGrid) -> Self {
        let [forward, right, up] = [rays.forward(), rays.right(), rays.up()];
        let fill = -forward + 1.1 * right - 0.2 * up;
        let rim = 0.6 * forward + 0.5 * right + up;
        Self {
            forward: forward.as_vec3(),
            above: up.as_vec3(),
            fill: fill.normalize().as_vec3(),
            rim: rim.normalize().as_vec3(),
        }
    }
}

/// The share of the key light that reaches points, including what walls and floor scatter into its
/// shadow. `lit` is the share that is not hidden.
#[inline(always)]
fn with_scattered<S: Simd>(lit: f32x16<S>) -> f32x16<S> {
    SCATTERED + (1.0 - SCATTERED) * lit
}

impl Shader<'_> {
    /// Writes the colors of a window's pixels. `faced` has their normals and the directions to the
    /// eye; without it, the normals are read from `seen`.
    #[inline(always)]
    fn paint<S: Simd>(
        &self,
        simd: S,
        seen: &ShadingInput<'_>,
        mut window: PixelWindow,
        faced: Option<ViewAndNormals<S>>,
        all: &mut ColorsMut<'_>,
    ) {
        let mut status = [Status::Miss; LANES];
        let status = window.load(seen.columns.status, &mut status);
        let mut numbers = [0; LANES];
        for (number, &status) in numbers.iter_mut().zip(status) {
            *number = status as u8;
        }
        let numbers = u8x16::simd_from(simd, numbers);
        let undecided = numbers.simd_eq(Status::Undecided as u8).to_bitmask() as u32;
        let marks = match self.appearance.undecided {
            _ if undecided == 0 => None,
            UndecidedStyle::Shade => None,
            UndecidedStyle::Miss => {
                window.wanted &= !undecided;
                None
            }
            UndecidedStyle::Hatch | UndecidedStyle::Tint => {
                Some(self.marks(PixelWindow { wanted: undecided, ..window }))
            }
        };
        let mut surface = [seen.columns.surface.all; LANES];
        let surface = window.load(seen.columns.surface.each, &mut surface);
        // Surfaces are painted one after another. Most windows have only one.
        while window.wanted != 0 {
            let first = window.wanted.trailing_zeros() as usize % LANES;
            let differ = surface.iter().fold(0, |any, number| any | (number ^ surface[first]));
            let of_surface =
                if differ == 0 { FULL } else { bits(|lane| surface[lane] == surface[first]) };
            let entry = usize::from(surface[first]) % self.palette.len();
            let PaletteColors { colors, is_plain } = &self.palette[entry];
            // The loop mostly runs once. Finding the rare quantities before it would take longer.
            let own = RareQuantities::of(seen, window, marks, self.appearance.haze);
            let none = &RareQuantities::NONE;
            let amounts = match &own {
                None if *is_plain => {
                    self.light::<S, false>(simd, seen, window, faced, colors, none)
                }
                own => {
                    let own = own.as_ref().unwrap_or(none);
                    self.light::<S, true>(simd, seen, window, faced, colors, own)
                }
            };
            let painted = PixelWindow { wanted: window.wanted & of_surface, ..window };
            match all {
                ColorsMut::Bytes(bytes) => {
                    painted.store_colors(&self.codes.bytes(simd, amounts), bytes);
                }
                ColorsMut::Floats(light) => painted.store(by_lane(amounts), light),
            }
            window.wanted &= !of_surface;
        }
    }

    /// The light that the surroundings send from the directions `way`. The surroundings are a dark
    /// room with a pale ceiling and a floor. The background is behind the surfaces. A wide panel
    /// shines at the key light, and a narrow one at the fill light.
    #[inline(always)]
    fn surroundings<S: Simd>(
        &self,
        simd: S,
        way: [f32x16<S>; 3],
        key: [f32x16<S>; 3],
    ) -> f32x16<S> {
        let lamps = self.lamps;
        let height = dot(way, splat(simd, lamps.above));
        let ceiling = 0.62 * smooth_step(height, -0.25, 0.55);
        let behind = smooth_step(dot(way, splat(simd, lamps.forward)), 0.0, 0.9);
        let floor = FLOOR * smooth_step(-height, -0.1, 0.5);
        let backdrop = self.backdrop * behind.max(floor);
        let axes = [lamps.above, lamps.forward];
        let wide = 1.5 * panel(simd, way, key, axes, [0.34, 0.24]);
        let narrow = 0.7 * panel(simd, way, splat(simd, lamps.fill), axes, [0.1, 0.36]);
        WALLS + ceiling.max(backdrop) + wide + narrow
    }

    /// The marks of undecided pixels: the factor of their own light, and the share of the tint.
    fn marks(&self, undecided: PixelWindow) -> [Lanes<f32>; 2] {
        let [mut left, mut tint] = [1.0, 0.0].map(Lanes::splat);
        let diagonal = undecided.column + undecided.row + self.rays.corner.iter().sum::<usize>();
        for lane in undecided.lanes() {
            if self.appearance.undecided == UndecidedStyle::Tint {
                (left[lane], tint[lane]) = (0.5, 0.5);
            } else if (diagonal + lane) % HATCH_PERIOD < HATCH_WIDTH {
                left[lane] = 0.25;
            }
        }
        [left, tint]
    }

    /// The light that a window's pixels send to the eye, by primary, clamped to the range of the
    /// table. The function is compiled in two versions, since most windows have no rare quantities.
    #[inline(always)]
    fn light<S: Simd, const OWN: bool>(
        &self,
        simd: S,
        seen: &ShadingInput<'_>,
        window: PixelWindow,
        faced: Option<ViewAndNormals<S>>,
        colors: &SurfaceColors,
        own: &RareQuantities,
    ) -> [f32x16<S>; 3] {
        let Self { rays, appearance, lamps, .. } = *self;
        let Appearance { look, ambient: everywhere, .. } = appearance;
        let light = appearance.light.all_towards(
            simd,
            #[inline(always)]
            || rays.points(simd, window, window.load(seen.columns.drawn, &mut [0.0; LANES])),
        );
        // Vectors are not passed to closures, which would be compiled separately, for narrower
        // vectors.
        let one = f32x16::splat(simd, 1.0);
        let (eye, normal) = if let Some(faced) = faced {
            faced
        } else {
            let normal = by_axis(simd, window.load(seen.columns.normal, &mut [[0.0; 3]; LANES]));
            (rays.ways(simd, window).to_eye, normal)
        };
        let facing = dot(normal, eye);
        // The visible side is the one that is lit.
        let side = one.copysign(facing);
        let (mut lit, mut open) = (one, one);
        if OWN {
            (lit, open) = (left(simd, &own.shadow), left(simd, &own.occlusion));
        }
        let slant = (side * dot(normal, light)).max(0.0);
        let direct = lit * slant;
        // The square of the cosine between the normal and the halfway vector, as a quotient. If the
        // light is straight behind the surface, the halfway vector is zero, and so is the
        // highlight.
        let halfway = [light[0] + eye[0], light[1] + eye[1], light[2] + eye[2]];
        let cosine = (side * dot(normal, halfway)).max(0.0);
        let square_of_length = dot(halfway, halfway).max(f32::MIN_POSITIVE);
        let highlight_power = highlight_power(simd, cosine * cosine, square_of_length);
        let grazing = 1.0 - facing.abs().min(1.0);
        let material = colors.material;
        // Little light from behind reaches a point that nearby points hide.
        let behind = (side * dot(normal, splat(simd, lamps.rim))).max(0.0);
        let mut white = look.rim * grazing * grazing * behind * (open * open * open);
        if let Some(mut power) = highlight_power {
            let mut strength = look.highlight;
            if OWN {
                strength *= material.highlight;
                if material.is_sharp {
                    power *= power;
                    power *= power;
                }
            }
            white = (strength * direct.sqrt()).mul_add(power, white);
        }
        // Ambient light falls off toward grazing angles, so that shapes stay readable in shadow.
        let from_above = 0.5 + 0.5 * (side * dot(normal, splat(simd, lamps.above)));
        let around = look.ground + (1.0 - look.ground) * from_above;
        let mut ambient = *everywhere * open * around * (1.0 - 0.4 * grazing);
        if OWN {
            // In shadow, some of the places that send light to the point are in shadow, too.
            let reached = 0.9 + 0.1 * lit;
            ambient *= reached;
            open *= reached;
        }
        let fill = look.fill * open * (side * dot(normal, splat(simd, lamps.fill))).max(0.0);
        let factor = ambient + (1.0 - everywhere) * (look.key * with_scattered(lit) * slant + fill);
        let edge = grazing * grazing;
        let factor = factor * (1.0 - look.outline * edge * edge);
        // The reflected surroundings, and how much more is reflected at grazing angles.
        let (mut mirrored, mut more) = (one, one);
        let reflects = OWN && material.reflection > 0.0;
        if reflects {
            let turned = 2.0 * facing;
            let way = [0, 1, 2].map(|axis| turned * normal[axis] - eye[axis]);
            mirrored = look.surroundings * open * self.surroundings(simd, way, light);
            let square = grazing * grazing;
            more = square * square * grazing;
        }
        let is_negative = facing.simd_lt(0.0);
        let haze = appearance.haze.map_or([0.0; 3], |haze| haze.color.0);
        let is_cut = mask32x16::from_bitmask(simd, u64::from(own.cuts));
        let mut amounts = [one; 3];
        for (primary, all) in amounts.iter_mut().enumerate() {
            let [positive, negative, cut] =
                [colors.positive, colors.negative, colors.cut].map(|color| color.0[primary]);
            let [positive, negative] =
                [f32x16::splat(simd, positive), f32x16::splat(simd, negative)];
            let mut base = is_negative.select(negative, positive);
            if OWN {
                base = is_cut.select(f32x16::splat(simd, cut), base);
                let painted = f32x16::from_slice(simd, &own.base[primary][..]);
                base = painted.is_nan().select(base, painted);
            }
            let mut light = base.mul_add(factor, white);
            if reflects {
                let share = material.reflection + (1.0 - material.reflection) * more;
                light = if material.is_metal {
                    // A metal's reflections lose their color toward grazing angles.
                    let tint = base + (1.0 - base) * more;
                    (material.diffuse * base).mul_add(factor, white)
                        + material.reflection * tint * mirrored
                } else {
                    (material.diffuse * (1.0 - share) * base).mul_add(factor, white)
                        + share * mirrored
                };
            }
            let mut amount = tone_map(simd, light);
            if OWN {
                let [left, tint] = &own.marks;
                amount *= 1.0 - INK * f32x16::from_slice(simd, &own.ink[..]);
                amount *= f32x16::from_slice(simd, &left[..]);
                amount += TINT.0[primary] * f32x16::from_slice(simd, &tint[..]);
                amount += (haze[primary] - amount) * f32x16::from_slice(simd, &own.haze[..]);
            }
            *all = amount.max(BLACK).min(1.0);
        }
        amounts
    }
}
