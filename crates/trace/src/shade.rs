//! From a G-buffer to colours: deferred shading, which asks nothing of the function.

use crate::colour::{BLACK, Codes, LinearRgb};
use crate::gbuffer::{GBuffer, Status};
use crate::grid::RayGrid;
use crate::light::Light;
use crate::look::Look;
use crate::painted::{BAND, Window, bits, windows};
use crate::spare::Spares;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use zeroset_eval::{LANES, Lanes};

/// The colours of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceColours {
    /// Of the side on which f > 0.
    pub positive: LinearRgb,
    /// Of the side on which f < 0.
    pub negative: LinearRgb,
    /// Of the faces where a region cuts a solid open.
    pub cut: LinearRgb,
}

/// How an undecided pixel is told from a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UndecidedStyle {
    /// Not at all.
    Shade,
    /// By diagonal stripes.
    #[default]
    Hatch,
    /// By a colour mixed in.
    Tint,
    /// It is left out.
    Miss,
}

/// Everything about a picture that is a matter of taste.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Colours by surface number; further surfaces start over. Empty: the default pairs.
    pub surfaces: Vec<SurfaceColours>,
    /// Shown where nothing is painted.
    pub background: LinearRgb,
    /// Share of the light that comes from everywhere, within [0, 1].
    pub ambient: f32,
    /// How the surfaces are lit; its background and ambient share do not count.
    pub look: Look,
    /// Where the light comes from that casts shadows.
    pub light: Light,
    /// How undecided pixels are marked.
    pub undecided: UndecidedStyle,
}

impl SurfaceColours {
    /// Pairs for surfaces without colours of their own: the first warm and cool, told apart in
    /// every common form of colour blindness (Okabe and Ito, "Color Universal Design", 2008).
    pub fn default_for(surface: usize) -> Self {
        let pair = DEFAULT_PAIRS[surface % DEFAULT_PAIRS.len()];
        let [positive, negative] = pair.map(LinearRgb::from_srgb);
        Self { positive, negative, cut: cut(positive) }
    }

    /// The sides of a surface whose outer one has this colour: the inner one is darker and less colourful.
    pub fn around(outer: LinearRgb) -> Self {
        let [red, green, blue] = outer.0;
        let grey = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        let negative = LinearRgb(outer.0.map(|part| 0.5 * part + 0.12 * grey + 0.02));
        Self { positive: outer, negative, cut: cut(outer) }
    }

    /// The same with the sides exchanged.
    #[must_use]
    pub fn turned(self) -> Self {
        Self { positive: self.negative, negative: self.positive, ..self }
    }
}

/// The colour of what is inside of a solid of this colour: lighter, as if sawn.
fn cut(outer: LinearRgb) -> LinearRgb {
    LinearRgb(outer.0.map(|part| 0.45 * part + 0.4))
}

impl Appearance {
    /// A look under this light.
    pub fn new(look: &Look, light: Light) -> Self {
        Self {
            surfaces: Vec::new(),
            background: look.background(),
            ambient: look.ambient,
            look: *look,
            light,
            undecided: UndecidedStyle::default(),
        }
    }

    /// The colours of surfaces, from the first on until they start over.
    fn palette(&self) -> Vec<SurfaceColours> {
        if self.surfaces.is_empty() {
            (0..DEFAULT_PAIRS.len()).map(SurfaceColours::default_for).collect()
        } else {
            self.surfaces.clone()
        }
    }
}

const DEFAULT_PAIRS: [[[u8; 3]; 2]; 4] = [
    [[230, 159, 0], [0, 114, 178]],   // orange, blue
    [[240, 228, 66], [86, 180, 233]], // yellow, sky blue
    [[213, 94, 0], [0, 158, 115]],    // vermilion, bluish green
    [[204, 121, 167], [92, 92, 104]], // reddish purple, grey
];

/// Distance of the stripes of a hatch, and their width, in pixels along a row.
const HATCH_PERIOD: usize = 6;
const HATCH_WIDTH: usize = 2;

/// Marks undecided pixels under [`UndecidedStyle::Tint`]: no hue of the default pairs.
const TINT: LinearRgb = LinearRgb([0.6, 0.0, 0.6]);

/// The picture as rows of sRGB bytes, red, green, blue, from the top left.
///
/// A surface is lit on both sides: the normal is turned to the eye, and the side that is seen, f >
/// 0 or f < 0, decides the colour. In shadow only the ambient share is left.
pub fn shade(buffer: &GBuffer, rays: &RayGrid, appearance: &Appearance) -> Vec<u8> {
    let pixels = buffer.status.len();
    let mut bytes = SPARES.take(3 * pixels, Vec::capacity).unwrap_or_default();
    bytes.resize(3 * pixels, 0);
    let row = appearance.background.to_srgb().repeat(buffer.width);
    let (palette, codes) = (appearance.palette(), Codes::get());
    let lamps = Lamps::new(rays);
    let size = (BAND * buffer.width).max(1);
    bytes.par_chunks_mut(3 * size).enumerate().for_each(|(band, bytes)| {
        bytes.chunks_mut(row.len().max(1)).for_each(|bytes| bytes.copy_from_slice(&row));
        let (bytes, first) = (bytes.as_chunks_mut().0, band * BAND);
        let here = band * size..band * size + bytes.len();
        let band = Band {
            rays,
            appearance,
            palette: &palette,
            lamps,
            codes,
            status: &buffer.status[here.clone()],
            drawn: &buffer.drawn[here.clone()],
            surface: &buffer.surface[here.clone()],
            normal: &buffer.normal[here.clone()],
            cap: &buffer.cap[here.clone()],
            shadow: &buffer.shadow[here.clone()],
            occlusion: &buffer.occlusion[here],
        };
        windows(band.drawn, first, buffer.width, |window| band.paint(window, bytes));
    });
    bytes
}

/// Leaves the memory of a picture to the next ones. Up to two pictures' are kept, until the end of the process.
pub fn hand_back_colours(bytes: Vec<u8>) {
    SPARES.hand_back(bytes);
}

static SPARES: Spares<Vec<u8>> = Spares::new();

/// What a buffer has of some rows.
struct Band<'a> {
    rays: &'a RayGrid,
    appearance: &'a Appearance,
    palette: &'a [SurfaceColours],
    lamps: Lamps,
    codes: &'a Codes,
    status: &'a [Status],
    drawn: &'a [f64],
    surface: &'a [u16],
    normal: &'a [[f32; 3]],
    cap: &'a [bool],
    shadow: &'a [u8],
    occlusion: &'a [u8],
}

/// Directions, of length 1, towards the lights that move with the camera.
#[derive(Clone, Copy)]
struct Lamps {
    above: Vec3,
    fill: Vec3,
    rim: Vec3,
}

impl Lamps {
    fn new(rays: &RayGrid) -> Self {
        let [forward, right, up] = [rays.forward(), rays.right(), rays.up()];
        let fill = -forward + 1.1 * right - 0.2 * up;
        let rim = 0.6 * forward + 0.5 * right + up;
        Self {
            above: up.as_vec3(),
            fill: fill.normalize().as_vec3(),
            rim: rim.normalize().as_vec3(),
        }
    }
}

impl Band<'_> {
    /// Writes the bytes of a window's pixels.
    fn paint(&self, mut window: Window, bytes: &mut [[u8; 3]]) {
        let mut status = [Status::Miss; LANES];
        let status = window.load(self.status, &mut status);
        let undecided = bits(|lane| status[lane] == Status::Undecided);
        let marks = match self.appearance.undecided {
            _ if undecided == 0 => None,
            UndecidedStyle::Shade => None,
            UndecidedStyle::Miss => {
                window.wanted &= !undecided;
                None
            }
            UndecidedStyle::Hatch | UndecidedStyle::Tint => {
                Some(self.marks(Window { wanted: undecided, ..window }))
            }
        };
        let mut surface = [0; LANES];
        let surface = window.load(self.surface, &mut surface);
        let mut amounts = [Lanes::splat(0.0); 3];
        // One surface after another: most windows have one.
        while let Some(first) = window.lanes().next() {
            let of_surface = bits(|lane| surface[lane] == surface[first]);
            let colours = &self.palette[usize::from(surface[first]) % self.palette.len()];
            self.light(window, colours, marks.as_ref(), &mut amounts);
            let [red, green, blue] = &amounts;
            let code = |amounts: &Lanes<f32>, lane: usize| self.codes.byte(amounts[lane]);
            Window { wanted: window.wanted & of_surface, ..window }
                .store(|lane| [code(red, lane), code(green, lane), code(blue, lane)], bytes);
            window.wanted &= !of_surface;
        }
    }

    /// How undecided pixels are marked: what is left of their own light, and the share of the tint.
    fn marks(&self, undecided: Window) -> [Lanes<f32>; 2] {
        let [mut left, mut tint] = [1.0, 0.0].map(Lanes::splat);
        for lane in undecided.lanes() {
            if self.appearance.undecided == UndecidedStyle::Tint {
                (left[lane], tint[lane]) = (0.5, 0.5);
            } else if (undecided.column + lane + undecided.row) % HATCH_PERIOD < HATCH_WIDTH {
                left[lane] = 0.25;
            }
        }
        [left, tint]
    }

    /// Writes the light that a window's pixels send to the eye, by primary, clamped to what the codes know.
    fn light(
        &self,
        window: Window,
        colours: &SurfaceColours,
        marks: Option<&[Lanes<f32>; 2]>,
        amounts: &mut [Lanes<f32>; 3],
    ) {
        let Self { rays, appearance, lamps, .. } = *self;
        let Appearance { look, ambient: everywhere, .. } = appearance;
        let (mut normal, mut is_cap) = ([[0.0; 3]; LANES], [false; LANES]);
        let mut spare = [[0; LANES]; 2];
        let [shadow, occlusion] = &mut spare;
        let normal = window.load(self.normal, &mut normal);
        let shadow = window.load(self.shadow, shadow);
        let occlusion = window.load(self.occlusion, occlusion);
        let is_cap = window.load(self.cap, &mut is_cap);
        let points = || rays.points(window, window.load(self.drawn, &mut [0.0; LANES]));
        let to_light = appearance.light.all_towards(points);
        let to_eye = rays.ways_to_eye(window);
        // Four at a time by hand: what compilers make of a loop over lanes moves most of it to memory and back.
        for at in (0..LANES).step_by(4) {
            let four = |value: &dyn Fn(usize) -> f32| {
                Vec4::new(value(at), value(at + 1), value(at + 2), value(at + 3))
            };
            let axes = [0, 1, 2];
            let normal = axes.map(|axis| four(&|lane| normal[lane][axis]));
            let eye = axes.map(|axis| Vec4::from_slice(&to_eye[axis][at..]));
            let light = axes.map(|axis| Vec4::from_slice(&to_light[axis][at..]));
            let facing = dot(normal, eye);
            // The side that is seen is lit.
            let side = Vec4::ONE.copysign(facing);
            let lamp = |way: Vec3| side * dot(normal, way.to_array().map(Vec4::splat));
            let lit = 1.0 - four(&|lane| f32::from(shadow[lane])) / 255.0;
            let open = 1.0 - four(&|lane| f32::from(occlusion[lane])) / 255.0;
            let direct = lit * (side * dot(normal, light)).max(Vec4::ZERO);
            // The square of the cosine between the normal and the direction half way to the light. From straight behind there
            // is none, and light is not seen.
            let halfway = axes.map(|axis| light[axis] + eye[axis]);
            let cosine = (side * dot(normal, halfway)).max(Vec4::ZERO);
            let square_of_length = dot(halfway, halfway).max(Vec4::splat(f32::MIN_POSITIVE));
            let square = cosine * cosine / square_of_length;
            let grazing = 1.0 - facing.abs().min(Vec4::ONE);
            let rim = look.rim * grazing * grazing * lamp(lamps.rim).max(Vec4::ZERO);
            let white = look.highlight * direct.sqrt() * sharpened(square) + rim;
            // Ambient light falls off towards grazing angles, so that shapes stay readable in shadow.
            let from_above = 0.5 + 0.5 * lamp(lamps.above);
            let around = look.ground + (1.0 - look.ground) * from_above;
            let ambient = everywhere * open * around * (1.0 - 0.4 * grazing);
            let fill = look.fill * open * lamp(lamps.fill).max(Vec4::ZERO);
            let factor = ambient + (1.0 - everywhere) * (look.key * direct + fill);
            let edge = grazing * grazing;
            let factor = factor * (1.0 - look.outline * edge * edge);
            let cap = four(&|lane| if is_cap[lane] { -1.0 } else { 1.0 });
            let (is_negative, is_cut) = (facing.cmplt(Vec4::ZERO), cap.cmplt(Vec4::ZERO));
            for (primary, amounts) in amounts.iter_mut().enumerate() {
                let [positive, negative, cut] = [colours.positive, colours.negative, colours.cut]
                    .map(|colour| Vec4::splat(colour.0[primary]));
                let base = Vec4::select(is_negative, negative, positive);
                let base = Vec4::select(is_cut, cut, base);
                let mut amount = toned(base * factor + white);
                if let Some([left, tint]) = marks {
                    let own = amount * Vec4::from_slice(&left[at..]);
                    amount = own + TINT.0[primary] * Vec4::from_slice(&tint[at..]);
                }
                let amount = amount.max(Vec4::splat(BLACK)).min(Vec4::ONE);
                amount.write_to_slice(&mut amounts[at..]);
            }
        }
    }
}

fn dot(a: [Vec4; 3], b: [Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Light as a picture shows it: what is brighter than most of the range is brought into it, rather than cut off.
fn toned(amount: Vec4) -> Vec4 {
    // Reinhard's curve (2002) with a white point, from the knee on, where its slope is 1.
    let above = (amount - KNEE).max(Vec4::ZERO) / (1.0 - KNEE);
    let curve = above * (1.0 + above / (WHITE * WHITE)) / (1.0 + above);
    amount.min(Vec4::splat(KNEE)) + (1.0 - KNEE) * curve
}

/// Up to here light is shown as it is.
const KNEE: f32 = 0.7;
/// What becomes full light, in units from the knee to 1.
const WHITE: f32 = 2.0;

/// The 40th power of a cosine, which makes a highlight as small as it is, given its square.
fn sharpened(square: Vec4) -> Vec4 {
    /// Of this the power is 3e-31: of less it would become subnormal, which takes processors far longer.
    const LEAST: Vec4 = Vec4::splat(0.03);
    let square = square.max(LEAST);
    let fourth = square * square;
    let eighth = fourth * fourth;
    let tenth = eighth * square;
    let twentieth = tenth * tenth;
    twentieth * twentieth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LOOKS;
    use crate::camera::{Camera, Projection};
    use glam::DVec3;

    /// One pixel painted at distance 4 on the way along +y from (0, −5, 0).
    fn painted(normal: [f32; 3]) -> (GBuffer, RayGrid) {
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let mut buffer = GBuffer::new(1, 1, 0);
        buffer.status[0] = Status::Hit;
        buffer.drawn[0] = 4.0;
        buffer.normal[0] = normal;
        (buffer, camera.expect("valid").rays(1, 1))
    }

    fn headlight() -> Appearance {
        Appearance::new(Default::default(), Light::Positional(DVec3::NEG_Y * 5.0))
    }

    #[test]
    fn the_side_that_is_seen_decides_the_colour() {
        let (buffer, rays) = painted([0.0, -1.0, 0.0]);
        let warm = shade(&buffer, &rays, &headlight());
        assert!(warm[0] > warm[2], "{warm:?}");
        let (buffer, rays) = painted([0.0, 1.0, 0.0]);
        let cool = shade(&buffer, &rays, &headlight());
        assert!(cool[0] < cool[2], "{cool:?}");
    }

    #[test]
    fn shadow_leaves_the_ambient_share() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let lit = shade(&buffer, &rays, &headlight());
        buffer.shadow[0] = 255;
        let dark = shade(&buffer, &rays, &headlight());
        assert!(dark[0] < lit[0] && dark[0] > 0);
    }

    #[test]
    fn light_from_behind_lights_no_more_than_it_should() {
        for k in 0..3000 {
            // All but straight behind, all but grazing: what is half way hangs on the last bits.
            let (aside, turned) = (1e-6 * f64::from(k), 1e-4 * (k % 7) as f32);
            let (buffer, rays) = painted([1.0, turned - 3e-4, 0.0]);
            let light = Light::Positional(DVec3::new(aside, 5.0, 0.0));
            let surfaces = vec![SurfaceColours::default_for(0)];
            let look = Appearance { surfaces, ..Appearance::new(Default::default(), light) };
            let (lit, plain) = (shade(&buffer, &rays, &look), plain(&buffer, &rays, &look, 0));
            let close = lit.iter().zip(plain).all(|(a, b)| a.abs_diff(b) <= 1);
            assert!(close, "{k}: {lit:?} {plain:?}");
        }
    }

    #[test]
    fn undecided_pixels_are_marked_as_asked() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let hit = shade(&buffer, &rays, &headlight());
        buffer.status[0] = Status::Undecided;
        let with = |undecided| shade(&buffer, &rays, &Appearance { undecided, ..headlight() });
        assert_eq!(with(UndecidedStyle::Shade), hit);
        assert!(with(UndecidedStyle::Hatch)[0] < hit[0]);
        assert_ne!(with(UndecidedStyle::Tint), hit);
        assert_eq!(with(UndecidedStyle::Miss), headlight().background.to_srgb());
    }

    #[test]
    fn a_cut_face_has_a_lighter_colour_on_either_side() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let outer = shade(&buffer, &rays, &headlight());
        buffer.cap[0] = true;
        let cut = shade(&buffer, &rays, &headlight());
        assert!(cut[2] > outer[2], "{cut:?} {outer:?}");
        buffer.normal[0] = [0.0, 1.0, 0.0];
        assert_eq!(shade(&buffer, &rays, &headlight()), cut);
    }

    #[test]
    fn what_is_near_takes_light_away() {
        for look in &LOOKS {
            let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
            let light = Light::Positional(DVec3::NEG_Y * 5.0);
            let open = shade(&buffer, &rays, &Appearance::new(look, light));
            buffer.occlusion[0] = 200;
            let hidden = shade(&buffer, &rays, &Appearance::new(look, light));
            assert!(hidden[0] < open[0] && hidden[0] > 0, "{}", look.name);
        }
    }

    /// The colour of one pixel in plain `f64`; not of an undecided one.
    fn plain(buffer: &GBuffer, rays: &RayGrid, look: &Appearance, pixel: usize) -> [u8; 3] {
        if !buffer.is_drawn(pixel) {
            return look.background.to_srgb();
        }
        let ray = rays.ray_of(pixel);
        let to_eye = -ray.direction.normalize();
        let normal = DVec3::from_array(buffer.normal[pixel].map(f64::from));
        let (facing, ambient) = (normal.dot(to_eye), f64::from(look.ambient));
        let colours = look.surfaces[usize::from(buffer.surface[pixel]) % look.surfaces.len()];
        let base = match (buffer.cap[pixel], facing < 0.0) {
            (true, _) => colours.cut,
            (false, true) => colours.negative,
            (false, false) => colours.positive,
        };
        let normal = if facing < 0.0 { -normal } else { normal };
        let to_light = look.light.towards(ray.at(ray.parameter(buffer.drawn[pixel]))).0;
        let halfway = (to_light + to_eye).normalize_or_zero();
        let [lit, open] = [&buffer.shadow, &buffer.occlusion]
            .map(|hidden| 1.0 - f64::from(hidden[pixel]) / 255.0);
        let [ground, key, fill, rim, highlight, outline] = {
            let Look { ground, key, fill, rim, highlight, outline, .. } = look.look;
            [ground, key, fill, rim, highlight, outline].map(f64::from)
        };
        let lamp = |way: DVec3| normal.dot(way.normalize());
        let (forward, right, up) = (rays.forward(), rays.right(), rays.up());
        let direct = lit * normal.dot(to_light).max(0.0);
        let grazing = 1.0 - facing.abs().min(1.0);
        let behind = lamp(0.6 * forward + 0.5 * right + up).max(0.0);
        let aside = lamp(-forward + 1.1 * right - 0.2 * up).max(0.0);
        let around = ground + (1.0 - ground) * (0.5 + 0.5 * lamp(up));
        let ambient_light = ambient * open * around * (1.0 - 0.4 * grazing);
        let factor = ambient_light + (1.0 - ambient) * (key * direct + fill * open * aside);
        let factor = factor * (1.0 - outline * grazing.powi(4));
        let shine = highlight * direct.sqrt() * normal.dot(halfway).max(0.0).powi(40);
        let white = shine + rim * grazing * grazing * behind;
        let toned = |amount: f64| {
            let above = (amount - 0.7).max(0.0) / 0.3;
            amount.min(0.7) + 0.3 * above * (1.0 + above / 4.0) / (1.0 + above)
        };
        let amounts = base.0.map(|part| toned(f64::from(part) * factor + white) as f32);
        LinearRgb(amounts).to_srgb()
    }

    #[test]
    fn every_pixel_is_lit_as_if_it_were_alone() {
        let projection = Projection::Perspective { fov: 60.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let (width, height) = (53, 19);
        let rays = camera.expect("valid").rays(width, height);
        let mut buffer = GBuffer::new(width, height, 0);
        let mut state = 1_u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for pixel in 0..width * height {
            // Runs of several lengths, and lone pixels.
            if random(8) == 0 || (pixel / 40) % 3 == 0 {
                buffer.drawn[pixel] = 3.0 + f64::from(random(100)) / 30.0;
            }
            let normal = [(); 3].map(|()| f64::from(random(201)) - 100.0);
            let normal = DVec3::from_array(normal).normalize_or(DVec3::Z);
            buffer.normal[pixel] = normal.as_vec3().to_array();
            buffer.surface[pixel] = if random(20) == 0 { random(7) as u16 } else { 1 };
            buffer.cap[pixel] = random(5) == 0;
            buffer.shadow[pixel] = if random(3) == 0 { random(256) as u8 } else { 0 };
            buffer.occlusion[pixel] = random(256) as u8;
        }
        let surfaces: Vec<_> = (0..3).map(SurfaceColours::default_for).collect();
        for light in [Light::above_left(&rays), Light::Positional(DVec3::new(1.0, -2.0, 1.0))] {
            for look in &LOOKS {
                let look =
                    Appearance { surfaces: surfaces.clone(), ..Appearance::new(look, light) };
                let bytes = shade(&buffer, &rays, &look);
                for (pixel, bytes) in bytes.chunks_exact(3).enumerate() {
                    let plain = plain(&buffer, &rays, &look, pixel);
                    let close = bytes.iter().zip(plain).all(|(a, b)| a.abs_diff(b) <= 1);
                    assert!(close, "{pixel}: {bytes:?} {plain:?}");
                }
            }
        }
    }

    #[test]
    fn memory_that_is_handed_back_holds_nothing_of_its_picture() {
        let (buffer, rays) = painted([0.0, -1.0, 0.0]);
        let before = shade(&buffer, &rays, &headlight());
        hand_back_colours(vec![7; 300]);
        assert_eq!(shade(&buffer, &rays, &headlight()), before);
    }
}
