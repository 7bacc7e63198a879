//! Colors of single pixels, and of sixteen at once compared with single ones.

use super::*;
use crate::colors::hand_back_colors;
use glam::DVec3;
use zeroset_space::{Camera, Projection};
use zeroset_style::{LOOKS, MATERIALS};
use zeroset_testkit::simd::{is_fused, levels};
use zeroset_trace::{RayGrid, Status};

/// One pixel painted at distance 4 on the way along +y from (0, −5, 0).
fn painted(normal: [f32; 3]) -> (GBuffer, RayGrid) {
    let projection = Projection::Perspective { fov: 40.0 };
    let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
    let mut buffer = GBuffer::new(1, 1, 0);
    buffer.status[0] = Status::Hit;
    buffer.drawn[0] = 4.0;
    buffer.normal[0] = normal;
    (buffer, RayGrid::new(&camera.expect("valid"), 1, 1))
}

fn bytes(buffer: &GBuffer, rays: &RayGrid, appearance: &Appearance) -> Vec<u8> {
    shade(buffer, rays, appearance, &[], ColorDepth::Bytes).into_bytes()
}

fn headlight() -> Appearance {
    Appearance::new(Default::default(), Light::Positional(DVec3::NEG_Y * 5.0))
}

#[test]
fn the_side_that_is_seen_decides_the_color() {
    let (buffer, rays) = painted([0.0, -1.0, 0.0]);
    let warm = bytes(&buffer, &rays, &headlight());
    assert!(warm[0] > warm[2], "{warm:?}");
    let (buffer, rays) = painted([0.0, 1.0, 0.0]);
    let cool = bytes(&buffer, &rays, &headlight());
    assert!(cool[0] < cool[2], "{cool:?}");
}

#[test]
fn shadow_leaves_the_ambient_share() {
    let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
    let lit = bytes(&buffer, &rays, &headlight());
    buffer.shadow = vec![255];
    let dark = bytes(&buffer, &rays, &headlight());
    assert!(dark[0] < lit[0] && dark[0] > 0);
}

#[test]
fn light_from_behind_lights_no_more_than_it_should() {
    for k in 0..3000 {
        // Light from almost straight behind that almost grazes the surface: the halfway vector
        // depends on the last bits, but the color must not.
        let (aside, turned) = (1e-6 * f64::from(k), 1e-4 * (k % 7) as f32);
        let (buffer, rays) = painted([1.0, turned - 3e-4, 0.0]);
        let light = Light::Positional(DVec3::new(aside, 5.0, 0.0));
        let surfaces = vec![SurfaceColors::default_for(0)];
        let look = Appearance { surfaces, ..Appearance::new(Default::default(), light) };
        let (lit, plain) = (bytes(&buffer, &rays, &look), plain(&buffer, &rays, &look, 0));
        let close = lit.iter().zip(plain).all(|(a, b)| a.abs_diff(b) <= 1);
        assert!(close, "{k}: {lit:?} {plain:?}");
    }
}

#[test]
fn undecided_pixels_are_marked_as_asked() {
    let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
    let hit = bytes(&buffer, &rays, &headlight());
    buffer.status[0] = Status::Undecided;
    let with = |undecided| bytes(&buffer, &rays, &Appearance { undecided, ..headlight() });
    assert_eq!(with(UndecidedStyle::Shade), hit);
    assert!(with(UndecidedStyle::Hatch)[0] < hit[0]);
    assert_ne!(with(UndecidedStyle::Tint), hit);
    assert_eq!(with(UndecidedStyle::Miss), headlight().background.to_srgb());
}

#[test]
fn a_cut_face_has_a_lighter_color_on_either_side() {
    let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
    let outer = bytes(&buffer, &rays, &headlight());
    buffer.cap = vec![true];
    let cut = bytes(&buffer, &rays, &headlight());
    assert!(cut[2] > outer[2], "{cut:?} {outer:?}");
    buffer.normal[0] = [0.0, 1.0, 0.0];
    assert_eq!(bytes(&buffer, &rays, &headlight()), cut);
}

#[test]
fn what_is_near_takes_light_away() {
    for look in &LOOKS {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let light = Light::Positional(DVec3::NEG_Y * 5.0);
        let open = bytes(&buffer, &rays, &Appearance::new(look, light));
        buffer.occlusion = vec![200];
        let hidden = bytes(&buffer, &rays, &Appearance::new(look, light));
        assert!(hidden[0] < open[0] && hidden[0] > 0, "{}", look.name);
    }
}

/// The color of one pixel in plain `f64`. Not for undecided pixels.
fn plain(buffer: &GBuffer, rays: &RayGrid, look: &Appearance, pixel: usize) -> [u8; 3] {
    if !buffer.is_drawn(pixel) {
        return look.background.to_srgb();
    }
    let ray = rays.ray_of(pixel);
    let to_eye = -ray.direction.normalize();
    let normal = DVec3::from_array(buffer.normal[pixel].map(f64::from));
    let (facing, ambient) = (normal.dot(to_eye), f64::from(look.ambient));
    let colors = look.surfaces[usize::from(buffer.surface[pixel]) % look.surfaces.len()];
    let base = match (buffer.is_cap(pixel), facing < 0.0) {
        (true, _) => colors.cut,
        (false, true) => colors.negative,
        (false, false) => colors.positive,
    };
    let normal = if facing < 0.0 { -normal } else { normal };
    let to_light = look.light.towards(ray.at(ray.parameter(buffer.drawn[pixel]))).0;
    let halfway = (to_light + to_eye).normalize_or_zero();
    let [lit, open] = [&buffer.shadow, &buffer.occlusion]
        .map(|hidden| 1.0 - f64::from(hidden.get(pixel).copied().unwrap_or_default()) / 255.0);
    let (open, not_hidden) = (open * (0.9 + 0.1 * lit), open);
    let [ground, key, fill, rim, highlight, outline] = {
        let Look { ground, key, fill, rim, highlight, outline, .. } = look.look;
        [ground, key, fill, rim, highlight, outline].map(f64::from)
    };
    let lamp = |way: DVec3| normal.dot(way.normalize());
    let (forward, right, up) = (rays.forward(), rays.right(), rays.up());
    let slant = normal.dot(to_light).max(0.0);
    let direct = lit * slant;
    let grazing = 1.0 - facing.abs().min(1.0);
    let behind = lamp(0.6 * forward + 0.5 * right + up).max(0.0);
    let aside = lamp(-forward + 1.1 * right - 0.2 * up).max(0.0);
    let around = ground + (1.0 - ground) * (0.5 + 0.5 * lamp(up));
    let ambient_light = ambient * open * around * (1.0 - 0.4 * grazing);
    let factor =
        ambient_light + (1.0 - ambient) * (key * (0.1 + 0.9 * lit) * slant + fill * open * aside);
    let factor = factor * (1.0 - outline * grazing.powi(4));
    let material = colors.material;
    let power = if material.is_sharp { 160 } else { 40 };
    let highlight = highlight * f64::from(material.highlight);
    let highlight_power = highlight * direct.sqrt() * normal.dot(halfway).max(0.0).powi(power);
    let white = highlight_power + not_hidden.powi(3) * rim * grazing * grazing * behind;
    let mirrored = 2.0 * normal.dot(to_eye) * normal - to_eye;
    let step = |value: f64, low: f64, high: f64| {
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let panel = |middle: DVec3, [wide, tall]: [f64; 2]| {
        let upward = if middle.dot(up).powi(2) > 0.95 { forward } else { up };
        let across = middle.cross(upward).normalize_or_zero();
        let upward = across.cross(middle);
        let beside = |along: f64, half: f64| 1.0 - step(along.abs(), half - 0.03, half + 0.03);
        step(mirrored.dot(middle), 0.0, 0.2)
            * beside(mirrored.dot(across), wide)
            * beside(mirrored.dot(upward), tall)
    };
    let backdrop = 0.42 * f64::from(look.background.0.iter().sum::<f32>()) / 3.0;
    let backdrop = backdrop
        * step(mirrored.dot(forward), 0.0, 0.9).max(0.4 * step(-mirrored.dot(up), -0.1, 0.5));
    let surroundings = 0.28
        + (0.62 * step(mirrored.dot(up), -0.25, 0.55)).max(backdrop)
        + 1.5 * panel(to_light, [0.34, 0.24])
        + 0.7 * panel((-forward + 1.1 * right - 0.2 * up).normalize(), [0.1, 0.36]);
    let surroundings = f64::from(look.look.surroundings) * open * surroundings;
    let more = grazing.powi(5);
    let [diffuse, reflection] = [material.diffuse, material.reflection].map(f64::from);
    let light = |base: f64| {
        let share = reflection + (1.0 - reflection) * more;
        if reflection == 0.0 {
            base * factor + white
        } else if material.is_metal {
            let tint = base + (1.0 - base) * more;
            diffuse * base * factor + white + reflection * tint * surroundings
        } else {
            diffuse * (1.0 - share) * base * factor + white + share * surroundings
        }
    };
    let tone_map = |amount: f64| {
        let above = (amount - 0.7).max(0.0) / 0.3;
        amount.min(0.7) + 0.3 * above * (1.0 + above / 4.0) / (1.0 + above)
    };
    let amounts = base.0.map(|part| tone_map(light(f64::from(part))) as f32);
    LinearRgb(amounts).to_srgb()
}

#[test]
fn every_pixel_is_lit_as_if_it_were_alone() {
    let projection = Projection::Perspective { fov: 60.0 };
    let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
    let (width, height) = (53, 19);
    let rays = RayGrid::new(&camera.expect("valid"), width, height);
    let mut buffer = GBuffer::new(width, height, 0);
    let mut state = 1_u32;
    let mut random = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % below
    };
    let size = width * height;
    (buffer.cap, buffer.shadow, buffer.occlusion) =
        (vec![false; size], vec![0; size], vec![0; size]);
    for pixel in 0..size {
        // Runs of several lengths, and lone pixels.
        if random(8) == 0 || (pixel / 40) % 3 == 0 {
            buffer.status[pixel] = Status::Hit;
            buffer.drawn[pixel] = 3.0 + f64::from(random(100)) / 30.0;
        }
        let normal = [(); 3].map(|()| f64::from(random(201)) - 100.0);
        let normal = DVec3::from_array(normal).normalize_or(DVec3::Z);
        buffer.normal[pixel] = normal.as_vec3().to_array();
        let number = if random(20) == 0 { random(7) as u16 } else { 1 };
        buffer.surface.set(pixel, number, buffer.status.len());
        buffer.cap[pixel] = random(5) == 0;
        buffer.shadow[pixel] = if random(3) == 0 { random(256) as u8 } else { 0 };
        buffer.occlusion[pixel] = random(256) as u8;
    }
    let of_material = |(n, material): (usize, &'static Material)| SurfaceColors {
        material,
        ..SurfaceColors::default_for(n)
    };
    let surfaces: Vec<_> = MATERIALS.iter().enumerate().map(of_material).collect();
    for light in [Light::above_left(&rays), Light::Positional(DVec3::new(1.0, -2.0, 1.0))] {
        for look in &LOOKS {
            let look = Appearance { surfaces: surfaces.clone(), ..Appearance::new(look, light) };
            let painted = bytes(&buffer, &rays, &look);
            for level in levels() {
                let others = shade_with(level, &buffer, &rays, &look, &[], ColorDepth::Bytes);
                let others = others.into_bytes();
                let off = others.iter().zip(&painted).map(|(a, b)| a.abs_diff(*b)).max();
                let most = u8::from(is_fused(level) != is_fused(Level::new()));
                assert!(off <= Some(most), "{} by {level:?}: {off:?}", look.look.name);
            }
            let light = shade(&buffer, &rays, &look, &[], ColorDepth::Floats);
            assert_eq!(light.into_bytes(), painted, "light has the same bytes");
            for (pixel, bytes) in painted.chunks_exact(3).enumerate() {
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
    let before = bytes(&buffer, &rays, &headlight());
    hand_back_colors(vec![7; 300]);
    assert_eq!(bytes(&buffer, &rays, &headlight()), before);
}
